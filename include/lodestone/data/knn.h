#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/data/dataset.h"

namespace lodestone::data {

/// k-nearest-neighbour regression of transitions: the baseline every dynamics network has to beat.
/// Features are position, sine and cosine of the heading where there is one, and the drives, each divided
/// by its standard deviation over the table. The prediction is the state plus the mean change of the
/// neighbours (heading change wrapped). A k-d tree finds them exactly; equal distances go to the lower row.
class NearestNeighbours {
 public:
  /// Uses min(k, N) neighbours. Throws DataError when the table is empty or k < 1.
  explicit NearestNeighbours(const TransitionTable& table, std::int64_t k = 10);
  ~NearestNeighbours();
  NearestNeighbours(NearestNeighbours&&) noexcept;
  NearestNeighbours& operator=(NearestNeighbours&&) noexcept;

  /// state [N, S], action [N, A] -> next state [N, S]. Throws DataError when the sizes disagree.
  std::vector<double> predict(const std::vector<double>& state, const std::vector<double>& action) const;

  /// The same with the change of one of the neighbours, each as likely, instead of their mean.
  std::vector<double> sample(const std::vector<double>& state, const std::vector<double>& action,
                             common::RandomStream& random) const;

  /// Rows of the table nearest to one query, nearest first.
  std::vector<std::int64_t> nearest(const double* state, const double* action) const;

 private:
  struct Index;
  /// States with `change_of`(rows of the neighbours) added.
  template <class ChangeOf>
  std::vector<double> next(const std::vector<double>& state, const std::vector<double>& action,
                           const ChangeOf& change_of) const;
  std::unique_ptr<Index> index_;
};

}  // namespace lodestone::data
