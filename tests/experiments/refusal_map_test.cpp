#include "lodestone/experiments/refusal_map.h"

#include <catch2/catch.hpp>
#include <string>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"

using namespace lodestone;

namespace {

control::PoseEstimate pose_at(double x_m, double heading_rad) {
  control::PoseEstimate estimate;
  estimate.valid = true;
  estimate.pose = {x_m, 0.001, heading_rad};
  return estimate;
}

control::PoseEstimate no_pose(const std::string& reason) {
  control::PoseEstimate estimate;
  estimate.reason = reason;
  return estimate;
}

}  // namespace

TEST_CASE("looks without a pose count where and how the needle is seen next") {
  experiments::RefusalMap map(0.04);
  CHECK(map.figures().share.n == 0);
  CHECK_FALSE(map.figures().share.interval);
  map.add(no_pose("glare"));
  map.add(no_pose("glare"));
  map.add(pose_at(0.001, 0.1));
  map.add(pose_at(0.001, 0.1));
  map.add(pose_at(0.030, 2.0));
  map.add(no_pose("two needles"));  // nobody knows where

  const runs::RefusalFigures figures = map.figures();
  CHECK(figures.share.n == 6);
  CHECK(figures.share.value == Approx(0.5));
  REQUIRE(figures.share.interval);
  CHECK(figures.share.interval->at(0) < 0.5);
  CHECK(figures.cell_mm == Approx(8.0));
  REQUIRE(figures.cells.size() == 2);
  CHECK(figures.cells[0].x_mm == Approx(4.0));
  CHECK(figures.cells[0].y_mm == Approx(4.0));
  CHECK(figures.cells[0].looks == 4);
  CHECK(figures.cells[0].refused == 2);
  CHECK(figures.cells[1].x_mm == Approx(28.0));
  CHECK(figures.cells[1].refused == 0);
  REQUIRE(figures.headings.size() == 12);
  std::int64_t looks = 0, refused = 0;
  for (const runs::RefusalBin& bin : figures.headings) {
    looks += bin.looks;
    if (bin.refused == 0) continue;
    refused += bin.refused;
    CHECK(bin.heading_from_deg == Approx(0.0).margin(1e-9));
  }
  CHECK(looks == 5);
  CHECK(refused == 2);
  CHECK(figures.reasons.at("glare") == 2);
}

TEST_CASE("reasons that hold numbers do not fill the result") {
  experiments::RefusalMap map(0.04);
  for (int i = 0; i < 100; ++i) map.add(no_pose("off by " + std::to_string(i) + " mm"));
  CHECK(map.figures().reasons.size() <= 21);
  CHECK(map.figures().reasons.at("other reasons") == 80);
}

TEST_CASE("counts go on from a file as if never stopped") {
  experiments::RefusalMap whole(0.04), first(0.04), second(0.04);
  for (experiments::RefusalMap* map : {&whole, &first}) {
    map->add(pose_at(-0.030, 0.1));
    map->add(no_pose("glare"));  // counts where the needle is seen next
  }
  const common::Json kept = common::artefact_to_json(first.counts());
  second.restore(common::artefact_from_json<experiments::RefusalCounts>(kept, "kept"));
  for (experiments::RefusalMap* map : {&whole, &second}) map->add(pose_at(0.020, 2.0));
  CHECK(common::artefact_to_json(second.counts()) == common::artefact_to_json(whole.counts()));
  CHECK(second.figures().cells.size() == 2);
  CHECK(second.figures().cells[1].refused == 1);
  CHECK_THROWS_AS(second.restore({}), common::DataError);
}
