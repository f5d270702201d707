#include "lodestone/common/config.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "lodestone/common/files.h"
#include "lodestone/common/shown.h"
#include "lodestone/common/spelling.h"

namespace lodestone::common {
namespace {

constexpr std::ptrdiff_t kDeepestKey = 32;  // steps of a dotted path

std::string bounds_text(const Bounds& bounds) {
  if (std::isinf(bounds.min) && std::isinf(bounds.max)) return "";
  if (std::isinf(bounds.max)) return fmt::format(">= {:g}", bounds.min);
  if (std::isinf(bounds.min)) return fmt::format("<= {:g}", bounds.max);
  return fmt::format("{:g} .. {:g}", bounds.min, bounds.max);
}

}  // namespace

/// A list comes from one place, with all that is in it.
std::string ConfigSources::given(const std::string& path) const {
  if (!by_path_) return "";
  const auto found = by_path_->find(path.substr(0, path.find('[')));
  return found == by_path_->end() ? "" : found->second;
}

std::string ConfigSources::of(const std::string& path) const {
  if (!by_path_) return name_;
  if (path.find('[') != std::string::npos) return of(path.substr(0, path.find('[')));
  const std::string below = path + ".";
  for (const auto& [key, source] : *by_path_)
    if (key == path || key.compare(0, below.size(), below) == 0) return source;
  return name_;
}

ConfigReader::ConfigReader(const Json& object, ConfigSources sources, std::string prefix)
    : object_(object), sources_(std::move(sources)), prefix_(std::move(prefix)) {
  if (!object_.is_object()) {
    const std::string name = prefix_.empty() ? "the configuration" : prefix_.substr(0, prefix_.size() - 1);
    throw ConfigError(sources_.of(prefix_.empty() ? prefix_ : name) + ": " + name + " = " +
                      shown_json(object_) + " must be a JSON object {...}");
  }
}

const Json* ConfigReader::find(const char* key) {
  known_.insert(key);
  const auto found = object_.find(key);
  return found == object_.end() ? nullptr : &*found;
}

void ConfigReader::fail(const std::string& key, const Json& value, const std::string& expectation) const {
  throw ConfigError(sources_.of(prefix_ + key) + ": " + prefix_ + key + " = " + shown_json(value) +
                    " must be " + expectation);
}

void ConfigReader::refuse(const InvalidConfig& error) const {
  std::string source = sources_.given(prefix_ + error.key());
  if (source.empty()) source = sources_.of(prefix_.substr(0, prefix_.rfind('.')));
  throw ConfigError(source + ": " + prefix_ + error.what());
}

double ConfigReader::number(const char* key, const Json& whole, const Json& item,
                            const std::string& expectation, const Bounds& bounds) const {
  if (!item.is_number()) fail(key, whole, expectation);
  const double value = item.get<double>();
  if (!std::isfinite(value)) fail(key, whole, "a finite number");
  if (value < bounds.min || value > bounds.max) fail(key, whole, "within " + bounds_text(bounds));
  return value;
}

std::int64_t ConfigReader::whole_number(const char* key, const Json& whole, const Json& item,
                                        const std::string& expectation, const Bounds& bounds) const {
  if (item.is_number_float()) {
    const double value = item.get<double>();
    if (!(std::abs(value) < 9e15 && std::floor(value) == value)) fail(key, whole, expectation);
  }
  constexpr auto kLargest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (item.is_number_unsigned() && item.get<std::uint64_t>() > kLargest)
    fail(key, whole, "a whole number of at most " + std::to_string(kLargest));
  const double value = number(key, whole, item, expectation, bounds);
  return item.is_number_integer() ? item.get<std::int64_t>() : static_cast<std::int64_t>(value);
}

void ConfigReader::field(const char* key, double& value, const char* unit, const char*, Bounds bounds) {
  const std::string expectation = *unit == '\0' ? "a number" : std::string("a number in ") + unit;
  if (const Json* json = find(key)) value = number(key, *json, *json, expectation, bounds);
}

void ConfigReader::field(const char* key, std::int64_t& value, const char*, const char*, Bounds bounds) {
  if (const Json* json = find(key)) value = whole_number(key, *json, *json, "a whole number", bounds);
}

void ConfigReader::field(const char* key, bool& value, const char*, const char*) {
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_boolean()) fail(key, *json, "true or false");
  value = json->get<bool>();
}

void ConfigReader::field(const char* key, std::string& value, const char*, const char*, Choices choices) {
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_string()) fail(key, *json, "text");
  const std::string text = json->get<std::string>();
  if (!choices.empty() && std::find(choices.begin(), choices.end(), text) == choices.end())
    fail(key, *json, "one of " + joined(choices));
  value = text;
}

void ConfigReader::field(const char* key, std::vector<double>& value, const char*, const char*,
                         Bounds bounds) {
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_array()) fail(key, *json, "a list of numbers");
  value.clear();
  for (const Json& item : *json) value.push_back(number(key, *json, item, "a list of numbers", bounds));
}

void ConfigReader::field(const char* key, std::vector<std::int64_t>& value, const char*, const char*,
                         Bounds bounds) {
  const Json* json = find(key);
  if (json == nullptr) return;
  const char* const expectation = "a list of whole numbers";
  if (!json->is_array()) fail(key, *json, expectation);
  value.clear();
  for (const Json& item : *json) value.push_back(whole_number(key, *json, item, expectation, bounds));
}

void ConfigReader::field(const char* key, std::vector<std::string>& value, const char*, const char*) {
  const Json* json = find(key);
  if (json == nullptr) return;
  const auto is_text = [](const Json& item) { return item.is_string(); };
  if (!json->is_array() || !std::all_of(json->begin(), json->end(), is_text))
    fail(key, *json, "a list of texts");
  value = json->get<std::vector<std::string>>();
}

void ConfigReader::field(const char* key, Range& value, const char*, const char*, Bounds bounds) {
  const Json* json = find(key);
  if (json == nullptr) return;
  const char* const expectation = "[low, high] with low <= high";
  if (!json->is_array() || json->size() != 2) fail(key, *json, expectation);
  value.low = number(key, *json, json->at(0), expectation, bounds);
  value.high = number(key, *json, json->at(1), expectation, bounds);
  if (value.low > value.high) fail(key, *json, expectation);
}

void ConfigReader::retired(const char* key, const char* successor) const {
  const auto found = object_.find(key);
  if (found == object_.end()) return;
  throw ConfigError(sources_.of(prefix_ + key) + ": " + prefix_ + key + " = " + shown_json(*found) +
                    " is no longer a key: use " + successor);
}

void ConfigReader::finish() const {
  for (const auto& [key, value] : object_.items()) {
    if (known_.count(key) != 0) continue;
    const std::string hint = spelling_hint(key, {known_.begin(), known_.end()}, "known keys", prefix_);
    throw ConfigError(sources_.of(prefix_ + key) + ": unknown key " + shown(prefix_ + key) + " = " +
                      shown_json(value) + "; " + hint);
  }
}

void ConfigDescriber::add(const char* key, Json value, const char* unit, const char* meaning,
                          const Bounds& bounds) {
  const std::string within = value.is_boolean() ? "true | false" : bounds_text(bounds);
  rows_.push_back({prefix_ + key, std::move(value), unit, within, meaning, sources_.given(prefix_ + key)});
}

void ConfigDescriber::field(const char* key, const std::string& value, const char* unit, const char* meaning,
                            Choices choices) {
  add(key, value, unit, meaning, {});
  rows_.back().bounds = joined(choices, " | ");
}

Json config_to_json(const std::vector<ConfigRow>& rows) {
  Json json = Json::object();
  for (const ConfigRow& row : rows) {
    Json* node = &json;
    std::istringstream path(row.key);
    for (std::string step; std::getline(path, step, '.');) node = &(*node)[step];
    *node = row.value;
  }
  return json;
}

Json read_json_file(const std::string& path, std::size_t largest_bytes) {
  if (!std::filesystem::exists(path))
    throw ConfigError("configuration file " + path +
                      " does not exist: check the path, or list presets under configs/");
  try {
    return parse_json(read_file(path, largest_bytes), path, JsonComments::kAllowed);
  } catch (const DataError& error) {
    throw ConfigError(error.what());
  } catch (const IoError& error) {
    throw ConfigError(std::string("configuration file: ") + error.what());
  }
}

void apply_override(Json& config, const std::string& assignment) {
  const std::string what = "--set " + shown(assignment);
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw ConfigError(what + " must have the form key.subkey=value");
  const std::string path = assignment.substr(0, equals);
  if (std::count(path.begin(), path.end(), '.') >= kDeepestKey)
    throw ConfigError(what + " names a key of more than " + std::to_string(kDeepestKey) + " steps");
  const std::string text = assignment.substr(equals + 1);
  const Json value = find_json(text).value_or(Json(text));
  Json* node = &config;
  std::istringstream steps(path);
  for (std::string step; std::getline(steps, step, '.');) {
    if (step.empty()) throw ConfigError(what + " has an empty step in its key");
    if (node->is_null()) *node = Json::object();
    if (!node->is_object())
      throw ConfigError(what + ": " + shown(step) + " lies below a key that is no object");
    node = &(*node)[step];
  }
  *node = value;
}

}  // namespace lodestone::common
