#include "gemm_pairs.h"

#include <immintrin.h>

#include <algorithm>

#include "gemm_kernel_body.h"

namespace lodestone::inference {
namespace {

/// Two bfloat16 that follow each other along k: each is multiplied with its like, both products are added.
struct PairTerms {
  using Operand = std::uint32_t;
  static __m512bh spread(std::uint32_t pair) { return (__m512bh)_mm512_set1_epi32(static_cast<int>(pair)); }
  template <class Vector, class Pairs>
  static void add(Vector& sum, __m512bh factor, const Pairs& b) {
    sum = (Vector)_mm512_dpbf16_ps((__m512)sum, factor, (__m512bh)b);
  }
};

constexpr std::int64_t kLanes = 16;
using PairKernel = Kernel<float, kLanes, 12, PairTerms>;

__mmask16 first_lanes(std::int64_t count) {
  return static_cast<__mmask16>((1U << std::clamp<std::int64_t>(count, 0, kLanes)) - 1);
}

/// [rows, k] with a stride to pairs [rows, (k + 1) / 2]; where k is odd, the last one is half zero.
void round_rows(const float* matrix, std::int64_t rows, std::int64_t stride, std::int64_t k,
                std::uint32_t* out) {
  const std::int64_t whole = k / (2 * kLanes) * (2 * kLanes);
  const __mmask16 low = first_lanes(k - whole), high = first_lanes(k - whole - kLanes);
  const __mmask16 rest = first_lanes((k - whole + 1) / 2);
  for (std::int64_t i = 0; i < rows; ++i, matrix += stride, out += (k + 1) / 2) {
    for (std::int64_t j = 0; j < whole; j += 2 * kLanes) {
      const __m512bh rounded =
          _mm512_cvtne2ps_pbh(_mm512_loadu_ps(matrix + j + kLanes), _mm512_loadu_ps(matrix + j));
      _mm512_storeu_si512(out + j / 2, (__m512i)rounded);
    }
    const __m512bh rounded = _mm512_cvtne2ps_pbh(_mm512_maskz_loadu_ps(high, matrix + whole + kLanes),
                                                 _mm512_maskz_loadu_ps(low, matrix + whole));
    _mm512_mask_storeu_epi32(out + whole / 2, rest, (__m512i)rounded);
  }
}

/// `columns` columns of [k, n], from `matrix` on, to a panel: pairs of what lies below each other.
void pack_pairs(const float* matrix, std::int64_t k, std::int64_t n, std::int64_t columns, std::int64_t width,
                std::uint32_t* panel) {
  const __m512i interleaved = _mm512_set_epi16(31, 15, 30, 14, 29, 13, 28, 12, 27, 11, 26, 10, 25, 9, 24, 8,
                                               23, 7, 22, 6, 21, 5, 20, 4, 19, 3, 18, 2, 17, 1, 16, 0);
  for (std::int64_t i = 0; i < k; i += 2, matrix += 2 * n, panel += width)
    for (std::int64_t j = 0; j < width; j += kLanes) {
      const __mmask16 there = first_lanes(columns - j);
      const __m512 upper = _mm512_maskz_loadu_ps(there, matrix + j);
      const __m512 lower = _mm512_maskz_loadu_ps(i + 1 < k ? there : __mmask16{0}, matrix + n + j);
      const auto rounded = (__m512i)_mm512_cvtne2ps_pbh(lower, upper);
      _mm512_store_si512(panel + j, _mm512_permutexvar_epi16(interleaved, rounded));
    }
}

/// The same of [n, k].
void pack_pairs_transposed(const float* matrix, std::int64_t k, std::int64_t columns, std::int64_t width,
                           std::uint32_t* rounded, std::uint32_t* panel) {
  const std::int64_t pairs = (k + 1) / 2;
  round_rows(matrix, columns, k, k, rounded);
  if (columns < width) std::fill_n(panel, pairs * width, 0U);
  PairKernel::transpose(rounded, columns, pairs, pairs, panel, width);
}

}  // namespace

bool has_pairs() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx512bf16") && __builtin_cpu_supports("avx512bw");
}

void multiply_by_pairs(const LeftSide<float>& a, const RightSide<float>& b, Bf16Scratch& scratch, float* out,
                       const Epilogue<float>& epilogue) {
  constexpr std::int64_t kWidth = PairKernel::kWidth;
  const std::int64_t pairs = (b.k + 1) / 2;
  std::uint32_t* left = scratch.left_pairs.at_least(a.m * pairs);
  std::uint32_t* panel = scratch.right.at_least(pairs * kWidth);
  std::uint32_t* turned = scratch.turned_pairs.at_least(pairs * kWidth);
  round_rows(a.matrix, a.m, a.stride, b.k, left);
  for (std::int64_t j = 0; j < b.n; j += kWidth) {
    const std::int64_t columns = std::min(kWidth, b.n - j);
    const std::int64_t width = columns > kLanes ? kWidth : kLanes;
    if (b.transposed)
      pack_pairs_transposed(b.matrix + j * b.k, b.k, columns, width, turned, panel);
    else
      pack_pairs(b.matrix + j, b.k, b.n, columns, width, panel);
    Epilogue<float> of_panel = epilogue;
    if (epilogue.bias != nullptr) of_panel.bias += j;
    if (epilogue.mask != nullptr) of_panel.mask += j;
    PairKernel::multiply(left, a.m, pairs, pairs, panel, columns, out + j, b.n, of_panel);
  }
}

}  // namespace lodestone::inference
