#include "lodestone/physics/viscosity.h"

#include <catch2/catch.hpp>

using lodestone::physics::water_glycerol_viscosity_Pa_s;

TEST_CASE("the viscosity of the dish's fluid is what Cheng's formula gives") {
  CHECK(water_glycerol_viscosity_Pa_s(20.0) == Approx(1.75e-3).epsilon(0.005));
  CHECK(water_glycerol_viscosity_Pa_s(22.0) == Approx(1.66e-3).epsilon(0.005));
  CHECK(water_glycerol_viscosity_Pa_s(25.0) == Approx(1.53e-3).epsilon(0.005));
  CHECK(water_glycerol_viscosity_Pa_s(30.0) == Approx(1.35e-3).epsilon(0.005));
  CHECK(water_glycerol_viscosity_Pa_s(20.0, 0.0) == Approx(1.00e-3).epsilon(0.02));  // water
}
