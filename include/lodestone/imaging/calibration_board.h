#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/imaging/camera_model.h"

namespace lodestone::imaging {

/// kCharuco: a chessboard with markers in its white squares (DICT_4X4_50), of which a part is enough.
/// kCheckerboard: a plain one, which has to be seen whole. kAprilTag: tags of the family 36h11 in rows,
/// number 0 at the top left, with a gap between them. All by OpenCV's own detectors.
enum class BoardKind { kCharuco, kCheckerboard, kAprilTag };
inline std::vector<std::string> names_of(BoardKind) { return {"charuco", "checkerboard", "apriltag"}; }

/// A printed board. The default fits into the dish. Measure the print: a printer that scales changes
/// square_m.
struct BoardConfig {
  BoardKind kind = BoardKind::kCharuco;
  std::int64_t squares_x = 8;
  std::int64_t squares_y = 6;
  double square_m = 0.008;
  double marker_m = 0.006;
  double dpi = 600.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("kind", kind, "",
            "charuco: a chessboard with markers, of which a part is enough; checkerboard: a plain one, seen "
            "whole; apriltag: tags 36h11 in rows, number 0 at the top left");
    v.field("squares_x", squares_x, "", "squares (or tags) of the board along x", {3, 24});
    v.field("squares_y", squares_y, "", "squares (or tags) of the board along y", {3, 24});
    v.field("square_m", square_m, "m", "side of a printed square, measured; of tags, from one to the next",
            {5e-4, 1.0});
    v.field("marker_m", marker_m, "m", "side of a printed marker or tag, measured", {3e-4, 1.0});
    v.field("dpi", dpi, "1/inch", "resolution of the board to print", {50.0, 2400.0});
  }
  /// Throws ConfigError when markers do not fit into squares, or the dictionary has too few; and for a
  /// checkerboard of as many squares either way, which looks alike on its side.
  void validate() const;
};

/// The board as it is printed, 8-bit grey, with a white margin of one square.
cv::Mat draw_board(const BoardConfig& board);
/// Writes it as PNG that holds its resolution, so that it prints in true size. Throws IoError.
void write_board(const std::string& png_file, const BoardConfig& board);

/// Corners between the squares, or of the tags, that were seen. Board frame: origin in the board's middle, x
/// to the right and y up as printed, z towards who looks at it.
struct BoardCorners {
  std::vector<int> ids;
  std::vector<Eigen::Vector2d> board_m;
  std::vector<Eigen::Vector2d> pixels;
};
/// `image`: 8-bit BGR or grey. Empty when no board is seen.
BoardCorners detect_board(const cv::Mat& image, const BoardConfig& board);

struct BoardFit {
  CameraModel camera;  ///< intrinsics and k1, k2; its pose is that over the board of the first used image
  double rms_px = 0.0;
  std::vector<std::size_t> used;  ///< indices of the images with enough corners
};
/// Fits one focal length, principal point, k1 and k2 to images of the board, of one size. Some must be
/// tilted by 15 degrees or more: straight views cannot tell focal length from distance. Throws DataError when
/// fewer than `kLeastBoardImages` show enough of the board.
BoardFit fit_board(const std::vector<cv::Mat>& images, const BoardConfig& board);

constexpr std::size_t kLeastBoardImages = 4;

/// Whether a view of the board is another than those before: a corner lies elsewhere by a hundredth of the
/// image's width, or others are seen.
bool is_another_view(const BoardCorners& corners, const std::vector<BoardCorners>& before, int width_px);

/// Pose over the board in one image: the intrinsics of `camera` with the pose replaced, as if the board's
/// frame were the dish's. Throws DataError when too few corners are seen.
CameraModel board_pose(const cv::Mat& image, const BoardConfig& board, const CameraModel& camera);

/// Of a board that lies flat in the dish: how large it is there, as a share of what `corners` take it to be.
/// One that is held above the floor is larger; less than 1 tells of a print smaller than it is said to be, as
/// nothing lies below the floor. Nothing where it lies tilted, beyond the dish's rim, or is hardly seen.
/// `camera`: placed over the dish.
std::optional<double> size_on_floor(const BoardCorners& corners, const CameraModel& camera,
                                    double dish_radius_m);

}  // namespace lodestone::imaging
