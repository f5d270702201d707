#pragma once

#include <functional>
#include <memory>
#include <string>

#include "lodestone/control/bench.h"

namespace lodestone::apps {

/// True when somebody sits at the terminal.
bool has_operator();

/// Asks at the terminal whether to go on; `yes` answers for the operator. Without either the answer is no.
bool confirm(const std::string& question, bool yes);

/// Connects to the bench of the configuration. In a terminal, the operator is asked to lay the needle; the
/// run also stops on any key, and as soon as `out`/STOP exists.
std::unique_ptr<control::Bench> open_bench(const rig::RigConfig& rig, const control::SensingConfig& sensor,
                                           control::SafetyConfig safety, const std::string& out);

}  // namespace lodestone::apps
