#pragma once

#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lodestone::common {

/// Named numbers at one step.
using Scalars = std::vector<std::pair<std::string, double>>;

/// Where a run's curves go: `metrics.jsonl` (one object a line, flushed) and TensorBoard events, both in one
/// folder. Opening appends, so a resumed run goes on in the same file.
class MetricsLog {
 public:
  /// Throws IoError when the files cannot be opened.
  explicit MetricsLog(const std::string& folder);
  ~MetricsLog();

  /// Writes {"step": step, "wall_s": ..., name: value...}. Throws IoError when the disk is full.
  void write(std::int64_t step, const Scalars& scalars);
  /// Puts an image (a whole PNG file, 8-bit RGB) into the TensorBoard events. Throws IoError.
  void write_image(std::int64_t step, const std::string& tag, std::string_view png, std::int64_t width,
                   std::int64_t height);

 private:
  std::string path_;
  std::ofstream lines_;
  std::unique_ptr<class TensorBoardWriter> events_;
  double start_s_;
};

}  // namespace lodestone::common
