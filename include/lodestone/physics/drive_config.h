#pragma once

#include <string>
#include <vector>

namespace lodestone::physics {

/// What the two numbers of an action are for the coils. kOpposedPairs: the paper's, each the current of one
/// of two coils that face each other (section IV-B3). kField: a field at the needle and a pull along it,
/// which currents of all coils make together.
enum class DriveKind { kOpposedPairs, kField };
inline std::vector<std::string> names_of(DriveKind) { return {"opposed_pairs", "field"}; }

struct DriveConfig {
  DriveKind kind = DriveKind::kOpposedPairs;
  double field_share = 1.0;  // D: with less, the field fades away from the centre; more leaves less pull

  template <class Visitor>
  void visit(Visitor& v) {
    v.field(
        "kind", kind, "",
        "opposed_pairs: four coils, each axis of the action drives one of two that face each other; field: "
        "any coils, the action is the direction of field and pull at the needle, and how strong");
    v.field("field_share", field_share, "",
            "of field: the field that an action of 1 asks for, as a share of what the strongest coil makes "
            "at the dish centre",
            {0.0, 10.0});
  }
};

}  // namespace lodestone::physics
