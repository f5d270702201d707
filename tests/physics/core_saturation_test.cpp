#include "lodestone/physics/core_saturation.h"

#include <catch2/catch.hpp>
#include <cmath>

namespace lodestone::physics {
namespace {

TEST_CASE("a core gives out while its winding goes on") {
  CHECK(unsaturated_A(7.3, 0.0, 1.0) == 7.3);
  CHECK(unsaturated_A(0.0, 0.8, 5.0) == 0.0);
  // At small currents nothing is lacking, and what is grows with their cube: 0.8 I^3 / (3 * 25).
  CHECK(unsaturated_A(0.1, 0.8, 5.0) == Approx(0.1 - 0.8e-3 / 75.0).epsilon(1e-6));
  CHECK(unsaturated_A(5.0, 1.0, 5.0) == Approx(5.0 * std::tanh(1.0)));
  // At large ones an ampere more gives what the winding alone gives.
  CHECK(unsaturated_A(51.0, 0.8, 5.0) - unsaturated_A(50.0, 0.8, 5.0) == Approx(0.2).epsilon(1e-6));
  CHECK(unsaturated_A(-6.0, 0.8, 5.0) == -unsaturated_A(6.0, 0.8, 5.0));
}

}  // namespace
}  // namespace lodestone::physics
