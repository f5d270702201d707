#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/imaging/scene.h"

namespace lodestone::imaging {

/// A needle in the image. Its pose is that of its middle, in the dish frame.
struct NeedleView {
  geometry::Pose2 pose;
  geometry::Vector2 smear_m = geometry::Vector2::Zero();  ///< way during the exposure
  double covered = 0.0;  ///< fraction of its length under a stain or another opaque thing
};

struct RenderedFrame {
  cv::Mat image;  ///< [height, width] 8-bit BGR
  /// [height, width] 8 bit, 255 where a pixel is wholly needle, covered parts included. Empty unless asked
  /// for.
  cv::Mat needle_mask;
  cv::Mat tape_mask;  ///< likewise, the taped head alone
};

/// Paints top views of one scene. Everything that stays (dish, fluid, coils, glare, distractors) is painted
/// once; a frame adds needles, what covers them, and the sensor's noise. Const calls may run on several
/// threads.
class SceneRenderer {
 public:
  explicit SceneRenderer(const Scene& scene);
  ~SceneRenderer();
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  /// `random` draws what covers the needles, and the noise.
  RenderedFrame render(const std::vector<NeedleView>& needles, common::RandomStream& random,
                       bool with_masks = false) const;

  const Scene& scene() const;

 private:
  struct Background;
  std::unique_ptr<Background> background_;
};

}  // namespace lodestone::imaging
