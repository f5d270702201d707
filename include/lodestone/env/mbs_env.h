#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "lodestone/common/thread_pool.h"
#include "lodestone/env/episode_batch.h"
#include "lodestone/env/vec_env.h"
#include "lodestone/inference/dynamics.h"

namespace lodestone::env {

/// Who predicts: the mean of all members, or one of them drawn for each episode or each step.
enum class EnsembleUse { kMean, kPerEpisode, kPerStep };
inline std::vector<std::string> names_of(EnsembleUse) { return {"mean", "per_episode", "per_step"}; }
/// What of a predicted distribution happens.
enum class Outcome { kMean, kSample };
inline std::vector<std::string> names_of(Outcome) { return {"mean", "sample"}; }

/// How the learned simulator is used, and what it adds to a clean prediction. Zeros add nothing, as in the
/// paper.
struct MbsConfig {
  EnsembleUse ensemble = EnsembleUse::kMean;
  Outcome outcome = Outcome::kMean;
  double disagreement_penalty = 0.0;
  double disagreement_stop_m = 0.0;
  double pose_noise_m = 0.0;
  double heading_noise_rad = 0.0;
  double breakaway_scatter = 0.0;  ///< friction that differs from episode to episode
  double stall_probability = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("ensemble", ensemble, "",
            "who predicts: the mean of all members, or one member drawn for each episode or each step");
    v.field("outcome", outcome, "",
            "what of a predicted distribution happens: its mean, or a sample of it (with one member, not the "
            "mean of "
            "all)");
    v.field("disagreement_penalty", disagreement_penalty, "1/dish radius",
            "taken from the reward, per RMS distance of the members' predicted positions from their mean",
            {0.0, 1e4});
    v.field("disagreement_stop_m", disagreement_stop_m, "m",
            "an episode ends where that distance is larger: there the members are guessing; 0: never",
            {0.0, 1.0});
    v.field("pose_noise_m", pose_noise_m, "m", "standard deviation of the sensed position, each axis",
            {0.0, 0.1});
    v.field("heading_noise_rad", heading_noise_rad, "rad", "standard deviation of the sensed heading",
            {0.0, 3.2});
    v.field(
        "breakaway_scatter", breakaway_scatter, "",
        "sigma of a log-normal factor on the drive, drawn for each episode: friction that differs, or rigs. "
        "One above 1 counts as 1, as the simulator knows no stronger drive, unless encoder.drive_gain tells "
        "an estimate of it",
        {0.0, 2.0});
    v.field("stall_probability", stall_probability, "", "chance that a pulse moves nothing", {0.0, 1.0});
  }
};

/// Poses of the training data within `radius_m` of the centre and inside `region` when there is one: where
/// episodes start. Throws ConfigError when there is none.
std::vector<geometry::Pose2> starts_within(const inference::DynamicsModel& model, double radius_m,
                                           const task::Region* region);

/// N copies of the learned simulator stepped as one batch (section IV-B1), at any number of threads with the
/// same result: environments are worked on in shards of fixed size. The rules of the paper are options of the
/// task. Episodes start from states of the training data within task.start_radius.
class MbsEnv final : public VecEnv {
 public:
  /// Copies what it needs from `model`. threads: 0 means one per processor.
  /// Throws ConfigError when no training state lies within the start radius, when the encoder wants a heading
  /// that the model does not have, or when the configuration wants more of the ensemble than there is.
  MbsEnv(const inference::DynamicsModel& model, const EpisodeSettings& settings, const MbsConfig& config,
         std::int64_t threads);

  EnvSpec spec() const override { return episodes_.spec(); }
  const std::vector<float>& reset() override;
  const StepResult& step(const std::vector<float>& actions) override;
  Snapshot save() const override;
  void load(const Snapshot& snapshot) override;

 private:
  /// Rows of a shard that move, gathered by ensemble member.
  struct Scratch {
    std::vector<std::size_t> row;  ///< environment of each gathered row
    std::vector<double> drive;     ///< [shard, A], in the order of environments
    std::vector<double> state, gathered_drive, next, one_member, mean_position;
    std::vector<double> disagreement_m;  ///< of each gathered row; empty unless it is wanted
    std::vector<common::RandomStream*> random;
    std::vector<std::size_t> first_of_member;
    inference::FoldedDynamics::Workspace workspace;
  };

  std::size_t shards() const;
  void begin(std::size_t i);
  void step_shard(std::size_t shard, const float* actions);
  void choose_drives(std::size_t first, std::size_t last, const float* actions, Scratch& scratch);
  void gather(std::size_t first, std::size_t last, Scratch& scratch) const;
  void predict(Scratch& scratch);
  void measure_disagreement(Scratch& scratch) const;
  std::unique_ptr<Scratch> borrow_scratch();
  void give_back(std::unique_ptr<Scratch> scratch);

  MbsConfig config_;
  bool mean_of_all_;
  bool sample_;
  bool disagreement_;
  std::vector<inference::FoldedDynamics> members_;
  std::size_t state_size_;
  std::size_t action_size_;
  std::vector<geometry::Pose2> starts_;
  EpisodeBatch episodes_;
  std::vector<std::int64_t> member_;  ///< [N] who predicts
  std::vector<double> drive_factor_;  ///< [N] for this episode
  common::ThreadPool pool_;
  std::mutex scratch_mutex_;
  std::vector<std::unique_ptr<Scratch>> scratch_;
};

}  // namespace lodestone::env
