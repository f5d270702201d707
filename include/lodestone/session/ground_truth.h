#pragma once

#include "lodestone/common/config.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::session {

/// What only a virtual rig can tell, and what only it can do: be put back.
class GroundTruth {
 public:
  virtual ~GroundTruth() = default;
  /// Where the needle really is: for scoring only.
  virtual geometry::Pose2 true_pose() const = 0;
  /// Everything that changes, between two episodes; going on after load() is bitwise as if never stopped.
  /// load() throws DataError when the state is malformed.
  virtual common::Json save() const = 0;
  virtual void load(const common::Json& state) = 0;
};

}  // namespace lodestone::session
