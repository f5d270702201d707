#include "lodestone/experiments/suture_score.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

using namespace lodestone;
using experiments::ScoredSample;
using geometry::kRadPerDeg;

namespace {

constexpr double kUp_rad = 0.5 * geometry::kPi;

/// 6 mm up the y axis, which a needle is pushed through from -6 to 6 mm.
const geometry::Stitch kStitch{{0.0, -0.003, kUp_rad}, {0.0, 0.003, kUp_rad}};

/// The needle at a moment: so far along the y axis and off it, and off the heading.
struct Lies {
  double y_mm;
  double x_mm = 0.0;
  double off_deg = 0.0;
};

std::vector<ScoredSample> push_of(const std::vector<Lies>& needle, std::size_t stitch = 0) {
  std::vector<ScoredSample> samples;
  for (const Lies& lies : needle)
    samples.push_back({0.3 * static_cast<double>(samples.size()),
                       {1e-3 * lies.x_mm, 1e-3 * lies.y_mm},
                       {0.0, 0.006},
                       false,
                       kUp_rad + kRadPerDeg * lies.off_deg,
                       kUp_rad,
                       stitch});
  return samples;
}

runs::TrialFigures score_of(const std::vector<Lies>& needle) {
  return experiments::score_suture(push_of(needle), {kStitch}, {});
}

/// Every 3 mm, the ends among them, all the way askew.
std::vector<Lies> all_the_way(double x_mm, double off_deg) {
  std::vector<Lies> needle;
  for (const double y_mm : {-6.0, -3.0, 0.0, 3.0, 6.0}) needle.push_back({y_mm, x_mm, off_deg});
  return needle;
}

}  // namespace

TEST_CASE("a stitch is made where the needle goes in and comes out near enough, and lies as it should") {
  const auto exact = score_of(all_the_way(0.0, 0.0));
  CHECK(exact.success);
  CHECK(*exact.stitches_made == 1);
  CHECK(*exact.stitches_made_share == 1.0);
  CHECK(*exact.stitch_rms_mm == Approx(0.0).margin(1e-9));
  CHECK(exact.error_mm() == *exact.stitch_rms_mm);
  CHECK(exact.final_error_mm == Approx(0.0).margin(1e-9));
  CHECK_FALSE(exact.cross_track_rms_mm);
  const auto within = score_of(all_the_way(0.9, -7.5));
  CHECK(within.success);
  CHECK(*within.stitch_rms_mm == Approx(0.9));
  CHECK(*within.stitch_worst_mm == Approx(0.9));
  CHECK(*within.stitch_worst_deg == Approx(7.5));
  CHECK(*within.heading_rms_deg == Approx(7.5));
  const auto beside = score_of(all_the_way(1.1, 0.0));
  CHECK_FALSE(beside.success);
  CHECK(*beside.stitches_made == 0);
  CHECK_FALSE(score_of(all_the_way(0.0, 8.5)).success);
  CHECK(score_of(all_the_way(0.0, 361.0)).success);  // the heading is an angle
}

TEST_CASE("each end counts by itself") {
  const auto beside_out = score_of({{-6.0}, {-3.0}, {0.0}, {3.0, 1.5}, {6.0, 3.0}});
  CHECK_FALSE(beside_out.success);
  REQUIRE(beside_out.stitch_figures->size() == 1);
  const runs::StitchFigures& figures = beside_out.stitch_figures->front();
  CHECK(figures.entry_error_mm == Approx(0.0).margin(1e-9));
  CHECK(figures.exit_error_mm == Approx(1.5 * 3.0 / std::hypot(1.5, 3.0)));  // where it was nearest
  CHECK_FALSE(figures.made);
  const auto turned_in = score_of({{-6.0}, {-3.0, 0.0, 20.0}, {0.0}, {3.0}, {6.0}});
  CHECK_FALSE(turned_in.success);
  CHECK(turned_in.stitch_figures->front().entry_heading_deg == Approx(20.0));
  CHECK(turned_in.stitch_figures->front().exit_heading_deg == Approx(0.0).margin(1e-9));
}

TEST_CASE("between two samples the needle goes and turns evenly") {
  const auto passing = score_of({{-6.0, 0.0, -30.0}, {-4.5, 0.0, -20.0}, {-1.5, 0.0, 10.0}, {1.5}, {4.5}});
  CHECK(passing.stitch_figures->front().entry_error_mm == Approx(0.0).margin(1e-9));
  CHECK(passing.stitch_figures->front().entry_heading_deg == Approx(5.0));
  CHECK(passing.success);
}

TEST_CASE("a needle that comes out before it goes in has made no stitch, nor one that lies still") {
  const auto backwards = score_of({{6.0}, {3.0}, {0.0}, {-3.0}});
  CHECK_FALSE(backwards.success);
  CHECK(backwards.stitch_figures->front().entry_error_mm == Approx(0.0).margin(1e-9));
  CHECK(backwards.stitch_figures->front().exit_error_mm == Approx(6.0));
  const auto still = score_of({{-3.0}, {-3.0}, {-3.0}});
  CHECK_FALSE(still.success);
  CHECK(still.stitch_figures->front().exit_error_mm == Approx(6.0));
  CHECK(score_of({{-3.0}}).stitch_figures->front().exit_error_mm == Approx(6.0));
}

TEST_CASE("only what is pushed through a stitch counts for it, and all must be made") {
  const geometry::Stitch beside{{0.004, 0.003, -kUp_rad}, {0.004, -0.003, -kUp_rad}};
  std::vector<ScoredSample> samples = push_of(all_the_way(0.0, 0.0));
  // It comes by the second one while it is still on its way to it, and is pushed beside it.
  for (ScoredSample way : push_of({{3.0, 4.0, 180.0}, {-3.0, 4.0, 180.0}}, 1)) {
    way.approach = true;
    samples.push_back(way);
  }
  for (const ScoredSample& through : push_of({{3.0, 6.0, 180.0}, {-3.0, 6.0, 180.0}}, 1))
    samples.push_back(through);
  const auto score = experiments::score_suture(samples, {kStitch, beside}, {});
  CHECK(*score.stitches_made == 1);
  CHECK(*score.stitches_made_share == 0.5);
  CHECK_FALSE(score.success);
  CHECK(score.stitch_figures->at(0).made);
  CHECK(*score.stitch_worst_mm == Approx(2.0));
  CHECK(*score.stitch_rms_mm == Approx(std::sqrt(2.0)));
  CHECK(*score.heading_rms_deg == Approx(180.0 * std::sqrt(2.0 / 7.0)));  // against what the samples wanted
  CHECK_THROWS_AS(experiments::score_suture(push_of(all_the_way(0.0, 0.0)), {kStitch, beside}, {}),
                  common::LogicFault);
}

TEST_CASE("sutures are summed up by their stitches") {
  const auto made = score_of(all_the_way(0.0, 0.0));
  const auto missed = score_of(all_the_way(2.0, 4.0));
  const auto summary = experiments::summarise_trials({&made, &missed});
  CHECK(summary.mean_error_mm == Approx(1.0));
  CHECK(summary.success_rate == 0.5);
  CHECK(*summary.stitches_made == 0.5);
  CHECK(*summary.stitches_made_share == 0.5);
  CHECK(*summary.stitch_rms_mm == Approx(1.0));
  CHECK(*summary.stitch_worst_mm == Approx(1.0));
  CHECK(*summary.stitch_worst_deg == Approx(2.0));
  CHECK(*summary.heading_rms_deg == Approx(2.0));
  CHECK_FALSE(summary.completion);
}
