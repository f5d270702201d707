#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "lodestone/common/config.h"

namespace lodestone::common {

// An artefact is what a run leaves behind: an aggregate with one template that visits its keys, so that the
// code that writes a result is the code that reads it.
//
//   struct Score {
//     double mean_mm = 0.0;
//     std::optional<double> hold_mm;  // what was not measured is absent
//     template <class Visitor>
//     void visit(Visitor& v) {
//       v.field("mean_mm", mean_mm);
//       v.field("hold_mm", hold_mm);
//     }
//   };
//
// A field is a number, text, a bool, Json, an artefact, or an optional, vector or map (by text or whole
// number) of these. v.part("mean_mm", score) puts the keys of an optional artefact among those of the whole:
// it is there when the named one of its keys is. v.entry("centre", by_task) visits one key of a map that may
// hold it.

class ArtefactWriter;
class ArtefactReader;

namespace detail {
template <class T, class = void>
struct IsArtefact : std::false_type {};
template <class T>
struct IsArtefact<T, std::void_t<decltype(std::declval<T&>().visit(std::declval<ArtefactWriter&>()))>>
    : std::true_type {};
template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T>
struct IsMap : std::false_type {};
template <class K, class T>
struct IsMap<std::map<K, T>> : std::true_type {};
inline std::string key_text(const std::string& key) { return key; }
inline std::string key_text(int key) { return std::to_string(key); }
}  // namespace detail

/// Writes an artefact as a JSON object. Optional fields without a value are left out.
class ArtefactWriter {
 public:
  template <class T>
  void field(const char* key, T& value) {
    if constexpr (detail::IsOptional<T>::value) {
      if (value) json_[key] = to_json(*value);
    } else {
      json_[key] = to_json(value);
    }
  }
  template <class T>
  void part(const char* /*key*/, std::optional<T>& value) {
    if (value) value->visit(*this);
  }
  template <class T>
  void entry(const char* key, std::map<std::string, T>& values) {
    const auto found = values.find(key);
    if (found != values.end()) json_[key] = to_json(found->second);
  }
  Json take() { return std::move(json_); }

  template <class T>
  static Json to_json(T& value) {
    if constexpr (detail::IsArtefact<T>::value) {
      ArtefactWriter writer;
      value.visit(writer);
      return writer.take();
    } else if constexpr (detail::IsOptional<T>::value) {
      return value ? to_json(*value) : Json(nullptr);  // in a list, a place is kept
    } else if constexpr (detail::IsVector<T>::value) {
      Json list = Json::array();
      for (auto&& item : value) list.push_back(to_json(item));
      return list;
    } else if constexpr (detail::IsMap<T>::value) {
      Json object = Json::object();
      for (auto& [key, item] : value) object[detail::key_text(key)] = to_json(item);
      return object;
    } else {
      return Json(value);
    }
  }

 private:
  Json json_ = Json::object();
};

/// Reads an artefact. A key that is missing or of another type throws DataError that names it and `source`;
/// an optional one may be missing or null. Keys that nobody asks for are no fault.
class ArtefactReader {
 public:
  ArtefactReader(const Json& object, std::string source, std::string prefix = "");

  template <class T>
  void field(const char* key, T& value) {
    const Json* found = find(key);
    if constexpr (detail::IsOptional<T>::value) {
      value.reset();
      if (found != nullptr) read(*found, prefix_ + key, value.emplace());
    } else {
      if (found == nullptr && !object_.contains(key)) fail(prefix_ + key, "is missing");
      read(object_.at(key), prefix_ + key, value);
    }
  }
  template <class T>
  void part(const char* key, std::optional<T>& value) {
    value.reset();
    if (find(key) != nullptr) value.emplace().visit(*this);
  }
  template <class T>
  void entry(const char* key, std::map<std::string, T>& values) {
    if (const Json* found = find(key)) read(*found, prefix_ + key, values[key]);
  }

 private:
  const Json* find(const char* key) const;  ///< nullptr when absent or null
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

  template <class T>
  void read(const Json& json, const std::string& key, T& value) const {
    if constexpr (detail::IsArtefact<T>::value) {
      ArtefactReader reader(json, source_, key + ".");
      value.visit(reader);
    } else if constexpr (detail::IsOptional<T>::value) {
      value.reset();
      if (!json.is_null()) read(json, key, value.emplace());
    } else if constexpr (detail::IsVector<T>::value) {
      if (!json.is_array()) fail(key, "must be a list");
      value.clear();
      value.reserve(json.size());
      for (const Json& item : json) read(item, key, value.emplace_back());
    } else if constexpr (detail::IsMap<T>::value) {
      if (!json.is_object()) fail(key, "must be an object");
      value.clear();
      for (const auto& [name, item] : json.items()) {
        typename T::key_type place{};
        read_key(name, key, place);
        read(item, key + "." + name, value[place]);
      }
    } else if constexpr (std::is_floating_point_v<T>) {
      value = number(json, key);
    } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
      value = static_cast<T>(
          whole_number(json, key, std::numeric_limits<T>::min(), std::numeric_limits<T>::max()));
    } else {
      try {
        value = json.get<T>();
      } catch (const nlohmann::json::exception& error) {
        fail(key, error.what());
      }
    }
  }
  static void read_key(const std::string& name, const std::string& /*key*/, std::string& place) {
    place = name;
  }
  void read_key(const std::string& name, const std::string& key, int& place) const;
  /// A number that was not finite is written as null, and read as NaN.
  double number(const Json& json, const std::string& key) const;
  std::int64_t whole_number(const Json& json, const std::string& key, std::int64_t least,
                            std::uint64_t most) const;

  const Json& object_;
  std::string source_;
  std::string prefix_;
};

template <class T>
Json artefact_to_json(T value) {
  return ArtefactWriter::to_json(value);
}

/// Throws DataError naming `source` and the key that cannot be read. An artefact may also have `void
/// validate() const`.
template <class T>
T artefact_from_json(const Json& json, const std::string& source) {
  T value{};
  ArtefactReader reader(json, source);
  value.visit(reader);
  try {
    detail::validate(value, 0);
  } catch (const DataError& error) {
    throw DataError(source + ": " + error.what());
  }
  return value;
}

/// The JSON of a file; null where there is no such file. Throws DataError when it is damaged.
Json read_json_if_there(const std::string& path);
/// Atomically. Throws IoError.
void write_json(const std::string& path, const Json& json);

template <class T>
void write_artefact(const std::string& path, const T& value) {
  write_json(path, artefact_to_json(value));
}

/// The artefact of a file; nothing where there is no such file.
template <class T>
std::optional<T> find_artefact(const std::string& path) {
  const Json json = read_json_if_there(path);
  if (json.is_null()) return std::nullopt;
  return artefact_from_json<T>(json, path);
}

/// Throws DataError where there is no such file, too.
template <class T>
T read_artefact(const std::string& path) {
  return artefact_from_json<T>(read_json_if_there(path), path);
}

}  // namespace lodestone::common
