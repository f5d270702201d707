#include "lodestone/report/charts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "lodestone/report/html.h"

namespace lodestone::report {
namespace {

using common::Json;

constexpr std::size_t kMaxPoints = 500;
constexpr double kSignificant = 1e5;  // five figures are more than a screen shows

double rounded(double value) {
  if (value == 0.0) return 0.0;
  const double scale = kSignificant / std::pow(10.0, std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;  // divided: 3 stays 3, and not 3.0000000000000004
}

Json thinned(const LineSeries& series) {
  const Curve& points = series.points;
  const std::size_t stretch = (points.size() + kMaxPoints - 1) / kMaxPoints;
  Json json = Json::array();
  for (std::size_t first = 0; first < points.size(); first += stretch) {
    const std::size_t last = series.dots ? first + 1 : std::min(first + stretch, points.size());
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

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string canvas(const std::string& id, bool small, const Json& spec, const std::string& description) {
  // "</" would end the script element early, wherever it stands.
  std::string text = spec.dump(-1, ' ', false, Json::error_handler_t::replace);
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3)
    text.insert(at + 1, "\\");
  const std::string words = escape(description);
  return "<div class=\"chart" + std::string(small ? " small" : "") + "\"><canvas id=\"" + escape(id) +
         "\" role=\"img\" aria-label=\"" + words + "\">" + words + "</canvas></div><script>lodestone_chart(" +
         Json(id).dump() + ", " + text + ")</script>";
}

std::string heading(const char* kind, const std::string& title, const std::string& x_label,
                    const std::string& y_label) {
  return std::string(kind) + (title.empty() ? "" : ": " + title) + ". " + y_label + " over " + x_label + ".";
}

}  // namespace

std::string describe(const LineChart& chart) {
  std::string text = heading("Chart", chart.title, chart.x_label, chart.y_label);
  for (const LineSeries& series : chart.series) {
    if (series.band || series.points.empty()) continue;
    const auto by_value = [](const auto& a, const auto& b) { return a.second < b.second; };
    const auto [low, high] = std::minmax_element(series.points.begin(), series.points.end(), by_value);
    text += " " + (series.name.empty() ? chart.y_label : series.name) + ": ";
    if (series.dots)
      text += std::to_string(series.points.size()) + " points";
    else
      text += "from " + short_number(series.points.front().second) + " at " +
              short_number(series.points.front().first) + " to " + short_number(series.points.back().second) +
              " at " + short_number(series.points.back().first);
    text += ", between " + short_number(low->second) + " and " + short_number(high->second) + ".";
  }
  return text;
}

std::string describe(const BarChart& chart) {
  std::string text = heading("Bar chart", chart.title, chart.x_label, chart.y_label);
  for (const BarSeries& series : chart.series) {
    text += " " + (series.name.empty() ? chart.y_label : series.name) + ":";
    for (std::size_t i = 0; i < series.values.size() && i < chart.categories.size(); ++i)
      if (series.values[i]) text += " " + chart.categories[i] + " " + short_number(*series.values[i]) + ",";
    text.back() = '.';
  }
  return text;
}

std::string chart_html(const LineChart& chart) {
  Json spec = {{"title", chart.title},   {"x_label", chart.x_label},     {"y_label", chart.y_label},
               {"log_y", chart.log_y},   {"from_zero", chart.from_zero}, {"categories", nullptr},
               {"series", Json::array()}};
  spec["y_max"] = chart.y_max ? Json(*chart.y_max) : Json(nullptr);
  bool edge = false;
  for (const LineSeries& series : chart.series) {
    const bool filled = series.band && edge;
    edge = series.band && !edge;
    spec["series"].push_back({{"name", series.name},
                              {"colour", series.colour},
                              {"dashed", series.dashed},
                              {"dots", series.dots},
                              {"stepped", series.stepped},
                              {"band", series.band},
                              {"filled", filled},
                              {"points", thinned(series)}});
  }
  return canvas(chart.id, chart.small, spec, describe(chart));
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
  return canvas(chart.id, false, spec, describe(chart));
}

}  // namespace lodestone::report
