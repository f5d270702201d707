#pragma once

#include <map>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/nets/tensors.h"

namespace lodestone::nets {

/// inference::Checkpoint with tensors in its parts.
struct Checkpoint {
  std::string kind;
  common::Json config = common::Json::object();
  common::Json facts = common::Json::object();
  std::map<std::string, NamedTensors> parts;
};

/// As the functions of inference.
void save_checkpoint(const std::string& folder, const Checkpoint& checkpoint);
Checkpoint load_checkpoint(const std::string& folder, const std::string& expected_kind);

}  // namespace lodestone::nets
