#pragma once

#include <map>
#include <string>
#include <vector>

#include "verb.h"

namespace lodestone::apps {

/// What a command line asks for.
struct Parsed {
  const Verb* verb = nullptr;  ///< null: --help or a fault was printed, and the program ends
  int exit_code = 0;           ///< of that end
  std::string path = {};       ///< "rig check"
  std::map<std::string, std::string> given = {};  ///< options of the verb, "--out", with their first values
};

/// Gives the options their values. Throws ConfigError for a verb that does not exist.
Parsed parse(Verb& program, int argc, char** argv);

/// Gives the options their values, of which none is needed. Throws ConfigError that begins with `what`.
void parse_only(Verb& program, const std::vector<std::string>& words, const std::string& what);

}  // namespace lodestone::apps
