#include "lodestone/common/artefact.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"

namespace lodestone::common {
namespace {

constexpr std::size_t kLargestArtefact = 1 << 30;  // bytes; trials with their trajectories

}  // namespace

ArtefactReader::ArtefactReader(const Json& object, std::string source, std::string prefix)
    : object_(object), source_(std::move(source)), prefix_(std::move(prefix)) {
  if (object_.is_object()) return;
  if (object_.is_null() && prefix_.empty())
    throw DataError(source_ + " does not exist; run the step that writes it");
  fail(prefix_.empty() ? "it" : prefix_.substr(0, prefix_.size() - 1), "must be a JSON object {...}");
}

const Json* ArtefactReader::find(const char* key) const {
  const auto found = object_.find(key);
  return found == object_.end() || found->is_null() ? nullptr : &*found;
}

void ArtefactReader::fail(const std::string& key, const std::string& what) const {
  throw DataError(source_ + ": " + key + " " + what +
                  "; the file is damaged or of another version: run the step that writes it again");
}

void ArtefactReader::read_key(const std::string& name, const std::string& key, int& place) const {
  const char* end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data(), end, place);
  if (error != std::errc() || stop != end) fail(key + "." + name, "must be named by a whole number");
}

double ArtefactReader::number(const Json& json, const std::string& key) const {
  if (json.is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (!json.is_number()) fail(key, "= " + shown_json(json) + " must be a number");
  return json.get<double>();
}

std::int64_t ArtefactReader::whole_number(const Json& json, const std::string& key, std::int64_t least,
                                          std::uint64_t most) const {
  const bool whole =
      json.is_number_integer() || (json.is_number_float() && std::abs(json.get<double>()) < 9e15 &&
                                   std::floor(json.get<double>()) == json.get<double>());
  const bool too_large = json.is_number_unsigned() && json.get<std::uint64_t>() > most;
  if (!whole || too_large) fail(key, "= " + shown_json(json) + " must be a whole number");
  const auto value = json.get<std::int64_t>();
  if (!json.is_number_unsigned() &&
      (value < least || (value > 0 && static_cast<std::uint64_t>(value) > most)))
    fail(key, "= " + shown_json(json) + " must be a whole number within its range");
  return value;
}

Json read_json_if_there(const std::string& path) {
  if (!std::filesystem::exists(path)) return nullptr;
  try {
    return parse_json(read_file(path, kLargestArtefact), path);
  } catch (const DataError& error) {
    throw DataError(std::string(error.what()) + "; the file is damaged: run the step that writes it again");
  }
}

void write_json(const std::string& path, const Json& json) {
  write_file_atomically(path, json.dump(1) + "\n");
}

}  // namespace lodestone::common
