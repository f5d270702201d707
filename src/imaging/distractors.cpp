#include "distractors.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "drawing.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::imaging {

namespace {

class Painter {
 public:
  Painter(const Scene& scene, common::RandomStream& random, SceneLayers& layers)
      : scene_(scene), random_(random), layers_(layers), pixel_m_(scene.camera.pixel_size_m()) {}

  void stain() {
    const Colour blood = tone({0.10F, 0.08F, 0.45F}, 0.5, 1.3);
    const cv::Mat before = layers_.under.clone();
    cv::fillPoly(layers_.under, std::vector<std::vector<cv::Point>>{blob(random_.uniform(0.001, 0.006))},
                 lit(blood), cv::LINE_AA, kShift);
    const double strength = random_.uniform(0.3, 0.85);
    cv::addWeighted(layers_.under, strength, before, 1.0 - strength, 0.0, layers_.under);
  }

  void scratch() {
    const geometry::Vector2 from = anywhere();
    const double angle = random_.uniform(0.0, geometry::kPi);
    const double length_m = random_.uniform(0.002, 0.025);
    const geometry::Vector2 to = from + length_m * geometry::Vector2(std::cos(angle), std::sin(angle));
    const auto value = static_cast<float>(scene_.floor_grey * random_.uniform(0.8, 1.25));
    cv::line(layers_.under, at(from), at(to), lit({value, value, value}),
             1 + static_cast<int>(random_.below(2)), cv::LINE_AA, kShift);
  }

  /// Suture thread: a smooth curve through four points, in one of the usual colours.
  void thread() {
    static const Colour kColours[] = {
        {0.45F, 0.12F, 0.30F}, {0.55F, 0.25F, 0.10F}, {0.08F, 0.08F, 0.08F}, {0.85F, 0.85F, 0.85F}};
    const Colour colour = tone(kColours[random_.below(4)], 0.8, 1.2);
    const geometry::Vector2 knots[4] = {anywhere(), anywhere(), anywhere(), anywhere()};
    std::vector<cv::Point> points;
    constexpr int kPieces = 60;
    for (int i = 0; i <= kPieces; ++i) {
      const double t = static_cast<double>(i) / kPieces;
      const double s = 1.0 - t;
      points.push_back(at(s * s * s * knots[0] + 3.0 * s * s * t * knots[1] + 3.0 * s * t * t * knots[2] +
                          t * t * t * knots[3]));
    }
    const int width_px =
        std::max(1, static_cast<int>(std::lround(random_.uniform(0.15e-3, 0.45e-3) / pixel_m_)));
    if (random_.uniform() < 0.5) {
      cv::polylines(layers_.under, points, false, lit(colour), width_px, cv::LINE_AA, kShift);
    } else {
      cv::polylines(layers_.over, points, false, lit(colour), width_px, cv::LINE_AA, kShift);
      cv::polylines(layers_.over_alpha, points, false, cv::Scalar(255), width_px, cv::LINE_AA, kShift);
    }
  }

  void bubble() {
    const cv::Point centre = at(anywhere());
    const double radius_m = random_.uniform(0.3e-3, 2.0e-3);
    const auto radius = static_cast<int>(radius_m / pixel_m_ * (1 << kShift));
    const auto rim = static_cast<float>(scene_.floor_grey * random_.uniform(0.3, 0.7));
    cv::circle(layers_.over, centre, radius, lit({rim, rim, rim}), 2, cv::LINE_AA, kShift);
    cv::circle(layers_.over_alpha, centre, radius, cv::Scalar(200), 2, cv::LINE_AA, kShift);
    const cv::Point spark(centre.x - radius / 3, centre.y - radius / 3);
    cv::circle(layers_.over, spark, radius / 4, lit({1.0F, 1.0F, 1.0F}), cv::FILLED, cv::LINE_AA, kShift);
    cv::circle(layers_.over_alpha, spark, radius / 4, cv::Scalar(255), cv::FILLED, cv::LINE_AA, kShift);
  }

 private:
  geometry::Vector2 anywhere() {
    const double r = scene_.bench.dish_radius_m * std::sqrt(random_.uniform());
    const double angle = random_.uniform(-geometry::kPi, geometry::kPi);
    return {r * std::cos(angle), r * std::sin(angle)};
  }

  cv::Point at(const geometry::Vector2& floor_m) const {
    const Eigen::Vector2d pixel = scene_.camera.project_floor(floor_m) * (1 << kShift);
    return {static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))};
  }

  /// A closed uneven outline.
  std::vector<cv::Point> blob(double radius_m) {
    const geometry::Vector2 centre = anywhere();
    const double amplitude = random_.uniform(0.1, 0.4);
    const double phases[2] = {random_.uniform(0.0, 2.0 * geometry::kPi),
                              random_.uniform(0.0, 2.0 * geometry::kPi)};
    const double stretch = random_.uniform(0.5, 1.0);
    std::vector<cv::Point> outline;
    for (int i = 0; i < 48; ++i) {
      const double angle = 2.0 * geometry::kPi * i / 48.0;
      const double r = radius_m * (1.0 + amplitude * (0.6 * std::sin(2.0 * angle + phases[0]) +
                                                      0.4 * std::sin(5.0 * angle + phases[1])));
      outline.push_back(at(centre + geometry::Vector2(r * std::cos(angle), stretch * r * std::sin(angle))));
    }
    return outline;
  }

  Colour tone(Colour colour, double low, double high) {
    const auto factor = static_cast<float>(random_.uniform(low, high));
    for (float& value : colour) value *= factor;
    return colour;
  }

  cv::Scalar lit(const Colour& colour) const {
    const double light = 255.0 * scene_.brightness;
    return {light * scene_.cast[0] * colour[0], light * scene_.cast[1] * colour[1],
            light * scene_.cast[2] * colour[2]};
  }

  const Scene& scene_;
  common::RandomStream& random_;
  SceneLayers& layers_;
  double pixel_m_;
};

}  // namespace

void draw_distractors(const Scene& scene, common::RandomStream& random, SceneLayers& layers) {
  Painter painter(scene, random, layers);
  for (int i = 0; i < scene.stains; ++i) painter.stain();
  for (int i = 0; i < scene.scratches; ++i) painter.scratch();
  for (int i = 0; i < scene.threads; ++i) painter.thread();
  for (int i = 0; i < scene.bubbles; ++i) painter.bubble();
}

}  // namespace lodestone::imaging
