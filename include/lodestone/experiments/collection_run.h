#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lodestone/common/thread_pool.h"
#include "lodestone/data/coverage.h"
#include "lodestone/data/journal.h"
#include "lodestone/experiments/collection.h"
#include "lodestone/runs/resumable_run.h"
#include "lodestone/runs/training_results.h"

namespace lodestone::experiments {

using Sessions = std::vector<std::unique_ptr<Collection>>;

/// Phase 1 as resumable work: several explorations of one rig side by side, into the journal of
/// `transitions.h5` in the run's folder; the caller folds it at the end. All sessions explore some episodes,
/// which are written in the order of the sessions, so that the file does not depend on threads.
class CollectionRun : public runs::ResumableWork {
 public:
  /// `repeatable`: what was lost with a killed process can be driven again exactly as it was; else each
  /// episode counts as soon as it is on the disk, and there is one session. `sessions` must outlive it.
  CollectionRun(const CollectionConfig& config, const Sessions& sessions, bool repeatable,
                std::int64_t threads, const std::string& folder);

  runs::Progress progress() const override;
  void step(common::MetricsLog& metrics) override;
  void save(const std::string& folder) override;
  void load(const std::string& folder) override;

 private:
  void open_journal();
  /// Episodes of one round, in the order of the sessions.
  std::vector<data::Episode> explore();

  CollectionConfig config_;
  const Sessions& sessions_;
  bool repeatable_;
  common::ThreadPool pool_;
  std::string recording_;
  std::unique_ptr<data::JournalWriter> journal_;
  std::int64_t stored_ = 0;  ///< episodes in the journal when it was opened
  std::int64_t episodes_ = 0;
  std::int64_t transitions_ = 0;
};

/// What a recording is, once all of it is there.
struct RecordingSummary {
  runs::CollectionFacts facts;
  data::Coverage coverage;
};
/// Folds the journal of a run that has recorded all it should, and writes both beside the recording.
RecordingSummary summarise_recording(const runs::RunFolder& run);

}  // namespace lodestone::experiments
