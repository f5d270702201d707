#include "lodestone/rl/hindsight.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

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

/// What an environment says beside where the needle comes to.
struct Told {
  bool terminated = false;  ///< at the last step, which is cut otherwise
  bool success = false;     ///< at every step
  double penalty = 0.0;
  double progress = 1.0;
};

/// Steps `first` to `last` of an episode of four steps of 4 mm to the right.
void play(rl::Hindsight& hindsight, rl::ReplayBuffer& buffer, const Told& told, int first = 0, int last = 3) {
  for (int t = first; t <= last; ++t) {
    env::StepResult result;
    result.final_observation = row(0.004 * (t + 1));
    result.reward = {0.0F};
    result.terminated = {static_cast<std::uint8_t>(t == 3 && told.terminated)};
    result.truncated = {static_cast<std::uint8_t>(t == 3 && !told.terminated)};
    result.success = {static_cast<std::uint8_t>(told.success)};
    result.penalty = {told.penalty};
    result.progress = {told.progress};
    hindsight.add(row(0.004 * t), {0.5F, 0.0F}, result, buffer);
  }
}

/// One step told again.
struct Relabelled {
  double was_m, is_m;  ///< distances to the target
  double target_x_m;
  double reward;
  bool terminated;
};

/// All that was told again of an episode, every step of it.
std::vector<Relabelled> told_again(const task::TaskConfig& task, const Told& told,
                                   std::shared_ptr<const task::Region> region = nullptr) {
  rl::Hindsight hindsight(1.0, task, encoder(), 1, 7, std::move(region));
  rl::ReplayBuffer buffer(100, 6, 2);
  play(hindsight, buffer, told);
  const at::Tensor rows = buffer.save().at("rows");
  const task::ObservationEncoder read(encoder());
  std::vector<Relabelled> steps;
  for (std::int64_t i = 0; i < rows.size(0); ++i) {
    const float* before = rows.data_ptr<float>() + i * rows.size(1);
    const float* after = before + 8;
    const double target_x_m = tests::paper_encoder().length_scale_m * before[2];
    steps.push_back({read.target_distance_m(before), read.target_distance_m(after), target_x_m, after[6],
                     after[7] != 0.0F});
  }
  return steps;
}

/// Of a step of 4 mm straight to the target.
double reward_of(bool reached) { return 10.0 * 0.004 / 0.0425 + (reached ? 10.0 : 0.0) - 0.04; }

}  // namespace

TEST_CASE("Steps are told again with a target that was reached later, and judged by the task's rules",
          "[rl]") {
  const task::TaskConfig task = tests::paper_task();
  const std::vector<Relabelled> steps = told_again(task, {});
  REQUIRE(steps.size() == 4);
  for (const Relabelled& step : steps) {
    // The new target lies ahead, on a place the needle came to.
    CHECK(step.was_m - step.is_m == Approx(0.004).margin(1e-6));
    CHECK(std::fmod(1e3 * step.is_m + 1e-3, 4.0) < 0.01);
    const bool reached = step.is_m < task.success_radius_m;
    CHECK(step.terminated == reached);
    CHECK(step.reward == Approx(reward_of(reached)).epsilon(1e-3));
  }
  CHECK(steps.back().terminated);  // the last step can only have its own end as target
}

TEST_CASE("A step told again costs what the environment took from the reward", "[rl]") {
  Told told;
  told.penalty = 0.75;
  for (const Relabelled& step : told_again(tests::paper_task(), told))
    CHECK(step.reward == Approx(reward_of(step.terminated) - 0.75).epsilon(1e-3));
}

TEST_CASE("A step told again is judged with the success radius of its time", "[rl]") {
  task::TaskConfig task = tests::paper_task();
  task.success_radius_m = 0.011;
  task.final_success_radius_m = 0.001;
  task.end_on_success = false;
  Told told;
  told.progress = 0.5;  // 6 mm: one step before the target counts, two do not
  int before_it = 0;
  for (const Relabelled& step : told_again(task, told)) {
    CHECK(step.reward == Approx(reward_of(step.is_m < 0.006)).epsilon(1e-3));
    before_it += step.is_m > 0.003 && step.is_m < 0.006 ? 1 : 0;
  }
  CHECK(before_it > 0);
}

TEST_CASE("Targets of steps told again lie where the task may set one", "[rl]") {
  task::TaskConfig task = tests::paper_task();
  task.goal_radius = 0.0085 / 0.0425;  // the needle passes 4 and 8 mm, then leaves
  const std::vector<Relabelled> near = told_again(task, {});
  CHECK(near.size() == 2);
  for (const Relabelled& step : near) CHECK(step.target_x_m < 0.0085);
  std::vector<task::Move> moves;  // to and fro between the cells of the first two steps
  for (int i = 0; i < 20; ++i) {
    const double x_m = i % 2 == 0 ? 0.004 : 0.008;
    moves.push_back({{x_m, 0.001}, {0.012 - x_m, 0.001}});
  }
  task::RegionConfig cells;
  cells.cell_m = 0.005;
  const std::vector<Relabelled> reachable =
      told_again(tests::paper_task(), {}, std::make_shared<const task::Region>(moves, cells));
  CHECK(reachable.size() == 2);
  for (const Relabelled& step : reachable) CHECK(step.target_x_m < 0.01);
}

TEST_CASE("An end that was not the target's doing stays one", "[rl]") {
  task::TaskConfig task = tests::paper_task();
  task.end_on_success = false;  // no target ends an episode, reached or not
  CHECK_FALSE(told_again(task, {}).back().terminated);
  Told told;
  told.terminated = true;
  CHECK(told_again(task, told).back().terminated);
  told.success = true;
  CHECK(told_again(task, told).back().terminated);
}

TEST_CASE("Half an episode survives saving, and no fraction means no rows", "[rl]") {
  rl::Hindsight one(0.5, tests::paper_task(), encoder(), 1, 7);
  rl::Hindsight two(0.5, tests::paper_task(), encoder(), 1, 8);
  rl::ReplayBuffer for_one(100, 6, 2);
  rl::ReplayBuffer for_two(100, 6, 2);
  Told told;
  told.penalty = 0.1;  // no float
  told.progress = 1.0 / 3.0;
  for (int i = 0; i < 3; ++i) play(one, for_one, told);
  play(one, for_one, told, 0, 1);
  two.load(common::Json::parse(one.save().dump()));
  for_two.load(for_one.save());
  play(one, for_one, told, 2, 3);
  play(two, for_two, told, 2, 3);
  for (int i = 0; i < 3; ++i) {
    play(one, for_one, told);
    play(two, for_two, told);
  }
  CHECK(at::equal(for_one.save().at("rows"), for_two.save().at("rows")));
  CHECK(for_one.size() < 28);
  CHECK_THROWS_AS(two.load(common::Json::object()), common::CheckpointError);
  task::TaskConfig centre = tests::paper_task();
  centre.goal = task::GoalKind::kCentre;
  CHECK_THROWS_AS(rl::Hindsight(0.5, centre, encoder(), 1, 7), common::ConfigError);
}
