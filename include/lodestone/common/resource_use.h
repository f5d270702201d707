#pragma once

namespace lodestone::common {

/// Most memory this program has held at a time so far (resident set), in MB of 10^6 bytes.
double peak_memory_mb();

/// Processor time that all threads of this program have used so far, in s. Unlike the time on the clock it
/// hardly grows where other programs want the processors, too.
double processor_seconds();

}  // namespace lodestone::common
