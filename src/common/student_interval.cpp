#include "lodestone/common/student_interval.h"

#include <cmath>
#include <iterator>

namespace lodestone::common {

std::optional<Interval> student_interval(const std::vector<double>& values) {
  if (values.size() < 2) return std::nullopt;
  // Its 97.5 % quantile by degrees of freedom; beyond, the first terms of its expansion (Cornish and Fisher).
  constexpr double kQuantiles[] = {12.706205, 4.302653, 3.182446, 2.776445, 2.570582,
                                   2.446912,  2.364624, 2.306004, 2.262157, 2.228139};
  const std::size_t freedom = values.size() - 1;
  const double z = normal_quantile(0.975), n = static_cast<double>(freedom);
  const double quantile = freedom <= std::size(kQuantiles)
                              ? kQuantiles[freedom - 1]
                              : z + (z * z * z + z) / (4.0 * n) +
                                    (5.0 * std::pow(z, 5) + 16.0 * z * z * z + 3.0 * z) / (96.0 * n * n);
  const double half = quantile * standard_deviation(values) / std::sqrt(static_cast<double>(values.size()));
  return Interval{mean(values) - half, mean(values) + half};
}

}  // namespace lodestone::common
