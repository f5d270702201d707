#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodestone/report/run_data.h"

namespace lodestone::report {

/// Colours of what is compared, the same on every image.
constexpr const char* kPolicyColour = "#1f5f8b";
constexpr const char* kUnseenColour = "#6aa6c9";
constexpr const char* kBaselineColour = "#c8553d";
constexpr const char* kUnseenBaselineColour = "#e0a695";
constexpr const char* kPaperColour = "#b9bfc5";
constexpr const char* kSecondColour = "#7a8b3c";
constexpr const char* kObserverColour = "#8a5a9e";
constexpr const char* kUnseenObserverColour = "#c4a5d1";

struct LineSeries {
  std::string name;
  Curve points;
  std::string colour = kPolicyColour;
  bool dashed = false;
  bool dots = false;     ///< points without a line, as they are
  bool stepped = false;  ///< a value holds until the next point
  bool band = false;     ///< an edge of an area, lower and upper one after the other; not in the legend
};

/// Lines over a numeric axis; labels carry the units.
struct LineChart {
  std::string id;  ///< unique on the page
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<LineSeries> series = {};
  bool log_y = false;
  bool from_zero = false;
  std::optional<double> y_max = {};
  bool small = false;
};

struct BarSeries {
  std::string name;
  std::vector<std::optional<double>> values;  ///< one for each category
  std::string colour = kPolicyColour;
};

/// Bars over named categories.
struct BarChart {
  std::string id;
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<std::string> categories = {};
  std::vector<BarSeries> series = {};
};

/// What a chart shows, in words: axes, and of each series where it starts, ends, and its extremes.
std::string describe(const LineChart& chart);
std::string describe(const BarChart& chart);

/// HTML of a chart: a canvas and the script that draws it, with its description for those who cannot see it.
/// Lines of more than 500 points are averaged over equal stretches; of dots, every so many-th is kept.
std::string chart_html(const LineChart& chart);
std::string chart_html(const BarChart& chart);

}  // namespace lodestone::report
