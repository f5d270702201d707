#include "lodestone/inference/onnx_model.h"

#include <cstring>

namespace lodestone::inference {
namespace {

/// One message in protobuf's wire format (https://protobuf.dev/programming-guides/encoding/). The numbers of
/// the fields below are those of onnx.proto.
class OnnxMessage {
 public:
  OnnxMessage& number(std::uint32_t field, std::int64_t value) {
    key(field, 0);
    varint(static_cast<std::uint64_t>(value));
    return *this;
  }
  OnnxMessage& real(std::uint32_t field, float value) {
    key(field, 5);
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    bytes_.append(bytes, sizeof value);
    return *this;
  }
  OnnxMessage& text(std::uint32_t field, const std::string& value) {
    key(field, 2);
    varint(value.size());
    bytes_ += value;
    return *this;
  }
  OnnxMessage& message(std::uint32_t field, const OnnxMessage& value) { return text(field, value.bytes_); }

  const std::string& bytes() const { return bytes_; }

 private:
  void key(std::uint32_t field, std::uint32_t wire_type) { varint(field << 3 | wire_type); }
  void varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_ += static_cast<char>(value | 0x80);
    bytes_ += static_cast<char>(value);
  }

  std::string bytes_;
};

std::int64_t onnx_type(ElementType type) {
  switch (type) {
    case ElementType::kFloat32:
      return 1;
    case ElementType::kUint8:
      return 2;
    case ElementType::kInt64:
      return 7;
    default:
      return 11;  // double
  }
}

OnnxMessage tensor(const std::string& name, const Array& numbers) {
  OnnxMessage out;
  for (const std::int64_t size : numbers.shape()) out.number(1, size);
  out.number(2, onnx_type(numbers.type()));
  out.text(8, name);
  const auto* data = static_cast<const char*>(numbers.owner().get());  // little-endian, as this processor's
  return out.text(9, std::string(data, numbers.bytes()));
}

OnnxMessage attribute(const std::string& name, const OnnxAttribute& value) {
  OnnxMessage out;
  out.text(1, name);
  struct {
    OnnxMessage& out;
    void operator()(float value) { out.real(2, value).number(20, 1); }
    void operator()(std::int64_t value) { out.number(3, value).number(20, 2); }
    void operator()(const std::string& value) { out.text(4, value).number(20, 3); }
    void operator()(const Array& value) { out.message(5, tensor("", value)).number(20, 4); }
    void operator()(const std::vector<std::int64_t>& values) {
      for (const std::int64_t value : values) out.number(8, value);
      out.number(20, 7);
    }
  } write{out};
  std::visit(write, value);
  return out;
}

OnnxMessage value_info(const OnnxValue& value) {
  OnnxMessage shape;
  for (const OnnxDimension& size : value.shape) {
    OnnxMessage dimension;
    if (const auto* fixed = std::get_if<std::int64_t>(&size))
      dimension.number(1, *fixed);
    else
      dimension.text(2, std::get<std::string>(size));
    shape.message(1, dimension);
  }
  const OnnxMessage type = OnnxMessage().number(1, onnx_type(value.type)).message(2, shape);
  return OnnxMessage()
      .text(1, value.name)
      .message(2, OnnxMessage().message(1, type))
      .text(3, value.description);
}

}  // namespace

std::string OnnxModel::input(OnnxValue value) {
  inputs_.push_back(std::move(value));
  return inputs_.back().name;
}

std::string OnnxModel::constant(const std::string& name, Array numbers) {
  constants_.emplace_back(name, std::move(numbers));
  return name;
}

std::string OnnxModel::node(const std::string& type, std::vector<std::string> inputs,
                            OnnxAttributes attributes, std::string output) {
  if (output.empty()) output = type + "_" + std::to_string(nodes_.size());
  nodes_.push_back({type, std::move(output), std::move(inputs), std::move(attributes)});
  return nodes_.back().output;
}

std::string OnnxModel::encode_graph() const {
  OnnxMessage graph;
  for (const Node& node : nodes_) {
    OnnxMessage out;
    for (const std::string& input : node.inputs) out.text(1, input);
    out.text(2, node.output).text(3, node.output).text(4, node.type);
    for (const auto& [name, value] : node.attributes) out.message(5, attribute(name, value));
    graph.message(1, out);
  }
  graph.text(2, name_);
  for (const auto& [name, numbers] : constants_) graph.message(5, tensor(name, numbers));
  for (const OnnxValue& value : inputs_) graph.message(11, value_info(value));
  for (const OnnxValue& value : outputs_) graph.message(12, value_info(value));
  return graph.bytes();
}

std::string OnnxModel::encode() const {
  OnnxMessage model;
  model.number(1, kIrVersion).text(2, "lodestone").text(7, encode_graph());
  model.message(8, OnnxMessage().text(1, "").number(2, kOpset));
  for (const auto& [key, value] : metadata_) model.message(14, OnnxMessage().text(1, key).text(2, value));
  return model.bytes();
}

}  // namespace lodestone::inference
