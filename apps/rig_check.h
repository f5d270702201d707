#pragma once

#include <CLI/CLI.hpp>

#include "verb.h"

namespace lodestone::apps {

/// `lodestone rig check`: walks a new user through the wiring.
void add_rig_check(CLI::App& rig, ConfigCatalogue& catalogue);
/// `lodestone rig emulate`: a bench without hardware, for trying everything else on.
void add_rig_emulate(CLI::App& rig, ConfigCatalogue& catalogue);
/// `lodestone calibrate coils`: resistance and inductance of the coils.
void add_calibrate_coils(CLI::App& calibrate, ConfigCatalogue& catalogue);

}  // namespace lodestone::apps
