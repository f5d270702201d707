#pragma once

namespace lodestone::report {

extern const char kChartJs[];  ///< Chart.js, from Debian, under its own licence

}  // namespace lodestone::report
