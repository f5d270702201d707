#include "lodestone/imaging/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "scene_background.h"

#include "lodestone/geometry/angle.h"

namespace lodestone::imaging {

namespace {

constexpr float kNoiseScale = 32.0F;         ///< grey levels of the bank per standard deviation
constexpr std::size_t kNoiseJump = 1 << 16;  ///< a row begins so many places, at most, after the one before

/// Normal numbers to read noise from, the same in every process.
std::vector<signed char> make_noise_bank(std::size_t size) {
  common::RandomStream random(1, "sensor noise bank");
  std::vector<signed char> bank(size);
  for (signed char& value : bank)
    value = static_cast<signed char>(
        std::lround(std::clamp(static_cast<float>(random.normal()) * kNoiseScale, -127.0F, 127.0F)));
  return bank;
}

/// The most an image of usual size needs; larger ones repeat it.
const std::vector<signed char>& noise_bank() {
  static const std::vector<signed char> bank = make_noise_bank(3 * 1280 * 1024 + kNoiseJump);
  return bank;
}

/// out = clean + gain / 256 * noise, clamped. Built for the widest vectors the processor has: this is most of
/// a frame's time.
// Sanitizers are not yet up when the loader chooses between the versions.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
__attribute__((target_clones("arch=skylake-avx512", "avx2", "default")))
#endif
void add_noise(const unsigned char* clean, const signed char* noise, short gain, std::size_t count,
               unsigned char* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto change = static_cast<short>((static_cast<short>(noise[i] * gain) + 128) >> 8);
    const auto value = static_cast<short>(clean[i] + change);
    out[i] = static_cast<unsigned char>(std::min<short>(std::max<short>(value, 0), 255));
  }
}

/// The sensor's noise for one frame: rows of the bank that begin anywhere and follow one another at any
/// distance, either way up, so that no two frames of a needle that lies still are alike, as a frozen camera's
/// are.
class FrameNoise {
 public:
  FrameNoise(double sigma_grey, common::RandomStream& random)
      : gain_(static_cast<short>((random.uniform() < 0.5 ? -1 : 1) *
                                 std::lround(256.0 * sigma_grey / kNoiseScale))),
        offset_(random.below(noise_bank().size())),
        jump_(random.below(kNoiseJump)) {}

  /// Noisy copy of an area; `clean` begins at the area's corner, `out` is the whole image.
  void apply(const cv::Mat& clean, const cv::Rect& area, cv::Mat& out) const {
    const std::vector<signed char>& bank = noise_bank();
    const std::size_t bytes = 3 * static_cast<std::size_t>(area.width);
    for (int v = 0; v < area.height; ++v) {
      const auto row = static_cast<std::size_t>(area.y + v);
      const std::size_t place =
          row * jump_ + 3 * (row * static_cast<std::size_t>(out.cols) + static_cast<std::size_t>(area.x));
      // Images larger than the bank read it again.
      const signed char* noise = bank.data() + (offset_ + place) % (bank.size() - bytes);
      add_noise(clean.ptr(v), noise, gain_, bytes, out.ptr(area.y + v) + 3 * area.x);
    }
  }

 private:
  short gain_;
  std::size_t offset_;
  std::size_t jump_;
};

/// A stain or another opaque thing over part of a needle, in the needle's frame (s along, d across).
struct Cover {
  float s_m = 0.0F;
  float half_length_m = 0.0F;
  float half_width_m = 0.0F;
  float wave = 0.0F;
  float phase = 0.0F;
  float opacity = 1.0F;
  Colour colour{};

  /// Opacity at a point.
  float at(float s, float d, float soft_m) const {
    const float x = (s - s_m) / half_length_m;
    const float y = d / half_width_m;
    const float r = std::hypot(x, y);
    if (r > 1.6F) return 0.0F;
    // The outline waves, but not where it crosses the needle's axis: what is asked for is covered, no more.
    const float sine = r > 0.0F ? y / r : 0.0F;
    const float outline = 1.0F + wave * sine * sine * std::sin(3.0F * std::atan2(y, x) + phase);
    return opacity * std::clamp(0.5F + (outline - r) * half_length_m / soft_m, 0.0F, 1.0F);
  }
};

Cover draw_cover(const NeedleView& needle, const BenchGeometry& bench, common::RandomStream& random) {
  static const Colour kColours[] = {
      {0.10F, 0.07F, 0.42F}, {0.06F, 0.04F, 0.22F}, {0.62F, 0.66F, 0.74F}, {0.12F, 0.12F, 0.12F}};
  Cover cover;
  const double half = 0.5 * needle.covered * bench.needle_length_m;
  const double room = 0.5 * bench.needle_length_m - half;
  cover.s_m = static_cast<float>(random.uniform(-room, room));
  cover.half_length_m = static_cast<float>(half);
  cover.half_width_m = static_cast<float>(random.uniform(0.0012, 0.004));
  cover.wave = static_cast<float>(random.uniform(0.0, 0.4));
  cover.phase = static_cast<float>(random.uniform(0.0, 2.0 * geometry::kPi));
  cover.opacity = static_cast<float>(random.uniform(0.75, 1.0));
  cover.colour = kColours[random.below(4)];
  return cover;
}

/// Needle and cover in one place of one frame.
class NeedlePainter {
 public:
  NeedlePainter(const Scene& scene, const SceneLayers& layers, const NeedleView& needle, const Cover& cover)
      : scene_(scene),
        layers_(layers),
        needle_(needle),
        cover_(cover),
        pixel_m_(static_cast<float>(scene.camera.pixel_size_m())),
        soft_m_(pixel_m_ * 3.0F * static_cast<float>(std::hypot(scene.blur_px, 0.3))),
        half_m_(0.5F * static_cast<float>(scene.bench.needle_length_m)),
        radius_m_(0.5F * static_cast<float>(scene.bench.needle_diameter_m)),
        tape_from_m_(half_m_ - static_cast<float>(scene.bench.tape_length_m)),
        steps_(std::clamp(static_cast<int>(std::ceil(needle.smear_m.norm() / pixel_m_)), 1, 24)) {}

  /// Part of the image that the needle and its cover can touch.
  cv::Rect area() const {
    const double margin_m = half_m_ + 0.5 * needle_.smear_m.norm() + 1e-3 +
                            (needle_.covered > 0.0 ? 1.5 * cover_.half_width_m : 0.0);
    const Eigen::Vector2d centre = scene_.camera.project_floor(needle_.pose.position_m());
    const double reach = margin_m / pixel_m_ * 1.15 + 8.0;
    const cv::Rect box(static_cast<int>(centre.x() - reach), static_cast<int>(centre.y() - reach),
                       static_cast<int>(2.0 * reach), static_cast<int>(2.0 * reach));
    return box & cv::Rect(0, 0, layers_.under.cols, layers_.under.rows);
  }

  /// Draws into `under`, which is the scene's `under` cut to `box`; masks are whole images or empty.
  void paint(const cv::Rect& box, cv::Mat& under, cv::Mat& needle_mask, cv::Mat& tape_mask) const {
    const float cos_h = static_cast<float>(std::cos(needle_.pose.heading_rad));
    const float sin_h = static_cast<float>(std::sin(needle_.pose.heading_rad));
    const float reach_s = half_m_ + static_cast<float>(needle_.smear_m.norm()) + 2.0F * soft_m_;
    float reach_d = radius_m_ + static_cast<float>(needle_.smear_m.norm()) + 2.0F * soft_m_;
    if (needle_.covered > 0.0) reach_d = std::max(reach_d, 1.5F * cover_.half_width_m + soft_m_);
    for (int v = box.y; v < box.y + box.height; ++v) {
      const auto* floor = layers_.floor_m.ptr<cv::Vec2f>(v);
      auto* out = under.ptr<cv::Vec3b>(v - box.y);
      for (int u = box.x; u < box.x + box.width; ++u) {
        const float dx = floor[u][0] - static_cast<float>(needle_.pose.x_m);
        const float dy = floor[u][1] - static_cast<float>(needle_.pose.y_m);
        const float s = cos_h * dx + sin_h * dy;
        const float d = cos_h * dy - sin_h * dx;
        if (std::abs(s) > reach_s + cover_.half_length_m || std::abs(d) > reach_d) continue;
        const Sample sample = smeared(s, d, cos_h, sin_h);
        if (!needle_mask.empty()) {
          mark(needle_mask, u, v, sample.coverage);
          mark(tape_mask, u, v, sample.tape);
        }
        const float hidden = needle_.covered > 0.0 ? cover_.at(s, d, soft_m_) : 0.0F;
        if (sample.coverage <= 0.0F && hidden <= 0.0F) continue;
        blend(sample, hidden, light_at(scene_, u, v), out[u - box.x]);
      }
    }
  }

 private:
  struct Sample {
    float coverage = 0.0F;
    float tape = 0.0F;
    Colour colour{};  ///< times coverage
  };

  /// Mean over the exposure.
  Sample smeared(float s, float d, float cos_h, float sin_h) const {
    Sample sum;
    for (int step = 0; step < steps_; ++step) {
      const float way = (static_cast<float>(step) + 0.5F) / static_cast<float>(steps_) - 0.5F;
      const float mx = way * static_cast<float>(needle_.smear_m.x());
      const float my = way * static_cast<float>(needle_.smear_m.y());
      add(s - (cos_h * mx + sin_h * my), d - (cos_h * my - sin_h * mx), sum);
    }
    const float fraction = 1.0F / static_cast<float>(steps_);
    sum.coverage *= fraction;
    sum.tape *= fraction;
    for (float& value : sum.colour) value *= fraction;
    return sum;
  }

  void add(float s, float d, Sample& sum) const {
    if (scene_.bench.sphere) return add_disc(s, d, sum);
    const float tape_edge = std::clamp(0.5F + (s - tape_from_m_) / soft_m_, 0.0F, 1.0F);
    const float radius = radius_m_ * (1.0F + 0.08F * tape_edge);
    const float inside_s = half_m_ - std::abs(s);
    const float inside_d = radius - std::abs(d);
    const float coverage =
        std::clamp(0.5F + inside_s / soft_m_, 0.0F, 1.0F) * std::clamp(0.5F + inside_d / soft_m_, 0.0F, 1.0F);
    if (coverage <= 0.0F) return;
    const float n = std::clamp(d / radius, -1.0F, 1.0F);
    const float round = std::sqrt(1.0F - 0.9F * n * n);
    const float off = (n - 0.25F) / 0.28F;
    const float streak = static_cast<float>(scene_.needle_shine) * std::exp(-off * off);
    const float steel = static_cast<float>(scene_.needle_grey) * (0.6F + 0.4F * round) + streak;
    sum.coverage += coverage;
    sum.tape += coverage * tape_edge;
    for (std::size_t i = 0; i < 3; ++i) {
      const float tape = scene_.tape[i] * (0.75F + 0.25F * round) + 0.25F * streak;
      sum.colour[i] += coverage * (steel + tape_edge * (tape - steel));
    }
  }

  /// A sphere seen from above: darker towards its edge, with the light's reflection beside its middle.
  void add_disc(float s, float d, Sample& sum) const {
    const float off_m = std::hypot(s, d);
    const float coverage = std::clamp(0.5F + (radius_m_ - off_m) / soft_m_, 0.0F, 1.0F);
    if (coverage <= 0.0F) return;
    const float n = std::min(off_m / radius_m_, 1.0F);
    const float round = std::sqrt(1.0F - 0.9F * n * n);
    const float off = std::hypot(s / radius_m_ - 0.2F, d / radius_m_ - 0.25F) / 0.28F;
    const float spot = static_cast<float>(scene_.needle_shine) * std::exp(-off * off);
    const float grey = static_cast<float>(scene_.needle_grey) * (0.6F + 0.4F * round) + spot;
    sum.coverage += coverage;
    for (float& value : sum.colour) value += coverage * grey;
  }

  void blend(const Sample& sample, float hidden, float light, cv::Vec3b& pixel) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const float gain = 255.0F * light * scene_.cast[i];
      float value = (1.0F - sample.coverage) * pixel[static_cast<int>(i)] + gain * sample.colour[i];
      value += hidden * (gain * cover_.colour[i] - value);
      pixel[static_cast<int>(i)] = cv::saturate_cast<unsigned char>(value);
    }
  }

  static void mark(cv::Mat& mask, int u, int v, float coverage) {
    unsigned char& value = mask.at<unsigned char>(v, u);
    value = std::max(value, cv::saturate_cast<unsigned char>(255.0F * coverage));
  }

  const Scene& scene_;
  const SceneLayers& layers_;
  const NeedleView& needle_;
  const Cover& cover_;
  float pixel_m_;
  float soft_m_;
  float half_m_;
  float radius_m_;
  float tape_from_m_;
  int steps_;
};

}  // namespace

struct SceneRenderer::Background {
  explicit Background(const Scene& drawn) : scene(drawn), layers(paint_layers(drawn)) {}
  Scene scene;
  SceneLayers layers;
};

SceneRenderer::SceneRenderer(const Scene& scene) : background_(std::make_unique<Background>(scene)) {}
SceneRenderer::~SceneRenderer() = default;
const Scene& SceneRenderer::scene() const { return background_->scene; }

RenderedFrame SceneRenderer::render(const std::vector<NeedleView>& needles, common::RandomStream& random,
                                    bool with_masks) const {
  const Scene& scene = background_->scene;
  const SceneLayers& layers = background_->layers;
  RenderedFrame frame;
  frame.image.create(layers.plain.size(), CV_8UC3);
  if (with_masks) {
    frame.needle_mask = cv::Mat::zeros(frame.image.size(), CV_8U);
    frame.tape_mask = cv::Mat::zeros(frame.image.size(), CV_8U);
  }
  std::vector<std::pair<cv::Rect, cv::Mat>> patches;
  cv::Mat under_all;  // where several needles may overlap, each is drawn on what the others left
  if (needles.size() > 1) under_all = layers.under.clone();
  for (const NeedleView& needle : needles) {
    const Cover cover = needle.covered > 0.0 ? draw_cover(needle, scene.bench, random) : Cover{};
    const NeedlePainter painter(scene, layers, needle, cover);
    const cv::Rect box = painter.area();
    if (box.empty()) continue;
    cv::Mat under = under_all.empty() ? layers.under(box).clone() : under_all(box);
    painter.paint(box, under, frame.needle_mask, frame.tape_mask);
    patches.emplace_back(box, under);
  }
  const FrameNoise noise(scene.noise_grey, random);
  noise.apply(layers.plain, {0, 0, layers.plain.cols, layers.plain.rows}, frame.image);
  for (const auto& [box, under] : patches) {
    cv::Mat patch(box.size(), CV_8UC3);
    compose(layers, under, box, patch);
    noise.apply(patch, box, frame.image);
  }
  return frame;
}

}  // namespace lodestone::imaging
