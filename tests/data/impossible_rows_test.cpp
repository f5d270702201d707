#include "impossible_rows.h"

#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("steps to and from an impossible position are taken out, and the rest stays in two episodes") {
  data::Dataset dataset;
  dataset.info.layout = data::StateLayout::kPosition;
  data::Episode episode;
  for (const double x_m : {0.00, 0.01, 0.90, 0.02, 0.03}) {
    episode.observations.push_back(x_m);
    episode.observations.push_back(0.0);
  }
  episode.actions.assign(8, 1.0);
  episode.terminations.assign(4, 0);
  episode.truncations = {0, 0, 0, 1};
  episode.zero_current.assign(4, 0);
  dataset.episodes.push_back(episode);
  const auto found = data::separate_impossible(dataset, {{2, 3, 4, 5, 6}}, 0.05);
  REQUIRE(found.size() == 1);
  CHECK(found[0].line == 4);
  CHECK(found[0].radius_m == 0.9);
  REQUIRE(dataset.episodes.size() == 2);
  CHECK(dataset.episodes[0].observations == std::vector<double>{0.0, 0.0, 0.01, 0.0});
  CHECK(dataset.episodes[1].observations == std::vector<double>{0.02, 0.0, 0.03, 0.0});
  CHECK(dataset.impossible.size() == 2);
}
