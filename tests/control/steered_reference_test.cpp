#include "lodestone/control/steered_reference.h"

#include <catch2/catch.hpp>

#include "lodestone/control/held_drive.h"
#include "lodestone/control/suture_reference.h"

using namespace lodestone;
using control::PointReference;
using control::SteeredReference;

TEST_CASE("a steered reference follows what it is given last, in that one's own time") {
  SteeredReference steered(std::make_shared<PointReference>(geometry::Vector2(0.01, 0.0), 5.0));
  steered.reset();
  CHECK(steered.target(0.0, {0.0, 0.0}).x() == 0.01);
  CHECK_FALSE(steered.finished(4.9));
  CHECK(steered.finished(5.0));

  control::PathReferenceConfig config;
  config.speed_m_s = 0.01;
  const geometry::Path path({{0.0, 0.0}, {0.0, 0.02}}, false);
  steered.steer(std::make_shared<control::PathReference>(path, config));
  CHECK_FALSE(steered.finished(6.0));  // what was followed so far is over, what comes has not begun
  CHECK(steered.target(6.0, {0.0, 0.0}).y() == Approx(0.0));
  CHECK(steered.target(7.0, {0.0, 0.0}).y() == Approx(0.01));
  REQUIRE(steered.ahead(7.0, 0.5, 3).size() == 3);
  CHECK(steered.ahead(7.0, 0.5, 3)[0].point_m.y() == Approx(0.015));
  CHECK_FALSE(steered.finished(7.9));
  CHECK(steered.finished(8.0));
}

TEST_CASE("a steered reference ends when somebody says so") {
  SteeredReference steered(std::make_shared<PointReference>(geometry::Vector2(0.01, 0.0), 1e9, 0.5));
  steered.reset();
  CHECK(steered.target_heading_rad() == 0.5);
  CHECK_FALSE(steered.finished(3600.0));
  steered.end();
  CHECK(steered.finished(3600.3));
}

TEST_CASE("a steered reference has the headings of what it follows") {
  control::PathReferenceConfig config;
  config.speed_m_s = 0.01;
  SteeredReference steered(std::make_shared<control::PathReference>(
      geometry::Path::square(0.02).with_heading(geometry::PathHeading::fixed(0.5)), config));
  steered.reset();
  steered.target(0.0, {0.01, -0.01});
  CHECK(steered.target_heading_rad() == 0.5);
  REQUIRE(steered.ahead(0.0, 0.3, 2).size() == 2);
  CHECK(steered.ahead(0.0, 0.3, 2)[1].heading_rad == 0.5);
}

TEST_CASE("a steered reference waits for the needle where what it follows does") {
  SteeredReference steered(std::make_shared<PointReference>(geometry::Vector2(0.01, 0.0), 5.0));
  steered.reset();
  CHECK_FALSE(steered.awaits());
  steered.steer(std::make_shared<control::SutureReference>(geometry::running_stitch(1, 0.006, 0.004),
                                                           control::SutureReferenceConfig()));
  steered.target(0.3, {0.01, 0.01});
  CHECK(steered.awaits());
}

TEST_CASE("a held drive is given until another is held") {
  control::HeldDrive hand;
  CHECK(hand.act({}) == geometry::Vector2(0.0, 0.0));
  hand.hold({0.5, -1.0});
  hand.reset();
  CHECK(hand.act({}) == geometry::Vector2(0.5, -1.0));
}
