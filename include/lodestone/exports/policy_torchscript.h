#pragma once

#include "lodestone/exports/policy_contract.h"
#include "lodestone/nets/script_module.h"

namespace lodestone::exports {

/// The policy in TorchScript, for nets::encode_script. forward() takes the inputs of the contract in their
/// order, [batch, n] float32, and gives `current`, or (current, next_memory). Metadata are extra files,
/// KEY.json.
nets::ScriptModule policy_torchscript(const PolicyContract& contract);

}  // namespace lodestone::exports
