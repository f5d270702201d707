#pragma once

#include <cstdint>
#include <string>

#include "lodestone/common/metrics.h"
#include "lodestone/runs/run_folder.h"

namespace lodestone::runs {

/// How far some work is.
struct Progress {
  std::int64_t done = 0;  ///< also the step of its metrics
  std::int64_t total = 0;
  bool finished = false;
  std::string note;
};

/// Long work that is cut into steps, and gone on with from a checkpoint bitwise as if never stopped. Work of
/// seconds is not (a report is read and written in whole), nor are measurements of this machine (bench speed,
/// bench emulation), which an interruption would spoil.
class ResumableWork {
 public:
  virtual ~ResumableWork() = default;
  virtual Progress progress() const = 0;
  /// One step. Metrics of a step have `done` after it as their step. A step that is too long for Ctrl-C to
  /// wait for looks at common::interrupted() and throws Interrupted: the run then goes on from its last
  /// checkpoint.
  virtual void step(common::MetricsLog& metrics) = 0;
  /// Writes the checkpoint into the run's folder, or takes it up from there.
  virtual void save(const std::string& folder) = 0;
  virtual void load(const std::string& folder) = 0;
};

/// What a person reads while it runs.
struct RunText {
  std::string label;  ///< of the progress bar
  std::string unit;   ///< "epochs", "trials"
  double checkpoint_every_s = 60.0;
};

/// Runs work to its end in a folder: goes on from the last checkpoint, drops metrics that a killed process
/// wrote after it, checkpoints, keeps run.json and a progress bar, and answers Ctrl-C with a checkpoint and
/// Interrupted, which says how to go on. Returns the seconds of work of all processes together. The folder is
/// finished by the caller, once results are written.
double run_resumably(RunFolder& folder, ResumableWork& work, const RunText& text);

/// Where the run's curves are, what it came to, too: the numbers of `result` (common::MetricsLog). Throws
/// IoError.
void show_result(const RunFolder& folder, const common::Json& result);

}  // namespace lodestone::runs
