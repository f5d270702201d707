#pragma once

#include <string>
#include <vector>

namespace lodestone::common {

/// One word of a shell's command line that stands for `text`, whatever is in it.
std::string shell_quoted(const std::string& text);
/// A command line: every word quoted.
std::string shell_quoted(const std::vector<std::string>& words);

/// How a command ended, and all that it wrote.
struct CommandResult {
  int exit_code = 0;  ///< 127: there is no such program; 128 and more: a signal ended it
  std::string output;
};

/// Runs another program and waits for it. Ctrl-C does not reach it. Throws IoError where no process can be
/// started.
CommandResult run_command(const std::vector<std::string>& words);

}  // namespace lodestone::common
