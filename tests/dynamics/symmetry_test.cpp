#include "symmetry.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>

#include "lodestone/geometry/angle.h"
#include "lodestone/nets/tensors.h"

using namespace lodestone;
using dynamics::seen;

namespace {

at::Tensor poses() {
  return nets::tensor_from({0.01, 0.02, 0.3, -0.03, 0.005, -3.0}, {2, 3}).to(at::kDouble);
}

bool alike(const at::Tensor& a, const at::Tensor& b) { return at::allclose(a, b, 0.0, 1e-12); }

}  // namespace

TEST_CASE("a quarter turn takes x to y, and the heading with it", "[unit]") {
  const at::Tensor turned = seen(poses(), 1);
  CHECK(turned[0][0].item<double>() == Approx(-0.02));
  CHECK(turned[0][1].item<double>() == Approx(0.01));
  CHECK(turned[0][2].item<double>() == Approx(0.3 + 0.5 * geometry::kPi));
  CHECK(turned[1][2].item<double>() == Approx(-3.0 + 0.5 * geometry::kPi));
  CHECK(seen(poses(), 2)[1][2].item<double>() == Approx(geometry::kPi - 3.0));  // wrapped
}

TEST_CASE("a mirror takes y and the heading to their opposites", "[unit]") {
  const at::Tensor mirrored = seen(poses(), 4);
  CHECK(mirrored[0][0].item<double>() == Approx(0.01));
  CHECK(mirrored[0][1].item<double>() == Approx(-0.02));
  CHECK(mirrored[0][2].item<double>() == Approx(-0.3));
}

TEST_CASE("the eight ways of a square are a group, each once", "[unit]") {
  CHECK(dynamics::ways_of(dynamics::Symmetry::kSquare) == 8);
  CHECK(dynamics::ways_of(dynamics::Symmetry::kNone) == 1);
  for (int a = 0; a < 8; ++a) {
    for (int b = 0; b < 8; ++b) {
      const at::Tensor both = seen(seen(poses(), a), b);
      int matches = 0;
      for (int c = 0; c < 8; ++c) matches += alike(both, seen(poses(), c)) ? 1 : 0;
      CHECK(matches == 1);
    }
  }
}

TEST_CASE("drives turn as positions do", "[unit]") {
  for (int way = 0; way < 8; ++way)
    CHECK(alike(seen(poses().narrow(1, 0, 2), way), seen(poses(), way).narrow(1, 0, 2)));
}
