#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "lodestone/physics/coils_description.h"
#include "lodestone/physics/per_coil.h"

namespace lodestone::physics {

/// The coils of a rig of which only one may be on.
class ApartCoils {
 public:
  ApartCoils() = default;
  explicit ApartCoils(const CoilsDescription& coils);

  /// Of two that are on, and may not be together, the weaker goes off.
  void keep(PerCoil& current_A) const;

 private:
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
};

}  // namespace lodestone::physics
