#pragma once

#include <string>

namespace lodestone::report {

/// Reads what `lodestone qualify` left in `folder` and writes the page `out`: a verdict per item, what to
/// mend first, where it was broken off, where looks give no pose, coils, what weak pulses do, and the error
/// to expect. Returns verdicts as text for a terminal, which ends with that error. Throws DataError and
/// IoError.
std::string write_qualification_report(const std::string& folder, const std::string& out);

}  // namespace lodestone::report
