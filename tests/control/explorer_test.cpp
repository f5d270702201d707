#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <optional>

#include "control/controller_conformance.h"
#include "control/fakes.h"
#include "lodestone/control/explorer.h"
#include "other_rigs.h"
#include "paper_rig.h"
#include "sphere_rig.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

/// A dish in which the needle goes where it is pulled, farther the nearer the coil, and clings to the wall:
/// enough to compare explorers.
geometry::Pose2 toy_step(const geometry::Pose2& pose, const Vector2& action) {
  const double drive = action.norm();
  const bool at_wall = pose.position_m().norm() > 0.036;
  if (drive < (at_wall ? 0.8 : 0.2)) return pose;
  const double nearness = pose.position_m().dot(action) / drive / 0.04;
  Vector2 next = pose.position_m() + 0.025 * action * drive * std::exp(2.0 * nearness);
  if (next.norm() > 0.038) next *= 0.038 / next.norm();
  return {next.x(), next.y(), std::atan2(action.y(), action.x())};
}

bool in_dish(const geometry::Pose2& pose) { return pose.position_m().norm() < 0.037; }

/// Entropy of visits over position cells, as a fraction of the largest that this many cells allow.
double evenness(const std::map<int, int>& visits, int total) {
  double entropy = 0.0;
  for (const auto& [cell, count] : visits) {
    const double fraction = static_cast<double>(count) / total;
    entropy -= fraction * std::log(fraction);
  }
  return entropy / std::log(80.0);
}

/// `placed`: where the needle is put before a step, if it is.
template <class Act, class Placed>
double explore(int steps, Act act, Placed placed) {
  std::map<int, int> visits;
  geometry::Pose2 pose;
  for (int step = 0; step < steps; ++step) {
    pose = placed(step).value_or(pose);
    ++visits[static_cast<int>((pose.x_m + 0.0425) / 0.0085) * 100 +
             static_cast<int>((pose.y_m + 0.0425) / 0.0085)];
    pose = toy_step(pose, act(pose));
  }
  return evenness(visits, steps);
}

task::Observation observed_at(const geometry::Pose2& pose) {
  task::Observation observation;
  observation.pose = pose;
  return observation;
}

/// An operator places the needle for every episode, as the paper has it.
control::ExplorerConfig with_operator() {
  control::ExplorerConfig config;
  config.self_reset = false;
  config.steering = 1.0;
  config.weak_fraction = 0.0;
  return config;
}

control::Explorer make_explorer(const control::ExplorerConfig& config, std::uint64_t seed = 1) {
  return {config, tests::paper_rig(), common::RandomStream(seed, "explorer")};
}

/// Evenness of 4,000 steps in episodes of 25, and how often the needle was placed.
std::pair<double, int> guided(const control::ExplorerConfig& config) {
  control::Explorer explorer = make_explorer(config);
  int placements = 0;
  const double even = explore(
      4000, [&](const geometry::Pose2& pose) { return explorer.act(observed_at(pose)); },
      [&](int step) -> std::optional<geometry::Pose2> {
        const bool due = explorer.needs_operator() || (!config.self_reset && step % 25 == 0);
        if (step % 25 == 0 || due) explorer.reset();
        if (!due) return std::nullopt;
        ++placements;
        explorer.placed();
        return explorer.next_start(in_dish);
      });
  return {even, placements};
}

}  // namespace

TEST_CASE("guided exploration covers the dish more evenly than random actions") {
  common::RandomStream random(2, "random");
  const double blind = explore(
      4000,
      [&](const geometry::Pose2&) { return Vector2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)); },
      [&](int step) -> std::optional<geometry::Pose2> {
        if (step % 25 != 0) return std::nullopt;
        geometry::Pose2 pose{1.0, 1.0, 0.0};
        while (!in_dish(pose)) pose = {random.uniform(-0.037, 0.037), random.uniform(-0.037, 0.037), 0.0};
        return pose;
      });
  const auto [placed, placements] = guided(with_operator());
  CAPTURE(blind, placed, placements);
  CHECK(placed > blind + 0.03);
  CHECK(placements >= 160);
  CHECK(guided({}).second == 0);
}

TEST_CASE("the explorer mixes levels, single axes and some zero rows") {
  control::Explorer explorer = make_explorer(with_operator());
  tests::check_controller(explorer);
  int zero = 0;
  int single = 0;
  int high = 0;
  int low = 0;
  constexpr int kSteps = 3000;
  common::RandomStream random(5, "poses");
  for (int i = 0; i < kSteps; ++i) {
    const Vector2 action = explorer.act(
        observed_at({random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), random.uniform(-3.1, 3.1)}));
    const bool x = action.x() != 0.0;
    const bool y = action.y() != 0.0;
    zero += !x && !y;
    single += x != y;
    high += std::abs(action.x()) > 0.8;
    low += x && std::abs(action.x()) < 0.4;
  }
  CHECK(zero == Approx(0.02 * kSteps).margin(30));
  CHECK(single > kSteps / 10);
  CHECK(high > kSteps / 10);
  CHECK(low > kSteps / 10);
}

TEST_CASE("of coils that are driven one by one, each is tried alone and with others, as its driver can") {
  physics::RigDescription rig = tests::ring_rig(6);
  rig.drive.kind = physics::DriveKind::kIndependent;
  rig.coils.each[2].bipolar = true;
  control::ExplorerConfig config;
  config.self_reset = false;
  control::Explorer explorer(config, rig, common::RandomStream(1, "explorer"));
  common::RandomStream random(5, "poses");
  geometry::Drive most = geometry::Drive::Zero(6), least = geometry::Drive::Zero(6);
  int alone = 0, together = 0;
  for (int i = 0; i < 600; ++i) {
    const geometry::Drive action = explorer.act(
        observed_at({random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), random.uniform(-3.1, 3.1)}));
    REQUIRE(action.size() == 6);
    most = most.cwiseMax(action);
    least = least.cwiseMin(action);
    const auto on = (action.array() != 0.0).count();
    alone += on == 1 ? 1 : 0;
    together += on == 6 ? 1 : 0;
    CHECK((on == 0 || action[2] < 0.0 || action.maxCoeff() > 0.0));  // something happens
  }
  CHECK(most.minCoeff() > 0.8);
  CHECK(least.maxCoeff() < -0.8);  // which all but the third coil take for off
  CHECK(alone > 60);
  CHECK(together > 60);
  explorer.reset();
  control::Explorer other(config, rig, common::RandomStream(2, "explorer"));
  other.restore(explorer.save());
  CHECK(other.act(observed_at({})) == explorer.act(observed_at({})));
}

TEST_CASE("weak pulses are as many as asked for, over decades, and none is weaker than the weakest") {
  control::ExplorerConfig config;
  config.zero_fraction = 0.0;
  common::RandomStream random(5, "poses");
  const auto weaker_than = [&](double weak_fraction, double bound) {
    config.weak_fraction = weak_fraction;
    control::Explorer explorer = make_explorer(config);
    int count = 0;
    constexpr int kSteps = 2000;
    for (int i = 0; i < kSteps; ++i) {
      explorer.reset();  // nothing stalls
      const double drive = explorer
                               .act(observed_at({random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03),
                                                 random.uniform(-3.1, 3.1)}))
                               .cwiseAbs()
                               .maxCoeff();
      CHECK(drive >= (weak_fraction > 0.0 ? config.weakest_drive : config.min_drive) * (1.0 - 1e-12));
      count += drive < bound;
    }
    return static_cast<double>(count) / kSteps;
  };
  CHECK(weaker_than(0.0, 0.1) == 0.0);
  // Of log-uniform drives half lie below the geometric mean of their bounds. Levels are tried equally often,
  // whatever the other axis does, which shifts that somewhat.
  const double middle = std::sqrt(config.weakest_drive);
  const double of_all = weaker_than(1.0, middle);
  CHECK(of_all > 0.3);
  CHECK(of_all < 0.6);
  const double of_half = weaker_than(0.5, middle);
  CHECK(of_half > 0.15);
  CHECK(of_half < of_all);
}

TEST_CASE("the explorer calls the operator when the needle is stuck, and its state can be saved") {
  control::ExplorerConfig config = with_operator();
  config.stuck_steps = 3;
  config.crowding = 1e6;
  control::Explorer explorer = make_explorer(config);
  const task::Observation observation;
  for (int i = 0; i < 3; ++i) {
    explorer.act(observation);
    CHECK_FALSE(explorer.needs_operator());
  }
  explorer.act(observation);
  CHECK(explorer.needs_operator());
  explorer.reset();
  CHECK(explorer.needs_operator());  // an episode that ends does not move the needle
  explorer.placed();
  CHECK_FALSE(explorer.needs_operator());
  control::Explorer other = make_explorer(config, 9);
  other.restore(explorer.save());
  for (int i = 0; i < 20; ++i) CHECK(other.act(observation) == explorer.act(observation));
  config.heading_bins = 4;
  control::Explorer different = make_explorer(config, 9);
  CHECK_THROWS_AS(different.restore(explorer.save()), common::DataError);
}

TEST_CASE("a needle that does not move is freed over several episodes, as if never stopped, then placed") {
  control::ExplorerConfig config;
  config.crowding = 1e6;
  config.freeing.max_pulses = 12;
  control::Explorer explorer = make_explorer(config);
  const task::Observation observation = observed_at({0.03, 0.0, 0.0});
  const auto episode = [&observation](control::Explorer& one) {
    one.reset();
    std::vector<Vector2> actions;
    for (int i = 0; i < 5 && !one.needs_operator(); ++i) actions.push_back(one.act(observation));
    return actions;
  };
  int pulses = 0;
  while (!explorer.needs_operator()) {
    control::Explorer resumed = make_explorer(config, 9);
    resumed.restore(common::Json::parse(explorer.save().dump()));
    const std::vector<Vector2> actions = episode(explorer);
    REQUIRE(actions == episode(resumed));
    CHECK(explorer.needs_operator() == resumed.needs_operator());
    pulses += static_cast<int>(actions.size());
    REQUIRE(pulses < 200);
  }
  CHECK(pulses >= 12 + config.stuck_steps);
  explorer.placed();
  CHECK_FALSE(explorer.needs_operator());
}

TEST_CASE("a needle that a weak pulse does not move is not stuck") {
  control::ExplorerConfig config;
  config.weak_fraction = 1.0;
  config.crowding = 1e6;
  config.min_drive = 1.0;  // all are too weak to tell
  config.freeing.max_pulses = 1;
  control::Explorer explorer = make_explorer(config);
  const task::Observation observation;
  for (int i = 0; i < 100; ++i) explorer.act(observation);
  CHECK_FALSE(explorer.needs_operator());
}

TEST_CASE("the places of a sphere are counted without headings") {
  const auto counted = [](const physics::RigDescription& rig) {
    control::Explorer explorer({}, rig, common::RandomStream(1, "explorer"));
    return explorer.save()["at_pose"].size();
  };
  CHECK(counted(tests::paper_rig()) == 8 * counted(tests::sphere_rig()));
}

TEST_CASE("bounds of what the explorer is told are kept") {
  const auto refused = [](const char* key, double value) {
    common::Json json = {{key, value}};
    CHECK_THROWS_WITH(common::config_from_json<control::ExplorerConfig>(json, "test"), Catch::Contains(key));
  };
  refused("weak_fraction", 1.1);
  refused("weakest_drive", 0.0);
  refused("steering", -1.0);
  const common::Json none = {{"freeing", {{"max_pulses", 0}}}};
  CHECK_THROWS_WITH(common::config_from_json<control::ExplorerConfig>(none, "test"),
                    Catch::Contains("freeing.max_pulses"));
}
