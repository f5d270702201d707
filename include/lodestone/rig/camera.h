#pragma once

#include "lodestone/imaging/frame.h"

namespace lodestone::rig {

/// A source of images of the dish.
class Camera {
 public:
  virtual ~Camera() = default;
  /// The next image. Throws common::HardwareError when none comes within `timeout_s`.
  virtual imaging::Frame grab(double timeout_s) = 0;
};

}  // namespace lodestone::rig
