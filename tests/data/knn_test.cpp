#include "lodestone/data/knn.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"
#include "synthetic.h"

using namespace lodestone;

namespace {

/// Rows sorted by normalised distance, the plain way.
std::vector<std::int64_t> nearest_by_force(const data::TransitionTable& table, const double* state,
                                           const double* action, std::size_t k) {
  const auto features = [](const double* s, const double* a) {
    return std::vector<double>{s[0], s[1], std::cos(s[2]), std::sin(s[2]), a[0], a[1]};
  };
  const auto n = static_cast<std::size_t>(table.size());
  std::vector<std::vector<double>> rows;
  for (std::size_t r = 0; r < n; ++r) rows.push_back(features(&table.state[r * 3], &table.action[r * 2]));
  std::vector<double> deviation(6);
  for (std::size_t i = 0; i < 6; ++i) {
    double mean = 0.0;
    for (const auto& row : rows) mean += row[i] / static_cast<double>(n);
    for (const auto& row : rows) deviation[i] += (row[i] - mean) * (row[i] - mean) / static_cast<double>(n);
    deviation[i] = std::sqrt(deviation[i]);
  }
  const std::vector<double> query = features(state, action);
  std::vector<std::pair<double, std::int64_t>> distances;
  for (std::size_t r = 0; r < n; ++r) {
    double square = 0.0;
    for (std::size_t i = 0; i < 6; ++i) square += std::pow((query[i] - rows[r][i]) / deviation[i], 2);
    distances.emplace_back(square, static_cast<std::int64_t>(r));
  }
  std::sort(distances.begin(), distances.end());
  std::vector<std::int64_t> result;
  for (std::size_t i = 0; i < k; ++i) result.push_back(distances[i].second);
  return result;
}

}  // namespace

TEST_CASE("the tree finds the neighbours that a full search finds") {
  const data::TransitionTable table = data::flatten(tests::random_dataset(60, 10));
  const data::TransitionTable queries = data::flatten(tests::random_dataset(5, 10, 2));
  const data::NearestNeighbours model(table, 10);
  for (std::int64_t q = 0; q < queries.size(); ++q) {
    const auto row = static_cast<std::size_t>(q);
    const double* state = &queries.state[row * 3];
    const double* action = &queries.action[row * 2];
    CHECK(model.nearest(state, action) == nearest_by_force(table, state, action, 10));
  }
}

TEST_CASE("equal rows are taken from the lowest on") {
  data::TransitionTable table;
  table.state_size = 2;
  for (int i = 0; i < 100; ++i) {
    table.state.insert(table.state.end(), {0.0, 0.0});
    table.action.insert(table.action.end(), {1.0, 0.0});
    table.next_state.insert(table.next_state.end(), {0.001 * (i + 1), 0.0});
    table.episode.push_back(0);
  }
  const data::NearestNeighbours model(table, 3);
  CHECK(model.nearest(table.state.data(), table.action.data()) == std::vector<std::int64_t>{0, 1, 2});
  CHECK(model.predict({0.01, 0.0}, {1.0, 0.0})[0] == Approx(0.01 + 0.002));
}

TEST_CASE("heading changes are averaged the short way round and stay wrapped") {
  data::TransitionTable table;
  table.state_size = 3;
  table.state = {0.0, 0.0, 3.1, 0.0, 0.0, 3.1};
  table.next_state = {0.0, 0.0, -3.1, 0.0, 0.0, 3.1};
  table.action = {1.0, 0.0, 1.0, 0.0};
  table.episode = {0, 0};
  const std::vector<double> next = data::NearestNeighbours(table, 10).predict({0.0, 0.0, 3.13}, {1.0, 0.0});
  const double turn = (2.0 * geometry::kPi - 6.2) / 2.0;
  CHECK(next[2] == Approx(3.13 + turn - 2.0 * geometry::kPi));
}

TEST_CASE("a draw follows one of the neighbours, each as likely") {
  data::TransitionTable table;
  table.state_size = 2;
  for (int row = 0; row < 5; ++row) {  // the last is far off
    table.state.insert(table.state.end(), {row < 4 ? 1e-6 * row : 0.03, 0.0});
    table.action.insert(table.action.end(), {1.0, 0.0});
    table.next_state.insert(table.next_state.end(), {table.state[2 * row] + 1e-3 * row, 2e-3});
    table.episode.push_back(row);
  }
  const data::NearestNeighbours model(table, 4);
  common::RandomStream random(1, "draws");
  std::map<int, int> counts;
  for (int i = 0; i < 4000; ++i) {
    const std::vector<double> next = model.sample({0.0, 0.0}, {1.0, 0.0}, random);
    CHECK(next[1] == Approx(2e-3));
    ++counts[static_cast<int>(std::lround(1e3 * next[0]))];
  }
  REQUIRE(counts.size() == 4);
  for (const auto& [change_mm, count] : counts) CHECK(count == Approx(1000).margin(120));  // 4 sigma
}

TEST_CASE("no data, no neighbours, and rows that do not fit are refused") {
  CHECK_THROWS_AS(data::NearestNeighbours(data::TransitionTable{}), common::DataError);
  const data::TransitionTable table = data::flatten(tests::random_dataset(2, 4));
  CHECK_THROWS_AS(data::NearestNeighbours(table, 0), common::DataError);
  CHECK_THROWS_AS(data::NearestNeighbours(table).predict({0.0, 0.0, 0.0}, {1.0}), common::DataError);
}
