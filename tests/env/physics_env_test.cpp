#include "lodestone/env/physics_env.h"

#include <catch2/catch.hpp>

#include "env/sample_settings.h"
#include "env/vec_env_conformance.h"
#include "sphere_rig.h"

namespace lodestone::env {
namespace {

EpisodeSettings short_episodes(std::int64_t count) {
  EpisodeSettings settings = tests::plain_settings(count);
  settings.action.scale = 6.0;
  settings.task.max_steps = 6;
  settings.task.success_radius_m = 0.009;
  return settings;
}

TEST_CASE("the plain simulator keeps the promises of a VecEnv", "[unit]") {
  const EpisodeSettings settings = short_episodes(20);
  PhysicsEnvConfig config;
  config.simulator.step_s = 2e-3;  // the promises do not depend on accuracy
  tests::check_vec_env({[&](std::int64_t threads) {
                          return std::make_unique<PhysicsEnv>(settings, lodestone::tests::paper_rig(), config,
                                                              threads);
                        },
                        6, 0.009, 0.0425, 0.0425});
}

TEST_CASE("the environment moves the needle as the simulator does", "[unit]") {
  EpisodeSettings settings = short_episodes(1);
  settings.encoder.heading = task::HeadingEncoding::kAngle;
  settings.task.success_radius_m = 1e-5;
  const PhysicsEnvConfig config;
  PhysicsEnv environments(settings, lodestone::tests::paper_rig(), config, 1);
  const std::vector<float> start = environments.reset();
  const geometry::Pose2 pose{0.0425 * start[0], 0.0425 * start[1], start[2]};
  const geometry::Pose2 expected = physics::PlainSimulator(lodestone::tests::paper_rig(), config.simulator)
                                       .step(pose, {3.0, 0.0, 0.0, 1.5}, config.pulse_s, config.rest_s);
  const std::vector<float> next = environments.step({0.5F, -0.25F}).final_observation;
  CHECK(0.0425 * next[0] == Approx(expected.x_m).margin(2e-5));
  CHECK(0.0425 * next[1] == Approx(expected.y_m).margin(2e-5));
  CHECK(std::abs(geometry::wrap_angle(next[2] - expected.heading_rad)) < 5e-3);
}

TEST_CASE("a sphere is trained on without a heading", "[unit]") {
  EpisodeSettings settings = short_episodes(20);
  settings.encoder.heading = task::HeadingEncoding::kAngle;
  PhysicsEnvConfig config;
  config.simulator.step_s = 2e-3;
  CHECK_THROWS_WITH(PhysicsEnv(settings, lodestone::tests::sphere_rig(), config, 1),
                    Catch::Contains("encoder.heading = \"angle\", but a sphere has no heading"));
  settings.encoder.heading = task::HeadingEncoding::kNone;
  PhysicsEnv environments(settings, lodestone::tests::sphere_rig(), config, 1);
  const std::vector<float> start = environments.reset();
  const auto columns = static_cast<std::size_t>(environments.spec().observation_size);
  const std::vector<float> next = environments.step(std::vector<float>(2 * 20, 1.0F)).final_observation;
  std::size_t moved = 0;
  for (std::size_t row = 0; row < 20; ++row) moved += next[row * columns] != start[row * columns] ? 1 : 0;
  CHECK(moved > 10);
}

TEST_CASE("randomised simulators keep the promises too, and differ from episode to episode", "[unit]") {
  const EpisodeSettings settings = short_episodes(20);
  PhysicsEnvConfig config;
  config.simulator.step_s = 2e-3;
  config.randomise.enabled = true;
  tests::check_vec_env({[&](std::int64_t threads) {
                          return std::make_unique<PhysicsEnv>(settings, lodestone::tests::paper_rig(), config,
                                                              threads);
                        },
                        6, 0.009, 0.0425, 0.0425});

  config.simulator.step_s = 0.5e-3;
  config.randomise.moment = {1.1, 1.1};
  config.randomise.viscosity = {0.9, 0.9};
  config.randomise.friction = {1.2, 1.2};
  EpisodeSettings one = short_episodes(1);
  one.encoder.heading = task::HeadingEncoding::kAngle;
  one.task.success_radius_m = 1e-5;
  PhysicsEnv fixed(one, lodestone::tests::paper_rig(), config, 1);
  const std::vector<float> start = fixed.reset();
  physics::RigDescription expected = lodestone::tests::paper_rig();
  expected.needle.moment_A_m2 *= 1.1;
  expected.fluid.viscosity_Pa_s *= 0.9;
  expected.friction.static_coefficient *= 1.2;
  expected.friction.kinetic_coefficient *= 1.2;
  const geometry::Pose2 next = physics::PlainSimulator(expected, config.simulator)
                                   .step({0.0425 * start[0], 0.0425 * start[1], start[2]},
                                         {3.0, 0.0, 0.0, 1.5}, config.pulse_s, config.rest_s);
  const std::vector<float> seen = fixed.step({0.5F, -0.25F}).final_observation;
  CHECK(0.0425 * seen[0] == Approx(next.x_m).margin(2e-5));
  CHECK(0.0425 * seen[1] == Approx(next.y_m).margin(2e-5));
}

}  // namespace
}  // namespace lodestone::env
