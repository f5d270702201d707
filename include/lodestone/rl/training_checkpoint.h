#pragma once

#include <string>

#include <ATen/core/Tensor.h>

#include "lodestone/inference/array.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/rl/flat_network.h"

namespace lodestone::rl {

/// A tensor of a training checkpoint, every number finite. Throws CheckpointError that names it where it is
/// missing, or of another shape or type.
at::Tensor tensor_of(const nets::Checkpoint& checkpoint, const char* part, const std::string& name,
                     at::IntArrayRef shape, at::ScalarType type);

/// Fills `flat`, which is laid out like the network's parameters, from the tensors "<prefix>l1.weight", ...
/// Throws as tensor_of().
void restore_numbers(const nets::Checkpoint& checkpoint, const char* part, const std::string& prefix,
                     const FlatNetwork<float>& network, const at::Tensor& flat);

/// The weights as checkpoints of policies hold them: "l1.weight", ...
inference::Arrays arrays_of(const FlatNetwork<float>& network);

}  // namespace lodestone::rl
