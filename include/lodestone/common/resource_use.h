#pragma once

#include <map>
#include <optional>
#include <string>

namespace lodestone::common {

/// Most memory this program has held at a time so far (resident set), in MB of 10^6 bytes.
double peak_memory_mb();

/// Processor time that all threads of this program have used so far, in s. Unlike the time on the clock it
/// hardly grows where other programs want the processors, too.
double processor_seconds();

/// Processor time, in s, that others have used of this machine since it started: its other programs, and
/// those beside it on the same processors where it is a virtual one. Counted in hundredths of a second;
/// absent where the system does not count it.
std::optional<double> other_processor_seconds();

/// The same as processor_seconds() of each thread that is there now, by its name (common/thread_name.h);
/// those of one name together.
std::map<std::string, double> processor_seconds_by_thread();

}  // namespace lodestone::common
