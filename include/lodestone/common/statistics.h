#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lodestone/common/random.h"

namespace lodestone::common {

/// The value below which this fraction of the values lies, without interpolation; 0 when there are none.
double percentile(std::vector<double> values, double fraction);
/// The middle value, or the mean of the two in the middle; 0 when there are none.
double median(std::vector<double> values);

double mean(const std::vector<double>& values);
double root_mean_square(const std::vector<double>& values);
/// Of a sample (n - 1); 0 for fewer than two.
double standard_deviation(const std::vector<double>& values);

/// Mean of the middle half, each value at either edge counted by the part of it that lies inside: robust as a
/// median, efficient as a mean (Agarwal et al., Deep reinforcement learning at the edge of the statistical
/// precipice, 2021).
double interquartile_mean(std::vector<double> values);

/// The value below which a standard normal number lies with this probability, which is within (0, 1).
double normal_quantile(double probability);

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// Distribution-free interval of a percentile: between the values whose ranks a binomial count of the values
/// below it would have, so it reaches the largest one where there are too few for more. `z` = 1.96 covers 95
/// %. {0, 0} when there are none.
Interval percentile_interval(std::vector<double> values, double fraction, double z = 1.96);

/// Wilson's score interval of a fraction: sensible for 50 of 50, too. `z` = 1.96 covers 95 %. Throws
/// LogicFault unless 0 <= successes <= trials and trials > 0.
Interval wilson_interval(std::int64_t successes, std::int64_t trials, double z = 1.96);

/// Percentile bootstrap of a statistic of all values together, drawn anew with replacement inside every
/// stratum (a training seed, or a task), so that each keeps its weight. Strata without values are left out.
Interval bootstrap_interval(const std::vector<std::vector<double>>& strata,
                            const std::function<double(const std::vector<double>&)>& statistic,
                            RandomStream random, std::int64_t resamples = 2000, double level = 0.95);

/// Percentile bootstrap of the difference of two samples' means, each drawn anew with replacement. {0, 0}
/// when one of them is empty.
Interval difference_interval(const std::vector<double>& sample, const std::vector<double>& other,
                             RandomStream random, std::int64_t resamples = 2000, double level = 0.95);

/// bootstrap_interval() where the groups (training seeds) are themselves a draw: groups are drawn with
/// replacement, then values inside each. One group is as there. Groups without values are left out.
Interval nested_bootstrap_interval(const std::vector<std::vector<double>>& groups,
                                   const std::function<double(const std::vector<double>&)>& statistic,
                                   RandomStream random, std::int64_t resamples = 2000, double level = 0.95);

/// Two-sided p of Wilcoxon's signed-rank test that paired differences lie as often and as far above zero as
/// below: zeros are dropped, equal sizes share their rank. Exact for up to 200 differences (every choice of
/// signs counted, so of differences of 1 and -1 it is the exact sign test), normal with the correction for
/// ties and continuity beyond. 1 when no difference is other than zero.
double signed_rank_p(const std::vector<double>& differences);

}  // namespace lodestone::common
