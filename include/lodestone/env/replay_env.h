#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/data/dataset.h"
#include "lodestone/env/episode_batch.h"
#include "lodestone/env/vec_env.h"

namespace lodestone::env {

/// How recorded episodes are cut up (section V-C).
struct ReplayConfig {
  std::int64_t environments = 0;
  std::int64_t shortest = 10;
  std::int64_t longest = 15;
  bool keep_shorter = false;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("environments", environments, "",
            "how many of training.environments play back recorded steps instead of the simulator (Fig. 5)",
            {0, 1 << 20});
    v.field("shortest", shortest, "steps", "shortest pseudo-episode", {1, 100000});
    v.field("longest", longest, "steps", "longest pseudo-episode", {1, 100000});
    v.field(
        "keep_shorter", keep_shorter, "",
        "recorded episodes that are shorter than the shortest pseudo-episode are played, too, as a whole");
  }
  /// Throws ConfigError when the lengths are the wrong way round.
  void validate() const;
};

/// N environments that play back stretches of recorded transitions as if they had just happened: section
/// V-C's off-policy data. The actions asked for change nothing; StepResult::action says what was done. Goals,
/// rewards and ends are the task's, and a stretch that is over is cut, so that its last step bootstraps.
class ReplayEnv final : public VecEnv {
 public:
  /// Throws ConfigError when no recorded episode is long enough, or when poses without heading
  /// shall be encoded with one.
  ReplayEnv(const data::Dataset& dataset, const EpisodeSettings& settings, const ReplayConfig& config);

  EnvSpec spec() const override { return episodes_.spec(); }
  const std::vector<float>& reset() override;
  const StepResult& step(const std::vector<float>& actions) override;
  Snapshot save() const override;
  void load(const Snapshot& snapshot) override;

 private:
  struct Stretch {
    std::int64_t episode = 0;
    std::int64_t next = 0;  // step to play
    std::int64_t end = 0;
  };
  geometry::Pose2 pose(std::int64_t episode, std::int64_t step) const;
  void begin(std::size_t i);

  ReplayConfig config_;
  double action_scale_;
  std::size_t action_size_;
  std::size_t state_size_;
  std::vector<data::Episode> recorded_;  // those that are long enough
  EpisodeBatch episodes_;
  std::vector<Stretch> stretches_;
  StepResult result_;
};

}  // namespace lodestone::env
