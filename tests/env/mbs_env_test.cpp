#include "lodestone/env/mbs_env.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "env/linear_model.h"
#include "env/sample_settings.h"
#include "env/vec_env_conformance.h"
#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::env {
namespace {

using tests::linear_model;

constexpr double kGain_m = 1e-3;

EpisodeSettings settings_for(std::int64_t count) {
  EpisodeSettings settings = tests::plain_settings(count);
  settings.action.scale = 10.0;
  return settings;
}

/// Position of environment i in metres.
geometry::Vector2 position_m(const std::vector<float>& rows, std::size_t columns, std::size_t i) {
  return {0.0425 * rows[i * columns], 0.0425 * rows[i * columns + 1]};
}

/// Column `column` of the difference of two sets of rows.
std::vector<double> change(const std::vector<float>& after, const std::vector<float>& before,
                           std::size_t columns, std::size_t column) {
  std::vector<double> values;
  for (std::size_t i = column; i < after.size(); i += columns)
    values.push_back(static_cast<double>(after[i]) - before[i]);
  return values;
}

TEST_CASE("the learned simulator keeps the promises of a VecEnv", "[unit]") {
  for (const auto ensemble : {EnsembleUse::kMean, EnsembleUse::kPerEpisode, EnsembleUse::kPerStep}) {
    for (const auto layout : {data::StateLayout::kPosition, data::StateLayout::kPose}) {
      CAPTURE(common::name_of(ensemble));
      MbsConfig config;
      config.ensemble = ensemble;
      config.breakaway_scatter = 0.2;
      config.stall_probability = 0.1;
      const inference::DynamicsModel model = linear_model(layout, {kGain_m, 0.5 * kGain_m}, {0.1, -0.1});
      EpisodeSettings settings = settings_for(60);
      settings.task.max_steps = 8;
      settings.task.success_radius_m = 0.008;
      tests::check_vec_env(
          {[&](std::int64_t threads) { return std::make_unique<MbsEnv>(model, settings, config, threads); },
           8, 0.008, 0.0425, 0.0425});
    }
  }
}

TEST_CASE("results do not depend on threads when there are many shards", "[unit]") {
  MbsConfig config;
  config.ensemble = EnsembleUse::kPerEpisode;
  config.pose_noise_m = 1e-4;
  const inference::DynamicsModel model =
      linear_model(data::StateLayout::kPose, {kGain_m, 0.7 * kGain_m, 0.4 * kGain_m}, {0.1, 0.0, -0.1});
  const EpisodeSettings settings = settings_for(3000);
  MbsEnv one(model, settings, config, 1);
  MbsEnv four(model, settings, config, 4);
  for (std::uint64_t step = 0; step < 5; ++step) {
    const std::vector<float> actions = tests::random_actions(one.spec(), step);
    CHECK(tests::same(one.step(actions), four.step(actions)));
  }
}

TEST_CASE("each way of using the ensemble moves as its members say", "[unit]") {
  const inference::DynamicsModel model =
      linear_model(data::StateLayout::kPosition, {kGain_m, 0.5 * kGain_m}, {0, 0});
  EpisodeSettings settings = settings_for(64);
  settings.task.end_on_success = false;
  settings.task.end_on_dish_exit = false;
  const std::vector<float> actions(128, 0.2F);  // 2 units of drive
  const auto steps_mm = [&](EnsembleUse ensemble) {
    MbsConfig config;
    config.ensemble = ensemble;
    MbsEnv environments(model, settings, config, 1);
    std::vector<std::vector<double>> moves(64);
    std::vector<float> before = environments.reset();
    for (int step = 0; step < 6; ++step) {
      const std::vector<float> after = environments.step(actions).observation;
      for (std::size_t i = 0; i < 64; ++i) {
        moves[i].push_back(std::round(1e5 * (position_m(after, 4, i) - position_m(before, 4, i)).x()) /
                           100.0);
      }
      before = after;
    }
    return moves;
  };
  for (const auto& moves : steps_mm(EnsembleUse::kMean)) CHECK(moves == std::vector<double>(6, 1.5));
  std::set<double> drawn;
  for (const auto& moves : steps_mm(EnsembleUse::kPerEpisode)) {
    CHECK(moves == std::vector<double>(6, moves.front()));
    drawn.insert(moves.front());
  }
  CHECK(drawn == std::set<double>{1.0, 2.0});
  std::int64_t changing = 0;
  for (const auto& moves : steps_mm(EnsembleUse::kPerStep)) {
    changing += std::set<double>(moves.begin(), moves.end()) == std::set<double>{1.0, 2.0} ? 1 : 0;
  }
  CHECK(changing > 50);
}

TEST_CASE("headings are averaged across the cut of the circle", "[unit]") {
  const inference::DynamicsModel model =
      linear_model(data::StateLayout::kPose, {kGain_m, kGain_m}, {2.9, 3.3});
  EpisodeSettings settings = settings_for(32);
  settings.encoder.heading = task::HeadingEncoding::kAngle;
  settings.task.end_on_success = false;
  MbsEnv environments(model, settings, {}, 1);
  const std::vector<float> before = environments.reset();
  const std::vector<float> after = environments.step(std::vector<float>(64, 0.01F)).final_observation;
  for (std::size_t i = 0; i < 32; ++i) {
    // Turns of 2.9 and of 3.3 (which is -2.98): their mean as wrapped turns.
    const double expected = before[5 * i + 2] + 0.5 * (2.9 + 3.3 - 2.0 * geometry::kPi);
    CHECK(std::abs(geometry::wrap_angle(after[5 * i + 2] - expected)) < 1e-5);
  }
}

TEST_CASE("the rules of the paper are options", "[unit]") {
  const inference::DynamicsModel model = linear_model(data::StateLayout::kPose, {kGain_m}, {0.25});
  EpisodeSettings settings = settings_for(40);
  settings.encoder.heading = task::HeadingEncoding::kAngle;
  settings.task.end_on_success = false;

  SECTION("zero current moves nothing") {
    MbsEnv environments(model, settings, {}, 1);
    const std::vector<float> before = environments.reset();
    CHECK(environments.step(std::vector<float>(80)).final_observation == before);
  }
  SECTION("or whatever the network says") {
    settings.task.zero_current_moves_nothing = false;
    MbsEnv environments(model, settings, {}, 1);
    const std::vector<float> before = environments.reset();
    const std::vector<float> after = environments.step(std::vector<float>(80)).final_observation;
    for (const double turn_rad : change(after, before, 5, 2)) CHECK(turn_rad != 0.0);
  }
  SECTION("the dish's edge ends the episode") {
    settings.task.max_steps = 1000;
    const auto terminations = [&] {
      MbsEnv environments(model, settings, {}, 1);
      environments.reset();
      std::int64_t ends = 0;
      for (int step = 0; step < 10; ++step) {
        const StepResult& result = environments.step(std::vector<float>(80, 1.0F));
        ends += std::count(result.terminated.begin(), result.terminated.end(), 1);
      }
      return ends;
    };
    CHECK(terminations() > 40);
    settings.task.end_on_dish_exit = false;
    CHECK(terminations() == 0);
  }
  SECTION("starts come from the training data within the start radius") {
    settings.task.start_radius = 0.01 / 0.0425;
    MbsEnv environments(model, settings, {}, 1);
    const std::vector<float> observation = environments.reset();
    for (std::size_t i = 0; i < 40; ++i) CHECK(position_m(observation, 5, i).norm() <= 0.01 + 1e-9);
    settings.task.start_radius = 0.0;
    inference::DynamicsModel shifted = model;
    for (double& number : shifted.start_states) number += 0.1;
    CHECK_THROWS_WITH(MbsEnv(shifted, settings, {}, 1),
                      Catch::Contains("holds no state of the training data"));
  }
}

TEST_CASE("disturbances do what they are called", "[unit]") {
  const inference::DynamicsModel model = linear_model(data::StateLayout::kPosition, {kGain_m}, {0});
  EpisodeSettings settings = settings_for(400);
  settings.task.end_on_success = false;
  settings.task.end_on_dish_exit = false;
  const auto first_moves_mm = [&](const MbsConfig& config) {
    MbsEnv environments(model, settings, config, 1);
    const std::vector<float> before = environments.reset();
    std::vector<double> moves_mm =
        change(environments.step(std::vector<float>(800, 0.3F)).final_observation, before, 4, 0);
    for (double& move : moves_mm) move *= 42.5;
    return moves_mm;
  };
  MbsConfig stalling;
  stalling.stall_probability = 0.25;
  const std::vector<double> stalls = first_moves_mm(stalling);
  const auto stalled =
      std::count_if(stalls.begin(), stalls.end(), [](double x) { return std::abs(x) < 1e-6; });
  CHECK(static_cast<double>(stalled) / 400.0 == Approx(0.25).margin(0.08));

  MbsConfig scattered;
  scattered.breakaway_scatter = 0.3;
  std::vector<double> factors = first_moves_mm(scattered);
  for (double& factor : factors) factor = std::log(factor / 3.0);
  // None is stronger than what the simulator knows: half of a normal distribution, the other half at zero.
  CHECK(*std::max_element(factors.begin(), factors.end()) < 1e-4);
  CHECK(common::mean(factors) == Approx(-0.3 / std::sqrt(2.0 * geometry::kPi)).margin(0.03));
  double square = 0.0;
  for (const double factor : factors) square += factor * factor / 400.0;
  CHECK(square == Approx(0.5 * 0.3 * 0.3).margin(0.012));

  // What a policy is told of the gain explains it, as far as it says: of stronger rigs, too.
  EpisodeSettings telling = settings_for(2000);
  telling.encoder.drive_gain = true;
  MbsEnv told(linear_model(data::StateLayout::kPose, {kGain_m}, {0.0}), telling, scattered, 1);
  const auto columns = static_cast<std::size_t>(told.spec().observation_size);
  const std::vector<float> at_first = told.reset();
  const std::vector<double> moves =
      change(told.step(std::vector<float>(4000, 0.3F)).final_observation, at_first, columns, 0);
  std::vector<double> surprise, gain;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const auto log_mean = static_cast<double>(at_first[i * columns + columns - 2]);
    const auto log_sigma = static_cast<double>(at_first[i * columns + columns - 1]);
    gain.push_back(std::log(42.5 * moves[i] / 3.0));
    surprise.push_back((gain.back() - log_mean) / log_sigma);
  }
  CHECK(common::standard_deviation(gain) == Approx(0.3).margin(0.03));
  CHECK(common::standard_deviation(surprise) == Approx(1.0).margin(0.1));

  MbsConfig noisy;
  noisy.pose_noise_m = 5e-4;
  CHECK(common::standard_deviation(first_moves_mm(noisy)) == Approx(0.5 * std::sqrt(2.0)).margin(0.1));
}

TEST_CASE("a heading that the model lacks cannot be encoded", "[unit]") {
  EpisodeSettings settings = settings_for(2);
  settings.encoder.heading = task::HeadingEncoding::kAngle;
  CHECK_THROWS_AS(MbsEnv(linear_model(data::StateLayout::kPosition, {kGain_m}, {0}), settings, {}, 1),
                  common::ConfigError);
}

}  // namespace
}  // namespace lodestone::env
namespace lodestone::env {
namespace {

/// Drives every environment fully to the right once; returns what happened.
StepResult push(MbsEnv& environments) {
  std::vector<float> actions(static_cast<std::size_t>(2 * environments.spec().count));
  for (std::size_t i = 0; i < actions.size(); i += 2) actions[i] = 1.0F;
  return environments.step(actions);
}

TEST_CASE("a predicted distribution is sampled, another draw in every environment", "[unit]") {
  inference::DynamicsModel model = linear_model(data::StateLayout::kPosition, {kGain_m}, {0});
  model.config.components = 2;
  {
    // weights equal; means of the change 0 and 4 mm; spreads of e^-5.5
    inference::Arrays weights = tests::without_normalisation(4, 2);
    weights["output_std"] = {std::vector<float>(2, 1e-3F), {2}};
    weights["layers.0.weight"] = {std::vector<float>(16), {4, 4}};
    weights["layers.0.bias"] = {std::vector<float>(4), {4}};
    weights["layers.2.weight"] = {std::vector<float>(40), {10, 4}};
    weights["layers.2.bias"] = {std::vector<float>{0, 0, 0, 0, 4, 0, -50, -50, -50, -50}, {10}};
    model.members.front() = {weights, model.config, data::StateLayout::kPosition, "mixture"};
  }
  EpisodeSettings settings = settings_for(600);
  settings.task.end_on_success = false;
  MbsConfig config;
  config.ensemble = EnsembleUse::kPerStep;
  config.outcome = Outcome::kSample;
  MbsEnv environments(model, settings, config, 2);
  const std::vector<float> before = environments.reset();
  std::int64_t far = 0;
  for (const double moved : change(push(environments).final_observation, before, 4, 0)) {
    const double moved_mm = 42.5 * moved;
    far += moved_mm > 2.0 ? 1 : 0;
    CHECK(std::min(std::abs(moved_mm - 4.0), std::abs(moved_mm)) < 0.05);
  }
  CHECK(static_cast<double>(far) / 600.0 == Approx(0.5).margin(0.07));

  config.outcome = Outcome::kMean;
  MbsEnv mean(model, settings, config, 2);
  const std::vector<float> start = mean.reset();
  for (const double moved : change(push(mean).final_observation, start, 4, 0))
    CHECK(42.5 * moved == Approx(2.0).margin(1e-3));

  config.outcome = Outcome::kSample;
  const inference::DynamicsModel single = linear_model(data::StateLayout::kPosition, {kGain_m}, {0});
  CHECK_THROWS_AS(MbsEnv(single, settings, config, 1), common::ConfigError);
}

TEST_CASE("disagreement of the members costs, and ends episodes where it is large", "[unit]") {
  // The members move 10 mm and 6 mm: 2 mm RMS from their mean.
  const inference::DynamicsModel model =
      linear_model(data::StateLayout::kPosition, {kGain_m, 0.6 * kGain_m}, {0, 0});
  EpisodeSettings settings = settings_for(50);
  settings.task.end_on_success = false;
  settings.task.end_on_dish_exit = false;
  MbsConfig config;
  MbsEnv plain(model, settings, config, 1);
  config.disagreement_penalty = 3.0;
  MbsEnv punished(model, settings, config, 1);
  config.disagreement_stop_m = 0.0019;
  MbsEnv stopped(model, settings, config, 1);
  const StepResult free = push(plain);
  const StepResult paid = push(punished);
  for (const double difference : change(free.reward, paid.reward, 1, 0))
    CHECK(difference == Approx(3.0 * 0.002 / 0.0425).margin(1e-5));
  for (const double penalty : paid.penalty) CHECK(penalty == Approx(3.0 * 0.002 / 0.0425).margin(1e-5));
  CHECK(free.penalty == std::vector<double>(50, 0.0));
  CHECK(paid.terminated == std::vector<std::uint8_t>(50, 0));
  CHECK(push(stopped).terminated == std::vector<std::uint8_t>(50, 1));
  const inference::DynamicsModel alone = linear_model(data::StateLayout::kPosition, {kGain_m}, {0});
  CHECK_THROWS_AS(MbsEnv(alone, settings, config, 1), common::ConfigError);
}

TEST_CASE("starts and goals keep to the region, and the radius shrinks with age", "[unit]") {
  const inference::DynamicsModel model = linear_model(data::StateLayout::kPosition, {kGain_m}, {0});
  EpisodeSettings settings = settings_for(200);
  std::vector<task::Move> moves;
  for (int i = 0; i < 2000; ++i) {
    const double x = 0.02 * ((i * 37) % 100) / 100.0;  // the right half only
    const double y = 0.02 * ((i * 61) % 100) / 100.0 - 0.01;
    moves.push_back({{0.02 - x, -y}, {x, y}});
  }
  settings.region = std::make_shared<const task::Region>(moves, task::RegionConfig());
  MbsEnv environments(model, settings, {}, 1);
  const std::vector<float> seen = environments.reset();
  for (std::size_t i = 0; i < 200; ++i) {
    CHECK(settings.region->contains(position_m(seen, 4, i)));
    CHECK(seen[4 * i + 2] >= 0.0F);
  }
  settings = settings_for(1);
  settings.task.success_radius_m = 1.0;  // everything counts at first, nothing in the end
  settings.task.final_success_radius_m = 1e-5;
  settings.task.end_on_success = false;
  settings.task.end_on_dish_exit = false;
  settings.shrink_steps = 20;
  MbsEnv shrinking(model, settings, {}, 1);
  CHECK(push(shrinking).success[0] != 0);
  CHECK(push(shrinking).progress[0] == Approx(0.1));
  for (int i = 0; i < 20; ++i) push(shrinking);
  CHECK(push(shrinking).success[0] == 0);
}

}  // namespace
}  // namespace lodestone::env
