#include <catch2/catch.hpp>

#include "inference/random_policy.h"
#include "lodestone/common/artefact.h"
#include "lodestone/control/policy_controller.h"
#include "lodestone/experiments/deployment.h"
#include "lodestone/experiments/recorder.h"
#include "lodestone/experiments/routing.h"
#include "paper_rig.h"

using namespace lodestone;

namespace {

experiments::DeploymentConfig quick_config() {
  experiments::DeploymentConfig config;
  config.sensor.kind = "simulated";
  config.trials.point_seconds = 3.0;
  config.reference.speed_m_s = 0.03;
  config.reference.approach_limit_s = 1.0;
  return config;
}

std::vector<experiments::TrialPlan> plans(const experiments::DeploymentConfig& config,
                                          const experiments::Deployment& deployment, const std::string& task,
                                          int count) {
  std::vector<experiments::TrialPlan> out;
  for (int i = 0; i < count; ++i)
    out.push_back(
        experiments::plan_trial(config, task, i, std::nullopt, std::nullopt,
                                [&](const geometry::Pose2& pose) { return deployment.fits(pose); }));
  return out;
}

std::string fingerprint(const std::vector<experiments::TrialResult>& results) {
  std::string text;
  for (const auto& result : results) text += common::artefact_to_json(experiments::record_of(result)).dump();
  return text;
}

}  // namespace

TEST_CASE("trials depend neither on threads nor on the trials beside them") {
  const auto config = quick_config();
  const experiments::Deployment deployment(config);
  const auto source = experiments::baseline_source(config);
  for (const auto kind : {experiments::RigKind::kExplored, experiments::RigKind::kUnseen}) {
    const auto todo = plans(config, deployment, "point", 3);
    std::vector<std::string> prints;
    for (const std::size_t threads : {1, 2, 4}) {
      common::ThreadPool pool(threads);
      prints.push_back(fingerprint(deployment.run(todo, kind, source, pool)));
    }
    CHECK(prints[0] == prints[1]);
    CHECK(prints[0] == prints[2]);
    common::ThreadPool pool(1);
    const auto alone = deployment.run({todo[2]}, kind, source, pool);
    CHECK(prints[0].find(fingerprint(alone)) != std::string::npos);
  }
}

TEST_CASE("one policy drives trials in several threads with the same results") {
  const auto config = quick_config();
  const experiments::Deployment deployment(config);
  inference::Policy policy;
  policy.encoder = tests::paper_encoder();
  policy.action = tests::paper_action();
  policy.encoder.memory = true;
  tests::draw_weights(policy, 7);
  experiments::ControllerSource source;
  source.name = "policy";
  source.action = policy.action;
  source.make = [policy](std::uint64_t) { return std::make_unique<control::PolicyController>(policy); };
  const auto todo = plans(config, deployment, "centre", 6);
  std::vector<std::string> prints;
  for (const std::size_t threads : {1, 2, 4}) {
    common::ThreadPool pool(threads);
    const auto results = deployment.run(todo, experiments::RigKind::kExplored, source, pool);
    for (const auto& result : results) CHECK(result.stop_reason.empty());
    prints.push_back(fingerprint(results));
  }
  CHECK(prints[0] == prints[1]);
  CHECK(prints[0] == prints[2]);
}

TEST_CASE("with a simulator every controller is told how strong its rig is, each trial from nothing") {
  const auto config = quick_config();
  const experiments::Deployment deployment(config);
  const std::string folder = std::string(LODESTONE_SOURCE_DIR) + "/models/dynamics_best";
  const experiments::SimulatorSource simulator = experiments::load_simulator(config, folder);
  common::ThreadPool pool(2);
  const auto todo = plans(config, deployment, "point", 2);
  for (const experiments::ControllerSource& source :
       {experiments::planner_source(config, simulator), experiments::baseline_source(config, &simulator)}) {
    INFO(source.name);
    for (const auto& result : deployment.run(todo, experiments::RigKind::kExplored, source, pool)) {
      CHECK(result.stop_reason.empty());
      const auto& first = result.samples.front().step.drive_gain;
      const auto& last = result.samples.back().step.drive_gain;
      REQUIRE(first);
      REQUIRE(last);
      CHECK(first->log_mean == Approx(0.0).margin(1e-12));
      CHECK(last->log_sigma < first->log_sigma);
    }
  }
  auto without = config;
  without.identification.enabled = false;
  CHECK_FALSE(experiments::planner_source(without, simulator).identify);
  CHECK_FALSE(experiments::baseline_source(config).identify);
}

TEST_CASE("a policy that is told the gain decides for itself; the commands of any other are divided by it") {
  const auto config = quick_config();
  task::Observation strong;
  strong.drive_gain = task::DriveGain{std::log(2.0), 0.1};
  for (const bool told : {false, true}) {
    inference::Policy policy;
    policy.hidden = {8};
    policy.encoder.drive_gain = told;
    tests::draw_weights(policy, 3);
    task::Observation as_seen = strong;
    if (!told) as_seen.drive_gain.reset();
    const geometry::Vector2 own = control::PolicyController(policy).act(as_seen);
    REQUIRE(own.norm() > 0.01);
    const auto controller = experiments::policy_source(config, policy, "policy", nullptr).make(1);
    const geometry::Vector2 given = controller->act(strong);
    CHECK((given - (told ? own : geometry::Vector2(own / 2.0))).norm() < 1e-6);
  }
}

TEST_CASE("on a bench what was identified is carried from trial to trial where that is asked for") {
  auto config = quick_config();
  const std::string folder = std::string(LODESTONE_SOURCE_DIR) + "/models/dynamics_best";
  const experiments::SimulatorSource simulator = experiments::load_simulator(config, folder);
  const auto same = [&] {
    const auto source = experiments::baseline_source(config, &simulator);
    return source.identify() == source.identify();
  };
  config.identification.carry = true;
  CHECK_FALSE(same());
  config.rig.backend = rig::Backend::kSerial;
  CHECK(same());
  config.identification.carry = false;
  CHECK_FALSE(same());
}

TEST_CASE("plans repeat, lie inside the dish and keep a given target") {
  const auto config = quick_config();
  const experiments::Deployment deployment(config);
  const auto first = plans(config, deployment, "point", 20);
  const auto again = plans(config, deployment, "point", 20);
  for (std::size_t i = 0; i < first.size(); ++i) {
    CHECK(deployment.fits(first[i].start));
    CHECK(first[i].start.x_m == again[i].start.x_m);
    CHECK(first[i].target_m == again[i].target_m);
    CHECK(first[i].target_m.norm() <= config.trials.goal_radius * config.rig.dish.radius_m);
  }
  CHECK(first[0].target_m != first[1].target_m);
  const geometry::Vector2 target(0.004, -0.01);
  const auto fixed =
      experiments::plan_trial(config, "point", 0, target, std::nullopt,
                              [&](const geometry::Pose2& pose) { return deployment.fits(pose); });
  CHECK(fixed.target_m == target);
  CHECK(fixed.start.x_m == first[0].start.x_m);
}

TEST_CASE("explored rigs share friction and calibration, unseen rigs do not share the outcomes of starts") {
  const auto config = quick_config();
  const experiments::Deployment deployment(config);
  const auto source = experiments::baseline_source(config);
  common::ThreadPool pool(2);
  const auto todo = plans(config, deployment, "square", 1);
  const auto explored = deployment.run(todo, experiments::RigKind::kExplored, source, pool);
  const auto unseen = deployment.run(todo, experiments::RigKind::kUnseen, source, pool);
  REQUIRE(explored[0].completed);
  REQUIRE(unseen[0].completed);
  CHECK(explored[0].samples.front().true_pose->x_m == unseen[0].samples.front().true_pose->x_m);
  CHECK(explored[0].samples.front().step.estimate.pose.x_m !=
        unseen[0].samples.front().step.estimate.pose.x_m);
  CHECK(explored[0].truth->cross_track_rms_mm);
  CHECK(explored[0].samples.back().step.last);
}

TEST_CASE("trials of a pose have a heading to reach, and those within a region keep to it") {
  const experiments::DeploymentConfig config;
  const auto anywhere = [](const geometry::Pose2&) { return true; };
  const experiments::TrialPlan pose =
      experiments::plan_trial(config, "pose", 3, std::nullopt, std::nullopt, anywhere);
  REQUIRE(pose.target_heading_rad);
  CHECK_FALSE(
      experiments::plan_trial(config, "point", 3, std::nullopt, std::nullopt, anywhere).target_heading_rad);

  std::vector<task::Move> moves;
  for (int i = 0; i < 500; ++i) {
    const double x_m = 0.02 * ((i * 37) % 100) / 100.0;
    const double y_m = 0.02 * ((i * 61) % 100) / 100.0;
    moves.push_back({{0.02 - x_m, 0.02 - y_m}, {x_m, y_m}});
  }
  const task::Region region(moves, {});
  for (int i = 0; i < 20; ++i) {
    const experiments::TrialPlan plan =
        experiments::plan_trial(config, "point", i, std::nullopt, std::nullopt, anywhere, &region);
    CHECK(region.contains(plan.start.position_m()));
    CHECK(region.contains(plan.target_m));
  }
}

TEST_CASE("paths have the headings that are configured, and nothing else changes by them") {
  experiments::DeploymentConfig config;
  const auto anywhere = [](const geometry::Pose2&) { return true; };
  const auto planned = [&](const std::string& task, const std::optional<geometry::Path>& path = {}) {
    return experiments::plan_trial(config, task, 3, std::nullopt, path, anywhere);
  };
  const experiments::TrialPlan plain = planned("circle");
  CHECK_FALSE(plain.path->heading_rad(0.0));
  const double drawn_rad = *planned("pose").target_heading_rad;
  config.trials.path_heading = geometry::HeadingRule::kTangent;
  const experiments::TrialPlan tangent = planned("circle");
  CHECK(*tangent.path->heading_rad(0.0) == Approx(geometry::kPi / 2.0).margin(0.02));
  CHECK(tangent.start.x_m == plain.start.x_m);
  CHECK_FALSE(tangent.target_heading_rad);  // of a point
  CHECK(*planned("pose").target_heading_rad == drawn_rad);
  config.trials.path_heading = geometry::HeadingRule::kFixed;
  config.trials.path_heading_deg = -270.0;
  CHECK(*planned("square").path->heading_rad(0.05) == Approx(geometry::kPi / 2.0));
  CHECK(*planned("pose").target_heading_rad == Approx(geometry::kPi / 2.0));
  CHECK(planned("pose").start.x_m == experiments::plan_trial({}, "pose", 3, {}, {}, anywhere).start.x_m);
  config.trials.path_heading = geometry::HeadingRule::kColumn;
  const geometry::Path way({{0.0, 0.0}, {0.01, 0.0}}, false);
  const geometry::Path headed = way.with_heading(geometry::PathHeading::column({0.5, 1.0}));
  CHECK(*planned("path", headed).path->heading_rad(0.0) == 0.5);
  CHECK_THROWS_WITH(planned("path", way), Catch::Contains("x_m,y_m,heading_rad"));
  CHECK_THROWS_AS(planned("square"), common::ConfigError);
  config.trials.path_heading = geometry::HeadingRule::kNone;
  CHECK_FALSE(planned("path", headed).path->heading_rad(0.0));
}

TEST_CASE("a suture is planned as it is configured, from a start that is drawn as for any task") {
  experiments::DeploymentConfig config;
  const auto anywhere = [](const geometry::Pose2&) { return true; };
  const auto planned = [&] {
    return experiments::plan_trial(config, "suture", 3, std::nullopt, std::nullopt, anywhere);
  };
  const experiments::TrialPlan plan = planned();
  REQUIRE(plan.stitches.size() == 5);
  CHECK(plan.moves());
  CHECK_FALSE(plan.path);
  CHECK_FALSE(plan.target_heading_rad);
  CHECK(plan.suture.arrive_m == config.suture.arrive_m);
  CHECK(planned().start.x_m == plan.start.x_m);
  config.trials.suture.count = 2;
  config.decorators.hold_radius_m = 0.0015;
  CHECK(planned().stitches.size() == 2);
  CHECK(planned().start.x_m == plan.start.x_m);
  CHECK(planned().suture.arrive_m == 0.0015);
  CHECK_FALSE(experiments::plan_trial(config, "point", 3, std::nullopt, std::nullopt, anywhere).moves());
}

TEST_CASE("a suture is driven to its end on a virtual rig, scored and recorded") {
  experiments::DeploymentConfig config = quick_config();
  config.trials.suture.count = 2;
  config.suture.speed_m_s = 0.02;
  config.suture.arrive_limit_s = 0.9;
  const experiments::Deployment deployment(config);
  common::ThreadPool pool(1);
  const auto result = deployment
                          .run(plans(config, deployment, "suture", 1), experiments::RigKind::kExplored,
                               experiments::baseline_source(config), pool)
                          .front();
  REQUIRE(result.completed);
  REQUIRE(result.truth);
  CHECK(result.truth->stitch_figures->size() == 2);
  CHECK(result.truth->heading_rms_deg);
  const runs::TrialRecord record = experiments::record_of(result);
  CHECK(record.task == "suture");
  REQUIRE(record.stitches);
  CHECK(record.stitches->at(1).entry[0] == Approx(2.0));
  CHECK(record.stitches->at(1).exit[1] == Approx(-3.0));
  CHECK_FALSE(record.target_mm);
  CHECK_FALSE(record.path_mm);
  CHECK(record.reference_mm->size() == record.time_s.size());
  CHECK(record.reference_heading_rad->size() == record.time_s.size());
  CHECK(record.approach->front() == 1);
  CHECK(record.approach->back() == 0);
}

TEST_CASE("starts and drawn targets keep clear of zones, and without zones are what they were") {
  experiments::DeploymentConfig config;
  const auto anywhere = [](const geometry::Pose2&) { return true; };
  const auto plan = [&](int index) {
    return experiments::plan_trial(config, "point", index, std::nullopt, std::nullopt, anywhere);
  };
  const experiments::TrialPlan before = plan(0);
  config.safety.keep_out = {{"vessel", {0.0, 0.0}, 0.004}};
  for (int i = 0; i < 30; ++i) {
    const experiments::TrialPlan kept = plan(i);
    REQUIRE_FALSE(kept.keep_out.empty());
    CHECK(kept.keep_out.clearance_m(kept.start) > kept.keep_out.margin_m);
    CHECK(kept.keep_out.clearance_m(kept.target_m, kept.target_m) > kept.keep_out.any_way_m());
  }
  config.safety.keep_out = {{"far away", {0.9, 0.9}, 0.004}};
  CHECK(plan(0).target_m == before.target_m);
  CHECK(plan(0).start.x_m == before.start.x_m);
  config.safety.keep_out = {{"everywhere", {0.0, 0.0}, 0.05}};
  CHECK_THROWS_WITH(plan(0), Catch::Contains("safety.keep_out"));
}

TEST_CASE(
    "a baseline that would go through a zone is led around it, and the supervisor stops one that is not") {
  experiments::DeploymentConfig config = quick_config();
  config.trials.point_seconds = 20.0;
  config.safety.keep_out = {{"vessel", {0.0, 0.0}, 0.003}};
  experiments::TrialPlan led = experiments::plan_trial(
      config, "point", 0, geometry::Vector2(0.025, 0.0), std::nullopt,
      [](const geometry::Pose2&) { return true; }, nullptr, experiments::route_map(config, nullptr, nullptr));
  led.start = {-0.025, 0.0, 0.5 * geometry::kPi};
  experiments::TrialPlan straight = led;
  straight.routes = nullptr;
  const experiments::Deployment deployment(config);
  const auto source = experiments::baseline_source(config);
  common::ThreadPool pool(2);
  const auto results = deployment.run({led, straight}, experiments::RigKind::kExplored, source, pool);
  CHECK_FALSE(results[1].completed);
  CHECK_THAT(results[1].stop_reason, Catch::Contains("keep-out zone vessel"));
  CHECK_FALSE(results[1].truth->success);
  const auto record = experiments::record_of(results[0]);
  REQUIRE(record.route_mm);
  CHECK(record.route_mm->size() > 1);
  REQUIRE(results[0].truth->clearance_mm);
  CHECK(*results[0].truth->clearance_mm > *results[1].truth->clearance_mm);
}

TEST_CASE("an unseen rig is as warm as its trial says, an explored one as configured") {
  experiments::DeploymentConfig config = quick_config();
  config.trials.temperature_C = {20.0, 20.0};
  experiments::DeploymentConfig warm = config;
  warm.trials.temperature_C = {40.0, 40.0};
  const experiments::Deployment cold_rigs(config);
  const experiments::Deployment warm_rigs(warm);
  const auto source = experiments::baseline_source(config);
  common::ThreadPool pool(1);
  const auto todo = plans(config, cold_rigs, "point", 1);
  CHECK(fingerprint(cold_rigs.run(todo, experiments::RigKind::kUnseen, source, pool)) !=
        fingerprint(warm_rigs.run(todo, experiments::RigKind::kUnseen, source, pool)));
  CHECK(fingerprint(cold_rigs.run(todo, experiments::RigKind::kExplored, source, pool)) ==
        fingerprint(warm_rigs.run(todo, experiments::RigKind::kExplored, source, pool)));
}

TEST_CASE("a target where the middle of the needle cannot be is refused") {
  const physics::RigDescription rig;
  CHECK_NOTHROW(experiments::check_in_dish(rig, {0.040, 0.0}, "target_mm"));
  CHECK_THROWS_WITH(experiments::check_in_dish(rig, {0.0, -0.042}, "target_mm"),
                    Catch::Contains("target_mm = (0.0, -42.0) mm") && Catch::Contains("42.5"));
}
