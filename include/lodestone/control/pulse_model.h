#pragma once

#include "lodestone/geometry/drive.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_drive.h"
#include "lodestone/physics/plain_simulator.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::control {

/// What a pulse does by the rig's description, and nothing else: the plain simulator (section IV-C) behind
/// the rig's drive. Nothing is learned, and nothing that is hidden in a rig is known. Stateless.
class PulseModel {
 public:
  /// Of a loop whose pulses and rests are so long.
  PulseModel(const physics::RigDescription& rig, double pulse_s, double rest_s);

  /// Where a pulse of a drive (A) and the rest after it take a needle that lies still. `gain`: factor on the
  /// coils' currents. Throws LogicFault for a drive of another size.
  geometry::Pose2 after(const geometry::Pose2& pose, const geometry::Drive& drive_A, double gain = 1.0) const;

  /// The strongest action whose field and pull have that direction (physics::CoilDrive::along), of the rig's
  /// size and with 1 as its largest number; zero where the coils have none.
  geometry::Drive full_action(double direction_rad, const geometry::Vector2& position_m) const;

 private:
  physics::CoilDrive drive_;
  physics::PlainSimulator simulator_;
  double pulse_s_, rest_s_;
};

}  // namespace lodestone::control
