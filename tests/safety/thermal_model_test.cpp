#include "lodestone/safety/thermal_model.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace lodestone;

TEST_CASE("the thermal model heats as R i2 and cools towards the room") {
  physics::RigDescription config;
  config.coils.temperature_coefficient_per_K = 0.0;
  safety::ThermalModel model(config);
  model.advance({10.0, 0.0, 0.0, 0.0}, 1e6, 1e6);
  CHECK(model.temperature_C(0) == Approx(22.0 + 190.0 / 15.0));
  CHECK(model.temperature_C(1) == Approx(22.0));
  const double tau_s = 651.0 / 15.0;
  model.advance({}, 0.0, tau_s);
  CHECK(model.temperature_C(0) == Approx(22.0 + 190.0 / 15.0 * std::exp(-1.0)));
}
