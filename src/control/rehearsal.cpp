#include "lodestone/control/rehearsal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/random.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/saturation.h"
#include "lodestone/task/action.h"

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

/// Whether a needle has come past the line across an end, near it, and how far to the left of it.
class Crossing {
 public:
  Crossing(const Pose2& end, double near_m) : end_(end), near_m_(near_m) {}

  void see(const Pose2& needle) {
    const Vector2 off_m = needle.position_m() - end_.position_m();
    const Vector2 ahead(std::cos(end_.heading_rad), std::sin(end_.heading_rad));
    const Vector2 now_m(off_m.dot(ahead), off_m.dot(left_of(end_)));  // beyond, left
    const Vector2 before_m = seen_ ? before_m_ : Vector2(0.0, now_m.y());
    seen_ = true;
    before_m_ = now_m;
    if (passed_ || now_m.x() < 0.0 || before_m.x() > 0.0) return;
    const double step_m = now_m.x() - before_m.x();
    const double share = step_m > 0.0 ? -before_m.x() / step_m : 1.0;
    left_m_ = before_m.y() + share * (now_m.y() - before_m.y());
    passed_ = std::abs(left_m_) <= near_m_;
  }
  bool passed() const { return passed_; }
  double left_m() const { return left_m_; }

 private:
  Pose2 end_;
  double near_m_;
  bool seen_ = false;
  Vector2 before_m_ = Vector2::Zero();
  bool passed_ = false;
  double left_m_ = 0.0;
};

/// What controller and simulator make of a needle, period by period.
class ImaginedNeedle {
 public:
  ImaginedNeedle(const Rehearsal& with, const Pose2& lies, std::size_t member, common::RandomStream random)
      : with_(with), lies_(lies), member_(member), random_(std::move(random)) {
    observation_.last_action = geometry::Drive::Zero(with.action.size);
  }

  const Pose2& lies() const { return lies_; }
  void step(double time_s, const Vector2& target_m, const Reference& reference) {
    observation_.pose = lies_;
    observation_.target_m = target_m;
    observation_.target_heading_rad = reference.target_heading_rad();
    observation_.ahead = reference.ahead(time_s, with_.period_s, kStepsAhead);
    const geometry::Drive action = geometry::saturated(with_.controller.act(observation_));
    pulse(with_.drive_per_A * task::drive_of(action, with_.action));
    observation_.last_action = action;
    observation_.last_displacement_m = lies_.position_m() - observation_.pose.position_m();
  }

 private:
  /// The simulator has seen neither pulses without current nor stronger ones than its largest.
  void pulse(const geometry::Drive& asked) {
    if (asked.isZero(0.0)) return;
    const geometry::Drive drive = geometry::saturated(asked, with_.foresight.facts().action.scale);
    const std::array<double, 3> before{lies_.x_m, lies_.y_m, lies_.heading_rad};
    std::array<double, 3> after{};
    with_.foresight.foresee(member_, 0, before.data(), drive.data(), 1, random_, after.data());
    lies_ = {after[0], after[1], geometry::wrap_angle(after[2])};
  }

  const Rehearsal& with_;
  Pose2 lies_;
  std::size_t member_;
  common::RandomStream random_;
  task::Observation observation_;
};

/// The stitch to aim at, by how far beside this one needles have passed in the mean: all of their way is
/// moved aside, so that it passes both ends alike.
Stitch aimed(const Stitch& stitch, const std::vector<Passed>& passed, double most_m) {
  double entry_m = 0.0, exit_m = 0.0;
  for (const Passed& each : passed) {
    entry_m += each.entry_m / static_cast<double>(passed.size());
    exit_m += each.exit_m / static_cast<double>(passed.size());
  }
  const double by_m = -0.5 * (entry_m + exit_m);
  const auto within = [most_m](double left_m) { return std::clamp(left_m, -most_m, most_m); };
  // From the entry the way comes from, and it is the exit where the needle will come out.
  return {moved_left(stitch.entry, within(by_m)), moved_left(stitch.exit, within(exit_m + by_m))};
}

}  // namespace

std::optional<Passed> rehearse(const Stitch& stitch, const SutureReferenceConfig& config,
                               const Rehearsal& with, std::uint64_t seed, std::uint64_t index) {
  LODESTONE_CHECK(with.foresight.facts().state_size == 3, "a simulator that knows headings");
  SutureReference reference({stitch}, config);
  reference.reset();
  with.controller.reset();
  const Vector2 from_m = reference.way().at(0.0);
  ImaginedNeedle needle(with, {from_m.x(), from_m.y(), stitch.entry.heading_rad},
                        index % with.foresight.facts().ways, common::RandomStream(seed, "rehearsal", index));
  const double near_m = 0.5 * (stitch.exit.position_m() - stitch.entry.position_m()).norm();
  Crossing entry(stitch.entry, near_m), exit(stitch.exit, near_m);
  for (std::int64_t step = 0; !exit.passed(); ++step) {
    entry.see(needle.lies());
    exit.see(needle.lies());
    const double time_s = static_cast<double>(step) * with.period_s;
    const Vector2 target_m = reference.target(time_s, needle.lies());
    if (exit.passed() || reference.finished(time_s)) break;
    needle.step(time_s, target_m, reference);
  }
  if (!entry.passed() || !exit.passed()) return std::nullopt;
  return Passed{entry.left_m(), exit.left_m()};
}

std::vector<Stitch> rehearsed(const std::vector<Stitch>& stitches, const SutureReferenceConfig& config,
                              const Rehearsal& with, std::uint64_t seed) {
  std::vector<Stitch> aims = stitches;
  if (config.aside_m == 0.0) return aims;
  const auto count = static_cast<std::uint64_t>(config.rehearsals);
  for (std::size_t i = 0; i < stitches.size(); ++i) {
    std::vector<Passed> passed;
    for (std::uint64_t index = 0; index < count && passed.size() == index; ++index) {
      if (common::interrupted()) throw common::Interrupted("rehearsals were cut short");
      if (const auto each =
              rehearse(stitches[i], config, with, common::derive_seed(seed, "stitch", i), index))
        passed.push_back(*each);
    }
    if (passed.size() == count && count > 0)
      aims[i] = aimed(stitches[i], passed, config.aside_m);
    else if (count > 0)
      common::log_warning("stitch " + std::to_string(i + 1) +
                          ": in a rehearsal the needle never came past its exit; it is aimed at as it is "
                          "(a longer suture.leave_m or a lower suture.speed_m_s may help)");
  }
  return aims;
}

}  // namespace lodestone::control
