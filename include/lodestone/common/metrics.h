#pragma once

#include <cstdint>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lodestone/common/json.h"

namespace lodestone::common {

/// Named numbers at one step.
using Scalars = std::vector<std::pair<std::string, double>>;

constexpr std::int64_t kNoStep = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kEveryStep = std::numeric_limits<std::int64_t>::max();

/// Where a run's curves go: `metrics.jsonl` (one object a line, flushed) and TensorBoard events, both in one
/// folder; they are made by the first write.
class MetricsLog {
 public:
  /// Appends to what is there up to `last_step`. Lines beyond it were written by a killed process after its
  /// last checkpoint; their steps are run again, so that they are dropped (TensorBoard is told to do so).
  /// `earlier_s` is the run's time before this process; `config`, where there is one, what the run is
  /// configured by: TensorBoard shows it as text, and its values as hyperparameters. Throws IoError.
  explicit MetricsLog(std::string folder, std::int64_t last_step = kEveryStep, double earlier_s = 0.0,
                      Json config = {});
  ~MetricsLog();

  /// Writes {"step": step, "wall_s": ..., name: value...}. Throws IoError when the disk is full.
  void write(std::int64_t step, const Scalars& scalars);
  /// Puts an image (a whole PNG file, 8-bit RGB) into the TensorBoard events. Throws IoError.
  void write_image(std::int64_t step, const std::string& tag, std::string_view png, std::int64_t width,
                   std::int64_t height);
  /// What the run came to: every number of `result` as `final/a.b` in the TensorBoard events, the row of the
  /// run's hyperparameters with it. Throws IoError.
  void write_result(std::int64_t step, const Json& result);

 private:
  class TensorBoardWriter& events();

  std::string folder_;
  std::int64_t last_step_;
  double earlier_s_;
  Json config_;
  std::ofstream lines_;
  std::unique_ptr<class TensorBoardWriter> events_;
  double start_s_;
};

}  // namespace lodestone::common
