#pragma once

#include "lodestone/inference/gemm_bf16.h"

namespace lodestone::inference {

/// Whether this processor multiplies vectors of pairs of bfloat16 (AVX512-BF16).
bool has_pairs();
/// As multiply_bf16(), on vectors of pairs; only where has_pairs().
void multiply_by_pairs(const LeftSide<float>& a, const RightSide<float>& b, Bf16Scratch& scratch, float* out,
                       const Epilogue<float>& epilogue);

}  // namespace lodestone::inference
