#pragma once

// Included by one file per instruction set, which the build compiles with that set's options: everything here
// has internal linkage, so that no code of one set can stand in for another's.

#include <algorithm>
#include <cstdint>
#include <type_traits>

#include "gemm_kernels.h"

namespace lodestone::inference {
namespace {

template <class Number, int Lanes>
struct VectorOf {
  typedef Number Type
      __attribute__((vector_size(Lanes * sizeof(Number)), aligned(alignof(Number)), may_alias));
  static Type load(const Number* from) { return *reinterpret_cast<const Type*>(from); }
  static void store(Number* to, const Type& value) { *reinterpret_cast<Type*>(to) = value; }
};

/// What sums are made of: operands of the same type, multiplied.
template <class Real, int Lanes>
struct PlainTerms {
  using Operand = Real;
  using Vector = typename VectorOf<Real, Lanes>::Type;
  static Vector spread(Real number) { return number - Vector{}; }  // the same in every lane
  static void add(Vector& sum, const Vector& factor, const Vector& b) { sum += factor * b; }
};

/// `Lanes` numbers to a vector; a tile of `TileRows` x 2 vectors fills the registers.
template <class Real, int Lanes, int TileRows, class Terms = PlainTerms<Real, Lanes>>
struct Kernel {
  using Operand = typename Terms::Operand;
  using Operands = VectorOf<Operand, Lanes>;
  using Vector = typename VectorOf<Real, Lanes>::Type;
  static constexpr std::int64_t kWidth = 2 * Lanes;

  static Vector load(const Real* from) { return VectorOf<Real, Lanes>::load(from); }
  static void store(Real* to, const Vector& value) { VectorOf<Real, Lanes>::store(to, value); }

  /// `Rows` rows of `a` times one panel of `Vectors` vectors.
  template <int Rows, int Vectors>
  static void tile(const Operand* a, std::int64_t a_stride, std::int64_t k, const Operand* panel, Real* out,
                   std::int64_t n, std::int64_t columns, const Epilogue<Real>& epilogue) {
    Vector sum[Rows][Vectors];
#pragma GCC unroll 16
    for (int i = 0; i < Rows; ++i) {
#pragma GCC unroll 2
      for (int v = 0; v < Vectors; ++v) sum[i][v] = Vector{};
    }
    for (std::int64_t p = 0; p < k; ++p, panel += Vectors * Lanes) {
      typename Operands::Type b[Vectors];
#pragma GCC unroll 2
      for (int v = 0; v < Vectors; ++v) b[v] = Operands::load(panel + v * Lanes);
#pragma GCC unroll 16
      for (int i = 0; i < Rows; ++i) {
        const auto factor = Terms::spread(a[i * a_stride + p]);
#pragma GCC unroll 2
        for (int v = 0; v < Vectors; ++v) Terms::add(sum[i][v], factor, b[v]);
      }
    }
    if (columns == Vectors * Lanes) {
#pragma GCC unroll 16
      for (int i = 0; i < Rows; ++i) {
#pragma GCC unroll 2
        for (int v = 0; v < Vectors; ++v) {
          Vector x = sum[i][v];
          if (epilogue.bias != nullptr) x += load(epilogue.bias + v * Lanes);
          if (epilogue.relu) x = x < Vector{} ? Vector{} : x;
          if (epilogue.mask != nullptr) x = load(epilogue.mask + i * n + v * Lanes) > Vector{} ? x : Vector{};
          store(out + i * n + v * Lanes, x);
        }
      }
      return;
    }
    Real rows[Rows * Vectors * Lanes];
#pragma GCC unroll 16
    for (int i = 0; i < Rows; ++i) {
#pragma GCC unroll 2
      for (int v = 0; v < Vectors; ++v) store(rows + (i * Vectors + v) * Lanes, sum[i][v]);
    }
    finish_edge(rows, Rows, Vectors * Lanes, out, n, columns, epilogue);
  }

  /// The same for fewer columns than vectors hold. A function of its own: in every tile, its loops would cost
  /// more to compile than all the rest.
  [[gnu::noinline]] static void finish_edge(const Real* row, int rows, std::int64_t row_size, Real* out,
                                            std::int64_t n, std::int64_t columns,
                                            const Epilogue<Real>& epilogue) {
    for (int i = 0; i < rows; ++i, row += row_size, out += n) {
      for (std::int64_t j = 0; j < columns; ++j) {
        Real x = row[j];
        if (epilogue.bias != nullptr) x += epilogue.bias[j];
        if (epilogue.relu) x = x < Real(0) ? Real(0) : x;
        if (epilogue.mask != nullptr) x = epilogue.mask[i * n + j] > Real(0) ? x : Real(0);
        out[j] = x;
      }
    }
  }

  using Tile = void (*)(const Operand*, std::int64_t, std::int64_t, const Operand*, Real*, std::int64_t,
                        std::int64_t, const Epilogue<Real>&);

  /// The tile for fewer rows than a full one, which the last rows of a matrix need.
  template <int Vectors, int Rows = TileRows>
  static Tile tile_of(std::int64_t rows) {
    if constexpr (Rows > 1) {
      if (rows < Rows) return tile_of<Vectors, Rows - 1>(rows);
    }
    return &tile<Rows, Vectors>;
  }

  template <int Vectors>
  static void all_rows(const Operand* a, std::int64_t m, std::int64_t a_stride, std::int64_t k,
                       const Operand* panel, std::int64_t columns, Real* out, std::int64_t n,
                       Epilogue<Real> epilogue) {
    for (std::int64_t i = 0; i < m; i += TileRows) {
      const std::int64_t rows = std::min<std::int64_t>(TileRows, m - i);
      if (rows == TileRows) {
        tile<TileRows, Vectors>(a + i * a_stride, a_stride, k, panel, out + i * n, n, columns, epilogue);
      } else {
        tile_of<Vectors>(rows)(a + i * a_stride, a_stride, k, panel, out + i * n, n, columns, epilogue);
      }
      if (epilogue.mask != nullptr) epilogue.mask += TileRows * n;
    }
  }

  static void multiply(const Operand* a, std::int64_t m, std::int64_t a_stride, std::int64_t k,
                       const Operand* panel, std::int64_t columns, Real* out, std::int64_t n,
                       const Epilogue<Real>& epilogue) {
    if (columns > Lanes) {
      all_rows<2>(a, m, a_stride, k, panel, columns, out, n, epilogue);
    } else {
      all_rows<1>(a, m, a_stride, k, panel, columns, out, n, epilogue);
    }
  }

  /// A square of Lanes x Lanes in log2(Lanes) rounds of exchanges between pairs of rows.
  static void transpose_square(const Operand* matrix, std::int64_t stride, Operand* out,
                               std::int64_t out_stride) {
    typename Operands::Type row[Lanes];
#pragma GCC unroll 16
    for (int i = 0; i < Lanes; ++i) row[i] = Operands::load(matrix + i * stride);
    exchange<1>(row);
#pragma GCC unroll 16
    for (int i = 0; i < Lanes; ++i) Operands::store(out + i * out_stride, row[i]);
  }

  template <int Step>
  static void exchange(typename Operands::Type* row) {
    if constexpr (Step < Lanes) {
      using Index = std::conditional_t<sizeof(Operand) == 4, std::int32_t, std::int64_t>;
      typedef Index Mask __attribute__((vector_size(Lanes * sizeof(Operand))));
      Mask upper{};
      Mask lower{};
#pragma GCC unroll 16
      for (int lane = 0; lane < Lanes; ++lane) {
        upper[lane] = (lane & Step) != 0 ? Lanes + lane - Step : lane;
        lower[lane] = (lane & Step) != 0 ? Lanes + lane : lane + Step;
      }
#pragma GCC unroll 16
      for (int i = 0; i < Lanes; ++i) {
        if ((i & Step) != 0) continue;
        const auto first = row[i];
        const auto second = row[i + Step];
        row[i] = __builtin_shuffle(first, second, upper);
        row[i + Step] = __builtin_shuffle(first, second, lower);
      }
      exchange<2 * Step>(row);
    }
  }

  static void transpose(const Operand* matrix, std::int64_t rows, std::int64_t columns, std::int64_t stride,
                        Operand* out, std::int64_t out_stride) {
    const std::int64_t whole_rows = rows / Lanes * Lanes;
    const std::int64_t whole_columns = columns / Lanes * Lanes;
    for (std::int64_t c = 0; c < whole_columns; c += Lanes) {
      for (std::int64_t r = 0; r < whole_rows; r += Lanes) {
        transpose_square(matrix + r * stride + c, stride, out + c * out_stride + r, out_stride);
      }
    }
    for (std::int64_t r = 0; r < rows; ++r) {
      for (std::int64_t c = r < whole_rows ? whole_columns : 0; c < columns; ++c) {
        out[c * out_stride + r] = matrix[r * stride + c];
      }
    }
  }

  static void pack(const Operand* matrix, std::int64_t k, std::int64_t n, std::int64_t columns,
                   Operand* panel, std::int64_t panel_width) {
    if (columns == kWidth) {
      for (std::int64_t p = 0; p < k; ++p, matrix += n, panel += kWidth) {
        const auto left = Operands::load(matrix);
        const auto right = Operands::load(matrix + Lanes);
        Operands::store(panel, left);
        Operands::store(panel + Lanes, right);
      }
      return;
    }
    for (std::int64_t p = 0; p < k; ++p) std::copy_n(matrix + p * n, columns, panel + p * panel_width);
  }

  static GemmKernels<Real> table() { return {kWidth, &multiply, &pack, &transpose}; }
};

}  // namespace
}  // namespace lodestone::inference
