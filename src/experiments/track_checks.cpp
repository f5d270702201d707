#include "lodestone/experiments/track_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/control/reference.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/task/task.h"

namespace lodestone::experiments {
namespace {

constexpr double kMoved_m = 0.03;
constexpr double kFound_m = 1e-3;

session::SensorErrorConfig never_missing(session::SensorErrorConfig errors) {
  errors.dropout = 0.0;
  return errors;
}

/// A virtual rig, seen by the simulated localiser in every image.
struct SeenRig {
  SeenRig(const DeploymentConfig& config, std::uint64_t seed)
      : rig(config.rig, seed),
        detector([this] { return rig.true_pose(); }, rig.clock(), never_missing(config.sensor.simulated), {},
                 common::RandomStream(seed, "sensor noise")) {}
  rig::VirtualRig rig;
  session::SimulatedDetector detector;
};

/// Sees nothing for a while.
class BlindFor final : public control::PoseSensor {
 public:
  BlindFor(control::PoseSensor& sensor, std::int64_t from, std::int64_t steps)
      : sensor_(sensor), from_(from), steps_(steps) {}
  control::PoseEstimate observe() override {
    control::PoseEstimate seen = sensor_.observe();
    const bool blind = step_ >= from_ && step_ < from_ + steps_;
    ++step_;
    if (!blind) return seen;
    seen.valid = false;
    seen.reason = "covered";
    return seen;
  }
  void pulsed(const physics::PerCoil& current_A,
              const std::vector<physics::PulseOutcome>& outcomes) override {
    sensor_.pulsed(current_A, outcomes);
  }
  void pulse_cut() override { sensor_.pulse_cut(); }

 private:
  control::PoseSensor& sensor_;
  std::int64_t from_, steps_, step_ = 0;
};

/// Scratches in the dish, which are seen from a time on, and until another one without the needle.
class Scratched final : public session::NeedleDetector {
 public:
  Scratched(session::NeedleDetector& inner, double from_s, double until_s, double dish_radius_m,
            std::uint64_t seed)
      : inner_(inner), from_s_(from_s), until_s_(until_s) {
    common::RandomStream random(seed, "scratches");
    for (int i = 0; i < 3; ++i) {
      const geometry::Vector2 at_m = task::draw_in_disc(0.7 * dish_radius_m, random);
      scratches_.push_back({at_m.x(), at_m.y(), 2.0 * geometry::kPi * random.uniform()});
    }
  }
  vision::Sighting look() override {
    vision::Sighting sighting = inner_.look();
    if (sighting.stamp_s < from_s_ || sighting.candidates.empty()) return sighting;
    const vision::Rod needle = sighting.candidates.front();
    if (sighting.stamp_s < until_s_) sighting.candidates.clear();
    for (const geometry::Pose2& pose : scratches_) {
      sighting.candidates.push_back(needle);
      sighting.candidates.back().pose = pose;
    }
    return sighting;
  }
  void reset() override { inner_.reset(); }

 private:
  session::NeedleDetector& inner_;
  double from_s_, until_s_;
  std::vector<geometry::Pose2> scratches_;
};

}  // namespace

std::int64_t looks_until_found(const DeploymentConfig& config, std::int64_t count) {
  constexpr std::int64_t kMost = 1000;
  std::int64_t most = 0;
  common::RandomStream random(static_cast<std::uint64_t>(config.seed), "moved by hand");
  for (std::int64_t i = 0; i < count; ++i) {
    SeenRig seen(config, common::derive_seed(static_cast<std::uint64_t>(config.seed), "moved", i));
    vision::PoseTracker tracker(config.sensor.tracker, config.rig);
    const double way_rad = 2.0 * geometry::kPi * random.uniform();
    const geometry::Vector2 half_m = 0.5 * kMoved_m * geometry::Vector2(std::cos(way_rad), std::sin(way_rad));
    seen.rig.place({-half_m.x(), -half_m.y(), 2.0 * geometry::kPi * random.uniform()});
    for (int look = 0; look < 5; ++look) tracker.see(seen.detector.look());
    seen.rig.place({half_m.x(), half_m.y(), 2.0 * geometry::kPi * random.uniform()});
    std::int64_t looks = 0;
    for (bool found = false; !found && looks < kMost; ++looks) {
      const vision::Track track = tracker.see(seen.detector.look());
      found = track.seen && (track.pose.position_m() - half_m).norm() < kFound_m;
    }
    most = std::max(most, looks);
  }
  return most;
}

BlindDrive drive_blind(const DeploymentConfig& config, std::int64_t steps, std::uint64_t seed) {
  constexpr std::int64_t kFrom = 10;
  SeenRig seen(config, seed);
  seen.rig.place({-0.02, -0.012, 0.7});
  session::TrackedPoseSensor sensor(seen.detector, config.sensor.tracker, config.rig, seen.rig.clock());
  BlindFor blinded(sensor, kFrom, steps);
  safety::Supervisor coils(seen.rig.coils(), config.safety, config.rig, seen.rig.clock());
  const ControllerSource source = baseline_source(config);
  control::ControlLoop loop(config.loop, source.action, coils, blinded, seen.rig.clock(), &config.rig);
  control::PointReference far({0.025, 0.02},
                              static_cast<double>(kFrom + steps + 10) * config.loop.period_s());
  BlindDrive result;
  loop.run(*source.make(seed), far, [&](const control::StepRecord& record) {
    const double most_A = *std::max_element(record.current_A.begin(), record.current_A.end());
    if (record.estimate.valid || most_A == 0.0) return;
    ++result.pulses;
    result.most_A = std::max(result.most_A, most_A);
  });
  return result;
}

DistractedDrive drive_distracted(const DeploymentConfig& config, std::int64_t steps, std::uint64_t seed) {
  constexpr std::int64_t kFrom = 10;
  SeenRig seen(config, seed);
  seen.rig.place({-0.02, -0.012, 0.7});
  const double start_s = seen.rig.clock().now_s();
  const auto begins_s = [&](std::int64_t step) {
    return start_s + (static_cast<double>(step) - 0.5) * config.loop.period_s();
  };
  Scratched scratched(seen.detector, begins_s(kFrom), begins_s(kFrom + steps), config.rig.dish.radius_m,
                      seed);
  session::TrackedPoseSensor sensor(scratched, config.sensor.tracker, config.rig, seen.rig.clock());
  safety::Supervisor coils(seen.rig.coils(), config.safety, config.rig, seen.rig.clock());
  const ControllerSource source = baseline_source(config);
  control::ControlLoop loop(config.loop, source.action, coils, sensor, seen.rig.clock(), &config.rig);
  control::PointReference far({0.025, 0.02},
                              static_cast<double>(kFrom + steps + 20) * config.loop.period_s());
  DistractedDrive result;
  loop.run(*source.make(seed), far, [&](const control::StepRecord& record) {
    if (!record.estimate.valid) return;
    const bool right =
        (record.estimate.pose.position_m() - seen.rig.true_pose().position_m()).norm() < kFound_m;
    result.taken += right ? 0 : 1;
    result.found = right && record.time_s > begins_s(kFrom + steps) - start_s;
  });
  return result;
}

double least_spread_m(const DeploymentConfig& config, double lies_s) {
  SeenRig seen(config, static_cast<std::uint64_t>(config.seed));
  seen.rig.place({0.01, -0.005, 0.3});
  vision::PoseTracker tracker(config.sensor.tracker, config.rig);
  double least_m = std::numeric_limits<double>::infinity();
  for (double time_s = 0.0; time_s < lies_s; time_s += config.loop.period_s()) {
    const vision::Track track = tracker.see(seen.detector.look());
    if (track.located)
      least_m = std::min(least_m, std::sqrt(track.covariance(0, 0) + track.covariance(1, 1)));
  }
  return least_m;
}

double tracker_ms(const DeploymentConfig& config, std::int64_t steps,
                  const std::shared_ptr<control::RigIdentifier>& identifier) {
  SeenRig seen(config, static_cast<std::uint64_t>(config.seed));
  seen.rig.place({0.01, -0.005, 0.3});
  vision::PoseTracker tracker(config.sensor.tracker, config.rig);
  const vision::Sighting sighting = seen.detector.look();
  for (int look = 0; look < 3; ++look) tracker.see(sighting);
  const common::SteadyClock clock;
  const double start_s = clock.now_s();
  for (std::int64_t step = 0; step < steps; ++step) {
    tracker.pulse({1.0, 0.0, 0.5, 0.0},
                  identifier ? identifier->outcomes(sighting.candidates.front().pose, {1.0, 0.5})
                             : std::vector<physics::PulseOutcome>{});
    tracker.see(sighting);
  }
  return 1e3 * (clock.now_s() - start_s) / static_cast<double>(steps);
}

}  // namespace lodestone::experiments
