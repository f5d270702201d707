#pragma once

#include <string>

#include "lodestone/exports/policy_contract.h"

namespace lodestone::exports {

/// The policy as a header in C99 that allocates nothing and needs nothing but the C library: weights in
/// 16 bits (rounded_layer.h), constants in arrays of at most 32,767 bytes behind one macro, which keeps them
/// in program memory on AVR. Compiled as a program with LODESTONE_POLICY_TEST it holds itself against what
/// control::PolicyController gives.
std::string policy_header(const PolicyContract& contract);

}  // namespace lodestone::exports
