#include "lodestone/common/student_interval.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace lodestone;

TEST_CASE("Student's interval is that of the tables, and none of one value") {
  CHECK_FALSE(common::student_interval({1.0}));
  const auto two = common::student_interval({0.0, 2.0});  // deviation sqrt(2): half of 12.706 * 1
  REQUIRE(two);
  CHECK(two->low == Approx(1.0 - 12.706205));
  CHECK(two->high == Approx(1.0 + 12.706205));
  std::vector<double> values;
  for (int i = 0; i < 31; ++i) values.push_back(i % 2 == 0 ? 1.0 : -1.0);
  const double half =
      2.042272 * common::standard_deviation(values) / std::sqrt(31.0);  // 30 degrees of freedom
  const auto many = common::student_interval(values);
  CHECK(many->high - many->low == Approx(2.0 * half).epsilon(1e-4));
  for (std::size_t n = 9; n < 13; ++n) {  // from the table into the expansion
    const std::vector<double> fewer(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n));
    const auto its = common::student_interval(fewer);
    const double quantile = (its->high - common::mean(fewer)) * std::sqrt(static_cast<double>(n)) /
                            common::standard_deviation(fewer);
    constexpr double kTable[] = {2.306004, 2.262157, 2.228139, 2.200985};
    CHECK(quantile == Approx(kTable[n - 9]).epsilon(1e-3));
  }
}
