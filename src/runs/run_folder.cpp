#include "lodestone/runs/run_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <system_error>
#include <thread>
#include <utility>

#include "lodestone/common/artefact.h"
#include "lodestone/common/build_facts.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/path_digest.h"

namespace lodestone::runs {
namespace {

namespace fs = std::filesystem;
using common::ConfigError;
using common::Json;

constexpr const char* kStateFile = "/run.json";
constexpr const char* kConfigFile = "/config.json";
constexpr const char* kManifestFile = "/manifest.json";
constexpr const char* kInputs = "inputs";  // in the manifest
constexpr const char* kContinued = "continued";
constexpr std::size_t kMostNamed = 8;  // differing keys in a message

constexpr int kTries = 20;  // to lock a folder at which somebody may just be looking
constexpr std::chrono::milliseconds kBetweenTries{10};

int open_folder(const std::string& folder) {
  return ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

/// A lock on a folder: it is free as soon as the process that held it has gone, however it went. -1 where
/// another has it.
int open_locked(const std::string& folder) {
  const int descriptor = open_folder(folder);
  if (descriptor < 0) throw common::IoError("cannot open the folder " + folder);
  for (int tried = 0; tried < kTries; ++tried) {
    if (tried > 0) std::this_thread::sleep_for(kBetweenTries);
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  }
  ::close(descriptor);
  return -1;
}

void flatten(const Json& json, const std::string& prefix, std::map<std::string, std::string>& out) {
  const bool list_of_objects = json.is_array() && !json.empty() && json.front().is_object();
  if (!json.is_object() && !list_of_objects) {
    out[prefix] = json.dump();
    return;
  }
  for (const auto& [key, value] : json.items())
    flatten(value, prefix.empty() ? key : prefix + "." + key, out);
}

/// What a run leaves behind that is killed while it writes its first file.
bool unborn(const fs::path& file) {
  return file.filename().string().rfind(std::string(kStateFile + 1) + ".tmp", 0) == 0;
}

bool holds_nothing(const std::string& folder) {
  return std::all_of(fs::directory_iterator(folder), fs::directory_iterator(),
                     [](const fs::directory_entry& entry) { return unborn(entry.path()); });
}

std::string joined(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < std::min(items.size(), kMostNamed); ++i) text += (i > 0 ? "; " : "") + items[i];
  if (items.size() > kMostNamed) text += "; and " + std::to_string(items.size() - kMostNamed) + " more";
  return text;
}

}  // namespace

std::map<std::string, std::string> values_by_key(const Json& config) {
  std::map<std::string, std::string> values;
  flatten(config, "", values);
  return values;
}

std::vector<std::string> differing_keys(const Json& there, const Json& here,
                                        const std::vector<std::string>& ignored) {
  std::map<std::string, std::string> before = values_by_key(there);
  std::map<std::string, std::string> now = values_by_key(here);
  const auto is_ignored = [&ignored](const std::string& key) {
    return std::any_of(ignored.begin(), ignored.end(), [&key](const std::string& whole) {
      return key.compare(0, whole.size(), whole) == 0 &&
             (key.size() == whole.size() || key[whole.size()] == '.');
    });
  };
  for (auto* values : {&before, &now})
    for (auto value = values->begin(); value != values->end();)
      value = is_ignored(value->first) ? values->erase(value) : std::next(value);
  std::vector<std::string> keys;
  for (const auto& [key, value] : now) {
    const auto found = before.find(key);
    if (found == before.end())
      keys.push_back(key + " = " + value + " (there: absent)");
    else if (found->second != value)
      keys.push_back(key + " = " + value + " (there: " + found->second + ")");
  }
  for (const auto& [key, value] : before)
    if (now.count(key) == 0) keys.push_back(key + " is absent (there: " + value + ")");
  return keys;
}

std::map<std::string, std::string> named_inputs(const Json& config, const std::vector<std::string>& keys) {
  std::map<std::string, std::string> inputs;
  for (const std::string& key : keys) {
    std::string pointer = "/" + key;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    const Json value = config.value(Json::json_pointer(pointer), Json());
    if (value.is_string() && fs::exists(value.get<std::string>())) inputs[key] = value;
  }
  return inputs;
}

std::vector<Json> manifests_of(const Json& manifest) {
  if (!manifest.is_object()) return {};
  std::vector<Json> all{manifest};
  all.front().erase(kContinued);
  if (const auto continued = manifest.find(kContinued); continued != manifest.end() && continued->is_array())
    for (const Json& part : *continued)
      if (part.is_object()) all.push_back(part);
  return all;
}

RunFolder::RunFolder(RunRequest request) : request_(std::move(request)) {
  const std::string& folder = request_.folder;
  if (folder.empty())
    throw ConfigError(request_.verb + ": --out DIR is missing; name the folder to write into");
  state_.verb = request_.verb;
  if (!fs::exists(folder) || (fs::is_directory(folder) && holds_nothing(folder))) return;
  if (!request_.resume)
    throw ConfigError("--out " + folder +
                      " is not empty: name a new folder, or go on with the run in it with --resume");
  lock();
  try {
    find_again();
  } catch (...) {
    ::close(lock_);
    throw;
  }
}

RunFolder::~RunFolder() {
  if (lock_ >= 0) ::close(lock_);
}

void RunFolder::lock() {
  lock_ = open_locked(path());
  if (lock_ < 0)
    throw common::Error(request_.verb + ": another process is working in " + path() +
                        "; wait until it has ended");
}

void RunFolder::find_again() {
  const std::optional<RunState> found = find_run(path());
  if (!found)
    throw ConfigError("--out " + path() +
                      " is not empty and holds no run (no run.json): name another folder");
  if (found->verb != request_.verb)
    throw ConfigError("--resume: " + path() + " holds a run of " + found->verb + ", not of " + request_.verb +
                      "; name its own folder, or a new one");
  const Json there = common::read_json_if_there(path() + kConfigFile);
  if (there.is_null()) return;  // killed while it began
  state_ = *found;
  std::vector<std::string> ignored = request_.free_keys;
  ignored.insert(ignored.end(), request_.length_keys.begin(), request_.length_keys.end());
  const std::vector<std::string> differing = differing_keys(there, request_.config, ignored);
  if (!differing.empty())
    throw ConfigError("--resume: the run in " + path() + " has other settings: " + joined(differing) +
                      "; use the same --config and --set as before, or another --out");
  check_inputs();
  const bool longer = !differing_keys(there, request_.config, request_.free_keys).empty();
  stage_ = state_.finished && !longer ? RunStage::kFinished : RunStage::kResumable;
}

void RunFolder::check_inputs() const {
  const Json manifest = common::read_json_if_there(path() + kManifestFile);
  if (!manifest.contains(kInputs)) return;  // begun by an older version, or without any
  const Json& before = manifest[kInputs];
  for (const auto& [name, input] : request_.inputs) {
    const std::string now = before.contains(name) ? common::path_digest(input) : "";
    if (!now.empty() && now != before[name])
      throw ConfigError("--resume: " + name + ": " + input + " holds something else than when the run in " +
                        path() + " began; give it what it held, or name another --out");
  }
}

void RunFolder::begin() {
  if (begun_) return;
  begun_ = true;
  made_ = !fs::exists(path());
  common::make_folders(path());
  if (lock_ < 0) lock();
  if (stage_ == RunStage::kFresh && holds_nothing(path()))
    for (const auto& entry : fs::directory_iterator(path())) fs::remove(entry.path());
  update(state_);  // first, so that a run that is killed right here is found again
  write_manifest();
  common::write_file_atomically(path() + kConfigFile, request_.config.dump(2) + "\n");
}

void RunFolder::write_manifest() const {
  const std::string file = path() + kManifestFile;
  Json facts = common::build_and_host_facts();
  if (request_.config.contains("threads")) facts["threads"] = request_.config["threads"];
  Json manifest = common::read_json_if_there(file);
  if (stage_ == RunStage::kFresh || !manifest.is_object()) {
    manifest = {{"verb", request_.verb}, {"seed", request_.seed}};
    for (const auto& [name, input] : request_.inputs)
      if (const std::string digest = common::path_digest(input); !digest.empty())
        manifest[kInputs][name] = digest;
    manifest.update(facts);
  } else {
    const Json last = manifests_of(manifest).back();
    const auto differs = [&](const auto& fact) {
      return fact.key() != "time_utc" && last.value(fact.key(), Json()) != fact.value();
    };
    bool elsewhere = false;
    for (auto fact = facts.begin(); fact != facts.end(); ++fact) elsewhere = elsewhere || differs(fact);
    if (!elsewhere) return;
    if (!manifest.contains(kContinued) || !manifest[kContinued].is_array())
      manifest[kContinued] = Json::array();
    manifest[kContinued].push_back(std::move(facts));
  }
  common::write_file_atomically(file, manifest.dump(2) + "\n");
}

void RunFolder::update(const RunState& state) {
  begin();
  state_ = state;
  state_.verb = request_.verb;
  state_.finished = false;
  state_.updated_utc = common::utc_now();
  common::write_artefact(path() + kStateFile, state_);
}

void RunFolder::abandon() {
  if (!begun_ || stage_ != RunStage::kFresh) return;
  std::error_code error;
  if (made_) {
    fs::remove_all(path(), error);
  } else {
    for (const auto& entry : fs::directory_iterator(path())) fs::remove_all(entry.path(), error);
  }
  if (error) throw common::IoError("cannot empty " + path() + ": " + error.message());
  begun_ = false;
}

void RunFolder::finish() {
  begin();
  state_.finished = true;
  state_.updated_utc = common::utc_now();
  common::write_artefact(path() + kStateFile, state_);
  stage_ = RunStage::kFinished;
}

std::optional<RunState> find_run(const std::string& folder) {
  return common::find_artefact<RunState>(folder + kStateFile);
}

bool is_running(const std::string& folder) {
  const int descriptor = open_folder(folder);
  if (descriptor < 0) return false;  // gone since
  // With others who look, and against whom works there.
  const bool free = ::flock(descriptor, LOCK_SH | LOCK_NB) == 0;
  ::close(descriptor);
  return !free;
}

}  // namespace lodestone::runs
