#include "lodestone/imaging/dish_view.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "lodestone/common/error.h"

namespace lodestone::imaging {
namespace {

constexpr double kLargestView_px = 8192;

}  // namespace

DishView::DishView(const CameraModel& camera, double radius_m, double margin_m, double pixel_m,
                   std::int64_t multiple_px)
    : camera_(camera), pixel_m_(pixel_m), multiple_px_(multiple_px) {
  const double side_px = 2.0 * (radius_m + margin_m) / pixel_m;
  if (!(side_px <= kLargestView_px))
    throw common::ConfigError("a view of the dish with pixels of " + std::to_string(1e3 * pixel_m) +
                              " mm has " + std::to_string(side_px) +
                              " pixels to a side, at most 8192 are allowed");
  size_px_ = static_cast<int>(std::ceil(side_px / static_cast<double>(multiple_px)) *
                              static_cast<double>(multiple_px));
  shrink_ = std::max(1, static_cast<int>(std::lround(pixel_m / camera.pixel_size_m())));
  cv::Mat places(size_px_, size_px_, CV_32FC2);
  for (int row = 0; row < size_px_; ++row) {
    auto* out = places.ptr<cv::Vec2f>(row);
    for (int column = 0; column < size_px_; ++column) {
      const Eigen::Vector2d pixel = camera.project_floor(to_dish(column, row));
      // Pixel k of the shrunk image has its middle at shrink * k + (shrink - 1) / 2 of the image.
      const double offset = 0.5 * (shrink_ - 1);
      out[column] = {static_cast<float>((pixel.x() - offset) / shrink_),
                     static_cast<float>((pixel.y() - offset) / shrink_)};
    }
  }
  cv::convertMaps(places, {}, lookup_, between_, CV_16SC2);
}

geometry::Vector2 DishView::to_dish(double column, double row) const {
  const double middle = 0.5 * (size_px_ - 1);
  return {pixel_m_ * (column - middle), pixel_m_ * (middle - row)};
}

cv::Rect DishView::around(const geometry::Vector2& centre_m, int size_px) const {
  const int size = std::min(size_px, size_px_);
  const double middle = 0.5 * (size_px_ - 1);
  const auto corner = [&](double centre_px) {
    const double wanted = (centre_px - 0.5 * size) / static_cast<double>(multiple_px_);
    const auto snapped = static_cast<int>(std::lround(wanted) * multiple_px_);
    return std::clamp(snapped, 0, size_px_ - size);
  };
  return {corner(middle + centre_m.x() / pixel_m_), corner(middle - centre_m.y() / pixel_m_), size, size};
}

bool DishView::shows(const geometry::Vector2& point_m) const {
  const Eigen::Vector2d pixel = camera_.project_floor(point_m);
  return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= static_cast<double>(camera_.width_px - 1) &&
         pixel.y() <= static_cast<double>(camera_.height_px - 1);
}

cv::Mat DishView::cut(const cv::Mat& image, const cv::Rect& area) const {
  if (image.cols != camera_.width_px || image.rows != camera_.height_px)
    throw common::DataError("the image is " + std::to_string(image.cols) + " x " +
                            std::to_string(image.rows) + " px, the calibration is for " +
                            std::to_string(camera_.width_px) + " x " + std::to_string(camera_.height_px) +
                            "; calibrate again with `lodestone calibrate`");
  const cv::Mat lookup = lookup_(area);
  // Only the part of the image that the area shows is shrunk.
  // Straight lines are nearly straight in it, so that a few points of the border bound it.
  cv::Point low(1 << 20, 1 << 20);
  cv::Point high(-(1 << 20), -(1 << 20));
  constexpr int kPieces = 8;
  for (int i = 0; i <= kPieces; ++i) {
    const int row = (area.height - 1) * i / kPieces;
    const int column = (area.width - 1) * i / kPieces;
    for (const cv::Point& at : {cv::Point(0, row), cv::Point(area.width - 1, row), cv::Point(column, 0),
                                cv::Point(column, area.height - 1)}) {
      const cv::Vec2s place = lookup.at<cv::Vec2s>(at);
      low = {std::min<int>(low.x, place[0]), std::min<int>(low.y, place[1])};
      high = {std::max<int>(high.x, place[0]), std::max<int>(high.y, place[1])};
    }
  }
  const cv::Rect all(0, 0, image.cols / shrink_, image.rows / shrink_);
  const cv::Rect box = cv::Rect(low.x - 4, low.y - 4, high.x - low.x + 10, high.y - low.y + 10) & all;
  cv::Mat out = cv::Mat::zeros(area.size(), image.type());
  if (box.empty()) return out;
  const cv::Mat source(image, {box.x * shrink_, box.y * shrink_, box.width * shrink_, box.height * shrink_});
  cv::Mat shrunk = source;
  if (shrink_ > 1) cv::resize(source, shrunk, box.size(), 0.0, 0.0, cv::INTER_AREA);
  cv::Mat places;
  cv::subtract(lookup, cv::Scalar(box.x, box.y), places);
  cv::remap(shrunk, out, places, between_(area), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return out;
}

}  // namespace lodestone::imaging
