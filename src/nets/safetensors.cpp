// The safetensors format: 8-byte little-endian header length, JSON header, raw little-endian tensor data.
// Source: https://github.com/huggingface/safetensors (README, "Format").
#include <cstring>
#include <limits>

#include "lodestone/common/error.h"
#include "lodestone/nets/checkpoint.h"

namespace lodestone::nets {
namespace {

using common::CheckpointError;
using common::Json;

constexpr std::size_t kLengthBytes = 8;
constexpr std::uint64_t kLargestHeader = 100'000'000;  // the limit of the reference implementation

struct ElementType {
  const char* name;
  torch::ScalarType type;
};
constexpr ElementType kTypes[] = {
    {"F32", torch::kFloat32}, {"F64", torch::kFloat64}, {"I64", torch::kInt64}, {"U8", torch::kUInt8}};

const char* name_of(torch::ScalarType type) {
  for (const ElementType& element : kTypes) {
    if (element.type == type) return element.name;
  }
  throw common::LogicFault(std::string("safetensors parts hold float32, float64, int64 and uint8, not ") +
                           torch::toString(type));
}

torch::ScalarType type_of(const std::string& name, const std::string& what) {
  for (const ElementType& element : kTypes) {
    if (name == element.name) return element.type;
  }
  throw CheckpointError(what + ": element type \"" + name + "\" is not one of F32, F64, I64, U8");
}

torch::Tensor decode_tensor(const std::string& name, const Json& entry, const char* data, std::uint64_t size,
                            const std::string& what) {
  const std::string where = what + ": tensor \"" + name + "\"";
  const torch::ScalarType type = type_of(entry.at("dtype").get<std::string>(), where);
  const auto shape = entry.at("shape").get<std::vector<std::int64_t>>();
  const auto offsets = entry.at("data_offsets").get<std::vector<std::uint64_t>>();
  if (offsets.size() != 2 || offsets[0] > offsets[1] || offsets[1] > size) {
    throw CheckpointError(where + " lies outside the file");
  }
  const std::uint64_t bytes = offsets[1] - offsets[0];
  std::uint64_t expected = torch::elementSize(type);
  for (const std::int64_t length : shape) {
    if (length < 0 || (length > 0 && expected > size / static_cast<std::uint64_t>(length))) {
      throw CheckpointError(where + " has a shape that does not fit its data");
    }
    expected *= static_cast<std::uint64_t>(length);
  }
  if (expected != bytes) throw CheckpointError(where + " has a shape that does not fit its data");
  torch::Tensor tensor = torch::empty(shape, type);
  if (bytes > 0) std::memcpy(tensor.data_ptr(), data + offsets[0], bytes);
  return tensor;
}

}  // namespace

std::string encode_safetensors(const NamedTensors& tensors) {
  Json header = Json::object();
  std::uint64_t offset = 0;
  for (const auto& [name, tensor] : tensors) {
    const std::uint64_t bytes = static_cast<std::uint64_t>(tensor.numel()) * tensor.element_size();
    header[name] = {{"dtype", name_of(tensor.scalar_type())},
                    {"shape", tensor.sizes().vec()},
                    {"data_offsets", {offset, offset + bytes}}};
    offset += bytes;
  }
  std::string text = header.dump();
  text.resize((text.size() + kLengthBytes - 1) / kLengthBytes * kLengthBytes,
              ' ');  // data stays 8-byte aligned

  std::string content;
  content.reserve(kLengthBytes + text.size() + offset);
  for (std::size_t byte = 0; byte < kLengthBytes; ++byte) {
    content.push_back(static_cast<char>((static_cast<std::uint64_t>(text.size()) >> (8 * byte)) & 0xff));
  }
  content += text;
  for (const auto& [name, tensor] : tensors) {
    const torch::Tensor plain = tensor.detach().cpu().contiguous();
    if (plain.numel() == 0) continue;
    content.append(static_cast<const char*>(plain.data_ptr()),
                   static_cast<std::size_t>(plain.numel()) * plain.element_size());
  }
  return content;
}

NamedTensors decode_safetensors(const std::string& content, const std::string& what) {
  if (content.size() < kLengthBytes) throw CheckpointError(what + " is truncated: it has no header");
  std::uint64_t length = 0;
  for (std::size_t byte = 0; byte < kLengthBytes; ++byte) {
    length |= static_cast<std::uint64_t>(static_cast<unsigned char>(content[byte])) << (8 * byte);
  }
  if (length > kLargestHeader || length > content.size() - kLengthBytes) {
    throw CheckpointError(what + " is truncated or no safetensors file: its header says " +
                          std::to_string(length) + " bytes, the file holds " +
                          std::to_string(content.size()));
  }
  const char* data = content.data() + kLengthBytes + length;
  const std::uint64_t size = content.size() - kLengthBytes - length;
  NamedTensors tensors;
  try {
    const Json header = Json::parse(content.begin() + kLengthBytes,
                                    content.begin() + static_cast<std::ptrdiff_t>(kLengthBytes + length));
    for (const auto& [name, entry] : header.items()) {
      if (name == "__metadata__") continue;
      tensors[name] = decode_tensor(name, entry, data, size, what);
    }
  } catch (const Json::exception& error) {
    throw CheckpointError(what + " has a malformed header: " + error.what());
  }
  return tensors;
}

}  // namespace lodestone::nets
