#include "onnx_columns.h"

#include <utility>

namespace lodestone::exports {

std::string OnnxColumns::constant(std::vector<float> numbers, std::vector<std::int64_t> shape) {
  return model_.constant("constant_" + std::to_string(constants_++), {std::move(numbers), std::move(shape)});
}

std::string OnnxColumns::indices(const std::vector<std::int64_t>& numbers) {
  return model_.constant("constant_" + std::to_string(constants_++),
                         {numbers, {static_cast<std::int64_t>(numbers.size())}});
}

std::string OnnxColumns::columns(const std::string& value, std::int64_t first, std::int64_t count) {
  return op("Slice", {value, indices({first}), indices({first + count}), indices({1})});
}

std::string OnnxColumns::length(const std::string& vectors, bool keep_axis) {
  return op("ReduceL2", {vectors},
            {{"axes", std::vector<std::int64_t>{-1}}, {"keepdims", std::int64_t{keep_axis}}});
}

std::string OnnxColumns::any(const std::string& truths, bool keep_axis) {
  return above(op("ReduceMax", {as_float(truths)},
                  {{"axes", std::vector<std::int64_t>{-1}}, {"keepdims", std::int64_t{keep_axis}}}),
               0.5);
}

}  // namespace lodestone::exports
