#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lodestone/runs/engine.h"

namespace lodestone::runs {

/// Names of the engines there are.
std::vector<std::string> engine_names();

/// The engine of a name. Throws ConfigError where there is none.
std::unique_ptr<Engine> make_engine(const std::string& name);

}  // namespace lodestone::runs
