#include "lodestone/control/pulse_model.h"

#include <cmath>

namespace lodestone::control {
namespace {

/// Half as many steps as the simulator takes for itself: a controller asks it some two hundred times per
/// pulse.
constexpr double kModelStep_s = 1e-3;

}  // namespace

PulseModel::PulseModel(const physics::RigDescription& rig, double pulse_s, double rest_s)
    : drive_(rig), simulator_(rig, {kModelStep_s}), pulse_s_(pulse_s), rest_s_(rest_s) {}

geometry::Pose2 PulseModel::after(const geometry::Pose2& pose, const geometry::Drive& drive_A,
                                  double gain) const {
  physics::PerCoil current_A = drive_.current_A(drive_A, pose.position_m());
  for (double& one_A : current_A) one_A *= gain;
  return simulator_.step(pose, current_A, pulse_s_, rest_s_);
}

geometry::Drive PulseModel::full_action(double direction_rad, const geometry::Vector2& position_m) const {
  const geometry::Drive drive = drive_.along({std::cos(direction_rad), std::sin(direction_rad)}, position_m);
  const double largest = drive.cwiseAbs().maxCoeff();
  return largest > 0.0 ? geometry::Drive(drive / largest) : drive;
}

}  // namespace lodestone::control
