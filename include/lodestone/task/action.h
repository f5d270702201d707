#pragma once

#include <string>

#include "lodestone/common/config.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::task {

/// Section IV-B3: a 2-D action in [-1, 1]^2; the sign picks the coil of each axis, the magnitude times
/// `scale` is its drive. Opposite coils are never on together.
struct ActionConfig {
  double dead_band = 0.0;           ///< a weaker action gives no pulse
  bool one_axis_at_a_time = false;  ///< only the larger component acts (the recorded sphere's device)

  template <class Visitor>
  void visit(Visitor& v) {
    v.retired("scale", "rig.coils.max_current_A");
    v.field("dead_band", dead_band, "", "an action of less than this magnitude gives no pulse", {0.0, 1.0});
    v.field("one_axis_at_a_time", one_axis_at_a_time, "", "only the larger component acts");
  }

  /// Drive that 1 maps to, in `unit`. No key: it is the rig's largest current, or that of the data.
  double scale = 0.0;
  std::string unit = "A";  ///< "A", or "percent" of the rig's full drive
};

/// An action's meaning as checkpoints hold it, scale and unit included, and back. Throws ConfigError naming
/// `what`.
common::Json action_to_json(const ActionConfig& config);
ActionConfig action_from_json(common::Json json, const std::string& what);

/// Signed axis drives (x, y) of an action; components are clipped to [-1, 1] first.
geometry::Vector2 axis_drive(const geometry::Vector2& action, const ActionConfig& config);

}  // namespace lodestone::task
