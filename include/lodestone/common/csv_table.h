#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "lodestone/common/error.h"

namespace lodestone::common {

/// A fault of one row; the message starts with file:line.
class RowError : public DataError {
 public:
  using DataError::DataError;
};

/// How a file separates its cells and writes its numbers.
struct CsvFormat {
  char separator = ',';  ///< ' ' stands for every run of blanks and tabs
  char decimal = '.';    ///< or ','
  /// Line of the header, the first line that is not blank from there on; 0: there is none, and the columns
  /// are called 1, 2, ...
  std::int64_t header_line = 1;
};

/// Reads a CSV file with a header row by row. Accepts a byte order mark, CRLF, quoted cells and blank lines.
class CsvTable {
 public:
  /// Throws IoError when it is no file, DataError when it cannot be read, is empty or names a column twice.
  explicit CsvTable(const std::string& path, const CsvFormat& format = {});

  const std::vector<std::string>& header() const { return header_; }
  bool has_columns(const std::vector<std::string>& names) const;
  /// Index of a column that is there.
  std::size_t column(const std::string& name) const;

  /// Goes to the next row that is not blank; false at the end.
  bool next();
  /// Throws RowError when the row has fewer or more cells than the header, or leaves a quote open.
  void check_width() const;
  std::int64_t line() const { return line_; }
  std::size_t cells() const { return cells_.size(); }
  const std::string& text(std::size_t column) const { return cells_.at(column); }
  /// Cell as a finite number. Throws RowError naming line and column.
  double number(std::size_t column) const;
  /// Throws RowError about a cell: `expectation` says what it should be.
  [[noreturn]] void fail(std::size_t column, const std::string& expectation) const;

 private:
  bool read_line(std::vector<std::string>& cells);
  void read_header();

  std::string path_;
  CsvFormat format_;
  std::ifstream stream_;
  std::int64_t line_ = 0;
  bool open_quote_ = false;  ///< of the last line read
  bool pending_ = false;     ///< the first row is read already, there is no header
  std::vector<std::string> header_;
  std::vector<std::string> cells_;
};

}  // namespace lodestone::common
