#include "lodestone/physics/finite_coil.h"

#include <fmt/core.h>

#include <cmath>

#include "lodestone/common/config.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::physics {
namespace {

struct Quadrature {
  std::vector<double> nodes;  // in [-1, 1]
  std::vector<double> weights;
};

/// Gauss-Legendre rule by Newton's method on the Legendre polynomial.
Quadrature gauss_legendre(int order) {
  Quadrature rule;
  rule.nodes.resize(order);
  rule.weights.resize(order);
  for (int i = 0; i < order; ++i) {
    double x = std::cos(geometry::kPi * (i + 0.75) / (order + 0.5));
    double derivative = 1.0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double previous = 1.0;
      double value = x;
      for (int n = 2; n <= order; ++n) {
        const double next = ((2.0 * n - 1.0) * x * value - (n - 1.0) * previous) / n;
        previous = value;
        value = next;
      }
      derivative = order * (x * value - previous) / (x * x - 1.0);
      const double change = value / derivative;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    rule.nodes[i] = x;
    rule.weights[i] = 2.0 / ((1.0 - x * x) * derivative * derivative);
  }
  return rule;
}

}  // namespace

void CoilWinding::validate() const {
  if (inner_radius_m >= outer_radius_m)
    throw common::InvalidConfig("inner_radius_m", inner_radius_m,
                                fmt::format("be below outer_radius_m = {}", outer_radius_m));
}

void CoilGeometry::validate() const {
  CoilWinding::validate();
  if (centre_distance_m <= length_m / 2.0)
    throw common::InvalidConfig(
        "centre_distance_m", centre_distance_m,
        fmt::format("exceed half of length_m = {}, or the winding reaches the dish centre", length_m));
}

CoilGeometry published_coil_geometry() {
  CoilGeometry geometry;
  geometry.inner_radius_m = 0.5 * 0.085;
  geometry.outer_radius_m = 0.049;
  geometry.length_m = 0.060;
  geometry.turns = 648;
  geometry.centre_distance_m = 0.080;
  return geometry;
}

EllipticKE complete_elliptic(double m) {
  LODESTONE_CHECK(m >= 0.0 && m < 1.0, "parameter must be in [0, 1), got " + std::to_string(m));
  double a = 1.0;
  double b = std::sqrt(1.0 - m);
  double sum = m / 2.0;
  double power = 0.5;
  // Quadratic convergence: the difference after c ~ 1e-8 is below the resolution of a double.
  for (double c = 1.0; std::abs(c) > 1e-9 * a;) {
    c = (a - b) / 2.0;
    const double mean = (a + b) / 2.0;
    b = std::sqrt(a * b);
    a = mean;
    power *= 2.0;
    sum += power * c * c;
  }
  const double k = geometry::kPi / (2.0 * a);
  return {k, k * (1.0 - sum)};
}

AxialRadial loop_field_per_ampere(double radius_m, double axial_m, double radial_m) {
  const double a2 = radius_m * radius_m;
  const double z2 = axial_m * axial_m;
  if (radial_m < 1e-5 * radius_m) {
    // The general form loses digits near the axis; this is its leading term, exact to (radial / radius)^2.
    const double s2 = a2 + z2;
    const double axial = kVacuumPermeability * a2 / (2.0 * s2 * std::sqrt(s2));
    return {axial, 1.5 * axial * axial_m * radial_m / s2};
  }
  const double r2 = radial_m * radial_m;
  const double near2 = (radius_m - radial_m) * (radius_m - radial_m) + z2;
  const double far2 = (radius_m + radial_m) * (radius_m + radial_m) + z2;
  const EllipticKE elliptic = complete_elliptic(1.0 - near2 / far2);
  const double scale = kVacuumPermeability / (2.0 * geometry::kPi * near2 * std::sqrt(far2));
  return {scale * ((a2 - r2 - z2) * elliptic.e + near2 * elliptic.k),
          scale * axial_m / radial_m * ((a2 + r2 + z2) * elliptic.e - near2 * elliptic.k)};
}

FiniteCoil::FiniteCoil(const CoilGeometry& geometry, int radial_order, int axial_order)
    : FiniteCoil(static_cast<const CoilWinding&>(geometry), radial_order, axial_order) {
  geometry.validate();
  centre_distance_m_ = geometry.centre_distance_m;
}

FiniteCoil::FiniteCoil(const CoilWinding& geometry, int radial_order, int axial_order) {
  geometry.validate();
  const Quadrature radial = gauss_legendre(radial_order);
  const Quadrature axial = gauss_legendre(axial_order);
  const double mean_radius = (geometry.inner_radius_m + geometry.outer_radius_m) / 2.0;
  const double half_width = (geometry.outer_radius_m - geometry.inner_radius_m) / 2.0;
  for (int i = 0; i < radial_order; ++i) {
    for (int j = 0; j < axial_order; ++j)
      loops_.push_back({mean_radius + half_width * radial.nodes[i], geometry.length_m / 2.0 * axial.nodes[j],
                        static_cast<double>(geometry.turns) * radial.weights[i] * axial.weights[j] / 4.0});
  }
}

AxialRadial FiniteCoil::per_ampere(double axial_m, double radial_m) const {
  AxialRadial sum;
  for (const Loop& loop : loops_) {
    const AxialRadial one = loop_field_per_ampere(loop.radius_m, axial_m - loop.axial_m, radial_m);
    sum.axial += loop.turns * one.axial;
    sum.radial += loop.turns * one.radial;
  }
  return sum;
}

geometry::Vector2 FiniteCoil::in_dish_plane(const geometry::Vector2& point_m) const {
  const AxialRadial field = per_ampere(point_m.x() - centre_distance_m_, std::abs(point_m.y()));
  return {field.axial, point_m.y() < 0.0 ? -field.radial : field.radial};
}

double on_axis_per_ampere(const CoilGeometry& geometry, double axial_m) {
  const double r1 = geometry.inner_radius_m;
  const double r2 = geometry.outer_radius_m;
  const auto end = [&](double z) {
    return z * std::log((r2 + std::sqrt(r2 * r2 + z * z)) / (r1 + std::sqrt(r1 * r1 + z * z)));
  };
  const double density = static_cast<double>(geometry.turns) / (geometry.length_m * (r2 - r1));
  return kVacuumPermeability * density / 2.0 *
         (end(axial_m + geometry.length_m / 2.0) - end(axial_m - geometry.length_m / 2.0));
}

}  // namespace lodestone::physics
