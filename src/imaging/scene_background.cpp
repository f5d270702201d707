#include "scene_background.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "distractors.h"
#include "obstacles.h"

namespace lodestone::imaging {

namespace {

constexpr int kMapStep_px = 16;

Colour operator*(float factor, const Colour& colour) {
  return {factor * colour[0], factor * colour[1], factor * colour[2]};
}

Colour mix(const Colour& a, const Colour& b, float fraction_of_b) {
  Colour out;
  for (int i = 0; i < 3; ++i) out[i] = a[i] + fraction_of_b * (b[i] - a[i]);
  return out;
}

Colour grey(float value) { return {value, value, value}; }

/// 0 below -width/2, 1 above +width/2.
float edge(float distance, float width) { return std::clamp(0.5F + distance / width, 0.0F, 1.0F); }

/// The camera's inverse on a coarse grid, linear between: exact to a thousandth of a pixel for a lens.
cv::Mat floor_map(const CameraModel& camera) {
  const int width = static_cast<int>(camera.width_px);
  const int height = static_cast<int>(camera.height_px);
  const int columns = width / kMapStep_px + 2;
  const int rows = height / kMapStep_px + 2;
  cv::Mat_<cv::Vec2f> grid(rows, columns);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const geometry::Vector2 point =
          camera.to_dish({static_cast<double>(column * kMapStep_px), static_cast<double>(row * kMapStep_px)});
      grid(row, column) = {static_cast<float>(point.x()), static_cast<float>(point.y())};
    }
  }
  cv::Mat map(height, width, CV_32FC2);
  for (int v = 0; v < height; ++v) {
    const int row = v / kMapStep_px;
    const float down = static_cast<float>(v % kMapStep_px) / kMapStep_px;
    auto* out = map.ptr<cv::Vec2f>(v);
    for (int u = 0; u < width; ++u) {
      const int column = u / kMapStep_px;
      const float right = static_cast<float>(u % kMapStep_px) / kMapStep_px;
      const cv::Vec2f top = grid(row, column) + right * (grid(row, column + 1) - grid(row, column));
      const cv::Vec2f bottom =
          grid(row + 1, column) + right * (grid(row + 1, column + 1) - grid(row + 1, column));
      out[u] = top + down * (bottom - top);
    }
  }
  return map;
}

/// Smooth unevenness, standard deviation 1, a few cells across the image.
cv::Mat unevenness(common::RandomStream& random, cv::Size size, int cells) {
  cv::Mat_<float> grid(cells, cells);
  for (float& value : grid) value = static_cast<float>(random.normal());
  cv::Mat smooth;
  cv::resize(grid, smooth, size, 0.0, 0.0, cv::INTER_CUBIC);
  return smooth;
}

/// Colours of the bench, before light, by the ray of a pixel: it leaves `eye` and meets the floor plane at
/// (x, y).
class Bench {
 public:
  explicit Bench(const Scene& scene)
      : bench_(scene.bench),
        eye_((-(scene.camera.rotation.transpose() * scene.camera.translation_m)).cast<float>()),
        pixel_m_(static_cast<float>(scene.camera.pixel_size_m())),
        floor_(mix(grey(static_cast<float>(scene.floor_grey)),
                   {static_cast<float>(scene.floor_grey) * 0.75F,
                    static_cast<float>(scene.floor_grey) * 0.95F, static_cast<float>(scene.floor_grey)},
                   static_cast<float>(8.0 * scene.fluid_tint))) {}

  /// `r_floor`: how far from the dish centre the ray meets the floor, bent by the fluid. `texture` is about
  /// normal.
  Colour at(float x, float y, float r_floor, float texture) const {
    const float radius = static_cast<float>(bench_.dish_radius_m);
    if (r_floor < radius - 2.0F * pixel_m_) return (1.0F + 0.02F * texture) * floor_;
    // The ray passes the top of the wall at this fraction of its way.
    const float up = static_cast<float>(bench_.wall_height_m) / eye_.z();
    const float r_top = std::hypot(x + up * (eye_.x() - x), y + up * (eye_.y() - y));
    const float thickness = static_cast<float>(bench_.wall_thickness_m);
    const Colour inside = mix(floor_, 0.72F * floor_, edge(r_floor - radius, pixel_m_));
    Colour colour = mix(inside, grey(0.93F), edge(r_top - radius, pixel_m_));
    return mix(colour, outside(x, y, texture), edge(r_top - radius - thickness, pixel_m_));
  }

 private:
  /// Plate and coils.
  Colour outside(float x, float y, float texture) const {
    const float face = static_cast<float>(bench_.coil_face_m);
    const float reach = static_cast<float>(bench_.coil_outer_radius_m);
    const float along_x = std::abs(x);
    const float along_y = std::abs(y);
    const bool on_x = along_x > along_y;
    const float depth = (on_x ? along_x : along_y) - face;
    const float across = on_x ? along_y : along_x;
    const float shade = across < reach ? 1.0F - 0.35F * std::exp(-std::max(-depth, 0.0F) / 0.006F) : 1.0F;
    const Colour plate = (shade * (1.0F + 0.03F * texture)) * grey(0.42F);
    if (depth < -pixel_m_) return plate;
    return mix(plate, coil(x, y, on_x, texture), edge(depth, pixel_m_));
  }

  Colour coil(float x, float y, bool on_x, float texture) const {
    const float face = static_cast<float>(bench_.coil_face_m);
    const float a = on_x ? x : y;
    const float b = on_x ? y : x;
    const float eye_a = on_x ? eye_.x() : eye_.y();
    const float eye_b = on_x ? eye_.y() : eye_.x();
    const float plane = a > 0.0F ? face : -face;
    const float way = (plane - eye_a) / (a - eye_a);  // 1 at the floor plane
    const float side = eye_b + way * (b - eye_b);
    const float height = eye_.z() * (1.0F - way);
    const float r = std::hypot(side, height);
    const Colour copper{0.16F, 0.30F, 0.52F};
    const float stripes = 1.0F + 0.12F * std::cos(r * 4200.0F) + 0.05F * texture;
    const Colour winding = stripes * copper;
    const Colour face_colour =
        mix(grey(0.06F), winding, edge(r - static_cast<float>(bench_.coil_bore_radius_m), 2.0F * pixel_m_));
    const Colour top = (0.6F * stripes) * copper;  // the round outside of the winding, seen from above
    return mix(face_colour,
               std::abs(side) < static_cast<float>(bench_.coil_outer_radius_m) ? top : grey(0.40F),
               edge(r - static_cast<float>(bench_.coil_outer_radius_m), 2.0F * pixel_m_));
  }

  BenchGeometry bench_;
  Eigen::Vector3f eye_;
  float pixel_m_;
  Colour floor_;
};

/// `straight_m`: where the rays would meet the floor plane without fluid, as they do outside the dish.
cv::Mat paint_bench(const Scene& scene, const cv::Mat& straight_m, const cv::Mat& floor_m,
                    common::RandomStream& random) {
  const Bench bench(scene);
  const cv::Mat texture = unevenness(random, floor_m.size(), 24);
  cv::Mat painted(floor_m.size(), CV_8UC3);
  for (int v = 0; v < painted.rows; ++v) {
    const auto* straight = straight_m.ptr<cv::Vec2f>(v);
    const auto* floor = floor_m.ptr<cv::Vec2f>(v);
    const auto* rough = texture.ptr<float>(v);
    auto* out = painted.ptr<cv::Vec3b>(v);
    for (int u = 0; u < painted.cols; ++u) {
      const Colour colour =
          bench.at(straight[u][0], straight[u][1], std::hypot(floor[u][0], floor[u][1]), rough[u]);
      const float light = 255.0F * light_at(scene, u, v);
      for (int i = 0; i < 3; ++i) {
        const float gain = light * scene.cast[static_cast<std::size_t>(i)];
        out[u][i] = cv::saturate_cast<unsigned char>(gain * colour[static_cast<std::size_t>(i)]);
      }
    }
  }
  return painted;
}

/// The ring light mirrored by the fluid: a ring, uneven along its way, and a faint veil inside.
cv::Mat paint_glare(const Scene& scene, const cv::Mat& floor_m, common::RandomStream& random) {
  const float strength = 255.0F * static_cast<float>(scene.glare * scene.brightness);
  const auto radius = static_cast<float>(scene.bench.dish_radius_m * random.uniform(0.35, 0.8));
  const auto width = static_cast<float>(random.uniform(0.8e-3, 2.5e-3));
  const auto off_x = static_cast<float>(random.uniform(-0.006, 0.006));
  const auto off_y = static_cast<float>(random.uniform(-0.006, 0.006));
  const auto phase = static_cast<float>(random.uniform(0.0, 6.28));
  const auto lobes = static_cast<float>(2 + random.below(4));
  const auto dish = static_cast<float>(scene.bench.dish_radius_m);
  cv::Mat glare = cv::Mat::zeros(floor_m.size(), CV_8U);
  if (strength <= 0.0F) return glare;
  for (int v = 0; v < glare.rows; ++v) {
    const auto* floor = floor_m.ptr<cv::Vec2f>(v);
    auto* out = glare.ptr<unsigned char>(v);
    for (int u = 0; u < glare.cols; ++u) {
      if (std::hypot(floor[u][0], floor[u][1]) > dish) continue;
      const float x = floor[u][0] - off_x;
      const float y = floor[u][1] - off_y;
      const float from_ring = (std::hypot(x, y) - radius) / width;
      float shine = 0.08F;
      if (std::abs(from_ring) < 3.0F)
        shine +=
            std::exp(-from_ring * from_ring) * (0.55F + 0.45F * std::cos(lobes * std::atan2(y, x) + phase));
      out[u] = cv::saturate_cast<unsigned char>(strength * shine);
    }
  }
  return glare;
}

void blur(cv::Mat& image, double sigma_px) {
  if (sigma_px > 0.05) cv::GaussianBlur(image, image, {}, sigma_px);
}

}  // namespace

float light_at(const Scene& scene, double u_px, double v_px) {
  const double half_u = 0.5 * static_cast<double>(scene.camera.width_px);
  const double half_v = 0.5 * static_cast<double>(scene.camera.height_px);
  const double du = (u_px - half_u) / half_u;
  const double dv = (v_px - half_v) / half_v;
  return static_cast<float>(scene.brightness * (1.0 - 0.5 * scene.vignetting * (du * du + dv * dv)));
}

void compose(const SceneLayers& layers, const cv::Mat& under, const cv::Rect& area, cv::Mat& image) {
  for (int v = area.y; v < area.y + area.height; ++v) {
    const auto* below = under.ptr<cv::Vec3b>(v - area.y);
    const auto* above = layers.over.ptr<cv::Vec3b>(v);
    const auto* alpha = layers.over_alpha.ptr<unsigned char>(v);
    const auto* shine = layers.glare.ptr<unsigned char>(v);
    auto* out = image.ptr<cv::Vec3b>(v - area.y) - area.x;
    for (int u = area.x; u < area.x + area.width; ++u) {
      const int clear = 255 - alpha[u];
      for (int i = 0; i < 3; ++i) {
        int value = below[u - area.x][i] + shine[u];
        if (clear != 255) value = above[u][i] + (below[u - area.x][i] * clear + 127) / 255 + shine[u];
        out[u][i] = static_cast<unsigned char>(std::min(value, 255));
      }
    }
  }
}

SceneLayers paint_layers(const Scene& scene) {
  common::RandomStream random(scene.seed, "scene/paint");
  SceneLayers layers;
  CameraModel straight = scene.camera, bent = scene.camera;
  straight.fluid = {};
  bent.fluid.radius_m = 1e3;  // without a seam at the wall, which hides where the fluid ends
  const cv::Mat straight_m = floor_map(straight);
  layers.floor_m = scene.camera.fluid.depth_m > 0.0 ? floor_map(bent) : straight_m;
  layers.under = paint_bench(scene, straight_m, layers.floor_m, random);
  layers.glare = paint_glare(scene, layers.floor_m, random);
  layers.over = cv::Mat::zeros(layers.under.size(), CV_8UC3);
  layers.over_alpha = cv::Mat::zeros(layers.under.size(), CV_8U);
  draw_distractors(scene, random, layers);
  draw_obstacles(scene, layers);
  blur(layers.under, scene.blur_px);
  blur(layers.over, scene.blur_px);
  blur(layers.over_alpha, scene.blur_px);
  layers.plain.create(layers.under.size(), CV_8UC3);
  compose(layers, layers.under, {0, 0, layers.under.cols, layers.under.rows}, layers.plain);
  return layers;
}

}  // namespace lodestone::imaging
