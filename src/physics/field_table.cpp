#include "lodestone/physics/field_table.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "cubic_spline.h"
#include "lodestone/common/error.h"
#include "lodestone/physics/finite_coil.h"

namespace lodestone::physics {
namespace {

/// The point, or, in or close to the winding, where the field is none of a coil seen from outside, the first
/// one towards the dish centre that is not.
geometry::Vector2 outside_winding(geometry::Vector2 point_m, const CoilGeometry& geometry) {
  constexpr double kClear_m = 1e-3;
  const double face_m = geometry.centre_distance_m - geometry.length_m / 2.0;
  const auto inside = [&] {
    return point_m.x() > face_m - kClear_m && std::abs(point_m.y()) > geometry.inner_radius_m - kClear_m;
  };
  while (inside()) point_m *= 0.98;
  return point_m;
}

}  // namespace

FieldTable::FieldTable(const CoilGeometry& geometry, double reach_m, double spacing_m, double free_m)
    : geometry_(geometry), reach_m_(reach_m), spacing_m_(spacing_m) {
  LODESTONE_CHECK(reach_m > 0.0 && spacing_m > 0.0, "reach and spacing must be positive");
  geometry.validate();
  const int half = static_cast<int>(std::ceil(reach_m / spacing_m - 1e-9)) + kSplinePadding;
  const double face_m = geometry.centre_distance_m - geometry.length_m / 2.0;
  const double winding_m = std::hypot(face_m, geometry.inner_radius_m);
  if (free_m <= 0.0) free_m = reach_m;
  if (winding_m <= free_m)
    throw common::ConfigError("coil: its winding begins " + std::to_string(winding_m) +
                              " m from the dish centre, which must be beyond " + std::to_string(free_m) +
                              " m, the reach of the field table");
  const int side = 2 * half + 1;
  const FiniteCoil coil(geometry);
  std::vector<double> full(static_cast<std::size_t>(side) * side * 2);
  const auto at = [&](int i, int j) { return &full[(static_cast<std::size_t>(i) * side + j) * 2]; };
  for (int i = 0; i < side; ++i) {
    for (int j = half; j < side; ++j) {
      const geometry::Vector2 field =
          coil.in_dish_plane(outside_winding({(i - half) * spacing_m, (j - half) * spacing_m}, geometry));
      at(i, j)[0] = at(i, side - 1 - j)[0] = field.x();
      at(i, side - 1 - j)[1] = -field.y();
      at(i, j)[1] = field.y();
    }
  }
  std::vector<double> scratch;
  for (int component = 0; component < 2; ++component) {
    for (int i = 0; i < side; ++i) to_spline(at(i, 0) + component, side, 2, scratch);
    for (int j = 0; j < side; ++j) to_spline(at(0, j) + component, side, 2 * side, scratch);
  }
  rows_ = side;
  columns_ = side - (half - 1);  // one column below y = 0 for the stencil
  origin_x_m_ = -half * spacing_m;
  origin_y_m_ = -spacing_m;
  coefficients_.reserve(static_cast<std::size_t>(rows_) * columns_ * 2);
  for (int i = 0; i < rows_; ++i)
    coefficients_.insert(coefficients_.end(), at(i, half - 1), at(i, half - 1) + 2 * columns_);
}

geometry::Vector2 FieldTable::per_ampere(const geometry::Vector2& point_m) const {
  const double side = std::abs(point_m.y());
  LODESTONE_CHECK(std::abs(point_m.x()) <= reach_m_ && side <= reach_m_,
                  "point (" + std::to_string(point_m.x()) + ", " + std::to_string(point_m.y()) +
                      ") m outside the field table");
  const double u = (point_m.x() - origin_x_m_) / spacing_m_;
  const double v = (side - origin_y_m_) / spacing_m_;
  const int i = static_cast<int>(u);
  const int j = static_cast<int>(v);
  const SplineWeights wu = spline_weights(u - i);
  const SplineWeights wv = spline_weights(v - j);
  double bx = 0.0;
  double by = 0.0;
  for (int p = 0; p < 4; ++p) {
    const double* row = &coefficients_[(static_cast<std::size_t>(i - 1 + p) * columns_ + (j - 1)) * 2];
    const double x = wv.w[0] * row[0] + wv.w[1] * row[2] + wv.w[2] * row[4] + wv.w[3] * row[6];
    const double y = wv.w[0] * row[1] + wv.w[1] * row[3] + wv.w[2] * row[5] + wv.w[3] * row[7];
    bx += wu.w[p] * x;
    by += wu.w[p] * y;
  }
  return {bx, point_m.y() < 0.0 ? -by : by};
}

std::shared_ptr<const FieldTable> make_field_table(const CoilGeometry& geometry, double dish_radius_m,
                                                   double margin_m, double spacing_m) {
  const double free_m = dish_radius_m + 0.5e-3;
  return std::make_shared<const FieldTable>(geometry, free_m + margin_m, spacing_m, free_m);
}

}  // namespace lodestone::physics
