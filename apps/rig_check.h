#pragma once

#include <CLI/CLI.hpp>

#include "verb.h"

namespace lodestone::apps {

/// `lodestone rig check`: walks a new user through the wiring.
void add_rig_check(CLI::App& rig);
/// `lodestone rig emulate`: a bench without hardware, for trying everything else on.
void add_rig_emulate(CLI::App& rig);
/// `lodestone calibrate coils`: resistance and inductance of the coils.
void add_calibrate_coils(CLI::App& calibrate);

/// Configuration of these verbs.
std::vector<common::ConfigRow> describe_bench_config();

}  // namespace lodestone::apps
