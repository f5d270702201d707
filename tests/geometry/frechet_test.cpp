#include "lodestone/geometry/frechet.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <random>

using namespace lodestone;
using geometry::Vector2;

namespace {

/// As it is defined, without memory: the shortest over all ways of walking.
double by_every_walk(const std::vector<Vector2>& a, const std::vector<Vector2>& b) {
  const std::function<double(std::size_t, std::size_t)> from = [&](std::size_t i, std::size_t j) -> double {
    const double here = (a[i] - b[j]).norm();
    std::vector<double> ways;
    if (i + 1 < a.size()) ways.push_back(from(i + 1, j));
    if (j + 1 < b.size()) ways.push_back(from(i, j + 1));
    if (i + 1 < a.size() && j + 1 < b.size()) ways.push_back(from(i + 1, j + 1));
    return ways.empty() ? here : std::max(here, *std::min_element(ways.begin(), ways.end()));
  };
  return from(0, 0);
}

}  // namespace

TEST_CASE("the discrete Frechet distance is that of the best of all walks") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  for (int round = 0; round < 200; ++round) {
    std::vector<Vector2> a(1 + random() % 6);
    std::vector<Vector2> b(1 + random() % 6);
    for (auto* line : {&a, &b})
      for (Vector2& point : *line) point = {coordinate(random), coordinate(random)};
    CHECK(geometry::discrete_frechet_m(a, b) == Approx(by_every_walk(a, b)));
    CHECK(geometry::discrete_frechet_m(a, b) == Approx(geometry::discrete_frechet_m(b, a)));
  }
}

TEST_CASE("who walks the same points backwards is far away") {
  const std::vector<Vector2> line = {{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}, {3.0, 0.0}};
  CHECK(geometry::discrete_frechet_m(line, line) == 0.0);
  CHECK(geometry::discrete_frechet_m(line, {line.rbegin(), line.rend()}) == 3.0);
}
