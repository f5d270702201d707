#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

#include "lodestone/imaging/dish_view.h"
#include "lodestone/vision/rod_fit.h"
#include "lodestone/vision/segmenter.h"

namespace lodestone::vision {

struct LocaliserConfig {
  double crop_m = 0.0512;
  double still_crop_m = 0.032;
  double still_m = 0.003;
  RodConfig rod;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("crop_m", crop_m, "m", "side of the square around the last pose that is searched while tracking",
            {0.001, 0.5});
    v.field("still_crop_m", still_crop_m, "m",
            "side of a smaller one, searched first while the needle hardly moves", {0.001, 0.5});
    v.field("still_m", still_m, "m", "a shorter way between two images is hardly moving", {0.0, 0.1});
    v.group("rod", rod, "the needle, and what counts as seeing it");
  }
};

struct Localisation : RodFit {
  bool tracked = false;  ///< seen near the last pose; otherwise the whole dish was searched
};

/// Camera image -> pose. Looks around the last pose first, and over the whole dish when the needle is not
/// there.
class Localiser {
 public:
  Localiser(std::shared_ptr<const Segmenter> segmenter, const imaging::CameraModel& camera,
            double dish_radius_m, const LocaliserConfig& config);

  /// `image`: [height, width] 8-bit BGR of the calibrated camera. Throws DataError when it has another
  /// size.
  Localisation locate(const cv::Mat& image);
  /// The next image is searched as a whole, or around `near_m`.
  void forget() { last_m_.reset(); }
  void expect(const geometry::Vector2& near_m) {
    last_m_ = near_m;
    still_ = false;
  }

 private:
  Localisation look(const cv::Mat& image, const cv::Rect& area);
  Localisation look_near(const cv::Mat& image, double side_m);
  void remember(const Localisation& found);
  bool inside(const geometry::Pose2& pose, const cv::Rect& area) const;

  std::shared_ptr<const Segmenter> segmenter_;
  LocaliserConfig config_;
  imaging::DishView view_;
  Segmenter::Workspace workspace_;
  std::optional<geometry::Vector2> last_m_;
  bool still_ = false;
};

}  // namespace lodestone::vision
