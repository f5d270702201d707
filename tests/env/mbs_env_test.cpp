#include "lodestone/env/mbs_env.h"

#include <catch2/catch.hpp>
#include <set>

#include "env/linear_model.h"
#include "env/vec_env_conformance.h"
#include "lodestone/common/error.h"
#include "paper_rig.h"

namespace lodestone::env {
namespace {

using tests::linear_model;

constexpr double kGain_m = 1e-3;

EpisodeSettings settings_for(std::int64_t count) {
  EpisodeSettings settings;
  settings.task = tests::paper_task();
  settings.encoder = tests::paper_encoder();
  settings.action = tests::paper_action();
  settings.count = count;
  settings.encoder.heading = "none";
  settings.action.scale = 10.0;
  settings.seed = 4;
  return settings;
}

/// Position of environment i in metres.
geometry::Vector2 position_m(const torch::Tensor& observation, std::int64_t i) {
  return {0.0425 * observation[i][0].item<double>(), 0.0425 * observation[i][1].item<double>()};
}

TEST_CASE("the learned simulator keeps the promises of a VecEnv", "[unit]") {
  for (const char* ensemble : {"mean", "per_episode", "per_step"}) {
    for (const auto layout : {data::StateLayout::kPosition, data::StateLayout::kPose}) {
      CAPTURE(ensemble);
      MbsConfig config;
      config.ensemble = ensemble;
      config.breakaway_scatter = 0.2;
      config.stall_probability = 0.1;
      const nets::DynamicsModel model = linear_model(layout, {kGain_m, 0.5 * kGain_m}, {0.1, -0.1});
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
  config.ensemble = "per_episode";
  config.pose_noise_m = 1e-4;
  const nets::DynamicsModel model =
      linear_model(data::StateLayout::kPose, {kGain_m, 0.7 * kGain_m, 0.4 * kGain_m}, {0.1, 0.0, -0.1});
  const EpisodeSettings settings = settings_for(3000);
  MbsEnv one(model, settings, config, 1);
  MbsEnv four(model, settings, config, 4);
  for (std::uint64_t step = 0; step < 5; ++step) {
    const torch::Tensor actions = tests::random_actions(one.spec(), step);
    CHECK(tests::same(one.step(actions), four.step(actions)));
  }
}

TEST_CASE("each way of using the ensemble moves as its members say", "[unit]") {
  const nets::DynamicsModel model =
      linear_model(data::StateLayout::kPosition, {kGain_m, 0.5 * kGain_m}, {0, 0});
  EpisodeSettings settings = settings_for(64);
  settings.task.end_on_success = false;
  settings.task.end_on_dish_exit = false;
  const torch::Tensor actions = torch::full({64, 2}, 0.2F);  // 2 units of drive
  const auto steps_mm = [&](const std::string& ensemble) {
    MbsConfig config;
    config.ensemble = ensemble;
    MbsEnv environments(model, settings, config, 1);
    std::vector<std::vector<double>> moves(64);
    torch::Tensor before = environments.reset().clone();
    for (int step = 0; step < 6; ++step) {
      const torch::Tensor after = environments.step(actions).observation.clone();
      for (std::int64_t i = 0; i < 64; ++i) {
        moves[static_cast<std::size_t>(i)].push_back(
            std::round(1e5 * (position_m(after, i) - position_m(before, i)).x()) / 100.0);
      }
      before = after;
    }
    return moves;
  };
  for (const auto& moves : steps_mm("mean")) CHECK(moves == std::vector<double>(6, 1.5));
  std::set<double> drawn;
  for (const auto& moves : steps_mm("per_episode")) {
    CHECK(moves == std::vector<double>(6, moves.front()));
    drawn.insert(moves.front());
  }
  CHECK(drawn == std::set<double>{1.0, 2.0});
  std::int64_t changing = 0;
  for (const auto& moves : steps_mm("per_step")) {
    changing += std::set<double>(moves.begin(), moves.end()) == std::set<double>{1.0, 2.0} ? 1 : 0;
  }
  CHECK(changing > 50);
}

TEST_CASE("headings are averaged across the cut of the circle", "[unit]") {
  const nets::DynamicsModel model = linear_model(data::StateLayout::kPose, {kGain_m, kGain_m}, {2.9, 3.3});
  EpisodeSettings settings = settings_for(32);
  settings.encoder.heading = "angle";
  settings.task.end_on_success = false;
  MbsEnv environments(model, settings, {}, 1);
  const torch::Tensor before = environments.reset().clone();
  const torch::Tensor after = environments.step(torch::full({32, 2}, 0.01F)).final_observation;
  for (std::int64_t i = 0; i < 32; ++i) {
    // Turns of 2.9 and of 3.3 (which is -2.98): their mean as wrapped turns.
    const double expected = before[i][2].item<double>() + 0.5 * (2.9 + 3.3 - 2.0 * M_PI);
    CHECK(std::abs(geometry::wrap_angle(after[i][2].item<double>() - expected)) < 1e-5);
  }
}

TEST_CASE("the rules of the paper are options", "[unit]") {
  const nets::DynamicsModel model = linear_model(data::StateLayout::kPose, {kGain_m}, {0.25});
  EpisodeSettings settings = settings_for(40);
  settings.encoder.heading = "angle";
  settings.task.end_on_success = false;

  SECTION("zero current moves nothing") {
    MbsEnv environments(model, settings, {}, 1);
    const torch::Tensor before = environments.reset().clone();
    CHECK(torch::equal(environments.step(torch::zeros({40, 2})).final_observation, before));
  }
  SECTION("or whatever the network says") {
    settings.task.zero_current_moves_nothing = false;
    MbsEnv environments(model, settings, {}, 1);
    const torch::Tensor before = environments.reset().clone();
    const torch::Tensor after = environments.step(torch::zeros({40, 2})).final_observation;
    CHECK_FALSE(torch::equal(after.select(1, 2), before.select(1, 2)));
  }
  SECTION("the dish's edge ends the episode") {
    settings.task.max_steps = 1000;
    const auto terminations = [&] {
      MbsEnv environments(model, settings, {}, 1);
      environments.reset();
      std::int64_t ends = 0;
      for (int step = 0; step < 10; ++step) {
        ends += environments.step(torch::full({40, 2}, 1.0F)).terminated.sum().item<std::int64_t>();
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
    const torch::Tensor observation = environments.reset();
    for (std::int64_t i = 0; i < 40; ++i) CHECK(position_m(observation, i).norm() <= 0.01 + 1e-9);
    settings.task.start_radius = 0.0;
    nets::DynamicsModel shifted = model;
    shifted.start_states = model.start_states + 0.1;
    CHECK_THROWS_WITH(MbsEnv(shifted, settings, {}, 1),
                      Catch::Contains("holds no state of the training data"));
  }
}

TEST_CASE("disturbances do what they are called", "[unit]") {
  const nets::DynamicsModel model = linear_model(data::StateLayout::kPosition, {kGain_m}, {0});
  EpisodeSettings settings = settings_for(400);
  settings.task.end_on_success = false;
  settings.task.end_on_dish_exit = false;
  const auto first_moves_mm = [&](const MbsConfig& config) {
    MbsEnv environments(model, settings, config, 1);
    const torch::Tensor before = environments.reset().clone();
    const torch::Tensor after = environments.step(torch::full({400, 2}, 0.3F)).final_observation;
    return ((after - before).select(1, 0) * 42.5).clone();
  };
  MbsConfig stalling;
  stalling.stall_probability = 0.25;
  const double stalled = (first_moves_mm(stalling).abs() < 1e-6).sum().item<double>() / 400.0;
  CHECK(stalled == Approx(0.25).margin(0.08));

  MbsConfig scattered;
  scattered.breakaway_scatter = 0.3;
  const torch::Tensor factors = torch::log(first_moves_mm(scattered) / 3.0);
  CHECK(factors.mean().item<double>() == Approx(0.0).margin(0.05));
  CHECK(factors.std().item<double>() == Approx(0.3).margin(0.05));

  MbsConfig noisy;
  noisy.pose_noise_m = 5e-4;
  CHECK(first_moves_mm(noisy).std().item<double>() == Approx(0.5 * std::sqrt(2.0)).margin(0.1));
}

TEST_CASE("a heading that the model lacks cannot be encoded", "[unit]") {
  EpisodeSettings settings = settings_for(2);
  settings.encoder.heading = "angle";
  CHECK_THROWS_AS(MbsEnv(linear_model(data::StateLayout::kPosition, {kGain_m}, {0}), settings, {}, 1),
                  common::ConfigError);
}

}  // namespace
}  // namespace lodestone::env
namespace lodestone::env {
namespace {

/// Drives every environment fully to the right once; returns what happened.
StepResult push(MbsEnv& environments) {
  torch::Tensor actions = torch::zeros({environments.spec().count, 2});
  actions.select(1, 0).fill_(1.0);
  return environments.step(actions);
}

TEST_CASE("a predicted distribution is sampled, another draw in every environment", "[unit]") {
  nets::DynamicsModel model = linear_model(data::StateLayout::kPosition, {kGain_m}, {0});
  model.config.components = 2;
  model.members = nets::make_dynamics_members(model.config, data::StateLayout::kPosition, 1);
  {
    // weights equal; means of the change 0 and 4 mm; spreads of e^-5.5
    const torch::NoGradGuard no_grad;
    for (torch::Tensor& parameter : model.members[0]->parameters()) parameter.zero_();
    torch::Tensor bias = model.members[0]->named_parameters()["layers.2.bias"];
    bias[2 + 2] = 4.0;
    bias.narrow(0, 6, 4).fill_(-50.0);
    model.members[0]->output_std.fill_(1e-3);
    model.members[0]->eval();
  }
  EpisodeSettings settings = settings_for(600);
  settings.task.end_on_success = false;
  MbsConfig config;
  config.ensemble = "per_step";
  config.outcome = "sample";
  MbsEnv environments(model, settings, config, 2);
  const torch::Tensor before = environments.reset().clone();
  const torch::Tensor moved =
      42.5 * (push(environments).final_observation.select(1, 0) - before.select(1, 0));  // mm
  const double fraction = (moved > 2.0).to(torch::kFloat32).mean().item<double>();
  CHECK(fraction == Approx(0.5).margin(0.07));
  CHECK(torch::minimum((moved - 4.0).abs(), moved.abs()).max().item<double>() < 0.05);

  config.outcome = "mean";
  MbsEnv mean(model, settings, config, 2);
  const torch::Tensor start = mean.reset().clone();
  const torch::Tensor by_mean = 42.5 * (push(mean).final_observation.select(1, 0) - start.select(1, 0));
  CHECK((by_mean - 2.0).abs().max().item<double>() < 1e-3);

  config.outcome = "sample";
  const nets::DynamicsModel single = linear_model(data::StateLayout::kPosition, {kGain_m}, {0});
  CHECK_THROWS_AS(MbsEnv(single, settings, config, 1), common::ConfigError);
}

TEST_CASE("disagreement of the members costs, and ends episodes where it is large", "[unit]") {
  // The members move 10 mm and 6 mm: 2 mm RMS from their mean.
  const nets::DynamicsModel model =
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
  const StepResult free = tests::copy_of(push(plain));
  const StepResult paid = tests::copy_of(push(punished));
  CHECK((free.reward - paid.reward - 3.0 * 0.002 / 0.0425).abs().max().item<double>() < 1e-5);
  CHECK(paid.terminated.sum().item<std::int64_t>() == 0);
  CHECK(push(stopped).terminated.sum().item<std::int64_t>() == 50);
  const nets::DynamicsModel alone = linear_model(data::StateLayout::kPosition, {kGain_m}, {0});
  CHECK_THROWS_AS(MbsEnv(alone, settings, config, 1), common::ConfigError);
}

TEST_CASE("starts and goals keep to the region, and the radius shrinks with age", "[unit]") {
  const nets::DynamicsModel model = linear_model(data::StateLayout::kPosition, {kGain_m}, {0});
  EpisodeSettings settings = settings_for(200);
  std::vector<task::Move> moves;
  for (int i = 0; i < 2000; ++i) {
    const double x = 0.02 * ((i * 37) % 100) / 100.0;  // the right half only
    const double y = 0.02 * ((i * 61) % 100) / 100.0 - 0.01;
    moves.push_back({{0.02 - x, -y}, {x, y}});
  }
  settings.region = std::make_shared<const task::Region>(moves, task::RegionConfig());
  MbsEnv environments(model, settings, {}, 1);
  const torch::Tensor seen = environments.reset();
  for (std::int64_t i = 0; i < 200; ++i) {
    CHECK(settings.region->contains(position_m(seen, i)));
    CHECK(seen[i][2].item<double>() >= 0.0);
  }
  settings = settings_for(1);
  settings.task.success_radius_m = 1.0;  // everything counts at first, nothing in the end
  settings.task.final_success_radius_m = 1e-5;
  settings.task.end_on_success = false;
  settings.task.end_on_dish_exit = false;
  settings.shrink_steps = 20;
  MbsEnv shrinking(model, settings, {}, 1);
  CHECK(push(shrinking).success[0].item<bool>());
  for (int i = 0; i < 20; ++i) push(shrinking);
  CHECK_FALSE(push(shrinking).success[0].item<bool>());
}

}  // namespace
}  // namespace lodestone::env
