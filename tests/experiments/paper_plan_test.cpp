#include "lodestone/experiments/paper_plan.h"

#include <algorithm>
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

TEST_CASE("trials over the whole dish lie where the paper's TD3 trains") {
  const runs::Plan plan = experiments::paper_plan({});
  for (const char* row : {"baseline", "paper", "paper_simulator"}) {
    const std::string id = std::string("transfer/") + row;
    const runs::Cell* whole = plan.find(id + "/whole_dish/point/1");
    const runs::Cell* bare = plan.find(id + "/bare/point/1");
    REQUIRE(whole != nullptr);
    REQUIRE(bare != nullptr);
    CHECK(whole->seed == bare->seed);
    const auto& settings = whole->settings;
    for (const char* radius : {"trials.start_radius=0.96", "trials.goal_radius=1"})
      CHECK(std::count(settings.begin(), settings.end(), radius) == 1);
  }
}

TEST_CASE("the pace of every training of Table I is measured, of its own length but for the end") {
  experiments::PaperScale scale;
  scale.seeds = scale.ablation_seeds = 1;
  const runs::Plan whole = experiments::paper_plan(scale);
  const runs::Plan paces = experiments::paper_pace_plan(scale);
  paces.validate();
  std::size_t count = 0;
  for (const runs::Cell& cell : whole.cells) {
    if (cell.id.rfind("policy/", 0) != 0) continue;
    const std::string id = "pace" + cell.id.substr(cell.id.find('/'), cell.id.rfind('/') - cell.id.find('/'));
    CAPTURE(id);
    const runs::Cell* pace = paces.find(id);
    REQUIRE(pace != nullptr);
    ++count;
    CHECK(pace->config == cell.config);
    REQUIRE(pace->settings.size() == cell.settings.size());
    for (std::size_t i = 0; i < cell.settings.size(); ++i) {
      const std::string key = cell.settings[i].substr(0, cell.settings[i].find('='));
      const bool shorter = key == "training.env_steps";
      if (key != "dynamics") CHECK((pace->settings[i] == cell.settings[i]) != shorter);
      CHECK(pace->settings[i].rfind(key + "=", 0) == 0);
    }
  }
  CHECK(count == 11);
  CHECK(paces.find("pace/offline/centre") != nullptr);  // of Table II alone
}
