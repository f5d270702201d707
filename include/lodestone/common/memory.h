#pragma once

namespace lodestone::common {

/// Most memory this program has held at a time so far (resident set), in MB of 10^6 bytes.
double peak_memory_mb();

}  // namespace lodestone::common
