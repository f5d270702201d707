#include "lodestone/rl/imagined_needle.h"

#include <catch2/catch.hpp>
#include <cmath>

using lodestone::common::RandomStream;
using lodestone::geometry::Drive;
using lodestone::geometry::Vector2;
using lodestone::rl::ImaginationConfig;
using lodestone::rl::ImaginedNeedle;
using lodestone::rl::ImaginedTask;

TEST_CASE("An imagined rig lies about as far from its estimate as that says", "[unit]") {
  ImaginationConfig config;
  config.gain_sigma = config.least_gain_sigma = 0.2;
  RandomStream random(1, "imagined");
  ImaginedNeedle needle;
  constexpr int kRigs = 4000;
  double square = 0.0;
  for (int i = 0; i < kRigs; ++i) {
    needle.draw_rig(config, random);
    CHECK(std::abs(needle.log_gain) <= 1.1);
    square += std::pow((needle.log_gain - needle.told.log_mean) / needle.told.log_sigma, 2) / kRigs;
  }
  CHECK(square == Approx(1.0).epsilon(0.1));
}

TEST_CASE("Friction stays with a place, and is another elsewhere", "[unit]") {
  ImaginationConfig config;
  RandomStream random(2, "imagined");
  ImaginedNeedle needle;
  needle.put({0.01, 0.0, 0.3}, config, random);
  needle.log_gain = 0.1;
  const double here = needle.log_place;
  CHECK(needle.factor() == Approx(std::exp(0.1 + here)));
  needle.pose.x_m += 0.5 * config.place_size_m;
  needle.note_pulse({0.2, 0.0}, {0.01, 0.0}, config, random);
  CHECK(needle.log_place == here);
  CHECK(needle.last_displacement_m.x() == Approx(0.5 * config.place_size_m));
  needle.pose.x_m += config.place_size_m;
  needle.note_pulse({0.2, 0.1}, {0.01, 0.0}, config, random);
  CHECK(needle.log_place != here);
  CHECK(needle.last_action == Drive{0.2, 0.1});
  needle.put({0.0, 0.0, 0.0}, config, random);
  CHECK(needle.last_action.isZero(0.0));
  CHECK(needle.last_displacement_m.isZero(0.0));
}

TEST_CASE("Near goals are as often near as far by the logarithm, and none lies outside the disc", "[unit]") {
  ImaginedTask task;
  task.task.dish_radius_m = 0.04;
  task.task.goal_radius = 0.5;
  RandomStream random(3, "imagined");
  const Vector2 place_m(0.015, 0.0);
  int none = 0, close = 0;
  constexpr int kDrawn = 2000;
  for (int i = 0; i < kDrawn; ++i) {
    const auto near_m = lodestone::rl::draw_near_m(place_m, task, random);
    if (!near_m) {
      ++none;
      continue;
    }
    CHECK(near_m->norm() <= 0.02);
    close += (*near_m - place_m).norm() < 1e-3 ? 1 : 0;
  }
  CHECK(none > kDrawn / 20);
  CHECK(close > kDrawn / 5);
  CHECK(lodestone::rl::draw_log_uniform(2.0, 2.0, random) == Approx(2.0));
}
