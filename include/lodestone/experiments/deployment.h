#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/range.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/control/control_loop.h"
#include "lodestone/control/decorators.h"
#include "lodestone/control/dipole_pull.h"
#include "lodestone/control/learned_simulator.h"
#include "lodestone/control/observer_config.h"
#include "lodestone/control/planner.h"
#include "lodestone/control/reference.h"
#include "lodestone/control/rig_identifier.h"
#include "lodestone/control/suture_reference.h"
#include "lodestone/control/turn_in_place.h"
#include "lodestone/experiments/score.h"
#include "lodestone/experiments/suture.h"
#include "lodestone/experiments/trial.h"
#include "lodestone/experiments/trial_obstacles.h"
#include "lodestone/experiments/trial_recording.h"
#include "lodestone/geometry/path_heading.h"
#include "lodestone/inference/policy.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/session/rig_session.h"
#include "lodestone/session/sensing.h"
#include "lodestone/task/region.h"
#include "lodestone/task/route_map.h"
#include "lodestone/task/task.h"

namespace lodestone::experiments {

/// Which trials are run. Starts and targets are drawn from the run's seed, the same for every controller and
/// rig.
struct TrialsConfig {
  std::int64_t count = 50;
  std::int64_t per_rig = 0;
  double start_radius = 0.82;
  double goal_radius = 0.7;
  task::Within within = task::Within::kDisc;
  common::Range temperature_C = {20.0, 25.0};  // I: a laboratory over the year
  double point_seconds = 20.0;
  double square_side_m = 0.030;
  double circle_radius_m = 0.015;
  geometry::HeadingRule path_heading = geometry::HeadingRule::kNone;
  double path_heading_deg = 0.0;
  TrialObstaclesConfig obstacles;
  SutureConfig suture;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("count", count, "", "trials per task", {1, 100000});
    v.field(
        "per_rig", per_rig, "",
        "so many trials of a task, one after another, share a rig nobody has seen, and all tasks have the "
        "same rigs; 0: every trial has one of its own",
        {0, 100000});
    v.retired("start_radius_m", "start_radius, in dish radii");
    v.retired("goal_radius_m", "goal_radius, in dish radii");
    v.field("start_radius", start_radius, "dish radii", "starts are drawn over a disc of this radius",
            {0.0, 1.0});
    v.field("goal_radius", goal_radius, "dish radii",
            "targets of `point` are drawn over a disc of this radius", {0.0, 1.0});
    v.field("within", within, "",
            "starts and targets lie anywhere on those discs, or only where the policy's training data show "
            "them to be "
            "reachable");
    v.field("temperature_C", temperature_C, "C",
            "an unseen rig's room, and with it its coils and fluid, is this warm", {0.0, 60.0});
    v.field("point_seconds", point_seconds, "s", "length of a trial of `centre`, `point` or `pose`",
            {0.1, 3600.0});
    v.field("square_side_m", square_side_m, "m", "side of the square", {1e-3, 1.0});
    v.field("circle_radius_m", circle_radius_m, "m", "radius of the circle", {1e-3, 1.0});
    v.field(
        "path_heading", path_heading, "",
        "how the needle shall lie along square, circle or path: any way, along the direction of travel, at "
        "path_heading_deg, or as the path's file says (column heading_rad); fixed is that of `pose`, too, "
        "which is drawn otherwise");
    v.field("path_heading_deg", path_heading_deg, "deg", "the heading, where it is fixed", {-360.0, 360.0});
    v.group("obstacles", obstacles, "obstacles that are drawn for each trial");
    v.group("suture", suture, "the stitches of `suture`");
  }
};

/// Everything a deployment depends on, besides the policy.
struct DeploymentConfig {
  std::int64_t seed = 1;
  std::int64_t rig_seed = 1;
  std::int64_t sensor_seed = 1;
  TrialsConfig trials;
  ScoreConfig score;
  control::PathReferenceConfig reference;
  control::SutureReferenceConfig suture;
  task::RouteConfig route;
  control::ControlLoopConfig loop;
  safety::SafetyConfig safety;
  control::DecoratorConfig decorators;
  control::TurnConfig turn;
  control::DipolePullConfig baseline;
  control::ObserverConfig observer;
  control::PlannerConfig planner;
  control::IdentificationConfig identification;
  rig::RigConfig rig;
  session::SensingConfig sensor;
  RecordingConfig record;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of starts, targets, sensor noise and unseen rigs", {0, 9e15});
    v.field("rig_seed", rig_seed, "", "seed of what is hidden in the explored rig, as in collect", {0, 9e15});
    v.field("sensor_seed", sensor_seed, "", "seed of the explored rig's camera, as in collect", {0, 9e15});
    v.group("trials", trials, "the trials");
    v.group("score", score, "rules of scoring");
    v.group("reference", reference, "how a path is fed to the controller");
    v.group("suture", suture, "how stitches are fed to the controller");
    v.group("route", route, "how ways to a point are searched around zones, and fed to the controller");
    v.group("loop", loop, "timing of the control loop");
    v.group("safety", safety, "limits of the supervisor");
    v.group("decorators", decorators, "what is put around every controller");
    v.group("turn", turn, "turning in place, where a target has a heading (task pose)");
    v.group("baseline", baseline, "the proportional baseline");
    v.group("observer", observer, "sliding mode with a disturbance observer");
    v.group("planner", planner, "planning in the learned simulator");
    v.group("identification", identification,
            "what the pulses say about the rig, where a learned simulator is named (dynamics)");
    v.group("rig", rig, "the rig");
    v.group("sensor", sensor, "how poses are sensed");
    v.group("record", record, "videos");
  }
};

/// A rig that was explored (friction map and camera of collect), or one never seen before (own friction map,
/// camera and temperature in every trial, calibrated from its first image), or one that is connected.
enum class RigKind { kExplored, kUnseen, kReal };
std::string to_string(RigKind kind);

/// A rig nobody has seen: what makes it.
struct UnseenRig {
  rig::RigConfig config;    ///< the description at its temperature, which changes coils and fluid
  std::uint64_t seed = 1;   ///< of what is hidden in it
  std::uint64_t scene = 1;  ///< of its camera, or its simulated calibration error
};

/// The one that a trial is driven on.
UnseenRig unseen_rig(const DeploymentConfig& config, const std::string& task, std::int64_t index);

/// Throws ConfigError, naming `key`, where the middle of a needle of this rig cannot be.
void check_in_dish(const physics::RigDescription& rig, const geometry::Vector2& point_m,
                   const std::string& key);

/// The path with the headings that config.trials asks for. Throws ConfigError where they are to be those of
/// its file, and that has none, and where a sphere is to have any.
geometry::Path headed_path(const geometry::Path& path, const DeploymentConfig& config);

/// Start, target or path of trial `index` of a task ("centre", "point", "pose", "square", "circle", "suture",
/// or "path" with `path`). `target_m`, when given, replaces the drawn target of `point`. `fits` says whether
/// a start lies inside the dish. With a `region`, start and drawn target lie in it. Both keep clear of the
/// zones of config.safety; by `routes` the needle is led around them. Obstacles are drawn from a stream of
/// their own, so that start and target are those of a trial without; where `routes` has no way past them the
/// plan says so. Throws ConfigError where nothing fits, and what check_obstacles() throws.
TrialPlan plan_trial(const DeploymentConfig& config, const std::string& task, std::int64_t index,
                     const std::optional<geometry::Vector2>& target_m,
                     const std::optional<geometry::Path>& path,
                     const std::function<bool(const geometry::Pose2&)>& fits,
                     const task::Region* region = nullptr,
                     std::shared_ptr<const task::RouteMap> routes = nullptr);

/// A learned simulator, which sources share.
struct SimulatorSource {
  std::shared_ptr<const control::LearnedSimulator> simulator;
  task::ActionConfig action;  ///< its own, in the rig's ampere
  /// What poses cost in it, where that was learned beside a policy; null: planners go by distances.
  std::shared_ptr<const inference::CostToGo> cost_to_go = nullptr;

  /// Takes amperes to its unit of drive.
  double drive_per_A() const { return simulator->action.scale / action.scale; }
};

/// What a simulator says of pulses on the rig.
control::MotionModel motion_model(const SimulatorSource& source, const control::IdentificationConfig& config);

/// Reads the simulator in a folder for this rig. Says so where it was learned on another one, or where a rig
/// that shall be identified cannot be by it. Throws ConfigError when its drives go beyond the rig's largest
/// current, and CheckpointError.
SimulatorSource load_simulator(const DeploymentConfig& config, const std::string& folder);

/// From now on planners in the simulator go by what the policy's checkpoint says that poses cost, where it
/// says so. Says so where that was learned for another rig; `what` names the policy.
void go_by_cost_to_go(const DeploymentConfig& config, const inference::Policy& policy,
                      const std::string& what, SimulatorSource& simulator);

/// A controller and the scale of its actions. What it makes is made once per trial, and must be safe to make
/// from several threads.
struct ControllerSource {
  std::string name;  ///< "policy", "planner", "baseline", "observer" or "oracle"
  task::ActionConfig action;
  std::function<std::unique_ptr<control::Controller>(std::uint64_t seed)> make;
  /// Instead, for a virtual rig alone, which outlives what is made (oracle_source()).
  std::function<std::unique_ptr<control::Controller>(std::uint64_t seed, const rig::VirtualRig& rig)>
      make_for;
  /// What the rig is identified by in the next trial, as it knows it then; empty: it is not.
  std::function<std::shared_ptr<control::RigIdentifier>()> identify;
  /// In which it can rehearse; null: in none.
  std::shared_ptr<const SimulatorSource> rehearses_in = nullptr;
};

/// What the configuration puts around every controller; an action of 1 is `scale_A`.
std::unique_ptr<control::Controller> decorated(std::unique_ptr<control::Controller> controller,
                                               const DeploymentConfig& config, double scale_A);

/// The baseline at the rig's largest current; with a simulator, its commands are divided by the gain that is
/// identified.
ControllerSource baseline_source(const DeploymentConfig& config, const SimulatorSource* simulator = nullptr);

/// Sliding mode with a disturbance observer, at the rig's largest current. It knows the description and its
/// own pulses: no simulator identifies its rig, as it estimates the gain itself.
ControllerSource observer_source(const DeploymentConfig& config);

/// A trained policy; with a simulator, as the baseline. Throws ConfigError when its actions go beyond the
/// rig's largest current; `what` names it.
ControllerSource policy_source(const DeploymentConfig& config, const inference::Policy& policy,
                               const std::string& what, const SimulatorSource* simulator = nullptr);

/// A planner in a learned simulator, and by what is identified.
ControllerSource planner_source(const DeploymentConfig& config, const SimulatorSource& simulator);

/// What drives a virtual rig: its own coils and clock, or a whole emulated bench around it, which `keep`
/// keeps.
struct RigDrive {
  rig::Coils* coils = nullptr;
  common::Clock* clock = nullptr;
  std::shared_ptr<void> keep;
};
using MakeDrive = std::function<RigDrive(rig::VirtualRig& rig)>;

/// One trial on a bench, from where the needle lies.
TrialResult run_on_session(session::RigSession& bench, const DeploymentConfig& config, const TrialPlan& plan,
                           const ControllerSource& source, const TruePose& truth = {},
                           const TrialWatch& watch = {});

/// Name of a trial's files, without ending.
std::string trial_name(RigKind kind, const ControllerSource& source, const TrialPlan& plan);

/// Runs trials, each on a virtual rig of its own with its own random streams, so that results depend neither
/// on threads nor on which other trials are run.
class Deployment {
 public:
  /// `drive`, when given, must be safe to call from several threads.
  explicit Deployment(const DeploymentConfig& config, MakeDrive drive = {});

  /// Results in the order of `plans`. With `realtime`, every trial takes as long as it says.
  std::vector<TrialResult> run(const std::vector<TrialPlan>& plans, RigKind kind,
                               const ControllerSource& source, common::ThreadPool& pool,
                               bool realtime = false, const TrialFolders& folders = {}) const;

  /// Whether the needle lies inside the wall at a pose.
  bool fits(const geometry::Pose2& pose) const { return sample_rig_->fits(pose); }

 private:
  TrialResult run_one(const TrialPlan& plan, RigKind kind, const ControllerSource& source, bool realtime,
                      const TrialFolders& folders) const;

  DeploymentConfig config_;
  MakeDrive drive_;
  session::Sensing sensing_;
  session::SeenBench explored_;
  std::unique_ptr<rig::VirtualRig> sample_rig_;  // lends its field table to the rigs of the trials
};

}  // namespace lodestone::experiments
