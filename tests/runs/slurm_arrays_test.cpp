#include "lodestone/runs/slurm_arrays.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <functional>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/shell.h"
#include "runs/cells.h"
#include "temporary_folder.h"

using namespace lodestone;
using runs::Plan;
using runs::SlurmArray;
using tests::cell;
using tests::Ids;
using tests::plan;

namespace {

std::vector<SlurmArray> arrays(const Plan& made,
                               const runs::PlanPlace& place = {"out", "lodestone", "configs"},
                               std::int64_t most_tasks = 1001) {
  return runs::slurm_arrays(made, place, runs::wanted_cells(made), most_tasks);
}

Ids ids(const SlurmArray& array) {
  Ids out;
  for (const runs::SlurmTask& task : array.tasks) out.push_back(task.cell->id);
  return out;
}

}  // namespace

TEST_CASE("cells that each need one cell of an array wait for that task alone") {
  const Plan chains =
      plan({cell("a0"), cell("a1"), cell("a2"), cell("b0", {"data={a0}/x"}), cell("b2", {"data={a2}/x"}),
            cell("c2", {"data={b2}/x"}), cell("d2", {"data={b2}/x"}), cell("d0", {"data={b0}/x"})});
  const auto made = arrays(chains);
  REQUIRE(made.size() == 4);
  CHECK(ids(made[0]) == Ids{"a0", "a1", "a2"});
  CHECK(runs::slurm_indices(made[0]) == "0-2");
  CHECK(ids(made[1]) == Ids{"b0", "b2"});
  CHECK(runs::slurm_indices(made[1]) == "0,2");
  CHECK(made[1].one_to_one);
  CHECK(made[1].after == std::vector<std::size_t>{0});
  CHECK(ids(made[2]) == Ids{"d0", "c2"});
  CHECK(ids(made[3]) == Ids{"d2"});  // the second that needs b2
  CHECK(runs::slurm_indices(made[3]) == "2");
  CHECK(made[3].after == std::vector<std::size_t>{1});
}

TEST_CASE("cells that need several, or one that many need, wait for whole arrays") {
  std::vector<runs::Cell> cells = {cell("a"), cell("b", {"data={a}/x"}), cell("both", {"data={a}/x,{b}/x"})};
  const Plan few = plan(cells);
  const auto made = arrays(few);
  REQUIRE(made.size() == 3);
  CHECK_FALSE(made[2].one_to_one);
  CHECK(made[2].after == std::vector<std::size_t>{0, 1});
  for (int i = 0; i < 40; ++i) cells.push_back(cell("c" + std::to_string(i), {"data={b}/x"}));
  const Plan more = plan(cells);
  const auto many = arrays(more);
  REQUIRE(many.size() == 3);
  CHECK(many[2].tasks.size() == 41);
  CHECK(many[2].after == std::vector<std::size_t>{0, 1});
}

TEST_CASE("arrays are as long as the cluster takes, and cells that ask for more have their own") {
  Plan made = plan({cell("a"), cell("b"), cell("c"), cell("d")});
  made.minutes = 90;
  made.cells[1].memory_mb = 9000;
  made.cells[2].all_threads = true;
  const auto limited = arrays(made, {"out", "lodestone", "configs", "", 8});
  REQUIRE(limited.size() == 3);
  CHECK(ids(limited[0]) == Ids{"a", "d"});
  CHECK(limited[0].resources.minutes == 90);
  CHECK(limited[1].resources.memory_mb == 9000);
  CHECK(limited[2].resources.cpus == 8);
  const Plan chain = plan({cell("a"), cell("b"), cell("c"), cell("d", {"data={c}/x"})});
  const auto split = arrays(chain, {"out", "lodestone", "configs"}, 2);
  REQUIRE(split.size() == 3);
  CHECK(ids(split[1]) == Ids{"c"});
  CHECK(split[2].after == std::vector<std::size_t>{1});
}

TEST_CASE("needs that are finished are waited for by nobody") {
  const Plan made = plan({cell("a"), cell("b", {"data={a}/x"})});
  const auto left = runs::slurm_arrays(made, {"out", "lodestone", "configs"}, {&made.cells[1]}, 1001);
  REQUIRE(left.size() == 1);
  CHECK(left[0].after.empty());
}

TEST_CASE("a task runs the line of its index, and says in its cell's log why it did not") {
  const tests::TemporaryFolder folder;
  const std::string program = folder / "it's a program";
  common::write_file_atomically(program, R"(#!/bin/sh
while [ $# -gt 0 ]; do if [ "$1" = --out ]; then out=$2; fi; shift; done
echo "in $out"
case "$out" in *fails) echo "something broke"; exit 3 ;; *slow) exec sleep 30 ;; esac
mkdir -p "$out/training"
printf '{"finished": true}' > "$out/run.json"
)");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const runs::PlanPlace place{folder / "out $1", program, "configs"};
  Plan made = plan({cell("a"), cell("fails"), cell("b", {"data={a}/x"}), cell("slow")});
  made.keep_checkpoints = false;
  std::filesystem::create_directories(place.folder);
  common::write_file_atomically(folder / "task.sh", runs::slurm_script(made));
  const auto run = [&](const std::string& id, const std::string& before = "") {
    SlurmArray array;
    array.tasks = {{3, &made.cells[0]}, {17, made.find(id)}};
    common::write_file_atomically(folder / "tasks", runs::slurm_lines(made, place, array));
    const int code = common::run_command({"sh", "-c",
                                          "sleep() { :; }; export SLURM_ARRAY_TASK_ID=17; " + before +
                                              " exec sh \"$0\" \"$1\"",
                                          folder / "task.sh", folder / "tasks"})
                         .exit_code;
    return std::make_pair(code, common::read_file(runs::log_file(made, place, id)));
  };
  CHECK(run("fails").first == 3);
  CHECK(run("fails").second.find("something broke") != std::string::npos);
  CHECK(run("a") == std::make_pair(0, "in " + place.folder + "/a\n"));
  CHECK(std::filesystem::exists(place.folder + "/a/run.json"));
  CHECK_FALSE(std::filesystem::exists(place.folder + "/a/training"));
  CHECK(run("b").first == 0);
  Plan lines = plan({cell("a", {"x=1\n2"})});
  SlurmArray array;
  array.tasks = {{0, &lines.cells[0]}};
  CHECK_THROWS_WITH(runs::slurm_lines(lines, place, array), Catch::Contains("one line"));
}
