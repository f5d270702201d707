#include "symmetry.h"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <ATen/TensorOperators.h>
#include <ATen/ops/cat.h>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/common/log.h"
#include "lodestone/dynamics/network.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::dynamics {

using inference::Symmetry;

namespace {

constexpr int kQuarters = 4;

bool all_alike(const std::vector<double>& numbers) {
  return std::adjacent_find(numbers.begin(), numbers.end(), std::not_equal_to<>()) == numbers.end();
}

/// Empty: a rig that is described so looks the same from four sides, but for how its coils are wound where it
/// need not be `exact`; else why it does not.
std::string why_not_square(const data::DatasetInfo& info, bool exact) {
  if (info.action_size != 2)
    return "drives of " + std::to_string(info.action_size) + " numbers do not turn with the dish";
  const auto rig = common::config_from_json<physics::RigDescription>(physics::completed_rig(info.rig),
                                                                     "the recording's rig");
  if (rig.drive.kind != physics::DriveKind::kOpposedPairs)
    return "its coils are no opposed pairs along x and y (drive.kind)";
  if (exact && (!all_alike(rig.coils.resistance_20C_ohm) || !all_alike(rig.coils.inductance_H)))
    return "its four coils differ (coils.resistance_20C_ohm, coils.inductance_H)";
  return "";
}

}  // namespace

Symmetry symmetry_of(Symmetry asked, bool exact, const data::DatasetInfo& info, const std::string& key) {
  if (asked == Symmetry::kNone) return asked;
  const bool known = info.rig.is_object() && !info.rig.empty();
  if (asked == Symmetry::kDescribed) {
    const std::string why_not = known ? why_not_square(info, exact) : "the recording carries no rig.json";
    common::log_info(key + " = \"described\": " + (why_not.empty() ? "square" : "none, as " + why_not));
    return why_not.empty() ? Symmetry::kSquare : Symmetry::kNone;
  }
  // Where nobody has described the rig, it is believed.
  const std::string why_not = known || info.action_size != 2 ? why_not_square(info, exact) : "";
  if (!why_not.empty())
    throw common::ConfigError(
        key + " = \"square\": the recorded rig does not look the same from four sides: " + why_not +
        "; say none, or described");
  return asked;
}

int ways_of(Symmetry symmetry) { return symmetry == Symmetry::kSquare ? 2 * kQuarters : 1; }

at::Tensor seen(const at::Tensor& rows, int way) {
  if (way == 0) return rows;
  const bool mirrored = way >= kQuarters;
  const int quarters = way % kQuarters;
  at::Tensor x = rows.narrow(1, 0, 1);
  at::Tensor y = rows.narrow(1, 1, 1);
  if (mirrored) y = -y;
  for (int k = 0; k < quarters; ++k) {
    const at::Tensor was_x = x;
    x = -y;
    y = was_x;
  }
  if (rows.size(1) == 2) return at::cat({x, y}, 1);
  const at::Tensor heading = rows.narrow(1, 2, 1);
  return at::cat({x, y, wrap_angles((mirrored ? -heading : heading) + 0.5 * geometry::kPi * quarters)}, 1);
}

}  // namespace lodestone::dynamics
