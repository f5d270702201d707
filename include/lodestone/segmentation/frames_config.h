#pragma once

#include <cstdint>
#include <string>

namespace lodestone::segmentation {

/// Images of a laboratory's own needle, to learn from beside rendered ones.
struct FramesConfig {
  std::string source;
  std::string calibration;
  std::string labels;
  std::string from;
  std::int64_t count = 200;
  std::int64_t corrected = 20;
  std::int64_t crops = 8;
  double held_back = 0.25;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("source", source, "",
            "video, folder or pattern of images of the needle; empty: rendered ones only");
    v.field("calibration", calibration, "",
            "calibration.json of the camera; empty: it is found in the first image");
    v.field("labels", labels, "",
            "labels.json of these images, looked through by a person; accept: as they are proposed");
    v.field("from", from, "", "segmenter checkpoint that goes on learning; empty: the one that is shipped");
    v.field("count", count, "", "images that are used, evenly over all there are", {8, 2000});
    v.field("corrected", corrected, "", "labels that a person is asked to look through, the doubtful first",
            {0, 200});
    v.field("crops", crops, "", "training images that are cut out of each", {1, 100});
    v.field("held_back", held_back, "", "share of the images, the last ones, that are only looked at",
            {0.05, 0.9});
  }
};

}  // namespace lodestone::segmentation
