#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "lodestone/common/random.h"
#include "lodestone/imaging/bench.h"
#include "lodestone/imaging/scene_renderer.h"
#include "lodestone/rig/camera.h"
#include "lodestone/rig/virtual_rig.h"

namespace lodestone::rig {

/// Sizes of what a camera over this rig sees, as far as its description tells.
imaging::BenchGeometry bench_of(const physics::RigDescription& rig);
/// The same with the obstacles that the virtual rig hides: for those who render it, and nobody else.
imaging::BenchGeometry rendered_bench_of(const VirtualRigConfig& rig);

/// The virtual rig's own camera. An image takes the scene's exposure on the rig's clock, and what moves
/// meanwhile is smeared; its stamp is the middle of the exposure.
class RenderedCamera final : public Camera {
 public:
  /// `rig` must outlive the camera; the renderer may be shared. `noise` draws the sensor's noise. `clock` is
  /// what moves the rig's time where the rig does not do so itself.
  RenderedCamera(VirtualRig& rig, std::shared_ptr<const imaging::SceneRenderer> renderer,
                 common::RandomStream noise, common::Clock* clock = nullptr);
  /// Throws HardwareError when the exposure is longer than `timeout_s`.
  imaging::Frame grab(double timeout_s) override;

  /// State of the noise stream, for bitwise resumption.
  std::string save() const;
  void restore(const std::string& state);

 private:
  VirtualRig& rig_;
  common::Clock& clock_;
  std::shared_ptr<const imaging::SceneRenderer> renderer_;
  mutable std::mutex mutex_;  // of the noise
  common::RandomStream noise_;
};

}  // namespace lodestone::rig
