#pragma once

#include "lodestone/inference/gemm_bf16.h"

namespace lodestone::inference {

/// Asks the system for the tile registers; false where there are none.
bool request_tiles();
/// As multiply_bf16(), on tile registers; only after request_tiles().
void multiply_by_tiles(const LeftSide<float>& a, const RightSide<float>& b, Bf16Scratch& scratch, float* out,
                       const Epilogue<float>& epilogue);

}  // namespace lodestone::inference
