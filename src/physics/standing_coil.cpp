#include "lodestone/physics/standing_coil.h"

#include "lodestone/common/error.h"

namespace lodestone::physics {

StandingCoil::StandingCoil(const CoilDescription& coil)
    : coil_(coil), exact_(static_cast<const CoilWinding&>(coil)) {
  coil.validate();
  middle_m_ = coil.middle_m();
  axis_ = coil.unit_axis();
}

Eigen::Vector3d StandingCoil::per_ampere(const Eigen::Vector3d& point_m) const {
  constexpr double kOnAxis_m = 1e-9;
  const Eigen::Vector3d from_m = point_m - middle_m_;
  const double axial_m = from_m.dot(axis_);
  const Eigen::Vector3d outwards_m = from_m - axial_m * axis_;
  const double radial_m = outwards_m.norm();
  const AxialRadial field = exact_.per_ampere(axial_m, radial_m);
  if (radial_m < kOnAxis_m) return coil_.gain * field.axial * axis_;
  return coil_.gain * (field.axial * axis_ + field.radial / radial_m * outwards_m);
}

Eigen::Vector3d StandingCoil::beside_winding_per_ampere(geometry::Vector2 point_m) const {
  constexpr int kMostSteps = 400;
  for (int step = 0; coil_.winds_at({point_m.x(), point_m.y(), 0.0}, kClearOfWinding_m); ++step) {
    LODESTONE_CHECK(step < kMostSteps, "a winding outside the dish, not at its centre: " + coil_.name);
    point_m *= 0.98;
  }
  return per_ampere({point_m.x(), point_m.y(), 0.0});
}

}  // namespace lodestone::physics
