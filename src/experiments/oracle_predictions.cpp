#include "lodestone/experiments/oracle_predictions.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/named.h"
#include "lodestone/common/random.h"
#include "lodestone/experiments/oracle.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/mean_pose.h"
#include "lodestone/physics/coil_drive.h"
#include "lodestone/rig/virtual_rig.h"

namespace lodestone::experiments {
namespace {

constexpr auto& kSteps = runs::OpenLoopError::kSteps;

/// A pulse of the recording from which the twin runs on by itself.
struct Chain {
  const data::Episode* episode;
  std::int64_t first;
};

/// Squared errors of some predictions.
struct Squares {
  double position_m2 = 0.0, heading_rad2 = 0.0;
  std::int64_t count = 0;

  void add(const geometry::Pose2& predicted, const geometry::Pose2& seen) {
    position_m2 += (predicted.position_m() - seen.position_m()).squaredNorm();
    heading_rad2 += std::pow(geometry::wrap_angle(predicted.heading_rad - seen.heading_rad), 2);
    ++count;
  }
  Squares& operator+=(const Squares& other) {
    position_m2 += other.position_m2;
    heading_rad2 += other.heading_rad2;
    count += other.count;
    return *this;
  }
  runs::StateError error() const {
    const auto n = static_cast<double>(count);
    return {geometry::kMmPerM * std::sqrt(position_m2 / n),
            geometry::kDegPerRad * std::sqrt(heading_rad2 / n)};
  }
};

/// What one shard finds: of single pulses with current, and by kSteps.
struct Found {
  Squares one_step;
  Squares open_loop[std::size(kSteps)];
};

geometry::Pose2 pose_at(const data::Episode& episode, std::int64_t row) {
  const double* state = &episode.observations[static_cast<std::size_t>(3 * row)];
  return {state[0], state[1], state[2]};
}

class Twin {
 public:
  Twin(const CollectionConfig& recorded, std::shared_ptr<const physics::CoilFields> fields,
       std::int64_t outcomes)
      : config_(recorded),
        drive_(recorded.rig),
        rig_(recorded.rig, static_cast<std::uint64_t>(recorded.rig_seed), std::move(fields)),
        cold_(rig_.save()),
        ends_(static_cast<std::size_t>(outcomes)) {}

  /// Runs on from there as far as kSteps and the episode go.
  void foretell(const Chain& chain, std::uint64_t number, Found& found) {
    const std::int64_t steps =
        std::min<std::int64_t>(chain.episode->length() - chain.first, *std::rbegin(kSteps));
    for (std::size_t k = 0; k < ends_.size(); ++k) run(chain, steps, number * ends_.size() + k, ends_[k]);
    std::vector<geometry::Pose2> poses(ends_.size());
    for (std::size_t i = 0; i < std::size(kSteps) && kSteps[i] <= steps; ++i) {
      for (std::size_t k = 0; k < ends_.size(); ++k)
        poses[k] = ends_[k][static_cast<std::size_t>(kSteps[i] - 1)];
      const geometry::Pose2 seen = pose_at(*chain.episode, chain.first + kSteps[i]);
      const geometry::Pose2 mean = geometry::mean_pose(poses);
      found.open_loop[i].add(mean, seen);
      if (kSteps[i] == 1 && !action(chain, 0).isZero(0.0)) found.one_step.add(mean, seen);
    }
  }

 private:
  geometry::Drive action(const Chain& chain, std::int64_t step) const {
    const std::int64_t row = chain.first + step;
    return geometry::as_drive(&chain.episode->actions[static_cast<std::size_t>(drive_.size() * row)],
                              drive_.size());
  }

  /// Where the needle lies after each of the pulses, by one draw of the scatter.
  void run(const Chain& chain, std::int64_t steps, std::uint64_t draw, std::vector<geometry::Pose2>& ends) {
    common::Json start = cold_;
    start["scatter"] = common::RandomStream(draw, "what the oracle expects").save();
    rig_.restore(start);
    lay(rig_, pose_at(*chain.episode, chain.first));
    ends.clear();
    for (std::int64_t step = 0; step < steps; ++step) {
      const geometry::Drive drive_A = action(chain, step);
      if (!drive_A.isZero(0.0))
        rig_.coils().apply({drive_.current_A(drive_A, rig_.true_pose().position_m()), config_.loop.pulse_s});
      rig_.clock().wait_until(rig_.clock().now_s() + config_.loop.period_s(), nullptr);
      ends.push_back(rig_.true_pose());
    }
  }

  const CollectionConfig& config_;
  physics::CoilDrive drive_;
  rig::VirtualRig rig_;
  common::Json cold_;
  std::vector<std::vector<geometry::Pose2>> ends_;  // [outcomes][steps]
};

}  // namespace

void add_oracle(const CollectionConfig& recorded, const data::Dataset& dataset, std::int64_t outcomes,
                common::ThreadPool& pool, runs::DynamicsBaselines& baselines) {
  if (recorded.rig.real())
    throw common::InvalidConfig("rig.backend", common::name_of(recorded.rig.backend),
                                "be virtual: of a real rig nobody knows what the oracle knows");
  if (recorded.rig.needle.is_sphere())
    throw common::InvalidConfig("rig.needle.shape", common::name_of(recorded.rig.needle.shape),
                                "be needle: the oracle does not know spheres");
  if (dataset.info.action_size != recorded.rig.drive_size() || dataset.info.action_unit != "A" ||
      data::state_size(dataset.info.layout) != 3)
    throw common::DataError(
        "the data are of another drive, or another state, than the rig that they are said "
        "to be of");
  std::vector<Chain> chains;
  for (const data::Episode& episode : dataset.episodes)
    for (std::int64_t t = 0; t < episode.length(); ++t) chains.push_back({&episode, t});
  if (chains.empty()) throw common::DataError("there is no pulse to foretell");
  const auto fields = rig::VirtualRig(recorded.rig, static_cast<std::uint64_t>(recorded.rig_seed)).fields();
  constexpr std::size_t kChainsOfShard = 64;
  const std::size_t shards = (chains.size() + kChainsOfShard - 1) / kChainsOfShard;
  std::vector<Found> found(shards);
  pool.for_each(shards, [&](std::size_t shard) {
    Twin twin(recorded, fields, outcomes);
    const std::size_t end = std::min(chains.size(), (shard + 1) * kChainsOfShard);
    for (std::size_t i = shard * kChainsOfShard; i < end; ++i) twin.foretell(chains[i], i, found[shard]);
  });
  Found all;
  for (const Found& each : found) {
    all.one_step += each.one_step;
    for (std::size_t i = 0; i < std::size(kSteps); ++i) all.open_loop[i] += each.open_loop[i];
  }
  if (all.one_step.count == 0) throw common::DataError("there is no pulse with current to foretell");
  baselines.oracle = all.one_step.error();
  runs::OpenLoopError& ahead = baselines.oracle_open_loop.emplace();
  ahead.k_step_mm.emplace();
  ahead.k_step_heading_deg.emplace();
  for (std::size_t i = 0; i < std::size(kSteps); ++i) {
    const int steps = kSteps[i];
    const bool any = all.open_loop[i].count > 0;
    const runs::StateError error = any ? all.open_loop[i].error() : runs::StateError{};
    (*ahead.k_step_mm)[steps] = any ? std::optional<double>(error.position_rms_mm) : std::nullopt;
    (*ahead.k_step_heading_deg)[steps] = any ? error.heading_rms_deg : std::nullopt;
  }
}

}  // namespace lodestone::experiments
