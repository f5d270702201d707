#include "lodestone/segmentation/label_proposals.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/vision/rod_fit.h"

namespace lodestone::segmentation {
namespace {

using geometry::Vector2;

constexpr std::size_t kMostOfMedian = 41;  // images
constexpr double kAboveNoise = 6.0;        // standard deviations
constexpr double kMostLogOdds = 5.0;
constexpr double kPerFactor = 1.2;        // log-odds of a pixel e times as far from the background
constexpr double kLeastTape_grey = 12.0;  // levels of 255 by which the ends differ, of needles with a tape

/// What is there without the needle, which lies elsewhere in most images.
cv::Mat median_of(const std::vector<cv::Mat>& images) {
  const std::size_t count = std::min(images.size(), kMostOfMedian);
  cv::Mat median(images.front().size(), CV_8UC3);
  std::vector<unsigned char> values(count);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
  for (int row = 0; row < median.rows; ++row) {
    auto* out = median.ptr<unsigned char>(row);
    for (int i = 0; i < 3 * median.cols; ++i) {
      for (std::size_t k = 0; k < count; ++k)
        values[k] = images[k * images.size() / count].ptr<unsigned char>(row)[i];
      std::nth_element(values.begin(), middle, values.end());
      out[i] = *middle;
    }
  }
  return median;
}

cv::Mat disc_of(const imaging::DishView& view, double radius_m) {
  cv::Mat disc = cv::Mat::zeros(view.size_px(), view.size_px(), CV_8U);
  const int middle = view.size_px() / 2;
  cv::circle(disc, {middle, middle}, static_cast<int>(radius_m / view.pixel_m()), cv::Scalar(255),
             cv::FILLED);
  return disc;
}

/// Log-odds that a pixel is none of the background: how far it is from that, beyond the noise of most pixels.
/// Where it is far beyond they grow slowly, so that they still fall towards the needle's blurred ends, whose
/// place they tell.
cv::Mat moved_log_odds(const cv::Mat& image, const cv::Mat& background, const cv::Mat& disc) {
  const cv::Scalar seen = cv::mean(image, disc), usual = cv::mean(background, disc);
  cv::Scalar gain;
  for (int i = 0; i < 3; ++i) gain[i] = usual[i] / std::max(seen[i], 1.0);
  cv::Mat levelled, difference, largest, smooth;
  cv::multiply(image, gain, levelled);
  cv::absdiff(levelled, background, difference);
  std::vector<cv::Mat> channels;
  cv::split(difference, channels);
  cv::max(channels[0], channels[1], largest);
  cv::max(largest, channels[2], largest);
  largest.convertTo(smooth, CV_32F);
  cv::blur(smooth, smooth, {3, 3});
  std::vector<double> levels;
  for (int row = 0; row < smooth.rows; row += 2)
    for (int column = 0; column < smooth.cols; column += 2)
      if (disc.at<unsigned char>(row, column) != 0) levels.push_back(smooth.at<float>(row, column));
  const double usual_level = common::median(levels);
  for (double& level : levels) level = std::abs(level - usual_level);
  const double noise = std::max(1.4826 * common::median(levels), 0.5);
  cv::Mat log_odds(smooth.size(), CV_32F);
  for (int row = 0; row < smooth.rows; ++row) {
    const auto* level = smooth.ptr<float>(row);
    const auto* inside = disc.ptr<unsigned char>(row);
    auto* out = log_odds.ptr<float>(row);
    for (int column = 0; column < smooth.cols; ++column) {
      const double above = (level[column] - usual_level) / noise - kAboveNoise;
      const double odds = above > 0.0 ? kPerFactor * std::log1p(above / kAboveNoise) : above;
      out[column] = static_cast<float>(inside[column] == 0 ? -kMostLogOdds
                                                           : std::clamp(odds, -kMostLogOdds, kMostLogOdds));
    }
  }
  return log_odds;
}

/// Mean colour along the needle, from one place to another (m from its middle towards the head).
Eigen::Vector3d colour(const cv::Mat& image, const imaging::DishView& view, const geometry::Pose2& pose,
                       double from_m, double to_m) {
  const double middle = 0.5 * (view.size_px() - 1);
  const Vector2 along(std::cos(pose.heading_rad), std::sin(pose.heading_rad));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (double s_m = from_m; s_m <= to_m; s_m += 0.5 * view.pixel_m()) {
    const Vector2 at_m = pose.position_m() + s_m * along;
    const int column = static_cast<int>(std::lround(middle + at_m.x() / view.pixel_m()));
    const int row = static_cast<int>(std::lround(middle - at_m.y() / view.pixel_m()));
    if (column < 0 || row < 0 || column >= image.cols || row >= image.rows) continue;
    const cv::Vec3b& pixel = image.at<cv::Vec3b>(row, column);
    sum += Eigen::Vector3d(pixel[0], pixel[1], pixel[2]);
    ++count;
  }
  return sum / std::max(count, 1);
}

/// Turns the labels of one needle so that they point to its head.
class HeadFinder {
 public:
  HeadFinder(const FrameViews& frames, const imaging::BenchGeometry& bench, FrameLabels& labels)
      : labels_(labels) {
    const double half_m = 0.5 * bench.needle_length_m;
    for (std::size_t i = 0; i < labels.labels.size(); ++i) {
      if (!labels.labels[i].pose) continue;
      const geometry::Pose2& pose = *labels.labels[i].pose;
      const cv::Mat& image = frames.images[i];
      const double inner_m = half_m - 0.9 * bench.tape_length_m, outer_m = half_m - 0.1 * bench.tape_length_m;
      const Eigen::Vector3d middle = colour(image, frames.view, pose, -0.4 * half_m, 0.4 * half_m);
      ends_.push_back({i, colour(image, frames.view, pose, inner_m, outer_m) - middle,
                       colour(image, frames.view, pose, -outer_m, -inner_m) - middle});
    }
  }

  void run() {
    if (ends_.empty()) return;
    // All needles differ along one direction of colour, this way or that way round.
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Ends& ends : ends_)
      spread += (ends.ahead - ends.behind) * (ends.ahead - ends.behind).transpose();
    const Eigen::Vector3d direction =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2);
    Eigen::Vector3d first = Eigen::Vector3d::Zero(), second = Eigen::Vector3d::Zero();
    std::vector<double> strengths;
    for (Ends& ends : ends_) {
      ends.strength = direction.dot(ends.ahead - ends.behind);
      first += ends.strength > 0.0 ? ends.ahead : ends.behind;
      second += ends.strength > 0.0 ? ends.behind : ends.ahead;
      strengths.push_back(std::abs(ends.strength));
    }
    const double usual = common::median(strengths);
    labels_.taped = usual >= kLeastTape_grey;
    const bool first_is_head = first.norm() >= second.norm();
    for (const Ends& ends : ends_) {
      FrameLabel& label = labels_.labels[ends.label];
      const bool ahead = (ends.strength > 0.0) == first_is_head;
      if (!ahead) label.pose->heading_rad = geometry::wrap_angle(label.pose->heading_rad + geometry::kPi);
      const double less = labels_.taped ? 1.0 - std::abs(ends.strength) / usual : 0.0;
      label.doubt = std::clamp(std::max(label.doubt, less), 0.0, 1.0);
    }
  }

 private:
  struct Ends {
    std::size_t label;
    Eigen::Vector3d ahead, behind;  // colour over that of the needle's middle
    double strength = 0.0;
  };

  FrameLabels& labels_;
  std::vector<Ends> ends_;
};

}  // namespace

FrameLabels propose_labels(const FrameViews& frames, const imaging::BenchGeometry& bench) {
  LODESTONE_CHECK(!frames.images.empty() && frames.images.size() == frames.names.size(), "images with names");
  const cv::Mat background = median_of(frames.images);
  const cv::Mat disc = disc_of(frames.view, bench.dish_radius_m);
  const vision::RodConfig rod = vision::rod_of(bench);
  const vision::MaskGrid grid{frames.view.to_dish(0.0, 0.0), frames.view.pixel_m()};
  FrameLabels labels;
  for (std::size_t i = 0; i < frames.images.size(); ++i) {
    FrameLabel& label = labels.labels.emplace_back();
    label.frame = frames.names[i];
    vision::Evidence evidence;
    evidence.needle = moved_log_odds(frames.images[i], background, disc);
    evidence.tape = cv::Mat::zeros(evidence.needle.size(), CV_32F);
    const vision::RodFit fit = vision::fit_rod(evidence, grid, rod);
    if (!fit.axis_found) {
      label.reason = fit.reason;
      continue;
    }
    label.pose = LabelledPose{fit.pose};
    label.doubt = 1.0 - fit.support;
  }
  if (bench.sphere)
    labels.taped = false;
  else
    HeadFinder(frames, bench, labels).run();
  return labels;
}

}  // namespace lodestone::segmentation
