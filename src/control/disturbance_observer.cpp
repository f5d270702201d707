#include "lodestone/control/disturbance_observer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lodestone::control {
namespace {

/// One pulse is not believed to say more of the gain than a factor of this.
constexpr double kGainOfOnePulse = 2.0;
constexpr int kGainHalvings = 8;  // to half a per cent

}  // namespace

DisturbanceObserver::DisturbanceObserver(std::shared_ptr<const PulseModel> model,
                                         const ObserverConfig& config)
    : model_(std::move(model)), config_(config) {
  reset();
}

void DisturbanceObserver::reset() {
  gain_ = config_.first_gain;
  disturbance_m_.setZero();
  drift_m_.setZero();
}

geometry::Vector2 DisturbanceObserver::modelled_m(const geometry::Pose2& before,
                                                  const geometry::Drive& drive_A, double gain) const {
  return model_->after(before, drive_A, gain).position_m() - before.position_m();
}

geometry::Pose2 DisturbanceObserver::after(const geometry::Pose2& pose,
                                           const geometry::Drive& drive_A) const {
  geometry::Pose2 then = drive_A.isZero(0.0) ? pose : modelled(pose, drive_A);
  const bool held = then.position_m() == pose.position_m();
  const geometry::Vector2& carried_m = held ? drift_m_ : disturbance_m_;
  then.x_m += carried_m.x();
  then.y_m += carried_m.y();
  return then;
}

void DisturbanceObserver::filter(const geometry::Vector2& seen_m, geometry::Vector2& estimate_m) const {
  estimate_m += config_.disturbance_share * (seen_m - estimate_m);
  const double length_m = estimate_m.norm();
  if (length_m > config_.most_disturbance_m) estimate_m *= config_.most_disturbance_m / length_m;
}

void DisturbanceObserver::learn(const geometry::Pose2& before, const geometry::Drive& drive_A,
                                const geometry::Vector2& moved_m) {
  if (drive_A.isZero(0.0)) {
    filter(moved_m, drift_m_);
    filter(moved_m, disturbance_m_);  // what holds a needle at rest is no disturbance of the next pulse
    return;
  }
  if (config_.gain_share > 0.0) learn_gain(before, drive_A, moved_m);
  // What the gain explains is no disturbance.
  filter(stuck(moved_m) ? drift_m_ : geometry::Vector2(moved_m - modelled_m(before, drive_A, gain_)),
         disturbance_m_);
}

void DisturbanceObserver::learn_gain(const geometry::Pose2& before, const geometry::Drive& drive_A,
                                     const geometry::Vector2& moved_m) {
  double low = std::max(gain_ / kGainOfOnePulse, 1.0 / kMostGain);
  double high = std::min(gain_ * kGainOfOnePulse, kMostGain);
  geometry::Vector2 said_m = modelled_m(before, drive_A, gain_);
  if (said_m.norm() < config_.still_m) said_m = modelled_m(before, drive_A, high);
  if (said_m.norm() < config_.still_m) return;  // too weak a pulse to say anything
  const geometry::Vector2 along = said_m.normalized();
  const bool held = stuck(moved_m);
  const double seen_m = held ? 0.0 : std::max(0.0, (moved_m - disturbance_m_).dot(along));
  for (int i = 0; i < kGainHalvings; ++i) {
    const double middle = std::sqrt(low * high);
    (modelled_m(before, drive_A, middle).dot(along) > seen_m ? high : low) = middle;
  }
  // That a pulse moved nothing which would have moved nothing anyway does not make the rig stronger.
  const double seen = held ? std::min(low, gain_) : low;
  gain_ *= std::pow(seen / gain_, config_.gain_share);
}

}  // namespace lodestone::control
