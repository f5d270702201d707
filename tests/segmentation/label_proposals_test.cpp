#include "lodestone/segmentation/label_proposals.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "segmentation/own_frames.h"

using namespace lodestone;

TEST_CASE("a needle that moves is labelled whatever it looks like, head and all") {
  const tests::OwnFrames own = tests::own_frames(24);
  const segmentation::FrameLabels labels = segmentation::propose_labels(own.frames, own.bench);
  REQUIRE(labels.labels.size() == 24);
  CHECK(labels.taped);
  int told = 0, turned = 0;
  for (std::size_t i = 0; i < 24; ++i) {
    const segmentation::FrameLabel& label = labels.labels[i];
    CHECK(label.frame == own.frames.names[i]);
    if (!label.pose) {
      CHECK(label.reason.value_or("") != "");
      continue;
    }
    ++told;
    CHECK((label.pose->position_m() - own.truth[i].position_m()).norm() < 0.5e-3);
    const double off_rad = geometry::wrap_angle(label.pose->heading_rad - own.truth[i].heading_rad);
    if (std::abs(off_rad) > 0.5 * geometry::kPi) ++turned;
    CHECK(std::abs(std::sin(off_rad)) < 0.05);
  }
  CHECK(told >= 21);
  CHECK(turned <= 1);
}

TEST_CASE("where nothing moves, nothing is labelled, and it is said why") {
  tests::OwnFrames own = tests::own_frames(1);
  for (int i = 0; i < 9; ++i) {
    own.frames.images.push_back(own.frames.images.front());
    own.frames.names.push_back("the same");
  }
  for (const segmentation::FrameLabel& label : segmentation::propose_labels(own.frames, own.bench).labels) {
    CHECK_FALSE(label.pose);
    CHECK(label.doubt == 1.0);
    CHECK(label.reason.value_or("") == "no needle in view");
  }
}

TEST_CASE("of a needle without a tape the ends look alike") {
  const tests::OwnFrames own = tests::own_frames(16, /*taped=*/false);
  const segmentation::FrameLabels labels = segmentation::propose_labels(own.frames, own.bench);
  int told = 0;
  for (const segmentation::FrameLabel& label : labels.labels) told += label.pose ? 1 : 0;
  CHECK(told > 8);
  CHECK_FALSE(labels.taped);
}
