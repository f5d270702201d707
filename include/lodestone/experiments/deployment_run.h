#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/experiments/deployment_job.h"
#include "lodestone/experiments/recorder.h"
#include "lodestone/experiments/trial_driver.h"
#include "lodestone/runs/deployment_results.h"
#include "lodestone/runs/resumable_run.h"

namespace lodestone::experiments {

/// Phase 3 as resumable work: a trial that has ended is kept (`trajectories.csv`, `trials.jsonl`, both
/// flushed, and `summary.json` of all so far), whatever happens to the process.
class DeploymentRun : public runs::ResumableWork {
 public:
  /// `config` and `job` must outlive it.
  DeploymentRun(const DeploymentConfig& config, const DeploymentJob& job, std::string folder,
                TrialDriver driver);

  runs::Progress progress() const override;
  void step(common::MetricsLog& metrics) override;
  void save(const std::string& folder) override;
  void load(const std::string& folder) override;

  /// The trials that have ended.
  runs::DeploymentSummary summary() const;
  /// Writes trials.json of every kind of rig from trials.jsonl, and the map in which ways were searched.
  void write_trials() const;

 protected:
  /// One task by one controller on one kind of rig, with the trials of it that have ended, without
  /// trajectories.
  struct Part {
    std::size_t rig, source, task;
    std::vector<runs::TrialRecord> ended;
  };
  const std::vector<Part>& parts() const { return parts_; }

 private:
  std::vector<TrialPlan> next_plans(const Part& part) const;
  /// The next trials of a part. Those of a connected rig are recorded while they are driven.
  std::vector<TrialResult> drive(const Part& part, const ControllerSource& source);
  /// Of a suture by a controller: rehearsed once, as a run has one.
  const std::vector<geometry::Stitch>& aims_for(std::size_t source,
                                                const std::vector<geometry::Stitch>& stitches);
  void keep(Part& part, const TrialResult& result);
  Part& part_of(const runs::TrialRecord& record);
  runs::RigSummary summary_of(std::size_t rig) const;
  /// trials.json of a kind of rig lies in a folder of its own where there are two.
  std::string folder_of(std::size_t rig) const;

  const DeploymentConfig& config_;
  const DeploymentJob& job_;
  std::string folder_;
  TrialDriver driver_;
  std::vector<Part> parts_;
  std::int64_t done_ = 0;
  std::int64_t rows_ = 0;      ///< of trajectories.csv that belong to trials that have ended
  std::size_t live_rows_ = 0;  ///< of the trial that is being driven, in trajectories.csv already
  std::string note_;
  std::map<std::size_t, std::vector<geometry::Stitch>> aims_;  ///< of a suture, by source
  std::optional<Recorder> recorder_;
  std::ofstream journal_;
};

}  // namespace lodestone::experiments
