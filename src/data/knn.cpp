#include "lodestone/data/knn.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/geometry/drive.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::data {
namespace {

constexpr std::size_t kPlace = 4;  // features of a state at most
constexpr std::size_t kMaxFeatures = kPlace + geometry::kMostDrives;
constexpr std::size_t kLeafRows = 16;

using Features = std::array<double, kMaxFeatures>;
using Candidate = std::pair<double, std::int64_t>;  // squared distance, row

std::size_t features_of_state(int state_size) { return state_size == 3 ? kPlace : 2; }

Features raw_features(int state_size, int action_size, const double* state, const double* action) {
  Features features{};
  features[0] = state[0];
  features[1] = state[1];
  if (state_size == 3) {
    features[2] = std::cos(state[2]);
    features[3] = std::sin(state[2]);
  }
  std::copy(action, action + action_size, features.begin() + features_of_state(state_size));
  return features;
}

}  // namespace

struct NearestNeighbours::Index {
  struct Node {
    std::size_t begin;
    std::size_t end;
    int axis = -1;  // -1: a leaf
    double cut = 0.0;
    std::size_t right = 0;  // the left child follows its parent
  };

  int state_size = 0;
  int action_size = 0;
  std::size_t k = 0;
  std::size_t features = 0;
  Features scale{};
  std::vector<Features> points;    // in the order of `rows`
  std::vector<std::int64_t> rows;  // row of the table
  std::vector<double> changes;     // [N, S] by row of the table
  std::vector<Node> nodes;

  const double* change(std::int64_t row) const {
    return &changes[static_cast<std::size_t>(row) * static_cast<std::size_t>(state_size)];
  }

  Features query(const double* state, const double* action) const {
    Features f = raw_features(state_size, action_size, state, action);
    for (std::size_t i = 0; i < features; ++i) f[i] *= scale[i];
    return f;
  }

  void build(std::size_t begin, std::size_t end, std::vector<std::size_t>& order,
             const std::vector<Features>& all) {
    const std::size_t node = nodes.size();
    nodes.push_back({begin, end});
    if (end - begin <= kLeafRows) return;
    int axis = 0;
    double widest = -1.0;
    for (std::size_t i = 0; i < features; ++i) {
      double low = all[order[begin]][i];
      double high = low;
      for (std::size_t r = begin; r < end; ++r) {
        low = std::min(low, all[order[r]][i]);
        high = std::max(high, all[order[r]][i]);
      }
      if (high - low > widest) {
        widest = high - low;
        axis = static_cast<int>(i);
      }
    }
    if (widest <= 0.0) return;
    const auto a = static_cast<std::size_t>(axis);
    const std::size_t middle = (begin + end) / 2;
    const auto at = [&order](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::size_t l, std::size_t r) {
      return std::make_pair(all[l][a], l) < std::make_pair(all[r][a], r);
    });
    nodes[node].axis = axis;
    nodes[node].cut = all[order[middle]][a];
    build(begin, middle, order, all);
    nodes[node].right = nodes.size();
    build(middle, end, order, all);
  }

  void search(std::size_t node, const Features& q, std::vector<Candidate>& heap) const {
    const Node& n = nodes[node];
    if (n.axis < 0) {
      for (std::size_t r = n.begin; r < n.end; ++r) {
        double square = 0.0;
        for (std::size_t i = 0; i < features; ++i) square += (q[i] - points[r][i]) * (q[i] - points[r][i]);
        const Candidate candidate{square, rows[r]};
        if (heap.size() == k && !(candidate < heap.front())) continue;
        if (heap.size() == k) {
          std::pop_heap(heap.begin(), heap.end());
          heap.pop_back();
        }
        heap.push_back(candidate);
        std::push_heap(heap.begin(), heap.end());
      }
      return;
    }
    const double offset = q[static_cast<std::size_t>(n.axis)] - n.cut;
    const std::size_t near = offset < 0.0 ? node + 1 : n.right;
    const std::size_t far = offset < 0.0 ? n.right : node + 1;
    search(near, q, heap);
    if (heap.size() < k || offset * offset <= heap.front().first) search(far, q, heap);
  }
};

NearestNeighbours::NearestNeighbours(const TransitionTable& table, std::int64_t k)
    : index_(std::make_unique<Index>()) {
  if (table.size() == 0) throw common::DataError("nearest neighbours need at least one transition");
  if (k < 1) throw common::DataError("nearest neighbours: k is " + std::to_string(k) + ", must be 1 or more");
  Index& index = *index_;
  const auto n = static_cast<std::size_t>(table.size());
  const auto s = static_cast<std::size_t>(table.state_size);
  const auto a = static_cast<std::size_t>(table.action_size);
  index.state_size = table.state_size;
  index.action_size = table.action_size;
  index.k = std::min(static_cast<std::size_t>(k), n);
  index.features = features_of_state(table.state_size) + a;

  std::vector<Features> all(n);
  for (std::size_t r = 0; r < n; ++r)
    all[r] = raw_features(table.state_size, table.action_size, &table.state[r * s], &table.action[r * a]);
  for (std::size_t i = 0; i < index.features; ++i) {
    double sum = 0.0;
    double squares = 0.0;
    for (const Features& f : all) sum += f[i];
    const double mean = sum / static_cast<double>(n);
    for (const Features& f : all) squares += (f[i] - mean) * (f[i] - mean);
    const double deviation = std::sqrt(squares / static_cast<double>(n));
    index.scale[i] = deviation > 0.0 ? 1.0 / deviation : 1.0;
  }
  for (Features& f : all)
    for (std::size_t i = 0; i < index.features; ++i) f[i] *= index.scale[i];

  index.changes.resize(n * s);
  for (std::size_t i = 0; i < n * s; ++i) {
    const double change = table.next_state[i] - table.state[i];
    index.changes[i] = i % s == 2 ? geometry::wrap_angle(change) : change;
  }
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  index.build(0, n, order, all);
  for (const std::size_t r : order) {
    index.points.push_back(all[r]);
    index.rows.push_back(static_cast<std::int64_t>(r));
  }
}

NearestNeighbours::~NearestNeighbours() = default;
NearestNeighbours::NearestNeighbours(NearestNeighbours&&) noexcept = default;
NearestNeighbours& NearestNeighbours::operator=(NearestNeighbours&&) noexcept = default;

std::vector<std::int64_t> NearestNeighbours::nearest(const double* state, const double* action) const {
  std::vector<Candidate> heap;
  heap.reserve(index_->k + 1);
  index_->search(0, index_->query(state, action), heap);
  std::sort(heap.begin(), heap.end());
  std::vector<std::int64_t> rows;
  for (const Candidate& candidate : heap) rows.push_back(candidate.second);
  return rows;
}

template <class ChangeOf>
std::vector<double> NearestNeighbours::next(const std::vector<double>& state,
                                            const std::vector<double>& action,
                                            const ChangeOf& change_of) const {
  const auto s = static_cast<std::size_t>(index_->state_size);
  const auto a = static_cast<std::size_t>(index_->action_size);
  if (state.size() % s != 0 || action.size() % a != 0 || state.size() / s != action.size() / a)
    throw common::DataError("nearest neighbours: " + std::to_string(state.size()) + " state numbers and " +
                            std::to_string(action.size()) + " action numbers do not form rows of " +
                            std::to_string(s) + " and " + std::to_string(a));
  std::vector<double> next = state;
  for (std::size_t r = 0; r < state.size() / s; ++r) {
    const std::vector<std::int64_t> rows = nearest(&state[r * s], &action[r * a]);
    const std::array<double, 3> change = change_of(rows);
    for (std::size_t i = 0; i < s; ++i) next[r * s + i] += change[i];
    if (s == 3) next[r * s + 2] = geometry::wrap_angle(next[r * s + 2]);
  }
  return next;
}

std::vector<double> NearestNeighbours::predict(const std::vector<double>& state,
                                               const std::vector<double>& action) const {
  return next(state, action, [this](const std::vector<std::int64_t>& rows) {
    std::array<double, 3> mean{};
    for (std::size_t i = 0; i < static_cast<std::size_t>(index_->state_size); ++i) {
      double sum = 0.0;
      for (const std::int64_t row : rows) sum += index_->change(row)[i];
      mean[i] = sum / static_cast<double>(rows.size());
    }
    return mean;
  });
}

std::vector<double> NearestNeighbours::sample(const std::vector<double>& state,
                                              const std::vector<double>& action,
                                              common::RandomStream& random) const {
  return next(state, action, [&](const std::vector<std::int64_t>& rows) {
    const double* change = index_->change(rows[random.below(rows.size())]);
    std::array<double, 3> one{};
    std::copy_n(change, index_->state_size, one.begin());
    return one;
  });
}

}  // namespace lodestone::data
