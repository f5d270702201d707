#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/imaging/camera_model.h"

namespace lodestone::imaging {

/// A printed chessboard with markers in its white squares (OpenCV's ChArUco, markers of DICT_4X4_50). The
/// default fits into the dish. Measure the print: a printer that scales changes square_m.
struct CharucoConfig {
  std::int64_t squares_x = 8;
  std::int64_t squares_y = 6;
  double square_m = 0.008;
  double marker_m = 0.006;
  double dpi = 600.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("squares_x", squares_x, "", "squares of the board along x", {3, 14});
    v.field("squares_y", squares_y, "", "squares of the board along y", {3, 14});
    v.field("square_m", square_m, "m", "side of a printed square, measured", {5e-4, 1.0});
    v.field("marker_m", marker_m, "m", "side of a printed marker, measured", {3e-4, 1.0});
    v.field("dpi", dpi, "1/inch", "resolution of the board to print", {50.0, 2400.0});
  }
  /// Throws ConfigError when markers do not fit into squares, or the dictionary has too few.
  void validate() const;
};

/// The board as it is printed, 8-bit grey, with a white margin of one square.
cv::Mat draw_charuco(const CharucoConfig& board);
/// Writes it as PNG that holds its resolution, so that it prints in true size. Throws IoError.
void write_charuco(const std::string& png_file, const CharucoConfig& board);

/// Corners between the squares that were seen. Board frame: origin in the board's middle, x to the right and
/// y up as printed, z towards who looks at it.
struct CharucoCorners {
  std::vector<int> ids;
  std::vector<Eigen::Vector2d> board_m;
  std::vector<Eigen::Vector2d> pixels;
};
/// `image`: 8-bit BGR or grey. Empty when no board is seen.
CharucoCorners detect_charuco(const cv::Mat& image, const CharucoConfig& board);

struct CharucoFit {
  CameraModel camera;  ///< intrinsics and k1, k2; its pose is that over the board of the first used image
  double rms_px = 0.0;
  std::vector<std::size_t> used;  ///< indices of the images with enough corners
};
/// Fits one focal length, principal point, k1 and k2 to images of the board, of one size. Some must be
/// tilted by 15 degrees or more: straight views cannot tell focal length from distance. Throws DataError when
/// fewer than `kMinCharucoImages` show enough of the board.
CharucoFit fit_charuco(const std::vector<cv::Mat>& images, const CharucoConfig& board);

constexpr std::size_t kMinCharucoImages = 4;

/// Pose over the board in one image: the intrinsics of `camera` with the pose replaced, as if the board's
/// frame were the dish's. Throws DataError when too few corners are seen.
CameraModel charuco_pose(const cv::Mat& image, const CharucoConfig& board, const CameraModel& camera);

}  // namespace lodestone::imaging
