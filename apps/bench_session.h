#pragma once

#include <functional>
#include <memory>
#include <string>

#include "lodestone/session/rig_session.h"

namespace lodestone::apps {

/// True when somebody sits at the terminal.
bool has_operator();

/// Asks at the terminal whether to go on; `yes` answers for the operator. Without either the answer is no.
bool confirm(const std::string& question, bool yes);

/// Connects to the bench of the configuration. In a terminal, the operator is asked to place the needle; the
/// run also stops on any key, and as soon as `out`/STOP exists.
std::unique_ptr<session::RigSession> open_bench(const rig::RigConfig& rig,
                                                const session::SensingConfig& sensor,
                                                safety::SafetyConfig safety, const std::string& out);

}  // namespace lodestone::apps
