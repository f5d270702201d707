#include "lodestone/control/motion_model.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "env/linear_model.h"
#include "lodestone/common/statistics.h"

using namespace lodestone;
using geometry::Pose2;
using geometry::Vector2;

namespace {

constexpr double kPerDrive_m = 0.8e-3;

control::MotionModel motion_model(double drive_per_A = 1.0) {
  return {std::make_shared<const control::LearnedSimulator>(env::tests::noisy_linear_model(kPerDrive_m)),
          {},
          drive_per_A};
}

}  // namespace

TEST_CASE("the motion that is predicted is the likeliest, and an outlier as likely as its share", "[unit]") {
  control::MotionModel model = motion_model();
  const Pose2 before = {0.005, -0.002, 0.3};
  const Vector2 drive(3.0, -1.0);
  const auto after = [&](double off_m) {
    return Pose2{before.x_m + 3.0 * kPerDrive_m + off_m, before.y_m - kPerDrive_m, before.heading_rad};
  };
  std::vector<double> ratio;
  model.judge({{before, drive, after(0.0)}, {before, drive, after(0.5e-3)}, {before, drive, after(0.02)}},
              ratio);
  // The peak of three normal densities, with the sensor's noise on top.
  const double spread_m = std::hypot(env::tests::kLinearNoise_m, 0.5e-3);
  const double spread_rad = std::hypot(env::tests::kLinearNoise_m, 0.05);
  const double peak = 1.0 / (std::pow(2.0 * geometry::kPi, 1.5) * spread_m * spread_m * spread_rad);
  const double outlier = 1.0 / (geometry::kPi * 0.0425 * 0.0425 * 2.0 * geometry::kPi);
  CHECK(ratio[0] == Approx(0.9 * peak / outlier + 0.1).epsilon(0.01));
  CHECK(ratio[1] < ratio[0]);
  CHECK(ratio[2] == Approx(0.1));
}

TEST_CASE("motions are drawn as they are judged, and amperes are told", "[unit]") {
  control::MotionModel model = motion_model(2.0);
  common::RandomStream random(1, "draws");
  std::vector<double> along_m;
  for (int i = 0; i < 2000; ++i) along_m.push_back(model.draw({}, {1.5, 0.0}, random).x_m);
  CHECK(common::mean(along_m) == Approx(3.0 * kPerDrive_m).margin(0.05e-3));
  CHECK(common::standard_deviation(along_m) ==
        Approx(std::hypot(env::tests::kLinearNoise_m, 0.5e-3)).epsilon(0.05));
  // More than the simulator was shown (10) counts as that.
  std::vector<double> ratio;
  const Pose2 far = {10.0 * kPerDrive_m, 0.0, 0.0};
  model.judge({{{}, {5.0, 0.0}, far}, {{}, {50.0, 0.0}, far}}, ratio);
  CHECK(ratio[0] == ratio[1]);
}

TEST_CASE("what a pulse may do is what is drawn, as a mixture", "[unit]") {
  control::MotionModel model = motion_model(2.0);
  const Pose2 before = {0.005, -0.002, 3.1};
  const auto outcomes = model.outcomes(before, {1.5, 0.0});
  REQUIRE_FALSE(outcomes.empty());
  double weight = 0.0, x_m = 0.0;
  for (const physics::PulseOutcome& outcome : outcomes) {
    weight += outcome.weight;
    x_m += outcome.weight * outcome.mean.x_m;
    CHECK(outcome.sigma_x_m == Approx(env::tests::kLinearNoise_m).epsilon(0.05));
    CHECK(outcome.sigma_heading_rad == Approx(std::hypot(env::tests::kLinearNoise_m, 0.05)).epsilon(0.05));
    CHECK(outcome.mean.heading_rad == Approx(3.1).margin(0.01));
  }
  CHECK(weight == Approx(1.0));
  CHECK(x_m == Approx(0.005 + 3.0 * kPerDrive_m).margin(0.05e-3));
}
