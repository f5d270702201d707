#include "lodestone/data/dataset.h"

#include <catch2/catch.hpp>
#include <limits>
#include <set>

#include "lodestone/common/error.h"
#include "synthetic.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

std::set<double> first_numbers(const data::Dataset& dataset) {
  std::set<double> values;
  for (const data::Episode& episode : dataset.episodes) values.insert(episode.observations[0]);
  return values;
}

}  // namespace

TEST_CASE("flattening pairs every state with the one after it") {
  const data::Dataset dataset = tests::random_dataset(3, 5);
  CHECK(dataset.transitions() == 15);
  const data::TransitionTable all = data::flatten(dataset, true);
  REQUIRE(all.size() == 15);
  const data::Episode& second = dataset.episodes[1];
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(all.state[7 * 3 + i] == second.observations[2 * 3 + i]);
    CHECK(all.next_state[7 * 3 + i] == second.observations[3 * 3 + i]);
  }
  CHECK(all.action[7 * 2] == second.actions[2 * 2]);
  CHECK(all.episode[7] == 1);

  const data::TransitionTable driven = data::flatten(dataset);
  CHECK(driven.size() == 12);
  for (std::int64_t i = 0; i < driven.size(); ++i)
    CHECK(driven.action[static_cast<std::size_t>(i) * 2] != 0.0);
}

TEST_CASE("a split keeps episodes whole, loses none and depends on the seed alone") {
  const data::Dataset dataset = tests::random_dataset(40, 3);
  const data::Split a = data::split_by_episode(dataset, 0.1, 0.2, 7);
  const data::Split b = data::split_by_episode(dataset, 0.1, 0.2, 7);
  const data::Split other = data::split_by_episode(dataset, 0.1, 0.2, 8);
  CHECK(a.validation.episodes.size() == 4);
  CHECK(a.test.episodes.size() == 8);
  CHECK(a.train.episodes.size() == 28);
  CHECK(first_numbers(a.test) == first_numbers(b.test));
  CHECK(first_numbers(a.test) != first_numbers(other.test));
  std::set<double> together = first_numbers(a.train);
  together.merge(first_numbers(a.validation));
  together.merge(first_numbers(a.test));
  CHECK(together == first_numbers(dataset));
}

TEST_CASE("a split with an empty part is refused") {
  const data::Dataset dataset = tests::random_dataset(4, 3);
  CHECK_THROWS_WITH(data::split_by_episode(dataset, 0.01, 0.5, 1),
                    Contains("validation") && Contains("4 episodes"));
  CHECK_THROWS_WITH(data::split_by_episode(dataset, 0.5, 0.5, 1), Contains("training"));
  CHECK(data::split_by_episode(dataset, 0.25, 0.0, 1).test.episodes.empty());
}

TEST_CASE("NaN and infinity are found with their place") {
  data::Dataset dataset = tests::random_dataset(3, 4);
  dataset.episodes[2].observations[3 * 3 + 2] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(data::check_dataset(dataset, "a.h5"), common::DataError);
  CHECK_THROWS_WITH(data::check_dataset(dataset, "a.h5"), Contains("a.h5") && Contains("episode 2") &&
                                                              Contains("row 3") && Contains("heading_rad"));
  dataset = tests::random_dataset(3, 4);
  dataset.episodes[1].actions[5] = std::numeric_limits<double>::infinity();
  CHECK_THROWS_WITH(data::check_dataset(dataset, "a.h5"), Contains("row 2") && Contains("drive_y"));
}

TEST_CASE("sizes that disagree and empty datasets are found") {
  data::Dataset dataset = tests::random_dataset(2, 4);
  dataset.episodes[1].observations.pop_back();
  CHECK_THROWS_WITH(data::check_dataset(dataset, "a.h5"), Contains("observations") && Contains("episode 1"));
  dataset.episodes.clear();
  CHECK_THROWS_WITH(data::check_dataset(dataset, "a.h5"), Contains("no transition"));
}

TEST_CASE("the first transitions are whole episodes and a part of one") {
  const data::Dataset dataset = tests::random_dataset(4, 5);
  const data::Dataset part = data::first_transitions(dataset, 12);
  CHECK(part.transitions() == 12);
  REQUIRE(part.episodes.size() == 3);
  CHECK(part.episodes[1].actions == dataset.episodes[1].actions);
  CHECK(part.episodes[2].length() == 2);
  CHECK(part.episodes[2].truncations.back() == 1);
  CHECK(data::first_transitions(dataset, 10).episodes.size() == 2);
  CHECK(data::first_transitions(dataset, 1000).transitions() == 20);
}

TEST_CASE("numbers out of all proportion, flags that are none and impossible attributes are found") {
  const auto fault_of = [](const auto& spoil) {
    data::Dataset dataset = tests::random_dataset(3, 4);
    dataset.impossible = {dataset.episodes[0]};
    data::check_dataset(dataset, "a.h5");
    spoil(dataset);
    try {
      data::check_dataset(dataset, "a.h5");
    } catch (const common::DataError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(fault_of([](data::Dataset& d) { d.episodes[1].observations[3] = 1e300; }),
             Contains("episode 1: observations row 1, column x_m is 1e+300"));
  CHECK_THAT(fault_of([](data::Dataset& d) { d.episodes[1].observations[2] = -1e9; }),
             Contains("heading_rad"));
  CHECK_THAT(fault_of([](data::Dataset& d) { d.episodes[1].actions[1] = 1e6; }), Contains("drive_y"));
  CHECK_THAT(fault_of([](data::Dataset& d) { d.episodes[2].truncations[1] = 7; }),
             Contains("episode 2: truncations row 1 is 7; a flag is 0 or 1"));
  CHECK_THAT(fault_of([](data::Dataset& d) { d.episodes[1].placements = -1; }),
             Contains("episode 1: placements is -1"));
  CHECK_THAT(fault_of([](data::Dataset& d) { d.impossible[0].zero_current[0] = 2; }), Contains("impossible"));
  CHECK_THAT(fault_of([](data::Dataset& d) { d.impossible[0].observations[0] = 1e4; }),
             Contains("impossible"));
  CHECK(fault_of([](data::Dataset& d) { d.impossible[0].observations[0] = 3.0; }) == "accepted");
  for (const double bad :
       {0.0, -1.0, 1e9, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    CHECK_THAT(fault_of([bad](data::Dataset& d) { d.info.control_period_s = bad; }),
               Contains("control_period_s"));
    CHECK_THAT(fault_of([bad](data::Dataset& d) { d.info.action_scale = bad; }), Contains("action_scale"));
    CHECK_THAT(fault_of([bad](data::Dataset& d) { d.info.workspace_radius_m = bad; }),
               Contains("workspace_radius_m"));
  }
  CHECK_THAT(fault_of([](data::Dataset& d) { d.info.source = "\xff"; }), Contains("UTF-8"));
  CHECK_THAT(fault_of([](data::Dataset& d) { d.info.action_unit = "furlong"; }), Contains("furlong"));
}
