#include "lodestone/report/html.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>

namespace lodestone::report {

std::string escape(const std::string& text) {
  static const std::map<char, const char*> kEntities = {
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
  std::string out;
  for (const char c : text) {
    const auto entity = kEntities.find(c);
    out += entity == kEntities.end() ? std::string(1, c) : entity->second;
  }
  return out;
}

std::string fixed(const std::optional<double>& value, int decimals) {
  if (!value || !std::isfinite(*value)) return "–";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, *value);
  return text;
}

std::string plus_minus(const std::optional<double>& mean, const std::optional<double>& deviation,
                       int decimals) {
  return deviation && mean ? fixed(mean, decimals) + " ± " + fixed(deviation, decimals)
                           : fixed(mean, decimals);
}

std::string with_interval(const std::optional<double>& value,
                          const std::optional<std::array<double, 2>>& interval, int decimals, double scale,
                          const std::string& unit) {
  if (!value || !interval) return "–";
  return fixed(scale * *value, decimals) + unit + " (" + fixed(scale * interval->at(0), decimals) + " to " +
         fixed(scale * interval->at(1), decimals) + ")";
}

std::string percent(const std::optional<double>& fraction) {
  return fraction ? fixed(100.0 * *fraction, 0) + " %" : "–";
}

std::string grouped(double value) {
  if (!(std::abs(value) < 1e15)) return "–";
  std::string digits = std::to_string(std::llround(std::abs(value)));
  for (int i = static_cast<int>(digits.size()) - 3; i > 0; i -= 3)
    digits.insert(static_cast<std::size_t>(i), "\u202f");
  return (value < 0 ? "−" : "") + digits;
}

std::string table(const std::vector<std::string>& headers, const std::vector<std::vector<std::string>>& rows,
                  int text_columns, const std::vector<std::string>& row_classes) {
  const auto kind = [text_columns](std::size_t column) {
    return static_cast<int>(column) < text_columns ? "" : " class=\"number\"";
  };
  std::string html = "<div class=\"scroll\"><table><thead><tr>";
  for (std::size_t i = 0; i < headers.size(); ++i)
    html += std::string("<th") + kind(i) + ">" + headers[i] + "</th>";
  html += "</tr></thead><tbody>\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    html +=
        r < row_classes.size() && !row_classes[r].empty() ? "<tr class=\"" + row_classes[r] + "\">" : "<tr>";
    for (std::size_t i = 0; i < rows[r].size(); ++i)
      html += std::string("<td") + kind(i) + ">" + rows[r][i] + "</td>";
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

void drop_empty_columns(std::vector<std::string>& headers, std::vector<std::vector<std::string>>& rows) {
  if (rows.empty()) return;
  for (std::size_t column = headers.size(); column-- > 0;) {
    const bool empty =
        std::all_of(rows.begin(), rows.end(), [column](const auto& row) { return row[column] == "–"; });
    if (!empty) continue;
    const auto at = static_cast<std::ptrdiff_t>(column);
    headers.erase(headers.begin() + at);
    for (std::vector<std::string>& row : rows) row.erase(row.begin() + at);
  }
}

std::string figure(const std::string& content, const std::string& caption, const std::string& css_class) {
  return "<figure" + (css_class.empty() ? "" : " class=\"" + css_class + "\"") + ">" + content +
         "<figcaption>" + caption + "</figcaption></figure>\n";
}

std::string missing(const std::string& what, const std::string& command) {
  return "<p class=\"missing\">" + escape(what) + " is not in this run: <code>" + escape(command) +
         "</code> makes it.</p>\n";
}

}  // namespace lodestone::report
