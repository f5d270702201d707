#include "lodestone/control/goal_seeker.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <utility>

#include "control/fakes.h"
#include "paper_rig.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

/// Notes the targets it is given and asks for nothing.
control::GoalSeeker seeker(std::vector<Vector2>& targets, const control::GoalSeekerConfig& config) {
  return control::GoalSeeker(
      std::make_unique<tests::FunctionController>([&targets](const task::Observation& seen) {
        targets.push_back(seen.target_m);
        return Vector2(0.0, 0.0);
      }),
      config, tests::paper_rig().dish.radius_m, common::RandomStream(1, "seek"));
}

}  // namespace

TEST_CASE("a target is kept until it is reached or its pulses are used up") {
  control::GoalSeekerConfig config;
  config.max_pulses_per_target = 5;
  config.noise = 0.0;
  std::vector<Vector2> targets;
  control::GoalSeeker seek = seeker(targets, config);
  seek.reset();
  task::Observation observation;
  observation.pose.x_m = 0.040;  // outside every target's disc
  for (int i = 0; i < 10; ++i) CHECK(seek.act(observation).isZero(0.0));
  CHECK(targets[0] == targets[4]);
  CHECK(targets[4] != targets[5]);
  CHECK(targets[5] == targets[9]);
  CHECK(targets[0].norm() <= config.goal_radius * tests::paper_rig().dish.radius_m);
  observation.pose = {targets[9].x() + 0.001, targets[9].y(), 0.0};
  seek.act(observation);
  CHECK(targets[10] != targets[9]);
}

TEST_CASE("a policy that does not get the needle to move is stuck until the needle has been placed") {
  control::GoalSeekerConfig config;
  config.stuck_pulses = 3;
  std::vector<Vector2> targets;
  control::GoalSeeker seek = seeker(targets, config);
  seek.reset();
  task::Observation observation;
  for (int i = 0; i < 5; ++i) seek.act(observation);  // no pulse, no motion
  CHECK_FALSE(seek.stuck());
  observation.last_action = {0.5, 0.0};
  seek.act(observation);
  seek.act(observation);
  control::GoalSeeker resumed = seeker(targets, config);
  resumed.restore(seek.save());
  for (control::GoalSeeker* each : {&seek, &resumed}) {
    each->reset();  // an episode that ends does not free the needle
    CHECK_FALSE(each->stuck());
    each->act(observation);
    CHECK(each->stuck());
    each->reset();
    CHECK_FALSE(each->stuck());
  }
  seek.act(observation);
  seek.act(observation);
  observation.last_displacement_m = {0.0, 0.001};
  seek.act(observation);
  observation.last_displacement_m.setZero();
  seek.act(observation);
  CHECK_FALSE(seek.stuck());
  CHECK_THROWS_AS(resumed.restore("{}"), common::DataError);
}

TEST_CASE("noise is added, clipped, and goes on after a restore") {
  control::GoalSeekerConfig config;
  config.noise = 0.7;
  std::vector<Vector2> targets;
  control::GoalSeeker one = seeker(targets, config);
  one.reset();
  task::Observation observation;
  observation.pose.x_m = 0.040;
  std::set<double> seen;
  for (int i = 0; i < 50; ++i) {
    const Vector2 action = one.act(observation);
    CHECK(action.cwiseAbs().maxCoeff() <= 1.0);
    seen.insert(action.x());
  }
  CHECK(seen.size() > 20);
  control::GoalSeeker two = seeker(targets, config);
  two.restore(one.save());
  one.reset();
  two.reset();
  CHECK(one.act(observation) == two.act(observation));
}

TEST_CASE("weak pulses are as many as asked for, over decades and all around, and stick no needle") {
  control::GoalSeekerConfig config;
  config.noise = 0.0;
  config.stuck_pulses = 1;
  config.weak_fraction = 0.5;
  std::vector<Vector2> targets;
  control::GoalSeeker seek = seeker(targets, config);
  seek.reset();
  task::Observation observation;
  observation.pose.x_m = 0.040;
  constexpr int kPulses = 4000;
  int weak = 0;
  int weaker = 0;
  std::set<std::pair<bool, bool>> quadrants;
  for (int i = 0; i < kPulses; ++i) {
    const geometry::Drive action = seek.act(observation);
    observation.last_action = action;  // which moves nothing
    if (action.isZero(0.0)) continue;  // what the controller asks for
    const double largest = action.cwiseAbs().maxCoeff();
    CHECK(largest >= config.weakest_drive * (1.0 - 1e-12));
    CHECK(largest <= 1.0 + 1e-12);
    ++weak;
    weaker += largest < std::sqrt(config.weakest_drive);
    quadrants.insert({action[0] > 0.0, action[1] > 0.0});
  }
  CHECK_FALSE(seek.stuck());
  CHECK(targets.size() == static_cast<std::size_t>(kPulses));
  // Four standard errors.
  CHECK(std::abs(weak - 0.5 * kPulses) < 4.0 * std::sqrt(0.25 * kPulses));
  CHECK(std::abs(weaker - 0.5 * weak) < 4.0 * std::sqrt(0.25 * weak));
  CHECK(quadrants.size() == 4);
}
