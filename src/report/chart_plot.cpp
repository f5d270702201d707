#include "chart_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace lodestone::report {
namespace {

using common::Json;

constexpr double kPixelsPerMm = 96.0 / 25.4;
constexpr double kHeightToWidth = 0.62;
constexpr double kLegendLinePixels = 15.0;  // above the plot, a line for each name
constexpr double kFontPixels = 10.0;        // 7.5 pt, whatever the width

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? "\"\"" : std::string(1, c);
  return cell + "\"";
}

std::string number(const Json& value) { return value.is_null() ? "" : value.dump(); }

std::string name_of(const Json& spec, const Json& series) {
  const auto name = series.at("name").get<std::string>();
  return name.empty() ? spec.at("y_label").get<std::string>() : name;
}

/// How a series of points is drawn.
std::string line_style(const Json& series) {
  const std::string colour = "lc rgb " + gnuplot_text(series.at("colour").get<std::string>());
  if (series.at("dots").get<bool>()) return "with points pt 7 ps 0.25 " + colour;
  const std::string dash = series.at("dashed").get<bool>() ? " dt 2" : "";
  if (series.at("stepped").get<bool>()) return "with steps lw 1.2 " + colour + dash;
  return "with lines lw 1.2 " + colour + dash;
}

std::string title_of(const Json& series) {
  const auto name = series.at("name").get<std::string>();
  return name.empty() ? "notitle" : "title " + gnuplot_text(name);
}

std::string lines(const Json& spec) {
  std::string data, plot;
  int block = 0;
  const Json* lower = nullptr;
  for (const Json& series : spec.at("series")) {
    if (series.at("points").empty()) continue;
    if (series.at("band").get<bool>() && !series.at("filled").get<bool>()) {
      lower = &series.at("points");
      continue;
    }
    const bool area = series.at("filled").get<bool>() && lower != nullptr;
    data += fmt::format("$data{} << EOD\n", block);
    std::size_t i = 0;
    for (const Json& point : series.at("points")) {
      data += number(point[0]) + " " + number(point[1]);
      if (area && i < lower->size()) data += " " + number((*lower)[i][1]);
      data += "\n";
      ++i;
    }
    data += "EOD\n";
    plot += plot.empty() ? "plot " : ", ";
    plot += fmt::format("$data{} ", block);
    plot += area ? "using 1:2:3 with filledcurves fs transparent solid 0.18 noborder lc rgb " +
                       gnuplot_text(series.at("colour").get<std::string>()) + " notitle"
                 : "using 1:2 " + line_style(series) + " " + title_of(series);
    ++block;
  }
  return plot.empty() ? "" : data + plot + "\n";
}

std::string bars(const Json& spec) {
  std::string data = "$bars << EOD\n", plot;
  for (std::size_t row = 0; row < spec.at("categories").size(); ++row) {
    data += fmt::format("{}", row);
    for (const Json& series : spec.at("series"))
      data += " " + (row < series.at("values").size() && !series["values"][row].is_null()
                         ? number(series["values"][row])
                         : std::string("?"));
    data += "\n";
  }
  data += "EOD\n";
  std::string ticks;
  for (std::size_t row = 0; row < spec["categories"].size(); ++row)
    ticks += (ticks.empty() ? "" : ", ") + gnuplot_text(spec["categories"][row].get<std::string>()) +
             fmt::format(" {}", row);
  std::size_t column = 2;
  for (const Json& series : spec["series"])
    plot += (plot.empty() ? "plot " : ", ") +
            fmt::format("$bars using {} with histograms lc rgb ", column++) +
            gnuplot_text(series.at("colour").get<std::string>()) + " " + title_of(series);
  if (plot.empty()) return "";
  return data + "set style histogram clustered gap 1\nset style fill solid noborder\nset xtics (" + ticks +
         ") rotate by -30\n" + plot + "\n";
}

bool of_bars(const Json& spec) { return !spec.at("categories").is_null(); }

}  // namespace

std::string gnuplot_text(std::string text) {
  for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos; at += 2) text.insert(at, "'");
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return "'" + text + "'";
}

std::string chart_csv(const Json& spec) {
  const std::string x = csv_cell(spec.at("x_label")), y = csv_cell(spec.at("y_label"));
  if (of_bars(spec)) {
    std::string csv = x + ",series," + y + "\n";
    for (const Json& series : spec.at("series"))
      for (std::size_t row = 0; row < series.at("values").size() && row < spec["categories"].size(); ++row)
        csv += csv_cell(spec["categories"][row]) + "," + csv_cell(name_of(spec, series)) + "," +
               number(series["values"][row]) + "\n";
    return csv;
  }
  std::string csv = "series," + x + "," + y + "\n";
  for (const Json& series : spec.at("series")) {
    const bool band = series.at("band").get<bool>();
    const std::string name =
        band ? (series.at("filled").get<bool>() ? "upper edge" : "lower edge") : name_of(spec, series);
    for (const Json& point : series.at("points"))
      csv += csv_cell(name) + "," + number(point[0]) + "," + number(point[1]) + "\n";
  }
  return csv;
}

std::string chart_gnuplot(const Json& spec, const std::string& out, double width_mm) {
  const double width = kPixelsPerMm * width_mm;
  const auto named =
      std::count_if(spec.at("series").begin(), spec.at("series").end(),
                    [](const Json& series) { return !series.at("name").get<std::string>().empty(); });
  const double height = kHeightToWidth * width + kLegendLinePixels * static_cast<double>(named);
  std::string script = fmt::format(
      "reset session\nset terminal svg size {:.0f},{:.0f} font 'Helvetica,{:.0f}' noenhanced background rgb "
      "'white'\nset output {}\n",
      width, height, kFontPixels, gnuplot_text(out));
  script +=
      "set datafile missing '?'\nset border 3 lc rgb '#5b6773'\nset tics nomirror out\nset grid lc rgb "
      "'#e3e7ea'\n"
      "set key above left reverse Left samplen 1.5\n";
  if (const auto title = spec.at("title").get<std::string>(); !title.empty())
    script += "set title " + gnuplot_text(title) + "\n";
  script += "set xlabel " + gnuplot_text(spec.at("x_label")) + "\nset ylabel " +
            gnuplot_text(spec.at("y_label")) + "\n";
  if (spec.at("log_y").get<bool>()) script += "set logscale y\n";
  const std::string low = spec.at("from_zero").get<bool>() && !spec.at("log_y").get<bool>() ? "0" : "*";
  const std::string high = spec.at("y_max").is_null() ? "*" : number(spec.at("y_max"));
  script += "set yrange [" + low + ":" + high + "]\n";
  const std::string plot = of_bars(spec) ? bars(spec) : lines(spec);
  return plot.empty() ? "" : script + plot + "unset output\n\n";
}

}  // namespace lodestone::report
