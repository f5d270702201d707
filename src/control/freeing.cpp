#include "lodestone/control/freeing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::control {

namespace {

constexpr double kFirstPull = 2.0;  // in units of the one that breaks the needle loose
constexpr double kWidestDither_rad = geometry::kPi / 2.0;
constexpr double kTurnLead_rad = 60.0 * geometry::kRadPerDeg;  // of the field before the needle
constexpr int kDrives = 72;                                    // that the strongest pull is searched among

/// 0, 1, -1, 2, -2, ...
std::int64_t alternating(std::int64_t index) { return index % 2 == 1 ? (index + 1) / 2 : -index / 2; }

}  // namespace

Freeing::Freeing(const FreeingConfig& config, const physics::RigDescription& rig)
    : config_(config),
      field_(rig),
      pull_(rig),
      breakaway_N_(rig.breakaway_N()),
      max_current_A_(rig.coils.max_current_A),
      turns_(rig.needle.is_sphere() ? 0 : 2) {}

void Freeing::reset() { pulses_ = full_ = 0; }

geometry::Drive Freeing::next(const geometry::Pose2& pose) {
  const geometry::Vector2 direction = next_direction(pose);
  return geometry::saturated_in_direction(field_.along(direction, pose.position_m()));
}

geometry::Vector2 Freeing::next_direction(const geometry::Pose2& pose) {
  const double force_N = kFirstPull * breakaway_N_ * std::pow(config_.growth, static_cast<double>(pulses_));
  ++pulses_;
  const geometry::Vector2 straight = pull(pose, 0.0, force_N);
  if (straight.cwiseAbs().maxCoeff() < 1.0) return straight;
  // A round: the straight pull, those to both sides, a turn to each.
  const double dither_rad = config_.dither_deg * geometry::kRadPerDeg;
  const std::int64_t pulls = 1 + 2 * static_cast<std::int64_t>(kWidestDither_rad / dither_rad + 1e-9);
  const std::int64_t at = full_++ % (pulls + turns_);
  if (at >= pulls) return turn(pose, at == pulls ? kTurnLead_rad : -kTurnLead_rad);
  return pull(pose, static_cast<double>(alternating(at)) * dither_rad, force_N);
}

/// The drives that pull most along the direction so far from that to the centre, as weak as `force_N` asks.
geometry::Vector2 Freeing::pull(const geometry::Pose2& pose, double from_centre_rad, double force_N) const {
  const geometry::Vector2 position_m = pose.position_m();
  const geometry::Vector2 inwards =
      position_m.isZero(0.0) ? geometry::Vector2(1.0, 0.0) : geometry::Vector2(-position_m.normalized());
  const geometry::Vector2 direction = Eigen::Rotation2Dd(from_centre_rad) * inwards;
  geometry::Vector2 best = geometry::Vector2::Zero();
  double most_N = -1.0;
  for (int i = 0; i < kDrives; ++i) {
    const double angle = 2.0 * geometry::kPi * i / kDrives;
    geometry::Vector2 drive(std::cos(angle), std::sin(angle));
    drive /= drive.cwiseAbs().maxCoeff();
    const double along_N =
        pull_.pull_N(field_.along(max_current_A_ * drive, position_m), position_m).dot(direction);
    if (along_N <= most_N) continue;
    most_N = along_N;
    best = drive;
  }
  return most_N > force_N ? geometry::Vector2(best * (force_N / most_N)) : best;
}

geometry::Vector2 Freeing::turn(const geometry::Pose2& pose, double by_rad) const {
  const double heading_rad = pose.heading_rad + by_rad;
  const geometry::Vector2 drive =
      unit_drive_along({std::cos(heading_rad), std::sin(heading_rad)}, [&](const geometry::Vector2& two) {
        return field_.at(field_.along(two, pose.position_m()), pose.position_m()).field_T;
      });
  return drive * std::min(1.0, config_.turn_A / max_current_A_);
}

void Freeing::restore(const common::Json& state) {
  pulses_ = state.at("pulses").get<std::int64_t>();
  full_ = state.at("full").get<std::int64_t>();
}

}  // namespace lodestone::control
