#include "lodestone/nets/tensors.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <ATen/ops/empty.h>
#include <ATen/ops/from_blob.h>
#include <c10/util/StringUtil.h>

#include "lodestone/common/error.h"

namespace lodestone::nets {
namespace {

using inference::ElementType;

constexpr std::pair<ElementType, at::ScalarType> kTypes[] = {{ElementType::kFloat32, at::kFloat},
                                                             {ElementType::kFloat64, at::kDouble},
                                                             {ElementType::kInt64, at::kLong},
                                                             {ElementType::kUint8, at::kByte}};

}  // namespace

inference::Array to_array(const at::Tensor& tensor) {
  for (const auto& [element, type] : kTypes) {
    if (type != tensor.scalar_type()) continue;
    auto plain = std::make_shared<const at::Tensor>(tensor.detach().cpu().contiguous());
    return {element, plain->sizes().vec(), std::shared_ptr<const void>(plain, plain->data_ptr())};
  }
  throw common::LogicFault(std::string("checkpoints hold float32, float64, int64 and uint8, not ") +
                           at::toString(tensor.scalar_type()));
}

at::Tensor to_tensor(const inference::Array& array) {
  for (const auto& [element, type] : kTypes) {
    if (element != array.type()) continue;
    if (array.size() == 0) return at::empty(array.shape(), type);
    return at::from_blob(
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

at::Tensor tensor_from(const std::vector<double>& values, const std::vector<std::int64_t>& shape,
                       at::ScalarType type) {
  const at::Tensor tensor = at::empty(shape, at::kDouble);
  LODESTONE_CHECK(tensor.numel() == static_cast<std::int64_t>(values.size()),
                  "shape does not hold " + std::to_string(values.size()) + " numbers");
  std::copy(values.begin(), values.end(), tensor.data_ptr<double>());
  return tensor.to(type);
}

void check_tensor(const at::Tensor& tensor, at::IntArrayRef shape, at::ScalarType type,
                  const std::string& what) {
  LODESTONE_CHECK(tensor.sizes() == shape && tensor.scalar_type() == type && tensor.is_contiguous(),
                  c10::str(what, " is ", tensor.sizes(), " ", tensor.dtype(), ", expected contiguous ", shape,
                           " ", type));
}

std::vector<double> to_vector(const at::Tensor& tensor) {
  const at::Tensor flat = tensor.detach().to(at::kDouble).contiguous();
  const double* data = flat.data_ptr<double>();
  return {data, data + flat.numel()};
}

}  // namespace lodestone::nets
