#pragma once

#include <string>
#include <vector>

#include "lodestone/imaging/scene_renderer.h"
#include "lodestone/segmentation/label_proposals.h"
#include "lodestone/segmentation/needle_pose.h"
#include "paper_scenes.h"

namespace lodestone::tests {

/// Images of a needle on one bench, with orange tape or without any, and where it lies.
struct OwnFrames {
  imaging::BenchGeometry bench;
  segmentation::FrameViews frames;
  std::vector<geometry::Pose2> truth;
};

inline OwnFrames own_frames(int count, bool taped = true) {
  imaging::SceneConfig scenes = paper_scenes();
  scenes.tape_hue_deg = {22.0, 28.0};
  imaging::Scene scene = imaging::draw_scene(scenes, 4);
  if (!taped) {
    const auto steel = static_cast<float>(scene.needle_grey);
    scene.tape = {steel, steel, steel};
    scene.needle_shine = 0.0;  // on tape it would be weaker
  }
  const imaging::SceneRenderer renderer(scene);
  OwnFrames own{scenes.bench, {{scene.camera, scenes.bench.dish_radius_m, 2.3e-3, 0.2e-3, 16}, {}, {}}, {}};
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
