#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/inference/gemm.h"

namespace lodestone::inference {

/// Products whose operands are rounded to bfloat16 (8 bits of mantissa, the range of float) and summed in
/// float32. Processors with tile products (AMX) or dot products of pairs (AVX512-BF16) multiply so up to
/// several times as fast; any other does the same with its float32 kernels, slower than without.
///
/// Operands are rounded to the nearest, ties to even; subnormal ones count as zero, and NaN stays NaN. Sums
/// are float32 and rounded likewise; those of "tiles" and "pairs" that would be subnormal are zero. A kernel
/// sums each element in an order that depends on k alone: bitwise the same for any number of rows, so for any
/// shards and threads. Different kernels agree to the rounding of float32 sums.

/// Names of the kernels this processor can run, the one to use first: "tiles", "pairs", "rounded" (the
/// float32 kernels after rounding).
std::vector<std::string> bf16_kernels();
/// Uses another kernel from now on. For tests; not thread-safe. Throws LogicFault on a name that is not among
/// bf16_kernels().
void select_bf16_kernel(const std::string& name);

/// Sides of a product below this are not worth rounding: they are computed in float32.
constexpr std::int64_t kLeastBf16Side = 32;

/// Memory of one thread for its products.
struct Bf16Scratch {
  CacheAligned<std::uint16_t> left, turned;
  CacheAligned<std::uint32_t> right, left_pairs, turned_pairs;
  CacheAligned<float> rounded_left, rounded_right, panel;
};

/// out [m, n] = epilogue(A B) as multiply() does, with both operands rounded where k and n are at least
/// kLeastBf16Side. Bitwise the same for any number of rows.
void multiply_bf16(const LeftSide<float>& a, const RightSide<float>& b, Bf16Scratch& scratch, float* out,
                   const Epilogue<float>& epilogue = {});

/// How many times as fast as in float32 a product of 256 x 256 x 256 is here, packing included: measured
/// once.
double bf16_speedup();

}  // namespace lodestone::inference
