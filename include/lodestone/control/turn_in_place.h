#pragma once

#include <memory>

#include "lodestone/common/config.h"
#include "lodestone/control/controller.h"
#include "lodestone/control/driven_field.h"
#include "lodestone/control/inner_controller.h"

namespace lodestone::control {

/// How a needle that has come to its target is turned to the heading it should have.
struct TurnConfig {
  double current_A = 0.0;
  double max_current_A = 3.0;
  double growth = 1.25;
  double lead_deg = 70.0;
  double arrive_m = 0.0015;
  double leave_m = 0.0028;
  double heading_deg = 8.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.retired("coil", "rig.coils");
    v.field("current_A", current_A, "A",
            "turning begins with so much: friction holds a needle against pulls long after it has let it "
            "turn; 0 is "
            "off, and the controller turns the needle itself",
            {0.0, 1000.0});
    v.field("max_current_A", max_current_A, "A", "and grows to so much", {0.0, 1000.0});
    v.field("growth", growth, "", "factor on it for a pulse that did not turn the needle", {1.0, 10.0});
    v.field(
        "lead_deg", lead_deg, "deg",
        "the field points at most so far ahead of the needle: opposite to it, it would not turn it at all",
        {1.0, 180.0});
    v.field("arrive_m", arrive_m, "m", "turning begins within this of the target", {0.0, 0.1});
    v.field("leave_m", leave_m, "m", "beyond this of it the controller brings the needle back", {0.0, 0.1});
    v.field("heading_deg", heading_deg, "deg", "within this of the heading there is no current",
            {0.0, 180.0});
  }
};

/// Position first, heading then: lets the controller inside bring the needle to the target, and turns it
/// there by a field along the wanted heading, too weak to pull it far. Does nothing where the target has no
/// heading, and along a path: a needle that is turned in place comes late, so what is inside steers both.
class TurnInPlace final : public Controller {
 public:
  /// Knows the rig as it is described. `scale_A`: current that an action of 1 maps to.
  TurnInPlace(std::unique_ptr<Controller> inner, const TurnConfig& config, const physics::RigDescription& rig,
              double scale_A);
  void reset() override;
  geometry::Drive act(const task::Observation& observation) override;
  std::unique_ptr<Controller> clone() const override { return inner_.clone_of(*this); }

  /// Two numbers of size 1 (physics::CoilDrive::along) whose field at `position_m` points along
  /// `heading_rad`, as nearly as any does.
  geometry::Vector2 drive_along(double heading_rad, const geometry::Vector2& position_m) const;

 private:
  InnerController inner_;
  TurnConfig config_;
  double scale_A_;
  DrivenField field_;
  double current_A_ = 0.0;  // of the next turning pulse
  double last_error_deg_ = 0.0;
  bool arrived_ = false;
  bool turning_ = false;  // the last pulse was one
};

}  // namespace lodestone::control
