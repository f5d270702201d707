#include "mean_bootstrap.h"

#include <algorithm>

namespace lodestone::report {
namespace {

constexpr std::size_t kResamples = 2000;
constexpr std::size_t kMostKept = 1 << 16;  // values of all groups: half a gigabyte of indices
constexpr std::size_t kAtATime = 8;
constexpr double kTail = 0.025;
static_assert(kResamples % kAtATime == 0);

}  // namespace

const std::vector<std::uint32_t>& MeanBootstrap::draws_of(Shape shape) {
  std::vector<std::uint32_t>& draws = draws_[shape];
  if (!draws.empty()) return draws;
  const auto [groups, values] = shape;
  common::RandomStream random(1, name_);
  draws.reserve(kResamples * groups * values);
  for (std::size_t i = 0; i < kResamples; ++i)
    for (std::size_t k = 0; k < groups; ++k) {
      const std::size_t group = random.below(groups);
      for (std::size_t j = 0; j < values; ++j)
        draws.push_back(static_cast<std::uint32_t>(group * values + random.below(values)));
    }
  return draws;
}

common::Interval MeanBootstrap::interval(const std::vector<std::vector<double>>& groups) {
  std::vector<double> values;
  std::size_t filled = 0, size = 0;
  bool alike = true;
  for (const std::vector<double>& group : groups) {
    if (group.empty()) continue;
    alike = alike && (filled == 0 || group.size() == size);
    size = group.size();
    ++filled;
    values.insert(values.end(), group.begin(), group.end());
  }
  if (values.empty()) return {};
  if (!alike || values.size() > kMostKept)
    return common::nested_bootstrap_interval(groups, common::mean, common::RandomStream(1, name_));
  const std::vector<std::uint32_t>& draws = draws_of({filled, size});
  std::vector<double> means;
  for (std::size_t i = 0; i < kResamples;
       i += kAtATime) {  // each sum in its order, and none waits for another
    const std::uint32_t* drawn = draws.data() + i * values.size();
    double sums[kAtATime] = {};
    for (std::size_t k = 0; k < values.size(); ++k)
      for (std::size_t r = 0; r < kAtATime; ++r) sums[r] += values[drawn[r * values.size() + k]];
    for (const double sum : sums) means.push_back(sum / static_cast<double>(values.size()));
  }
  return {common::percentile(means, kTail), common::percentile(means, 1.0 - kTail)};
}

}  // namespace lodestone::report
