#include "lodestone/report/figure_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>

#include "chart_plot.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/shell.h"

namespace lodestone::report {
namespace {

using common::Json;

struct Width {
  const char* suffix;
  double mm;
};
constexpr std::array<Width, 2> kWidths = {{{"-85mm", 85.0}, {"-175mm", 175.0}}};

/// A figure of a page: a chart's specification, or a drawing.
struct Found {
  std::string name;
  std::optional<Json> chart;
  std::string svg;
};

/// What stands between two texts from `at` on, which is moved behind it; nothing where there is no more.
std::optional<std::string> between(const std::string& text, const std::string& begin, const std::string& end,
                                   std::size_t& at) {
  const std::size_t first = text.find(begin, at);
  if (first == std::string::npos) return std::nullopt;
  const std::size_t last = text.find(end, first + begin.size());
  if (last == std::string::npos) return std::nullopt;
  at = last + end.size();
  return text.substr(first + begin.size(), last - first - begin.size());
}

/// A file's name of a text, which no other figure has.
std::string file_name(const std::string& text, std::set<std::string>& taken) {
  constexpr std::size_t kLongest = 60;
  std::string name;
  for (const char c : text) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (plain) name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (!plain && !name.empty() && name.back() != '-') name += '-';
    if (name.size() == kLongest) break;
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  if (name.empty()) name = "figure";
  std::string unique = name;
  for (int i = 2; !taken.insert(unique).second; ++i) unique = name + "-" + std::to_string(i);
  return unique;
}

std::vector<Found> figures_of(const std::string& page) {
  std::vector<Found> found;
  std::set<std::string> taken;
  std::size_t at = 0;
  // Only calls have a text behind the bracket; the function itself stands in the head, too.
  while (const auto call = between(page, "<script>lodestone_chart(\"", ")</script>", at)) {
    const Json arguments = Json::parse("[\"" + *call + "]", nullptr, false);
    if (!arguments.is_array() || arguments.size() != 2) continue;
    found.push_back({file_name(arguments[0].get<std::string>(), taken), arguments[1], ""});
  }
  at = 0;
  while (const auto inner = between(page, "<svg role=\"img\" ", "</svg>", at)) {
    std::size_t label_at = 0;
    const std::string label = between(*inner, "aria-label=\"", "\"", label_at).value_or("drawing");
    found.push_back({file_name(label, taken), std::nullopt, "<svg role=\"img\" " + *inner + "</svg>"});
  }
  return found;
}

double number_of(const std::string& element, const char* name) {
  std::size_t at = 0;
  return std::strtod(between(element, std::string(" ") + name + "=\"", "\"", at).value_or("0").c_str(),
                     nullptr);
}

/// What is drawn in a dish, in mm: cells of a map with their values, points of lines, and dots.
std::string drawing_csv(const std::string& svg) {
  const double mm = number_of(svg, "data-mm");
  std::string csv = "kind,number,x_mm,y_mm,value\n";
  int count = 0;
  std::size_t at = 0;
  while (const auto cell = between(svg, "<rect class=\"cell\"", "/>", at))
    csv += fmt::format("cell,{},{:.3f},{:.3f},{:g}\n", count++,
                       mm * (number_of(*cell, "x") + 0.5 * number_of(*cell, "width")),
                       -mm * (number_of(*cell, "y") + 0.5 * number_of(*cell, "height")),
                       number_of(*cell, "data-value"));
  at = 0, count = 0;
  while (const auto line = between(svg, "<polyline", "/>", at)) {
    std::size_t points_at = 0;
    const std::string points = between(*line, " points=\"", "\"", points_at).value_or("");
    const char* next = points.c_str();
    for (char* end = nullptr; *next != '\0'; next = end) {
      const double x = std::strtod(next, &end);
      if (end == next || *end != ',') break;
      const char* second = end + 1;
      const double y = std::strtod(second, &end);
      while (*end == ' ') ++end;
      csv += fmt::format("line,{},{:.3f},{:.3f},\n", count, mm * x, -mm * y);
    }
    ++count;
  }
  const std::pair<const char*, const char*> marks[] = {{"dot", "<circle class=\"mark"},
                                                       {"target", "<g class=\"target\""}};
  for (const auto& [kind, begin] : marks) {
    at = 0, count = 0;
    while (const auto mark = between(svg, begin, "/>", at))
      csv += fmt::format("{},{},{:.3f},{:.3f},\n", kind, count++, mm * number_of(*mark, "cx"),
                         -mm * number_of(*mark, "cy"));
  }
  return csv;
}

/// The same drawing so many millimetres wide.
std::string sized(const std::string& svg, double width_mm) {
  std::size_t at = 0;
  const std::string box = between(svg, " viewBox=\"", "\"", at).value_or("0 0 1 1");
  std::array<double, 4> bounds = {0.0, 0.0, 1.0, 1.0};
  const char* next = box.c_str();
  for (double& bound : bounds) {
    char* end = nullptr;
    bound = std::strtod(next, &end);
    next = end;
  }
  return fmt::format("<svg width=\"{:g}mm\" height=\"{:.2f}mm\" ", width_mm,
                     width_mm * bounds[3] / bounds[2]) +
         svg.substr(5) + "\n";
}

/// gnuplot counts in pixels; a journal does in millimetres.
void size_in_mm(const std::string& path, double width_mm) {
  std::string svg = common::read_file(path);
  const std::size_t first = svg.find("<svg");
  const std::size_t last = svg.find('>', first);
  if (first == std::string::npos || last == std::string::npos)
    throw common::IoError("gnuplot left no drawing in " + path);
  std::string head = svg.substr(first, last - first);
  const double height_mm = width_mm * number_of(head, "height") / number_of(head, "width");
  for (const auto& [name, mm] : {std::pair("width", width_mm), std::pair("height", height_mm)}) {
    const std::size_t begin = head.find(std::string(" ") + name + "=\"");
    const std::size_t end =
        begin == std::string::npos ? begin : head.find('"', begin + std::string(name).size() + 3);
    if (end != std::string::npos)
      head.replace(begin, end + 1 - begin, fmt::format(" {}=\"{:.2f}mm\"", name, mm));
  }
  common::write_file_atomically(path, svg.replace(first, last - first, head));
}

void run_tool(const std::vector<std::string>& words, const std::string& package) {
  const common::CommandResult result = common::run_command(words);
  if (result.exit_code == 127)
    throw common::ConfigError("figures: there is no " + words.front() +
                              ", only the CSV files were written; install " + package);
  if (result.exit_code != 0) throw common::IoError(words.front() + " failed: " + result.output);
}

}  // namespace

std::vector<std::string> save_figures(const std::string& page, const std::string& folder) try {
  const std::vector<Found> figures = figures_of(common::read_file(page));
  if (figures.empty())
    throw common::ConfigError("figures: " + page +
                              " holds no figure; name a page that report, compare, sweep or bench wrote");
  common::make_folders(folder);
  std::string script;
  std::vector<std::string> names;
  std::vector<std::pair<std::string, double>> charts, drawings;  // files without ending, and their width
  for (const Found& figure : figures) {
    names.push_back(figure.name);
    const std::string base = folder + "/" + figure.name;
    common::write_file_atomically(base + ".csv",
                                  figure.chart ? chart_csv(*figure.chart) : drawing_csv(figure.svg));
    for (const Width& width : kWidths) {
      const std::string file = base + width.suffix;
      if (!figure.chart) {
        common::write_file_atomically(file + ".svg", sized(figure.svg, width.mm));
        drawings.emplace_back(file, width.mm);
        continue;
      }
      const std::string commands =
          chart_gnuplot(*figure.chart, figure.name + width.suffix + ".svg", width.mm);
      if (commands.empty()) continue;  // without a point
      script += commands;
      charts.emplace_back(file, width.mm);
    }
  }
  if (!charts.empty()) {
    common::write_file_atomically(folder + "/charts.gp", script);
    run_tool({"gnuplot", "-e", "cd " + gnuplot_text(folder) + "; load 'charts.gp'"}, "gnuplot-nox");
    for (const auto& [file, mm] : charts) size_in_mm(file + ".svg", mm);
  }
  for (const auto* files : {&charts, &drawings})
    for (const auto& [file, mm] : *files)
      run_tool({"rsvg-convert", "-f", "pdf", "-o", file + ".pdf", file + ".svg"}, "librsvg2-bin");
  return names;
} catch (const Json::exception& error) {
  throw common::DataError(page + ": a chart of it is damaged (" + error.what() + "); write the page again");
}

}  // namespace lodestone::report
