#include "lodestone/rl/training_checkpoint.h"

#include "lodestone/common/error.h"
#include "lodestone/nets/tensors.h"

namespace lodestone::rl {

at::Tensor tensor_of(const nets::Checkpoint& checkpoint, const char* part, const std::string& name,
                     at::IntArrayRef shape, at::ScalarType type) {
  const std::string what = "training checkpoint: tensor \"" + name + "\"";
  const auto tensors = checkpoint.parts.find(part);
  if (tensors == checkpoint.parts.end() || tensors->second.count(name) == 0 ||
      tensors->second.at(name).sizes() != shape || tensors->second.at(name).scalar_type() != type)
    throw common::CheckpointError(
        what + " is missing or of another shape: resume with the configuration it was made with");
  inference::check_finite(nets::to_array(tensors->second.at(name)), what);
  return tensors->second.at(name);
}

void restore_numbers(const nets::Checkpoint& checkpoint, const char* part, const std::string& prefix,
                     const FlatNetwork<float>& network, const at::Tensor& flat) {
  for (auto& [name, view] : network.named(flat, prefix)) {
    at::Tensor numbers = view;
    numbers.copy_(tensor_of(checkpoint, part, name, view.sizes(), at::kFloat));
  }
}

inference::Arrays arrays_of(const FlatNetwork<float>& network) {
  inference::Arrays weights;
  for (const auto& [name, tensor] : network.named(network.parameters(), ""))
    weights[name] = nets::to_array(tensor.clone());
  return weights;
}

}  // namespace lodestone::rl
