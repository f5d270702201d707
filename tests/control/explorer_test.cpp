#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "control/controller_conformance.h"
#include "control/fakes.h"
#include "lodestone/control/explorer.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

constexpr double kDish_m = 0.0425;

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

template <class Act, class Stuck, class Start>
double explore(int steps, Act act, Stuck stuck, Start start) {
  std::map<int, int> visits;
  geometry::Pose2 pose = start();
  for (int step = 0; step < steps; ++step) {
    if (step % 25 == 0 || stuck()) pose = start();
    ++visits[static_cast<int>((pose.x_m + 0.0425) / 0.0085) * 100 +
             static_cast<int>((pose.y_m + 0.0425) / 0.0085)];
    pose = toy_step(pose, act(pose));
  }
  return evenness(visits, steps);
}

}  // namespace

TEST_CASE("guided exploration covers the dish more evenly than random actions") {
  control::Explorer explorer({}, kDish_m, common::RandomStream(1, "explorer"));
  common::RandomStream random(2, "random");
  const auto start = [&] {
    explorer.reset();
    return explorer.next_start(in_dish);
  };
  const auto act = [&](const geometry::Pose2& pose) {
    task::Observation observation;
    observation.pose = pose;
    return explorer.act(observation);
  };
  const double guided = explore(
      4000, act, [&] { return explorer.stuck(); }, start);
  const auto random_start = [&] {
    geometry::Pose2 pose{1.0, 1.0, 0.0};
    while (!in_dish(pose)) pose = {random.uniform(-0.037, 0.037), random.uniform(-0.037, 0.037), 0.0};
    return pose;
  };
  const double blind = explore(
      4000,
      [&](const geometry::Pose2&) { return Vector2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)); },
      [] { return false; }, random_start);
  CAPTURE(guided, blind);
  CHECK(guided > blind + 0.03);
}

TEST_CASE("the explorer mixes levels, single axes and some zero rows") {
  control::Explorer explorer({}, kDish_m, common::RandomStream(1, "explorer"));
  tests::check_controller(explorer);
  int zero = 0;
  int single = 0;
  int high = 0;
  int low = 0;
  constexpr int kSteps = 3000;
  common::RandomStream random(5, "poses");
  for (int i = 0; i < kSteps; ++i) {
    task::Observation observation;
    observation.pose = {random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), random.uniform(-3.1, 3.1)};
    const Vector2 action = explorer.act(observation);
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

TEST_CASE("the explorer calls the operator when the needle is stuck, and its state can be saved") {
  control::ExplorerConfig config;
  config.stuck_steps = 3;
  config.crowding = 1e6;
  control::Explorer explorer(config, kDish_m, common::RandomStream(1, "explorer"));
  task::Observation observation;
  for (int i = 0; i < 3; ++i) {
    explorer.act(observation);
    CHECK_FALSE(explorer.stuck());
  }
  explorer.act(observation);
  CHECK(explorer.stuck());
  explorer.reset();
  CHECK_FALSE(explorer.stuck());
  control::Explorer other(config, kDish_m, common::RandomStream(9, "explorer"));
  other.restore(explorer.save());
  for (int i = 0; i < 20; ++i) CHECK(other.act(observation) == explorer.act(observation));
  config.heading_bins = 4;
  control::Explorer different(config, kDish_m, common::RandomStream(9, "explorer"));
  CHECK_THROWS_AS(different.restore(explorer.save()), common::DataError);
}
