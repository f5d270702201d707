#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "lodestone/runs/engine.h"
#include "lodestone/runs/slurm_arrays.h"
#include "lodestone/runs/slurm_queue.h"

namespace lodestone::runs {

/// Cancels the jobs of a plan whose command has died; false where this folder gave Slurm none. Throws Error
/// where Slurm does not.
bool cancel_left_jobs(const std::string& folder);

/// Runs cells on a cluster: job arrays whose tasks wait for what they need, and a last job, all of one name,
/// which is kept in the plan's folder. They go on when this process dies, and an engine that is started again
/// finds them: what is running or waiting is not submitted twice. Needs Slurm 20.11 or newer, and a folder
/// that every node sees under the same path.
class SlurmEngine final : public Engine {
 public:
  /// Throws Error, too, where Slurm does not answer or take a job.
  void start(const Plan& plan, const PlanPlace& place, const std::vector<const Cell*>& cells) override;
  bool ended() override;
  void stop() override;

 private:
  /// A job that Slurm has not taken yet.
  struct Submission {
    std::string key;                 ///< comment of the job, and name of its files in slurm/
    std::vector<std::string> words;  ///< of sbatch, but for what it waits for
    bool one_to_one = false;         ///< its tasks wait for those of `after` one by one
    std::vector<std::string> after;  ///< keys of jobs of this process that it waits for
    std::vector<std::string> tasks;  ///< of earlier processes, as Slurm names them, that it waits for
  };

  void prepare(const Plan& plan, const PlanPlace& place, const std::vector<SlurmArray>& arrays,
               const std::map<std::string, QueuedTask>& running);
  void prepare_last(const PlanPlace& place, const std::vector<QueuedTask>& queued);
  void submit();
  std::string dependency(const Submission& submission) const;

  std::string folder_;  ///< slurm/ in the plan's
  std::string name_;    ///< of all jobs
  std::deque<Submission> waiting_;
  std::map<std::string, std::string> jobs_;  ///< of this process, by key
  bool queued_before_ = false;               ///< an earlier process's tasks, when this one began
  std::vector<std::string> replaced_;        ///< last jobs of earlier processes, until there is another
  std::string refusal_;                      ///< what Slurm said when it did not take the first that waits
  std::chrono::steady_clock::time_point looked_{};
};

}  // namespace lodestone::runs
