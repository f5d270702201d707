#include "lodestone/safety/keep_out_check.h"

#include <catch2/catch.hpp>
#include <limits>

#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// A disc of 4 mm around (20, 0) mm, a needle of 20 mm by 1 mm, and a margin of 1 mm.
geometry::KeepOut one_disc() { return {{{"disc", {0.02, 0.0}, 0.004}}, 0.02, 0.001, 0.001}; }

}  // namespace

TEST_CASE("a needle within the margin of a zone, or nowhere, is not trusted") {
  safety::KeepOutCheck check(one_disc());
  control::PoseEstimate estimate;
  estimate.pose = {0.0044, 0.0, 0.0};  // its head 1.1 mm from the disc
  check.observe(estimate, 0.0);
  estimate.pose.x_m = 0.0046;  // 0.9 mm
  CHECK_THROWS_WITH(check.observe(estimate, 0.0),
                    Catch::Contains("keep-out zone disc") && Catch::Contains("margin of 1 mm"));
  estimate.pose.heading_rad = 0.5 * geometry::kPi;  // the same place, but its side towards the disc
  check.observe(estimate, 0.0);
  estimate.pose.heading_rad = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(check.observe(estimate, 0.0), safety::Distrust);
}

TEST_CASE("what the needle may lie nearer is added") {
  safety::KeepOutCheck check(one_disc());
  control::PoseEstimate estimate;
  estimate.pose = {0.0034, 0.0, 0.0};  // 2.1 mm
  check.observe(estimate, 0.0);
  SECTION("of its place") { estimate.position_sigma_m = 0.6e-3; }
  SECTION("of its heading") { estimate.heading_sigma_rad = 0.06; }
  CHECK_THROWS_AS(check.observe(estimate, 0.0), safety::Distrust);
}

TEST_CASE("zones move, and without any nothing is kept out of") {
  safety::KeepOutCheck check(one_disc());
  control::PoseEstimate estimate;
  estimate.pose = {-0.02, 0.0, 0.0};
  check.observe(estimate, 0.0);
  check.move_zones({{"wall", {-0.02, -0.01, -0.02, 0.01}, 0.0}});
  CHECK_THROWS_WITH(check.observe(estimate, 0.0), Catch::Contains("wall"));
  check.move_zones({});
  check.observe(estimate, 0.0);
}

TEST_CASE("zones of a file are kept out of beside the others, and one that cannot be read is not trusted") {
  const tests::TemporaryFolder folder;
  const std::string path = folder / "moving.json";
  common::write_file_atomically(path, R"({"keep_out": []})");
  safety::KeepOutCheck check(one_disc(), path);
  control::PoseEstimate estimate;
  estimate.pose = {-0.02, 0.0, 0.0};
  check.observe(estimate, 0.0);
  CHECK(check.zones().size() == 1);
  common::write_file_atomically(
      path, R"({"keep_out": [{"name": "hand", "corners_m": [-0.02, 0.005], "radius_m": 0.004}]})");
  CHECK_THROWS_WITH(check.observe(estimate, 0.0), Catch::Contains("keep-out zone hand"));
  CHECK(check.zones().size() == 2);
  check.look();
  estimate.pose.x_m = 0.01;
  CHECK_THROWS_WITH(check.observe(estimate, 0.0), Catch::Contains("keep-out zone disc"));
  common::write_file_atomically(path, "half a fi");
  estimate.pose.x_m = 0.0;
  CHECK_THROWS_AS(check.observe(estimate, 0.0), safety::Distrust);
  CHECK_THROWS_WITH(check.observe(estimate, 0.0), Catch::Contains(path));
  CHECK_THROWS_WITH(check.look(), Catch::Contains(path));
  CHECK(check.zones().size() == 2);  // as it was read last
}
