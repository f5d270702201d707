#pragma once

#include <string>
#include <vector>

#include "lodestone/inference/array.h"
#include "lodestone/inference/dense_network.h"
#include "lodestone/inference/dynamics_config.h"

namespace lodestone::inference {

/// The linear layers of a dynamics network with every normalisation worked into them, in float64 until the
/// end. Throws CheckpointError that begins with `what` when `weights` are not those of the shape.
std::vector<LinearLayer> fold(const Arrays& weights, const DynamicsConfig& config, data::StateLayout layout,
                              const std::string& what);

/// Array `name` of `shape`, float32. Throws CheckpointError that begins with `what`.
const Array& weight_at(const Arrays& weights, const std::string& name, const std::vector<std::int64_t>& shape,
                       const std::string& what);

}  // namespace lodestone::inference
