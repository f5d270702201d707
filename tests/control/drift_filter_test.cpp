#include "lodestone/control/drift_filter.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/random.h"
#include "lodestone/geometry/angle.h"

using namespace lodestone;
using geometry::Pose2;
using geometry::Vector2;

namespace {

constexpr double kPeriod_s = 0.3;
constexpr double kNoise_m = 0.3e-3;  // of every coordinate of a pulse's motion

/// A needle that pulses take this way and that, and a flow besides; learns what its filter is told.
class Dish {
 public:
  explicit Dish(const control::IdentificationConfig& config = {}, std::uint64_t seed = 1)
      : filter(config), random_(seed, "dish") {}

  /// One pulse that takes the needle, however it lies, from the centre by 3 mm in some direction, and the
  /// flow from there.
  void pulse(const Vector2& flow_m) {
    const Pose2 from{0.0, 0.0, random_.uniform(-geometry::kPi, geometry::kPi)};
    const double way_rad = random_.uniform(-geometry::kPi, geometry::kPi);
    const Pose2 said{3e-3 * std::cos(way_rad), 3e-3 * std::sin(way_rad), from.heading_rad};
    Pose2 after = said;
    const Vector2 carried_m = control::carried_m(flow_m, from, said);
    after.x_m += carried_m.x() + kNoise_m * random_.normal();
    after.y_m += carried_m.y() + kNoise_m * random_.normal();
    filter.learn({from, {1.0, 0.0}, after, time_s}, {{1.0, said, kNoise_m, kNoise_m, 0.1}});
    time_s += kPeriod_s;
  }
  /// What is expected of the next pulse.
  Vector2 expected_m() const {
    const auto drifts_m = filter.drifts_m(time_s, kPeriod_s, 1);
    return drifts_m.empty() ? Vector2(Vector2::Zero()) : drifts_m.front();
  }

  control::DriftFilter filter;
  double time_s = 0.0;

 private:
  common::RandomStream random_;
};

}  // namespace

TEST_CASE("a flow carries a needle across it whole, along it by half", "[unit]") {
  const Vector2 flow_m(2e-3, 0.0);
  const auto carried_m = [&flow_m](double from_rad, double to_rad) {
    return control::carried_m(flow_m, {0.0, 0.0, from_rad}, {0.01, 0.0, to_rad});
  };
  const double quarter_rad = 0.5 * geometry::kPi;
  CHECK(carried_m(0.0, 0.0).x() == Approx(1e-3));
  CHECK(carried_m(quarter_rad, -3.0 * quarter_rad).x() == Approx(2e-3));
  CHECK(carried_m(0.5 * quarter_rad, 1.5 * quarter_rad).x() == Approx(2e-3));  // across in the mean
  CHECK(carried_m(3.1, -3.1).x() == Approx(1e-3).margin(1e-5));
  CHECK(carried_m(0.5 * quarter_rad, 0.5 * quarter_rad).y() == Approx(-0.5e-3));
}

TEST_CASE("a steady flow is found from a few pulses", "[unit]") {
  const Vector2 flow_m(0.6e-3, -0.8e-3);
  Dish dish;
  CHECK(dish.filter.drifts_m(0.0, kPeriod_s, 5).empty());
  for (int i = 0; i < 15; ++i) dish.pulse(flow_m);
  CHECK(dish.filter.flow_probability() > 0.9);
  CHECK((dish.expected_m() - flow_m).norm() < 0.25e-3);
  for (int i = 0; i < 30; ++i) dish.pulse(flow_m);
  CHECK((dish.expected_m() - flow_m).norm() < 0.15e-3);
  CHECK(dish.filter.drifts_m(dish.time_s, kPeriod_s, 5).size() == 5);
  dish.filter.reset();
  CHECK(dish.filter.flow_probability() == Approx(control::IdentificationConfig().drift_share));
  CHECK(dish.filter.drifts_m(dish.time_s, kPeriod_s, 5).empty());
}

TEST_CASE("a flow that pulses is foretold pulse by pulse, whatever its period", "[unit]") {
  for (const double period_s : {0.83, 1.0, 2.7}) {
    INFO("period " << period_s);
    const auto flow_m = [&](double time_s) -> Vector2 {
      return (1.0 + std::sin(2.0 * geometry::kPi * time_s / period_s)) * Vector2(0.8e-3, 0.0);
    };
    Dish dish;
    for (int i = 0; i < 60; ++i) dish.pulse(flow_m(dish.time_s));
    double square_m2 = 0.0;
    constexpr int kChecked = 20;
    for (int i = 0; i < kChecked; ++i) {
      square_m2 += (dish.expected_m() - flow_m(dish.time_s)).squaredNorm() / kChecked;
      dish.pulse(flow_m(dish.time_s));
    }
    CHECK(std::sqrt(square_m2) < 0.3e-3);  // the mean alone would leave 0.57 mm
  }
}

TEST_CASE("a fluid at rest stays one", "[unit]") {
  int flows = 0, steps = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Dish dish({}, seed);
    for (int i = 0; i < 60; ++i) {
      dish.pulse(Vector2::Zero());
      flows += dish.expected_m().isZero(0.0) ? 0 : 1;
      ++steps;
    }
  }
  CHECK(flows < steps / 50);
}

TEST_CASE("a flow that turns is followed, and one that ends forgotten", "[unit]") {
  Dish dish;
  for (int i = 0; i < 40; ++i) dish.pulse({1e-3, 0.0});
  for (int i = 0; i < 60; ++i) dish.pulse({0.0, 1e-3});
  CHECK((dish.expected_m() - Vector2(0.0, 1e-3)).norm() < 0.3e-3);
  for (int i = 0; i < 100; ++i) dish.pulse(Vector2::Zero());
  CHECK(dish.expected_m().norm() < 0.25e-3);
}

TEST_CASE("needles that friction holds, or that are not driven, say nothing of a flow", "[unit]") {
  control::DriftFilter filter({});
  const std::vector<physics::PulseOutcome> said = {{1.0, {2e-3, 0.0, 0.0}, kNoise_m, kNoise_m, 0.1}};
  const double before = filter.flow_probability();
  for (int i = 0; i < 20; ++i) {
    filter.learn({{}, {1.0, 0.0}, {}, kPeriod_s * i}, said);
    filter.learn({{}, {0.0, 0.0}, {1e-3, 0.0, 0.0}, kPeriod_s * i}, said);
    filter.learn({{}, {1.0, 0.0}, {1e-3, 0.0, 0.0}, kPeriod_s * i}, {{1.0, {}, kNoise_m, kNoise_m, 0.1}});
  }
  CHECK(filter.flow_probability() == before);
}

TEST_CASE("a filter that is told of no flow finds none", "[unit]") {
  control::IdentificationConfig config;
  config.drift_m = 0.0;
  Dish dish(config);
  for (int i = 0; i < 40; ++i) dish.pulse({2e-3, 0.0});
  CHECK(dish.expected_m().isZero(0.0));
  CHECK(dish.filter.by_flow_m({{}, {1.0, 0.0}, {5e-3, 0.0, 0.0}, dish.time_s}).isZero(0.0));
}

TEST_CASE("what a flow did to a pulse is told apart", "[unit]") {
  Dish dish;
  for (int i = 0; i < 40; ++i) dish.pulse({1e-3, 0.0});
  const Vector2 known_m = dish.expected_m();
  const auto by_flow_m = [&dish](const Pose2& after) {
    return dish.filter.by_flow_m({{}, {1.0, 0.0}, after, dish.time_s});
  };
  CHECK(by_flow_m({5e-3, 0.0, 0.0}).x() == Approx(0.5 * known_m.x()));
  CHECK(by_flow_m({5e-3, 0.0, 0.0}).y() == Approx(known_m.y()));
  CHECK(by_flow_m({}).isZero(0.0));
}
