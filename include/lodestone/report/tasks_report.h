#pragma once

#include <string>

namespace lodestone::report {

/// Reads what `lodestone bench tasks` left in `folder` and writes the page `out`: the table, and the errors
/// along a square against its speed. Returns the table as text for a terminal. Throws DataError and IoError.
std::string write_tasks_report(const std::string& folder, const std::string& out);

}  // namespace lodestone::report
