#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lodestone::inference {

/// Matrix products of small dense networks, in float and double, by the widest vectors this processor has.
///
/// BLAS libraries are tuned for matrices of thousands; in a layer of 256 x 256 the packing of both sides
/// shows there, and bias, ReLU and its gradient are passes of their own. Here a right-hand matrix that does
/// not change is packed once, and the rest happens while the result is in registers.
///
/// Every element of a result depends on one row of the left-hand matrix only and is summed in a fixed order:
/// results are bitwise the same for any number of rows, so for any shards and threads, and on every processor
/// with AVX2 or AVX-512.

/// Names of the kernels this processor can run, widest first: "avx512", "avx2", "generic".
std::vector<std::string> gemm_kernels();
/// Name of the kernels in use: the first of gemm_kernels().
std::string gemm_kernel_name();
/// Uses other kernels from now on; matrices packed before must be packed again. For tests; not thread-safe.
/// Throws LogicFault on a name that is not among gemm_kernels().
void select_gemm_kernels(const std::string& name);

/// Numbers that begin on a cache line, so that no vector of them lies on two. Grows, never shrinks.
template <class Real>
class CacheAligned {
 public:
  /// Room for `count` numbers, which may be other numbers than before.
  Real* at_least(std::int64_t count);
  const Real* data() const { return reinterpret_cast<const Real*>(lines_.data()); }

 private:
  struct alignas(64) Line {
    unsigned char bytes[64];
  };
  std::vector<Line> lines_;
};

/// A of a product: `matrix` [m, k], row-major, `stride` numbers from row to row.
template <class Real>
struct LeftSide {
  const Real* matrix;
  std::int64_t m, stride;
};

/// B [k, n] of a product: `matrix` is [k, n], or with `transposed` [n, k] (a linear layer's weight in its
/// forward pass); row-major, contiguous.
template <class Real>
struct RightSide {
  const Real* matrix;
  std::int64_t k, n;
  bool transposed = false;
};

/// A right-hand side that stays the same for many products, in the order in which the kernels read it.
template <class Real>
class PackedMatrix {
 public:
  explicit PackedMatrix(const RightSide<Real>& b);
  std::int64_t k() const { return k_; }
  std::int64_t n() const { return n_; }
  const Real* panels() const { return storage_.data(); }

 private:
  CacheAligned<Real> storage_;
  std::int64_t k_, n_;
};

/// What happens to an element of a product before it is written, in this order. NaN stays NaN.
template <class Real>
struct Epilogue {
  const Real* bias = nullptr;  ///< [n], added
  bool relu = false;           ///< max(x, 0)
  const Real* mask = nullptr;  ///< [m, n]: zero where the mask is not positive, the gradient of a ReLU
};

/// out [m, n] = epilogue(A B), row-major and contiguous; it may not overlap the operands.
template <class Real>
void multiply(const LeftSide<Real>& a, const PackedMatrix<Real>& b, Real* out,
              const Epilogue<Real>& epilogue = {});
/// The same for a B that changes from product to product: it is packed on the way, a part at a time, in
/// `scratch`.
template <class Real>
void multiply(const LeftSide<Real>& a, const RightSide<Real>& b, CacheAligned<Real>& scratch, Real* out,
              const Epilogue<Real>& epilogue = {});

/// out [columns, rows] = the transpose of matrix [rows, columns], with `out_stride` numbers from row to row
/// of `out`.
template <class Real>
void transpose(const Real* matrix, std::int64_t rows, std::int64_t columns, Real* out,
               std::int64_t out_stride);

/// A row stride for transpose() that keeps its writes out of each other's cache sets: `columns` and a cache
/// line.
constexpr std::int64_t padded_stride(std::int64_t columns) { return columns + 16; }

}  // namespace lodestone::inference
