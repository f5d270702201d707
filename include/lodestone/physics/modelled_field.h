#pragma once

#include <memory>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_fields.h"
#include "lodestone/physics/dipole_coil.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::physics {

/// The field as classical controllers and the plain simulator know it. Of the paper's four coils it is that
/// of point dipoles (section IV-C); coils that are listed have their exact one, as they may stand closer than
/// a dipole is good for. Copies share what they hold.
class ModelledField {
 public:
  explicit ModelledField(const RigDescription& rig);

  /// Field (T) and gradient (T/m) in the needle's plane. Places outside the dish count as the nearest one
  /// inside, where the coils are listed.
  FieldGradient at(const PerCoil& current_A, const geometry::Vector2& point_m) const;

 private:
  void add_background(const geometry::Vector2& here_m, FieldGradient& sum) const;

  std::vector<DipoleCoil> dipoles_;
  std::shared_ptr<const CoilFields> exact_;  ///< null: the dipoles
  double reach_m_ = 0.0;
};

}  // namespace lodestone::physics
