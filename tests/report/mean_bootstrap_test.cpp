#include "../../src/report/mean_bootstrap.h"

#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("what was drawn once gives the intervals that are drawn anew, to the bit") {
  report::MeanBootstrap bootstrap("test");
  common::RandomStream random(7, "values");
  const auto groups_of = [&random](std::vector<std::size_t> sizes) {
    std::vector<std::vector<double>> groups;
    for (const std::size_t size : sizes) {
      groups.emplace_back();
      for (std::size_t i = 0; i < size; ++i) groups.back().push_back(random.normal());
    }
    return groups;
  };
  for (const std::vector<std::size_t>& sizes : std::vector<std::vector<std::size_t>>{
           {5, 5, 5}, {5, 5, 5}, {15}, {3, 0, 3}, {3, 4}, {1}, {1, 1}, {}, {0}, {5, 5, 5}}) {
    const auto groups = groups_of(sizes);
    const common::Interval kept = bootstrap.interval(groups);
    const common::Interval drawn =
        common::nested_bootstrap_interval(groups, common::mean, common::RandomStream(1, "test"));
    CHECK(kept.low == drawn.low);
    CHECK(kept.high == drawn.high);
  }
}
