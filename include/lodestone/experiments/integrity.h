#pragma once

#include <string>
#include <vector>

namespace lodestone::experiments {

/// One thing on the disk: a recording, a checkpoint, the record of a deployment, a file of results.
struct CheckedItem {
  std::string path;
  std::string what;     ///< for example "recording, 120 transitions in 16 episodes"
  std::string problem;  ///< what is wrong and what to do; empty when it is whole
};

/// Reads what lodestone wrote at a path, a file or everything below a folder, as a verb that uses it would:
/// checksums of recordings and checkpoints, results that parse, rows that belong to the trials that name
/// them. In the order of the paths. Throws ConfigError when nothing there is lodestone's.
std::vector<CheckedItem> check_integrity(const std::string& path);

}  // namespace lodestone::experiments
