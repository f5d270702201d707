#include "lodestone/segmentation/frame_labels.h"

#include <catch2/catch.hpp>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "temporary_folder.h"

using namespace lodestone;
using segmentation::FrameLabels;

namespace {

FrameLabels three() {
  FrameLabels labels;
  labels.labels.resize(3);
  labels.labels[0] = {"a", segmentation::LabelledPose{{0.01, -0.02, 0.5}}, std::nullopt, 0.1, false};
  labels.labels[1] = {"b", std::nullopt, "no needle in view", 1.0, false};
  labels.labels[2] = {"c", segmentation::LabelledPose{{0.0, 0.0, 3.0}}, std::nullopt, 0.4, true};
  return labels;
}

}  // namespace

TEST_CASE("the doubtful are looked through first") {
  CHECK(segmentation::doubtful(three(), 2) == std::vector<std::size_t>{1, 2});
  CHECK(segmentation::doubtful(three(), 9).size() == 3);
}

TEST_CASE("labels come back from their file, and those of other images are refused") {
  const tests::TemporaryFolder folder;
  const std::string file = folder / "labels.json";
  common::write_artefact(file, three());
  const FrameLabels back = segmentation::read_labels(file, {"a", "b", "c"});
  CHECK(back.labels[0].pose->heading_rad == 0.5);
  CHECK_FALSE(back.labels[1].pose);
  CHECK(back.labels[2].by_person);
  CHECK_THROWS_WITH(segmentation::read_labels(file, {"a", "b"}),
                    Catch::Contains("has 3 labels, and there are 2"));
  CHECK_THROWS_WITH(segmentation::read_labels(file, {"a", "d", "c"}),
                    Catch::Contains("label 1 is of b, the image is d"));
}
