#include "lodestone/imaging/calibration_board.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstring>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "lodestone/common/config.h"
#include "lodestone/common/files.h"
#include "lodestone/imaging/image_file.h"

namespace lodestone::imaging {
namespace {

constexpr double kMetrePerInch = 0.0254;
constexpr std::size_t kMinCorners = 8;
constexpr std::int64_t kMarkersOfDictionary = 50;
constexpr std::int64_t kTagsOfFamily = 587;

cv::Ptr<cv::aruco::Dictionary> dictionary(BoardKind kind) {
  return cv::aruco::getPredefinedDictionary(kind == BoardKind::kAprilTag ? cv::aruco::DICT_APRILTAG_36h11
                                                                         : cv::aruco::DICT_4X4_50);
}

cv::Ptr<cv::aruco::CharucoBoard> chessboard(const BoardConfig& board) {
  return cv::aruco::CharucoBoard::create(static_cast<int>(board.squares_x), static_cast<int>(board.squares_y),
                                         static_cast<float>(board.square_m),
                                         static_cast<float>(board.marker_m), dictionary(board.kind));
}

int pixels_per_square(const BoardConfig& board) {
  return static_cast<int>(std::lround(board.square_m / kMetrePerInch * board.dpi));
}

std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    crc ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) != 0U ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

std::string big_endian(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
          static_cast<char>(value)};
}

/// The pHYs chunk of PNG (RFC 2083, 4.2.4.2): pixels per metre in x and y.
std::string resolution_chunk(double pixels_per_metre) {
  const std::string density = big_endian(static_cast<std::uint32_t>(std::lround(pixels_per_metre)));
  const std::string body = "pHYs" + density + density + std::string(1, '\1');
  return big_endian(9) + body + big_endian(crc32(body));
}

std::vector<cv::Point3f> object_points(const BoardCorners& corners) {
  std::vector<cv::Point3f> points;
  for (const Eigen::Vector2d& p : corners.board_m)
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F);
  return points;
}

std::vector<cv::Point2f> image_points(const BoardCorners& corners) {
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector2d& p : corners.pixels)
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  return points;
}

cv::Mat grey_of(const cv::Mat& image) {
  cv::Mat grey = image;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

/// OpenCV 4.6 gives corners half a pixel too far right and down; they are found again from there, in windows
/// that leave out the markers.
void refine(const cv::Mat& image, const std::vector<std::vector<cv::Point2f>>& markers,
            const BoardConfig& board, std::vector<cv::Point2f>& pixels) {
  if (pixels.empty()) return;
  double perimeter_px = 0.0;
  for (const std::vector<cv::Point2f>& marker : markers) perimeter_px += cv::arcLength(marker, true);
  const double side_px = 0.25 * perimeter_px / static_cast<double>(markers.size());
  const double gap_px = 0.5 * (board.square_m / board.marker_m - 1.0) * side_px;
  const int window = std::clamp(static_cast<int>(gap_px), 2, 15);
  for (cv::Point2f& pixel : pixels) pixel -= cv::Point2f(0.5F, 0.5F);
  cv::cornerSubPix(grey_of(image), pixels, {window, window}, {-1, -1},
                   cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 50, 1e-3));
}

/// Of a point in squares from the top left of the print.
Eigen::Vector2d in_board_frame(const BoardConfig& board, double column, double row) {
  return board.square_m * Eigen::Vector2d(column - 0.5 * static_cast<double>(board.squares_x),
                                          0.5 * static_cast<double>(board.squares_y) - row);
}

void add_corner(BoardCorners& corners, const BoardConfig& board, int id, const cv::Point2f& pixel) {
  const auto columns = static_cast<int>(board.squares_x - 1);
  corners.ids.push_back(id);
  corners.board_m.push_back(in_board_frame(board, id % columns + 1, id / columns + 1));  // from the top
  corners.pixels.emplace_back(pixel.x, pixel.y);
}

/// In windows that reach no further than the tag's frame.
void refine_tags(const cv::Mat& image, std::vector<std::vector<cv::Point2f>>& tags) {
  constexpr double kCells = 8.0;  // of a side, the frame included
  const cv::Mat grey = grey_of(image);
  for (std::vector<cv::Point2f>& tag : tags) {
    const double cell_px = 0.25 * cv::arcLength(tag, true) / kCells;
    const int window = std::clamp(static_cast<int>(0.8 * cell_px), 2, 15);
    cv::cornerSubPix(grey, tag, {window, window}, {-1, -1},
                     cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 50, 1e-3));
  }
}

std::vector<std::vector<cv::Point2f>> markers_in(const cv::Mat& image, BoardKind kind,
                                                 std::vector<int>& ids) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  if (kind == BoardKind::kCharuco) parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  std::vector<std::vector<cv::Point2f>> markers;
  cv::aruco::detectMarkers(image, dictionary(kind), markers, ids, parameters);
  return markers;
}

BoardCorners charuco_corners(const cv::Mat& image, const BoardConfig& board) {
  BoardCorners corners;
  std::vector<int> marker_ids, ids;
  const auto markers = markers_in(image, board.kind, marker_ids);
  if (marker_ids.empty()) return corners;
  std::vector<cv::Point2f> pixels;
  cv::aruco::interpolateCornersCharuco(markers, marker_ids, image, chessboard(board), pixels, ids);
  refine(image, markers, board, pixels);
  for (std::size_t i = 0; i < ids.size(); ++i) add_corner(corners, board, ids[i], pixels[i]);
  return corners;
}

BoardCorners checkerboard_corners(const cv::Mat& image, const BoardConfig& board) {
  BoardCorners corners;
  std::vector<cv::Point2f> pixels;
  const cv::Size inner(static_cast<int>(board.squares_x - 1), static_cast<int>(board.squares_y - 1));
  if (!cv::findChessboardCornersSB(grey_of(image), inner, pixels, cv::CALIB_CB_ACCURACY)) return corners;
  // Upside down it looks alike: what is called its top is on top.
  if (pixels.front().y > pixels.back().y) std::reverse(pixels.begin(), pixels.end());
  for (std::size_t i = 0; i < pixels.size(); ++i) add_corner(corners, board, static_cast<int>(i), pixels[i]);
  return corners;
}

BoardCorners tag_corners(const cv::Mat& image, const BoardConfig& board) {
  BoardCorners corners;
  std::vector<int> ids;
  auto tags = markers_in(image, board.kind, ids);
  refine_tags(image, tags);
  const double side = board.marker_m / board.square_m;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] >= board.squares_x * board.squares_y) continue;  // of another board
    const double left = static_cast<double>(ids[i] % board.squares_x) + 0.5 * (1.0 - side);
    const double top = static_cast<double>(ids[i] / board.squares_x) + 0.5 * (1.0 - side);
    for (int corner = 0; corner < 4; ++corner) {  // clockwise from the top left
      corners.ids.push_back(4 * ids[i] + corner);
      corners.board_m.push_back(in_board_frame(board, left + (corner == 1 || corner == 2 ? side : 0.0),
                                               top + (corner >= 2 ? side : 0.0)));
      const cv::Point2f& pixel = tags[i][static_cast<std::size_t>(corner)];
      corners.pixels.emplace_back(pixel.x, pixel.y);
    }
  }
  return corners;
}

void set_pose(CameraModel& camera, const cv::Mat& rotation_vector, const cv::Mat& translation) {
  cv::Mat rotation;
  cv::Rodrigues(rotation_vector, rotation);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      camera.rotation(row, column) = rotation.at<double>(row, column);
    camera.translation_m(row) = translation.at<double>(row);
  }
}

/// A corner on the board and on the floor, x + iy in metres.
struct Seen {
  std::complex<double> on_board, on_floor;
};

/// The shift, turn and scale that take corners of the board to the floor best.
struct Likeness {
  std::complex<double> board_middle, floor_middle, turn;
  double off(const Seen& corner) const {
    return std::norm(turn * (corner.on_board - board_middle) - (corner.on_floor - floor_middle));
  }
};

Likeness likeness(const std::vector<Seen>& corners) {
  Likeness found;
  for (const Seen& corner : corners) {
    found.board_middle += corner.on_board / static_cast<double>(corners.size());
    found.floor_middle += corner.on_floor / static_cast<double>(corners.size());
  }
  double square = 0.0;
  for (const Seen& corner : corners) {
    const std::complex<double> on_board = corner.on_board - found.board_middle;
    found.turn += std::conj(on_board) * (corner.on_floor - found.floor_middle);
    square += std::norm(on_board);
  }
  found.turn /= square;
  return found;
}

}  // namespace

void BoardConfig::validate() const {
  if (kind != BoardKind::kCheckerboard && !(marker_m < 0.9 * square_m))
    throw common::InvalidConfig("marker_m", marker_m, fmt::format("be below 0.9 of square_m = {}", square_m));
  if (kind == BoardKind::kCharuco && squares_x * squares_y / 2 > kMarkersOfDictionary)
    throw common::InvalidConfig(
        "squares_x", squares_x,
        fmt::format("times squares_y = {} be at most 100: the dictionary has 50 markers", squares_y));
  if (kind == BoardKind::kAprilTag && squares_x * squares_y > kTagsOfFamily)
    throw common::InvalidConfig(
        "squares_x", squares_x,
        fmt::format("times squares_y = {} be at most 587: the family 36h11 has no more tags", squares_y));
  if (kind == BoardKind::kCheckerboard && std::min(squares_x, squares_y) < 4)
    throw common::InvalidConfig("squares_x", squares_x, "be at least 4, and squares_y, of a checkerboard");
  if (kind == BoardKind::kCheckerboard && squares_x == squares_y)
    throw common::InvalidConfig("squares_x", squares_x,
                                "differ from squares_y, or the board looks alike on its side");
}

cv::Mat draw_board(const BoardConfig& board) {
  board.validate();
  const int side = pixels_per_square(board);
  const cv::Size size(static_cast<int>(board.squares_x + 2) * side,
                      static_cast<int>(board.squares_y + 2) * side);
  cv::Mat image(size, CV_8U, cv::Scalar(255));
  const auto place = [side](int column, int row) {
    return cv::Rect((column + 1) * side, (row + 1) * side, side, side);
  };
  if (board.kind == BoardKind::kCharuco) {
    chessboard(board)->draw(size, image, side);
    return image;
  }
  for (int row = 0; row < board.squares_y; ++row)
    for (int column = 0; column < board.squares_x; ++column) {
      cv::Mat square = image(place(column, row));
      if (board.kind == BoardKind::kCheckerboard) {
        if ((row + column) % 2 == 0) square.setTo(0);
        continue;
      }
      const int tag_px = static_cast<int>(std::lround(board.marker_m / board.square_m * side));
      const int edge_px = (side - tag_px) / 2;
      cv::Mat tag;
      cv::aruco::drawMarker(dictionary(board.kind), row * static_cast<int>(board.squares_x) + column, tag_px,
                            tag);
      tag.copyTo(square(cv::Rect(edge_px, edge_px, tag_px, tag_px)));
    }
  return image;
}

void write_board(const std::string& png_file, const BoardConfig& board) {
  constexpr std::size_t kEndOfHeader = 33;  // signature and IHDR
  std::string png = encoded_image(draw_board(board), ".png");
  // A square is a whole number of pixels; the resolution makes up for the rounding.
  png.insert(kEndOfHeader, resolution_chunk(pixels_per_square(board) / board.square_m));
  common::write_file_atomically(png_file, png);
}

BoardCorners detect_board(const cv::Mat& image, const BoardConfig& board) {
  board.validate();
  if (board.kind == BoardKind::kCharuco) return charuco_corners(image, board);
  if (board.kind == BoardKind::kAprilTag) return tag_corners(image, board);
  return checkerboard_corners(image, board);
}

bool is_another_view(const BoardCorners& corners, const std::vector<BoardCorners>& before, int width_px) {
  constexpr double kFar = 0.01;  // of the image's width
  if (corners.ids.size() < kMinCorners) return false;
  const auto alike = [&](const BoardCorners& other) {
    double farthest_px = 0.0;  // a tilt moves little but the edges
    std::size_t common = 0;
    for (std::size_t i = 0; i < corners.ids.size(); ++i) {
      const auto found = std::find(other.ids.begin(), other.ids.end(), corners.ids[i]);
      if (found == other.ids.end()) continue;
      const Eigen::Vector2d& there = other.pixels[static_cast<std::size_t>(found - other.ids.begin())];
      farthest_px = std::max(farthest_px, (corners.pixels[i] - there).norm());
      ++common;
    }
    return 2 * common > corners.ids.size() && farthest_px < kFar * width_px;
  };
  return std::none_of(before.begin(), before.end(), alike);
}

BoardFit fit_board(const std::vector<cv::Mat>& images, const BoardConfig& board) {
  BoardFit fit;
  std::vector<std::vector<cv::Point3f>> objects;
  std::vector<std::vector<cv::Point2f>> points;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i].size() != images[0].size())
      throw common::DataError("images of the board differ in size; take all with one camera at one size");
    const BoardCorners corners = detect_board(images[i], board);
    if (corners.ids.size() < kMinCorners) continue;
    fit.used.push_back(i);
    objects.push_back(object_points(corners));
    points.push_back(image_points(corners));
  }
  if (fit.used.size() < kLeastBoardImages)
    throw common::DataError("the board was seen in " + std::to_string(fit.used.size()) + " of " +
                            std::to_string(images.size()) + " images, needs " +
                            std::to_string(kLeastBoardImages) +
                            "; add sharp images that show most of it, some tilted by 15 degrees or more");
  cv::Mat matrix = cv::Mat::eye(3, 3, CV_64F);
  cv::Mat distortion = cv::Mat::zeros(1, 5, CV_64F);
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  // CALIB_FIX_ASPECT_RATIO keeps one focal length; the camera model has radial terms k1 and k2 alone.
  fit.rms_px =
      cv::calibrateCamera(objects, points, images[0].size(), matrix, distortion, rotations, translations,
                          cv::CALIB_FIX_ASPECT_RATIO | cv::CALIB_ZERO_TANGENT_DIST | cv::CALIB_FIX_K3,
                          cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-12));
  fit.camera.width_px = images[0].cols;
  fit.camera.height_px = images[0].rows;
  fit.camera.focal_px = matrix.at<double>(0, 0);
  fit.camera.centre_u_px = matrix.at<double>(0, 2);
  fit.camera.centre_v_px = matrix.at<double>(1, 2);
  fit.camera.k1 = distortion.at<double>(0);
  fit.camera.k2 = distortion.at<double>(1);
  set_pose(fit.camera, rotations[0], translations[0]);
  return fit;
}

CameraModel board_pose(const cv::Mat& image, const BoardConfig& board, const CameraModel& camera) {
  const BoardCorners corners = detect_board(image, board);
  if (corners.ids.size() < kMinCorners)
    throw common::DataError("the board shows " + std::to_string(corners.ids.size()) + " corners, needs " +
                            std::to_string(kMinCorners) +
                            "; lay it flat in the dish, in focus and uncovered");
  const cv::Matx33d matrix(camera.focal_px, 0.0, camera.centre_u_px, 0.0, camera.focal_px, camera.centre_v_px,
                           0.0, 0.0, 1.0);
  const std::array<double, 4> distortion = {camera.k1, camera.k2, 0.0, 0.0};
  cv::Mat rotation;
  cv::Mat translation;
  cv::solvePnP(object_points(corners), image_points(corners), matrix, distortion, rotation, translation,
               false, cv::SOLVEPNP_IPPE);
  cv::solvePnPRefineLM(object_points(corners), image_points(corners), matrix, distortion, rotation,
                       translation);
  CameraModel out = camera;
  set_pose(out, rotation, translation);
  return out;
}

std::optional<double> size_on_floor(const BoardCorners& corners, const CameraModel& camera,
                                    double dish_radius_m) {
  constexpr std::size_t kLeastCorners = 12;
  constexpr std::size_t kMistaken = 8;  // one of so many
  constexpr double kTilted = 0.005;     // RMS, of the board's: it is tilted by some 6 degrees, or no board
  if (corners.ids.size() < kLeastCorners) return std::nullopt;
  CameraModel dry = camera;
  dry.fluid = {};
  std::vector<Seen> seen;
  for (std::size_t i = 0; i < corners.ids.size(); ++i) {
    const geometry::Vector2 on_floor_m = dry.to_dish(corners.pixels[i]);
    if (on_floor_m.norm() > dish_radius_m) return std::nullopt;
    seen.push_back({{corners.board_m[i].x(), corners.board_m[i].y()}, {on_floor_m.x(), on_floor_m.y()}});
  }
  // A corner may be a mistaken one: those that fit worst are left out.
  const Likeness rough = likeness(seen);
  std::sort(seen.begin(), seen.end(),
            [&rough](const Seen& a, const Seen& b) { return rough.off(a) < rough.off(b); });
  seen.resize(seen.size() - seen.size() / kMistaken);
  const Likeness likely = likeness(seen);
  double off = 0.0, square = 0.0;
  for (const Seen& corner : seen) {
    off += likely.off(corner);
    square += std::norm(corner.on_board - likely.board_middle);
  }
  if (off > kTilted * kTilted * square) return std::nullopt;
  return std::abs(likely.turn);
}

}  // namespace lodestone::imaging
