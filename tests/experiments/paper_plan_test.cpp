#include "lodestone/experiments/paper_plan.h"

#include <catch2/catch.hpp>
#include <map>
#include <set>

using namespace lodestone;

TEST_CASE("the paper's plan is one, and its size follows the scale") {
  experiments::PaperScale scale;
  scale.seeds = scale.ablation_seeds = 1;
  const runs::Plan one = experiments::paper_plan(scale);
  one.validate();
  scale.seeds = 3;
  const runs::Plan three = experiments::paper_plan(scale);
  CHECK(three.cells.size() > one.cells.size());
  scale.data_sizes.clear();
  CHECK(experiments::paper_plan(scale).cells.size() < three.cells.size());
}

TEST_CASE("every row of a table meets the same trials, and no two trainings share a seed") {
  experiments::PaperScale scale;
  scale.seeds = scale.ablation_seeds = 2;
  std::map<std::string, std::set<std::int64_t>> evaluation;  // task and training seed: seeds of its cells
  std::set<std::int64_t> training;
  std::size_t trainings = 0;
  for (const runs::Cell& cell : experiments::paper_plan(scale).cells) {
    REQUIRE(cell.seed);
    if (cell.verb == "deploy") {
      const std::size_t task = cell.id.rfind('/', cell.id.rfind('/') - 1);
      evaluation[cell.id.substr(task)].insert(*cell.seed);
    } else {
      training.insert(*cell.seed);
      ++trainings;
    }
  }
  CHECK(evaluation.size() == 6);  // centre, point and square, two seeds of each
  for (const auto& [what, seeds] : evaluation) {
    CAPTURE(what);
    CHECK(seeds.size() == 1);
  }
  CHECK(training.size() == trainings);
}
