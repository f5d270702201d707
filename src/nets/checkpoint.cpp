#include "lodestone/nets/checkpoint.h"

#include "lodestone/inference/checkpoint.h"

namespace lodestone::nets {

void save_checkpoint(const std::string& folder, const Checkpoint& checkpoint) {
  inference::Checkpoint plain{checkpoint.kind, checkpoint.config, checkpoint.facts, {}};
  for (const auto& [part, tensors] : checkpoint.parts) plain.parts[part] = to_arrays(tensors);
  inference::save_checkpoint(folder, plain);
}

Checkpoint load_checkpoint(const std::string& folder, const std::string& expected_kind) {
  const inference::Checkpoint plain = inference::load_checkpoint(folder, expected_kind);
  Checkpoint checkpoint{plain.kind, plain.config, plain.facts, {}};
  for (const auto& [part, arrays] : plain.parts) checkpoint.parts[part] = to_tensors(arrays);
  return checkpoint;
}

}  // namespace lodestone::nets
