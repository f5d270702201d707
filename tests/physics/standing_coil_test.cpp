#include "lodestone/physics/standing_coil.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::physics {
namespace {

CoilDescription coil_at(std::vector<double> position_m, std::vector<double> axis = {}) {
  CoilDescription coil;
  coil.name = "a";
  coil.position_m = std::move(position_m);
  coil.axis = std::move(axis);
  return coil;
}

TEST_CASE("a coil that stands anywhere has its field turned and moved with it") {
  const CoilDescription plain = coil_at({0.08, 0.0, 0.0});
  const StandingCoil on_x(plain);
  const Eigen::Vector3d centre = on_x.per_ampere(Eigen::Vector3d::Zero());
  CHECK(centre.x() == Approx(on_axis_per_ampere(CoilGeometry{}, -0.08)).epsilon(1e-8));
  CHECK(centre.tail<2>().norm() < 1e-12);

  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift_m(0.01, -0.02, 0.03), middle_m = turn * plain.middle_m() + shift_m;
  const Eigen::Vector3d axis = turn * Eigen::Vector3d::UnitX();
  const StandingCoil moved(
      coil_at({middle_m.x(), middle_m.y(), middle_m.z()}, {axis.x(), axis.y(), axis.z()}));
  for (const Eigen::Vector3d& point_m :
       {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(0.02, -0.01, 0.015)}) {
    const Eigen::Vector3d want = turn * on_x.per_ampere(point_m);
    CHECK((moved.per_ampere(turn * point_m + shift_m) - want).norm() < 1e-9 * want.norm());
  }
}

TEST_CASE("no source and no curl outside the winding") {
  const StandingCoil coil(coil_at({0.05, 0.03, -0.06}, {0.2, 0.1, 1.0}));
  const Eigen::Vector3d point_m(-0.01, 0.02, 0.005);
  const double h_m = 1e-5;
  Eigen::Matrix3d slope;
  for (int axis = 0; axis < 3; ++axis)
    slope.col(axis) = (coil.per_ampere(point_m + h_m * Eigen::Vector3d::Unit(axis)) -
                       coil.per_ampere(point_m - h_m * Eigen::Vector3d::Unit(axis))) /
                      (2.0 * h_m);
  CHECK(std::abs(slope.trace()) < 1e-5 * slope.norm());
  CHECK((slope - slope.transpose()).norm() < 1e-5 * slope.norm());
}

TEST_CASE("a description that is none of a coil is refused") {
  CHECK_THROWS_WITH(StandingCoil(coil_at({0.08, 0.0})), Catch::Contains("position_m"));
  CHECK_THROWS_WITH(StandingCoil(coil_at({0.08, 0.0, 0.0}, {0.0, 0.0, 0.0})), Catch::Contains("axis"));
  CHECK_THROWS_WITH(StandingCoil(coil_at({0.0, 0.0, 0.0})), Catch::Contains("dish centre"));
  CoilDescription nameless = coil_at({0.08, 0.0, 0.0});
  nameless.name = "a,b";
  CHECK_THROWS_WITH(StandingCoil(nameless), Catch::Contains("letters"));
}

}  // namespace
}  // namespace lodestone::physics
