#pragma once

#include <string>

namespace lodestone::report {

/// Reads what `lodestone bench rigs` left in `folder` and writes the page `out`: the table, and every
/// controller's error on each rig against what was hidden in it. Returns the table as text for a terminal.
/// Throws DataError and IoError.
std::string write_rigs_report(const std::string& folder, const std::string& out);

}  // namespace lodestone::report
