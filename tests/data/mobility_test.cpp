#include "lodestone/data/mobility.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("mobility counts strong pulses where they began, and how far they went") {
  data::Dataset dataset;
  dataset.info.workspace_radius_m = 0.02;
  dataset.info.action_scale = 10.0;
  dataset.info.layout = data::StateLayout::kPose;
  data::Episode episode;
  // 2 mm from the centre by a strong pulse, nothing by another, 4 mm by one that is too weak to count.
  episode.observations = {0.0, 0.0, 0.0, 0.002, 0.0, 0.0, 0.002, 0.0, 0.0, 0.006, 0.0, 0.0};
  episode.actions = {8.0, 0.0, 0.0, -6.0, 2.0, 0.0};
  episode.terminations = episode.truncations = episode.zero_current = {0, 0, 0};
  episode.truncations.back() = 1;
  dataset.episodes.push_back(episode);

  const data::Mobility mobility = data::measure_mobility(dataset, 0.005);
  CHECK(mobility.strong_A == Approx(5.0));
  const auto with_pulses = [](const data::MobilityCell& cell) { return cell.pulses > 0; };
  REQUIRE(std::count_if(mobility.cells.begin(), mobility.cells.end(), with_pulses) == 1);
  const auto centre = std::find_if(mobility.cells.begin(), mobility.cells.end(), with_pulses);
  CHECK(centre->x_m == 0.0);
  CHECK(centre->pulses == 2);
  CHECK(centre->moved == Approx(0.5));
  CHECK(centre->mean_mm == Approx(1.0));
  CHECK(mobility.cells.size() == 49);  // squares of 5 mm whose centres lie within 20 mm
}
