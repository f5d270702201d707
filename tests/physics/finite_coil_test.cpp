#include "lodestone/physics/finite_coil.h"
#include "lodestone/geometry/angle.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

/// Biot-Savart by the midpoint rule around the loop, which converges exponentially for a periodic integrand.
AxialRadial biot_savart(double radius, double axial, double radial) {
  constexpr int kSegments = 2000;
  double along = 0.0, away = 0.0;
  for (int i = 0; i < kSegments; ++i) {
    const double phi = 2.0 * geometry::kPi * (i + 0.5) / kSegments;
    // Loop in the plane z = 0, point (radial, 0, axial); dl = radius (-sin, cos, 0) dphi.
    const double rx = radial - radius * std::cos(phi), ry = -radius * std::sin(phi), rz = axial;
    const double lx = -radius * std::sin(phi), ly = radius * std::cos(phi);
    const double r3 = std::pow(rx * rx + ry * ry + rz * rz, 1.5);
    away += ly * rz / r3;
    along += (lx * ry - ly * rx) / r3;
  }
  const double scale = kVacuumPermeability / (4.0 * geometry::kPi) * 2.0 * geometry::kPi / kSegments;
  return {scale * along, scale * away};
}

TEST_CASE("complete elliptic integrals match tabulated values") {
  // Abramowitz and Stegun, table 17.1 (parameter m).
  CHECK(complete_elliptic(0.0).k == Approx(geometry::kPi / 2.0).epsilon(1e-14));
  CHECK(complete_elliptic(0.0).e == Approx(geometry::kPi / 2.0).epsilon(1e-14));
  CHECK(complete_elliptic(0.5).k == Approx(1.854074677301372).epsilon(1e-14));
  CHECK(complete_elliptic(0.5).e == Approx(1.350643881047676).epsilon(1e-14));
  CHECK(complete_elliptic(0.99).k == Approx(3.695637362989875).epsilon(1e-13));
  CHECK(complete_elliptic(0.99).e == Approx(1.015993545025224).epsilon(1e-13));
  CHECK_THROWS_AS(complete_elliptic(1.0), common::LogicFault);
}

TEST_CASE("one loop by elliptic integrals is the Biot-Savart integral") {
  const double radius = 0.04;
  for (const double axial : {-0.12, -0.05, -0.01, 0.0, 0.03}) {
    for (const double radial : {0.0, 1e-7, 1e-4, 0.01, 0.03, 0.06}) {
      const AxialRadial exact = loop_field_per_ampere(radius, axial, radial);
      const AxialRadial numeric = biot_savart(radius, axial, radial);
      const double size = std::hypot(numeric.axial, numeric.radial);
      CAPTURE(axial, radial);
      CHECK(std::abs(exact.axial - numeric.axial) < 1e-9 * size);
      CHECK(std::abs(exact.radial - numeric.radial) < 1e-9 * size);
    }
  }
}

TEST_CASE("finite coil meets the closed form on its axis") {
  for (const CoilGeometry& geometry : {CoilGeometry{}, published_coil_geometry()}) {
    const FiniteCoil coil(geometry);
    for (double x = -0.045; x <= 0.0451; x += 0.005) {
      const double closed = on_axis_per_ampere(geometry, x - geometry.centre_distance_m);
      CHECK(coil.in_dish_plane({x, 0.0}).x() == Approx(closed).epsilon(1e-8));
      CHECK(coil.in_dish_plane({x, 0.0}).y() == 0.0);
    }
  }
}

TEST_CASE("quadrature orders are enough over the whole dish") {
  const FiniteCoil coil{CoilGeometry{}};
  const FiniteCoil finer(CoilGeometry{}, 16, 48);
  double worst = 0.0;
  for (int i = 0; i < 8; ++i) {
    for (const double radius : {0.02, 0.0425}) {
      const Vector2 point(radius * std::cos(0.4 * i), radius * std::sin(0.4 * i));
      worst = std::max(worst, (coil.in_dish_plane(point) - finer.in_dish_plane(point)).norm() /
                                  finer.in_dish_plane(point).norm());
    }
  }
  CHECK(worst < 1e-6);
}

TEST_CASE("published winding gives the field and gradient of the design notes") {
  // mT and T/m at 15 A on the axis; the notes give two or three digits.
  const CoilGeometry geometry = published_coil_geometry();
  const double expected[][3] = {{-0.040, 6.6, 0.15}, {0.0, 18.9, 0.56}, {0.040, 63.4, 1.71}};
  for (const auto& row : expected) {
    const double h = 1e-5;
    const auto field = [&](double x) {
      return 15.0 * on_axis_per_ampere(geometry, x - geometry.centre_distance_m);
    };
    CHECK(1e3 * field(row[0]) == Approx(row[1]).epsilon(0.01));
    CHECK((field(row[0] + h) - field(row[0] - h)) / (2.0 * h) == Approx(row[2]).epsilon(0.03));
  }
}

TEST_CASE("coil geometry that cannot be is refused") {
  CoilGeometry inside_out;
  inside_out.inner_radius_m = 0.05;
  CHECK_THROWS_AS(FiniteCoil(inside_out), common::ConfigError);
}

}  // namespace
}  // namespace lodestone::physics
