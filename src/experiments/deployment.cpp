#include "lodestone/experiments/deployment.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/log.h"
#include "lodestone/control/gain_correction.h"
#include "lodestone/control/observer_controller.h"
#include "lodestone/control/policy_controller.h"
#include "lodestone/experiments/effort.h"
#include "lodestone/experiments/heading_need.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/physics/viscosity.h"
#include "lodestone/task/task.h"

namespace lodestone::experiments {

namespace {

/// Streams of a trial are told apart by its task and index, not by the order in which trials run.
std::uint64_t trial_seed(const DeploymentConfig& config, const std::string& task, std::int64_t index) {
  return common::derive_seed(static_cast<std::uint64_t>(config.seed), "deploy/" + task,
                             static_cast<std::uint64_t>(index));
}
std::uint64_t trial_seed(const DeploymentConfig& config, const TrialPlan& plan) {
  return trial_seed(config, plan.task, plan.index);
}

/// All that an unseen rig has of its own comes from this.
std::uint64_t unseen_seed(const DeploymentConfig& config, const std::string& task, std::int64_t index) {
  if (config.trials.per_rig == 0) return trial_seed(config, task, index);
  return common::derive_seed(static_cast<std::uint64_t>(config.seed), "rig nobody has seen",
                             static_cast<std::uint64_t>(index / config.trials.per_rig));
}

/// The actions of a policy or a simulator in the rig's ampere.
task::ActionConfig in_ampere(const DeploymentConfig& config, task::ActionConfig action,
                             const std::string& what) {
  const physics::RigDescription& rig = config.rig;
  if (action.unit == "percent") {
    if (rig.full_drive_A <= 0.0)
      throw common::ConfigError(what +
                                ": its actions are per cent of drive; say in rig.json what 100 per cent "
                                "are in ampere (rig.full_drive_A)");
    action.scale *= rig.full_drive_A / 100.0;
    action.unit = "A";
  }
  if (action.scale > rig.coils.max_current_A)
    throw common::ConfigError(what + ": its largest drive is " + std::to_string(action.scale) +
                              ", the rig takes " + std::to_string(rig.coils.max_current_A) +
                              " A at most (rig.coils.max_current_A); it was trained for another rig");
  if (action.size != rig.drive_size())
    throw common::ConfigError(what + ": its actions are of " + std::to_string(action.size) +
                              " numbers, this rig's drive is of " + std::to_string(rig.drive_size()) +
                              "; it was trained for another rig");
  return action;
}

/// What of the rig a policy or a simulator depends on and that differs from what it was trained for. Throws
/// ConfigError where a drive means something else for the coils.
void warn_of_another_rig(const DeploymentConfig& config, const common::Json& trained_for,
                         const std::string& what) {
  if (!trained_for.is_object()) return;
  const common::Json here = common::config_to_json<physics::RigDescription>(config.rig);
  const common::Json then = physics::completed_rig(trained_for);
  if (const std::string other = physics::other_drive(then, here); !other.empty())
    throw common::ConfigError(what + ": its drives are those of a rig with " + other +
                              "; it was trained for another rig");
  std::string differs;
  for (const char* part : {"coils", "drive", "amplifier", "needle", "dish", "fluid", "friction", "supply_V",
                           "supply_resistance_ohm"})
    if (trained_for.contains(part) && then[part] != here[part])
      differs += (differs.empty() ? "" : ", ") + std::string(part);
  if (!differs.empty())
    common::log_warning(what + " was trained for a rig with other figures of: " + differs);
}

/// What makes filters by a simulator, where the configuration asks for it and there is one that can.
std::function<std::shared_ptr<control::RigIdentifier>()> identified_by(const DeploymentConfig& config,
                                                                       const SimulatorSource* source) {
  if (source == nullptr || !config.identification.enabled || !source->simulator->sampled) return {};
  const auto make = [simulator = *source, identification = config.identification] {
    return std::make_shared<control::RigIdentifier>(simulator.simulator, identification,
                                                    simulator.drive_per_A());
  };
  // Virtual trials run beside one another, on rigs of their own.
  if (!config.rig.real() || !config.identification.carry) return make;
  return [carried = make()] { return carried; };
}

/// What a controller can rehearse in, where there is a simulator that knows headings.
std::shared_ptr<const SimulatorSource> rehearses_in(const SimulatorSource* source) {
  if (source == nullptr || source->simulator->state_size != 3) return nullptr;
  return std::make_shared<const SimulatorSource>(*source);
}

std::shared_ptr<control::RigIdentifier> identifier_of(const ControllerSource& source) {
  return source.identify ? source.identify() : nullptr;
}

rig::RigConfig warmed(rig::RigConfig config, double temperature_C) {
  const double change = physics::water_glycerol_viscosity_Pa_s(temperature_C) /
                        physics::water_glycerol_viscosity_Pa_s(physics::kNominalFluid_C);
  config.fluid.viscosity_Pa_s *= change;
  config.ambient_C = temperature_C;
  return config;
}

std::vector<geometry::Zone> zones_of(const std::vector<physics::ObstacleConfig>& obstacles) {
  std::vector<geometry::Zone> zones;
  for (const physics::ObstacleConfig& each : obstacles)
    zones.push_back(zone_of(each, "obstacle " + std::to_string(zones.size() + 1)));
  return zones;
}

BenchReport report_of(const safety::Supervisor& coils, const safety::SafetyConfig& config) {
  BenchReport report;
  report.coils = [&coils] { return coils.reported(); };
  if (!config.keep_out_file.empty()) report.keep_out = [&coils] { return coils.keep_out(); };
  return report;
}

/// Draws what a trial has of its own, and says whether there is a way past it.
void add_obstacles(const DeploymentConfig& config, TrialPlan& plan) {
  const TrialObstaclesConfig& wanted = config.trials.obstacles;
  check_obstacles(wanted, config.rig, plan.task);
  if (wanted.count == 0) return;
  plan.obstacles = draw_obstacles(wanted, config.rig, plan, config.route.clearance_m,
                                  common::RandomStream(trial_seed(config, plan), "obstacles"));
  const std::vector<geometry::Zone> solid = zones_of(plan.obstacles);
  std::vector<geometry::Zone>& zones = plan.keep_out.zones;  // those that may move stay the last
  zones.insert(zones.begin() + static_cast<std::ptrdiff_t>(config.safety.keep_out.size()), solid.begin(),
               solid.end());
  plan.unreachable =
      plan.routes && plan.routes->route(plan.start.position_m(), plan.target_m, plan.keep_out).empty();
}

}  // namespace

std::unique_ptr<control::Controller> decorated(std::unique_ptr<control::Controller> controller,
                                               const DeploymentConfig& config, double scale_A) {
  controller = control::decorate(std::move(controller), config.decorators, physics::CoilDrive(config.rig));
  if (config.turn.current_A > 0.0)
    controller =
        std::make_unique<control::TurnInPlace>(std::move(controller), config.turn, config.rig, scale_A);
  return controller;
}

std::string to_string(RigKind kind) {
  return kind == RigKind::kExplored ? "explored" : kind == RigKind::kUnseen ? "unseen" : "real";
}

UnseenRig unseen_rig(const DeploymentConfig& config, const std::string& task, std::int64_t index) {
  const std::uint64_t around = unseen_seed(config, task, index);
  common::RandomStream room(around, "unseen temperature");
  return {warmed(config.rig, config.trials.temperature_C.draw(room)),
          common::derive_seed(around, "unseen rig"), common::derive_seed(around, "unseen sensor")};
}

void check_in_dish(const physics::RigDescription& rig, const geometry::Vector2& point_m,
                   const std::string& key) {
  // Furthest out, the needle lies along the wall.
  if (rig.fits({point_m.x(), point_m.y(), std::atan2(point_m.y(), point_m.x()) + 0.5 * geometry::kPi}))
    return;
  char text[160];
  std::snprintf(
      text, sizeof text,
      " = (%.1f, %.1f) mm lies outside the dish: its radius is %.1f mm, and the middle of the needle "
      "stays %.1f mm from the wall",
      1e3 * point_m.x(), 1e3 * point_m.y(), 1e3 * rig.dish.radius_m,
      1e3 * (rig.dish.radius_m - rig.reach_m()));
  throw common::ConfigError(key + text);
}

geometry::Path headed_path(const geometry::Path& path, const DeploymentConfig& config) {
  using geometry::HeadingRule;
  using geometry::PathHeading;
  const TrialsConfig& trials = config.trials;
  if (trials.path_heading != HeadingRule::kNone && config.rig.needle.is_sphere())
    throw common::InvalidConfig("trials.path_heading", common::name_of(trials.path_heading),
                                "be none: a sphere (rig.needle.shape) has no heading");
  switch (trials.path_heading) {
    case HeadingRule::kNone:
      break;
    case HeadingRule::kTangent:
      return path.with_heading(PathHeading::tangent());
    case HeadingRule::kFixed:
      return path.with_heading(PathHeading::fixed(geometry::kRadPerDeg * trials.path_heading_deg));
    case HeadingRule::kColumn:
      if (path.heading().rule() == HeadingRule::kColumn) return path;
      throw common::ConfigError(
          "trials.path_heading = \"column\": the path has no headings of its own; follow a file with header "
          "x_m,y_m,heading_rad, or use tangent or fixed");
  }
  return path.with_heading({});
}

TrialPlan plan_trial(const DeploymentConfig& config, const std::string& task, std::int64_t index,
                     const std::optional<geometry::Vector2>& target_m,
                     const std::optional<geometry::Path>& path,
                     const std::function<bool(const geometry::Pose2&)>& fits, const task::Region* region,
                     std::shared_ptr<const task::RouteMap> routes) {
  TrialPlan plan;
  plan.task = task;
  plan.index = index;
  plan.duration_s = config.trials.point_seconds;
  plan.reference = config.reference;
  plan.suture = suture_reference(config);
  plan.keep_out = config.safety.keeps_out(config.rig);
  plan.routes = std::move(routes);
  // Whatever holds the needle near its target would hold it there on its way, too.
  plan.waypoint_radius_m = std::max(config.route.waypoint_radius_m, config.decorators.hold_radius_m);
  common::RandomStream random(trial_seed(config, plan), "start and target");
  constexpr int kMaxDraws = 100000;
  int draws = 0;
  do {
    if (++draws > kMaxDraws)
      throw common::ConfigError("trials.start_radius = " + std::to_string(config.trials.start_radius) +
                                ": no start inside the dish and clear of safety.keep_out and of the zones of "
                                "safety.keep_out_file was found; use a "
                                "smaller radius, or smaller zones");
    const geometry::Vector2 start_m =
        task::draw_in_disc(config.trials.start_radius * config.rig.dish.radius_m, random);
    plan.start = {start_m.x(), start_m.y(), random.uniform(-geometry::kPi, geometry::kPi)};
  } while (!fits(plan.start) || (region != nullptr && !region->contains(plan.start.position_m())) ||
           !(plan.keep_out.clearance_m(plan.start) > plan.keep_out.margin_m + config.route.clearance_m));
  if (config.rig.needle.is_sphere()) plan.start.heading_rad = 0.0;
  const auto draw = [&] {
    return task::draw_in_disc(config.trials.goal_radius * config.rig.dish.radius_m, random);
  };
  const auto draw_target = [&]() -> geometry::Vector2 {
    return region != nullptr ? region->draw(draw) : draw();
  };
  geometry::Vector2 drawn_m = draw_target();
  const bool drawn = (task == "point" || task == "pose") && !target_m;
  for (draws = 0; drawn && !(plan.keep_out.clearance_m(drawn_m, drawn_m) > plan.keep_out.any_way_m());) {
    if (++draws > kMaxDraws)
      throw common::ConfigError("trials.goal_radius = " + std::to_string(config.trials.goal_radius) +
                                ": no target was found at which the needle keeps clear of safety.keep_out "
                                "and of the zones of safety.keep_out_file "
                                "whichever way it lies; use a larger radius, or smaller zones");
    drawn_m = draw_target();
  }
  if (task == "point" || task == "pose")
    plan.target_m = target_m.value_or(drawn_m);
  else if (task == "square")
    plan.path = geometry::Path::square(config.trials.square_side_m);
  else if (task == "circle")
    plan.path = geometry::Path::circle(config.trials.circle_radius_m);
  else if (task == "path")
    plan.path = path;
  else if (task == "suture")
    plan.stitches = stitches_of(config.trials.suture);
  else
    LODESTONE_CHECK(task == "centre",
                    "a task: centre, point, pose, square, circle, path or suture, not " + task);
  if (plan.path) plan.path = headed_path(*plan.path, config);
  if (task == "pose") plan.target_heading_rad = random.uniform(-geometry::kPi, geometry::kPi);
  if (task == "pose" && config.trials.path_heading == geometry::HeadingRule::kFixed)
    plan.target_heading_rad = geometry::wrap_angle(geometry::kRadPerDeg * config.trials.path_heading_deg);
  add_obstacles(config, plan);
  return plan;
}

SimulatorSource load_simulator(const DeploymentConfig& config, const std::string& folder) {
  const inference::DynamicsModel model = inference::load_dynamics(folder);
  refuse_heading(config.rig, model, folder);
  warn_of_another_rig(config, model.info.rig, folder);
  SimulatorSource source;
  source.simulator = std::make_shared<const control::LearnedSimulator>(model);
  source.action = in_ampere(config, source.simulator->action, folder);
  if (config.identification.enabled && !source.simulator->sampled)
    common::log_warning(folder +
                        " predicts single values, so no rig can be identified by it (train-dynamics with "
                        "model.components above 0 makes one that predicts distributions)");
  return source;
}

void go_by_cost_to_go(const DeploymentConfig& config, const inference::Policy& policy,
                      const std::string& what, SimulatorSource& simulator) {
  if (!policy.cost_to_go) return;
  warn_of_another_rig(config, policy.rig, what);
  simulator.cost_to_go = std::make_shared<const inference::CostToGo>(*policy.cost_to_go);
}

ControllerSource policy_source(const DeploymentConfig& config, const inference::Policy& policy,
                               const std::string& what, const SimulatorSource* simulator) {
  refuse_heading(config.rig, policy, what);
  warn_of_another_rig(config, policy.rig, what);
  ControllerSource source;
  source.name = "policy";
  source.action = in_ampere(config, policy.action, what);
  source.identify = identified_by(config, simulator);
  source.rehearses_in = rehearses_in(simulator);
  if (policy.encoder.drive_gain && !source.identify)
    common::log_warning(
        what +
        " wants to know how strongly its rig answers, and takes it for the one it was learned "
        "on; name the simulator that identifies it: --set dynamics=DIR");
  DeploymentConfig around = config;
  if (policy.encoder.target_ahead) around.decorators.lead_s = 0.0;  // it knows where its target will be
  source.make = [policy, config = around, scale_A = source.action.scale](std::uint64_t) {
    std::unique_ptr<control::Controller> bare = std::make_unique<control::PolicyController>(policy);
    if (!policy.encoder.drive_gain) bare = std::make_unique<control::GainCorrection>(std::move(bare));
    return decorated(std::move(bare), config, scale_A);
  };
  return source;
}

ControllerSource planner_source(const DeploymentConfig& config, const SimulatorSource& simulator) {
  ControllerSource source;
  source.name = "planner";
  source.action = simulator.action;
  source.identify = identified_by(config, &simulator);
  source.rehearses_in = rehearses_in(&simulator);
  DeploymentConfig around = config;
  around.decorators.lead_s = 0.0;  // it plans for where its target will be
  source.make = [shared = simulator.simulator, cost_to_go = simulator.cost_to_go, config = around,
                 scale_A = source.action.scale](std::uint64_t seed) {
    return decorated(std::make_unique<control::Planner>(shared, config.planner, seed, cost_to_go), config,
                     scale_A);
  };
  return source;
}

control::MotionModel motion_model(const SimulatorSource& source,
                                  const control::IdentificationConfig& config) {
  return {source.simulator, config, source.drive_per_A()};
}

ControllerSource baseline_source(const DeploymentConfig& config, const SimulatorSource* simulator) {
  ControllerSource source;
  source.name = "baseline";
  source.action.scale = config.rig.coils.max_current_A;
  source.action.size = config.rig.drive_size();
  source.identify = identified_by(config, simulator);
  source.rehearses_in = rehearses_in(simulator);
  source.make = [config](std::uint64_t) {
    return decorated(std::make_unique<control::GainCorrection>(
                         std::make_unique<control::DipolePullController>(config.rig, config.baseline)),
                     config, config.rig.coils.max_current_A);
  };
  return source;
}

ControllerSource observer_source(const DeploymentConfig& config) {
  ControllerSource source;
  source.name = "observer";
  source.action.scale = config.rig.coils.max_current_A;
  source.action.size = config.rig.drive_size();
  DeploymentConfig around = config;
  around.decorators.lead_s = 0.0;  // it knows where its target will be
  source.make = [config = around](std::uint64_t) {
    return decorated(std::make_unique<control::ObserverController>(config.rig, config.observer,
                                                                   config.loop.pulse_s, config.loop.rest_s),
                     config, config.rig.coils.max_current_A);
  };
  return source;
}

std::string trial_name(RigKind kind, const ControllerSource& source, const TrialPlan& plan) {
  return to_string(kind) + "-" + source.name + "-" + plan.task + "-" + std::to_string(plan.index);
}

TrialResult run_on_session(session::RigSession& bench, const DeploymentConfig& config, const TrialPlan& plan,
                           const ControllerSource& source, const TruePose& truth, const TrialWatch& watch) {
  LODESTONE_CHECK(source.make != nullptr, "a controller that any rig can be driven by, not " + source.name);
  const std::shared_ptr<control::RigIdentifier> identifier = identifier_of(source);
  control::ControlLoop loop(config.loop, source.action, bench.coils(), bench.sensor(), bench.clock(),
                            &config.rig, identifier.get());
  const std::unique_ptr<control::Controller> controller = source.make(trial_seed(config, plan));
  TrialResult result =
      run_trial(plan, loop, *controller, truth, config.score, watch, report_of(bench.coils(), config.safety));
  note_effort(config.loop, config.rig, result);
  if (!result.samples.empty() && result.samples.front().step.estimate.valid)
    result.plan.start = result.samples.front().step.estimate.pose;
  result.rig = to_string(RigKind::kReal);
  result.controller = source.name;
  return result;
}

Deployment::Deployment(const DeploymentConfig& config, MakeDrive drive)
    : config_(config),
      drive_(std::move(drive)),
      sensing_(config.sensor, config.rig),
      explored_(sensing_.calibrated_bench(static_cast<std::uint64_t>(config.sensor_seed))),
      sample_rig_(
          std::make_unique<rig::VirtualRig>(config.rig, static_cast<std::uint64_t>(config.rig_seed))) {}

std::vector<TrialResult> Deployment::run(const std::vector<TrialPlan>& plans, RigKind kind,
                                         const ControllerSource& source, common::ThreadPool& pool,
                                         bool realtime, const TrialFolders& folders) const {
  std::vector<TrialResult> results(plans.size());
  pool.for_each(plans.size(), [&](std::size_t trial) {
    results[trial] = run_one(plans[trial], kind, source, realtime, folders);
  });
  return results;
}

TrialResult Deployment::run_one(const TrialPlan& plan, RigKind kind, const ControllerSource& source,
                                bool realtime, const TrialFolders& folders) const {
  const std::uint64_t seed = trial_seed(config_, plan);
  const bool explored = kind == RigKind::kExplored;
  UnseenRig made = explored ? UnseenRig{config_.rig, static_cast<std::uint64_t>(config_.rig_seed), 0}
                            : unseen_rig(config_, plan.task, plan.index);
  std::vector<physics::ObstacleConfig>& solid = made.config.simulation.obstacles;
  solid.insert(solid.end(), plan.obstacles.begin(), plan.obstacles.end());
  common::SteadyClock wall;  // outlives the rig
  rig::VirtualRig rig(made.config, made.seed, sample_rig_->fields());
  // The scatter from pulse to pulse belongs to the trial, or trials on the explored rig would all see the
  // same.
  common::Json state = rig.save();
  LODESTONE_CHECK(state.contains("scatter"), "the rig's state to hold the stream of its scatter");
  state["scatter"] = common::RandomStream(seed, "pulse scatter").save();
  rig.restore(state);
  rig.place(plan.start);
  session::SeenBench bench = explored ? explored_ : sensing_.new_bench(made.scene, plan.obstacles);
  if (explored && !plan.obstacles.empty())
    bench.renderer = sensing_.new_bench(explored_.seed, plan.obstacles).renderer;
  RigDrive drive{&rig.coils(), &rig.clock(), nullptr};
  if (drive_) drive = drive_(rig);
  const std::unique_ptr<session::RigSensor> sensor =
      sensing_.make(rig, bench, common::RandomStream(seed, "sensor noise"), drive.clock);
  if (realtime) rig.keep_pace_with(wall);
  common::Clock& clock = *drive.clock;
  safety::SafetyConfig limits = config_.safety;
  for (const geometry::Zone& zone : zones_of(plan.obstacles)) limits.keep_out.push_back(zone);
  safety::Supervisor coils(*drive.coils, limits, config_.rig, clock);
  const std::shared_ptr<control::RigIdentifier> identifier = identifier_of(source);
  control::ControlLoop loop(config_.loop, source.action, coils, *sensor, clock, &config_.rig,
                            identifier.get());
  const std::unique_ptr<control::Controller> controller =
      source.make_for ? source.make_for(seed, rig) : source.make(seed);
  TrialRecording recording(folders, config_.record,
                           {trial_name(kind, source, plan),
                            plan,
                            {clock, coils, sensor->camera()},
                            config_.rig,
                            config_.loop.period_s(),
                            source.action.scale,
                            true});
  TrialResult result = run_trial(
      plan, loop, *controller, [&rig] { return rig.true_pose(); }, config_.score,
      [&recording](const TrialSample& sample) { recording.show(sample); }, report_of(coils, config_.safety));
  note_effort(config_.loop, config_.rig, result);
  recording.finish(result);
  result.rig = to_string(kind);
  result.controller = source.name;
  return result;
}

}  // namespace lodestone::experiments
