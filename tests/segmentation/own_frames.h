#pragma once

#include <string>
#include <vector>

#include "lodestone/imaging/scene_renderer.h"
#include "lodestone/segmentation/label_proposals.h"
#include "lodestone/segmentation/samples.h"
#include "paper_scenes.h"

namespace lodestone::tests {

/// Images of a needle with orange tape on one bench, and where it lies.
struct OwnFrames {
  imaging::BenchGeometry bench;
  segmentation::FrameViews frames;
  std::vector<geometry::Pose2> truth;
};

inline OwnFrames own_frames(int count) {
  imaging::SceneConfig scenes = paper_scenes();
  scenes.tape_hue_deg = {22.0, 28.0};
  const imaging::SceneRenderer renderer(imaging::draw_scene(scenes, 4));
  OwnFrames own{scenes.bench, {{renderer.scene().camera, scenes.bench.dish_radius_m, 2.3e-3, 0.2e-3, 16}, {}, {}}, {}};
  common::RandomStream random(2, "own frames");
  for (int i = 0; i < count; ++i) {
    own.truth.push_back(segmentation::draw_needle_pose(own.bench, random));
    const cv::Mat image = renderer.render({{own.truth.back()}}, random).image;
    own.frames.images.push_back(own.frames.view.cut(image, own.frames.view.whole()));
    own.frames.names.push_back("image " + std::to_string(i));
  }
  return own;
}

}  // namespace lodestone::tests
