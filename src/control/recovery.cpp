#include "lodestone/control/recovery.h"

#include <cmath>

#include "lodestone/geometry/angle.h"

namespace lodestone::control {

namespace {
constexpr double kTurn_rad = 60.0 * geometry::kRadPerDeg;
constexpr std::int64_t kStepsPerProbe =
    2;  // so that an image is taken of what the probe did, and one after it
}  // namespace

Recovery::Recovery(const RecoveryConfig& config, const physics::RigDescription& rig)
    : config_(config), field_(rig), pull_(rig) {
  if (rig.needle.is_sphere()) config_.turning_probes = 0;  // it looks the same
}

void Recovery::reset() {
  last_.reset();
  blind_ = 0;
}

void Recovery::seen(const geometry::Pose2& pose) {
  last_ = pose;
  blind_ = 0;
}

std::optional<geometry::Drive> Recovery::next_probe() {
  ++blind_;
  if (blind_ % kStepsPerProbe != 0) return std::nullopt;
  const std::int64_t probe = blind_ / kStepsPerProbe - 1;
  if (probe < config_.turning_probes) return turn(probe);
  if (probe < config_.turning_probes + config_.pulling_probes) return pull();
  return std::nullopt;
}

geometry::Drive Recovery::turn(std::int64_t index) const {
  const geometry::Pose2 from = last_.value_or(geometry::Pose2{});
  const double heading_rad = from.heading_rad + (index % 2 == 0 ? kTurn_rad : -kTurn_rad);
  const double current_A = index < 2 ? config_.turn_A : config_.turn_max_A;
  const geometry::Vector2 unit =
      unit_drive_along({std::cos(heading_rad), std::sin(heading_rad)}, [&](const geometry::Vector2& two) {
        return field_.at(field_.along(two, from.position_m()), from.position_m()).field_T;
      });
  return field_.along(current_A * unit, from.position_m());
}

std::optional<geometry::Drive> Recovery::pull() const {
  if (!last_ || last_->position_m().isZero(0.0)) return std::nullopt;
  const geometry::Drive drive_A =
      pull_.drive_A(-last_->position_m().normalized() * 1e-6, last_->position_m());
  if (drive_A.isZero(0.0)) return std::nullopt;
  return geometry::Drive(config_.pull_A * drive_A / drive_A.cwiseAbs().maxCoeff());
}

}  // namespace lodestone::control
