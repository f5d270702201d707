#include "lodestone/experiments/tracking_bench.h"

#include <algorithm>
#include <cmath>

#include "lodestone/common/build_facts.h"
#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/progress.h"
#include "lodestone/common/statistics.h"
#include "lodestone/experiments/collection.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/inference/dynamics.h"
#include "lodestone/vision/commanded_field.h"
#include "lodestone/vision/heading_filter.h"

namespace lodestone::experiments {
namespace {

constexpr double kClearTape = 20.0;  // log-odds of a head that is known
constexpr double kAxisSigma_rad = 0.5 * geometry::kRadPerDeg;

CollectionConfig exploration_of(const DeploymentConfig& deployment) {
  CollectionConfig config;
  config.seed = deployment.seed;
  config.rig_seed = deployment.rig_seed;
  config.rig = deployment.rig;
  config.loop = deployment.loop;
  config.safety = deployment.safety;
  config.sensor.kind = "simulated";
  return config;
}

/// What one pulse did: the head before it is known, of what came after it the axis.
void add_step(const geometry::Pose2& before, const physics::Currents& current_A, double heading_rad,
              const vision::CommandedField& field, double sure, MaskedTape& result) {
  const auto field_rad = field.direction_rad(current_A, before.position_m());
  if (!field_rad) return;
  vision::HeadingFilter filter;
  filter.see(before.heading_rad, kAxisSigma_rad, kClearTape);
  filter.pulse(*field_rad);
  const double probability = filter.see(heading_rad, kAxisSigma_rad, 0.0);
  ++result.steps;
  if (std::max(probability, 1.0 - probability) < sure)
    ++result.undecided;
  else if (probability < 0.5)
    ++result.wrong;
  if (std::cos(heading_rad - before.heading_rad) < 0.0) ++result.wrong_by_nearest;
}

void add_steps(const data::Episode& episode, const vision::CommandedField& field, double sure,
               MaskedTape& result) {
  for (std::int64_t step = 0; step < episode.length(); ++step) {
    const auto row = static_cast<std::size_t>(step);
    const double* pose = &episode.observations[3 * row];
    add_step({pose[0], pose[1], pose[2]},
             task::coil_currents({episode.actions[2 * row], episode.actions[2 * row + 1]}), pose[5], field,
             sure, result);
  }
}

void add_steps(const TrialResult& trial, const vision::CommandedField& field, double sure,
               MaskedTape& result) {
  for (std::size_t i = 1; i < trial.samples.size(); ++i)
    add_step(*trial.samples[i - 1].true_pose, trial.samples[i - 1].step.current_A,
             trial.samples[i].true_pose->heading_rad, field, sure, result);
}

std::array<double, 2> interval_of(std::int64_t count, std::int64_t of) {
  const common::Interval interval = common::wilson_interval(count, of);
  return {interval.low, interval.high};
}

void add_trial(const TrialResult& trial, TrackedTrials& result) {
  ++result.trials;
  if (trial.stop_reason.rfind("no pose", 0) == 0) ++result.lost;
  for (const TrialSample& sample : trial.samples) {
    ++result.observations;
    if (!sample.step.estimate.valid)
      ++result.unseen;
    else if (std::cos(sample.step.estimate.pose.heading_rad - sample.true_pose->heading_rad) < 0.0)
      ++result.flipped;
  }
}

}  // namespace

TrackingBench::TrackingBench(const TrackingBenchConfig& config)
    : config_(config),
      source_(config.dynamics.empty()
                  ? baseline_source(config.deployment)
                  : planner_source(config.deployment, inference::load_dynamics(config.dynamics),
                                   config.dynamics)) {
  result_.machine = common::build_and_host_facts();
}

void TrackingBench::mask_tape() {
  const CollectionConfig exploration = exploration_of(config_.deployment);
  Collection collection(exploration);
  const vision::CommandedField field(config_.deployment.rig);
  MaskedTape& masked = result_.masked_tape.emplace();
  common::Progress progress("masked tape", config_.transitions);
  for (std::int64_t recorded = 0; recorded < config_.transitions;) {
    if (common::interrupted()) throw common::Interrupted("bench tracking: stopped by the user");
    const data::Episode episode = collection.next_episode(config_.transitions - recorded);
    recorded += episode.length();
    add_steps(episode, field, config_.deployment.sensor.camera.min_head_probability, masked);
    progress.update(recorded, "");
  }
  progress.finish();
  close(masked, "masked tape, explorer");
}

void TrackingBench::close(MaskedTape& masked, const std::string& where) {
  if (masked.steps == 0) throw common::DataError("bench tracking: no step had current; ask for more");
  masked.wrong_share = static_cast<double>(masked.wrong) / static_cast<double>(masked.steps);
  masked.undecided_share = static_cast<double>(masked.undecided) / static_cast<double>(masked.steps);
  masked.wrong_interval = interval_of(masked.wrong, masked.steps);
  masked.undecided_interval = interval_of(masked.undecided, masked.steps);
  result_.figures.push_back(at_most(where + ": wrong head committed", 100.0 * masked.wrong_share, "%", 0.05));
  result_.figures.push_back(at_most(where + ": undecided", 100.0 * masked.undecided_share, "%", 1.5));
}

void TrackingBench::drive() {
  const Deployment deployment(config_.deployment);
  common::ThreadPool pool(static_cast<std::size_t>(config_.threads));
  TrackedTrials& trials = result_.trials.emplace();
  MaskedTape& masked = result_.masked_while_driven.emplace();
  const vision::CommandedField field(config_.deployment.rig);
  const std::int64_t count = config_.deployment.trials.count;
  common::Progress progress("trials", 2 * count);
  for (const char* task : {"square", "circle"})
    for (std::int64_t first = 0; first < count; first += static_cast<std::int64_t>(pool.size())) {
      if (common::interrupted()) throw common::Interrupted("bench tracking: stopped by the user");
      std::vector<TrialPlan> plans;
      const std::int64_t last = std::min(count, first + static_cast<std::int64_t>(pool.size()));
      for (std::int64_t index = first; index < last; ++index)
        plans.push_back(plan_trial(config_.deployment, task, index, std::nullopt, std::nullopt,
                                   [&](const geometry::Pose2& pose) { return deployment.fits(pose); }));
      for (const TrialResult& trial : deployment.run(plans, RigKind::kUnseen, source_, pool)) {
        add_trial(trial, trials);
        add_steps(trial, field, config_.deployment.sensor.camera.min_head_probability, masked);
      }
      progress.update(trials.trials, task);
    }
  progress.finish();
  close(masked, "masked tape, driven");
  trials.lost_interval = interval_of(trials.lost, trials.trials);
  result_.figures.push_back(
      at_most("trials that ended for want of a pose", static_cast<double>(trials.lost), "", 0.0));
  result_.figures.push_back(
      at_most("poses with head and tail exchanged", static_cast<double>(trials.flipped), "", 0.0));
}

}  // namespace lodestone::experiments
