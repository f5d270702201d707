#include "lodestone/common/statistics.h"

#include <algorithm>
#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::common {

double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1))];
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

}  // namespace lodestone::common
