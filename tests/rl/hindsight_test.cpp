#include "lodestone/rl/hindsight.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>

#include "lodestone/common/error.h"
#include "paper_rig.h"

using namespace lodestone;

namespace {

task::EncoderConfig encoder() {
  task::EncoderConfig config = tests::paper_encoder();
  config.heading = task::HeadingEncoding::kNone;
  config.relative_target = true;
  return config;
}

/// Row of a needle at `x_m` on the x axis whose target lies at (0, 30 mm).
std::vector<float> row(double x_m) {
  task::Observation seen;
  seen.pose.x_m = x_m;
  seen.target_m = {0.0, 0.03};
  std::vector<float> out(6);
  task::ObservationEncoder(encoder()).encode(seen, out.data());
  return out;
}

/// An episode of four steps of 4 mm to the right; `left_dish` says how it ends.
void play(rl::Hindsight& hindsight, rl::ReplayBuffer& buffer, bool left_dish) {
  for (int t = 0; t < 4; ++t) {
    env::StepResult result;
    result.final_observation = row(0.004 * (t + 1));
    result.reward = {0.0F};
    result.terminated = {static_cast<std::uint8_t>(t == 3 && left_dish)};
    result.truncated = {static_cast<std::uint8_t>(t == 3 && !left_dish)};
    result.success = {0};
    hindsight.add(row(0.004 * t), {0.5F, 0.0F}, result, buffer);
  }
}

}  // namespace

TEST_CASE("Steps are told again with a target that was reached later, and judged by the task's rules",
          "[rl]") {
  const task::TaskConfig task = tests::paper_task();
  rl::Hindsight hindsight(1.0, task, encoder(), 1, 7);
  rl::ReplayBuffer buffer(100, 6, 2);
  play(hindsight, buffer, false);
  REQUIRE(buffer.size() == 4);
  const at::Tensor rows = buffer.save().at("rows");
  const task::ObservationEncoder read(encoder());
  bool some_reached = false;
  for (std::int64_t i = 0; i < 4; ++i) {
    const float* before = rows.data_ptr<float>() + i * rows.size(1);
    const float* after = before + 8;
    const float reward = before[14];
    const bool terminated = before[15] != 0.0F;
    const double was_m = read.target_distance_m(before);
    const double is_m = read.target_distance_m(after);
    // The new target lies ahead, on a place the needle came to.
    CHECK(was_m - is_m == Approx(0.004).margin(1e-6));
    CHECK(std::fmod(1e3 * is_m + 1e-3, 4.0) < 0.01);
    const bool reached = is_m < task.success_radius_m;
    CHECK(terminated == reached);
    CHECK(reward == Approx(10.0 * 0.004 / 0.0425 + (reached ? 10.0 : 0.0) - 0.04).epsilon(1e-3));
    some_reached = some_reached || reached;
  }
  CHECK(some_reached);  // the last step can only have its own end as target
}

TEST_CASE("An end that was not the target's doing stays one", "[rl]") {
  rl::Hindsight hindsight(1.0, {}, encoder(), 1, 7);
  rl::ReplayBuffer buffer(100, 6, 2);
  play(hindsight, buffer, true);
  CHECK(buffer.save().at("rows")[3][15].item<float>() == 1.0F);
}

TEST_CASE("Half an episode survives saving, and no fraction means no rows", "[rl]") {
  rl::Hindsight one(0.5, tests::paper_task(), encoder(), 1, 7);
  rl::Hindsight two(0.5, tests::paper_task(), encoder(), 1, 8);
  rl::ReplayBuffer for_one(100, 6, 2);
  rl::ReplayBuffer for_two(100, 6, 2);
  for (int i = 0; i < 3; ++i) play(one, for_one, false);
  two.load(one.save());
  for_two.load(for_one.save());
  for (int i = 0; i < 3; ++i) {
    play(one, for_one, false);
    play(two, for_two, false);
  }
  CHECK(at::equal(for_one.save().at("rows"), for_two.save().at("rows")));
  CHECK(for_one.size() < 24);
  CHECK_THROWS_AS(two.load(common::Json::object()), common::CheckpointError);
  task::TaskConfig centre = tests::paper_task();
  centre.goal = task::GoalKind::kCentre;
  CHECK_THROWS_AS(rl::Hindsight(0.5, centre, encoder(), 1, 7), common::ConfigError);
}
