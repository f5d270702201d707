#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/dipole_coil.h"
#include "lodestone/physics/field_table.h"
#include "lodestone/physics/finite_coil.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;
constexpr double kPi = 3.14159265358979323846;

std::shared_ptr<const FieldTable> shared_table() {
  static const std::shared_ptr<const FieldTable> table = make_field_table(CoilGeometry{}, 0.0425);
  return table;
}

/// Biot-Savart by the midpoint rule around the loop, which converges exponentially for a periodic integrand.
AxialRadial biot_savart(double radius, double axial, double radial) {
  constexpr int kSegments = 2000;
  double along = 0.0, away = 0.0;
  for (int i = 0; i < kSegments; ++i) {
    const double phi = 2.0 * kPi * (i + 0.5) / kSegments;
    // Loop in the plane z = 0, point (radial, 0, axial); dl = radius (-sin, cos, 0) dphi.
    const double rx = radial - radius * std::cos(phi), ry = -radius * std::sin(phi), rz = axial;
    const double lx = -radius * std::sin(phi), ly = radius * std::cos(phi);
    const double r3 = std::pow(rx * rx + ry * ry + rz * rz, 1.5);
    away += ly * rz / r3;
    along += (lx * ry - ly * rx) / r3;
  }
  const double scale = kVacuumPermeability / (4.0 * kPi) * 2.0 * kPi / kSegments;
  return {scale * along, scale * away};
}

TEST_CASE("complete elliptic integrals match tabulated values") {
  // Abramowitz and Stegun, table 17.1 (parameter m).
  CHECK(complete_elliptic(0.0).k == Approx(kPi / 2.0).epsilon(1e-14));
  CHECK(complete_elliptic(0.0).e == Approx(kPi / 2.0).epsilon(1e-14));
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

TEST_CASE("a finite coil looks like its dipole from afar and is weaker near by") {
  CoilGeometry geometry = published_coil_geometry();
  const auto ratio = [&](double x) {
    const FiniteCoil exact(geometry);
    FieldGradient dipole;
    DipoleCoil(geometry, 0).add(1.0, {x, 0.0}, dipole);
    return dipole.field_T.x() / exact.in_dish_plane({x, 0.0}).x();
  };
  // Errors of the point dipole from the design notes.
  CHECK(ratio(-0.040) == Approx(1.12).epsilon(0.02));
  CHECK(ratio(0.0) == Approx(1.32).epsilon(0.02));
  CHECK(ratio(0.040) == Approx(3.15).epsilon(0.02));
  CHECK(ratio(-3.0) == Approx(1.0).epsilon(1e-3));
  FieldGradient dipole;
  const Vector2 far(-0.9, 1.7);
  DipoleCoil(geometry, 0).add(1.0, far, dipole);
  const Vector2 exact = FiniteCoil(geometry).in_dish_plane(far);
  CHECK((dipole.field_T - exact).norm() < 2e-3 * exact.norm());
}

TEST_CASE("dipole gradient is the derivative of its field") {
  const DipoleCoil coil(CoilGeometry{}, 2);
  const Vector2 point(0.013, -0.021);
  FieldGradient centre;
  coil.add(7.0, point, centre);
  const double h = 1e-6;
  for (int j = 0; j < 2; ++j) {
    FieldGradient ahead, behind;
    coil.add(7.0, point + h * Vector2::Unit(j), ahead);
    coil.add(7.0, point - h * Vector2::Unit(j), behind);
    const Vector2 numeric = (ahead.field_T - behind.field_T) / (2.0 * h);
    CHECK((centre.gradient_T_per_m.col(j) - numeric).norm() < 1e-6 * centre.gradient_T_per_m.norm());
  }
}

TEST_CASE("table holds the exact field and its gradient") {
  const FieldTable& table = *shared_table();
  const FiniteCoil exact{CoilGeometry{}};
  double worst = 0.0, worst_gradient = 0.0;
  const double h = 1e-5;
  for (int i = 0; i < 60; ++i) {
    const double radius = 0.0424 * std::sqrt((i + 0.5) / 60.0), angle = 0.3 + 2.399963 * i;
    const Vector2 point(radius * std::cos(angle), radius * std::sin(angle));
    const auto gradient = [&](const auto& field) { return ((field(h) - field(-h)) / (2.0 * h)).eval(); };
    const Vector2 want = exact.in_dish_plane(point);
    worst = std::max(worst, (table.per_ampere(point) - want).norm() / want.norm());
    const Vector2 want_slope =
        gradient([&](double d) { return Vector2(exact.in_dish_plane(point + Vector2(d, 0.0))); });
    const Vector2 slope =
        gradient([&](double d) { return Vector2(table.per_ampere(point + Vector2(d, 0.0))); });
    worst_gradient = std::max(worst_gradient, (slope - want_slope).norm() / want_slope.norm());
  }
  CAPTURE(worst, worst_gradient);
  CHECK(worst < 1e-5);
  CHECK(worst_gradient < 1e-3);
  CHECK_THROWS_AS(table.per_ampere({0.05, 0.0}), common::LogicFault);
}

TEST_CASE("tabulated field is free of divergence and curl") {
  const FieldTable& table = *shared_table();
  const double h = 2e-5;
  for (int i = 0; i < 40; ++i) {
    const double radius = 0.002 + 0.040 * std::sqrt((i + 0.5) / 40.0), angle = 0.3 + 2.399963 * i;
    const Vector2 p(radius * std::cos(angle), radius * std::sin(angle));
    const auto slope = [&](const Vector2& d) -> Vector2 {
      return (table.per_ampere(p + h * d) - table.per_ampere(p - h * d)) / (2.0 * h);
    };
    const Vector2 dx = slope({1.0, 0.0}), dy = slope({0.0, 1.0});
    const double size = dx.norm() + dy.norm();
    // Out of the plane the field of a coil turns with the azimuth about its axis: dBz/dz = B_radial / radius.
    const double dz = table.per_ampere(p).y() / p.y();
    CAPTURE(p.x(), p.y());
    CHECK(std::abs(dx.x() + dy.y() + dz) < 2e-3 * size);
    CHECK(std::abs(dx.y() - dy.x()) < 2e-3 * size);
  }
}

TEST_CASE("four coils: positive current makes a field towards the coil, strongest near it") {
  const CoilArray coils(shared_table());
  for (int coil = 0; coil < kCoils; ++coil) {
    Currents current{};
    current[static_cast<std::size_t>(coil)] = 1.0;
    const Vector2 direction = coil_direction(coil);
    const Vector2 side(-direction.y(), direction.x());
    CHECK((from_coil_frame(coil, to_coil_frame(coil, {0.3, -0.7})) - Vector2(0.3, -0.7)).norm() == 0.0);
    const Vector2 centre = coils.field_T(current, {0.0, 0.0});
    CHECK(centre.dot(direction) > 0.5e-3);
    CHECK(std::abs(centre.dot(side)) < 1e-12);
    CHECK(coils.field_T(current, 0.03 * direction).dot(direction) > 2.0 * centre.dot(direction));
    // The same field in every coil's own frame.
    const Vector2 point = 0.01 * direction + 0.02 * side;
    CHECK((to_coil_frame(coil, coils.field_T(current, point)) -
           coils.field_T({1.0, 0.0, 0.0, 0.0}, {0.01, 0.02}))
              .norm() < 1e-15);
  }
  const Vector2 point(0.011, -0.007);
  const Vector2 both = coils.field_T({2.0, 0.0, 0.0, -3.0}, point);
  CHECK((both - coils.field_T({2.0, 0.0, 0.0, 0.0}, point) - coils.field_T({0.0, 0.0, 0.0, -3.0}, point))
            .norm() < 1e-15);
}

TEST_CASE("coil geometry that cannot be is refused") {
  CoilGeometry inside_out;
  inside_out.inner_radius_m = 0.05;
  CHECK_THROWS_AS(FiniteCoil(inside_out), common::ConfigError);
  CoilGeometry near_by;
  near_by.centre_distance_m = 0.056;  // its winding begins 42 mm from the dish centre, inside the dish
  CHECK_THROWS_AS(make_field_table(near_by, 0.0425), common::ConfigError);
}

}  // namespace
}  // namespace lodestone::physics
