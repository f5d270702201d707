#include "lodestone/control/residual_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodestone/geometry/angle.h"

namespace lodestone::control {
namespace {

constexpr std::size_t kDraws = 19;
constexpr double kUsualShare = 0.12;   // of surprises: simulators are not perfect either
constexpr double kChangedShare = 0.4;  // of them on a rig that it is worth telling of
constexpr double kEnough = 9.0;        // evidence, natural logarithm
constexpr double kStill_m = 0.5e-3;
constexpr double kStill_rad = 0.05;
constexpr double kAlike = 0.25;  // of the stronger of two drives

bool lies_still(const geometry::Pose2& a, const geometry::Pose2& b) {
  return (a.position_m() - b.position_m()).norm() < kStill_m &&
         std::abs(geometry::wrap_angle(a.heading_rad - b.heading_rad)) < kStill_rad;
}

}  // namespace

ResidualWatch::ResidualWatch(MotionModel model) : model_(std::move(model)), random_(1, "residual watch") {}

void ResidualWatch::reset() {
  random_ = common::RandomStream(1, "residual watch");
  evidence_ = 0.0;
  stalled_A_.clear();
}

bool ResidualWatch::changed() const { return evidence_ > kEnough; }

bool ResidualWatch::known_stall(const SeenPulse& pulse) {
  if (!lies_still(pulse.before, place_)) {
    place_ = pulse.before;
    stalled_A_.clear();
  }
  if (!lies_still(pulse.after, place_)) return false;
  const bool known = std::any_of(stalled_A_.begin(), stalled_A_.end(), [&](const auto& stalled_A) {
    return (pulse.drive_A - stalled_A).norm() < kAlike * std::max(pulse.drive_A.norm(), stalled_A.norm());
  });
  if (!known) stalled_A_.push_back(pulse.drive_A);
  return known;
}

void ResidualWatch::check(const SeenPulse& pulse, const task::DriveGain& gain) {
  if (pulse.drive_A.isZero(0.0) || known_stall(pulse)) return;
  const geometry::Vector2 drive_A = std::exp(gain.log_mean) * pulse.drive_A;
  draws_.assign(1, {pulse.before, drive_A, pulse.after});
  for (std::size_t k = 0; k < kDraws; ++k) {
    const double factor = std::exp(gain.log_mean + gain.log_sigma * random_.normal());
    draws_.push_back({pulse.before, drive_A, model_.draw(pulse.before, factor * pulse.drive_A, random_)});
  }
  model_.judge(draws_, ratio_);
  const bool surprising = ratio_.front() < *std::min_element(ratio_.begin() + 1, ratio_.end());
  evidence_ += surprising ? std::log(kChangedShare / kUsualShare)
                          : std::log((1.0 - kChangedShare) / (1.0 - kUsualShare));
  evidence_ = std::max(0.0, evidence_);
}

}  // namespace lodestone::control
