#include "lodestone/runs/open_cells.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/error.h"
#include "lodestone/runs/kept_results.h"
#include "runs/cells.h"
#include "temporary_folder.h"

using namespace lodestone;
using runs::Plan;
using tests::cell;
using tests::finish;
using tests::Ids;
using tests::ids;
using tests::plan;
using tests::to_run;

TEST_CASE("wanted is all, or a cell with all that it needs") {
  const Plan made =
      plan({cell("a"), cell("b", {"dynamics={a}/x"}), cell("c"), cell("d", {"data={b}/x,{a}/y"})});
  CHECK(ids(runs::wanted_cells(made)) == Ids{"a", "b", "c", "d"});
  CHECK(ids(runs::wanted_cells(made, "d")) == Ids{"a", "b", "d"});
  CHECK(ids(runs::wanted_cells(made, "c")) == Ids{"c"});
  CHECK_THROWS_AS(runs::wanted_cells(made, "e"), common::ConfigError);
  CHECK(ids(runs::wanted_cells(made, "[bc]")) == Ids{"a", "b", "c"});
  CHECK(ids(runs::wanted_cells(made, "*")) == Ids{"a", "b", "c", "d"});
  CHECK_THROWS_AS(runs::wanted_cells(made, "e*"), common::ConfigError);
}

TEST_CASE("a name with stars names cells across slashes, and a cell that is called so is that cell") {
  const Plan made = plan({cell("mix/0/1"), cell("mix/0/2"), cell("mix/offline/2"), cell("mix[2]")});
  CHECK(ids(runs::cells_named(made, "mix/*/2")) == Ids{"mix/0/2", "mix/offline/2"});
  CHECK(ids(runs::cells_named(made, "mix*2")) == Ids{"mix/0/2", "mix/offline/2"});
  CHECK(ids(runs::cells_named(made, "mix/?/[12]")) == Ids{"mix/0/1", "mix/0/2"});
  CHECK(ids(runs::cells_named(made, "mix[2]")) == Ids{"mix[2]"});
  CHECK(ids(runs::cells_named(made, "mix")).empty());
}

TEST_CASE("what is finished in its folder is not run again, and what it needs is not asked for") {
  const tests::TemporaryFolder folder;
  const Plan made = plan({cell("a"), cell("b", {"dynamics={a}/x"}), cell("c", {"dynamics={b}/x"})});
  const runs::PlanPlace place{folder.path(), "lodestone", "configs"};
  CHECK(to_run(made, place) == Ids{"a", "b", "c"});
  finish(made, place, "b");
  CHECK(ids(runs::unfinished_cells(made, place, runs::wanted_cells(made))) == Ids{"a", "c"});
  CHECK(ids(runs::cells_to_run(made, place, runs::wanted_cells(made, "c"))) == Ids{"a", "c"});
  finish(made, place, "c");
  finish(made, place, "a");
  CHECK(to_run(made, place).empty());
}

TEST_CASE("weights that are needed and were lost are made again, and their records still hold") {
  const tests::TemporaryFolder folder;
  const Plan made =
      plan({cell("a"), cell("b", {"dynamics={a}/checkpoint"}), cell("c", {"dynamics={b}/checkpoint"})});
  const runs::PlanPlace place{folder / "out", "lodestone", "configs", "", 1, folder / "kept"};
  for (const char* id : {"a", "b"}) finish(made, place, id);
  runs::KeptResults(place.results).keep(made, place);
  std::filesystem::remove_all(folder / "out");
  std::filesystem::remove_all(folder / "kept/weights");
  CHECK(ids(runs::unfinished_cells(made, place, runs::wanted_cells(made))) == Ids{"c"});
  CHECK(to_run(made, place) == Ids{"a", "b", "c"});
}
