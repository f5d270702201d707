#include "open_loop.h"

#include <catch2/catch.hpp>

#include "lodestone/geometry/angle.h"

namespace lodestone::dynamics {
namespace {

/// A needle that goes 2 mm along x with every pulse and does not turn.
data::Dataset straight(std::int64_t steps) {
  data::Dataset dataset;
  data::Episode episode;
  for (std::int64_t t = 0; t <= steps; ++t) {
    episode.observations.insert(episode.observations.end(), {2e-3 * static_cast<double>(t), 0.0, 3.1});
    if (t == steps) break;
    episode.actions.insert(episode.actions.end(), {1.0, 0.0});
    episode.terminations.push_back(0);
    episode.truncations.push_back(0);
    episode.zero_current.push_back(0);
  }
  dataset.episodes.push_back(episode);
  return dataset;
}

/// Of every four runs one stands still, three go 2 mm, and each turns by as much to one side or the other.
std::vector<double> either_way(const std::vector<double>& state, const std::vector<double>& /*action*/) {
  std::vector<double> next = state;
  for (std::size_t i = 0; i < state.size() / 3; ++i) {
    if (i % 4 != 0) next[3 * i] += 2e-3;
    next[3 * i + 2] = geometry::wrap_angle(next[3 * i + 2] + (i % 2 == 0 ? 0.2 : -0.2));
  }
  return next;
}

}  // namespace

TEST_CASE("of many runs the mean counts, of headings on the circle", "[unit]") {
  const runs::OpenLoopError error = open_loop_error(either_way, straight(5), 4);
  for (const int steps : {1, 2, 5}) {
    CAPTURE(steps);
    CHECK(error.k_step_mm->at(steps).value() == Approx(0.25 * 2.0 * steps));
    CHECK(error.k_step_heading_deg->at(steps).value() == Approx(0.0).margin(1e-9));
  }
  CHECK_FALSE(error.k_step_mm->at(10).has_value());
}

TEST_CASE("a run alone is judged as it is", "[unit]") {
  const runs::OpenLoopError error = open_loop_error(
      [](const std::vector<double>& state, const std::vector<double>& /*action*/) { return state; },
      straight(12));
  CHECK(error.k_step_mm->at(10).value() == Approx(20.0));
  CHECK(error.k_step_heading_deg->at(10).value() == Approx(0.0).margin(1e-9));
}

}  // namespace lodestone::dynamics
