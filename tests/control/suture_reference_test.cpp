#include "lodestone/control/suture_reference.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"

using namespace lodestone;
using control::SutureReference;
using geometry::kPi;
using geometry::Pose2;
using geometry::Vector2;

namespace {

/// Aligned and left 3 mm from the ends of a stitch.
control::SutureReferenceConfig around() {
  control::SutureReferenceConfig config;
  config.approach_m = config.leave_m = 0.003;
  return config;
}

/// Two stitches of 6 mm, 4 mm apart, up and down: 3 mm before and behind each, so 6 s through one.
SutureReference two_stitches(const control::SutureReferenceConfig& config = around()) {
  SutureReference reference(geometry::running_stitch(2, 0.006, 0.004), config);
  reference.reset();
  return reference;
}

const Pose2 kBefore{-0.002, -0.006, 0.5 * kPi};  // the first one,
const Pose2 kNext{0.002, 0.006, -0.5 * kPi};     // and the second
const Pose2 kElsewhere{0.02, 0.02, 0.0};

bool is_at(const Vector2& a, const Vector2& b) { return (a - b).norm() < 1e-9; }

}  // namespace

TEST_CASE("a needle is waited for before its stitch until it has come there and lies along it") {
  SutureReference reference = two_stitches();
  CHECK(is_at(reference.target(0.0, kElsewhere), kBefore.position_m()));
  CHECK(*reference.target_heading_rad() == Approx(0.5 * kPi));
  CHECK(reference.approaching());
  CHECK(reference.awaits());
  CHECK(reference.stitch() == 0);
  CHECK(reference.ahead(0.0, 0.3, 5).empty());  // a pose to stay at
  Pose2 needle = kBefore;
  needle.heading_rad += 7.0 * geometry::kRadPerDeg;  // there, but askew
  CHECK(is_at(reference.target(0.3, needle), kBefore.position_m()));
  CHECK(reference.approaching());
  needle = kBefore;
  needle.x_m += 0.0006;  // along it, but not there
  reference.target(0.6, needle);
  CHECK(reference.approaching());
  needle.x_m -= 0.0002;
  needle.heading_rad += 2.0 * kPi - 4.0 * geometry::kRadPerDeg;
  CHECK(is_at(reference.target(0.9, needle), kBefore.position_m()));
  CHECK_FALSE(reference.approaching());
  CHECK_FALSE(reference.awaits());
}

TEST_CASE("it is pushed through along its way, told what comes, and sent to the next stitch") {
  SutureReference reference = two_stitches();
  reference.target(0.0, kElsewhere);
  reference.target(3.0, kBefore);
  CHECK(is_at(reference.target(4.5, kElsewhere), {-0.002, -0.003}));  // the entry, wherever the needle is
  CHECK(*reference.target_heading_rad() == Approx(0.5 * kPi));
  const auto ahead = reference.ahead(4.5, 0.5, 20);
  REQUIRE(ahead.size() == 20);
  CHECK(ahead[0].in_s == 0.5);
  CHECK(is_at(ahead[0].point_m, {-0.002, -0.002}));
  CHECK(*ahead[0].heading_rad == Approx(0.5 * kPi));
  CHECK(is_at(ahead[8].point_m, {-0.002, 0.006}));
  CHECK(is_at(ahead[19].point_m, {-0.002, 0.006}));  // when it goes on depends on the needle
  CHECK(is_at(reference.target(7.5, kElsewhere), {-0.002, 0.003}));
  CHECK(is_at(reference.target(8.9, kElsewhere), {-0.002, 0.0058}));
  CHECK(reference.stitch() == 0);
  CHECK_FALSE(reference.finished(9.0));
  CHECK(is_at(reference.target(9.0, kElsewhere), kNext.position_m()));
  CHECK(reference.stitch() == 1);
  CHECK(reference.approaching());
  CHECK(*reference.target_heading_rad() == Approx(-0.5 * kPi));
  reference.target(12.0, kNext);
  CHECK_FALSE(reference.approaching());
  CHECK(is_at(reference.target(18.0, kElsewhere), {0.002, -0.006}));
  CHECK_FALSE(reference.finished(17.9));
  CHECK(reference.finished(18.0));
  CHECK(reference.stitch() == 1);
  reference.reset();
  CHECK(reference.stitch() == 0);
  CHECK(reference.approaching());
  CHECK_FALSE(reference.target_heading_rad());
}

TEST_CASE("a needle that does not come is waited for no longer than the limit, before each stitch") {
  control::SutureReferenceConfig config = around();
  config.arrive_limit_s = 5.0;
  SutureReference reference = two_stitches(config);
  reference.target(4.9, kElsewhere);
  CHECK(reference.approaching());
  reference.target(5.0, kElsewhere);
  CHECK_FALSE(reference.approaching());
  reference.target(11.0, kElsewhere);
  CHECK(reference.stitch() == 1);
  reference.target(15.9, kElsewhere);
  CHECK(reference.approaching());
  reference.target(16.0, kElsewhere);
  CHECK_FALSE(reference.approaching());
  CHECK(reference.finished(22.0));
}

TEST_CASE("through a stitch that turns the heading turns with the way") {
  const geometry::Stitch arch{{-0.003, 0.0, 0.5 * kPi}, {0.003, 0.0, -0.5 * kPi}};
  const control::SutureReferenceConfig config = around();
  SutureReference reference({arch}, config);
  reference.reset();
  reference.target(0.0, {-0.003, -0.003, 0.5 * kPi});
  REQUIRE_FALSE(reference.approaching());
  const double top_s = 0.5 * reference.way().length_m() / config.speed_m_s;
  CHECK(is_at(reference.target(top_s, kElsewhere), {0.0, 0.0015}));
  CHECK(*reference.target_heading_rad() == Approx(0.0).margin(1e-6));
  CHECK(*reference.ahead(top_s, 0.5, 1).front().heading_rad < -0.1);
}

TEST_CASE("without stitches there is nothing to follow") {
  CHECK_THROWS_AS(SutureReference({}, {}), common::LogicFault);
}
