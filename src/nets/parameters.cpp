#include "lodestone/nets/parameters.h"

#include <sstream>

#include <ATen/core/grad_mode.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/zeros.h>

#include "lodestone/common/error.h"
#include "lodestone/common/shown.h"

namespace lodestone::nets {
namespace {

std::vector<at::Tensor> tensors_of(const std::vector<std::pair<std::string, at::Tensor>>& entries) {
  std::vector<at::Tensor> tensors;
  for (const auto& entry : entries) tensors.push_back(entry.second);
  return tensors;
}

}  // namespace

at::Tensor Parameters::add(const std::string& name, const std::vector<std::int64_t>& shape) {
  return parameters_.emplace_back(name, at::zeros(shape).set_requires_grad(true)).second;
}

at::Tensor Parameters::add_buffer(const std::string& name, const at::Tensor& value) {
  return buffers_.emplace_back(name, value).second;
}

std::vector<at::Tensor> Parameters::parameters() const { return tensors_of(parameters_); }
std::vector<at::Tensor> Parameters::buffers() const { return tensors_of(buffers_); }

void Parameters::flatten() {
  const at::NoGradGuard no_grad;
  std::int64_t count = 0;
  for (const auto& entry : parameters_) count += entry.second.numel();
  LODESTONE_CHECK(count > 0, "a network with parameters");
  values_ = at::empty({count});
  gradient_ = at::zeros({count});
  std::int64_t offset = 0;
  for (auto& [name, parameter] : parameters_) {
    const auto part_of = [&, &tensor = parameter](const at::Tensor& flat) {
      return flat.narrow(0, offset, tensor.numel()).view(tensor.sizes());
    };
    const at::Tensor view = part_of(values_);
    view.copy_(parameter);
    parameter.set_data(view);
    parameter.mutable_grad() = part_of(gradient_);
    offset += parameter.numel();
  }
}

NamedTensors Parameters::named() const {
  NamedTensors tensors;
  for (const auto& [name, tensor] : parameters_) tensors[name] = tensor.detach();
  for (const auto& [name, tensor] : buffers_) tensors[name] = tensor.detach();
  return tensors;
}

void Parameters::load(const NamedTensors& tensors, const std::string& what) {
  const at::NoGradGuard no_grad;
  const NamedTensors own = named();
  for (const auto& entry : tensors) {
    if (own.count(entry.first) == 0)
      throw common::CheckpointError(what + ": unexpected tensor \"" + common::shown(entry.first) + "\"");
  }
  for (const auto& [name, target] : own) {
    const auto found = tensors.find(name);
    if (found == tensors.end()) throw common::CheckpointError(what + ": tensor \"" + name + "\" is missing");
    const at::Tensor& source = found->second;
    if (source.sizes() != target.sizes() || source.scalar_type() != target.scalar_type()) {
      std::ostringstream message;
      message << what << ": tensor \"" << name << "\" is " << source.sizes() << " "
              << at::toString(source.scalar_type()) << ", expected " << target.sizes() << " "
              << at::toString(target.scalar_type());
      throw common::CheckpointError(message.str());
    }
    inference::check_finite(to_array(source), what + ": tensor \"" + name + "\"");
    target.copy_(source);
  }
}

}  // namespace lodestone::nets
