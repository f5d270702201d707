#include "lodestone/runs/kept_results.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "data/synthetic.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/data/dataset_file.h"
#include "runs/cells.h"
#include "temporary_folder.h"

using namespace lodestone;
using runs::Plan;
using tests::cell;
using tests::finish;
using tests::Ids;
using tests::plan;
using tests::to_run;

TEST_CASE("what is kept of a plan is finished anywhere, with the weights that the rest needs and no others") {
  const tests::TemporaryFolder folder;
  const Plan made = plan({cell("a"), cell("b", {"dynamics={a}/checkpoint"}),
                          cell("c", {"dynamics={b}/checkpoint"}), cell("d", {"dynamics={a}/checkpoint"})});
  const runs::PlanPlace here{folder / "here", "lodestone", "configs", "", 1, folder / "kept"};
  runs::KeptResults kept(here.results);
  for (const char* id : {"a", "b"}) finish(made, here, id);
  kept.keep(made, here);
  CHECK(kept.finished(made, here).size() == 2);
  CHECK(common::read_file(folder / "kept/weights/a/checkpoint/weights") == "of a");
  CHECK_FALSE(std::filesystem::exists(folder / "kept/weights/a/log"));

  // On another machine, which has nothing but what was kept.
  const runs::PlanPlace there{folder / "there", "lodestone", "configs", "", 1, folder / "kept"};
  kept.restore(made, there);
  CHECK(to_run(made, there) == Ids{"c", "d"});
  CHECK(common::read_file(folder / "there/b/checkpoint/weights") == "of b");
  finish(made, there, "c");
  kept.keep(made, there);
  CHECK_FALSE(std::filesystem::exists(folder / "kept/weights/b"));  // nothing needs it any more
  CHECK(std::filesystem::exists(folder / "kept/weights/a"));
  finish(made, there, "d");
  kept.keep(made, there);
  CHECK_FALSE(std::filesystem::exists(folder / "kept/weights/a"));
  CHECK(to_run(made, there).empty());
  CHECK(runs::read_kept_plan(folder / "kept").records.size() == 4);
}

TEST_CASE("a recording is kept also when nothing needs it any more") {
  const tests::TemporaryFolder folder;
  const Plan made = plan({cell("a"), cell("b", {"data={a}/transitions.h5"})});
  const runs::PlanPlace place{folder / "out", "lodestone", "configs", "", 1, folder / "kept"};
  runs::KeptResults kept(place.results);
  finish(made, place, "a");
  data::write_dataset(folder / "out/a/transitions.h5", tests::random_dataset(2, 3));
  kept.keep(made, place);
  finish(made, place, "b");
  kept.keep(made, place);
  CHECK(data::read_dataset(folder / "kept/weights/a/transitions.h5").episodes.size() == 2);
  CHECK_FALSE(std::filesystem::exists(folder / "kept/weights/b"));

  // Also by who has not run it, and when its cell is no longer this one, until it has been run anew.
  const runs::PlanPlace there{folder / "there", "lodestone", "configs", "", 1, folder / "kept"};
  runs::KeptResults(there.results).keep(made, there);
  CHECK(std::filesystem::exists(folder / "kept/weights/a"));
  Plan other = made;
  other.cells[0].seed = 7;
  runs::KeptResults(there.results).keep(other, there);
  CHECK(runs::KeptResults(there.results).finished(other, there).empty());
  CHECK(data::read_dataset(folder / "kept/weights/a/transitions.h5").episodes.size() == 2);
  finish(other, there, "a");
  data::write_dataset(folder / "there/a/transitions.h5", tests::random_dataset(3, 3));
  runs::KeptResults(there.results).keep(other, there);
  CHECK(data::read_dataset(folder / "kept/weights/a/transitions.h5").episodes.size() == 3);
}

TEST_CASE("weights that nothing needs any more leave no folders behind") {
  const tests::TemporaryFolder folder;
  const Plan made = plan({cell("policy/a/1"), cell("b", {"policy={policy/a/1}/checkpoint"}),
                          cell("policy/c/1"), cell("d", {"policy={policy/c/1}/checkpoint"})});
  const runs::PlanPlace place{folder / "out", "lodestone", "configs", "", 1, folder / "kept"};
  runs::KeptResults kept(place.results);
  for (const char* id : {"policy/a/1", "policy/c/1"}) finish(made, place, id);
  kept.keep(made, place);
  finish(made, place, "b");
  kept.keep(made, place);
  CHECK_FALSE(std::filesystem::exists(folder / "kept/weights/policy/a"));
  CHECK(std::filesystem::exists(folder / "kept/weights/policy/c/1"));
  finish(made, place, "d");
  kept.keep(made, place);
  CHECK_FALSE(std::filesystem::exists(folder / "kept/weights/policy"));
  CHECK(std::filesystem::exists(folder / "kept/weights"));
}

TEST_CASE("results of another plan are left as they are") {
  const tests::TemporaryFolder folder;
  const Plan made = plan({cell("a"), cell("b", {"dynamics={a}/checkpoint"})});
  const runs::PlanPlace place{folder / "out", "lodestone", "configs", "", 1, folder / "kept"};
  finish(made, place, "a");
  runs::KeptResults(place.results).keep(made, place);
  const std::string before = common::read_file(folder / "kept/plan.json");
  Plan other = made;
  SECTION("by name") { other.name = "quick"; }
  SECTION("by seed") { other.seed = made.seed + 1; }
  CHECK_THROWS_WITH(runs::KeptResults(place.results).keep(other, place),
                    Catch::Contains("keeps results of the plan") && Catch::Contains("another folder"));
  CHECK(common::read_file(folder / "kept/plan.json") == before);
  CHECK(std::filesystem::exists(folder / "kept/weights/a"));
}

TEST_CASE("a record holds no more once the cell, its preset or what it needs is another") {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "preset.json", "{\"epochs\": 3}");
  Plan made = plan({cell("a"), cell("b", {"dynamics={a}/checkpoint"})});
  made.cells[1].config = "preset.json";
  const runs::PlanPlace place{folder / "out", "lodestone", folder.path(), "", 1, folder / "kept"};
  runs::KeptResults kept(place.results);
  for (const char* id : {"a", "b"}) finish(made, place, id);
  common::write_file_atomically(folder / "out/b/config.json", "{\"epochs\": 3}");
  kept.keep(made, place);
  REQUIRE(kept.finished(made, place).size() == 2);

  Plan other = made;
  other.cells[0].seed = 7;
  CHECK(kept.finished(other, place).empty());  // b was made from another a
  other = made;
  other.cells[1].settings.push_back("epochs=4");
  CHECK(kept.finished(other, place).count("a") == 1);
  CHECK(kept.finished(other, place).count("b") == 0);
  CHECK(kept.changed(made) == 0);
  CHECK(kept.changed(other) == 1);
  other.cells[1].id = "c";  // nothing is kept of that
  CHECK(kept.changed(other) == 0);
  other.cells[1].id = "b";
  common::write_file_atomically(folder / "preset.json", "{\"epochs\": 4}");
  CHECK(kept.finished(made, place).count("b") == 0);
  runs::write_plan(other, folder / "kept");  // the page, too, has only what still holds
  CHECK(runs::read_kept_plan(folder / "kept").records.count("a") == 1);
  CHECK(runs::read_kept_plan(folder / "kept").records.count("b") == 0);
}

TEST_CASE("what was run with other settings is neither kept nor restored as what it is not") {
  const tests::TemporaryFolder folder;
  Plan made = plan({cell("a", {"epochs=3"}), cell("b", {"dynamics={a}/checkpoint"})});
  const runs::PlanPlace place{folder / "out", "lodestone", "configs", "", 1, folder / "kept"};
  finish(made, place, "a");
  common::write_file_atomically(folder / "out/a/config.json", "{\"epochs\": 3, \"rate\": 0.5}");
  runs::KeptResults(place.results).keep(made, place);
  CHECK(std::filesystem::exists(folder / "kept/weights/a"));

  made.cells[0].settings = {"epochs=4"};
  runs::KeptResults later(place.results);
  later.keep(made, place);
  CHECK(later.finished(made, place).empty());
  CHECK(std::filesystem::exists(folder / "kept/weights/a"));  // of what it was, until it is run anew
  common::write_file_atomically(folder / "out/a/config.json", "{\"epochs\": 4, \"rate\": 0.5}");
  runs::KeptResults(place.results).keep(made, place);
  CHECK(later.finished(made, place).count("a") == 1);
}

TEST_CASE("a folder of results without a plan, and a damaged record, are named") {
  const tests::TemporaryFolder folder;
  CHECK_THROWS_WITH(runs::read_kept_plan(folder.path()), Catch::Contains("holds no plan"));
  const Plan made = plan({cell("a")});
  const runs::PlanPlace place{folder / "out", "lodestone", "configs", "", 1, folder / "kept"};
  finish(made, place, "a");
  runs::KeptResults(place.results).keep(made, place);
  common::write_file_atomically(folder / "kept/records/a.json", "{\"verb\": ");
  CHECK_THROWS_AS(runs::read_kept_plan(folder / "kept"), common::DataError);
  runs::CellRecord uneven;
  uneven.curve.emplace().env_steps = {0.0, 100.0};
  uneven.curve->episode_return = uneven.curve->success_rate = uneven.curve->seconds = {0.0, 1.0};
  common::write_artefact(folder / "kept/records/a.json", uneven);
  CHECK_THROWS_WITH(runs::read_kept_plan(folder / "kept"), Catch::Contains("differ in length"));
}
