#pragma once

#include <string>

namespace lodestone::report {

/// Reads what `lodestone qualify` left in `folder` and writes the page `out`: a verdict per item, what to
/// mend first, where it was broken off, where looks give no pose, coils, and what weak pulses do. Returns
/// verdicts as text for a terminal. Throws DataError and IoError.
std::string write_qualification_report(const std::string& folder, const std::string& out);

}  // namespace lodestone::report
