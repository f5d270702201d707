#include "../../src/physics/cubic_spline.h"

#include <catch2/catch.hpp>
#include <cmath>

namespace lodestone::physics {
namespace {

TEST_CASE("a spline goes through its samples, and between those of a wave follows it") {
  std::vector<double> line, scratch;
  const auto wave = [](double x) { return std::sin(0.4 * x); };
  for (int i = 0; i < 60; ++i) line.push_back(wave(i));
  to_spline(line.data(), static_cast<int>(line.size()), 1, scratch);
  const auto at = [&](double x) {
    const int i = static_cast<int>(x);
    const SplineWeights weights = spline_weights(x - i);
    double sum = 0.0;
    for (int p = 0; p < 4; ++p) sum += weights.w[p] * line[static_cast<std::size_t>(i - 1 + p)];
    return sum;
  };
  for (int i = kSplinePadding; i < 60 - kSplinePadding; ++i) {
    CHECK(at(i) == Approx(wave(i)).margin(1e-12));
    CHECK(at(i + 0.37) == Approx(wave(i + 0.37)).margin(2e-4));
  }
}

}  // namespace
}  // namespace lodestone::physics
