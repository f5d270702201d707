#include "lodestone/env/episode_batch.h"

#include <catch2/catch.hpp>

#include "env/sample_settings.h"
#include "other_rigs.h"

namespace lodestone::env {
namespace {

/// Episodes begin at rest in the centre.
void begin(EpisodeBatch& episodes, std::size_t i) {
  episodes.begin(i, [](common::RandomStream&) { return geometry::Pose2{}; });
}

EpisodeBatch begun(const EpisodeSettings& settings, const SensorNoise& noise = {}) {
  EpisodeBatch episodes(settings, noise, "test");
  for (std::size_t i = 0; i < static_cast<std::size_t>(settings.count); ++i) begin(episodes, i);
  return episodes;
}

TEST_CASE("an environment may end or cut an episode, and its penalty is taken from the reward", "[unit]") {
  EpisodeSettings settings = tests::plain_settings(4);
  settings.task.end_on_success = false;
  EpisodeBatch episodes = begun(settings);
  const geometry::Pose2 next{0.001, 0.0, 0.0};
  CHECK_FALSE(episodes.finish(0, next));
  StepEnd extra;
  extra.terminated = true;
  extra.truncated = true;  // an end goes before a cut
  CHECK(episodes.finish(1, next, extra));
  CHECK(episodes.result().terminated[1] == 1);
  CHECK(episodes.result().truncated[1] == 0);
  extra.terminated = false;
  CHECK(episodes.finish(2, next, extra));
  CHECK(episodes.result().truncated[2] == 1);
  EpisodeBatch fined = begun(settings);
  extra = {};
  extra.penalty = 0.25;
  fined.finish(0, next, extra);
  CHECK(fined.result().reward[0] == Approx(episodes.result().reward[0] - 0.25));
  CHECK(fined.result().penalty == std::vector<double>{0.25, 0.0, 0.0, 0.0});
}

TEST_CASE("a start is drawn again where it counts as reached now, not where it once would have", "[unit]") {
  EpisodeSettings settings = tests::plain_settings(1);
  settings.task.goal = task::GoalKind::kCentre;
  settings.task.success_radius_m = 0.01;
  settings.task.final_success_radius_m = 0.001;
  settings.shrink_steps = 10;
  EpisodeBatch episodes(settings, {}, "test");
  int draws = 0;
  const auto begin_near = [&] {
    draws = 0;
    episodes.begin(0, [&draws](common::RandomStream&) {
      return geometry::Pose2{++draws == 1 ? 0.005 : 0.02, 0.0, 0.0};
    });
  };
  begin_near();
  CHECK(draws == 2);
  CHECK(episodes.pose(0).x_m == 0.02);
  for (int step = 0; step < 10; ++step) episodes.finish(0, {0.02, 0.0, 0.0});
  CHECK(episodes.result().progress == std::vector<double>{1.0});
  begin_near();
  CHECK(draws == 1);
  CHECK(episodes.pose(0).x_m == 0.005);
  settings.shrink_steps = 0;  // it has shrunk
  EpisodeBatch later(settings, {}, "test");
  later.begin(0, [](common::RandomStream&) { return geometry::Pose2{0.005, 0.0, 0.0}; });
  CHECK_FALSE(later.finish(0, {0.005, 0.0, 0.0}));
}

TEST_CASE("a needle that lies at its goal the wrong way round starts there", "[unit]") {
  EpisodeSettings settings = tests::plain_settings(1);
  settings.task.goal = task::GoalKind::kPose;
  settings.task.goal_radius = 0.0;
  settings.encoder.target_heading = true;
  EpisodeBatch episodes(settings, {}, "test");
  int draws = 0;
  constexpr int kEpisodes = 100;
  for (int episode = 0; episode < kEpisodes; ++episode) {
    episodes.begin(0, [&draws](common::RandomStream&) {
      ++draws;
      return geometry::Pose2{};
    });
  }
  CHECK(draws > kEpisodes);  // one heading of eighteen counts as reached
  CHECK(draws < 1.3 * kEpisodes);
}

TEST_CASE("the final observation stays when a new episode has begun", "[unit]") {
  EpisodeSettings settings = tests::plain_settings(1);
  settings.task.max_steps = 1;
  EpisodeBatch episodes = begun(settings);
  CHECK(episodes.finish(0, {0.01, 0.0, 0.0}));
  begin(episodes, 0);
  CHECK(episodes.result().final_observation[0] == Approx(0.01 / settings.encoder.length_scale_m));
  CHECK(episodes.observation()[0] == 0.0F);
}

TEST_CASE("the sensor's noise is in what is seen, not in where the robot is", "[unit]") {
  EpisodeBatch episodes = begun(tests::plain_settings(1), {1e-3, 0.0});
  CHECK(episodes.observation()[0] != 0.0F);
  CHECK(episodes.pose(0).x_m == 0.0);
}

TEST_CASE("drives are bounded actions in the unit of the scale", "[unit]") {
  EpisodeSettings settings = tests::plain_settings(1);
  settings.action.scale = 10.0;
  EpisodeBatch episodes = begun(settings);
  const float action[2] = {0.5F, -3.0F};
  const geometry::Vector2 drive = episodes.drive(0, action);
  CHECK(drive.x() == Approx(5.0));
  CHECK(drive.y() == Approx(-10.0));
  CHECK_THROWS_AS(episodes.check_actions({0.0F}), common::LogicFault);
}

TEST_CASE("actions of any size are bounded, remembered, and kept in a snapshot", "[unit]") {
  EpisodeSettings settings = tests::plain_settings(2);
  settings.action.size = settings.encoder.action_size = 5;
  settings.encoder.memory = true;
  settings.action.scale = 10.0;
  EpisodeBatch episodes = begun(settings);
  CHECK(episodes.spec().action_size == 5);
  CHECK(episodes.spec().observation_size == 4 + 5 + 2);
  const float action[5] = {0.5F, -3.0F, 0.0F, 0.25F, 1.0F};
  CHECK(episodes.drive(0, action) == geometry::Drive{5.0, -10.0, 0.0, 2.5, 10.0});
  episodes.finish(0, episodes.pose(0));
  CHECK(episodes.observation()[5] == -1.0F);
  EpisodeBatch other = begun(settings);
  other.load(episodes.save());
  CHECK(other.observation() == episodes.observation());
  CHECK_NOTHROW(episodes.check_actions(std::vector<float>(10)));
  CHECK_THROWS_AS(episodes.check_actions(std::vector<float>(4)), common::LogicFault);
}

TEST_CASE("the rig says what an action means, and the data how many numbers it has", "[unit]") {
  physics::RigDescription rig = lodestone::tests::ring_rig(6);
  rig.drive.kind = physics::DriveKind::kIndependent;
  EpisodeSettings settings;
  adopt_rig(rig, settings.task, settings.encoder, settings.action);
  CHECK(settings.action.size == 6);
  CHECK(settings.encoder.action_size == 6);
  CHECK(settings.action.scale == rig.coils.max_current_A);
  CHECK(settings.task.dish_radius_m == rig.dish.radius_m);
  data::DatasetInfo info;
  info.workspace_radius_m = 0.03;
  info.action_size = 3;
  adopt_data(info, settings.task, settings.encoder, settings.action);
  CHECK(settings.action.size == 3);
  CHECK(settings.encoder.action_size == 3);
}

TEST_CASE("an environment's random numbers are those of its stream, wherever it stands in a batch",
          "[unit]") {
  EpisodeBatch three(tests::plain_settings(3), {}, "test");
  EpisodeSettings settings = tests::plain_settings(1);
  settings.first_stream = 2;
  EpisodeBatch third(settings, {}, "test");
  CHECK(third.random(0).uniform() == three.random(2).uniform());
}

TEST_CASE("the data say what an action means and how far the state reaches", "[unit]") {
  data::DatasetInfo info;
  info.layout = data::StateLayout::kPosition;
  info.action_unit = "percent";
  info.action_scale = 89.0;
  info.workspace_radius_m = 0.03;
  info.one_axis_at_a_time = true;
  EpisodeSettings settings;
  adopt_data(info, settings.task, settings.encoder, settings.action);
  CHECK(settings.action.scale == 89.0);
  CHECK(settings.action.unit == "percent");
  CHECK(settings.action.one_axis_at_a_time);
  CHECK(settings.task.dish_radius_m == 0.03);
  CHECK(settings.encoder.length_scale_m == 0.03);
  CHECK(settings.encoder.heading == task::HeadingEncoding::kNone);
  settings.task.goal = task::GoalKind::kPose;
  CHECK_THROWS_WITH(adopt_data(info, settings.task, settings.encoder, settings.action),
                    Catch::Contains("task.goal = \"pose\""));
}

TEST_CASE("episodes of another number are refused", "[unit]") {
  CHECK_THROWS_AS(begun(tests::plain_settings(2)).load(begun(tests::plain_settings(3)).save()),
                  common::CheckpointError);
  CHECK_THROWS_AS(EpisodeBatch(tests::plain_settings(0), {}, "test"), common::ConfigError);
}

}  // namespace
}  // namespace lodestone::env
