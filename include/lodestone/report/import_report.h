#pragma once

#include <string>

#include "lodestone/data/mapped_import.h"

namespace lodestone::report {

/// The page that shows how a foreign log was understood: columns, units, first rows, trajectories, how the
/// currents were cut into pulses, and what was left out and why. `source` is the log's path, `out` the page
/// to write. Throws IoError.
void write_import_report(const data::MappedImport& imported, const std::string& source,
                         const std::string& out);

}  // namespace lodestone::report
