#include "obstacles.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "drawing.h"

namespace lodestone::imaging {

namespace {

constexpr double kPiece_m = 2e-3;  // of a side, which the lens bends

/// The outline in the image, in sixteenths of a pixel.
std::vector<cv::Point> seen_outline(const CameraModel& camera,
                                    const std::vector<geometry::Vector2>& corners_m) {
  std::vector<cv::Point> outline;
  for (std::size_t i = 0; i < corners_m.size(); ++i) {
    const geometry::Vector2 side_m = corners_m[(i + 1) % corners_m.size()] - corners_m[i];
    const int pieces = std::max(1, static_cast<int>(std::ceil(side_m.norm() / kPiece_m)));
    for (int piece = 0; piece < pieces; ++piece) {
      const geometry::Vector2 point_m = corners_m[i] + (static_cast<double>(piece) / pieces) * side_m;
      const Eigen::Vector2d pixel = camera.project_floor(point_m) * (1 << kShift);
      outline.emplace_back(static_cast<int>(std::lround(pixel.x())),
                           static_cast<int>(std::lround(pixel.y())));
    }
  }
  return outline;
}

}  // namespace

void draw_obstacles(const Scene& scene, SceneLayers& layers) {
  if (scene.bench.obstacles_m.empty()) return;
  cv::Mat solid = cv::Mat::zeros(layers.under.size(), CV_8U);
  for (const std::vector<geometry::Vector2>& corners_m : scene.bench.obstacles_m)
    cv::fillPoly(solid, std::vector<std::vector<cv::Point>>{seen_outline(scene.camera, corners_m)},
                 cv::Scalar(255), cv::LINE_AA, kShift);
  for (int v = 0; v < solid.rows; ++v) {
    const auto* share = solid.ptr<unsigned char>(v);
    auto* out = layers.under.ptr<cv::Vec3b>(v);
    for (int u = 0; u < solid.cols; ++u) {
      if (share[u] == 0) continue;
      const float covered = static_cast<float>(share[u]) / 255.0F;
      const float light = 255.0F * static_cast<float>(scene.obstacle_grey) * light_at(scene, u, v);
      for (int i = 0; i < 3; ++i) {
        const float value = light * scene.cast[static_cast<std::size_t>(i)];
        out[u][i] = cv::saturate_cast<unsigned char>((1.0F - covered) * out[u][i] + covered * value);
      }
    }
  }
}

}  // namespace lodestone::imaging
