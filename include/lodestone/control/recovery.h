#pragma once

#include <cstdint>
#include <optional>

#include "lodestone/common/config.h"
#include "lodestone/control/dipole_pull.h"
#include "lodestone/control/driven_field.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::control {

/// What is tried when the needle is not seen.
struct RecoveryConfig {
  std::int64_t turning_probes = 4;
  std::int64_t pulling_probes = 2;
  double turn_A = 1.0;
  double turn_max_A = 1.5;
  double pull_A = 2.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("turning_probes", turning_probes, "",
            "weak pulses that turn a needle that is not seen, so that the image changes; 0 is off", {0, 4});
    v.field("pulling_probes", pulling_probes, "",
            "then so many towards the dish centre, where it was seen before", {0, 2});
    v.field("turn_A", turn_A, "A", "current of the first turns", {0.1, 2.0});
    v.field("turn_max_A", turn_max_A, "A", "and of the last ones", {0.1, 2.0});
    v.field("pull_A", pull_A, "A", "current of the pulls", {0.1, 2.0});
  }
};

/// Finds a needle that is not seen. While the coils are off it lies still, and what hides it (a reflection,
/// its shadow, a second thing that looks like a needle) goes on hiding it. So every other step without a pose
/// gets a weak pulse: fields 60 degrees to either side of where it pointed last turn it and hardly move it;
/// at last it is pulled towards the centre. The first such step waits: a hand may be in the way.
class Recovery {
 public:
  Recovery(const RecoveryConfig& config, const physics::RigDescription& rig);

  /// A new run: the needle was never seen.
  void reset();
  /// The needle is seen.
  void seen(const geometry::Pose2& pose);
  /// The drive in A to be tried at a step at which it is not, the n-th in a row; nothing: wait.
  std::optional<geometry::Drive> next_probe();

 private:
  geometry::Drive turn(std::int64_t index) const;
  std::optional<geometry::Drive> pull() const;

  RecoveryConfig config_;
  DrivenField field_;
  DipolePull pull_;
  std::optional<geometry::Pose2> last_;
  std::int64_t blind_ = 0;
};

}  // namespace lodestone::control
