#include "lodestone/vision/localiser.h"

#include <algorithm>
#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::vision {

namespace {

/// Both ends must be this far inside the area: what is cut off at its border may be longer than it looks.
constexpr double kBorder_m = 0.8e-3;

}  // namespace

Localiser::Localiser(std::shared_ptr<const Segmenter> segmenter, const imaging::CameraModel& camera,
                     double dish_radius_m, const LocaliserConfig& config)
    : segmenter_(std::move(segmenter)), config_(config), view_(segmenter_->view_of(camera, dish_radius_m)) {}

bool Localiser::inside(const geometry::Pose2& pose, const cv::Rect& area) const {
  const geometry::Vector2 low = view_.to_dish(area.x, area.y + area.height - 1);
  const geometry::Vector2 high = view_.to_dish(area.x + area.width - 1, area.y);
  if (config_.rod.sphere) {
    const double reach_m = 0.5 * config_.rod.needle_diameter_m + kBorder_m;
    return (pose.position_m().array() > low.array() + reach_m).all() &&
           (pose.position_m().array() < high.array() - reach_m).all() && view_.shows(pose.position_m());
  }
  const geometry::Vector2 half = 0.5 * config_.rod.needle_length_m *
                                 geometry::Vector2(std::cos(pose.heading_rad), std::sin(pose.heading_rad));
  for (const double sign : {-1.0, 1.0}) {
    const geometry::Vector2 end = pose.position_m() + sign * half;
    const bool seen = (end.array() > low.array() + kBorder_m).all() &&
                      (end.array() < high.array() - kBorder_m).all() && view_.shows(end);
    if (!seen) return false;
  }
  return true;
}

Localisation Localiser::look(const cv::Mat& image, const cv::Rect& area) {
  const Evidence evidence = segmenter_->segment(view_.cut(image, area), workspace_);
  Localisation found{fit_rod(evidence, segmenter_->grid_of(view_, area), config_.rod)};
  if (found.axis_found && !inside(found.pose, area)) {
    found.found = found.axis_found = false;
    found.reason = "the needle leaves the view";
  }
  const auto cut_off = [&](const Rod& rod) { return !inside(rod.pose, area); };
  found.candidates.erase(std::remove_if(found.candidates.begin(), found.candidates.end(), cut_off),
                         found.candidates.end());
  return found;
}

/// A square around the last pose.
Localisation Localiser::look_near(const cv::Mat& image, double side_m) {
  const std::int64_t multiple = segmenter_->config().network.multiple();
  const auto side_px = static_cast<std::int64_t>(std::lround(side_m / view_.pixel_m()));
  const std::int64_t fitting_px = std::max<std::int64_t>(1, side_px / multiple) * multiple;
  Localisation found = look(image, view_.around(*last_m_, static_cast<int>(fitting_px)));
  found.tracked = found.axis_found;
  return found;
}

void Localiser::remember(const Localisation& found) {
  if (!found.axis_found) {
    forget();
    return;
  }
  const geometry::Vector2 now_m = found.pose.position_m();
  still_ = last_m_ && (now_m - *last_m_).norm() < config_.still_m;
  last_m_ = now_m;
}

Localisation Localiser::locate(const cv::Mat& image) {
  Localisation found;
  if (last_m_ && still_) found = look_near(image, config_.still_crop_m);
  if (last_m_ && !found.axis_found) found = look_near(image, config_.crop_m);
  if (!found.axis_found) found = look(image, view_.whole());
  remember(found);
  return found;
}

}  // namespace lodestone::vision
