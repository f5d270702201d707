#pragma once

#include <map>
#include <string>
#include <vector>

#include <torch/torch.h>

#include "lodestone/common/config.h"

namespace lodestone::nets {

/// Tensors by name; order is the names'.
using NamedTensors = std::map<std::string, torch::Tensor>;

/// A folder `manifest.json` + `<part>.safetensors`. Loading never executes code.
struct Checkpoint {
  std::string kind;                              ///< "dynamics", "policy", "td3_training", ...
  common::Json config = common::Json::object();  ///< resolved configuration it was made with
  common::Json facts = common::Json::object();   ///< anything else that is JSON: layout, counters, RNG states
  std::map<std::string, NamedTensors> parts;     ///< file stem -> tensors (float32, float64, int64, uint8)
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

/// Parameters and buffers of a module under dotted names, and back (copied in place, shapes and types
/// checked; throws CheckpointError naming the tensor that is missing, unexpected or of another shape).
NamedTensors module_tensors(const torch::nn::Module& module);
void load_module_tensors(torch::nn::Module& module, const NamedTensors& tensors, const std::string& what);

/// Safetensors file content (8-byte little-endian header length, JSON header, raw little-endian data) and
/// back.
std::string encode_safetensors(const NamedTensors& tensors);
NamedTensors decode_safetensors(const std::string& content, const std::string& what);

}  // namespace lodestone::nets
