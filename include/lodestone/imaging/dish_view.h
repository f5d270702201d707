#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "lodestone/geometry/pose2.h"
#include "lodestone/imaging/camera_model.h"

namespace lodestone::imaging {

/// A camera's image made straight: the dish seen from right above, square, free of distortion, at a fixed
/// scale whatever the camera. Row 0 is the side of +y, columns go to +x. Everything after it works in metres.
class DishView {
 public:
  /// The view reaches `margin_m` beyond `radius_m`, and a little more to make its side a multiple of
  /// `multiple_px`.
  DishView(const CameraModel& camera, double radius_m, double margin_m, double pixel_m,
           std::int64_t multiple_px);

  int size_px() const { return size_px_; }
  double pixel_m() const { return pixel_m_; }
  cv::Rect whole() const { return {0, 0, size_px_, size_px_}; }
  /// Square of `size_px` around a point of the dish, moved inside the view; its corner is a multiple of
  /// `multiple_px`.
  cv::Rect around(const geometry::Vector2& centre_m, int size_px) const;

  /// The area of the view, out of a camera's image: same type, [area.height, area.width]. What the image
  /// does not show is black. Throws DataError when the image has another size than the camera.
  cv::Mat cut(const cv::Mat& image, const cv::Rect& area) const;
  /// Whether the image shows the point.
  bool shows(const geometry::Vector2& point_m) const;

  /// Point of the dish at a place of the view; pixel centres are whole numbers.
  geometry::Vector2 to_dish(double column, double row) const;

 private:
  CameraModel camera_;
  double pixel_m_;
  std::int64_t multiple_px_;
  int size_px_;
  int shrink_;       ///< the image is first averaged over squares of this side
  cv::Mat lookup_;   ///< [size, size] 2 x short: place in the shrunk image, whole pixels
  cv::Mat between_;  ///< [size, size] unsigned short: the rest, as cv::remap wants it
};

}  // namespace lodestone::imaging
