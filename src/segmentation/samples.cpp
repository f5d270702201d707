#include "lodestone/segmentation/samples.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <ATen/ops/empty.h>

#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/imaging/scene_renderer.h"
#include "lodestone/segmentation/needle_pose.h"
#include "sample_rows.h"

namespace lodestone::segmentation {

namespace {

/// Fills one row of the tensors.
class SampleMaker {
 public:
  SampleMaker(const SampleConfig& config, const vision::SegmenterConfig& segmenter, SegmenterSamples& out)
      : config_(config), segmenter_(segmenter), out_(out) {}

  void run(const imaging::SceneRenderer& renderer, const imaging::DishView& view,
           common::RandomStream& random, std::int64_t row) const {
    const imaging::BenchGeometry& bench = renderer.scene().bench;
    const std::vector<imaging::NeedleView> needles = draw_needles(bench, random);
    const imaging::RenderedFrame frame = renderer.render(needles, random, true);
    geometry::Vector2 centre = draw_needle_pose(bench, random).position_m();
    if (!needles.empty() && random.uniform() >= config_.elsewhere) {
      const double room_m = 0.5 * config_.crop_px * view.pixel_m() - 0.25 * bench.needle_length_m;
      centre = needles.front().pose.position_m() +
               geometry::Vector2(random.uniform(-room_m, room_m), random.uniform(-room_m, room_m));
    }
    const cv::Rect area = view.around(centre, static_cast<int>(config_.crop_px));
    store_image(view.cut(frame.image, area), row, out_);
    store_mask(view.cut(frame.needle_mask, area), row, 0, out_);
    store_mask(view.cut(frame.tape_mask, area), row, 1, out_);
  }

 private:
  std::vector<imaging::NeedleView> draw_needles(const imaging::BenchGeometry& bench,
                                                common::RandomStream& random) const {
    const double kind = random.uniform();
    const int count = kind < config_.none ? 0 : kind < config_.none + config_.two ? 2 : 1;
    std::vector<imaging::NeedleView> needles;
    for (int i = 0; i < count; ++i) {
      imaging::NeedleView needle;
      needle.pose = draw_needle_pose(bench, random);
      if (random.uniform() < config_.covered) needle.covered = random.uniform(0.03, config_.max_covered);
      if (random.uniform() < config_.moving) {
        const double way_m = random.uniform(0.0, 1e-3);
        const double angle = random.uniform(-geometry::kPi, geometry::kPi);
        needle.smear_m = {way_m * std::cos(angle), way_m * std::sin(angle)};
      }
      needles.push_back(needle);
    }
    return needles;
  }

  const SampleConfig& config_;
  const vision::SegmenterConfig& segmenter_;
  SegmenterSamples& out_;
};

}  // namespace

SegmenterSamples render_samples(const imaging::SceneConfig& scenes, const SampleConfig& config,
                                const vision::SegmenterConfig& segmenter, std::int64_t count,
                                std::uint64_t seed, common::ThreadPool& pool) {
  const inference::UNetConfig& network = segmenter.network;
  LODESTONE_CHECK(config.crop_px % network.multiple() == 0, "crops the network can take");
  const std::int64_t mask_px = config.crop_px * network.upscale / network.stem;
  SegmenterSamples samples;
  samples.images = at::empty({count, 3, config.crop_px, config.crop_px}, at::kByte);
  samples.masks = at::empty({count, 2, mask_px, mask_px}, at::kByte);
  const std::int64_t scene_count = (count + config.frames_per_scene - 1) / config.frames_per_scene;
  const SampleMaker maker(config, segmenter, samples);
  pool.for_each(static_cast<std::size_t>(scene_count), [&](std::size_t index) {
    if (common::interrupted()) return;
    const imaging::SceneRenderer renderer(
        imaging::draw_scene(scenes, common::derive_seed(seed, "training scene", index)));
    const imaging::DishView view(renderer.scene().camera, scenes.bench.dish_radius_m, segmenter.view_margin_m,
                                 segmenter.view_pixel_m, network.multiple());
    common::RandomStream random(seed, "training frames", index);
    const std::int64_t first = static_cast<std::int64_t>(index) * config.frames_per_scene;
    const std::int64_t last = std::min(first + config.frames_per_scene, count);
    for (std::int64_t row = first; row < last; ++row) maker.run(renderer, view, random, row);
  });
  if (common::interrupted()) throw common::Interrupted("rendering of training images was interrupted");
  return samples;
}

}  // namespace lodestone::segmentation
