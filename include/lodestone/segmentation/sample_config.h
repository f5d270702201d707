#pragma once

#include <cstdint>

namespace lodestone::segmentation {

/// What the rendered training images hold.
struct SampleConfig {
  std::int64_t frames_per_scene = 12;
  std::int64_t crop_px = 256;
  double elsewhere = 0.1;
  double none = 0.05;
  double two = 0.06;
  double covered = 0.45;
  double max_covered = 0.45;
  double moving = 0.1;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("frames_per_scene", frames_per_scene, "", "images of one scene", {1, 10000});
    v.field("crop_px", crop_px, "px", "side of a training image, in pixels of the view", {32, 4096});
    v.field("elsewhere", elsewhere, "", "fraction of images cut anywhere in the dish, not around the needle",
            {0.0, 1.0});
    v.field("none", none, "", "fraction of images without a needle", {0.0, 1.0});
    v.field("two", two, "", "fraction of images with two needles", {0.0, 1.0});
    v.field("covered", covered, "", "fraction of needles that are partly covered", {0.0, 1.0});
    v.field("max_covered", max_covered, "", "largest covered fraction of a needle", {0.0, 1.0});
    v.field("moving", moving, "", "fraction of needles that move during the exposure", {0.0, 1.0});
  }
};

}  // namespace lodestone::segmentation
