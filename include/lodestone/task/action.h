#pragma once

#include <string>

#include "lodestone/common/config.h"
#include "lodestone/common/random.h"
#include "lodestone/geometry/drive.h"

namespace lodestone::task {

/// What an action in [-1, 1]^k means: each number times `scale` is a number of the rig's drive. Section
/// IV-B3: two numbers, of which the sign picks the coil of each axis.
struct ActionConfig {
  double dead_band = 0.0;           ///< a weaker action gives no pulse
  bool one_axis_at_a_time = false;  ///< only the largest component acts (the recorded sphere's device)

  template <class Visitor>
  void visit(Visitor& v) {
    v.retired("scale", "rig.coils.max_current_A");
    v.field("dead_band", dead_band, "", "an action of less than this magnitude gives no pulse", {0.0, 1.0});
    v.field("one_axis_at_a_time", one_axis_at_a_time, "", "only the largest component acts");
  }

  /// Drive that 1 maps to, in `unit`. No key: it is the rig's largest current, or that of the data.
  double scale = 0.0;
  std::string unit = "A";  ///< "A", or "percent" of the rig's full drive
  /// Numbers of an action. No key: they are those of the rig's drive, or of the data.
  int size = 2;
};

/// An action's meaning as checkpoints hold it, scale, unit and size included, and back. Throws ConfigError
/// naming `what`.
common::Json action_to_json(const ActionConfig& config);
ActionConfig action_from_json(common::Json json, const std::string& what);

/// The drive that an action is; components are clipped to [-1, 1] first.
geometry::Drive drive_of(const geometry::Drive& action, const ActionConfig& config);

/// An action of `size` numbers in any direction, the largest of them log-uniform from `weakest` to 1:
/// friction lets a needle turn at a tenth of what moves it, and both are looked for alike.
geometry::Drive draw_action(int size, double weakest, common::RandomStream& random);
/// One near another: its strength by a factor of about exp(+-share), its direction by about `share` in rad.
geometry::Drive vary_action(const geometry::Drive& action, double share, common::RandomStream& random);

}  // namespace lodestone::task
