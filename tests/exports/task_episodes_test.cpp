#include "lodestone/exports/task_episodes.h"

#include <catch2/catch.hpp>

#include "data/synthetic.h"
#include "lodestone/common/error.h"

using namespace lodestone;

namespace {

/// A needle that is pulled along x, from 10 mm to the left of the centre through it, 2 mm a step.
data::Dataset walk(int steps = 8) {
  data::Dataset dataset;
  dataset.info.workspace_radius_m = 0.04;
  dataset.info.action_scale = 15.0;
  data::Episode episode;
  for (int t = 0; t <= steps; ++t)
    episode.observations.insert(episode.observations.end(), {-0.010 + 0.002 * t, 0.0, 0.5});
  for (int t = 0; t < steps; ++t) {
    episode.actions.insert(episode.actions.end(), {t == 1 ? 18.0 : 7.5, t == 2 ? -15.0 : 0.0});
    episode.terminations.push_back(0);
    episode.truncations.push_back(t + 1 == steps ? 1 : 0);
    episode.zero_current.push_back(0);
  }
  dataset.episodes.push_back(episode);
  return dataset;
}

task::TaskConfig centre() {
  task::TaskConfig task;
  task.goal = task::GoalKind::kCentre;
  task.dish_radius_m = 0.04;
  return task;
}

}  // namespace

TEST_CASE("a recording is cut where the task ends an episode, and no step is lost") {
  const auto episodes = exports::task_episodes(walk(), centre(), 1);
  // Within 3 mm after four steps, after each of the next two, and at 4 mm where the recording is cut.
  REQUIRE(episodes.size() == 4);
  CHECK(episodes[0].length() == 4);
  CHECK(episodes[0].terminations == std::vector<std::uint8_t>{0, 0, 0, 1});
  CHECK(episodes[0].truncations == std::vector<std::uint8_t>{0, 0, 0, 0});
  CHECK(episodes[0].success == std::vector<std::uint8_t>{0, 0, 0, 0, 1});
  CHECK(episodes[0].distance_m[1] == Approx(0.008));
  CHECK(episodes[0].observations.size() == 15);
  CHECK(episodes[1].length() == 1);
  CHECK(episodes[3].length() == 2);
  CHECK(episodes[3].terminations == std::vector<std::uint8_t>{0, 0});
  CHECK(episodes[3].truncations == std::vector<std::uint8_t>{0, 1});
}

TEST_CASE("rewards are those of eq. 3, actions the drives over the largest one, saturated") {
  const exports::TaskEpisode episode = exports::task_episodes(walk(), centre(), 1).at(0);
  CHECK(episode.actions == std::vector<double>{0.5, 0.0, 1.0, 0.0, 0.5, -1.0, 0.5, 0.0});
  CHECK(episode.rewards[0] == Approx(-10.0 * -0.002 / 0.04 - 0.04));
  CHECK(episode.rewards[3] == Approx(-10.0 * -0.002 / 0.04 - 0.04 + 10.0));
}

TEST_CASE("the step limit truncates") {
  task::TaskConfig task = centre();
  task.end_on_success = false;
  task.max_steps = 3;
  const auto episodes = exports::task_episodes(walk(), task, 1);
  REQUIRE(episodes.size() == 3);
  CHECK(episodes[0].truncations == std::vector<std::uint8_t>{0, 0, 1});
  CHECK(episodes[2].length() == 2);
}

TEST_CASE("goals that are drawn are part of what is observed, and come from the seed") {
  task::TaskConfig task = centre();
  task.goal = task::GoalKind::kPose;
  CHECK(exports::observation_columns(data::StateLayout::kPose, task.goal) ==
        std::vector<std::string>{"x_m", "y_m", "heading_rad", "target_x_m", "target_y_m",
                                 "target_heading_rad"});
  CHECK(exports::observation_columns(data::StateLayout::kPosition, task::GoalKind::kCentre) ==
        std::vector<std::string>{"x_m", "y_m"});
  const auto episodes = exports::task_episodes(tests::random_dataset(6, 5), task, 3);
  const auto again = exports::task_episodes(tests::random_dataset(6, 5), task, 3);
  REQUIRE(episodes.size() >= 6);
  const exports::TaskEpisode& episode = episodes[2];
  REQUIRE(episode.observations.size() == 6 * static_cast<std::size_t>(episode.length() + 1));
  CHECK(episode.observations[3] == episode.goal.position_m.x());
  CHECK(episode.observations[5] == *episode.goal.heading_rad);
  CHECK(episode.observations[3] != episodes[3].observations[3]);
  CHECK(episode.observations == again[2].observations);
  CHECK(episode.seed > 0);
  CHECK(exports::task_episodes(tests::random_dataset(6, 5), task, 4)[2].seed != episode.seed);
}

TEST_CASE("a goal with a heading needs a recording with one") {
  data::Dataset dataset = walk();
  dataset.info.layout = data::StateLayout::kPosition;
  task::TaskConfig task = centre();
  task.goal = task::GoalKind::kPose;
  CHECK_THROWS_WITH(exports::task_episodes(dataset, task, 1), Catch::Contains("task.goal"));
}
