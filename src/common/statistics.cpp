#include "lodestone/common/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lodestone/common/error.h"

namespace lodestone::common {
namespace {

/// Differences other than zero by size, each with twice its rank: equal sizes share the mean of theirs.
struct SignedRanks {
  std::vector<std::int64_t> twice;
  std::int64_t twice_above = 0, twice_below = 0;  ///< sums over the differences above and below zero
  double ties = 0.0;                              ///< sum of t^3 - t over the groups of equal ones
};

SignedRanks signed_ranks(std::vector<double> differences) {
  differences.erase(std::remove(differences.begin(), differences.end(), 0.0), differences.end());
  std::sort(differences.begin(), differences.end(),
            [](double a, double b) { return std::abs(a) < std::abs(b); });
  SignedRanks ranks;
  for (std::size_t first = 0, last = 0; first < differences.size(); first = last) {
    while (last < differences.size() && std::abs(differences[last]) == std::abs(differences[first])) ++last;
    const auto twice = static_cast<std::int64_t>(first + 1 + last);
    for (std::size_t i = first; i < last; ++i) {
      ranks.twice.push_back(twice);
      (differences[i] > 0.0 ? ranks.twice_above : ranks.twice_below) += twice;
    }
    const auto tied = static_cast<double>(last - first);
    ranks.ties += tied * tied * tied - tied;
  }
  return ranks;
}

/// Probability that a sum of ranks is at most `twice_sum` / 2 where every sign is as likely as its opposite.
double exact_tail(const std::vector<std::int64_t>& twice_ranks, std::int64_t twice_sum) {
  const std::int64_t total = std::accumulate(twice_ranks.begin(), twice_ranks.end(), std::int64_t{0});
  std::vector<double> chance(static_cast<std::size_t>(total) + 1, 0.0);
  chance[0] = 1.0;
  std::int64_t reach = 0;
  for (const std::int64_t rank : twice_ranks) {
    reach += rank;
    for (std::int64_t sum = reach; sum >= 0; --sum) {
      double& here = chance[static_cast<std::size_t>(sum)];
      here = 0.5 * (here + (sum >= rank ? chance[static_cast<std::size_t>(sum - rank)] : 0.0));
    }
  }
  return std::accumulate(chance.begin(), chance.begin() + twice_sum + 1, 0.0);
}

}  // namespace

double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0.0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double root_mean_square(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return values.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(values.size()));
}

double standard_deviation(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const double middle = mean(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - middle) * (value - middle);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

double interquartile_mean(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto count = static_cast<double>(values.size());
  const double low = 0.25 * count;
  const double high = 0.75 * count;
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto from = static_cast<double>(i);
    sum += values[i] * std::max(0.0, std::min(from + 1.0, high) - std::max(from, low));
  }
  return sum / (high - low);
}

double normal_quantile(double probability) {
  LODESTONE_CHECK(probability > 0.0 && probability < 1.0, "a probability within (0, 1)");
  double low = -40.0, high = 40.0;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (0.5 * std::erfc(-middle / std::sqrt(2.0)) < probability ? low : high) = middle;
  }
}

Interval percentile_interval(std::vector<double> values, double fraction, double z) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto count = static_cast<double>(values.size());
  const double half = z * std::sqrt(count * fraction * (1.0 - fraction));
  const auto at = [&](double rank) {
    return values[static_cast<std::size_t>(std::clamp(rank, 1.0, count)) - 1];
  };
  return {at(std::floor(count * fraction - half)), at(std::ceil(count * fraction + half) + 1.0)};
}

Interval wilson_interval(std::int64_t successes, std::int64_t trials, double z) {
  LODESTONE_CHECK(trials > 0 && successes >= 0 && successes <= trials, "a fraction of trials");
  const auto n = static_cast<double>(trials);
  const double fraction = static_cast<double>(successes) / n;
  const double scale = 1.0 + z * z / n;
  const double centre = (fraction + z * z / (2.0 * n)) / scale;
  const double half = z / scale * std::sqrt(fraction * (1.0 - fraction) / n + z * z / (4.0 * n * n));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

Interval bootstrap_interval(const std::vector<std::vector<double>>& strata,
                            const std::function<double(const std::vector<double>&)>& statistic,
                            RandomStream random, std::int64_t resamples, double level) {
  std::vector<double> statistics;
  std::vector<double> drawn;
  for (std::int64_t i = 0; i < resamples; ++i) {
    drawn.clear();
    for (const std::vector<double>& stratum : strata) {
      for (std::size_t k = 0; k < stratum.size(); ++k) drawn.push_back(stratum[random.below(stratum.size())]);
    }
    if (drawn.empty()) return {};
    statistics.push_back(statistic(drawn));
  }
  return {percentile(statistics, 0.5 * (1.0 - level)), percentile(statistics, 1.0 - 0.5 * (1.0 - level))};
}

Interval difference_interval(const std::vector<double>& sample, const std::vector<double>& other,
                             RandomStream random, std::int64_t resamples, double level) {
  if (sample.empty() || other.empty()) return {};
  const auto drawn_mean = [&](const std::vector<double>& values) {
    double sum = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) sum += values[random.below(values.size())];
    return sum / static_cast<double>(values.size());
  };
  std::vector<double> differences;
  for (std::int64_t i = 0; i < resamples; ++i) {
    const double first = drawn_mean(sample);
    differences.push_back(first - drawn_mean(other));
  }
  return {percentile(differences, 0.5 * (1.0 - level)), percentile(differences, 1.0 - 0.5 * (1.0 - level))};
}

Interval nested_bootstrap_interval(const std::vector<std::vector<double>>& groups,
                                   const std::function<double(const std::vector<double>&)>& statistic,
                                   RandomStream random, std::int64_t resamples, double level) {
  std::vector<const std::vector<double>*> filled;
  for (const std::vector<double>& group : groups)
    if (!group.empty()) filled.push_back(&group);
  if (filled.empty()) return {};
  std::vector<double> statistics;
  std::vector<double> drawn;
  for (std::int64_t i = 0; i < resamples; ++i) {
    drawn.clear();
    for (std::size_t k = 0; k < filled.size(); ++k) {
      const std::vector<double>& group = *filled[random.below(filled.size())];
      for (std::size_t j = 0; j < group.size(); ++j) drawn.push_back(group[random.below(group.size())]);
    }
    statistics.push_back(statistic(drawn));
  }
  return {percentile(statistics, 0.5 * (1.0 - level)), percentile(statistics, 1.0 - 0.5 * (1.0 - level))};
}

double signed_rank_p(const std::vector<double>& differences) {
  constexpr std::size_t kMostExact = 200;
  const SignedRanks ranks = signed_ranks(differences);
  if (ranks.twice.empty()) return 1.0;
  const std::int64_t twice_less = std::min(ranks.twice_above, ranks.twice_below);
  if (ranks.twice.size() <= kMostExact) return std::min(1.0, 2.0 * exact_tail(ranks.twice, twice_less));
  const auto n = static_cast<double>(ranks.twice.size());
  const double deviation = std::sqrt(n * (n + 1.0) * (2.0 * n + 1.0) / 24.0 - ranks.ties / 48.0);
  const double z = (0.25 * n * (n + 1.0) - 0.5 * static_cast<double>(twice_less) - 0.5) / deviation;
  return std::min(1.0, std::erfc(z / std::sqrt(2.0)));
}

}  // namespace lodestone::common
