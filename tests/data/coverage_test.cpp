#include "lodestone/data/coverage.h"

#include <array>
#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>
#include "lodestone/common/artefact.h"

#include "lodestone/common/error.h"
#include "synthetic.h"

using namespace lodestone;

namespace {

data::Dataset spheres_at(const std::vector<std::array<double, 3>>& rows) {
  data::Dataset dataset;
  dataset.info.layout = data::StateLayout::kPosition;
  dataset.info.workspace_radius_m = 1.0;
  dataset.info.action_scale = 1.0;
  for (const auto& [x, y, drive] : rows) {
    data::Episode episode;
    episode.observations = {x, y, x, y};
    episode.actions = {drive, 0.0};
    episode.terminations = {0};
    episode.truncations = {1};
    episode.zero_current = {drive == 0.0 ? std::uint8_t{1} : std::uint8_t{0}};
    dataset.episodes.push_back(episode);
  }
  return dataset;
}

}  // namespace

TEST_CASE("coverage counts cells by hand") {
  // Two by two position cells and two levels: eight cells. Three of them visited, one twice.
  const data::Dataset dataset = spheres_at(
      {{-0.5, -0.5, 0.2}, {-0.5, -0.5, -0.2}, {-0.5, -0.5, 0.9}, {0.5, 0.5, 1.0}, {0.5, 0.5, 0.0}});
  const data::Coverage coverage = data::measure_coverage(dataset, {2, 8, 2});
  CHECK(coverage.transitions == 4);
  CHECK(coverage.cells == 8);
  CHECK(coverage.visited == 3);
  CHECK(coverage.fraction == Approx(3.0 / 8.0));
  CHECK(coverage.evenness == Approx((0.5 * std::log(2.0) + 2 * 0.25 * std::log(4.0)) / std::log(8.0)));
  CHECK(coverage.position_counts == std::vector<std::int64_t>{3, 0, 0, 1});
  CHECK(coverage.drive_counts == std::vector<std::int64_t>{2, 2});
  CHECK(coverage.heading_counts == std::vector<std::int64_t>{4});
}

TEST_CASE("cells outside the dish do not count") {
  const data::Coverage coverage =
      data::measure_coverage(spheres_at({{0.99, 0.99, 1.0}, {3.0, 0.0, 1.0}}), {4, 1, 1});
  CHECK(coverage.position_counts[15] == -1);
  CHECK(coverage.visited == 0);
  CHECK(coverage.fraction == 0.0);
  CHECK(coverage.cells == 12);
}

TEST_CASE("headings fill their cells, and JSON keeps everything") {
  const data::Coverage coverage = data::measure_coverage(tests::random_dataset(200, 10));
  CHECK(coverage.heading_counts.size() == 8);
  CHECK(std::accumulate(coverage.heading_counts.begin(), coverage.heading_counts.end(), std::int64_t{0}) ==
        coverage.transitions);
  CHECK(coverage.evenness > 0.5);
  const data::Coverage back =
      common::artefact_from_json<data::Coverage>(common::artefact_to_json(coverage), "coverage.json");
  CHECK(back.position_counts == coverage.position_counts);
  CHECK(back.evenness == coverage.evenness);
  CHECK(back.visited == coverage.visited);
  CHECK_THROWS_AS(common::artefact_from_json<data::Coverage>(common::Json::object(), "coverage.json"),
                  common::DataError);
}
