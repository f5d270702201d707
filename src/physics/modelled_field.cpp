#include "lodestone/physics/modelled_field.h"

namespace lodestone::physics {
namespace {

constexpr double kTableSpacing_m = 2e-3;  // of the table: a model needs no finer one
constexpr double kSlope_m = 0.5e-3;

}  // namespace

ModelledField::ModelledField(const RigDescription& rig) {
  if (rig.coils.each.empty())
    dipoles_ = dipole_coils(rig.coils);
  else
    exact_ = CoilFields::shared(rig.coils, rig.dish.radius_m, 0.0, kTableSpacing_m);
  reach_m_ = rig.dish.radius_m - kSlope_m;
}

FieldGradient ModelledField::at(const PerCoil& current_A, const geometry::Vector2& point_m) const {
  FieldGradient sum;
  for (std::size_t coil = 0; coil < dipoles_.size(); ++coil)
    if (current_A[coil] != 0.0) dipoles_[coil].add(current_A[coil], point_m, sum);
  if (!exact_) return sum;
  const double distance_m = point_m.norm();
  const geometry::Vector2 here_m =
      distance_m > reach_m_ ? geometry::Vector2(point_m * (reach_m_ / distance_m)) : point_m;
  const auto field_T = [&](std::size_t coil, const geometry::Vector2& step_m) {
    return geometry::Vector2(exact_->per_ampere(coil, here_m + step_m).head<2>());
  };
  add_background(here_m, sum);
  for (std::size_t coil = 0; coil < exact_->coils(); ++coil) {
    if (current_A[coil] == 0.0) continue;
    sum.field_T += current_A[coil] * field_T(coil, {0.0, 0.0});
    for (int axis = 0; axis < 2; ++axis) {
      const geometry::Vector2 step_m = kSlope_m * geometry::Vector2::Unit(axis);
      sum.gradient_T_per_m.col(axis) +=
          current_A[coil] / (2.0 * kSlope_m) * (field_T(coil, step_m) - field_T(coil, -step_m));
    }
  }
  return sum;
}

/// What is there without current, of coils that were measured.
void ModelledField::add_background(const geometry::Vector2& here_m, FieldGradient& sum) const {
  sum.field_T += exact_->background_T(here_m).head<2>();
  for (int axis = 0; axis < 2; ++axis) {
    const geometry::Vector2 step_m = kSlope_m * geometry::Vector2::Unit(axis);
    sum.gradient_T_per_m.col(axis) +=
        (exact_->background_T(here_m + step_m) - exact_->background_T(here_m - step_m)).head<2>() /
        (2.0 * kSlope_m);
  }
}

}  // namespace lodestone::physics
