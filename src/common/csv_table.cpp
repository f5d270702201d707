#include "lodestone/common/csv_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

namespace lodestone::common {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Cells of one line; quotes hold commas, and a doubled quote inside them is one quote.
std::vector<std::string> split_cells(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  for (std::string& cell : cells) cell = trimmed(cell);
  return cells;
}

}  // namespace

CsvTable::CsvTable(const std::string& path) : path_(path), stream_(path, std::ios::binary) {
  if (!stream_ || stream_.peek() == std::ifstream::traits_type::eof())
    throw DataError("cannot read " + path + ": there is no such file, or it is empty");
  if (!read_line(header_)) throw DataError(path + ": holds no header line");
  std::set<std::string> seen;
  for (const std::string& name : header_)
    if (!name.empty() && !seen.insert(name).second)
      throw DataError(path + ":" + std::to_string(line_) + ": column " + name +
                      " appears twice in the header");
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
    cells = split_cells(line);
    return true;
  }
  if (stream_.bad())
    throw DataError(path_ + ":" + std::to_string(line_) + ": the file cannot be read further");
  return false;
}

bool CsvTable::next() { return read_line(cells_); }

void CsvTable::check_width() const {
  if (cells_.size() == header_.size()) return;
  const std::size_t first = std::min(cells_.size(), header_.size());
  const std::string where =
      first < header_.size() ? " (" + header_[first] + ") is missing" : " is one too many";
  throw RowError(path_ + ":" + std::to_string(line_) + ": column " + std::to_string(first + 1) + where +
                 ": the row has " + std::to_string(cells_.size()) + " cells, the header " +
                 std::to_string(header_.size()));
}

double CsvTable::number(std::size_t column) const {
  const std::string& cell = cells_.at(column);
  if (cell.empty()) fail(column, "a number (the cell is empty)");
  const char* first = cell.data() + (cell[0] == '+' ? 1 : 0);
  const char* last = cell.data() + cell.size();
  double value = 0.0;
  const auto [end, error] = std::from_chars(first, last, value);
  if (error != std::errc() || end != last) fail(column, "a number");
  if (!std::isfinite(value)) fail(column, "a finite number");
  return value;
}

void CsvTable::fail(std::size_t column, const std::string& expectation) const {
  throw RowError(path_ + ":" + std::to_string(line_) + ": column " + std::to_string(column + 1) + " (" +
                 header_.at(column) + "): \"" + cells_.at(column) + "\" must be " + expectation);
}

}  // namespace lodestone::common
