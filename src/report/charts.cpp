#include "lodestone/report/charts.h"

#include <cmath>

#include "lodestone/report/html.h"

namespace lodestone::report {
namespace {

using common::Json;

constexpr std::size_t kMaxPoints = 500;
constexpr double kSignificant = 1e5;  // five figures are more than a screen shows

double rounded(double value) {
  if (value == 0.0) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value)))) / kSignificant;
  return std::round(value / unit) * unit;
}

Json thinned(const Curve& points) {
  const std::size_t stretch = (points.size() + kMaxPoints - 1) / kMaxPoints;
  Json json = Json::array();
  for (std::size_t first = 0; first < points.size(); first += stretch) {
    const std::size_t last = std::min(first + stretch, points.size());
    double x = 0.0;
    double y = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      x += points[i].first;
      y += points[i].second;
    }
    const auto count = static_cast<double>(last - first);
    json.push_back({rounded(x / count), rounded(y / count)});
  }
  return json;
}

std::string canvas(const std::string& id, bool small, const Json& spec) {
  // "</" would end the script element early, wherever it stands.
  std::string text = spec.dump(-1, ' ', false, Json::error_handler_t::replace);
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3)
    text.insert(at + 1, "\\");
  return "<div class=\"chart" + std::string(small ? " small" : "") + "\"><canvas id=\"" + escape(id) +
         "\"></canvas></div><script>lodestone_chart(" + Json(id).dump() + ", " + text + ")</script>";
}

}  // namespace

std::string chart_html(const LineChart& chart) {
  Json spec = {{"title", chart.title},   {"x_label", chart.x_label},     {"y_label", chart.y_label},
               {"log_y", chart.log_y},   {"from_zero", chart.from_zero}, {"categories", nullptr},
               {"series", Json::array()}};
  spec["y_max"] = chart.y_max ? Json(*chart.y_max) : Json(nullptr);
  for (const LineSeries& series : chart.series)
    spec["series"].push_back({{"name", series.name},
                              {"colour", series.colour},
                              {"dashed", series.dashed},
                              {"points", thinned(series.points)}});
  return canvas(chart.id, chart.small, spec);
}

std::string chart_html(const BarChart& chart) {
  Json spec = {{"title", chart.title},     {"x_label", chart.x_label},
               {"y_label", chart.y_label}, {"log_y", false},
               {"from_zero", true},        {"y_max", nullptr},
               {"series", Json::array()},  {"categories", chart.categories}};
  for (const BarSeries& series : chart.series) {
    Json values = Json::array();
    for (const std::optional<double>& value : series.values)
      values.push_back(value ? Json(rounded(*value)) : Json(nullptr));
    spec["series"].push_back({{"name", series.name}, {"colour", series.colour}, {"values", values}});
  }
  return canvas(chart.id, false, spec);
}

}  // namespace lodestone::report
