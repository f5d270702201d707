#include "lodestone/rig/virtual_rig.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/named.h"
#include "lodestone/physics/amplifier.h"
#include "lodestone/physics/body_motion.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/core_saturation.h"
#include "lodestone/rig/hidden_deviation.h"

namespace lodestone::rig {
namespace {

// With less than this in every coil, and fluid at rest, nothing that rests can start to move: it is a
// hundredth of the break-away current at the centre, and an eighth of that at the mouth of a coil.
constexpr double kQuiet_A = 0.02;

// A rig that keeps pace with a clock is looked at so often.
constexpr double kPace_s = 5e-3;
constexpr double kTooLate_s = 0.5;  // behind that clock: given up, or the rig would run faster afterwards

}  // namespace

struct VirtualRig::State {
  State(const VirtualRigConfig& rig_config, std::uint64_t rig_seed,
        std::shared_ptr<const physics::CoilFields> shared)
      : config(rig_config),
        seed(rig_seed),
        hidden(HiddenDeviation::draw(config.simulation.deviation, seed, config.coils)),
        truth(hidden.applied_to(config)),
        fields(std::move(shared)),
        field(fields, hidden.coils),
        map(truth.friction, truth.dish.radius_m, seed),
        motion(truth, physics::Flow(config.simulation.flow), physics::Obstacles(config.simulation.obstacles)),
        scatter(seed, "pulse_friction"),
        amplifier(truth) {
    for (std::size_t coil = 0; coil < config.coils.count(); ++coil)
      circuits.emplace_back(truth.circuit(coil));
    const std::optional<geometry::Pose2> start = motion.free_near({});
    if (!start)
      throw common::ConfigError(
          fmt::format("virtual rig: simulation.obstacles leave no place in the dish for a needle of {} m "
                      "(needle.length_m); take some away",
                      truth.needle.length_m));
    needle.pose = *start;
  }

  /// A little of the friction is drawn anew for every pulse (how the needle happens to lie).
  void draw_friction() {
    const double sigma = truth.friction.pulse_sigma;
    friction_scale = std::exp(sigma * scatter.normal() - 0.5 * sigma * sigma);
  }

  void advance_circuits() {
    if (now_s > circuits_s)
      for (physics::CoilCircuit& circuit : circuits) circuit.advance(now_s - circuits_s);
    circuits_s = now_s;
  }
  /// What the coils' currents make, of cores that saturate.
  physics::PerCoil magnetising_A(physics::PerCoil current_A) const {
    const SimulationConfig& cores = config.simulation;
    for (std::size_t i = 0; i < circuits.size(); ++i)
      current_A[i] = physics::unsaturated_A(current_A[i], cores.core_share, cores.core_saturation_A);
    return current_A;
  }
  /// Before the coils are driven otherwise, in the middle of a stretch.
  void catch_up() {
    ++changes;
    advance_circuits();
  }
  void switch_off() {
    catch_up();
    pulsing = false;
    amplifier.off(now_s, circuits);
  }
  /// Up to when the voltages of the coils stay as they are; no further than `time_s`.
  double constant_until_s(double time_s) const {
    const double until_s = std::min(time_s, amplifier.change_s());
    return pulsing ? std::min(until_s, pulse_end_s) : until_s;
  }
  /// At the end of a stretch. Where voltages change by themselves, the circuits are left as they were at the
  /// last change until the next, so that it does not matter how a wait is cut.
  void end_stretch() {
    if (pulsing && now_s >= pulse_end_s) {
      switch_off();
    } else if (now_s >= amplifier.change_s()) {
      advance_circuits();
      amplifier.change(now_s, circuits);
    } else if (!amplifier.stepwise()) {
      advance_circuits();
    }
  }

  const VirtualRigConfig config;  // as described
  const std::uint64_t seed;
  const HiddenDeviation hidden;
  const physics::RigDescription truth;
  const std::shared_ptr<const physics::CoilFields> fields;
  const physics::CoilArray field;
  const physics::FrictionMap map;
  const physics::BodyMotion motion;

  std::mutex mutex;  // of all that follows
  common::RandomStream scatter;
  std::vector<physics::CoilCircuit> circuits;
  physics::Amplifier amplifier;
  physics::NeedleState needle;
  double friction_scale = 1.0;
  double now_s = 0.0;
  double circuits_s = 0.0;    // when the circuits were so; below now_s within a stretch
  std::uint64_t changes = 0;  // of what drives the coils, and of the rest by restore()
  double pulse_end_s = 0.0;
  bool pulsing = false;
  common::Clock* wall = nullptr;  // to keep pace with
  double wall_offset_s = 0.0;

  std::unique_ptr<VirtualCoils> coils;
  std::unique_ptr<VirtualClock> clock;
};

class VirtualRig::VirtualCoils final : public Coils {
 public:
  explicit VirtualCoils(State& state) : state_(state) {}

  void apply(const CoilPulse& pulse) override {
    const physics::CoilsDescription& coils = state_.config.coils;
    for (std::size_t i = 0; i < std::max(coils.count(), pulse.current_A.size()); ++i) {
      const double current = pulse.current_A[i];
      const bool there = i < coils.count();
      const double lowest_A = there ? coils.smallest_A(i) : 0.0, largest_A = there ? coils.largest_A(i) : 0.0;
      if (!(current >= lowest_A && current <= largest_A)) {
        throw common::HardwareError(
            fmt::format("virtual coils: current of coil {} = {} A is refused; it must be within {} and {} A",
                        coils.name(i), current, lowest_A, largest_A));
      }
    }
    if (!(pulse.duration_s >= 0.0 && pulse.duration_s <= state_.config.simulation.max_pulse_s)) {
      throw common::HardwareError(
          fmt::format("virtual coils: duration = {} s is refused; it must be within 0 and {} s",
                      pulse.duration_s, state_.config.simulation.max_pulse_s));
    }
    const std::lock_guard<std::mutex> lock(state_.mutex);
    state_.catch_up();
    state_.draw_friction();
    state_.pulsing = pulse.duration_s > 0.0;
    state_.pulse_end_s = state_.now_s + pulse.duration_s;
    if (state_.pulsing) {
      state_.amplifier.demand(pulse.current_A, state_.now_s, state_.pulse_end_s, state_.circuits);
    } else {
      state_.amplifier.off(state_.now_s, state_.circuits);
    }
  }

  void stop() noexcept override {
    const std::lock_guard<std::mutex> lock(state_.mutex);
    state_.switch_off();
  }

  CoilStatus status() override {
    const std::lock_guard<std::mutex> lock(state_.mutex);
    CoilStatus status;
    for (std::size_t i = 0; i < state_.circuits.size(); ++i) {
      physics::CoilCircuit circuit = state_.circuits[i];
      if (state_.now_s > state_.circuits_s) circuit.advance(state_.now_s - state_.circuits_s);
      status.current_A[i] = circuit.state().current_A;
      status.temperature_C[i] = circuit.state().temperature_C;
      if (status.temperature_C[i] > state_.config.simulation.max_temperature_C)
        status.faults.push_back(fmt::format("coil {} is at {} C, above {} C", state_.config.coils.name(i),
                                            status.temperature_C[i],
                                            state_.config.simulation.max_temperature_C));
    }
    return status;
  }

 private:
  State& state_;
};

class VirtualRig::VirtualClock final : public common::Clock {
 public:
  explicit VirtualClock(VirtualRig& rig) : rig_(rig) {}
  double now_s() const override {
    const std::lock_guard<std::mutex> lock(rig_.state_->mutex);
    return rig_.state_->now_s;
  }
  bool wait_until(double time_s, common::Interruption* interruption) override {
    return rig_.advance_to(time_s, interruption);
  }

 private:
  VirtualRig& rig_;
};

void VirtualRigConfig::validate() const {
  RigDescription::validate();
  if (needle.is_sphere() &&
      (simulation.flow.kind != physics::FlowKind::kNone || !simulation.obstacles.empty()))
    throw common::InvalidConfig("needle.shape", common::name_of(needle.shape),
                                "be needle where simulation.flow or simulation.obstacles are given: a sphere "
                                "is simulated in fluid at rest and an empty dish");
  for (std::size_t i = 0; i < simulation.obstacles.size(); ++i) {
    const physics::ObstacleConfig& obstacle = simulation.obstacles[i];
    obstacle.validate();
    if (obstacle.reach_m() <= dish.radius_m) continue;
    const std::string key = fmt::format("simulation.obstacles[{}].", i);
    const std::string must = fmt::format(
        "keep the obstacle inside the dish, {} m about its centre (dish.radius_m)", dish.radius_m);
    if (obstacle.shape == physics::ObstacleShape::kPolygon)
      throw common::InvalidConfig(key + "corners_m", obstacle.corners_m, must);
    throw common::InvalidConfig(key + "centre_m", obstacle.centre_m,
                                fmt::format("{}, with its radius_m of {}", must, obstacle.radius_m));
  }
}

VirtualRig::VirtualRig(const VirtualRigConfig& config, std::uint64_t seed,
                       std::shared_ptr<const physics::CoilFields> fields) {
  config.coils.validate();
  config.validate();
  const double margin_m = deviation_margin_m(config.simulation.deviation, config);
  if (!fields) fields = physics::CoilFields::shared(config.coils, config.dish.radius_m, margin_m);
  LODESTONE_CHECK(fields->of(config.coils), "the fields are of other coils");
  LODESTONE_CHECK(fields->reach_m() >= config.dish.radius_m + margin_m, "the fields do not cover the dish");
  state_ = std::make_unique<State>(config, seed, std::move(fields));
  state_->coils = std::make_unique<VirtualCoils>(*state_);
  state_->clock = std::make_unique<VirtualClock>(*this);
}

VirtualRig::~VirtualRig() = default;

Coils& VirtualRig::coils() { return *state_->coils; }
common::Clock& VirtualRig::clock() { return *state_->clock; }
geometry::Pose2 VirtualRig::true_pose() const {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  geometry::Pose2 pose = state_->needle.pose;
  pose.heading_rad = geometry::wrap_angle(pose.heading_rad);
  return pose;
}
bool VirtualRig::at_rest() const {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  return state_->needle.stuck;
}
const VirtualRigConfig& VirtualRig::config() const { return state_->config; }
std::shared_ptr<const physics::CoilFields> VirtualRig::fields() const { return state_->fields; }

void VirtualRig::drive(const physics::PerCoil& duty, double supply_V) {
  State& state = *state_;
  const std::lock_guard<std::mutex> lock(state.mutex);
  state.catch_up();
  state.pulsing = false;
  bool was_off = true;
  bool is_off = true;
  for (std::size_t i = 0; i < state.circuits.size(); ++i) {
    LODESTONE_CHECK(std::isfinite(duty[i]), "a duty that is a number, not " + std::to_string(duty[i]));
    was_off = was_off && state.circuits[i].state().duty == 0.0;
    is_off = is_off && duty[i] == 0.0;
  }
  state.amplifier.drive(duty, supply_V, state.now_s, state.circuits);
  if (was_off && !is_off) state.draw_friction();
}

bool VirtualRig::fits(const geometry::Pose2& pose) const { return state_->motion.fits(pose); }

void VirtualRig::place(const geometry::Pose2& pose) {
  if (!fits(pose)) {  // also when a number is NaN, as for restore()
    throw common::DataError(
        fmt::format("virtual rig: the needle does not fit at ({}, {}) m, heading {} rad: both ends must lie "
                    "within {} m of the centre",
                    pose.x_m, pose.y_m, pose.heading_rad, state_->config.dish.radius_m));
  }
  const std::optional<geometry::Pose2> there = state_->motion.free_near(pose);
  if (!there)
    throw common::DataError("virtual rig: simulation.obstacles leave the needle no place; take some away");
  const std::lock_guard<std::mutex> lock(state_->mutex);
  state_->needle = physics::NeedleState{};
  state_->needle.pose = *there;
  state_->needle.pose.heading_rad =
      state_->config.needle.is_sphere() ? 0.0 : geometry::wrap_angle(there->heading_rad);
}

void VirtualRig::keep_pace_with(common::Clock& wall) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  state_->wall = &wall;
  state_->wall_offset_s = wall.now_s() - state_->now_s;
}

bool VirtualRig::advance_to(double time_s, common::Interruption* interruption) {
  LODESTONE_CHECK(std::isfinite(time_s), "a simulated clock cannot sleep until " + std::to_string(time_s));
  if (interruption != nullptr && interruption->raised()) return false;
  State& state = *state_;
  std::unique_lock<std::mutex> lock(state.mutex);
  double paced_s = state.now_s;
  while (state.now_s < time_s) {
    const double end_s = state.constant_until_s(time_s);
    if (run(end_s - state.now_s, lock, interruption)) {
      state.now_s = std::max(state.now_s, end_s);
      state.end_stretch();
      if (state.wall == nullptr) continue;
      // Voltages that change by themselves change far more often than anybody looks.
      if (state.amplifier.stepwise() && state.now_s < std::min(time_s, paced_s + kPace_s)) continue;
      paced_s = state.now_s;
      if (!pace(lock, interruption)) return false;
    } else if (interruption != nullptr && interruption->raised()) {
      return false;
    }
  }
  return true;
}

/// Waits until the wall clock has come as far; others may look at the rig meanwhile, and drive it.
bool VirtualRig::pace(std::unique_lock<std::mutex>& lock, common::Interruption* interruption) {
  common::Clock& wall = *state_->wall;
  const double behind_s = wall.now_s() - state_->wall_offset_s - state_->now_s;
  if (behind_s > kTooLate_s) state_->wall_offset_s += behind_s;
  const double until_s = state_->now_s + state_->wall_offset_s;
  lock.unlock();
  const bool go_on = wall.wait_until(until_s, interruption);
  lock.lock();
  return go_on;
}

/// Moves the needle through one stretch of constant voltages; the circuits stay as they were before it. False
/// when it was cut short: the wait was interrupted, or the coils are driven otherwise.
bool VirtualRig::run(double duration_s, std::unique_lock<std::mutex>& lock,
                     common::Interruption* interruption) {
  if (duration_s <= 0.0) return true;
  State& state = *state_;
  const double start_s = state.now_s;
  const double since_s = start_s - state.circuits_s;
  const std::uint64_t changes = state.changes;
  const int steps =
      std::max(1, static_cast<int>(std::ceil(duration_s / state.config.simulation.step_s - 1e-6)));
  const double step_s = duration_s / steps;
  const int steps_at_once = std::max(1, static_cast<int>(std::min(1e6, kPace_s / step_s)));
  const std::size_t coils = state.circuits.size();
  physics::PerCoil settled(coils);
  physics::PerCoil decay(coils);
  physics::PerCoil excess(coils);  // at the middle of the step; current = settled + excess
  for (std::size_t i = 0; i < coils; ++i) {
    settled[i] = state.circuits[i].settled_current_A();
    const double tau = state.circuits[i].time_constant_s();
    decay[i] = std::exp(-step_s / tau);
    excess[i] =
        (state.circuits[i].state().current_A - settled[i]) * std::exp(-(since_s + 0.5 * step_s) / tau);
  }
  for (int step = 0; step < steps; ++step) {
    physics::PerCoil current(coils);
    bool quiet = !state.fields->has_background() && !state.motion.fluid_moves();
    for (std::size_t i = 0; i < coils; ++i) {
      current[i] = settled[i] + excess[i];
      excess[i] *= decay[i];
      quiet = quiet && settled[i] == 0.0 && std::abs(current[i]) < kQuiet_A;
    }
    const bool at_rest = quiet && state.needle.stuck;
    if (at_rest && state.wall == nullptr) break;
    if (!at_rest)
      state.motion.step(state.needle, state.field, state.magnetising_A(current), state.map,
                        state.friction_scale, step_s, start_s + step * step_s);
    if (state.wall == nullptr || (step + 1) % steps_at_once != 0 || step + 1 == steps) continue;
    state.now_s = start_s + (step + 1) * step_s;
    const bool go_on = pace(lock, interruption);
    if (state.changes != changes) return false;
    if (!go_on) {
      state.catch_up();
      return false;
    }
  }
  return true;
}

common::Json VirtualRig::save() const {
  State& state = *state_;
  const std::lock_guard<std::mutex> lock(state.mutex);
  common::Json json;
  json["seed"] = state.seed;
  json["time_s"] = state.now_s;
  json["pose"] = {state.needle.pose.x_m, state.needle.pose.y_m, state.needle.pose.heading_rad};
  json["velocity"] = {state.needle.velocity_x_m_s, state.needle.velocity_y_m_s, state.needle.spin_rad_s};
  if (state.config.needle.is_sphere()) json["roll"] = {state.needle.roll_x_m_s, state.needle.roll_y_m_s};
  json["stuck"] = state.needle.stuck;
  json["friction_scale"] = state.friction_scale;
  json["pulsing"] = state.pulsing;
  json["pulse_end_s"] = state.pulse_end_s;
  json["coils"] = common::Json::array();
  for (const physics::CoilCircuit& circuit : state.circuits)
    json["coils"].push_back({circuit.state().current_A, circuit.state().temperature_C, circuit.state().duty});
  json["scatter"] = state.scatter.save();
  if (state.amplifier.shapes()) {
    json["coils_s"] = state.circuits_s;
    json["amplifier"] = state.amplifier.save();
  }
  return json;
}

void VirtualRig::restore(const common::Json& json) {
  State& state = *state_;
  const std::lock_guard<std::mutex> lock(state.mutex);
  try {
    if (json.at("seed").get<std::uint64_t>() != state.seed) {
      throw common::DataError("virtual rig state: seed " + json.at("seed").dump() +
                              " is not this rig's seed " + std::to_string(state.seed) +
                              "; its friction map would differ");
    }
    physics::NeedleState needle;
    const auto pose = json.at("pose").get<std::array<double, 3>>();
    const auto velocity = json.at("velocity").get<std::array<double, 3>>();
    needle.pose = {pose[0], pose[1], pose[2]};
    needle.velocity_x_m_s = velocity[0];
    needle.velocity_y_m_s = velocity[1];
    needle.spin_rad_s = velocity[2];
    if (state.config.needle.is_sphere()) {
      const auto roll = json.at("roll").get<std::array<double, 2>>();
      needle.roll_x_m_s = roll[0];
      needle.roll_y_m_s = roll[1];
    }
    needle.stuck = json.at("stuck").get<bool>();
    if (!state.motion.free_at(needle.pose))
      throw common::DataError(fits(needle.pose) ? "virtual rig state: the needle lies in an obstacle"
                                                : "virtual rig state: the needle lies outside the dish");
    const auto coils = json.at("coils").get<std::vector<std::array<double, 3>>>();
    if (coils.size() != state.circuits.size())
      throw common::DataError(
          fmt::format("virtual rig state: {} coils, this rig has {}", coils.size(), state.circuits.size()));
    const double friction_scale = json.at("friction_scale").get<double>();
    const double now_s = json.at("time_s").get<double>();
    const double pulse_end_s = json.at("pulse_end_s").get<double>();
    const bool pulsing = json.at("pulsing").get<bool>();
    // Rigs whose voltages do not change by themselves, and earlier versions, say neither.
    const double circuits_s = json.contains("coils_s") ? json.at("coils_s").get<double>() : now_s;
    if (!(circuits_s <= now_s))
      throw common::DataError(
          fmt::format("virtual rig state: coils_s = {} is after time_s = {}", circuits_s, now_s));
    const bool resumes = !(state.amplifier.shapes() && json.contains("amplifier"));
    physics::Amplifier amplifier = state.amplifier;
    if (!resumes) amplifier.restore(json.at("amplifier"));
    common::RandomStream scatter = state.scatter;
    scatter.restore(json.at("scatter").get<std::string>());
    ++state.changes;
    state.circuits_s = circuits_s;
    if (state.wall != nullptr) state.wall_offset_s = state.wall->now_s() - now_s;
    state.needle = needle;
    state.friction_scale = friction_scale;
    state.now_s = now_s;
    state.pulse_end_s = pulse_end_s;
    state.pulsing = pulsing;
    state.scatter = scatter;
    for (std::size_t i = 0; i < coils.size(); ++i)
      state.circuits[i].set_state({coils[i][0], coils[i][1], coils[i][2]});
    state.amplifier = amplifier;
    if (resumes)
      state.amplifier.resume(now_s, pulsing ? pulse_end_s : physics::Amplifier::kNever_s, state.circuits);
  } catch (const common::Json::exception& error) {
    throw common::DataError(std::string("virtual rig state: malformed: ") + error.what());
  }
}

}  // namespace lodestone::rig
