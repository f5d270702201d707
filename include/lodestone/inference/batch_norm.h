#pragma once

namespace lodestone::inference {

/// Batch normalisation adds this to a variance before the root is taken: PyTorch's default. Whoever folds a
/// normalisation into the layer before it needs the one that was trained with.
constexpr double kBatchNormEpsilon = 1e-5;

}  // namespace lodestone::inference
