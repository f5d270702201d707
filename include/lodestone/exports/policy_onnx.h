#pragma once

#include <string>

#include "lodestone/exports/policy_contract.h"

namespace lodestone::exports {

/// The policy as an ONNX file: inputs and outputs of its contract, [batch, n] float32, and its metadata.
std::string policy_onnx(const PolicyContract& contract);

}  // namespace lodestone::exports
