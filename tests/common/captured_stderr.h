#pragma once

#include <unistd.h>

#include <cstdio>
#include <functional>
#include <string>

#include "lodestone/common/files.h"
#include "temporary_folder.h"

namespace lodestone::tests {

/// What `action` writes to standard error, into a file: a terminal would get colours.
inline std::string captured_stderr(const std::function<void()>& action) {
  const TemporaryFolder folder;
  std::fflush(stderr);
  const int kept = dup(STDERR_FILENO);
  std::FILE* file = std::fopen((folder / "stderr").c_str(), "w");
  dup2(fileno(file), STDERR_FILENO);
  action();
  std::fflush(stderr);
  dup2(kept, STDERR_FILENO);
  close(kept);
  std::fclose(file);
  return common::read_file(folder / "stderr");
}

}  // namespace lodestone::tests
