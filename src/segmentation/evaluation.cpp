#include "lodestone/segmentation/evaluation.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/imaging/scene_renderer.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/segmentation/needle_pose.h"
#include "lodestone/segmentation/training.h"

namespace lodestone::segmentation {

namespace {

constexpr double kLeastCovered = 0.05;
constexpr double kMostCovered = 0.40;
constexpr double kTrackedOff_m = 0.010;

/// Processor time of this thread: what one core needs, whatever else the machine does.
double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

struct Attempt {
  vision::Localisation found;
  geometry::Pose2 truth;
  double ms = 0.0;
};

/// One scene's images.
struct SceneResult {
  Attempt clean;
  Attempt occluded;
  Attempt tracked;
  Attempt again;  ///< another image of the needle that was tracked
  bool found_in_none = false;
  bool found_in_two = false;
  double render_ms = 0.0;
  double scene_ms = 0.0;
};

Attempt attempt(vision::Localiser& localiser, const cv::Mat& image, const geometry::Pose2& truth) {
  Attempt out;
  out.truth = truth;
  const double start_ms = thread_ms();
  out.found = localiser.locate(image);
  out.ms = thread_ms() - start_ms;
  return out;
}

SceneResult run_scene(const std::shared_ptr<const vision::Segmenter>& segmenter,
                      const imaging::SceneConfig& scenes, const vision::LocaliserConfig& config,
                      std::uint64_t seed, std::uint64_t index) {
  SceneResult result;
  const double start_ms = thread_ms();
  const imaging::SceneRenderer renderer(
      imaging::draw_scene(scenes, common::derive_seed(seed, "evaluation scene", index)));
  result.scene_ms = thread_ms() - start_ms;
  common::RandomStream random(seed, "evaluation frames", index);
  vision::Localiser localiser(segmenter, renderer.scene().camera, scenes.bench.dish_radius_m, config);
  const auto pose = [&] { return draw_needle_pose(scenes.bench, random); };

  const geometry::Pose2 bare = pose();
  const double render_start_ms = thread_ms();
  const imaging::RenderedFrame frame = renderer.render({{bare}}, random);
  result.render_ms = thread_ms() - render_start_ms;
  result.clean = attempt(localiser, frame.image, bare);

  const double off_m = kTrackedOff_m * std::sqrt(random.uniform());
  const double angle = random.uniform(-geometry::kPi, geometry::kPi);
  localiser.expect(bare.position_m() + off_m * geometry::Vector2(std::cos(angle), std::sin(angle)));
  result.tracked = attempt(localiser, frame.image, bare);

  result.again = attempt(localiser, renderer.render({{bare}}, random).image, bare);

  localiser.forget();
  result.found_in_none = localiser.locate(renderer.render({}, random).image).found;
  localiser.forget();
  result.found_in_two = localiser.locate(renderer.render({{bare}, {pose()}}, random).image).found;

  localiser.forget();
  const geometry::Pose2 hidden = pose();
  const double fraction = random.uniform(kLeastCovered, kMostCovered);
  result.occluded =
      attempt(localiser, renderer.render({{hidden, {0.0, 0.0}, fraction}}, random).image, hidden);
  return result;
}

/// Squared error in units of the variance that was told, for each number: of a sphere these are its place's.
double normalised_square(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  if (covariance(2, 2) > 0.0) return error.dot(covariance.inverse() * error) / 3.0;
  const Eigen::Vector2d place = error.head<2>();
  const Eigen::Matrix2d of_place = covariance.topLeftCorner<2, 2>();
  return place.dot(of_place.inverse() * place) / 2.0;
}

LocalisationScore score(const std::vector<Attempt>& attempts) {
  LocalisationScore out;
  std::vector<double> errors_mm;
  std::vector<double> ms;
  double square_mm2 = 0.0;
  double heading_rad2 = 0.0;
  double normalised = 0.0;
  std::int64_t upright = 0;
  for (const Attempt& attempt : attempts) {
    ++out.n;
    if (!attempt.found.found) {
      ++out.refusals[attempt.found.reason];
      continue;
    }
    ++out.poses;
    ms.push_back(attempt.ms);
    const geometry::Vector2 error_m = attempt.found.pose.position_m() - attempt.truth.position_m();
    errors_mm.push_back(1e3 * error_m.norm());
    square_mm2 += 1e6 * error_m.squaredNorm();
    const double turn_rad = geometry::wrap_angle(attempt.found.pose.heading_rad - attempt.truth.heading_rad);
    if (std::abs(turn_rad) > 0.5 * geometry::kPi) {
      ++out.flips;
      continue;
    }
    ++upright;
    heading_rad2 += turn_rad * turn_rad;
    const Eigen::Vector3d error(error_m.x(), error_m.y(), turn_rad);
    normalised += normalised_square(error, attempt.found.covariance);
  }
  if (out.poses == 0) return out;
  out.position_rms_mm = std::sqrt(square_mm2 / static_cast<double>(out.poses));
  out.ms_per_frame = common::median(ms);
  out.position_p95_mm = common::percentile(errors_mm, 0.95);
  out.position_max_mm = common::percentile(errors_mm, 1.0);
  if (upright == 0) return out;
  out.heading_rms_deg = 180.0 / geometry::kPi * std::sqrt(heading_rad2 / static_cast<double>(upright));
  out.normalised_error = normalised / static_cast<double>(upright);
  return out;
}

}  // namespace

std::string in_words(const LocalisationScore& score) {
  if (score.position_rms_mm) {
    char text[120];
    std::snprintf(text, sizeof text, "%.3f mm and %.2f degrees RMS", *score.position_rms_mm,
                  score.heading_rms_deg.value_or(180.0));
    return text;
  }
  std::string text = "no pose found";
  for (const auto& [reason, count] : score.refusals)
    text += "; " + std::to_string(count) + " times " + reason;
  return text;
}

LocalisationScore evaluate_views(const vision::Segmenter& segmenter, const imaging::DishView& view,
                                 const vision::RodConfig& rod, const std::vector<cv::Mat>& images,
                                 const std::vector<geometry::Pose2>& poses) {
  LODESTONE_CHECK(images.size() == poses.size(), "a pose for each image");
  vision::Segmenter::Workspace workspace;
  std::vector<Attempt> attempts;
  for (std::size_t i = 0; i < images.size(); ++i) {
    Attempt& attempt = attempts.emplace_back();
    attempt.truth = poses[i];
    const double start_ms = thread_ms();
    const vision::Evidence evidence = segmenter.segment(images[i], workspace);
    attempt.found = {vision::fit_rod(evidence, segmenter.grid_of(view, view.whole()), rod)};
    attempt.ms = thread_ms() - start_ms;
  }
  return score(attempts);
}

SegmenterEvaluation evaluate_segmenter(std::shared_ptr<const vision::Segmenter> segmenter,
                                       const imaging::SceneConfig& scenes,
                                       const vision::LocaliserConfig& localiser, std::int64_t frames,
                                       std::uint64_t seed, common::ThreadPool& pool) {
  std::vector<SceneResult> results(static_cast<std::size_t>(frames));
  pool.for_each(results.size(), [&](std::size_t index) {
    if (!common::interrupted()) results[index] = run_scene(segmenter, scenes, localiser, seed, index);
  });
  if (common::interrupted()) throw common::Interrupted("evaluation was interrupted");
  std::vector<Attempt> clean, occluded, tracked;
  std::vector<double> render_ms, scene_ms;
  SegmenterEvaluation evaluation;
  double apart_m2 = 0.0;
  double apart_rad2 = 0.0;
  std::int64_t pairs = 0;
  for (const SceneResult& result : results) {
    clean.push_back(result.clean);
    occluded.push_back(result.occluded);
    tracked.push_back(result.tracked);
    evaluation.poses_of_none += result.found_in_none ? 1 : 0;
    evaluation.poses_of_two += result.found_in_two ? 1 : 0;
    if (result.tracked.found.found && result.again.found.found) {
      const geometry::Pose2& first = result.tracked.found.pose;
      const geometry::Pose2& second = result.again.found.pose;
      ++pairs;
      apart_m2 += (second.position_m() - first.position_m()).squaredNorm();
      const double turn_rad = geometry::wrap_angle(second.heading_rad - first.heading_rad);
      apart_rad2 += turn_rad * turn_rad;
    }
    render_ms.push_back(result.render_ms);
    scene_ms.push_back(result.scene_ms);
  }
  // Two images differ by the error of both, hence the half.
  if (pairs > 0) {
    const double count = 2.0 * static_cast<double>(pairs);
    evaluation.repeatability_mm = 1e3 * std::sqrt(apart_m2 / count);
    evaluation.repeatability_deg = 180.0 / geometry::kPi * std::sqrt(apart_rad2 / count);
  }
  evaluation.clean = score(clean);
  evaluation.occluded = score(occluded);
  evaluation.tracked = score(tracked);
  evaluation.ms_per_rendered_frame = common::median(render_ms);
  evaluation.ms_per_scene = common::median(scene_ms);
  return evaluation;
}

imaging::SceneConfig training_scenes(const std::string& checkpoint_folder) {
  common::Json scenes = inference::load_checkpoint(checkpoint_folder, vision::Segmenter::kKind)
                            .config.value("scenes", common::Json::object());
  scenes.erase("bench");  // checkpoints of earlier versions hold sizes that are the rig's now
  return common::config_from_json<imaging::SceneConfig>(scenes, checkpoint_folder);
}

std::string in_words(const SegmenterEvaluation& evaluation) {
  return std::to_string(evaluation.clean.n) + " rendered frames: clean " + in_words(evaluation.clean) +
         ", partly covered " + in_words(evaluation.occluded);
}

}  // namespace lodestone::segmentation
