#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/control/pose_sensor.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/field_table.h"
#include "lodestone/physics/four_coils.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/rig/coils.h"
#include "lodestone/rig/rig_config.h"

namespace lodestone::session {

/// One way in which the coils may be connected: who asks for coil i gets coil `coil[i]`, with its field
/// turned round where `sign[i]` is -1.
struct CoilWiring {
  std::array<int, physics::kFourCoils> coil{0, 1, 2, 3};
  std::array<int, physics::kFourCoils> sign{1, 1, 1, 1};

  bool operator==(const CoilWiring& other) const { return coil == other.coil && sign == other.sign; }
};

/// All 384: every order of the four coils with every polarity.
std::vector<CoilWiring> every_coil_wiring();

/// What one pulse of one coil did to the needle, as a sensor saw it.
struct ProbePulse {
  int asked = 0;           ///< coil that was asked for
  double current_A = 0.0;  ///< as asked
  geometry::Pose2 before;
  geometry::Pose2 after;
};

/// Which wirings the needle's motion leaves possible. A coil's field turns the needle, so the heading tells
/// the field's direction; but +x and a reversed -x make the same field at the centre. What tells them apart
/// is that a needle that has turned into the field is drawn towards the coil. Only directions are held
/// against the coils' field: how far the needle moves depends on friction that nobody knows.
class WiringInference {
 public:
  /// `rig` as it is described; `table`: its field, made by field_for().
  WiringInference(const physics::RigDescription& rig, std::shared_ptr<const physics::FieldTable> table);
  static std::shared_ptr<const physics::FieldTable> field_for(const physics::RigDescription& rig);

  /// False, and nothing learned, where the pulse moved nothing.
  bool add(const ProbePulse& pulse);

  /// In the order of every_coil_wiring(); all of them before the first motion.
  std::vector<CoilWiring> possible() const;
  /// Pulses of that coil after which the needle lay elsewhere.
  int moved(int asked) const { return moved_[static_cast<std::size_t>(asked)]; }
  /// Whether the most likely wiring explains what was seen; if not, what was seen is no needle in the field
  /// of four coils.
  bool explained() const;
  double dish_radius_m() const { return dish_radius_m_; }

 private:
  /// Whether both ends of the needle lie within this radius.
  bool within(const geometry::Pose2& pose, double radius_m) const;
  double least_against() const;
  double against(const CoilWiring& wiring) const;

  physics::CoilArray coils_;
  physics::NeedleConfig needle_;
  double dish_radius_m_;
  /// Evidence against (log-likelihood, up to a constant) coil c with sign +, - in the place of each coil.
  std::array<std::array<std::array<double, 2>, physics::kFourCoils>, physics::kFourCoils> against_{};
  std::array<int, physics::kFourCoils> moved_{};
};

/// Pulses that find out about the wiring.
struct WiringProbe {
  double current_A = 4.0;       ///< of the first pulses
  double max_current_A = 10.0;  ///< where the needle sticks, the current grows up to this
  double pulse_s = 0.06;
  double rest_s = 0.4;
  int max_pulses = 240;
};

/// Pulses one coil after the other, and watches the needle, until one wiring is left, the pulses are used up,
/// or the needle has stuck at the largest current. Once a coil is known it serves to draw the needle back
/// from the wall. Throws HardwareError.
void probe_wiring(WiringInference& inference, rig::Coils& coils, control::PoseSensor& sensor,
                  common::Clock& clock, const WiringProbe& probe);

/// What may answer in the place of coil `asked`: "coil +x, or coil -x reversed".
std::string possible_answers(const std::vector<CoilWiring>& possible, int asked);

/// What to do, in one line; empty where every coil is known to answer as asked on `rig`.
std::string wiring_remedy(const WiringInference& inference, const rig::RigConfig& rig);

/// The rig's configuration under which every coil answers as asked, when `found` is what happens under `rig`:
/// its serial.output and coils.polarity.
rig::RigConfig rewired(rig::RigConfig rig, const CoilWiring& found);

}  // namespace lodestone::session
