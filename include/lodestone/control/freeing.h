#pragma once

#include <cstdint>

#include "lodestone/common/config.h"
#include "lodestone/control/dipole_pull.h"
#include "lodestone/control/driven_field.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::control {

/// How a needle that is stuck is freed.
struct FreeingConfig {
  std::int64_t max_pulses = 40;
  double growth = 1.5;
  double dither_deg = 30.0;
  double turn_A = 1.5;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("max_pulses", max_pulses, "pulses",
            "so many in a row that do not free the needle, and the operator is asked to place it",
            {1, 100000});
    v.field("growth", growth, "", "factor on a pull that did not free it, up to the largest current",
            {1.0, 10.0});
    v.field("dither_deg", dither_deg, "deg",
            "where the largest current does not free it, pulls go so far to one side of the centre, to the "
            "other, then further, at last along the wall",
            {1.0, 90.0});
    v.field("turn_A", turn_A, "A", "current of the pulses between that turn it and hardly pull",
            {0.0, 1000.0});
  }
};

/// Pulses that free a needle which lies at the wall, before a coil, or where no coil pulls well: towards the
/// centre, first a little stronger than what breaks it loose, then ever stronger; then to both sides; and
/// turned between, as a needle that lies otherwise is held otherwise. Goes by sensed poses, and by the rig as
/// it is described.
class Freeing {
 public:
  Freeing(const FreeingConfig& config, const physics::RigDescription& rig);

  /// The needle is free, or has been placed elsewhere.
  void reset();
  /// The next pulse, as an action, for a needle that the one before has not freed.
  geometry::Drive next(const geometry::Pose2& pose);
  /// The pulses are used up.
  bool failed() const { return pulses_ >= config_.max_pulses; }

  /// Pulses so far, for bitwise resumption.
  common::Json save() const { return {{"pulses", pulses_}, {"full", full_}}; }
  void restore(const common::Json& state);

 private:
  /// As two numbers (physics::CoilDrive::along), each.
  geometry::Vector2 next_direction(const geometry::Pose2& pose);
  geometry::Vector2 pull(const geometry::Pose2& pose, double from_centre_rad, double force_N) const;
  geometry::Vector2 turn(const geometry::Pose2& pose, double by_rad) const;

  FreeingConfig config_;
  DrivenField field_;
  DipolePull pull_;
  double breakaway_N_;
  double max_current_A_;
  std::int64_t turns_;  // in a round; none of a sphere
  std::int64_t pulses_ = 0;
  std::int64_t full_ = 0;  // of these, since the largest current was reached
};

}  // namespace lodestone::control
