#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace lodestone::report {

/// Text made safe inside elements and attributes.
std::string escape(const std::string& text);

/// Number with a fixed count of decimals; an en dash when absent.
std::string fixed(const std::optional<double>& value, int decimals);
/// "6.30 ± 2.10"; the mean alone when the deviation is absent.
std::string plus_minus(const std::optional<double>& mean, const std::optional<double>& deviation,
                       int decimals);
/// "0.45 (0.41 to 0.52)", of numbers times `scale`, with `unit` behind the first; an en dash when either is
/// absent.
std::string with_interval(const std::optional<double>& value,
                          const std::optional<std::array<double, 2>>& interval, int decimals,
                          double scale = 1.0, const std::string& unit = "");
/// Fraction as "87 %".
std::string percent(const std::optional<double>& fraction);
/// Whole number with thin spaces between thousands.
std::string grouped(double value);

/// A table: headers (with units) and rows of ready HTML. The first `text_columns` are aligned left, numbers
/// right. `row_classes` may be empty, or names a CSS class for each row.
std::string table(const std::vector<std::string>& headers, const std::vector<std::vector<std::string>>& rows,
                  int text_columns, const std::vector<std::string>& row_classes = {});

/// Takes away columns of which every cell is an en dash; without rows there are none.
void drop_empty_columns(std::vector<std::string>& headers, std::vector<std::vector<std::string>>& rows);

/// A figure of ready HTML with its caption (HTML).
std::string figure(const std::string& content, const std::string& caption, const std::string& css_class = "");

/// The sentence that stands where a part of the run is missing.
std::string missing(const std::string& what, const std::string& command);

}  // namespace lodestone::report
