#include "lodestone/report/dish_svg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "lodestone/geometry/angle.h"
#include "lodestone/report/html.h"

namespace lodestone::report {
namespace {

// Schematic coils, in dish radii: face at 50 mm of a 42.5 mm dish.
constexpr double kCoilFace = 1.18;
constexpr double kCoilDepth = 0.20;
constexpr double kCoilHalfWidth = 0.46;
constexpr double kFrame = 1.48;
// Every dish is drawn at this radius, so that line widths and text sizes suit all.
constexpr double kDrawnRadius = 42.5;
constexpr double kLegendSteps = 24;

constexpr std::array<std::array<int, 3>, 5> kScale = {
    {{236, 243, 243}, {168, 211, 205}, {84, 165, 170}, {38, 103, 143}, {26, 43, 82}}};

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.2f", value);
  return buffer;
}

/// Six significant digits.
std::string precise(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

std::string attribute(const char* name, double value) {
  return std::string(" ") + name + "=\"" + text(value) + "\"";
}

std::string label_at(double x, double y, double size, const char* anchor, const std::string& content,
                     const std::string& more = "") {
  return "<text" + attribute("x", x) + attribute("y", y) + attribute("font-size", size) + " text-anchor=\"" +
         anchor + "\" fill=\"#5b6773\"" + more + ">" + escape(content) + "</text>";
}

/// A round step that gives about three ticks on each side of the centre.
double tick_step(double radius_mm) {
  for (const double step : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0})
    if (radius_mm / step <= 3.0) return step;
  return 200.0;
}

/// Many coils are drawn narrower, so that neighbours do not touch.
std::string coils(const std::vector<DrawnRig::Coil>& drawn) {
  constexpr double kOfRoom = 0.8;
  const double r = kDrawnRadius, face = kCoilFace * r, depth = kCoilDepth * r;
  const double share = geometry::kPi / static_cast<double>(std::max<std::size_t>(drawn.size(), 4));
  const double half = std::min(kCoilHalfWidth * r, kOfRoom * face * std::tan(share));
  const double middle = face + depth / 2.0, size = 0.105 * r;
  std::string boxes, names;
  for (const DrawnRig::Coil& coil : drawn) {
    boxes += "<rect" + attribute("x", face) + attribute("y", -half) + attribute("width", depth) +
             attribute("height", 2.0 * half) + attribute("rx", std::min(depth, 2.0 * half) * 0.12) +
             " transform=\"rotate(" + text(-coil.direction_deg) +
             ")\" class=\"coil\" fill=\"#ead3bd\" stroke=\"#b98a5e\" stroke-width=\"0.4\"/>";
    const double angle_rad = geometry::kRadPerDeg * coil.direction_deg;
    names += label_at(middle * std::cos(angle_rad), -middle * std::sin(angle_rad) + size * 0.35, size,
                      "middle", coil.name, " font-weight=\"600\"");
  }
  return boxes + names;
}

std::string axes(double radius_mm, bool compact) {
  const double r = kDrawnRadius;
  const double scale = r / radius_mm;
  const double f = kFrame * r;
  const double size = 0.085 * r;
  const double step_mm = tick_step(radius_mm);
  std::string svg = "<g class=\"frame\" stroke=\"#c5ccd3\" stroke-width=\"0.25\">";
  std::string labels;
  const int ticks = static_cast<int>(std::floor(radius_mm / step_mm));
  for (int i = -ticks; i <= ticks; ++i) {
    const double at = i * step_mm * scale;
    svg += "<line" + attribute("x1", at) + attribute("x2", at) + attribute("y1", f) +
           attribute("y2", f + 0.03 * r) + "/><line" + attribute("x1", -f) + attribute("x2", -f - 0.03 * r) +
           attribute("y1", at) + attribute("y2", at) + "/>";
    char tick[16];
    std::snprintf(tick, sizeof tick, "%.0f", i * step_mm);
    labels += label_at(at, f + 0.14 * r, size, "middle", tick);
    labels += label_at(-f - 0.06 * r, -at + 0.35 * size, size, "end", tick);
  }
  svg += "<rect fill=\"none\"" + attribute("x", -f) + attribute("y", -f) + attribute("width", 2 * f) +
         attribute("height", 2 * f) + "/></g>";
  if (compact) {
    // A bar of one tick step is scale enough for a small panel.
    const double y = f - 0.07 * r;
    const double x0 = -f + 0.07 * r;
    char caption[24];
    const double length = step_mm * scale;
    std::snprintf(caption, sizeof caption, "%.0f mm", step_mm);
    return "<line class=\"rim\" stroke=\"#5b6773\" stroke-width=\"0.5\"" + attribute("x1", x0) +
           attribute("x2", x0 + length) + attribute("y1", y) + attribute("y2", y) + "/>" +
           label_at(x0 + length / 2.0, y - 0.04 * r, 0.1 * r, "middle", caption);
  }
  svg += labels + label_at(0, f + 0.27 * r, size, "middle", "x (mm)") +
         label_at(0, -f - 0.24 * r, size, "middle", "y (mm)", " transform=\"rotate(-90)\"");
  return svg;
}

/// A stroke as wide as twice the radius reaches so far beyond a polygon, round its corners.
std::string drawn_zones(const std::vector<DrawnZone>& zones, double scale) {
  constexpr const char* kLook =
      " class=\"keep-out\" fill=\"#c0392b\" opacity=\"0.45\" stroke=\"#c0392b\" stroke-linejoin=\"round\"";
  std::string svg;
  for (const DrawnZone& zone : zones) {
    if (zone.corners_mm.size() == 1) {
      const auto& [x_mm, y_mm] = zone.corners_mm.front();
      svg += std::string("<circle") + kLook + " stroke-width=\"0\"" + attribute("cx", scale * x_mm) +
             attribute("cy", scale * -y_mm) + attribute("r", scale * zone.radius_mm) + "/>";
      continue;
    }
    svg += std::string("<polygon") + kLook + attribute("stroke-width", 2.0 * scale * zone.radius_mm) +
           " points=\"";
    for (const auto& [x_mm, y_mm] : zone.corners_mm)
      svg += text(scale * x_mm) + "," + text(scale * -y_mm) + " ";
    svg += "\"/>";
  }
  return svg;
}

}  // namespace

std::string map_colour(double t) {
  t = std::clamp(std::isfinite(t) ? t : 0.0, 0.0, 1.0) * static_cast<double>(kScale.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(t), kScale.size() - 2);
  const double part = t - static_cast<double>(low);
  char colour[8];
  std::array<int, 3> mixed{};
  for (std::size_t i = 0; i < 3; ++i)
    mixed[i] = static_cast<int>(std::lround((1.0 - part) * kScale[low][i] + part * kScale[low + 1][i]));
  std::snprintf(colour, sizeof colour, "#%02x%02x%02x", mixed[0] & 255, mixed[1] & 255, mixed[2] & 255);
  return colour;
}

DishSvg::DishSvg(const DrawnRig& rig, bool compact)
    : rig_(rig), scale_(kDrawnRadius / rig.radius_mm), compact_(compact) {}

void DishSvg::map(const std::vector<MapCell>& cells, double side_mm, double low, double high,
                  const std::string& legend, int decimals) {
  const double span = high > low ? high - low : 1.0;
  for (const MapCell& cell : cells)
    cells_ += "<rect class=\"cell\" data-value=\"" + precise(cell.value) + "\"" +
              attribute("x", scale_ * (cell.x_mm - side_mm / 2)) +
              attribute("y", scale_ * (-cell.y_mm - side_mm / 2)) + attribute("width", scale_ * side_mm) +
              attribute("height", scale_ * side_mm) + " fill=\"" + map_colour((cell.value - low) / span) +
              "\"/>";
  const double r = kDrawnRadius;
  const double x = (kFrame + 0.12) * r;
  const double top = -r;
  const double step = 2.0 * r / kLegendSteps;
  legend_.clear();
  for (int i = 0; i < static_cast<int>(kLegendSteps); ++i)
    legend_ += "<rect" + attribute("x", x) + attribute("y", top + i * step) + attribute("width", 0.1 * r) +
               attribute("height", step * 1.05) + " fill=\"" + map_colour(1.0 - (i + 0.5) / kLegendSteps) +
               "\"/>";
  const double size = 0.085 * r;
  for (int i = 0; i <= 4; ++i)
    legend_ += label_at(x + 0.14 * r, top + i * r / 2.0 + 0.35 * size, size, "start",
                        fixed(high - (high - low) * i / 4.0, decimals));
  legend_ += label_at(0, 0, size, "middle", legend,
                      " transform=\"translate(" + text(x + 0.48 * r) + " 0) rotate(90)\"");
}

void DishSvg::squares(const Points& centres_mm, double side_mm, const std::string& colour) {
  for (const auto& [x_mm, y_mm] : centres_mm)
    cells_ += "<rect class=\"cell\"" + attribute("x", scale_ * (x_mm - side_mm / 2)) +
              attribute("y", scale_ * (-y_mm - side_mm / 2)) + attribute("width", scale_ * side_mm) +
              attribute("height", scale_ * side_mm) + " fill=\"" + escape(colour) + "\"/>";
}

void DishSvg::line(const Points& points, const std::string& colour, double width, double opacity,
                   bool dashed) {
  if (points.size() < 2) return;
  marks_ += "<polyline fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" stroke=\"" +
            escape(colour) + "\"" + attribute("stroke-width", width) + attribute("stroke-opacity", opacity) +
            (dashed ? " stroke-dasharray=\"2 1.6\"" : "") + " points=\"";
  for (const auto& [x, y] : points) marks_ += text(scale_ * x) + "," + text(scale_ * -y) + " ";
  marks_ += "\"/>";
}

void DishSvg::dot(double x_mm, double y_mm, double radius, const std::string& colour, bool hollow,
                  double opacity) {
  marks_ +=
      std::string("<circle class=\"mark") + (hollow ? " hollow\"" : "\"") + attribute("cx", scale_ * x_mm) +
      attribute("cy", scale_ * -y_mm) + attribute("r", radius) + attribute("opacity", opacity) +
      (hollow ? " fill=\"#ffffff\" stroke-width=\"0.35\" stroke=\"" : " fill=\"") + escape(colour) + "\"/>";
}

void DishSvg::target(double x_mm, double y_mm, double radius_mm, const std::string& colour) {
  const double x = scale_ * x_mm;
  const double y = scale_ * -y_mm;
  const double r = scale_ * radius_mm;
  const double arm = 0.45 * r;
  marks_ += "<g class=\"target\" fill=\"none\" stroke-width=\"0.4\" stroke=\"" + escape(colour) +
            "\"><circle" + attribute("cx", x) + attribute("cy", y) + attribute("r", r) + "/><line" +
            attribute("x1", x - arm) + attribute("x2", x + arm) + attribute("y1", y) + attribute("y2", y) +
            "/><line" + attribute("x1", x) + attribute("x2", x) + attribute("y1", y - arm) +
            attribute("y2", y + arm) + "/></g>";
}

std::string DishSvg::svg(const std::string& label) const {
  const double r = kDrawnRadius;
  const double left = compact_ ? kFrame * r + 1.0 : (kFrame + 0.34) * r;
  const double right = legend_.empty() ? kFrame * r + 1.0 : (kFrame + 0.70) * r;
  const double top = kFrame * r + 1.0;
  const double bottom = compact_ ? top : (kFrame + 0.34) * r;
  return "<svg role=\"img\" aria-label=\"" + escape(label) +
         "\" xmlns=\"http://www.w3.org/2000/svg\" data-mm=\"" + precise(1.0 / scale_) + "\" viewBox=\"" +
         text(-left) + " " + text(-top) + " " + text(left + right) + " " + text(top + bottom) + "\"><title>" +
         escape(label) + "</title><defs><clipPath id=\"dish\"><circle cx=\"0\" cy=\"0\"" + attribute("r", r) +
         "/></clipPath></defs>" + coils(rig_.coils) +
         "<circle class=\"ground rim\" cx=\"0\" cy=\"0\" fill=\"#ffffff\" stroke=\"#5b6773\" "
         "stroke-width=\"0.6\"" +
         attribute("r", r) + "/><g clip-path=\"url(#dish)\">" + cells_ + drawn_zones(rig_.keep_out, scale_) +
         "</g><circle class=\"rim\" cx=\"0\" cy=\"0\" fill=\"none\" "
         "stroke=\"#5b6773\" stroke-width=\"0.6\"" +
         attribute("r", r) + "/>" + marks_ + axes(rig_.radius_mm, compact_) + legend_ + "</svg>";
}

}  // namespace lodestone::report
