#include "lodestone/physics/field_table.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/physics/finite_coil.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

const FieldTable& shared_table() {
  static const std::shared_ptr<const FieldTable> table = make_field_table(CoilGeometry{}, 0.0425);
  return *table;
}

TEST_CASE("table holds the exact field and its gradient") {
  const FieldTable& table = shared_table();
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
  const FieldTable& table = shared_table();
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

TEST_CASE("a winding that begins within the reach is refused") {
  CoilGeometry near_by;
  near_by.centre_distance_m = 0.056;  // its winding begins 42 mm from the dish centre, inside the dish
  CHECK_THROWS_AS(make_field_table(near_by, 0.0425), common::ConfigError);
}

}  // namespace
}  // namespace lodestone::physics
