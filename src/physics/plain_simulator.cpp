#include "lodestone/physics/plain_simulator.h"

#include <algorithm>
#include <cmath>

#include "lodestone/geometry/angle.h"

namespace lodestone::physics {

PlainSimulator::PlainSimulator(const RigDescription& rig, const PlainSimulatorConfig& config)
    : needle_(rig.needle),
      dish_radius_m_(rig.dish.radius_m),
      friction_N_(0.5 * (rig.friction.static_coefficient + rig.friction.kinetic_coefficient) *
                  rig.needle.net_weight_N),
      step_s_(config.step_s),
      field_(rig) {
  const double viscosity_Pa_s = rig.fluid.viscosity_Pa_s;
  // A capsule that is less than e times as long as thick is taken to be so: nearer to a sphere the drag of a
  // slender rod has no end.
  const double log_p = std::max(1.0, std::log(needle_.length_m / needle_.diameter_m));
  // Stokes drag of a slender rod far from walls; the mean of along (2 pi) and across (4 pi) serves every
  // direction.
  drag_N_s_m_ = 3.0 * geometry::kPi * viscosity_Pa_s * needle_.length_m / log_p;
  spin_drag_N_m_s_ = geometry::kPi * viscosity_Pa_s * std::pow(needle_.length_m, 3) / (3.0 * log_p);
  if (needle_.is_sphere()) drag_N_s_m_ = 3.0 * geometry::kPi * viscosity_Pa_s * needle_.diameter_m;
}

/// A sphere's is free to turn into the field.
geometry::Vector2 PlainSimulator::moment_A_m2(const geometry::Pose2& pose,
                                              const geometry::Vector2& field_T) const {
  if (!needle_.is_sphere())
    return needle_.moment_A_m2 * geometry::Vector2(std::cos(pose.heading_rad), std::sin(pose.heading_rad));
  const double strength_T = field_T.norm();
  if (strength_T == 0.0) return geometry::Vector2::Zero();
  return needle_.moment_A_m2 / strength_T * field_T;
}

PlainSimulator::Load PlainSimulator::load(const geometry::Pose2& pose, const PerCoil& current_A) const {
  const FieldGradient sum = field_.at(current_A, pose.position_m());
  const geometry::Vector2 moment = moment_A_m2(pose, sum.field_T);
  if (needle_.is_sphere()) return {sum.gradient_T_per_m.transpose() * moment, 0.0};
  return {sum.gradient_T_per_m.transpose() * moment,
          moment.x() * sum.field_T.y() - moment.y() * sum.field_T.x()};
}

geometry::Pose2 PlainSimulator::step(const geometry::Pose2& pose, const PerCoil& current_A, double pulse_s,
                                     double rest_s) const {
  const double friction_N_m = friction_N_ * needle_.length_m / 4.0;
  geometry::Pose2 now = pose;
  geometry::Vector2 velocity = geometry::Vector2::Zero();
  double spin = 0.0;
  const int pulse_steps = std::max(1, static_cast<int>(std::ceil(pulse_s / step_s_ - 1e-9)));
  const int rest_steps = static_cast<int>(std::ceil(rest_s / step_s_ - 1e-9));
  for (int i = 0; i < pulse_steps + rest_steps; ++i) {
    const bool on = i < pulse_steps;
    if (!on && velocity.isZero(0.0) && spin == 0.0) break;
    const double h = on ? pulse_s / pulse_steps : rest_s / rest_steps;
    const Load pull = on ? load(now, current_A) : Load{geometry::Vector2::Zero(), 0.0};
    // Coulomb friction takes away at most the motion there is, translation and rotation apart.
    velocity = (needle_.mass_kg * velocity + h * pull.force_N) / (needle_.mass_kg + h * drag_N_s_m_);
    const double speed = velocity.norm();
    if (speed > 0.0)
      velocity *= std::max(0.0, 1.0 - h * friction_N_ / (needle_.mass_kg + h * drag_N_s_m_) / speed);
    const double spin_mass = needle_.inertia_kg_m2 + h * spin_drag_N_m_s_;
    spin = (needle_.inertia_kg_m2 * spin + h * pull.torque_N_m) / spin_mass;
    spin = std::copysign(std::max(0.0, std::abs(spin) - h * friction_N_m / spin_mass), spin);
    geometry::Vector2 position = now.position_m() + h * velocity;
    if (position.norm() > dish_radius_m_) {
      position *= dish_radius_m_ / position.norm();
      velocity.setZero();
    }
    now.x_m = position.x();
    now.y_m = position.y();
    now.heading_rad += h * spin;
  }
  now.heading_rad = geometry::wrap_angle(now.heading_rad);
  return now;
}

}  // namespace lodestone::physics
