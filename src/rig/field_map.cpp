#include "lodestone/rig/field_map.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/imaging/image_file.h"
#include "lodestone/physics/described_coil.h"

namespace lodestone::rig {
namespace {

const cv::Scalar kBlack(0, 0, 0), kWhite(255, 255, 255), kRed(40, 40, 230);

/// The picture of a coil's field, drawn part by part.
class Plot {
 public:
  Plot(const physics::CoilDescription& coil, const physics::MeasuredRegion& measured, double dish_radius_m);
  void draw_field();
  void draw_dish(const std::vector<geometry::Vector2>& points_m);
  void draw_axes();
  void draw_scale();
  const cv::Mat& image() const { return image_; }

 private:
  cv::Point pixel(double x, double y) const {
    return {kLeft + static_cast<int>(std::lround((x + reach_m_) * px_per_m_)),
            kTop + static_cast<int>(std::lround((reach_m_ - y) * px_per_m_))};
  }
  geometry::Vector2 field_mT(double x, double y) const {
    return 1e3 * field_.in_plane_per_ampere({x, y}).head<2>();
  }
  void label(const std::string& words, cv::Point at, double size = 0.55) {
    cv::putText(image_, words, at, cv::FONT_HERSHEY_SIMPLEX, size, kBlack, 1, cv::LINE_AA);
  }

  static constexpr int kSide = 840;  // of the square map, px
  static constexpr int kLeft = 90, kTop = 60, kBottom = 80, kRight = 190;

  std::string name_;
  physics::DescribedCoil field_;
  double dish_radius_m_;
  double reach_m_;
  double px_per_m_;
  double low_ = 0.0, high_ = 0.0;  // decimal logarithm of mT/A
  cv::Mat image_;
};

Plot::Plot(const physics::CoilDescription& coil, const physics::MeasuredRegion& measured,
           double dish_radius_m)
    : name_(coil.name),
      field_(coil, measured),
      dish_radius_m_(dish_radius_m),
      reach_m_(1.08 * dish_radius_m),
      px_per_m_(kSide / (2.0 * reach_m_)),
      image_(kTop + kSide + kBottom, kLeft + kSide + kRight, CV_8UC3, kWhite) {}

/// The colour is logarithmic: the magnitude spans more than a decade over the dish.
void Plot::draw_field() {
  constexpr int kCoarse = kSide / 6;
  cv::Mat coarse(kCoarse, kCoarse, CV_64F), log_magnitude, grey, colour;
  for (int row = 0; row < kCoarse; ++row) {
    for (int column = 0; column < kCoarse; ++column) {
      const double x = reach_m_ * (2.0 * (column + 0.5) / kCoarse - 1.0);
      const double y = reach_m_ * (1.0 - 2.0 * (row + 0.5) / kCoarse);
      coarse.at<double>(row, column) = std::log10(field_mT(x, y).norm());
    }
  }
  cv::resize(coarse, log_magnitude, cv::Size(kSide, kSide), 0.0, 0.0, cv::INTER_LINEAR);
  cv::minMaxLoc(log_magnitude, &low_, &high_);
  log_magnitude.convertTo(grey, CV_8U, 255.0 / (high_ - low_), -255.0 * low_ / (high_ - low_));
  cv::applyColorMap(grey, colour, cv::COLORMAP_VIRIDIS);
  colour.copyTo(image_(cv::Rect(kLeft, kTop, kSide, kSide)));
  constexpr int kArrows = 17;
  for (int i = 0; i < kArrows; ++i) {
    for (int j = 0; j < kArrows; ++j) {
      const double x = reach_m_ * (2.0 * (i + 0.5) / kArrows - 1.0);
      const double y = reach_m_ * (2.0 * (j + 0.5) / kArrows - 1.0);
      const geometry::Vector2 half = 0.36 * 2.0 * reach_m_ / kArrows * field_mT(x, y).normalized();
      cv::arrowedLine(image_, pixel(x - half.x(), y - half.y()), pixel(x + half.x(), y + half.y()), kWhite, 1,
                      cv::LINE_AA, 0, 0.3);
    }
  }
}

void Plot::draw_dish(const std::vector<geometry::Vector2>& points_m) {
  cv::circle(image_, pixel(0.0, 0.0), static_cast<int>(dish_radius_m_ * px_per_m_), kWhite, 2, cv::LINE_AA);
  for (const geometry::Vector2& point : points_m)
    if (point.cwiseAbs().maxCoeff() <= reach_m_)
      cv::circle(image_, pixel(point.x(), point.y()), 4, kRed, cv::FILLED, cv::LINE_AA);
  cv::rectangle(image_, cv::Rect(kLeft, kTop, kSide, kSide), kBlack, 1);
  label("Coil " + name_ + ": field per ampere in the dish plane; circle: dish wall" +
            (points_m.empty() ? "" : "; red: points asked for"),
        {kLeft, 24}, 0.6);
}

void Plot::draw_axes() {
  const int step_mm = reach_m_ > 0.1 ? 50 : reach_m_ > 0.03 ? 10 : 2;
  for (int mm = -static_cast<int>(reach_m_ * 1e3) / step_mm * step_mm; mm * 1e-3 <= reach_m_; mm += step_mm) {
    const cv::Point below(pixel(mm * 1e-3, 0.0).x, kTop + kSide);
    const cv::Point beside(kLeft, pixel(0.0, mm * 1e-3).y);
    cv::line(image_, below, below + cv::Point(0, 6), kBlack);
    cv::line(image_, beside, beside - cv::Point(6, 0), kBlack);
    label(std::to_string(mm), below + cv::Point(-12, 24), 0.5);
    label(std::to_string(mm), beside + cv::Point(-44, 5), 0.5);
  }
  label("x (mm)", {kLeft + kSide / 2 - 30, kTop + kSide + 56});
  label("y (mm)", {12, kTop - 14});
}

void Plot::draw_scale() {
  constexpr int kLabels = 7;
  const cv::Rect bar(kLeft + kSide + 40, kTop, 27, kSide);
  cv::Mat ramp(bar.size(), CV_8U), shades;
  for (int row = 0; row < kSide; ++row) ramp.row(row) = cv::Scalar(255.0 * (kSide - 1 - row) / (kSide - 1));
  cv::applyColorMap(ramp, shades, cv::COLORMAP_VIRIDIS);
  shades.copyTo(image_(bar));
  cv::rectangle(image_, bar, kBlack, 1);
  label("|B| (mT/A)", {bar.x - 14, kTop - 14});
  for (int i = 0; i < kLabels; ++i) {
    const double fraction = static_cast<double>(i) / (kLabels - 1);
    const int row = kTop + static_cast<int>(std::lround((1.0 - fraction) * (kSide - 1)));
    cv::line(image_, {bar.x + 27, row}, {bar.x + 33, row}, kBlack);
    label(fmt::format("{:.3g}", std::pow(10.0, low_ + fraction * (high_ - low_))), {bar.x + 40, row + 5},
          0.5);
  }
}

}  // namespace

std::size_t coil_index(const physics::CoilsDescription& coils, const std::string& name) {
  std::string known;
  for (std::size_t coil = 0; coil < coils.count(); ++coil) {
    if (name == coils.name(coil)) return coil;
    known += (coil == 0 ? "" : coil + 1 == coils.count() ? " and " : ", ") + coils.name(coil);
  }
  throw common::ConfigError("coil = \"" + name + "\" is unknown; it is one of " + known);
}

std::vector<Eigen::Vector3d> field_per_ampere(const physics::CoilsDescription& coils, std::size_t coil,
                                              const std::vector<geometry::Vector2>& points_m) {
  const physics::CoilDescription described = coils.coil(coil);
  const physics::DescribedCoil field(described, coils.measured);
  std::vector<Eigen::Vector3d> fields;
  fields.reserve(points_m.size());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Eigen::Vector3d point_m(points_m[i].x(), points_m[i].y(), 0.0);
    if (!described.measured() && described.winds_at(point_m))
      throw common::DataError("point " + std::to_string(i + 1) + " (" + std::to_string(points_m[i].x()) +
                              ", " + std::to_string(points_m[i].y()) + ") m lies in the winding of coil " +
                              described.name);
    fields.push_back(field.per_ampere(point_m));
  }
  return fields;
}

std::string field_csv(const std::vector<geometry::Vector2>& points_m,
                      const std::vector<Eigen::Vector3d>& field_T_per_A) {
  std::string csv = "x_m,y_m,Bx_T_per_A,By_T_per_A,Bz_T_per_A\n";
  for (std::size_t i = 0; i < points_m.size(); ++i)  // plus zero: no "-0"
    csv += fmt::format("{},{},{},{},{}\n", points_m[i].x() + 0.0, points_m[i].y() + 0.0,
                       field_T_per_A[i].x() + 0.0, field_T_per_A[i].y() + 0.0, field_T_per_A[i].z() + 0.0);
  return csv;
}

void write_field_plot(const std::string& file, const physics::CoilsDescription& coils, std::size_t coil,
                      double dish_radius_m, const std::vector<geometry::Vector2>& points_m) {
  Plot plot(coils.coil(coil), coils.measured, dish_radius_m);
  plot.draw_field();
  plot.draw_dish(points_m);
  plot.draw_axes();
  plot.draw_scale();
  common::write_file_atomically(file, imaging::encoded_image(plot.image(), ".png"));
}

}  // namespace lodestone::rig
