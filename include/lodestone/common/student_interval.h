#pragma once

#include <optional>
#include <vector>

#include "lodestone/common/statistics.h"

namespace lodestone::common {

/// 95 % interval of the mean of what these are independent draws of, by Student's t: for few, which a
/// bootstrap draws too narrow. Absent of fewer than two.
std::optional<Interval> student_interval(const std::vector<double>& values);

}  // namespace lodestone::common
