// The safetensors format: 8-byte little-endian header length, JSON header, raw little-endian tensor data.
// Source: https://github.com/huggingface/safetensors (README, "Format").
#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>
#include <memory>

#include "lodestone/common/error.h"
#include "lodestone/common/shown.h"
#include "lodestone/inference/checkpoint.h"

namespace lodestone::inference {
namespace {

using common::CheckpointError;
using common::Json;

constexpr std::size_t kLengthBytes = 8;
constexpr std::uint64_t kLargestHeader = 16 << 20;  // bytes: it names some hundred arrays
constexpr std::size_t kMostDimensions = 8;

struct NamedType {
  const char* name;
  ElementType type;
};
constexpr NamedType kTypes[] = {{"F32", ElementType::kFloat32},
                                {"F64", ElementType::kFloat64},
                                {"I64", ElementType::kInt64},
                                {"U8", ElementType::kUint8}};

const char* safetensors_name(ElementType type) {
  const auto* found = std::find_if(std::begin(kTypes), std::end(kTypes),
                                   [type](const NamedType& t) { return t.type == type; });
  return found->name;
}

ElementType type_of(const std::string& name, const std::string& what) {
  for (const NamedType& named : kTypes) {
    if (name == named.name) return named.type;
  }
  throw CheckpointError(what + ": element type \"" + common::shown(name) +
                        "\" is not one of F32, F64, I64, U8");
}

/// A list of whole numbers from 0 up; nlohmann-json would convert others.
template <class Number>
std::vector<Number> whole_numbers(const Json& list, std::size_t most, const std::string& where) {
  const auto fits = [](const Json& item) {
    return item.is_number_unsigned() &&
           item.get<std::uint64_t>() <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  };
  if (!list.is_array() || list.size() > most || !std::all_of(list.begin(), list.end(), fits))
    throw CheckpointError(where + ": " + common::shown_json(list) + " is no list of at most " +
                          std::to_string(most) + " whole numbers");
  return list.get<std::vector<Number>>();
}

Array decode_array(const std::string& name, const Json& entry, const char* data, std::uint64_t size,
                   const std::string& what) {
  const std::string where = what + ": array \"" + common::shown(name) + "\"";
  const ElementType type = type_of(entry.at("dtype").get<std::string>(), where);
  auto shape = whole_numbers<std::int64_t>(entry.at("shape"), kMostDimensions, where + ", shape");
  const auto offsets = whole_numbers<std::uint64_t>(entry.at("data_offsets"), 2, where + ", data_offsets");
  if (offsets.size() != 2 || offsets[0] > offsets[1] || offsets[1] > size) {
    throw CheckpointError(where + " lies outside the file");
  }
  const std::uint64_t bytes = offsets[1] - offsets[0];
  std::uint64_t expected = element_size(type);
  for (const std::int64_t length : shape) {
    if (length > 0 && expected > size / static_cast<std::uint64_t>(length)) {
      throw CheckpointError(where + " has a shape that does not fit its data");
    }
    expected *= static_cast<std::uint64_t>(length);
  }
  if (expected != bytes) throw CheckpointError(where + " has a shape that does not fit its data");
  // Copied out of the file, where numbers need not be aligned.
  const auto words = std::make_shared<std::vector<std::uint64_t>>(bytes / sizeof(std::uint64_t) + 1);
  if (bytes > 0) std::memcpy(words->data(), data + offsets[0], bytes);
  return Array(type, std::move(shape), std::shared_ptr<const void>(words, words->data()));
}

}  // namespace

std::string encode_safetensors(const Arrays& arrays) {
  Json header = Json::object();
  std::uint64_t offset = 0;
  for (const auto& [name, array] : arrays) {
    const std::uint64_t bytes = array.bytes();
    header[name] = {{"dtype", safetensors_name(array.type())},
                    {"shape", array.shape()},
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
  for (const auto& [name, array] : arrays) {
    if (array.bytes() > 0) content.append(static_cast<const char*>(array.owner().get()), array.bytes());
  }
  return content;
}

Arrays decode_safetensors(const std::string& content, const std::string& what) {
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
  Arrays arrays;
  std::uint64_t bytes = 0;
  try {
    const Json header = common::parse_json(std::string_view(content).substr(kLengthBytes, length), "header");
    if (!header.is_object()) throw CheckpointError(what + " has a malformed header: it is no JSON object");
    for (const auto& [name, entry] : header.items()) {
      if (name == "__metadata__") continue;
      const Array& array = arrays[name] = decode_array(name, entry, data, size, what);
      bytes += array.bytes();
      // Otherwise a small file could hold the same numbers a thousand times.
      if (bytes > size) throw CheckpointError(what + ": its arrays overlap");
    }
  } catch (const Json::exception& error) {
    throw CheckpointError(what + " has a malformed header: " + error.what());
  } catch (const common::DataError& error) {
    throw CheckpointError(what + " has a malformed header: " + error.what());
  }
  return arrays;
}

}  // namespace lodestone::inference
