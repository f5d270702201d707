#include "lodestone/physics/per_coil.h"

#include <catch2/catch.hpp>

namespace lodestone::physics {
namespace {

TEST_CASE("numbers for coils: what was not given is 0") {
  PerCoil current_A;
  CHECK(current_A.size() == 0);
  CHECK(current_A == PerCoil{0.0, 0.0, 0.0, 0.0});
  current_A[2] = 3.0;
  CHECK(current_A.list() == std::vector<double>{0.0, 0.0, 3.0});
  CHECK(current_A == PerCoil{0.0, 0.0, 3.0, 0.0});
  CHECK(current_A != PerCoil{3.0});
  const PerCoil& read = current_A;
  CHECK(read[7] == 0.0);
  CHECK(current_A.size() == 3);
  current_A.assign(2, 1.5);
  CHECK(current_A.list() == std::vector<double>{1.5, 1.5});
  CHECK(read[2] == 0.0);
  CHECK(PerCoil(std::vector<double>{1.0, 2.0}) == PerCoil{1.0, 2.0});
}

TEST_CASE("more coils than a rig may have are refused") {
  PerCoil current_A(kMostCoils, 1.0);
  CHECK_THROWS_AS(current_A[kMostCoils] = 1.0, common::LogicFault);
  CHECK_THROWS_AS(PerCoil(kMostCoils + 1), common::LogicFault);
}

}  // namespace
}  // namespace lodestone::physics
