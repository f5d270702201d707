#pragma once

#include "verb.h"

namespace lodestone::apps {

/// Registers `lodestone bench paper`: the experiments of section V, as cells that can be run apart, resumed
/// and spread over machines, and the report that sets them beside the paper's tables and figures.
void add_bench_paper(CLI::App& bench, ConfigCatalogue& catalogue);

}  // namespace lodestone::apps
