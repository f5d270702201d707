#include "lodestone/common/path_digest.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "lodestone/common/files.h"

namespace lodestone::common {

namespace fs = std::filesystem;

std::string path_digest(const std::string& path) {
  if (fs::is_regular_file(path)) return sha256(read_file(path));
  if (!fs::is_directory(path)) return "";
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::string all;
  for (const fs::path& file : files)
    all += file.lexically_relative(path).string() + "\n" + sha256(read_file(file.string())) + "\n";
  return sha256(all);
}

}  // namespace lodestone::common
