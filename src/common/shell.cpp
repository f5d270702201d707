#include "lodestone/common/shell.h"

#include <sys/wait.h>

#include <array>
#include <cstdio>

#include "lodestone/common/error.h"

namespace lodestone::common {

std::string shell_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string shell_quoted(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + shell_quoted(word);
  return out;
}

CommandResult run_command(const std::vector<std::string>& words) {
  std::FILE* pipe = ::popen(("trap '' INT; exec 2>&1; " + shell_quoted(words)).c_str(), "re");
  if (pipe == nullptr) throw IoError("cannot start " + words.front() + ": too many processes are running");
  CommandResult result;
  std::array<char, 65536> part{};
  for (std::size_t n; (n = std::fread(part.data(), 1, part.size(), pipe)) > 0;)
    result.output.append(part.data(), n);
  const int status = ::pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace lodestone::common
