#include "lodestone/inference/checkpoint.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "lodestone/common/build_facts.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/shown.h"

namespace lodestone::inference {
namespace {

using common::CheckpointError;
using common::Json;
namespace fs = std::filesystem;

constexpr const char* kManifest = "manifest.json";
constexpr std::size_t kLargestManifest = 1 << 30;  // bytes; that of a training run holds random streams
constexpr std::size_t kLargestPart = std::size_t{4} << 30;  // bytes: a replay buffer
constexpr const char* kSeal = "sha256";                     ///< SHA-256 of the manifest without this key

std::string without_trailing_slash(std::string folder) {
  while (folder.size() > 1 && folder.back() == '/') folder.pop_back();
  return folder;
}

Json shapes_of(const Arrays& arrays) {
  Json shapes = Json::object();
  for (const auto& [name, array] : arrays) shapes[name] = array.shape();
  return shapes;
}

/// A manifest that may be none.
std::optional<Json> find_manifest(const std::string& path) {
  try {
    std::optional<Json> manifest = common::find_json(common::read_file(path, kLargestManifest));
    if (manifest && manifest->is_object()) return manifest;
  } catch (const common::IoError&) {  // somebody else's, then
  }
  return std::nullopt;
}

/// Where checkpoints of a kind lie below a folder that is none itself, as the end of a message; empty when
/// nowhere. Looks into runs and into folders of runs, no deeper.
std::string checkpoints_below(const std::string& folder, const std::string& kind) {
  constexpr int kLevels = 2;
  std::vector<std::string> found;
  std::error_code ignored;
  for (auto entry = fs::recursive_directory_iterator(folder, ignored); entry != fs::end(entry);
       entry.increment(ignored)) {
    if (entry.depth() >= kLevels) entry.disable_recursion_pending();
    if (entry->path().filename() != kManifest) continue;
    if (const std::optional<Json> manifest = find_manifest(entry->path()))
      if (manifest->contains("format") && manifest->value("kind", Json()) == kind)
        found.push_back(entry->path().parent_path().string());
  }
  std::sort(found.begin(), found.end());
  std::string text;
  for (const std::string& name : found) text += (text.empty() ? "; name " : " or ") + name;
  return text;
}

Json read_manifest(const std::string& folder, const std::string& expected_kind) {
  const std::string path = folder + "/" + kManifest;
  if (!fs::is_directory(folder)) {
    throw CheckpointError("checkpoint " + folder + ": no such folder; give the folder that holds " +
                          kManifest);
  }
  if (!fs::exists(path))
    throw CheckpointError("checkpoint " + folder + ": holds no " + kManifest +
                          checkpoints_below(folder, expected_kind));
  const std::string what = "checkpoint " + folder + ": ";
  try {
    Json manifest = common::parse_json(common::read_file(path, kLargestManifest), kManifest);
    if (manifest.is_object()) return manifest;
  } catch (const common::IoError& error) {
    throw CheckpointError(what + error.what());
  } catch (const common::DataError& error) {
    throw CheckpointError(what + kManifest + " is truncated or no JSON object (" + error.what() + ")");
  }
  throw CheckpointError(what + kManifest + " is truncated or no JSON object");
}

/// Format first, so that a newer program's checkpoint is named as such; then the seal, then the kind.
void check_manifest(Json manifest, const std::string& folder, const std::string& expected_kind) {
  const std::string where = "checkpoint " + folder + ": " + kManifest;
  if (!manifest.contains("format") || !manifest.at("format").is_number_integer()) {
    throw CheckpointError(where + " is not that of a checkpoint: it names no format version" +
                          checkpoints_below(folder, expected_kind));
  }
  if (const auto format = manifest.at("format").get<std::int64_t>(); format != kCheckpointFormat) {
    throw CheckpointError(where + " has format version " + std::to_string(format) + ", this program reads " +
                          std::to_string(kCheckpointFormat) + "; use the version that wrote it");
  }
  if (!manifest.contains(kSeal) || !manifest.at(kSeal).is_string())
    throw CheckpointError(where + " has no seal");
  const std::string seal = manifest.at(kSeal).get<std::string>();
  manifest.erase(kSeal);
  if (common::sha256(manifest.dump()) != seal) {
    throw CheckpointError(where + " was altered: its SHA-256 differs from the one it names");
  }
  const std::string kind = manifest.at("kind").get<std::string>();
  if (kind != expected_kind) {
    throw CheckpointError("checkpoint " + folder + " is of kind \"" + common::shown(kind) +
                          "\", expected \"" + expected_kind + "\"");
  }
}

Arrays read_part(const std::string& folder, const std::string& file, const Json& entry) {
  const std::string where = "checkpoint " + folder + ": " + common::shown(file);
  if (fs::path(file).filename() != file)
    throw CheckpointError(where + " is no name of a file beside " + kManifest);
  std::string content;
  try {
    content = common::read_file(folder + "/" + file, kLargestPart);
  } catch (const common::IoError& error) {
    throw CheckpointError(where + " cannot be read: " + error.what());
  }
  const auto bytes = entry.at("bytes").get<std::uint64_t>();
  if (content.size() != bytes) {
    throw CheckpointError(where + " is truncated: " + std::to_string(content.size()) + " of " +
                          std::to_string(bytes) + " bytes");
  }
  if (common::sha256(content) != entry.at("sha256").get<std::string>()) {
    throw CheckpointError(where + " was altered: its SHA-256 differs from the manifest's");
  }
  return decode_safetensors(content, where);
}

void write_staged(const std::string& staged, const Checkpoint& checkpoint) {
  Json manifest = Json::object();
  manifest["format"] = kCheckpointFormat;
  manifest["kind"] = checkpoint.kind;
  manifest["config"] = checkpoint.config;
  manifest["facts"] = checkpoint.facts;
  manifest["files"] = Json::object();
  for (const auto& [stem, arrays] : checkpoint.parts) {
    const std::string file = stem + ".safetensors";
    const std::string content = encode_safetensors(arrays);
    common::write_file_atomically(staged + "/" + file, content);
    manifest["files"][file] = {
        {"bytes", content.size()}, {"sha256", common::sha256(content)}, {"shapes", shapes_of(arrays)}};
  }
  manifest["build"] = common::build_and_host_facts();
  // A number JSON cannot hold (NaN) becomes null here, before the seal is computed.
  manifest = common::parse_json(manifest.dump(), staged + "/" + kManifest);
  manifest[kSeal] = common::sha256(manifest.dump());
  common::write_file_atomically(staged + "/" + kManifest, manifest.dump(2) + "\n");
  common::sync_path(staged);
}

}  // namespace

const Array& Checkpoint::at(const std::string& part, const std::string& name, const std::string& what) const {
  const auto found = parts.find(part);
  if (found == parts.end()) throw CheckpointError(what + ": part \"" + part + "\" is missing");
  const auto array = found->second.find(name);
  if (array == found->second.end())
    throw CheckpointError(what + ": array \"" + name + "\" of part \"" + part + "\" is missing");
  return array->second;
}

void save_checkpoint(const std::string& folder, const Checkpoint& checkpoint) {
  const std::string target = without_trailing_slash(folder);
  const std::string staged = target + ".staged";
  std::error_code ignored;
  fs::remove_all(staged, ignored);  // left there by a run that was killed
  common::make_folders(staged);
  try {
    write_staged(staged, checkpoint);
    common::replace_folder(staged, target);
  } catch (...) {
    fs::remove_all(staged, ignored);
    throw;
  }
}

Checkpoint load_checkpoint(const std::string& folder, const std::string& expected_kind) {
  const std::string source = without_trailing_slash(folder);
  const Json manifest = read_manifest(source, expected_kind);
  try {
    check_manifest(manifest, source, expected_kind);
    Checkpoint checkpoint;
    checkpoint.kind = expected_kind;
    checkpoint.config = manifest.at("config");
    checkpoint.facts = manifest.at("facts");
    if (!manifest.at("files").is_object())
      throw CheckpointError("checkpoint " + source + ": " + kManifest + " names no files");
    for (const auto& [file, entry] : manifest.at("files").items()) {
      checkpoint.parts[fs::path(file).stem().string()] = read_part(source, file, entry);
    }
    return checkpoint;
  } catch (const Json::exception& error) {
    throw CheckpointError("checkpoint " + source + ": " + kManifest + " lacks an entry: " + error.what());
  }
}

}  // namespace lodestone::inference
