#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/control/pose_sensor.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/coil_fields.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/rig/coils.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/session/wiring_evidence.h"

namespace lodestone::session {

/// What one pulse of one coil did to the needle, as a sensor saw it.
struct ProbePulse {
  int asked = 0;           ///< coil that was asked for
  double current_A = 0.0;  ///< as asked
  geometry::Pose2 before;
  geometry::Pose2 after;
};

/// Which wirings the needle's motion leaves possible. A coil's field turns the needle, so the heading tells
/// the field's direction; but a coil and the one across from it, reversed, make the same field at the centre.
/// What tells them apart is that a needle that has turned into the field is drawn towards the coil. Only
/// directions are held against the coils' field: how far the needle moves depends on friction that nobody
/// knows.
class WiringInference {
 public:
  /// `rig` as it is described; `fields`: those of its coils, made by field_for().
  WiringInference(const physics::RigDescription& rig, std::shared_ptr<const physics::CoilFields> fields);
  static std::shared_ptr<const physics::CoilFields> field_for(const physics::RigDescription& rig);

  /// False, and nothing learned, where the pulse moved nothing.
  bool add(const ProbePulse& pulse);

  /// All of them before the first motion.
  PossibleWirings possible() const;
  std::size_t coils() const { return evidence_.coils(); }
  /// Pulses of that coil after which the needle lay elsewhere.
  int moved(int asked) const { return moved_[static_cast<std::size_t>(asked)]; }
  /// Whether the most likely wiring explains what was seen; if not, what was seen is no needle in the field
  /// of these coils.
  bool explained() const;
  double dish_radius_m() const { return dish_radius_m_; }
  /// Unit vector from the dish centre to a coil, seen from above; zero where it is above or below the centre.
  const geometry::Vector2& direction(std::size_t coil) const { return directions_[coil]; }
  /// Coils in the order to ask in: crossing_order().
  const std::vector<int>& order() const { return order_; }

 private:
  /// Whether both ends of the needle lie within this radius.
  bool within(const geometry::Pose2& pose, double radius_m) const;

  physics::CoilArray coils_;
  physics::NeedleConfig needle_;
  double dish_radius_m_;
  std::vector<geometry::Vector2> directions_;  // [coils]
  std::vector<int> order_;                     // [coils]
  WiringEvidence evidence_;
  std::vector<int> moved_;  // [coils]
};

/// The coils in an order in which each field at the dish centre lies across the one before, as far as there
/// are such, so that the needle has to turn: the paper's +x, +y, -x, -y.
std::vector<int> crossing_order(const physics::RigDescription& rig);

/// Pulses that find out about the wiring.
struct WiringProbe {
  double current_A = 4.0;       ///< of the first pulses
  double max_current_A = 10.0;  ///< where the needle sticks, the current grows up to this
  double pulse_s = 0.06;
  double rest_s = 0.4;
  int max_pulses_each = 60;  ///< times the coils: in all
};

/// Pulses one coil after the other, and watches the needle, until one wiring is left, the pulses are used up,
/// or the needle has stuck at the largest current. Once a coil is known it serves to draw the needle back
/// from the wall. Throws HardwareError.
void probe_wiring(WiringInference& inference, rig::Coils& coils, control::PoseSensor& sensor,
                  common::Clock& clock, const WiringProbe& probe);

/// What may answer in the place of coil `asked`: "coil +x, or coil -x reversed".
std::string possible_answers(const PossibleWirings& possible, int asked,
                             const physics::CoilsDescription& coils);

/// What to do, in one line; empty where every coil is known to answer as asked on `rig`.
std::string wiring_remedy(const WiringInference& inference, const rig::RigConfig& rig);

/// The rig's configuration under which every coil answers as asked, when `found` is what happens under `rig`:
/// its serial.output and coils.polarity.
rig::RigConfig rewired(rig::RigConfig rig, const CoilWiring& found);

}  // namespace lodestone::session
