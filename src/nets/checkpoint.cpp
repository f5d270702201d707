#include "lodestone/nets/checkpoint.h"

#include <memory>
#include <sstream>

#include <torch/nn/module.h>
#include <torch/types.h>

#include "lodestone/common/error.h"
#include "lodestone/inference/checkpoint.h"

namespace lodestone::nets {
namespace {

using common::CheckpointError;
using inference::ElementType;

constexpr std::pair<ElementType, torch::ScalarType> kTypes[] = {{ElementType::kFloat32, torch::kFloat32},
                                                                {ElementType::kFloat64, torch::kFloat64},
                                                                {ElementType::kInt64, torch::kInt64},
                                                                {ElementType::kUint8, torch::kUInt8}};

}  // namespace

inference::Array to_array(const torch::Tensor& tensor) {
  for (const auto& [element, type] : kTypes) {
    if (type != tensor.scalar_type()) continue;
    auto plain = std::make_shared<const torch::Tensor>(tensor.detach().cpu().contiguous());
    return {element, plain->sizes().vec(), std::shared_ptr<const void>(plain, plain->data_ptr())};
  }
  throw common::LogicFault(std::string("checkpoints hold float32, float64, int64 and uint8, not ") +
                           torch::toString(tensor.scalar_type()));
}

torch::Tensor to_tensor(const inference::Array& array) {
  for (const auto& [element, type] : kTypes) {
    if (element != array.type()) continue;
    if (array.size() == 0) return torch::empty(array.shape(), type);
    return torch::from_blob(
        const_cast<void*>(array.owner().get()), array.shape(), [owner = array.owner()](void*) {}, type);
  }
  throw common::LogicFault("an array of a known type");
}

inference::Arrays to_arrays(const NamedTensors& tensors) {
  inference::Arrays arrays;
  for (const auto& [name, tensor] : tensors) arrays[name] = to_array(tensor);
  return arrays;
}

NamedTensors to_tensors(const inference::Arrays& arrays) {
  NamedTensors tensors;
  for (const auto& [name, array] : arrays) tensors[name] = to_tensor(array);
  return tensors;
}

void save_checkpoint(const std::string& folder, const Checkpoint& checkpoint) {
  inference::Checkpoint plain{checkpoint.kind, checkpoint.config, checkpoint.facts, {}};
  for (const auto& [part, tensors] : checkpoint.parts) plain.parts[part] = to_arrays(tensors);
  inference::save_checkpoint(folder, plain);
}

Checkpoint load_checkpoint(const std::string& folder, const std::string& expected_kind) {
  const inference::Checkpoint plain = inference::load_checkpoint(folder, expected_kind);
  Checkpoint checkpoint{plain.kind, plain.config, plain.facts, {}};
  for (const auto& [part, arrays] : plain.parts) checkpoint.parts[part] = to_tensors(arrays);
  return checkpoint;
}

NamedTensors module_tensors(const torch::nn::Module& module) {
  NamedTensors tensors;
  for (const auto& item : module.named_parameters()) tensors[item.key()] = item.value().detach();
  for (const auto& item : module.named_buffers()) tensors[item.key()] = item.value().detach();
  return tensors;
}

void load_module_tensors(torch::nn::Module& module, const NamedTensors& tensors, const std::string& what) {
  const torch::NoGradGuard no_grad;
  NamedTensors own = module_tensors(module);
  for (const auto& [name, tensor] : tensors) {
    if (own.count(name) == 0) throw CheckpointError(what + ": unexpected tensor \"" + name + "\"");
  }
  for (auto& [name, target] : own) {
    const auto found = tensors.find(name);
    if (found == tensors.end()) throw CheckpointError(what + ": tensor \"" + name + "\" is missing");
    const torch::Tensor& source = found->second;
    if (source.sizes() != target.sizes() || source.scalar_type() != target.scalar_type()) {
      std::ostringstream message;
      message << what << ": tensor \"" << name << "\" is " << source.sizes() << " "
              << torch::toString(source.scalar_type()) << ", expected " << target.sizes() << " "
              << torch::toString(target.scalar_type());
      throw CheckpointError(message.str());
    }
    target.copy_(source);
  }
}

}  // namespace lodestone::nets
