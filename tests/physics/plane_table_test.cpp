#include "lodestone/physics/plane_table.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

TEST_CASE("a table holds a smooth field in its reach, and refuses points outside") {
  const auto field = [](const Vector2& at_m) {
    return Eigen::Vector3d(std::sin(30.0 * at_m.x()), std::cos(20.0 * at_m.y() + 10.0 * at_m.x()),
                           at_m.x() * at_m.y());
  };
  const PlaneTable table(field, 0.04, 1e-3);
  for (const Vector2& at_m : {Vector2(0.0, 0.0), Vector2(0.04, -0.04), Vector2(-0.0123, 0.0307)})
    CHECK((table.at(at_m) - field(at_m)).norm() < 1e-6);
  CHECK_THROWS_AS(table.at({0.0401, 0.0}), common::LogicFault);
  CHECK_THROWS_AS(table.at({0.0, std::nan("")}), common::LogicFault);
}

}  // namespace
}  // namespace lodestone::physics
