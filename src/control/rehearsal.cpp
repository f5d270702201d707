#include "lodestone/control/rehearsal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::control {
namespace {

using geometry::Pose2;
using geometry::Stitch;
using geometry::Vector2;

Vector2 left_of(const Pose2& end) { return {-std::sin(end.heading_rad), std::cos(end.heading_rad)}; }

Pose2 moved_left(const Pose2& end, double by_m) {
  const Vector2 point_m = end.position_m() + by_m * left_of(end);
  return {point_m.x(), point_m.y(), end.heading_rad};
}

/// Whether a needle has come past the line across an end, and how far to the left of that.
class Crossing {
 public:
  explicit Crossing(const Pose2& end) : end_(end) {}

  void see(const Pose2& needle) {
    const Vector2 off_m = needle.position_m() - end_.position_m();
    const Vector2 ahead(std::cos(end_.heading_rad), std::sin(end_.heading_rad));
    const Vector2 now_m(off_m.dot(ahead), off_m.dot(left_of(end_)));  // beyond, left
    if (!passed_ && now_m.x() >= 0.0) {
      passed_ = true;
      const bool came = before_m_ && before_m_->x() < 0.0;
      const double share = came ? -before_m_->x() / (now_m.x() - before_m_->x()) : 1.0;
      left_m_ = came ? before_m_->y() + share * (now_m.y() - before_m_->y()) : now_m.y();
    }
    before_m_ = now_m;
  }
  bool passed() const { return passed_; }
  double left_m() const { return left_m_; }

 private:
  Pose2 end_;
  std::optional<Vector2> before_m_;
  bool passed_ = false;
  double left_m_ = 0.0;
};

/// What controller and simulator make of a needle, period by period.
class ImaginedNeedle {
 public:
  ImaginedNeedle(const Rehearsal& with, const Pose2& lies, std::uint64_t way, common::RandomStream random)
      : with_(with), lies_(lies), way_(way), random_(std::move(random)) {
    observation_.last_action = geometry::Drive::Zero(with.action.size);
  }

  const Pose2& lies() const { return lies_; }
  void step(double time_s, const Vector2& target_m, const Reference& reference) {
    observation_.pose = lies_;
    observation_.target_m = target_m;
    observation_.target_heading_rad = reference.target_heading_rad();
    observation_.ahead = reference.ahead(time_s, with_.period_s, kStepsAhead);
    const geometry::Drive action = geometry::saturated(with_.controller.act(observation_));
    if (!action.isZero(0.0)) pulse(with_.drive_per_A * task::drive_of(action, with_.action));
    observation_.last_action = action;
    observation_.last_displacement_m = lies_.position_m() - observation_.pose.position_m();
  }

 private:
  void pulse(const geometry::Drive& drive) {
    const std::array<double, 3> before{lies_.x_m, lies_.y_m, lies_.heading_rad};
    std::array<double, 3> after{};
    with_.foresight.foresee(way_, 0, before.data(), drive.data(), 1, random_, after.data());
    lies_ = {after[0], after[1], geometry::wrap_angle(after[2])};
  }

  const Rehearsal& with_;
  Pose2 lies_;
  std::size_t way_;
  common::RandomStream random_;
  task::Observation observation_;
};

/// The stitch to aim at, by how often and how far the needle has passed beside this one.
Stitch aimed(const Stitch& stitch, const std::vector<Passed>& passed, double most_m) {
  double entry_m = 0.0, exit_m = 0.0;
  for (const Passed& each : passed) {
    entry_m += each.entry_m / static_cast<double>(passed.size());
    exit_m += each.exit_m / static_cast<double>(passed.size());
  }
  const double by_m = -0.5 * (entry_m + exit_m);
  const auto within = [most_m](double left_m) { return std::clamp(left_m, -most_m, most_m); };
  return {moved_left(stitch.entry, within(entry_m + by_m)), moved_left(stitch.exit, within(exit_m + by_m))};
}

}  // namespace

std::optional<Passed> rehearse(const Stitch& stitch, const SutureReferenceConfig& config,
                               const Rehearsal& with, std::uint64_t seed, std::uint64_t turn) {
  LODESTONE_CHECK(with.foresight.facts().state_size == 3, "a simulator that knows headings");
  SutureReference reference({stitch}, config);
  reference.reset();
  with.controller.reset();
  const Vector2 from_m = reference.way().at(0.0);
  ImaginedNeedle needle(with, {from_m.x(), from_m.y(), stitch.entry.heading_rad},
                        turn % with.foresight.facts().ways, common::RandomStream(seed, "rehearsal", turn));
  Crossing entry(stitch.entry), exit(stitch.exit);
  for (std::int64_t step = 0; !exit.passed(); ++step) {
    entry.see(needle.lies());
    exit.see(needle.lies());
    const double time_s = static_cast<double>(step) * with.period_s;
    const Vector2 target_m = reference.target(time_s, needle.lies());
    if (exit.passed() || reference.finished(time_s)) break;
    needle.step(time_s, target_m, reference);
  }
  if (!exit.passed()) return std::nullopt;
  return Passed{entry.left_m(), exit.left_m()};
}

std::vector<Stitch> rehearsed(const std::vector<Stitch>& stitches, const SutureReferenceConfig& config,
                              const Rehearsal& with, std::uint64_t seed) {
  std::vector<Stitch> aims = stitches;
  for (std::size_t i = 0; i < stitches.size(); ++i) {
    std::vector<Passed> passed;
    const auto count = static_cast<std::uint64_t>(config.rehearsals);
    for (std::uint64_t turn = 0; turn < count && passed.size() == turn; ++turn)
      if (const auto each = rehearse(stitches[i], config, with, common::derive_seed(seed, "stitch", i), turn))
        passed.push_back(*each);
    if (!passed.empty() && passed.size() == count) aims[i] = aimed(stitches[i], passed, config.aside_m);
  }
  return aims;
}

}  // namespace lodestone::control
