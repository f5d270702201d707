#pragma once

#include <cstdint>

#include "lodestone/inference/gemm.h"

namespace lodestone::inference {

/// Products whose operands are rounded to bfloat16 (8 bits of mantissa, the range of float) and summed in
/// float32. A processor with tile products for them (AMX) multiplies so several times as fast; any other does
/// the same with its float32 kernels, slower than without.

/// Sides of a product below this are not worth rounding: they are computed in float32.
constexpr std::int64_t kLeastBf16Side = 32;

/// Memory of one thread for its products.
struct Bf16Scratch {
  CacheAligned<std::uint16_t> left, turned;
  CacheAligned<std::uint32_t> right;
  CacheAligned<float> rounded_left, rounded_right, panel;
};

/// out [m, n] = epilogue(A B) as multiply() does, with both operands rounded where k and n are at least
/// kLeastBf16Side. Bitwise the same for any number of rows.
void multiply_bf16(const LeftSide<float>& a, const RightSide<float>& b, Bf16Scratch& scratch, float* out,
                   const Epilogue<float>& epilogue = {});

/// Whether this processor has tile products.
bool has_bf16_tiles();
/// How many times as fast as in float32 a product of 256 x 256 x 256 is here, packing included: measured
/// once.
double bf16_speedup();

}  // namespace lodestone::inference
