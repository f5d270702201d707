#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/artefact.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/imaging/scene.h"
#include "lodestone/vision/localiser.h"
#include "lodestone/vision/segmenter.h"

namespace lodestone::segmentation {

/// How well poses are found over some images. Errors are absent where no pose was found.
struct LocalisationScore {
  std::optional<double> position_rms_mm;  ///< over images with a pose
  std::optional<double> position_p95_mm;
  std::optional<double> position_max_mm;
  std::optional<double> heading_rms_deg;  ///< over images with a pose that is not flipped
  std::int64_t flips = 0;                 ///< poses with head and tail the wrong way round
  std::int64_t poses = 0;
  std::int64_t n = 0;
  /// Mean squared error over the covariance the localiser states, per dimension: 1 is honest, more is too
  /// sure.
  std::optional<double> normalised_error;
  std::optional<double> ms_per_frame;  ///< processor time of one core, median over images with a pose
  std::map<std::string, std::int64_t> refusals;  ///< images without a pose, by reason

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("position_rms_mm", position_rms_mm);
    v.field("position_p95_mm", position_p95_mm);
    v.field("position_max_mm", position_max_mm);
    v.field("heading_rms_deg", heading_rms_deg);
    v.field("flips", flips);
    v.field("poses", poses);
    v.field("n", n);
    v.field("ms_per_frame", ms_per_frame);
    v.field("normalised_error", normalised_error);
    v.field("refusals", refusals);
  }
};

struct SegmenterEvaluation {
  LocalisationScore clean;                 ///< nothing covers the needle
  LocalisationScore occluded;              ///< 5 to 40 % of its length covered
  LocalisationScore tracked;               ///< clean, searched around a place up to 10 mm off
  std::int64_t poses_of_none = 0;          ///< poses given for images without a needle; each is a guess
  std::int64_t poses_of_two = 0;           ///< poses given for images with two needles, likewise
  std::optional<double> repeatability_mm;  ///< RMS between two images of a needle that lies still
  std::optional<double> repeatability_deg;
  double ms_per_rendered_frame = 0.0;
  double ms_per_scene = 0.0;  ///< rendering of what stays from frame to frame

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("clean", clean);
    v.field("occluded", occluded);
    v.field("tracked", tracked);
    v.field("poses_of_none", poses_of_none);
    v.field("poses_of_two", poses_of_two);
    v.field("repeatability_mm", repeatability_mm);
    v.field("repeatability_deg", repeatability_deg);
    v.field("ms_per_frame", clean.ms_per_frame);
    v.field("ms_per_tracked_frame", tracked.ms_per_frame);
    v.field("ms_per_rendered_frame", ms_per_rendered_frame);
    v.field("ms_per_scene", ms_per_scene);
  }
};

/// Localises needles in rendered images: `frames` scenes from `scenes`, each once clean and once partly
/// covered; the camera is known. Scenes have random streams of their own: results do not depend on threads.
SegmenterEvaluation evaluate_segmenter(std::shared_ptr<const vision::Segmenter> segmenter,
                                       const imaging::SceneConfig& scenes,
                                       const vision::LocaliserConfig& localiser, std::int64_t frames,
                                       std::uint64_t seed, common::ThreadPool& pool);

/// Localises the needle in whole views of a dish whose poses are known, as a localiser does that has just
/// begun.
LocalisationScore evaluate_views(const vision::Segmenter& segmenter, const imaging::DishView& view,
                                 const vision::RodConfig& rod, const std::vector<cv::Mat>& images,
                                 const std::vector<geometry::Pose2>& poses);

/// Scenes that a segmenter was trained on. Throws CheckpointError.
imaging::SceneConfig training_scenes(const std::string& checkpoint_folder);

/// One line: the errors, clean and partly covered, or that no pose was found and why not.
std::string in_words(const SegmenterEvaluation& evaluation);
std::string in_words(const LocalisationScore& score);

}  // namespace lodestone::segmentation
