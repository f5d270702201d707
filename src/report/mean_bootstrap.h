#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "lodestone/common/statistics.h"

namespace lodestone::report {

/// Intervals of means by common::nested_bootstrap_interval(), each from the stream RandomStream(1, name), and
/// the same to the bit. Groups of one size are drawn alike every time, so that what was drawn serves all of
/// them: drawing is most of the work.
class MeanBootstrap {
 public:
  explicit MeanBootstrap(const char* name) : name_(name) {}

  common::Interval interval(const std::vector<std::vector<double>>& groups);

 private:
  using Shape = std::pair<std::size_t, std::size_t>;  // groups, values of each

  const std::vector<std::uint32_t>& draws_of(Shape shape);

  const char* name_;
  std::map<Shape, std::vector<std::uint32_t>> draws_;  ///< indices into the groups one after another
};

}  // namespace lodestone::report
