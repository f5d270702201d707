#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/json.h"
#include "lodestone/common/named.h"
#include "lodestone/common/range.h"

namespace lodestone::common {

/// Closed interval a number must lie in.
struct Bounds {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// The words a text key may hold; empty means any text.
using Choices = std::vector<std::string>;

/// Which file or option each value of a configuration came from.
class ConfigSources {
 public:
  /// Everything came from `name`.
  ConfigSources(std::string name) : name_(std::move(name)) {}
  ConfigSources(const char* name) : name_(name) {}
  /// `by_path`: source of each value that was given, by its dotted path; `name` stands for the rest.
  ConfigSources(std::string name, std::map<std::string, std::string> by_path)
      : name_(std::move(name)),
        by_path_(std::make_shared<const std::map<std::string, std::string>>(std::move(by_path))) {}

  /// Of the value at a dotted path, or of the first one below it.
  std::string of(const std::string& path) const;
  /// Empty where the value was not given.
  std::string given(const std::string& path) const;

 private:
  std::string name_;
  std::shared_ptr<const std::map<std::string, std::string>> by_path_;
};

// A configuration is an aggregate with defaults and one template that visits its keys:
//
//   struct DishConfig {
//     double radius_m = 0.0425;
//     template <class Visitor>
//     void visit(Visitor& v) {
//       v.field("radius_m", radius_m, "m", "inner radius of the dish", {0.005, 0.5});
//     }
//   };
//
// The same visit() reads JSON (ConfigReader), and writes and documents it (ConfigDescriber). A field is a
// number, a bool, text, a Range, a list of numbers or texts, or an enum with names (common/named.h).
// Nested configurations are visited with v.group("dish", dish, "the dish"), lists of them with
// v.list("each", each, Coil{}, "every coil").
// A key that is no longer known is refused with where it went: v.retired("radius", "radius_m").
// A configuration may also have `void validate() const`, which throws InvalidConfig where values do not fit
// together; it runs after reading, for nested ones, too.

/// Values of a configuration that do not fit together. Whoever reads it puts the file or option and the path
/// of the configuration before the key.
class InvalidConfig : public ConfigError {
 public:
  /// `key` of this configuration (or "below.it"), its value and what it "must ...".
  InvalidConfig(std::string key, const Json& value, const std::string& must)
      : ConfigError(key + " = " + shown_json(value) + " must " + must), key_(std::move(key)) {}
  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

namespace detail {
template <class Config>
auto validate(const Config& config, int) -> decltype(config.validate(), void()) {
  config.validate();
}
template <class Config>
void validate(const Config&, long) {}
template <class Value>
using IfEnum = std::enable_if_t<std::is_enum_v<Value>>;
template <class Value>
using IfPlain = std::enable_if_t<!std::is_enum_v<Value>>;
}  // namespace detail

/// Reads one JSON object strictly: an unknown key, a wrong type or a value out of bounds throws ConfigError
/// naming source, key, value and bound. Keys that are absent keep their default.
class ConfigReader {
 public:
  ConfigReader(const Json& object, ConfigSources sources, std::string prefix = "");

  void field(const char* key, double& value, const char* unit, const char* meaning, Bounds bounds = {});
  void field(const char* key, std::int64_t& value, const char* unit, const char* meaning, Bounds bounds = {});
  void field(const char* key, bool& value, const char* unit, const char* meaning);
  void field(const char* key, std::string& value, const char* unit, const char* meaning,
             Choices choices = {});
  void field(const char* key, std::vector<double>& value, const char* unit, const char* meaning,
             Bounds bounds = {});
  void field(const char* key, std::vector<std::int64_t>& value, const char* unit, const char* meaning,
             Bounds bounds = {});
  void field(const char* key, std::vector<std::string>& value, const char* unit, const char* meaning);
  /// [low, high] with low <= high, both within `bounds`.
  void field(const char* key, Range& value, const char* unit, const char* meaning, Bounds bounds = {});

  template <class Kind, class = detail::IfEnum<Kind>>
  void field(const char* key, Kind& value, const char* unit, const char* meaning) {
    std::string name = name_of(value);
    field(key, name, unit, meaning, names_of(value));
    value = *find_named<Kind>(name);
  }

  template <class Config>
  void group(const char* key, Config& value, const char* /*meaning*/) {
    known_.insert(key);
    const auto found = object_.find(key);
    static const Json kNothing = Json::object();
    ConfigReader(found == object_.end() ? kNothing : *found, sources_, prefix_ + key + ".").read(value);
  }

  /// Keys that an item does not have are as in `plain`. In messages the first is key[0].
  template <class Config>
  void list(const char* key, std::vector<Config>& value, const Config& plain, const char* /*meaning*/) {
    const Json* json = find(key);
    if (json == nullptr) return;
    if (!json->is_array()) fail(key, *json, "a list of objects [{...}, ...]");
    value.assign(json->size(), plain);
    for (std::size_t i = 0; i < value.size(); ++i)
      ConfigReader((*json)[i], sources_, prefix_ + key + "[" + std::to_string(i) + "].").read(value[i]);
  }

  /// All of a configuration: its keys, none but these, and that its values fit together.
  template <class Config>
  void read(Config& value) {
    value.visit(*this);
    finish();
    try {
      detail::validate(value, 0);
    } catch (const InvalidConfig& error) {
      refuse(error);
    }
  }

  /// A key of earlier versions. Throws ConfigError that says what took its place.
  void retired(const char* key, const char* successor) const;

 private:
  const Json* find(const char* key);
  /// Throws ConfigError when the object holds a key that no field() or group() asked for.
  void finish() const;
  [[noreturn]] void refuse(const InvalidConfig& error) const;
  [[noreturn]] void fail(const std::string& key, const Json& value, const std::string& expectation) const;
  double number(const char* key, const Json& whole, const Json& item, const std::string& expectation,
                const Bounds& bounds) const;
  std::int64_t whole_number(const char* key, const Json& whole, const Json& item,
                            const std::string& expectation, const Bounds& bounds) const;

  const Json& object_;
  ConfigSources sources_;
  std::string prefix_;
  std::set<std::string> known_;
};

/// One line of `lodestone config --print`.
struct ConfigRow {
  std::string key;     ///< dotted path
  Json value;          ///< as it is now
  std::string unit;    ///< empty when the key has none
  std::string bounds;  ///< "0.01 .. 2" or "adam | sgd", empty when free
  std::string meaning;
  std::string source;  ///< file or option that gave the value; empty: the default
};

/// Lists every key of a configuration with its present value, unit, bounds and meaning.
class ConfigDescriber {
 public:
  explicit ConfigDescriber(ConfigSources sources = "", std::string prefix = "")
      : sources_(std::move(sources)), prefix_(std::move(prefix)) {}

  template <class Value, class = detail::IfPlain<Value>>
  void field(const char* key, const Value& value, const char* unit, const char* meaning, Bounds bounds = {}) {
    add(key, value, unit, meaning, bounds);
  }
  void field(const char* key, const std::string& value, const char* unit, const char* meaning,
             Choices choices = {});
  void field(const char* key, const Range& value, const char* unit, const char* meaning, Bounds bounds = {}) {
    add(key, {value.low, value.high}, unit, meaning, bounds);
  }
  template <class Kind, class = detail::IfEnum<Kind>>
  void field(const char* key, const Kind& value, const char* unit, const char* meaning) {
    field(key, name_of(value), unit, meaning, names_of(value));
  }
  template <class Config>
  void group(const char* key, Config& value, const char* /*meaning*/) {
    ConfigDescriber nested(sources_, prefix_ + key + ".");
    value.visit(nested);
    for (ConfigRow& row : nested.rows_) rows_.push_back(std::move(row));
  }
  /// One row: the items' own keys are in its value.
  template <class Config>
  void list(const char* key, const std::vector<Config>& value, const Config& /*plain*/, const char* meaning);
  void retired(const char* /*key*/, const char* /*successor*/) {}
  const std::vector<ConfigRow>& rows() const { return rows_; }

 private:
  void add(const char* key, Json value, const char* unit, const char* meaning, const Bounds& bounds);

  ConfigSources sources_;
  std::string prefix_;
  std::vector<ConfigRow> rows_;
};

constexpr std::size_t kLargestConfig = 4 << 20;  ///< bytes of a file

/// Reads a JSON file (comments allowed). Throws ConfigError, with line and column where it is malformed, and
/// when it is missing or too large.
Json read_json_file(const std::string& path, std::size_t largest_bytes = kLargestConfig);

/// Applies one "a.b.c=value" to `config`. The value is read as JSON, and as text when it is not JSON.
/// Throws ConfigError when there is no '=' or a step of the path is not an object.
void apply_override(Json& config, const std::string& assignment);

/// Reads `json` over `config`; `sources` names where it comes from in messages (a file name).
template <class Config>
Config config_from_json(const Json& json, const ConfigSources& sources, Config config) {
  ConfigReader(json, sources).read(config);
  return config;
}
/// Over the defaults of `Config`.
template <class Config>
Config config_from_json(const Json& json, const ConfigSources& sources) {
  Config config{};
  ConfigReader(json, sources).read(config);
  return config;
}

template <class Config>
std::vector<ConfigRow> describe_config(Config config = Config{}, const ConfigSources& sources = "") {
  ConfigDescriber describer(sources);
  config.visit(describer);
  return describer.rows();
}

/// The values of described keys as one JSON object.
Json config_to_json(const std::vector<ConfigRow>& rows);

/// Every key included.
template <class Config>
Json config_to_json(const Config& config) {
  return config_to_json(describe_config<Config>(config));
}

template <class Config>
void ConfigDescriber::list(const char* key, const std::vector<Config>& value, const Config& /*plain*/,
                           const char* meaning) {
  Json items = Json::array();
  for (const Config& item : value) items.push_back(config_to_json(item));
  add(key, std::move(items), "", meaning, {});
}

}  // namespace lodestone::common
