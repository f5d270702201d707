#include "lodestone/vision/rod_fit.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <opencv2/core.hpp>

#include "lodestone/common/random.h"
#include "paper_scenes.h"

using namespace lodestone;

namespace {

constexpr int kSide = 128;
const vision::MaskGrid kGrid{{-0.0254, 0.0254}, 0.4e-3};

vision::RodConfig paper_rod() { return vision::rod_of(tests::paper_bench()); }

/// Evidence of an ideal network for needles at these poses, with noise on the log-odds.
class Evidence {
 public:
  Evidence() {
    maps_.needle = cv::Mat(kSide, kSide, CV_32F, cv::Scalar(-6.0));
    maps_.tape = cv::Mat(kSide, kSide, CV_32F, cv::Scalar(-6.0));
  }

  /// Log-odds of the fraction of each pixel that is needle. Hidden parts (along the needle, from its middle)
  /// say nothing either way.
  Evidence& add(const geometry::Pose2& pose, double hidden_from_m = 1.0, double hidden_to_m = 1.0) {
    const vision::RodConfig rod = paper_rod();
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        double needle = 0.0;
        double tape = 0.0;
        bool hidden = false;
        for (int sub = 0; sub < 25; ++sub) {
          const geometry::Vector2 at = kGrid.at(column + (sub % 5 - 2) / 5.0, row + (sub / 5 - 2) / 5.0);
          const geometry::Vector2 offset = at - pose.position_m();
          const double s = std::cos(pose.heading_rad) * offset.x() + std::sin(pose.heading_rad) * offset.y();
          const double d = std::cos(pose.heading_rad) * offset.y() - std::sin(pose.heading_rad) * offset.x();
          hidden = hidden || (s > hidden_from_m && s < hidden_to_m && std::abs(d) < 0.002);
          if (std::abs(s) > 0.5 * rod.needle_length_m || std::abs(d) > 0.5 * rod.needle_diameter_m) continue;
          needle += 1.0 / 25.0;
          tape += s > 0.5 * rod.needle_length_m - rod.tape_length_m ? 1.0 / 25.0 : 0.0;
        }
        put(maps_.needle, row, column, hidden ? (needle > 0.3 ? 0.5 : -0.5) : log_odds(needle));
        put(maps_.tape, row, column, hidden ? -1.0 : log_odds(tape));
      }
    }
    return *this;
  }

  Evidence& noise(double sigma) {
    common::RandomStream random(1, "log-odds");
    for (cv::Mat* map : {&maps_.needle, &maps_.tape})
      for (int i = 0; i < kSide * kSide; ++i)
        map->ptr<float>()[i] += static_cast<float>(sigma * random.normal());
    return *this;
  }

  const vision::Evidence& maps() const { return maps_; }

 private:
  static double log_odds(double fraction) {
    const double p = std::min(std::max(fraction, 0.002), 0.998);
    return std::log(p / (1.0 - p));
  }
  static void put(cv::Mat& map, int row, int column, double value) {
    float& cell = map.at<float>(row, column);
    cell = std::max(cell, static_cast<float>(value));
  }
  vision::Evidence maps_;
};

void check_near(const vision::Rod& rod, const geometry::Pose2& pose, double position_m, double heading_rad) {
  REQUIRE(rod.found);
  CHECK(rod.reason.empty());
  CHECK((rod.pose.position_m() - pose.position_m()).norm() < position_m);
  CHECK(std::abs(geometry::wrap_angle(rod.pose.heading_rad - pose.heading_rad)) < heading_rad);
}

}  // namespace

TEST_CASE("a needle is found to a fifth of a pixel, at any heading, with its head") {
  for (double heading = -3.0; heading < 3.1; heading += 0.37) {
    const geometry::Pose2 pose{0.0031 * std::cos(5.0 * heading), -0.002, heading};
    check_near(vision::fit_rod(Evidence().add(pose).maps(), kGrid, paper_rod()), pose, 0.08e-3, 0.003);
    check_near(vision::fit_rod(Evidence().add(pose).noise(1.0).maps(), kGrid, paper_rod()), pose, 0.12e-3,
               0.008);
  }
}

TEST_CASE("a hidden end gives way to the visible one") {
  const geometry::Pose2 pose{0.002, 0.001, 0.7};
  const vision::Rod bare = vision::fit_rod(Evidence().add(pose).maps(), kGrid, paper_rod());
  for (const double sign : {-1.0, 1.0}) {
    const double from_m = sign > 0.0 ? 0.004 : -0.018;
    const vision::Rod rod =
        vision::fit_rod(Evidence().add(pose, from_m, from_m + 0.014).maps(), kGrid, paper_rod());
    check_near(rod, pose, 0.3e-3, 0.01);
    CHECK(rod.covariance.topLeftCorner(2, 2).trace() > bare.covariance.topLeftCorner(2, 2).trace());
    CHECK(rod.head_certainty < bare.head_certainty + 1e-12);
  }
}

TEST_CASE("the covariance lies along the needle and is positive") {
  const vision::Rod rod = vision::fit_rod(Evidence().add({0.0, 0.0, 0.5}).maps(), kGrid, paper_rod());
  REQUIRE(rod.found);
  const Eigen::Vector2d along(std::cos(0.5), std::sin(0.5));
  const Eigen::Vector2d across(-std::sin(0.5), std::cos(0.5));
  const Eigen::Matrix2d position = rod.covariance.topLeftCorner<2, 2>();
  CHECK(along.dot(position * along) > across.dot(position * across));
  CHECK(across.dot(position * across) > 0.0);
  CHECK(rod.covariance(2, 2) > 0.0);
}

TEST_CASE("there is no pose, but a reason, where no single needle is seen") {
  const auto reason = [](const Evidence& evidence) {
    const vision::Rod rod = vision::fit_rod(evidence.maps(), kGrid, paper_rod());
    CHECK_FALSE(rod.found);
    return rod.reason;
  };
  CHECK_THAT(reason(Evidence()), Catch::Contains("no needle"));
  CHECK_THAT(reason(Evidence().noise(0.5)), Catch::Contains("no needle"));
  CHECK_THAT(reason(Evidence().add({0.0, 0.010, 0.2}).add({0.002, -0.010, 1.0})),
             Catch::Contains("more than one"));
  Evidence bare;
  bare.add({0.0, 0.0, 0.2});
  vision::Evidence without_tape{bare.maps().needle, cv::Mat(kSide, kSide, CV_32F, cv::Scalar(-6.0))};
  const vision::Rod rod = vision::fit_rod(without_tape, kGrid, paper_rod());
  CHECK_FALSE(rod.found);
  CHECK_THAT(rod.reason, Catch::Contains("head and tail"));
}

TEST_CASE("a blob is no needle") {
  vision::Evidence blob{cv::Mat(kSide, kSide, CV_32F, cv::Scalar(-6.0)),
                        cv::Mat(kSide, kSide, CV_32F, cv::Scalar(-6.0))};
  blob.needle(cv::Rect(50, 50, 14, 14)).setTo(5.0);
  CHECK_FALSE(vision::fit_rod(blob, kGrid, paper_rod()).found);
}

TEST_CASE("a needle whose tape is hidden has an axis, and no pose") {
  Evidence seen;
  seen.add({0.0, 0.0, 0.2});
  const vision::Evidence hidden{seen.maps().needle, cv::Mat(kSide, kSide, CV_32F, cv::Scalar(-3.0))};
  const vision::Rod rod = vision::fit_rod(hidden, kGrid, paper_rod());
  CHECK_FALSE(rod.found);
  CHECK_THAT(rod.reason, Catch::Contains("head and tail"));
  REQUIRE(rod.axis_found);
  CHECK(std::abs(std::sin(rod.pose.heading_rad - 0.2)) < 0.01);
  CHECK(rod.tape_log_odds < 2.2);
  CHECK(vision::fit_rod(seen.maps(), kGrid, paper_rod()).tape_log_odds > 2.2);
}
