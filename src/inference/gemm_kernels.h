#pragma once

#include <cstdint>

#include "lodestone/inference/gemm.h"

namespace lodestone::inference {

/// The product of one instruction set: what gemm.cpp calls. A panel is `width` columns of B, row after row;
/// the last one of a matrix is `width` or `width` / 2 wide, whichever suffices, and filled up with zeros.
template <class Real>
struct GemmKernels {
  std::int64_t width;
  /// `columns` columns of the product, which is `n` wide: `out`, bias and mask point to the first of them.
  void (*multiply)(const Real* a, std::int64_t m, std::int64_t a_stride, std::int64_t k, const Real* panel,
                   std::int64_t columns, Real* out, std::int64_t n, const Epilogue<Real>& epilogue);
  /// `columns` columns of a matrix of `n`, from `matrix` on, into a panel of `panel_width`; the rest of it is
  /// kept.
  void (*pack)(const Real* matrix, std::int64_t k, std::int64_t n, std::int64_t columns, Real* panel,
               std::int64_t panel_width);
  /// out[c * out_stride + r] = matrix[r * stride + c]
  void (*transpose)(const Real* matrix, std::int64_t rows, std::int64_t columns, std::int64_t stride,
                    Real* out, std::int64_t out_stride);
};

struct GemmKernelSet {
  const char* name;
  GemmKernels<float> of_float;
  GemmKernels<double> of_double;
};

GemmKernelSet generic_gemm_kernels();
GemmKernelSet avx2_gemm_kernels();
GemmKernelSet avx512_gemm_kernels();

}  // namespace lodestone::inference
