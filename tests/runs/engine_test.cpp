#include "lodestone/runs/engine.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <set>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "runs/cells.h"
#include "temporary_folder.h"

using namespace lodestone;
using runs::Plan;
using tests::cell;
using tests::Ids;
using tests::plan;

namespace {

/// Finishes cells at once, but those that fail and those that need them.
class FakeEngine final : public runs::Engine {
 public:
  explicit FakeEngine(std::set<std::string> failing = {}) : failing_(std::move(failing)) {}

  void start(const Plan& made, const runs::PlanPlace& place,
             const std::vector<const runs::Cell*>& cells) override {
    for (const runs::Cell* asked : cells) {
      started.push_back(asked->id);
      bool fails = failing_.count(asked->id) > 0;
      for (const std::string& need : asked->needs()) fails = fails || failing_.count(need) > 0;
      if (!fails) {
        tests::finish(made, place, asked->id);
        continue;
      }
      if (failing_.insert(asked->id).second) continue;
      common::write_file_atomically(runs::log_file(made, place, asked->id), "at work\nsomething broke\n");
    }
  }
  bool ended() override { return true; }
  void stop() override {}

  Ids started;

 private:
  std::set<std::string> failing_;
};

}  // namespace

TEST_CASE("only what is not finished is started, and what is finished is kept") {
  const tests::TemporaryFolder folder;
  const runs::PlanPlace place{folder / "out", "lodestone", "configs", "", 1, folder / "kept"};
  const Plan made = plan({cell("a"), cell("b", {"dynamics={a}/checkpoint"}), cell("c")});
  FakeEngine first, second, third;
  runs::run_plan(made, place, first, "plan", "b");
  CHECK(first.started == Ids{"a", "b"});
  CHECK(std::filesystem::exists(folder / "kept/records/b.json"));
  runs::run_plan(made, place, second, "plan");
  CHECK(second.started == Ids{"c"});
  runs::run_plan(made, place, third, "plan");
  CHECK(third.started.empty());
  CHECK_THROWS_WITH(runs::run_plan(made, place, third, "plan", "nowhere"), Catch::Contains("nowhere"));
}

TEST_CASE("a cell that failed is named with its last line, and those that wait for it are counted") {
  const tests::TemporaryFolder folder;
  const runs::PlanPlace place{folder / "out", "lodestone", "configs"};
  const Plan made =
      plan({cell("a"), cell("bad"), cell("c", {"dynamics={bad}/x"}), cell("d", {"dynamics={c}/x"})});
  FakeEngine engine({"bad"});
  CHECK_THROWS_WITH(
      runs::run_plan(made, place, engine, "plan"),
      Catch::Contains("3 of 4 cells are not finished, 2 of them because they wait for others; the first, "
                      "bad: something broke"));
}

TEST_CASE("a plan's folder holds one plan, and is finished when all its cells are") {
  const tests::TemporaryFolder folder;
  const runs::PlanPlace place{folder / "out", "lodestone", "configs"};
  const Plan made = plan({cell("a"), cell("b")});
  const auto run = [&](const common::Json& settings, const std::string& only) {
    FakeEngine engine;
    runs::run_plan_in_folder(made, place, engine, "plan run", settings, only);
  };
  run({{"scale", 1}}, "a");
  CHECK_FALSE(runs::find_run(place.folder)->finished);
  CHECK_THROWS_WITH(run({{"scale", 2}}, ""), Catch::Contains("scale = 2"));
  run({{"scale", 1}}, "");
  CHECK(runs::find_run(place.folder)->finished);
}

TEST_CASE("a cell that has not finished may be corrected in its folder, one that has may not") {
  const tests::TemporaryFolder folder;
  const runs::PlanPlace place{folder / "out", "lodestone", "configs"};
  const auto run = [&](const Plan& made, std::set<std::string> failing) {
    FakeEngine engine(std::move(failing));
    runs::run_plan_in_folder(made, place, engine, "plan run", common::artefact_to_json(made), "");
    return engine.started;
  };
  CHECK_THROWS(run(plan({cell("a", {"sessions=1"}), cell("b", {"wrong=1"})}), {"b"}));
  const Plan corrected = plan({cell("a", {"sessions=1"}), cell("b", {"sessions=2"}), cell("c")});
  CHECK(run(corrected, {}) == Ids{"b", "c"});
  CHECK_THROWS_WITH(run(plan({cell("a", {"sessions=3"}), cell("b", {"sessions=2"})}), {}),
                    Catch::Contains("the cell a has finished with other settings"));

  // Also where the plan before did not have it, and another one had.
  CHECK(run(plan({cell("c")}), {}).empty());
  CHECK_THROWS_WITH(run(plan({cell("a", {"sessions=3"}), cell("c")}), {}),
                    Catch::Contains("the cell a has finished"));
  common::write_file_atomically(folder / "out/a/config.json", R"({"sessions": 1})");
  CHECK(run(plan({cell("a", {"sessions=1"}), cell("c")}), {}).empty());
  common::write_file_atomically(folder / "out/b/config.json", R"({"sessions": 2})");
  FakeEngine engine;
  runs::run_plan_in_folder(corrected, place, engine, "plan run", common::artefact_to_json(corrected), "a");
  CHECK(runs::find_run(place.folder)->finished);  // nothing is left of it
}

TEST_CASE("a request to stop that nobody met does not stop the next command") {
  const tests::TemporaryFolder folder;
  const runs::PlanPlace place{folder / "out", "lodestone", "configs"};
  const Plan made = plan({cell("a")});
  for (int i = 0; i < 2; ++i) {  // with something to run, and with nothing
    common::make_folders(place.folder);
    runs::ask_to_stop(place.folder);
    FakeEngine engine;
    runs::run_plan(made, place, engine, "plan");
    CHECK_FALSE(runs::asked_to_stop(place.folder));
  }
}

TEST_CASE("a plan's folder is that of a rig and of presets that stay what they were") {
  const tests::TemporaryFolder folder;
  const std::string rig = folder / "rig.json", preset = folder / "preset.json", other = folder / "other.json";
  const runs::PlanPlace place{folder / "out", "lodestone", folder.path(), rig};
  Plan made = plan({cell("a")});
  made.cells[0].config = "preset.json";
  const auto run = [&] {
    FakeEngine engine;
    runs::run_plan_in_folder(made, place, engine, "plan run", {}, "", [] {}, {{"other", other}});
  };
  for (const std::string& file : {rig, preset, other}) common::write_file_atomically(file, "{}");
  run();
  for (const auto& [name, file] : std::map<std::string, std::string>{
           {"--rig: ", rig}, {"preset preset.json: ", preset}, {"other: ", other}}) {
    common::write_file_atomically(file, "{\"changed\": 1}");
    CHECK_THROWS_WITH(run(), Catch::Contains(name) && Catch::Contains("holds something else"));
    common::write_file_atomically(file, "{}");
    CHECK_NOTHROW(run());
  }
}
