#include "lodestone/imaging/charuco.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
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
constexpr int kMarkersOfDictionary = 50;

cv::Ptr<cv::aruco::Dictionary> dictionary() {
  return cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
}

cv::Ptr<cv::aruco::CharucoBoard> opencv_board(const CharucoConfig& board) {
  return cv::aruco::CharucoBoard::create(static_cast<int>(board.squares_x), static_cast<int>(board.squares_y),
                                         static_cast<float>(board.square_m),
                                         static_cast<float>(board.marker_m), dictionary());
}

int pixels_per_square(const CharucoConfig& board) {
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

std::vector<cv::Point3f> object_points(const CharucoCorners& corners) {
  std::vector<cv::Point3f> points;
  for (const Eigen::Vector2d& p : corners.board_m)
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F);
  return points;
}

std::vector<cv::Point2f> image_points(const CharucoCorners& corners) {
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector2d& p : corners.pixels)
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  return points;
}

/// OpenCV 4.6 gives corners half a pixel too far right and down; they are found again from there, in windows
/// that leave out the markers.
void refine(const cv::Mat& image, const std::vector<std::vector<cv::Point2f>>& markers,
            const CharucoConfig& board, std::vector<cv::Point2f>& pixels) {
  if (pixels.empty()) return;
  double perimeter_px = 0.0;
  for (const std::vector<cv::Point2f>& marker : markers) perimeter_px += cv::arcLength(marker, true);
  const double side_px = 0.25 * perimeter_px / static_cast<double>(markers.size());
  const double gap_px = 0.5 * (board.square_m / board.marker_m - 1.0) * side_px;
  const int window = std::clamp(static_cast<int>(gap_px), 2, 15);
  cv::Mat grey = image;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  for (cv::Point2f& pixel : pixels) pixel -= cv::Point2f(0.5F, 0.5F);
  cv::cornerSubPix(grey, pixels, {window, window}, {-1, -1},
                   cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 50, 1e-3));
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

}  // namespace

void CharucoConfig::validate() const {
  if (!(marker_m < 0.9 * square_m))
    throw common::InvalidConfig("marker_m", marker_m, fmt::format("be below 0.9 of square_m = {}", square_m));
  if (squares_x * squares_y / 2 > kMarkersOfDictionary)
    throw common::InvalidConfig(
        "squares_x", squares_x,
        fmt::format("times squares_y = {} be at most 100: the dictionary has 50 markers", squares_y));
}

cv::Mat draw_charuco(const CharucoConfig& board) {
  board.validate();
  const int side = pixels_per_square(board);
  cv::Mat image;
  opencv_board(board)->draw(
      cv::Size(static_cast<int>(board.squares_x + 2) * side, static_cast<int>(board.squares_y + 2) * side),
      image, side);
  return image;
}

void write_charuco(const std::string& png_file, const CharucoConfig& board) {
  constexpr std::size_t kEndOfHeader = 33;  // signature and IHDR
  std::string png = encoded_image(draw_charuco(board), ".png");
  // A square is a whole number of pixels; the resolution makes up for the rounding.
  png.insert(kEndOfHeader, resolution_chunk(pixels_per_square(board) / board.square_m));
  common::write_file_atomically(png_file, png);
}

CharucoCorners detect_charuco(const cv::Mat& image, const CharucoConfig& board) {
  board.validate();
  const cv::Ptr<cv::aruco::CharucoBoard> model = opencv_board(board);
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> marker_ids;
  cv::aruco::detectMarkers(image, model->dictionary, markers, marker_ids, parameters);
  CharucoCorners corners;
  if (marker_ids.empty()) return corners;
  std::vector<cv::Point2f> pixels;
  cv::aruco::interpolateCornersCharuco(markers, marker_ids, image, model, pixels, corners.ids);
  refine(image, markers, board, pixels);
  const auto columns = static_cast<int>(board.squares_x - 1);
  for (std::size_t i = 0; i < corners.ids.size(); ++i) {
    const int column = corners.ids[i] % columns;
    const int row = corners.ids[i] / columns;  // from the top of the print
    corners.board_m.emplace_back(board.square_m * (column + 1 - 0.5 * static_cast<double>(board.squares_x)),
                                 board.square_m * (0.5 * static_cast<double>(board.squares_y) - row - 1));
    corners.pixels.emplace_back(pixels[i].x, pixels[i].y);
  }
  return corners;
}

CharucoFit fit_charuco(const std::vector<cv::Mat>& images, const CharucoConfig& board) {
  CharucoFit fit;
  std::vector<std::vector<cv::Point3f>> objects;
  std::vector<std::vector<cv::Point2f>> points;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i].size() != images[0].size())
      throw common::DataError("images of the board differ in size; take all with one camera at one size");
    const CharucoCorners corners = detect_charuco(images[i], board);
    if (corners.ids.size() < kMinCorners) continue;
    fit.used.push_back(i);
    objects.push_back(object_points(corners));
    points.push_back(image_points(corners));
  }
  if (fit.used.size() < kMinCharucoImages)
    throw common::DataError("the board was seen in " + std::to_string(fit.used.size()) + " of " +
                            std::to_string(images.size()) + " images, needs " +
                            std::to_string(kMinCharucoImages) +
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

CameraModel charuco_pose(const cv::Mat& image, const CharucoConfig& board, const CameraModel& camera) {
  const CharucoCorners corners = detect_charuco(image, board);
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

}  // namespace lodestone::imaging
