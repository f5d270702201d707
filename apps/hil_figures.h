#pragma once

#include <string>

#include "verb.h"

namespace lodestone::apps {

/// `lodestone bench hil`: the whole chain on an emulated bench, faults, timing, and errors beside those of
/// the simulated coils. Throws HardwareError after writing everything when a bound is broken.
void add_bench_hil(CLI::App& bench, ConfigCatalogue& catalogue);

}  // namespace lodestone::apps
