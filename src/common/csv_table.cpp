#include "lodestone/common/csv_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>

#include "lodestone/common/files.h"
#include "lodestone/common/shown.h"

namespace lodestone::common {
namespace {

constexpr std::uintmax_t kLargestFile = 256 << 20;  // bytes: millions of rows

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Cells of one line; quotes hold separators, and a doubled quote inside them is one quote. `quoted`: the
/// last one is not closed.
std::vector<std::string> split_cells(const std::string& whole, char separator, bool& quoted) {
  const bool blanks = separator == ' ';
  const std::string line = blanks ? trimmed(whole) : whole;
  const auto separates = [&](char c) { return c == separator || (blanks && c == '\t'); };
  std::vector<std::string> cells(1);
  quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (separates(c) && !quoted) {
      if (!blanks || !separates(line[i - 1])) cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  for (std::string& cell : cells) cell = trimmed(cell);
  return cells;
}

}  // namespace

CsvTable::CsvTable(const std::string& path, const CsvFormat& format) : path_(path), format_(format) {
  std::error_code fault;
  if (std::filesystem::exists(path, fault)) check_is_file(path);  // before: a pipe would be waited for
  if (const auto size = std::filesystem::file_size(path, fault); !fault && size > kLargestFile)
    throw DataError(
        fmt::format("cannot read {}: it holds {} bytes, at most {} are read", path, size, kLargestFile));
  stream_.open(path, std::ios::binary);
  if (!stream_ || stream_.peek() == std::ifstream::traits_type::eof())
    throw DataError("cannot read " + path + ": there is no such file, or it is empty");
  read_header();
}

void CsvTable::read_header() {
  for (std::string line; line_ + 1 < format_.header_line && std::getline(stream_, line);) ++line_;
  if (!read_line(header_)) throw DataError(path_ + ": holds no header line");
  if (open_quote_) throw DataError(fmt::format("{}:{}: a quote is opened and not closed", path_, line_));
  if (format_.header_line == 0) {
    cells_ = header_;
    pending_ = true;
    for (std::size_t i = 0; i < header_.size(); ++i) header_[i] = std::to_string(i + 1);
  }
  std::set<std::string> seen;
  for (const std::string& name : header_)
    if (!name.empty() && !seen.insert(name).second)
      throw DataError(fmt::format("{}:{}: column {} appears twice in the header", path_, line_, shown(name)));
}

bool CsvTable::has_columns(const std::vector<std::string>& names) const {
  return std::all_of(names.begin(), names.end(), [this](const std::string& name) {
    return std::find(header_.begin(), header_.end(), name) != header_.end();
  });
}

std::size_t CsvTable::column(const std::string& name) const {
  const auto found = std::find(header_.begin(), header_.end(), name);
  LODESTONE_CHECK(found != header_.end(), "column " + name + " is not in the header");
  return static_cast<std::size_t>(found - header_.begin());
}

bool CsvTable::read_line(std::vector<std::string>& cells) {
  for (std::string line; std::getline(stream_, line);) {
    ++line_;
    if (line_ == 1 && line.rfind("\xEF\xBB\xBF", 0) == 0) line.erase(0, 3);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (trimmed(line).empty()) continue;
    cells = split_cells(line, format_.separator, open_quote_);
    return true;
  }
  if (stream_.bad()) throw DataError(fmt::format("{}:{}: the file cannot be read further", path_, line_));
  return false;
}

bool CsvTable::next() {
  if (!pending_) return read_line(cells_);
  pending_ = false;
  return true;
}

void CsvTable::check_width() const {
  if (open_quote_) throw RowError(fmt::format("{}:{}: a quote is opened and not closed", path_, line_));
  if (cells_.size() == header_.size()) return;
  const std::size_t first = std::min(cells_.size(), header_.size());
  const std::string where =
      first < header_.size() ? " (" + shown(header_[first]) + ") is missing" : " is one too many";
  const bool commas = cells_.size() > header_.size() && format_.separator == ',';
  throw RowError(fmt::format("{}:{}: column {}{}: the row has {} cells, the header {}{}", path_, line_,
                             first + 1, where, cells_.size(), header_.size(),
                             commas ? " (decimal commas need another separator, or quotes)" : ""));
}

double CsvTable::number(std::size_t column) const {
  std::string cell = cells_.at(column);
  if (cell.empty()) fail(column, "a number (the cell is empty)");
  const char other = format_.decimal == ',' ? '.' : ',';
  if (cell.find(other) != std::string::npos)
    fail(column, format_.decimal == ',' ? "a number with a decimal comma" : "a number with a decimal point");
  std::replace(cell.begin(), cell.end(), format_.decimal, '.');
  const bool plus = cell[0] == '+' && cell.size() > 1 && cell[1] != '-';
  const char* first = cell.data() + (plus ? 1 : 0);
  const char* last = cell.data() + cell.size();
  double value = 0.0;
  const auto [end, error] = std::from_chars(first, last, value);
  if (error != std::errc() || end != last) fail(column, "a number");
  if (!std::isfinite(value)) fail(column, "a finite number");
  return value;
}

void CsvTable::fail(std::size_t column, const std::string& expectation) const {
  throw RowError(path_ + ":" + std::to_string(line_) + ": column " + std::to_string(column + 1) + " (" +
                 shown(header_.at(column)) + "): \"" + shown(cells_.at(column)) + "\" must be " +
                 expectation);
}

}  // namespace lodestone::common
