#include "lodestone/experiments/qualification_verdict.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <string>

using namespace lodestone;

namespace {

/// Everything measured, and good.
runs::QualificationResult good_bench() {
  runs::QualificationResult result;
  runs::StillFigures& still = result.still.emplace();
  still.x_mm = {0.01, 300, {}};
  still.y_mm = {0.01, 300, {}};
  still.heading_deg = {0.1, 300, {}};
  still.whitened_position = runs::Measured{0.9, 300, {}};
  still.drift_mm_per_min = {0.01, 300, {}};
  result.refusals.emplace().share = {0.002, 2000, {}};
  result.refusals->cells = {{0.0, 0.0, 0.0, 100, 1}, {8.0, 0.0, 0.0, 2, 2}};  // of two looks nothing is said
  result.latency.emplace().ms = {20.0, 20, {}};
  result.same_pulse.emplace().share_of_step = {0.1, 20, {}};
  result.step_change = runs::Measured{0.02, 20, {}};
  runs::CoilFigures& coil = result.coils.emplace_back();
  coil.gain = runs::Measured{1.01, 5, {}};
  coil.rise_ms = runs::Measured{20.0, 5, {}};
  coil.skew_ms = runs::Measured{-1.0, 5, {}};
  coil.first_C = 22.0;
  coil.last_C = 30.0;
  result.stick_slip.emplace().spread = runs::Measured{0.3, 9, {}};
  result.points.emplace().controller = "planner";
  result.points->rms_mm = runs::Measured{0.25, 16, {}};
  return result;
}

const runs::QualifiedItem& judged(const runs::QualificationResult& result, const std::string& name) {
  const auto found = std::find_if(result.items.begin(), result.items.end(),
                                  [&](const runs::QualifiedItem& item) { return item.item == name; });
  REQUIRE(found != result.items.end());
  return *found;
}

}  // namespace

TEST_CASE("a good bench has nothing to mend, and every item says why its bounds are what they are") {
  runs::QualificationResult result = good_bench();
  experiments::judge(result, {});
  for (const runs::QualifiedItem& item : result.items) {
    CHECK(item.verdict == "good");
    CHECK(item.good < item.acceptable);
    CHECK_FALSE(item.why.empty());
    CHECK_FALSE(item.mend.empty());
  }
  CHECK(result.mend_first == "nothing");
  const std::size_t items = result.items.size();
  experiments::judge(result, {});
  CHECK(result.items.size() == items);
}

TEST_CASE("what is furthest beyond its bound is to be mended first") {
  runs::QualificationResult result = good_bench();
  result.coils[0].gain->value = 0.5;   // 50 % off, 10 % are acceptable
  result.refusals->share.value = 0.2;  // 20 %, 10 % are acceptable
  result.same_pulse->share_of_step.value = 0.4;
  experiments::judge(result, {});
  CHECK(judged(result, "gain of a coil, off 1 by").verdict == "mend");
  CHECK(*judged(result, "gain of a coil, off 1 by").value == Approx(50.0));
  CHECK(judged(result, "looks without a pose").verdict == "mend");
  CHECK(judged(result, "scatter of the same pulse, by its step").verdict == "acceptable");
  CHECK(result.mend_first.rfind("gain of a coil, off 1 by: ", 0) == 0);
}

TEST_CASE("bounds of pulses follow the loop, and a change that chance may have made is none") {
  runs::QualificationResult result = good_bench();
  result.step_change = runs::Measured{0.5, 20, std::array<double, 2>{-0.1, 1.1}};
  control::ControlLoopConfig loop;
  loop.rest_s = 0.04;
  experiments::judge(result, loop);
  CHECK(judged(result, "latency from command to motion").verdict == "acceptable");  // half of that rest
  CHECK(judged(result, "step of the same pulse, changed by").verdict == "good");
  result.step_change->interval = std::array<double, 2>{0.4, 0.6};
  experiments::judge(result, loop);
  CHECK(judged(result, "step of the same pulse, changed by").verdict == "mend");
}

TEST_CASE("what was not measured is no verdict, and is said") {
  runs::QualificationResult result = good_bench();
  result.latency.reset();
  experiments::judge(result, {});
  CHECK(judged(result, "latency from command to motion").verdict == "not measured");
  CHECK(result.mend_first == "nothing; but not measured: latency from command to motion");
}

TEST_CASE("the error to expect is judged, but is nothing to mend by itself") {
  const char* const item = "error to expect at points (RMS)";
  runs::QualificationResult result = good_bench();
  result.points->sensed_rms_mm = runs::Measured{9.0, 16, {}};  // true poses come first
  experiments::judge(result, {});
  CHECK(result.items.back().item == item);
  CHECK(*judged(result, item).value == 0.25);
  result.points->rms_mm = runs::Measured{5.0, 16, {}};
  experiments::judge(result, {});
  CHECK(judged(result, item).verdict == "mend");
  CHECK(judged(result, item).mend.find("adapt") != std::string::npos);
  CHECK(result.mend_first == "nothing");
  result.points->controller = "baseline";
  result.points->rms_mm.reset();
  experiments::judge(result, {});
  CHECK(*judged(result, item).value == 9.0);
  CHECK(judged(result, item).mend.find("--models") != std::string::npos);
  result.points.reset();
  experiments::judge(result, {});
  CHECK(judged(result, item).verdict == "not measured");
  CHECK(result.mend_first == "nothing");
}
