#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/common/csv_table.h"
#include "lodestone/data/column_map.h"
#include "lodestone/data/csv_import.h"
#include "lodestone/data/pulse_cutting.h"

namespace lodestone::data {

/// A foreign log as it was understood: its rows in SI units in the dish frame.
struct MappedLog {
  common::CsvFormat format;
  std::vector<MappedColumn> columns;
  std::vector<std::string> ignored;                  ///< headers of columns that mean nothing here
  std::vector<std::vector<std::string>> first_rows;  ///< [a few, columns] as they stand in the file
  bool heading = false;
  std::string action_unit = "A";  ///< or "percent"
  double action_scale = 0.0;      ///< the largest current, or 100
  std::vector<LogSample> samples;
  double most_turned_rad = 0.0;  ///< largest heading as it stands in the file, without regard to full turns
  std::int64_t reversed = 0;     ///< rows with a current below zero that drives the opposite coil
  std::int64_t netted = 0;       ///< rows with opposite coils on together, of which the difference counts

  /// The mapped columns of a quantity.
  std::vector<MappedColumn> of(Quantity quantity) const;
};

/// Reads the rows. `result` counts them and those that were skipped. Per cent become ampere where the rig
/// says what 100 % are (`full_drive_A`, 0 where it does not). Throws ConfigError where `map` cannot be used,
/// and DataError naming file, line and column: a column that is not there, a cell that is no number, a time
/// that does not go on, a current that cannot be.
MappedLog read_mapped_log(const std::string& path, const CsvImportConfig& config, const MapConfig& map,
                          CsvImportResult& result);

}  // namespace lodestone::data
