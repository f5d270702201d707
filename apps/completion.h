#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "verb.h"

namespace lodestone::apps {

/// A script that completes the program's verbs, their options and, behind --set, the keys of their
/// configuration; written from the parser and the catalogue themselves.
std::string bash_completion(const CLI::App& program, const ConfigCatalogue& catalogue);

void add_completion(CLI::App& program, ConfigCatalogue& catalogue);

}  // namespace lodestone::apps
