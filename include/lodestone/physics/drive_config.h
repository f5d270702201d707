#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/common/config.h"

namespace lodestone::physics {

/// What the numbers of an action are for the coils. kOpposedPairs: the paper's, each the current of one of
/// two coils that face each other (section IV-B3). kIndependent: each the current of one coil. kField: a
/// field at the needle and a pull on it, which currents of all coils make together.
enum class DriveKind { kOpposedPairs, kIndependent, kField };
inline std::vector<std::string> names_of(DriveKind) { return {"opposed_pairs", "independent", "field"}; }

struct DriveConfig {
  DriveKind kind = DriveKind::kOpposedPairs;
  std::int64_t field_numbers = 2;
  double field_share = 1.0;  // D: with less, the field fades away from the centre; more leaves less pull

  template <class Visitor>
  void visit(Visitor& v) {
    v.field(
        "kind", kind, "",
        "opposed_pairs: four coils, each axis of the action drives one of two that face each other; "
        "independent: "
        "any coils, each number of the action drives one; field: any coils, the action is field and pull at "
        "the needle");
    v.field("field_numbers", field_numbers, "",
            "of field, the numbers of an action: 2, a direction for both, and how strong; 3, the field, and "
            "the pull "
            "along it, backwards where it is negative; 4, the field, and the pull",
            {2, 4});
    v.field("field_share", field_share, "",
            "of field: the field that an action of 1 asks for, as a share of what the strongest coil makes "
            "at the dish centre",
            {0.0, 10.0});
  }
};

}  // namespace lodestone::physics
