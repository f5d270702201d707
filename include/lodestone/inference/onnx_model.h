#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lodestone/inference/array.h"

namespace lodestone::inference {

/// A number, or the name of one that a caller of the network chooses, such as "batch".
using OnnxDimension = std::variant<std::int64_t, std::string>;

/// What a network takes or gives.
struct OnnxValue {
  std::string name;
  std::vector<OnnxDimension> shape;
  ElementType type = ElementType::kFloat32;
  std::string description = {};  ///< what it means, with units
};

using OnnxAttribute = std::variant<std::int64_t, float, std::string, std::vector<std::int64_t>, Array>;
using OnnxAttributes = std::map<std::string, OnnxAttribute>;

/// A network as an ONNX file, which other programs run: a graph of operators whose constants are in the file.
/// Nodes must come in the order in which they can be computed; nothing is checked before the file is loaded.
/// Format: https://onnx.ai/onnx/repo-docs/IR.html, operators: https://onnx.ai/onnx/operators/.
class OnnxModel {
 public:
  static constexpr std::int64_t kIrVersion = 8;
  static constexpr std::int64_t kOpset = 17;

  explicit OnnxModel(std::string name) : name_(std::move(name)) {}

  /// Both return the value's name, for the nodes that take it.
  std::string input(OnnxValue value);
  std::string constant(const std::string& name, Array numbers);
  /// Adds operator `type`. Returns the name of what it gives: `output`, or one made of the type and the
  /// node's number.
  std::string node(const std::string& type, std::vector<std::string> inputs, OnnxAttributes attributes = {},
                   std::string output = {});
  /// A value that a node gives is given by the network.
  void output(OnnxValue value) { outputs_.push_back(std::move(value)); }
  /// Anything a user of the file should find in it.
  void metadata(const std::string& key, const std::string& value) { metadata_[key] = value; }

  /// The content of the file.
  std::string encode() const;

 private:
  struct Node {
    std::string type, output;
    std::vector<std::string> inputs;
    OnnxAttributes attributes;
  };

  std::string encode_graph() const;

  std::string name_;
  std::vector<OnnxValue> inputs_, outputs_;
  std::vector<std::pair<std::string, Array>> constants_;
  std::vector<Node> nodes_;
  std::map<std::string, std::string> metadata_;
};

}  // namespace lodestone::inference
