#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "control/fakes.h"
#include "exports/mcap_file.h"
#include "lodestone/common/error.h"
#include "lodestone/control/goal_seeker.h"
#include "lodestone/data/coverage.h"
#include "lodestone/experiments/collection.h"
#include "sphere_rig.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

experiments::CollectionConfig simulated() {
  experiments::CollectionConfig config;
  config.sensor.kind = "simulated";
  return config;
}

void check_same(const data::Episode& a, const data::Episode& b) {
  CHECK(a.observations == b.observations);
  CHECK(a.actions == b.actions);
  CHECK(a.zero_current == b.zero_current);
  CHECK(a.truncations == b.truncations);
  CHECK(a.placements == b.placements);
}

/// What is explored in about so many steps.
data::Dataset explored(const experiments::CollectionConfig& config, std::int64_t transitions) {
  experiments::Collection collection(config);
  data::Dataset dataset;
  dataset.info = experiments::dataset_info(config);
  while (dataset.transitions() < transitions) dataset.episodes.push_back(collection.next_episode(25));
  return dataset;
}

/// Cells of position in which there was a pulse.
std::int64_t cells_of(const data::Dataset& dataset) {
  const data::Coverage coverage = data::measure_coverage(dataset);
  return std::count_if(coverage.position_counts.begin(), coverage.position_counts.end(),
                       [](std::int64_t count) { return count > 0; });
}

}  // namespace

TEST_CASE("episodes are whole, within bounds, and marked where no current flowed") {
  experiments::CollectionConfig config = simulated();
  config.explorer.zero_fraction = 0.3;
  experiments::Collection collection(config);
  int zero = 0;
  for (int i = 0; i < 6; ++i) {
    const data::Episode episode = collection.next_episode(12);
    const auto length = static_cast<std::size_t>(episode.length());
    REQUIRE(length >= 1);
    CHECK(length <= 12);
    CHECK(episode.observations.size() == 3 * (length + 1));
    REQUIRE(episode.actions.size() == 2 * length);
    CHECK(episode.truncations.back() == 1);
    for (std::size_t row = 0; row < length; ++row) {
      const bool none = episode.actions[2 * row] == 0.0 && episode.actions[2 * row + 1] == 0.0;
      CHECK((episode.zero_current[row] == 1) == none);
      CHECK(std::abs(episode.actions[2 * row]) <= config.rig.coils.max_current_A);
      zero += none;
    }
  }
  CHECK(zero > 0);
  CHECK(collection.next_episode(1).length() == 1);
}

TEST_CASE("of a sphere there is a recording of places, without headings") {
  experiments::CollectionConfig config = simulated();
  config.rig.needle = tests::sphere();
  CHECK(experiments::dataset_info(config).layout == data::StateLayout::kPosition);
  experiments::Collection collection(config);
  double travelled_m = 0.0;
  for (int i = 0; i < 6; ++i) {
    const data::Episode episode = collection.next_episode(12);
    const auto length = static_cast<std::size_t>(episode.length());
    REQUIRE(length >= 1);
    REQUIRE(episode.observations.size() == 2 * (length + 1));
    for (std::size_t row = 0; row < length; ++row) {
      const double* from = &episode.observations[2 * row];
      CHECK(std::hypot(from[2], from[3]) < config.rig.dish.radius_m);
      travelled_m += std::hypot(from[2] - from[0], from[3] - from[1]);
    }
  }
  CHECK(travelled_m > 0.02);
  CHECK(experiments::dataset_info(simulated()).layout == data::StateLayout::kPose);
}

TEST_CASE("collection goes on bitwise after a restart") {
  experiments::CollectionConfig config = simulated();
  config.explorer.self_reset = GENERATE(true, false);
  experiments::Collection straight(config);
  for (int i = 0; i < 3; ++i) straight.next_episode(10);
  const common::Json state = common::Json::parse(straight.save().dump());
  experiments::Collection resumed(config);
  resumed.restore(state);
  for (int i = 0; i < 3; ++i) check_same(straight.next_episode(10), resumed.next_episode(10));
  CHECK_THROWS_AS(resumed.restore(common::Json::object()), common::DataError);
}

TEST_CASE("the operator places the needle for every episode, or hardly ever where the rig resets itself") {
  experiments::CollectionConfig config = simulated();
  config.rig.simulation.deviation = GENERATE(rig::DeviationWidth::kLab, rig::DeviationWidth::kWide);
  const data::Dataset by_itself = explored(config, 1000);
  CHECK(by_itself.placements() <= 5);
  config.explorer.self_reset = false;
  const data::Dataset placed = explored(config, 1000);
  CHECK(placed.placements() == static_cast<std::int64_t>(placed.episodes.size()));
  CHECK(placed.placements() >= 40);
  CHECK(cells_of(by_itself) >= cells_of(placed) - 5);
}

TEST_CASE("an episode begins where the one before ended") {
  experiments::Collection collection(simulated());
  data::Episode before = collection.next_episode(5);
  CHECK(before.placements == 0);
  for (int i = 0; i < 10; ++i) {
    const data::Episode next = collection.next_episode(5);
    REQUIRE(next.placements == 0);
    const double* end = &before.observations[before.observations.size() - 3];
    CHECK(std::hypot(end[0] - next.observations[0], end[1] - next.observations[1]) < 0.001);
    before = next;
  }
}

TEST_CASE("a needle that cannot move is placed when freeing it has failed, also after a restart") {
  experiments::CollectionConfig config = simulated();
  config.rig.friction.static_coefficient = 1.0;
  config.rig.needle.net_weight_N = 0.1;
  config.explorer.freeing.max_pulses = 12;
  experiments::Collection straight(config);
  std::int64_t done = 0;
  std::int64_t placements = 0;
  while (placements < 3) {
    experiments::Collection resumed(config);
    resumed.restore(common::Json::parse(straight.save().dump()));
    const data::Episode episode = straight.next_episode(7);
    check_same(episode, resumed.next_episode(7));
    done += episode.length();
    placements += episode.placements;
    REQUIRE(done < 300);
  }
  CHECK(done >= 3 * 12);
}

TEST_CASE("a needle that is not seen is looked for before the operator is asked") {
  experiments::CollectionConfig config = simulated();
  config.sensor.simulated.dropout = 0.6;  // all three looks of a step fail in one of five
  experiments::Collection collection(config);
  int cut_short = 0;
  for (int i = 0; i < 20; ++i) {
    const data::Episode episode = collection.next_episode(25);
    CHECK(episode.placements == 0);
    cut_short += episode.length() < 25;
  }
  CHECK(cut_short > 5);
  config.sensor.simulated.dropout = 1.0;
  experiments::Collection blind(config);
  CHECK_THROWS_AS(blind.next_episode(25), common::HardwareError);
}

TEST_CASE("a missing pose ends an episode without a gap") {
  experiments::CollectionConfig config = simulated();
  config.explorer.self_reset = GENERATE(true, false);
  config.sensor.simulated.dropout = 0.2;
  experiments::Collection collection(config);
  for (int i = 0; i < 5; ++i) {
    const data::Episode episode = collection.next_episode(25);
    CHECK(episode.observations.size() == 3 * (static_cast<std::size_t>(episode.length()) + 1));
    CHECK(episode.truncations.back() == 1);
  }
}

TEST_CASE("sessions explore the same rig in ways of their own, and the first is as a single one") {
  const experiments::CollectionConfig config = simulated();
  experiments::Collection alone(config);
  experiments::Collection first(config, 0);
  experiments::Collection second(config, 1);
  const data::Episode one = alone.next_episode(20);
  check_same(one, first.next_episode(20));
  CHECK(second.next_episode(20).observations != one.observations);
}

TEST_CASE("the first steps of an episode are an episode") {
  experiments::Collection collection(simulated());
  data::Episode episode = collection.next_episode(25);
  while (episode.length() < 4) episode = collection.next_episode(25);
  const data::Episode part = data::first_steps(episode, 3);
  CHECK(part.length() == 3);
  CHECK(part.observations.size() == 12);
  CHECK(part.actions.size() == 6);
  CHECK(part.truncations.back() == 1);
  CHECK(std::equal(part.observations.begin(), part.observations.end(), episode.observations.begin()));
}

TEST_CASE("a policy that explores goes on after a restore as if never stopped") {
  const experiments::CollectionConfig config = simulated();
  const auto make = [&] {
    auto inner = std::make_unique<tests::FunctionController>([](const task::Observation& seen) {
      const geometry::Vector2 way_m = seen.target_m - seen.pose.position_m();
      return geometry::Vector2(0.5 * way_m / (way_m.norm() + 1e-9));
    });
    const auto seeker =
        std::make_shared<control::GoalSeeker>(std::move(inner), control::GoalSeekerConfig(),
                                              config.rig.dish.radius_m, common::RandomStream(5, "targets"));
    experiments::Teleoperator teleoperator;
    teleoperator.controller = seeker.get();
    teleoperator.episode_over = [seeker] { return false; };
    teleoperator.save = [seeker] { return seeker->save(); };
    teleoperator.restore = [seeker](const std::string& state) { seeker->restore(state); };
    return experiments::Collection(config, experiments::make_exploration_session(config),
                                   std::move(teleoperator));
  };
  experiments::Collection whole = make();
  whole.next_episode(10);
  const common::Json state = whole.save();
  experiments::Collection resumed = make();
  resumed.restore(state);
  const data::Episode next = whole.next_episode(10);
  CHECK(next.length() == 10);  // it does not stop where the explorer would
  check_same(next, resumed.next_episode(10));
}

TEST_CASE("what is explored is logged, and after every episode in the file") {
  const tests::TemporaryFolder folder;
  const std::string path = folder / "session-0.mcap";
  experiments::Collection collection(simulated());
  collection.log_into(path, {});
  std::size_t steps = 0;
  for (std::size_t episode = 1; episode <= 3; ++episode) {
    const auto before = std::filesystem::file_size(path);
    steps +=
        static_cast<std::size_t>(collection.next_episode(6).length()) + 1;  // and the closing observation
    CHECK(std::filesystem::file_size(path) > before);
  }
  collection.finish_log();
  const auto messages = tests::mcap_messages(path);
  CHECK(messages.at("/step").size() >= steps);  // a run without two poses in a row is no episode
  CHECK(messages.at("/log").size() >= 3);
  CHECK(messages.count("/target") == 0);
  CHECK(messages.count("/needle/truth") == 0);
}
