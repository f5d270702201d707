#include "lodestone/physics/flow.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/config.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::physics {
namespace {

using geometry::Vector2;

FlowConfig flow_of(FlowKind kind, double speed_m_s = 0.0, double direction_deg = 0.0) {
  FlowConfig config;
  config.kind = kind;
  config.speed_m_s = speed_m_s;
  config.direction_deg = direction_deg;
  return config;
}

FlowConfig vortex_of(double circulation_m2_s, double core_radius_m) {
  FlowConfig config = flow_of(FlowKind::kVortex);
  config.centre_m = {0.01, -0.005};
  config.circulation_m2_s = circulation_m2_s;
  config.core_radius_m = core_radius_m;
  return config;
}

/// Mean of the speed over one period, by the rectangle rule.
double mean_m_s(const Flow& flow, double period_s) {
  constexpr int kTimes = 4000;
  double sum = 0.0;
  for (int i = 0; i < kTimes; ++i) sum += flow.velocity_m_s({0.0, 0.0}, period_s * (i + 0.5) / kTimes).x();
  return sum / kTimes;
}

TEST_CASE("fluid that nothing moves rests") {
  CHECK(Flow().still());
  CHECK(Flow(FlowConfig{}).still());
  CHECK(Flow(flow_of(FlowKind::kUniform)).still());  // of no speed
  CHECK(Flow(vortex_of(0.0, 0.01)).still());
  CHECK(Flow().velocity_m_s({0.01, 0.02}, 3.0).norm() == 0.0);
  CHECK_FALSE(Flow(flow_of(FlowKind::kUniform, 1e-3)).still());
  CHECK_FALSE(Flow(vortex_of(-1e-5, 0.01)).still());
}

TEST_CASE("a uniform flow is the same everywhere, in its direction") {
  const Flow flow(flow_of(FlowKind::kUniform, 4e-3, 30.0));
  for (const Vector2& point : {Vector2(0.0, 0.0), Vector2(0.03, -0.02)}) {
    CHECK(flow.velocity_m_s(point, 0.7).x() == Approx(4e-3 * std::cos(geometry::kPi / 6.0)));
    CHECK(flow.velocity_m_s(point, 0.7).y() == Approx(2e-3));
  }
}

TEST_CASE(
    "a channel has Poiseuille's parabola: its peak on the middle line, nothing at the walls and beyond") {
  FlowConfig config = flow_of(FlowKind::kChannel, 6e-3, 90.0);  // along +y
  config.centre_m = {0.01, 0.0};
  config.width_m = 0.02;
  const Flow flow(config);
  const auto along = [&](double x_m) { return flow.velocity_m_s({x_m, 0.013}, 0.0).y(); };
  CHECK(along(0.01) == Approx(6e-3));
  CHECK(along(0.015) == Approx(0.75 * 6e-3));
  CHECK(along(0.005) == Approx(0.75 * 6e-3));
  CHECK(along(0.0) == Approx(0.0).margin(1e-12));
  CHECK(along(0.02) == Approx(0.0).margin(1e-12));
  CHECK(along(0.03) == 0.0);
  CHECK(std::abs(flow.velocity_m_s({0.012, 0.0}, 0.0).x()) < 1e-12);
  // The mean over the width is two thirds of the peak.
  double sum = 0.0;
  for (int i = 0; i < 1000; ++i) sum += along(0.02 * (i + 0.5) / 1000);
  CHECK(sum / 1000 == Approx(2.0 / 3.0 * 6e-3).epsilon(1e-5));
}

TEST_CASE("a vortex turns as a solid body in its core, and falls off with the distance outside") {
  const double circulation = 4e-5, core = 5e-3;
  const Flow flow(vortex_of(circulation, core));
  const Vector2 centre(0.01, -0.005);
  CHECK(flow.velocity_m_s(centre, 0.0).norm() == 0.0);
  const double spin = circulation / (2.0 * geometry::kPi * core * core);
  const Vector2 near = flow.velocity_m_s(centre + Vector2(1e-5, 0.0), 0.0);
  CHECK(near.y() == Approx(spin * 1e-5).epsilon(1e-4));
  CHECK(std::abs(near.x()) < 1e-15);
  CHECK(flow.velocity_m_s(centre + Vector2(0.0, core), 0.0).x() ==
        Approx(-circulation / (2.0 * geometry::kPi * core) * (1.0 - std::exp(-1.0))));
  const Vector2 far = centre + Vector2(-0.03, 0.04);
  CHECK(flow.velocity_m_s(far, 0.0).norm() == Approx(circulation / (2.0 * geometry::kPi * 0.05)));
  CHECK(std::abs(flow.velocity_m_s(far, 0.0).dot(far - centre)) < 1e-15);
  const Vector2 backwards = Flow(vortex_of(-circulation, core)).velocity_m_s(far, 0.0);
  CHECK((backwards + flow.velocity_m_s(far, 0.0)).norm() == 0.0);
}

TEST_CASE("a pulse comes again after its period, with its mean and its greatest speed") {
  FlowConfig config = flow_of(FlowKind::kUniform, 5e-3);
  config.period_s = 0.8;
  config.amplitude = 0.6;
  config.waveform = FlowWaveform::kSine;
  const Flow sine(config);
  CHECK(mean_m_s(sine, 0.8) == Approx(5e-3));
  CHECK(sine.velocity_m_s({0.0, 0.0}, 0.2).x() == Approx(1.6 * 5e-3));
  CHECK(sine.velocity_m_s({0.0, 0.0}, 0.6).x() == Approx(0.4 * 5e-3));

  config.waveform = FlowWaveform::kListed;
  config.factors = {0.0, 2.0, 1.0, 0.5};
  const Flow listed(config);
  CHECK(mean_m_s(listed, 0.8) == Approx(3.5 / 4.0 * 5e-3));
  const double at[][2] = {{0.0, 0.0}, {0.1, 1.0}, {0.2, 2.0}, {0.3, 1.5}, {0.6, 0.5}, {0.7, 0.25}};
  for (const auto& [time_s, factor] : at)
    CHECK(listed.velocity_m_s({0.0, 0.0}, time_s).x() == Approx(factor * 5e-3).margin(1e-12));
  for (const double time_s : {0.05, 0.33, 0.79}) {
    CHECK(listed.velocity_m_s({0.0, 0.0}, time_s + 5 * 0.8).x() ==
          Approx(listed.velocity_m_s({0.0, 0.0}, time_s).x()).margin(1e-12));
    CHECK(sine.velocity_m_s({0.0, 0.0}, time_s + 5 * 0.8).x() ==
          Approx(sine.velocity_m_s({0.0, 0.0}, time_s).x()).margin(1e-12));
  }
}

TEST_CASE("what is no flow is refused, and what is comes back as it was written") {
  const auto read = [](const char* json) {
    return common::config_from_json<FlowConfig>(common::Json::parse(json), "test");
  };
  CHECK_THROWS_WITH(read(R"({"kind": "channel", "width_m": -0.01})"), Catch::Contains("width_m = -0.01"));
  CHECK_THROWS_WITH(read(R"({"centre_m": [0.01]})"), Catch::Contains("must hold [x, y]"));
  CHECK_THROWS_WITH(read(R"({"waveform": "listed", "factors": [1.0]})"), Catch::Contains("two factors"));
  CHECK_THROWS_AS(read(R"({"waveform": "sine", "period_s": 0.0})"), common::ConfigError);
  CHECK_THROWS_AS(read(R"({"kind": "tide"})"), common::ConfigError);
  FlowConfig config = vortex_of(2e-5, 4e-3);
  config.waveform = FlowWaveform::kListed;
  config.factors = {1.0, 0.25};
  const common::Json written = common::config_to_json(config);
  CHECK(common::config_to_json(common::config_from_json<FlowConfig>(written, "test")) == written);
}

}  // namespace
}  // namespace lodestone::physics
