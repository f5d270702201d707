#include "lodestone/physics/apart_coils.h"

#include <catch2/catch.hpp>

using namespace lodestone::physics;

TEST_CASE("of two coils that may not be on together the weaker goes off", "[physics]") {
  PerCoil current_A{3.0, -4.0, 0.0, 2.0};
  ApartCoils(CoilsDescription{}).keep(current_A);
  CHECK(current_A == PerCoil{0.0, -4.0, 0.0, 2.0});

  PerCoil equal_A{1.0, 1.0, 0.0, 0.0};
  ApartCoils(CoilsDescription{}).keep(equal_A);
  CHECK(equal_A == PerCoil{1.0, 0.0, 0.0, 0.0});

  PerCoil free_A{3.0, 4.0};
  ApartCoils().keep(free_A);
  CHECK(free_A == PerCoil{3.0, 4.0});
}
