#include "lodestone/physics/described_coil.h"

namespace lodestone::physics {

DescribedCoil::DescribedCoil(const CoilDescription& coil, const MeasuredRegion& measured)
    : coil_(coil), measured_(measured) {
  coil.validate();
  if (!coil.measured()) winding_.emplace(coil);
}

Eigen::Vector3d DescribedCoil::per_ampere(const Eigen::Vector3d& point_m) const {
  if (winding_) return winding_->per_ampere(point_m);
  measured_.check_holds(point_m);
  return coil_.gain * measured_.sum(coil_.harmonics_T_per_A, point_m);
}

Eigen::Vector3d DescribedCoil::in_plane_per_ampere(const geometry::Vector2& point_m) const {
  if (winding_) return winding_->beside_winding_per_ampere(point_m);
  return coil_.gain * measured_.sum(coil_.harmonics_T_per_A, {point_m.x(), point_m.y(), 0.0});
}

}  // namespace lodestone::physics
