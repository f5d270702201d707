#include "lodestone/rig/field_map.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/finite_coil.h"
#include "lodestone/rig/coils.h"

namespace lodestone::rig {
namespace {

const char* const kCoilNames[] = {"+x", "-x", "+y", "-y"};

[[noreturn]] void bad_csv(const std::string& file, std::size_t line, std::size_t column,
                          const std::string& what) {
  throw common::DataError(file + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " + what);
}

/// Shortest text that reads back as the same number.
std::string full_precision(double value) {
  char buffer[32];
  const double plain = value == 0.0 ? 0.0 : value;  // no "-0"
  const std::to_chars_result end = std::to_chars(buffer, buffer + sizeof buffer, plain);
  return std::string(buffer, end.ptr);
}

/// One number that ends at `end`; `begin` counts from 0 within the line.
double parse_number(const std::string& text, std::size_t begin, std::size_t end, const std::string& file,
                    std::size_t line, const char* name) {
  const std::string field = text.substr(begin, end - begin);
  char* stop = nullptr;
  const double value = std::strtod(field.c_str(), &stop);
  const bool rest_is_blank = field.find_first_not_of(" \t", stop - field.c_str()) == std::string::npos;
  if (stop == field.c_str() || !rest_is_blank || !std::isfinite(value)) {
    bad_csv(file, line, begin + 1,
            std::string(name) + " must be a finite number of metres, got \"" + field + "\"");
  }
  return value;
}

}  // namespace

int coil_index(const std::string& name) {
  for (int coil = 0; coil < kCoilCount; ++coil) {
    if (name == kCoilNames[coil]) return coil;
  }
  throw common::ConfigError("coil = \"" + name + "\" is unknown; it is one of +x, -x, +y, -y");
}

std::vector<geometry::Vector2> read_points_csv(const std::string& file) {
  std::istringstream content(common::read_file(file));
  std::vector<geometry::Vector2> points;
  std::string text;
  for (std::size_t line = 1; std::getline(content, text); ++line) {
    if (!text.empty() && text.back() == '\r') text.pop_back();
    if (line == 1) {
      if (text.rfind("\xEF\xBB\xBF", 0) == 0) text.erase(0, 3);  // byte order mark of spreadsheet programs
      if (text != "x_m,y_m") bad_csv(file, 1, 1, "the header must be \"x_m,y_m\", got \"" + text + "\"");
      continue;
    }
    if (text.empty()) continue;
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos) bad_csv(file, line, text.size() + 1, "expected two columns, x_m,y_m");
    const std::size_t extra = text.find(',', comma + 1);
    if (extra != std::string::npos) bad_csv(file, line, extra + 1, "expected two columns, found a third");
    const double x = parse_number(text, 0, comma, file, line, "x_m");
    const double y = parse_number(text, comma + 1, text.size(), file, line, "y_m");
    points.emplace_back(x, y);
  }
  if (points.empty()) bad_csv(file, 1, 1, "no points; expected the header x_m,y_m and at least one row");
  return points;
}

std::vector<geometry::Vector2> field_per_ampere(const physics::CoilGeometry& geometry, int coil,
                                                const std::vector<geometry::Vector2>& points_m) {
  const physics::FiniteCoil exact(geometry);
  const double face_m = geometry.centre_distance_m - geometry.length_m / 2.0;
  std::vector<geometry::Vector2> fields;
  fields.reserve(points_m.size());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const geometry::Vector2 local = physics::to_coil_frame(coil, points_m[i]);
    if (local.x() >= face_m) {
      throw common::DataError("point " + std::to_string(i + 1) + " (" + std::to_string(points_m[i].x()) +
                              ", " + std::to_string(points_m[i].y()) + ") m lies beyond the face of coil " +
                              kCoilNames[coil] + ", " + std::to_string(face_m) + " m from the dish centre");
    }
    fields.push_back(physics::from_coil_frame(coil, exact.in_dish_plane(local)));
  }
  return fields;
}

std::string field_csv(const std::vector<geometry::Vector2>& points_m,
                      const std::vector<geometry::Vector2>& field_T_per_A) {
  std::string csv = "x_m,y_m,Bx_T_per_A,By_T_per_A\n";
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    csv += full_precision(points_m[i].x()) + "," + full_precision(points_m[i].y()) + "," +
           full_precision(field_T_per_A[i].x()) + "," + full_precision(field_T_per_A[i].y()) + "\n";
  }
  return csv;
}

void write_field_plot(const std::string& file, const physics::CoilGeometry& geometry, int coil,
                      double dish_radius_m, const std::vector<geometry::Vector2>& points_m) {
  constexpr int kSide = 840;  // of the square map, px
  constexpr int kLeft = 90, kTop = 60, kBottom = 80, kRight = 190;
  const double face_m = geometry.centre_distance_m - geometry.length_m / 2.0;
  const double reach_m = std::min(1.08 * dish_radius_m, 0.98 * face_m);
  const double px_per_m = kSide / (2.0 * reach_m);
  const auto pixel = [&](double x, double y) {
    return cv::Point(kLeft + static_cast<int>(std::lround((x + reach_m) * px_per_m)),
                     kTop + static_cast<int>(std::lround((reach_m - y) * px_per_m)));
  };
  const physics::FiniteCoil exact(geometry);
  const auto field_mT = [&](double x, double y) -> geometry::Vector2 {
    return 1e3 * physics::from_coil_frame(coil, exact.in_dish_plane(physics::to_coil_frame(coil, {x, y})));
  };

  // The colour is logarithmic: the magnitude spans more than a decade over the dish.
  constexpr int kCoarse = kSide / 6;
  cv::Mat coarse(kCoarse, kCoarse, CV_64F), log_magnitude;
  for (int row = 0; row < kCoarse; ++row) {
    for (int column = 0; column < kCoarse; ++column) {
      const double x = reach_m * (2.0 * (column + 0.5) / kCoarse - 1.0);
      const double y = reach_m * (1.0 - 2.0 * (row + 0.5) / kCoarse);
      coarse.at<double>(row, column) = std::log10(field_mT(x, y).norm());
    }
  }
  cv::resize(coarse, log_magnitude, cv::Size(kSide, kSide), 0.0, 0.0, cv::INTER_LINEAR);
  double low = 0.0, high = 0.0;
  cv::minMaxLoc(log_magnitude, &low, &high);
  cv::Mat grey, colour;
  log_magnitude.convertTo(grey, CV_8U, 255.0 / (high - low), -255.0 * low / (high - low));
  cv::applyColorMap(grey, colour, cv::COLORMAP_VIRIDIS);
  cv::Mat image(kTop + kSide + kBottom, kLeft + kSide + kRight, CV_8UC3, cv::Scalar(255, 255, 255));
  colour.copyTo(image(cv::Rect(kLeft, kTop, kSide, kSide)));

  const cv::Scalar black(0, 0, 0), white(255, 255, 255), red(40, 40, 230);
  const auto label = [&](const std::string& words, cv::Point at, double size = 0.55) {
    cv::putText(image, words, at, cv::FONT_HERSHEY_SIMPLEX, size, black, 1, cv::LINE_AA);
  };
  constexpr int kArrows = 17;
  for (int i = 0; i < kArrows; ++i) {
    for (int j = 0; j < kArrows; ++j) {
      const double x = reach_m * (2.0 * (i + 0.5) / kArrows - 1.0);
      const double y = reach_m * (2.0 * (j + 0.5) / kArrows - 1.0);
      const geometry::Vector2 half = 0.36 * 2.0 * reach_m / kArrows * field_mT(x, y).normalized();
      cv::arrowedLine(image, pixel(x - half.x(), y - half.y()), pixel(x + half.x(), y + half.y()), white, 1,
                      cv::LINE_AA, 0, 0.3);
    }
  }
  cv::circle(image, pixel(0.0, 0.0), static_cast<int>(dish_radius_m * px_per_m), white, 2, cv::LINE_AA);
  for (const geometry::Vector2& point : points_m) {
    if (std::abs(point.x()) > reach_m || std::abs(point.y()) > reach_m) continue;
    cv::circle(image, pixel(point.x(), point.y()), 4, red, cv::FILLED, cv::LINE_AA);
  }
  cv::rectangle(image, cv::Rect(kLeft, kTop, kSide, kSide), black, 1);

  label(std::string("Coil ") + kCoilNames[coil] + ": field per ampere in the dish plane; circle: dish wall" +
            (points_m.empty() ? "" : "; red: points asked for"),
        {kLeft, 24}, 0.6);
  const int step_mm = reach_m > 0.1 ? 50 : reach_m > 0.03 ? 10 : 2;
  for (int mm = -static_cast<int>(reach_m * 1e3) / step_mm * step_mm; mm * 1e-3 <= reach_m; mm += step_mm) {
    const cv::Point below(pixel(mm * 1e-3, 0.0).x, kTop + kSide);
    const cv::Point beside(kLeft, pixel(0.0, mm * 1e-3).y);
    cv::line(image, below, below + cv::Point(0, 6), black);
    cv::line(image, beside, beside - cv::Point(6, 0), black);
    label(std::to_string(mm), below + cv::Point(-12, 24), 0.5);
    label(std::to_string(mm), beside + cv::Point(-44, 5), 0.5);
  }
  label("x (mm)", {kLeft + kSide / 2 - 30, kTop + kSide + 56});
  label("y (mm)", {12, kTop - 14});

  const int bar = kLeft + kSide + 40;
  for (int row = 0; row < kSide; ++row) {
    cv::Mat level(1, 1, CV_8U, cv::Scalar(255.0 * (kSide - 1 - row) / (kSide - 1)));
    cv::Mat shade;
    cv::applyColorMap(level, shade, cv::COLORMAP_VIRIDIS);
    const cv::Vec3b bgr = shade.at<cv::Vec3b>(0, 0);
    cv::line(image, {bar, kTop + row}, {bar + 26, kTop + row}, cv::Scalar(bgr[0], bgr[1], bgr[2]));
  }
  cv::rectangle(image, cv::Rect(bar, kTop, 27, kSide), black, 1);
  label("|B| (mT/A)", {bar - 14, kTop - 14});
  constexpr int kLabels = 7;
  for (int i = 0; i < kLabels; ++i) {
    const double fraction = static_cast<double>(i) / (kLabels - 1);
    const int row = kTop + static_cast<int>(std::lround((1.0 - fraction) * (kSide - 1)));
    char words[32];
    std::snprintf(words, sizeof words, "%.3g", std::pow(10.0, low + fraction * (high - low)));
    cv::line(image, {bar + 27, row}, {bar + 33, row}, black);
    label(words, {bar + 40, row + 5}, 0.5);
  }

  std::vector<unsigned char> encoded;
  if (!cv::imencode(".png", image, encoded)) throw common::IoError(file + ": the image could not be encoded");
  common::write_file_atomically(
      file, std::string_view(reinterpret_cast<const char*>(encoded.data()), encoded.size()));
}

}  // namespace lodestone::rig
