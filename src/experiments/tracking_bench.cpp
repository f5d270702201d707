#include "lodestone/experiments/tracking_bench.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodestone/common/build_facts.h"
#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/progress.h"
#include "lodestone/common/statistics.h"
#include "lodestone/experiments/collection.h"
#include "lodestone/experiments/track_checks.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/vision/commanded_field.h"
#include "lodestone/vision/pose_tracker.h"

namespace lodestone::experiments {
namespace {

constexpr double kClearTape = 20.0;     // log-odds of a head that is known
constexpr double kChiSquare95 = 5.991;  // of 2 degrees of freedom
constexpr double kSigma_m = 0.07e-3;    // on each axis
constexpr double kAxisSigma_rad = 0.5 * geometry::kRadPerDeg;

CollectionConfig exploration_of(const DeploymentConfig& deployment) {
  CollectionConfig config;
  config.seed = deployment.seed;
  config.rig_seed = deployment.rig_seed;
  config.rig = deployment.rig;
  config.loop = deployment.loop;
  config.safety = deployment.safety;
  config.sensor.kind = "simulated";
  // Strong pulses between placements move the needle farthest: the hardest to follow.
  config.explorer.self_reset = false;
  config.explorer.steering = 1.0;
  config.explorer.weak_fraction = 0.0;
  return config;
}

/// A sighting of the needle, or of its axis alone: then without a word about which end is the head.
vision::Sighting shown(const geometry::Pose2& pose, double tape_log_odds) {
  vision::Rod rod;
  rod.found = rod.axis_found = true;
  rod.pose = pose;
  rod.tape_log_odds = tape_log_odds;
  rod.covariance.diagonal() << kSigma_m * kSigma_m, kSigma_m * kSigma_m, kAxisSigma_rad * kAxisSigma_rad;
  return {0.0, {rod}, ""};
}

/// Tells heads whose tape is masked.
class MaskedHead {
 public:
  MaskedHead(const DeploymentConfig& config, std::shared_ptr<control::RigIdentifier> identifier,
             MaskedTape& result)
      : tracker_(config.sensor.tracker, config.rig),
        identifier_(std::move(identifier)),
        field_(config.rig),
        drive_(config.rig),
        looks_(config.sensor.tracker.looks),
        result_(result) {}

  /// What one pulse did: the head before it is known, of what came after it the axis.
  void add(const geometry::Pose2& before, const geometry::Drive& drive_A, const geometry::Pose2& after) {
    const physics::PerCoil current_A = drive_.current_A(drive_A, before.position_m());
    if (!field_.direction_rad(current_A, before.position_m())) return;
    tracker_.forget();
    for (int look = 0; look < 2; ++look) tracker_.see(shown(before, kClearTape));
    tracker_.pulse(current_A, outcomes(before, drive_A));
    vision::Track track;
    for (std::int64_t look = 0; look < looks_ && !track.seen; ++look) track = tracker_.see(shown(after, 0.0));
    ++result_.steps;
    if (!track.seen)
      ++result_.undecided;
    else if (std::cos(track.pose.heading_rad - after.heading_rad) < 0.0)
      ++result_.wrong;
    if (std::cos(after.heading_rad - before.heading_rad) < 0.0) ++result_.wrong_by_nearest;
    if (identifier_) identifier_->learn({before, drive_A, after});
  }
  void add(const data::Episode& episode) {
    for (std::int64_t step = 0; step < episode.length(); ++step) {
      const auto row = static_cast<std::size_t>(step);
      const double* pose = &episode.observations[3 * row];
      const double* drive = &episode.actions[static_cast<std::size_t>(drive_.size()) * row];
      add({pose[0], pose[1], pose[2]}, geometry::as_drive(drive, drive_.size()), {pose[3], pose[4], pose[5]});
    }
  }
  void add(const TrialResult& trial) {
    if (identifier_) identifier_->reset();
    for (std::size_t i = 1; i < trial.samples.size(); ++i)
      add(*trial.samples[i - 1].true_pose, trial.samples[i - 1].step.drive_A, *trial.samples[i].true_pose);
  }

 private:
  std::vector<physics::PulseOutcome> outcomes(const geometry::Pose2& before, const geometry::Drive& drive_A) {
    if (!identifier_) return {};
    return identifier_->outcomes(before, drive_A);
  }

  vision::PoseTracker tracker_;
  std::shared_ptr<control::RigIdentifier> identifier_;  // null: nobody has learned the rig
  vision::CommandedField field_;
  physics::CoilDrive drive_;
  std::int64_t looks_;
  MaskedTape& result_;
};

std::array<double, 2> interval_of(std::int64_t count, std::int64_t of) {
  const common::Interval interval = common::wilson_interval(count, of);
  return {interval.low, interval.high};
}

/// Counts over trials; closed, it is what they say.
class Tally {
 public:
  void add(const TrialResult& trial) {
    ++result_.trials;
    if (trial.stop_reason.rfind("no pose", 0) == 0) ++result_.lost;
    for (const TrialSample& sample : trial.samples) add(sample.step, *sample.true_pose);
  }
  TrackedTrials close() {
    result_.lost_interval = interval_of(result_.lost, result_.trials);
    if (poses_ > 0) result_.covered_share = static_cast<double>(covered_) / static_cast<double>(poses_);
    if (surprises_ > 0) result_.innovation = innovation_sum_ / static_cast<double>(surprises_);
    return result_;
  }

 private:
  void add(const control::StepRecord& step, const geometry::Pose2& truth) {
    const control::PoseEstimate& estimate = step.estimate;
    ++result_.observations;
    if (estimate.innovation) {
      innovation_sum_ += *estimate.innovation;
      ++surprises_;
    }
    if (!estimate.valid) {
      ++result_.unseen;
      result_.undecided += estimate.either_way ? 1 : 0;
      result_.driven_undecided += step.either_way ? 1 : 0;
      return;
    }
    ++poses_;
    const double error_m = (estimate.pose.position_m() - truth.position_m()).norm();
    result_.worst_mm = std::max(result_.worst_mm, 1e3 * error_m);
    // Of a normal error in the plane with this RMS, spread alike in all directions.
    if (error_m <= estimate.position_sigma_m * std::sqrt(0.5 * kChiSquare95)) ++covered_;
    if (std::cos(estimate.pose.heading_rad - truth.heading_rad) < 0.0) ++result_.flipped;
  }

  TrackedTrials result_;
  std::int64_t poses_ = 0, covered_ = 0, surprises_ = 0;
  double innovation_sum_ = 0.0;
};

}  // namespace

TrackingBench::TrackingBench(const TrackingBenchConfig& config)
    : config_(config),
      source_(config.dynamics.empty()
                  ? baseline_source(config.deployment)
                  : planner_source(config.deployment, load_simulator(config.deployment, config.dynamics))) {
  result_.machine = common::build_and_host_facts();
}

void TrackingBench::mask_tape() {
  const CollectionConfig exploration = exploration_of(config_.deployment);
  Collection collection(exploration);
  MaskedHead masked(config_.deployment, source_.identify ? source_.identify() : nullptr,
                    result_.masked_tape.emplace());
  common::Progress progress("masked tape", config_.transitions);
  for (std::int64_t recorded = 0; recorded < config_.transitions;) {
    if (common::interrupted()) throw common::Interrupted("bench tracking: stopped by the user");
    const data::Episode episode = collection.next_episode(config_.transitions - recorded);
    recorded += episode.length();
    masked.add(episode);
    progress.update(recorded, "");
  }
  progress.finish();
  close(*result_.masked_tape, "masked tape, explorer");
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

/// Trials 0 to count - 1 of a task, in portions that can be interrupted.
template <class Add>
void run_trials(const Deployment& deployment, const DeploymentConfig& config, const std::string& task,
                std::int64_t count, RigKind kind, const ControllerSource& source, common::ThreadPool& pool,
                const Add& add) {
  for (std::int64_t first = 0; first < count; first += static_cast<std::int64_t>(pool.size())) {
    if (common::interrupted()) throw common::Interrupted("bench tracking: stopped by the user");
    std::vector<TrialPlan> plans;
    const std::int64_t last = std::min(count, first + static_cast<std::int64_t>(pool.size()));
    for (std::int64_t index = first; index < last; ++index)
      plans.push_back(plan_trial(config, task, index, std::nullopt, std::nullopt,
                                 [&](const geometry::Pose2& pose) { return deployment.fits(pose); }));
    for (const TrialResult& trial : deployment.run(plans, kind, source, pool)) add(trial);
  }
}

void TrackingBench::drive() {
  const Deployment deployment(config_.deployment);
  common::ThreadPool pool(static_cast<std::size_t>(config_.threads));
  Tally tally;
  MaskedHead masked(config_.deployment, source_.identify ? source_.identify() : nullptr,
                    result_.masked_while_driven.emplace());
  const std::int64_t count = config_.deployment.trials.count;
  common::Progress progress("trials", 2 * count);
  std::int64_t done = 0;
  for (const char* task : {"square", "circle"})
    run_trials(deployment, config_.deployment, task, count, RigKind::kUnseen, source_, pool,
               [&](const TrialResult& trial) {
                 tally.add(trial);
                 masked.add(trial);
                 progress.update(++done, task);
               });
  progress.finish();
  close(*result_.masked_while_driven, "masked tape, driven");
  result_.trials = tally.close();
  const TrackedTrials& trials = *result_.trials;
  result_.figures.push_back(
      at_most("trials that ended for want of a pose", static_cast<double>(trials.lost), "", 0.0));
  result_.figures.push_back(
      at_most("poses with head and tail exchanged", static_cast<double>(trials.flipped), "", 0.0));
  result_.figures.push_back(
      at_most("region of 95 %: off by", 100.0 * std::abs(trials.covered_share - 0.95), "%", 2.0));
  result_.figures.push_back(at_most("normalised innovation: off its mean by",
                                    100.0 * std::abs(trials.innovation / 2.0 - 1.0), "%", 10.0));
}

void TrackingBench::drive_spoiled(const std::string& how, const session::SensorErrorConfig& errors,
                                  double least_success) {
  DeploymentConfig config = config_.deployment;
  config.sensor.kind = "simulated";
  config.sensor.simulated = errors;
  const Deployment deployment(config);
  common::ThreadPool pool(static_cast<std::size_t>(config_.threads));
  Tally tally;
  SpoiledTrials spoiled;
  spoiled.how = how;
  std::int64_t succeeded = 0;
  common::Progress progress(how, config_.spoiled_trials);
  std::int64_t done = 0;
  run_trials(deployment, config, "square", config_.spoiled_trials, RigKind::kExplored, source_, pool,
             [&](const TrialResult& trial) {
               tally.add(trial);
               succeeded += trial.truth->success ? 1 : 0;
               progress.update(++done, "squares");
             });
  progress.finish();
  spoiled.tracked = tally.close();
  spoiled.success_share = static_cast<double>(succeeded) / static_cast<double>(config_.spoiled_trials);
  spoiled.success_interval = interval_of(succeeded, config_.spoiled_trials);
  result_.figures.push_back(at_most(how + ": squares failed", 100.0 * (1.0 - spoiled.success_share), "%",
                                    100.0 * (1.0 - least_success)));
  result_.spoiled.push_back(spoiled);
}

void TrackingBench::spoil() {
  const session::SensorErrorConfig errors = config_.deployment.sensor.simulated;
  for (const auto& [dropout, least_success] : {std::pair(0.1, 0.99), {0.3, 0.98}, {0.5, 0.95}}) {
    session::SensorErrorConfig spoiled = errors;
    spoiled.dropout = dropout;
    drive_spoiled(fmt::format("{:.0f} % of the images missing", 100.0 * dropout), spoiled, least_success);
  }
  session::SensorErrorConfig spoiled = errors;
  spoiled.outliers = 0.01;
  spoiled.flips = 0.01;
  const std::string how = "1 % of the images elsewhere, 1 % the wrong way round";
  drive_spoiled(how, spoiled, 0.0);
  const TrackedTrials& tracked = result_.spoiled.back().tracked;
  result_.figures.back() = at_most(how + ": largest error", tracked.worst_mm, "mm", 3.0);
  result_.figures.push_back(
      at_most(how + ": head and tail exchanged", static_cast<double>(tracked.flipped), "", 0.0));
}

void TrackingBench::check() {
  constexpr std::int64_t kTries = 100;
  constexpr double kFloor_mm = 0.1;
  const DeploymentConfig& config = config_.deployment;
  const auto figure = [&](const std::string& name, double value, const std::string& unit, double bound) {
    result_.figures.push_back(at_most(name, value, unit, bound));
  };
  figure("moved 30 mm by hand: looks until found", static_cast<double>(looks_until_found(config, kTries)), "",
         3.0);
  for (const std::int64_t steps : {6, 12, 24}) {
    BlindDrive most;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const BlindDrive blind = drive_blind(config, steps, seed);
      most.pulses = std::max(most.pulses, blind.pulses);
      most.most_A = std::max(most.most_A, blind.most_A);
    }
    const std::string how = fmt::format("blind for {} steps: ", steps);
    figure(how + "pulses", static_cast<double>(most.pulses), "", 6.0);
    figure(how + "largest current", most.most_A, "A", 2.0);
  }
  for (const std::int64_t steps : {3, 6, 12}) {
    std::int64_t taken = 0, lost = 0;
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
      const DistractedDrive distracted = drive_distracted(config, steps, seed);
      taken += distracted.taken > 0 ? 1 : 0;
      lost += distracted.found ? 0 : 1;
    }
    const std::string how = fmt::format("hidden for {} steps among 3 scratches, 50 times: ", steps);
    figure(how + "one taken for the needle", static_cast<double>(taken), "", 0.0);
    figure(how + "needle not found again", static_cast<double>(lost), "", 0.0);
  }
  figure("10 minutes of lying still: spread below its floor by",
         std::max(0.0, kFloor_mm - 1e3 * least_spread_m(config, 600.0)), "mm", 1e-6);
  figure("tracker, a pulse and a look",
         tracker_ms(config, 20000, source_.identify ? source_.identify() : nullptr), "ms", 0.1);
}

}  // namespace lodestone::experiments
