#include "lodestone/vision/disc_fit.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <opencv2/core.hpp>

#include "lodestone/common/random.h"
#include "lodestone/rig/rendered_camera.h"
#include "sphere_rig.h"

using namespace lodestone;

namespace {

constexpr int kDiscSide = 128;
const vision::MaskGrid kDiscGrid{{-0.0254, 0.0254}, 0.4e-3};

vision::RodConfig sphere_of_rig() { return vision::rod_of(rig::bench_of(tests::sphere_rig())); }

vision::Evidence nothing_seen() {
  vision::Evidence seen;
  seen.needle = cv::Mat(kDiscSide, kDiscSide, CV_32F, cv::Scalar(-6.0));
  seen.tape = seen.needle.clone();
  return seen;
}

/// Log-odds of the fraction of each pixel that a disc covers, as an ideal network gives them.
void add_disc(const geometry::Vector2& middle_m, double radius_m, vision::Evidence& seen) {
  for (int row = 0; row < kDiscSide; ++row) {
    for (int column = 0; column < kDiscSide; ++column) {
      double fraction = 0.0;
      for (int sub = 0; sub < 25; ++sub) {
        const geometry::Vector2 at = kDiscGrid.at(column + (sub % 5 - 2) / 5.0, row + (sub / 5 - 2) / 5.0);
        if ((at - middle_m).norm() <= radius_m) fraction += 1.0 / 25.0;
      }
      const double p = std::min(std::max(fraction, 0.002), 0.998);
      float& cell = seen.needle.at<float>(row, column);
      cell = std::max(cell, static_cast<float>(std::log(p / (1.0 - p))));
    }
  }
}

void add_noise(double sigma, vision::Evidence& seen) {
  common::RandomStream random(1, "log-odds");
  for (int i = 0; i < kDiscSide * kDiscSide; ++i)
    seen.needle.ptr<float>()[i] += static_cast<float>(sigma * random.normal());
}

}  // namespace

TEST_CASE("a sphere is found to a tenth of a millimetre, without a heading") {
  for (double place = 0.0; place < 1.0; place += 0.13) {
    const geometry::Vector2 middle_m(0.004 * std::cos(5.0 * place) + 1e-4 * place, -0.01 + 0.02 * place);
    for (const double noise : {0.0, 1.0}) {
      vision::Evidence seen = nothing_seen();
      add_disc(middle_m, 1.5e-3, seen);
      add_noise(noise, seen);
      const vision::RodFit fit = vision::fit_rod(seen, kDiscGrid, sphere_of_rig());
      REQUIRE(fit.found);
      CHECK(fit.reason.empty());
      CHECK(fit.candidates.size() == 1);
      CHECK((fit.pose.position_m() - middle_m).norm() < 0.1e-3);
      CHECK(fit.pose.heading_rad == 0.0);
      CHECK(fit.support > 0.8);
      CHECK(std::sqrt(fit.covariance(0, 0)) < 0.1e-3);
      CHECK(fit.covariance(0, 0) > 0.0);
    }
  }
}

TEST_CASE("what is no sphere is none: nothing, a speck, a stain, a rod") {
  const vision::RodConfig config = sphere_of_rig();
  vision::Evidence seen = nothing_seen();
  CHECK_FALSE(vision::fit_disc(seen, kDiscGrid, config).found);
  CHECK(vision::fit_disc(seen, kDiscGrid, config).reason == "no sphere in view");
  add_disc({0.005, 0.0}, 0.5e-3, seen);  // a speck
  add_disc({-0.01, 0.0}, 4e-3, seen);    // a stain
  CHECK_FALSE(vision::fit_disc(seen, kDiscGrid, config).found);
  for (int i = -60; i <= 60; ++i) add_disc({2e-4 * i, 0.015}, 0.36e-3, seen);  // a rod
  CHECK_FALSE(vision::fit_disc(seen, kDiscGrid, config).found);
  // The sphere is found beside all of them.
  add_disc({0.01, -0.01}, 1.5e-3, seen);
  const vision::RodFit fit = vision::fit_disc(seen, kDiscGrid, config);
  REQUIRE(fit.found);
  CHECK((fit.pose.position_m() - geometry::Vector2(0.01, -0.01)).norm() < 0.1e-3);
}

TEST_CASE("of two spheres none is the one, and both are candidates") {
  vision::Evidence seen = nothing_seen();
  add_disc({0.01, 0.0}, 1.5e-3, seen);
  add_disc({-0.01, 0.004}, 1.5e-3, seen);
  const vision::RodFit fit = vision::fit_disc(seen, kDiscGrid, sphere_of_rig());
  CHECK_FALSE(fit.found);
  CHECK_FALSE(fit.axis_found);
  CHECK(fit.reason == "more than one sphere in view, or something like one");
  REQUIRE(fit.candidates.size() == 2);
  for (const vision::Rod& disc : fit.candidates) CHECK(disc.found);
}
