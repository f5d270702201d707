#pragma once

#include <map>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/inference/array.h"

namespace lodestone::inference {

/// A folder `manifest.json` + `<part>.safetensors`. Loading never executes code.
struct Checkpoint {
  std::string kind;                              ///< "dynamics", "policy", "policy_training", ...
  common::Json config = common::Json::object();  ///< resolved configuration it was made with
  common::Json facts = common::Json::object();   ///< anything else that is JSON: layout, counters, RNG states
  std::map<std::string, Arrays> parts;           ///< file stem -> arrays

  /// Throws CheckpointError that names part and array, after `what`, when it is missing.
  const Array& at(const std::string& part, const std::string& name, const std::string& what) const;
};

/// Format version that save_checkpoint writes; load_checkpoint refuses others.
constexpr int kCheckpointFormat = 1;

/// Writes to a temporary folder beside `folder`, fsyncs, and swaps it in at once: a kill at any point leaves
/// the old checkpoint or the new one. manifest.json holds format, kind, config, facts, shapes and SHA-256 of
/// each file, build and host facts. Throws IoError (the old checkpoint stays).
void save_checkpoint(const std::string& folder, const Checkpoint& checkpoint);

/// Throws CheckpointError naming folder, file and reason when it is missing, truncated, of another kind or
/// format, or when a file's SHA-256 differs.
Checkpoint load_checkpoint(const std::string& folder, const std::string& expected_kind);

/// Safetensors file content (8-byte little-endian header length, JSON header, raw little-endian data) and
/// back. decode throws CheckpointError that begins with `what`.
std::string encode_safetensors(const Arrays& arrays);
Arrays decode_safetensors(const std::string& content, const std::string& what);

}  // namespace lodestone::inference
