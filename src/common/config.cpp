#include "lodestone/common/config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "lodestone/common/files.h"
#include "lodestone/common/spelling.h"

namespace lodestone::common {
namespace {

std::string bounds_text(const Bounds& bounds) {
  if (std::isinf(bounds.min) && std::isinf(bounds.max)) return "";
  if (std::isinf(bounds.max)) return fmt::format(">= {:g}", bounds.min);
  if (std::isinf(bounds.min)) return fmt::format("<= {:g}", bounds.max);
  return fmt::format("{:g} .. {:g}", bounds.min, bounds.max);
}

}  // namespace

std::string ConfigSources::given(const std::string& path) const {
  if (!by_path_) return "";
  const auto found = by_path_->find(path);
  return found == by_path_->end() ? "" : found->second;
}

std::string ConfigSources::of(const std::string& path) const {
  if (!by_path_) return name_;
  const std::string below = path + ".";
  for (const auto& [key, source] : *by_path_)
    if (key == path || key.compare(0, below.size(), below) == 0) return source;
  return name_;
}

ConfigReader::ConfigReader(const Json& object, ConfigSources sources, std::string prefix)
    : object_(object), sources_(std::move(sources)), prefix_(std::move(prefix)) {
  if (!object_.is_object()) {
    const std::string name = prefix_.empty() ? "the configuration" : prefix_.substr(0, prefix_.size() - 1);
    throw ConfigError(sources_.of(prefix_.empty() ? prefix_ : name) + ": " + name + " = " + object_.dump() +
                      " must be a JSON object {...}");
  }
}

const Json* ConfigReader::find(const char* key) {
  known_.insert(key);
  const auto found = object_.find(key);
  return found == object_.end() ? nullptr : &*found;
}

void ConfigReader::fail(const std::string& key, const Json& value, const std::string& expectation) const {
  throw ConfigError(sources_.of(prefix_ + key) + ": " + prefix_ + key + " = " + value.dump() + " must be " +
                    expectation);
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
  throw ConfigError(sources_.of(prefix_ + key) + ": " + prefix_ + key + " = " + found->dump() +
                    " is no longer a key: use " + successor);
}

void ConfigReader::finish() const {
  for (const auto& [key, value] : object_.items()) {
    if (known_.count(key) != 0) continue;
    const std::string hint = spelling_hint(key, {known_.begin(), known_.end()}, "known keys", prefix_);
    throw ConfigError(sources_.of(prefix_ + key) + ": unknown key " + prefix_ + key + " = " + value.dump() +
                      "; " + hint);
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

Json read_json_file(const std::string& path) {
  if (!std::filesystem::is_regular_file(path))
    throw ConfigError("configuration file " + path +
                      " does not exist: check the path, or list presets under configs/");
  const std::string text = read_file(path);
  try {
    return Json::parse(text, nullptr, true, true);
  } catch (const Json::parse_error& error) {
    const auto end = text.begin() +
                     static_cast<std::ptrdiff_t>(std::min(error.byte > 0 ? error.byte - 1 : 0, text.size()));
    const auto line = 1 + std::count(text.begin(), end, '\n');
    const auto last_break = std::find(std::make_reverse_iterator(end), text.rend(), '\n');
    const auto column = 1 + std::distance(last_break.base(), end);
    std::string what = error.what();
    const std::size_t colon = what.rfind("; ");
    throw ConfigError(path + ":" + std::to_string(line) + ":" + std::to_string(column) +
                      ": not JSON: " + (colon == std::string::npos ? what : what.substr(colon + 2)));
  }
}

void apply_override(Json& config, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw ConfigError("--set " + assignment + " must have the form key.subkey=value");
  const std::string path = assignment.substr(0, equals);
  const std::string text = assignment.substr(equals + 1);
  Json value = Json::parse(text, nullptr, false);
  if (value.is_discarded()) value = text;
  Json* node = &config;
  std::istringstream steps(path);
  for (std::string step; std::getline(steps, step, '.');) {
    if (step.empty()) throw ConfigError("--set " + assignment + " has an empty step in its key");
    if (node->is_null()) *node = Json::object();
    if (!node->is_object())
      throw ConfigError("--set " + assignment + ": " + step + " lies below a key that is no object");
    node = &(*node)[step];
  }
  *node = value;
}

}  // namespace lodestone::common
