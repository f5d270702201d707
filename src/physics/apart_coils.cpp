#include "lodestone/physics/apart_coils.h"

#include <cmath>

namespace lodestone::physics {

ApartCoils::ApartCoils(const CoilsDescription& coils) {
  for (std::size_t coil = 0; coil < coils.count(); ++coil)
    for (std::size_t other = coil + 1; other < coils.count(); ++other)
      if (coils.apart(coil, other)) pairs_.emplace_back(coil, other);
}

void ApartCoils::keep(PerCoil& current_A) const {
  for (const auto& [one, other] : pairs_)
    current_A[std::abs(current_A[one]) < std::abs(current_A[other]) ? one : other] = 0.0;
}

}  // namespace lodestone::physics
