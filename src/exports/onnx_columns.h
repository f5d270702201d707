#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/inference/onnx_model.h"

namespace lodestone::exports {

/// Names of values in an ONNX graph, with the few operators that exports need as functions of them. Constants
/// are float32.
class OnnxColumns {
 public:
  explicit OnnxColumns(inference::OnnxModel& model) : model_(model) {}

  std::string constant(std::vector<float> numbers, std::vector<std::int64_t> shape);
  std::string number(double value) { return constant({static_cast<float>(value)}, {1}); }
  std::string indices(const std::vector<std::int64_t>& numbers);

  std::string op(const std::string& type, const std::vector<std::string>& inputs,
                 const inference::OnnxAttributes& attributes = {}) {
    return model_.node(type, inputs, attributes);
  }
  /// Columns first .. first + count of [batch, n].
  std::string columns(const std::string& value, std::int64_t first, std::int64_t count);
  /// Side by side.
  std::string row(const std::vector<std::string>& values) {
    return op("Concat", values, {{"axis", std::int64_t{1}}});
  }
  std::string reshaped(const std::string& value, const std::vector<std::int64_t>& shape) {
    return op("Reshape", {value, indices(shape)});
  }
  /// Length of the vectors along the last axis.
  std::string length(const std::string& vectors, bool keep_axis = true);
  std::string scaled(const std::string& value, double factor) { return op("Mul", {value, number(factor)}); }
  std::string above(const std::string& value, double bound) { return op("Greater", {value, number(bound)}); }
  /// True as 1, false as 0, and back.
  std::string as_float(const std::string& truth) { return op("Cast", {truth}, {{"to", std::int64_t{1}}}); }
  /// Whether one along the last axis is true.
  std::string any(const std::string& truths, bool keep_axis);
  std::string where(const std::string& truth, const std::string& then, const std::string& otherwise) {
    return op("Where", {truth, then, otherwise});
  }

 private:
  inference::OnnxModel& model_;
  int constants_ = 0;
};

}  // namespace lodestone::exports
