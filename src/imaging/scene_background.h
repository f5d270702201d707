#pragma once

#include <opencv2/core/mat.hpp>

#include "lodestone/imaging/scene.h"

namespace lodestone::imaging {

/// What stays in a scene from frame to frame, painted once. All of the image's size, lit and blurred as the
/// camera sees it.
struct SceneLayers {
  cv::Mat
      floor_m;    ///< [H, W] 2 x float: point of the floor plane at each pixel, through the fluid, dish frame
  cv::Mat under;  ///< [H, W] 8-bit BGR: all that lies below a needle
  cv::Mat over;   ///< [H, W] 8-bit BGR, times its opacity: threads and bubbles above a needle
  cv::Mat over_alpha;  ///< [H, W] 8 bit: their opacity
  cv::Mat glare;       ///< [H, W] 8 bit: light reflected by the fluid's surface, added to everything below
  cv::Mat plain;       ///< [H, W] 8-bit BGR: the image without a needle
};

SceneLayers paint_layers(const Scene& scene);

/// Light that reaches the camera from a white surface at a pixel: brightness and vignetting.
float light_at(const Scene& scene, double u_px, double v_px);

/// `under`, then `over` on it, then the glare, for one area of the image; `under` and `image` are of the
/// area's size.
void compose(const SceneLayers& layers, const cv::Mat& under, const cv::Rect& area, cv::Mat& image);

}  // namespace lodestone::imaging
