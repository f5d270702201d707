#include "lodestone/physics/needle_motion.h"

#include <algorithm>
#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::physics {

/// Velocity, or a load, along the needle, across it (to the left of the heading), and about its middle.
struct NeedleMotion::BodyVelocity {
  double along = 0.0;
  double across = 0.0;
  double spin = 0.0;

  /// Speed of the point this far ahead of the middle.
  double slide(double ahead_m) const {
    const double aside = across + spin * ahead_m;
    return std::sqrt(along * along + aside * aside);
  }
};

/// What resists the motion at a velocity: each cell's friction, and moments 0 to 2 of the cross-flow drag
/// along the needle; of what that drag makes of a fluid that moves, force and torque on a needle at rest.
struct NeedleMotion::Resistance {
  double friction_N[kCells];
  double cross_0 = 0.0, cross_1 = 0.0, cross_2 = 0.0;
  double carried_N = 0.0, carried_N_m = 0.0;
};

/// The fluid around the needle: its velocity across each cell, and the motion of a rod that is carried along.
struct NeedleMotion::Stream {
  double across_m_s[kCells] = {};
  BodyVelocity carried;
};

/// A place of the needle's surface that would touch wall or obstacle within the step.
struct NeedleMotion::Contact {
  double arm_x, arm_y, normal_x, normal_y;
  double allowed_m_s;  ///< along the normal, which points out of the dish or into the obstacle
  double normal_impulse = 0.0, tangent_impulse = 0.0;
};

/// Cosine and sine of the heading.
struct NeedleMotion::Axes {
  double c;
  double s;

  BodyVelocity to_body(double x, double y, double spin) const {
    return {c * x + s * y, -s * x + c * y, spin};
  }
};

namespace {

// Below this a cell counts as creeping; it bounds how far a held mode drifts while another slides (1 um in
// 0.1 s).
constexpr double kCreep_m_s = 1e-5;

// Left between needle and obstacle, so that rounding never makes them overlap.
constexpr double kSkin_m = 1e-9;

void drift(NeedleState& state, double time_s) {
  state.pose.x_m += state.velocity_x_m_s * time_s;
  state.pose.y_m += state.velocity_y_m_s * time_s;
  state.pose.heading_rad += state.spin_rad_s * time_s;
}

}  // namespace

NeedleMotion::NeedleMotion(const NeedleConfig& needle, const FluidConfig& fluid,
                           const FrictionConfig& friction, const DishConfig& dish, const Flow& flow,
                           const Obstacles& obstacles)
    : needle_(needle),
      fluid_(fluid),
      friction_(friction),
      dish_(dish),
      flow_(flow),
      obstacles_(obstacles),
      drag_(rod_drag(needle, fluid)) {
  needle.validate();
  friction.validate();
  for (int i = 0; i < kCells; ++i) cell_position_m_[i] = needle.length_m * ((i + 0.5) / kCells - 0.5);
  cell_load_N_ = needle.net_weight_N / kCells;
}

NeedleMotion::Axes NeedleMotion::axes_of(const geometry::Pose2& pose) {
  return {std::cos(pose.heading_rad), std::sin(pose.heading_rad)};
}

/// Of the needle's weight, what rests on the floor.
double NeedleMotion::carried_share(double lift_N) const {
  return lift_N == 0.0 ? 1.0 : std::max(0.0, 1.0 - lift_N / needle_.net_weight_N);
}

void NeedleMotion::cell_factors(const geometry::Pose2& pose, const Axes& axes, const FrictionMap& map,
                                double scale, double* factors) const {
  for (int i = 0; i < kCells; ++i) {
    const double s = cell_position_m_[i];
    factors[i] = scale * map.factor(pose.x_m + s * axes.c, pose.y_m + s * axes.s);
  }
}

bool NeedleMotion::holds(const geometry::Pose2& pose, const Wrench& load, const FrictionMap& map,
                         double friction_scale) const {
  double factors[kCells];
  const Axes axes = axes_of(pose);
  cell_factors(pose, axes, map, friction_scale * carried_share(load.lift_N), factors);
  return holds(axes.to_body(load.force_x_N, load.force_y_N, load.torque_N_m), factors);
}

bool NeedleMotion::holds(const BodyVelocity& load, const double* factors) const {
  double total = 0.0;
  double first_moment = 0.0;
  for (int i = 0; i < kCells; ++i) {
    total += factors[i];
    first_moment += factors[i] * cell_position_m_[i];
  }
  const double per_factor_N = friction_.static_coefficient * cell_load_N_;
  const double greatest_force = per_factor_N * total;
  if (greatest_force <= 0.0) return false;
  const double centre = first_moment / total;  // of friction, along the needle
  double arm_sum = 0.0;
  for (int i = 0; i < kCells; ++i) arm_sum += factors[i] * std::abs(cell_position_m_[i] - centre);
  const double along = load.along / greatest_force;
  const double across = load.across / greatest_force;
  const double torque = (load.spin - centre * load.across) / (per_factor_N * arm_sum);
  const double room = 1.0 - along * along - across * across;
  return room > 0.0 && torque * torque < room * (1.0 - across * across);
}

/// The motion carried along is the one for which drag that is even along the rod has neither force nor
/// torque.
NeedleMotion::Stream NeedleMotion::stream_at(const geometry::Pose2& pose, const Axes& axes,
                                             double time_s) const {
  Stream stream;
  if (flow_.still()) return stream;
  double first_moment = 0.0;
  double squares_m2 = 0.0;
  for (int i = 0; i < kCells; ++i) {
    const double s = cell_position_m_[i];
    const geometry::Vector2 flow_m_s =
        flow_.velocity_m_s({pose.x_m + s * axes.c, pose.y_m + s * axes.s}, time_s);
    const BodyVelocity here = axes.to_body(flow_m_s.x(), flow_m_s.y(), 0.0);
    stream.across_m_s[i] = here.across;
    stream.carried.along += here.along / kCells;
    stream.carried.across += here.across / kCells;
    first_moment += s * here.across;
    squares_m2 += s * s;
  }
  stream.carried.spin = first_moment / squares_m2;
  return stream;
}

/// Friction of each cell at this velocity. Cross-flow drag of a cylinder, C_D = 1 + 10 Re^(-2/3) (White,
/// Viscous Fluid Flow), times speed relative to the fluid.
NeedleMotion::Resistance NeedleMotion::resistance(const BodyVelocity& velocity, const double* factors,
                                                  const Stream& stream) const {
  const double cell_length = needle_.length_m / kCells;
  const double inertial =
      0.5 * fluid_.density_kg_m3 * needle_.diameter_m * cell_length * fluid_.cross_flow_factor;
  const double kinematic = fluid_.viscosity_Pa_s / (fluid_.density_kg_m3 * needle_.diameter_m);
  const double viscous = 10.0 * std::cbrt(kinematic * kinematic);
  Resistance found;
  for (int i = 0; i < kCells; ++i) {
    const double s = cell_position_m_[i];
    const double across = velocity.across + velocity.spin * s;
    const double speed = std::abs(across - stream.across_m_s[i]);
    found.friction_N[i] =
        cell_load_N_ * factors[i] *
        (friction_.kinetic_coefficient + (friction_.static_coefficient - friction_.kinetic_coefficient) *
                                             std::exp(-velocity.slide(s) / friction_.stribeck_speed_m_s));
    const double cross =
        inertial > 0.0 && speed > 0.0 ? inertial * (speed + viscous * std::cbrt(speed)) : 0.0;
    found.cross_0 += cross;
    found.cross_1 += cross * s;
    found.cross_2 += cross * s * s;
    found.carried_N += cross * stream.across_m_s[i];
    found.carried_N_m += cross * s * stream.across_m_s[i];
  }
  return found;
}

/// A load, and with it the drag of a fluid that moves on a needle at rest: all of the drag but what is in
/// proportion to the needle's own velocity.
NeedleMotion::BodyVelocity NeedleMotion::dragged(const BodyVelocity& load, const Resistance& resisting,
                                                 const Stream& stream) const {
  return {load.along + drag_.along_N_s_m * stream.carried.along,
          load.across + drag_.across_N_s_m * stream.carried.across + resisting.carried_N,
          load.spin + drag_.rotation_N_m_s * stream.carried.spin + resisting.carried_N_m};
}

/// One implicit step of the velocity: minimises 1/2 (v - v*)^T A (v - v*) + step * sum of friction_i |v_i|,
/// where A holds inertia and drag and v* is the step without friction. Iteratively reweighted least squares;
/// the first guess, v* scaled back by the friction's power, is already exact for pure sliding and pure
/// turning. Returns false when the needle comes to rest.
bool NeedleMotion::kick(BodyVelocity& velocity, const BodyVelocity& load, const double* factors,
                        const Stream& stream, bool held, double step_s) const {
  const Resistance resisting = resistance(velocity, factors, stream);
  const BodyVelocity drive = fluid_moves() ? dragged(load, resisting, stream) : load;
  const double* friction_N = resisting.friction_N;
  const double a_along = needle_.mass_kg + step_s * drag_.along_N_s_m;
  const double a_across = needle_.mass_kg + step_s * (drag_.across_N_s_m + resisting.cross_0);
  const double a_mixed = step_s * resisting.cross_1;
  const double a_spin = needle_.inertia_kg_m2 + step_s * (drag_.rotation_N_m_s + resisting.cross_2);
  const double b_along = needle_.mass_kg * velocity.along + step_s * drive.along;
  const double b_across = needle_.mass_kg * velocity.across + step_s * drive.across;
  const double b_spin = needle_.inertia_kg_m2 * velocity.spin + step_s * drive.spin;

  const auto solve = [&](double k_0, double k_1, double k_2) {
    const double nn = a_across + k_0;
    const double nw = a_mixed + k_1;
    const double ww = a_spin + k_2;
    const double determinant = nn * ww - nw * nw;
    return BodyVelocity{b_along / (a_along + k_0), (b_across * ww - b_spin * nw) / determinant,
                        (b_spin * nn - b_across * nw) / determinant};
  };
  velocity = solve(0.0, 0.0, 0.0);
  double power = 0.0;
  for (int i = 0; i < kCells; ++i) power += friction_N[i] * velocity.slide(cell_position_m_[i]);
  if (power == 0.0) return true;
  const double energy = b_along * velocity.along + b_across * velocity.across + b_spin * velocity.spin;
  double scale = 1.0 - step_s * power / energy;
  if (scale <= 0.0 && held) {
    velocity = BodyVelocity{};
    return false;
  }
  // Friction stops the motion as a whole but not every part of it: start near rest and iterate longer.
  const int iterations = scale > 0.2 ? 3 : 8;
  scale = std::max(scale, 0.02);
  velocity = {scale * velocity.along, scale * velocity.across, scale * velocity.spin};
  for (int iteration = 0; iteration < iterations; ++iteration) {
    double k_0 = 0.0, k_1 = 0.0, k_2 = 0.0;
    for (int i = 0; i < kCells; ++i) {
      const double s = cell_position_m_[i];
      const double k = step_s * friction_N[i] / std::max(velocity.slide(s), kCreep_m_s);
      k_0 += k;
      k_1 += k * s;
      k_2 += k * s * s;
    }
    velocity = solve(k_0, k_1, k_2);
  }
  return true;
}

void NeedleMotion::step(NeedleState& state, const CoilArray& coils, const PerCoil& current_A,
                        const FrictionMap& map, double friction_scale, double step_s, double time_s) const {
  if (!state.stuck) advance(state, step_s / 2.0);
  const Axes axes = axes_of(state.pose);
  const Wrench pull = magnetic_wrench(needle_, state.pose.position_m(), {axes.c, axes.s}, coils, current_A);
  const BodyVelocity load = axes.to_body(pull.force_x_N, pull.force_y_N, pull.torque_N_m);
  double factors[kCells];
  cell_factors(state.pose, axes, map, friction_scale * carried_share(pull.lift_N), factors);
  const Stream stream = stream_at(state.pose, axes, time_s + step_s / 2.0);
  const bool held = holds(
      fluid_moves() ? dragged(load, resistance(BodyVelocity{}, factors, stream), stream) : load, factors);
  if (state.stuck && held) return;

  BodyVelocity velocity = axes.to_body(state.velocity_x_m_s, state.velocity_y_m_s, state.spin_rad_s);
  state.stuck = !kick(velocity, load, factors, stream, held, step_s);
  state.velocity_x_m_s = axes.c * velocity.along - axes.s * velocity.across;
  state.velocity_y_m_s = axes.s * velocity.along + axes.c * velocity.across;
  state.spin_rad_s = velocity.spin;
  if (state.stuck) {
    state.pose.heading_rad = geometry::wrap_angle(state.pose.heading_rad);
    return;
  }
  contact_impulses(state, axes, step_s);
  advance(state, step_s / 2.0);
}

/// Where obstacles leave no room for the motion, it ends: the needle rests where it was.
void NeedleMotion::advance(NeedleState& state, double time_s) const {
  const geometry::Pose2 before = state.pose;
  drift(state, time_s);
  keep_inside(state.pose);
  if (obstacles_.empty() || keep_clear(state.pose)) return;
  state = NeedleState{};
  state.pose = before;
}

bool NeedleMotion::near_wall(const geometry::Pose2& pose) const {
  const double free = dish_.radius_m - needle_.length_m / 2.0;
  return pose.x_m * pose.x_m + pose.y_m * pose.y_m > free * free;
}

bool NeedleMotion::fits(const geometry::Pose2& pose) const {
  const Axes axes = axes_of(pose);
  for (const double side : {0.5, -0.5}) {
    const double arm = side * needle_.length_m;
    const double radius = std::hypot(pose.x_m + arm * axes.c, pose.y_m + arm * axes.s);
    if (!(radius <= dish_.radius_m)) return false;  // NaN does not fit either
  }
  return true;
}

/// The needle with ends that are round within its length.
Capsule NeedleMotion::capsule_at(const geometry::Pose2& pose, const Axes& axes) const {
  const double radius_m = needle_.diameter_m / 2.0;
  const double half_m = needle_.length_m / 2.0 - radius_m;
  const geometry::Vector2 middle_m = pose.position_m();
  const geometry::Vector2 arm_m(half_m * axes.c, half_m * axes.s);
  return {middle_m - arm_m, middle_m + arm_m, radius_m};
}

bool NeedleMotion::free_at(const geometry::Pose2& pose) const {
  return fits(pose) && (obstacles_.empty() || obstacles_.clear_of(capsule_at(pose, axes_of(pose))));
}

std::optional<geometry::Pose2> NeedleMotion::free_near(const geometry::Pose2& pose) const {
  constexpr double kApart_m = 1e-3;
  constexpr int kHeadings = 12;
  if (free_at(pose)) return pose;
  const int rings = static_cast<int>(std::ceil(2.0 * dish_.radius_m / kApart_m));
  for (int turn = 0; turn < kHeadings; ++turn) {
    // 0, 30, -30, 60, -60, ... degrees
    const double turned_rad =
        (turn % 2 == 0 ? -1.0 : 1.0) * ((turn + 1) / 2) * 2.0 * geometry::kPi / kHeadings;
    for (int ring = 0; ring <= rings; ++ring) {
      const int places = std::max(1, static_cast<int>(std::ceil(2.0 * geometry::kPi * ring)));
      for (int place = 0; place < places; ++place) {
        const double angle_rad = 2.0 * geometry::kPi * place / places;
        const geometry::Pose2 candidate{pose.x_m + kApart_m * ring * std::cos(angle_rad),
                                        pose.y_m + kApart_m * ring * std::sin(angle_rad),
                                        pose.heading_rad + turned_rad};
        if (free_at(candidate)) return candidate;
      }
    }
  }
  return std::nullopt;
}

void NeedleMotion::find_at_wall(const NeedleState& state, const Axes& axes, double step_s,
                                std::vector<Contact>& contacts) const {
  const auto length = [](double x, double y) { return std::sqrt(x * x + y * y); };
  const double reach =
      needle_.length_m / 2.0 + step_s * (length(state.velocity_x_m_s, state.velocity_y_m_s) +
                                         std::abs(state.spin_rad_s) * needle_.length_m / 2.0);
  if (length(state.pose.x_m, state.pose.y_m) + reach < dish_.radius_m) return;
  for (const double side : {0.5, -0.5}) {
    const double arm_x = side * needle_.length_m * axes.c;
    const double arm_y = side * needle_.length_m * axes.s;
    const double x = state.pose.x_m + arm_x;
    const double y = state.pose.y_m + arm_y;
    const double radius = length(x, y);
    const double speed = length(state.velocity_x_m_s - state.spin_rad_s * arm_y,
                                state.velocity_y_m_s + state.spin_rad_s * arm_x);
    const double gap = std::max(0.0, dish_.radius_m - radius);
    if (speed * step_s >= gap) contacts.push_back({arm_x, arm_y, x / radius, y / radius, gap / step_s});
  }
}

void NeedleMotion::find_at_obstacles(const NeedleState& state, const Axes& axes, double step_s,
                                     std::vector<Contact>& contacts) const {
  if (obstacles_.empty()) return;
  const Capsule capsule = capsule_at(state.pose, axes);
  const double fastest_m_s = std::hypot(state.velocity_x_m_s, state.velocity_y_m_s) +
                             std::abs(state.spin_rad_s) * needle_.length_m / 2.0;
  std::vector<Obstacles::Touch> touches;
  obstacles_.find(capsule, step_s * fastest_m_s + kSkin_m, touches);
  for (const Obstacles::Touch& touch : touches) {
    const geometry::Vector2 arm_m = touch.at_m + capsule.radius_m * touch.towards - state.pose.position_m();
    contacts.push_back({arm_m.x(), arm_m.y(), touch.towards.x(), touch.towards.y(),
                        std::max(0.0, touch.clearance_m - kSkin_m) / step_s});
  }
}

/// Brings one contact to rest for itself; adds to `change` by how much its impulses changed.
void NeedleMotion::settle(Contact& c, NeedleState& state, double& change) const {
  const auto push = [&](double x, double y) {
    state.velocity_x_m_s += x / needle_.mass_kg;
    state.velocity_y_m_s += y / needle_.mass_kg;
    state.spin_rad_s += (c.arm_x * y - c.arm_y * x) / needle_.inertia_kg_m2;
  };
  const auto mass = [&](double x, double y) {
    const double lever = c.arm_x * y - c.arm_y * x;
    return 1.0 / (1.0 / needle_.mass_kg + lever * lever / needle_.inertia_kg_m2);
  };
  const auto speed_along = [&](double x, double y) {
    return (state.velocity_x_m_s - state.spin_rad_s * c.arm_y) * x +
           (state.velocity_y_m_s + state.spin_rad_s * c.arm_x) * y;
  };
  const double outward = speed_along(c.normal_x, c.normal_y);
  const double normal =
      std::max(0.0, c.normal_impulse + (outward - c.allowed_m_s) * mass(c.normal_x, c.normal_y));
  push(-(normal - c.normal_impulse) * c.normal_x, -(normal - c.normal_impulse) * c.normal_y);
  change += std::abs(normal - c.normal_impulse);
  c.normal_impulse = normal;
  const double tx = -c.normal_y;
  const double ty = c.normal_x;
  const double limit = dish_.wall_friction * c.normal_impulse;
  const double tangent = std::clamp(c.tangent_impulse - speed_along(tx, ty) * mass(tx, ty), -limit, limit);
  push((tangent - c.tangent_impulse) * tx, (tangent - c.tangent_impulse) * ty);
  change += std::abs(tangent - c.tangent_impulse);
  c.tangent_impulse = tangent;
}

/// Inelastic contact with friction: nothing of the needle may pass wall or obstacle within the step.
/// Sequential impulses over all contacts. Impulses only take outward motion away, so that neither can add
/// energy.
void NeedleMotion::contact_impulses(NeedleState& state, const Axes& axes, double step_s) const {
  constexpr int kIterations = 20;
  constexpr double kSettled_m_s = 1e-9;
  std::vector<Contact> contacts;
  find_at_wall(state, axes, step_s, contacts);
  find_at_obstacles(state, axes, step_s, contacts);
  for (int iteration = 0; iteration < kIterations && !contacts.empty(); ++iteration) {
    double change = 0.0;
    for (Contact& contact : contacts) settle(contact, state, change);
    if (change < kSettled_m_s * needle_.mass_kg) break;
  }
}

/// Takes back the little that the wall's curvature lets an end through in one step.
void NeedleMotion::keep_inside(geometry::Pose2& pose) const {
  if (!near_wall(pose)) return;
  const Axes axes = axes_of(pose);
  for (int pass = 0; pass < 3; ++pass) {
    bool moved = false;
    for (const double side : {0.5, -0.5}) {
      const double x = pose.x_m + side * needle_.length_m * axes.c;
      const double y = pose.y_m + side * needle_.length_m * axes.s;
      const double radius = std::sqrt(x * x + y * y);
      if (radius <= dish_.radius_m) continue;
      const double back = dish_.radius_m * (1.0 - 1e-12) / radius - 1.0;
      pose.x_m += back * x;
      pose.y_m += back * y;
      moved = true;
    }
    if (!moved) return;
  }
}

/// The same for the little that a turning needle gets into an obstacle in one step. False where that cannot
/// be taken back.
bool NeedleMotion::keep_clear(geometry::Pose2& pose) const {
  constexpr int kPasses = 16;
  std::vector<Obstacles::Touch> touches;
  for (int pass = 0; pass < kPasses; ++pass) {
    const Capsule capsule = capsule_at(pose, axes_of(pose));
    if (obstacles_.on_axis(capsule)) return false;
    touches.clear();
    obstacles_.find(capsule, 0.5 * kSkin_m, touches);
    if (touches.empty()) return pass == 0 || fits(pose);
    const Obstacles::Touch& deepest = *std::min_element(
        touches.begin(), touches.end(),
        [](const Obstacles::Touch& a, const Obstacles::Touch& b) { return a.clearance_m < b.clearance_m; });
    pose.x_m -= (kSkin_m - deepest.clearance_m) * deepest.towards.x();
    pose.y_m -= (kSkin_m - deepest.clearance_m) * deepest.towards.y();
    keep_inside(pose);
  }
  return free_at(pose);
}

}  // namespace lodestone::physics
