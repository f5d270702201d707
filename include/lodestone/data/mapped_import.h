#pragma once

#include <string>

#include "lodestone/data/csv_import.h"
#include "lodestone/data/mapped_log.h"
#include "lodestone/data/plausibility.h"
#include "lodestone/data/pulse_cutting.h"

namespace lodestone::data {

/// A log of any layout as a dataset, and how it was understood.
struct MappedImport {
  CsvImportResult result;
  MappedLog log;
  CutLog cut;
  DirectionMatch directions;
};

/// Reads a log through `map` (its columns must be set) and cuts it into pulses. Throws as read_mapped_log(),
/// cut_pulses() and, with `plausible`, check_sizes() and check_directions(); and DataError where no pulse
/// is left.
MappedImport import_mapped(const std::string& path, const CsvImportConfig& config, const MapConfig& map);

}  // namespace lodestone::data
