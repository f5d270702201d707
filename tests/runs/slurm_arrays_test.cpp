#include "lodestone/runs/slurm_arrays.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/resource_use.h"
#include "lodestone/common/shell.h"
#include "lodestone/runs/kept_results.h"
#include "lodestone/runs/ninja_engine.h"
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

/// Ten thousand chains: one recording, a simulator from it, and eight policies and trials in it.
Plan a_hundred_thousand() {
  Plan made;
  made.subfolder = "cells";
  for (int i = 0; i < 10000; ++i) {
    const std::string chain = std::to_string(i);
    made.cells.push_back(cell(chain + "/data"));
    made.cells.push_back(cell(chain + "/dynamics", {"data={" + chain + "/data}/transitions.h5"}));
    for (int j = 0; j < 8; ++j)
      made.cells.push_back(
          cell(chain + "/policy" + std::to_string(j),
               {"dynamics={" + chain + "/dynamics}/checkpoint", "training.env_steps=500000"}));
  }
  return made;
}

void finish_quickly(const std::string& folder) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/run.json")
      << R"({"verb": "collect", "finished": true, "unit": "transitions", "done": 1, "total": 1, "seconds": 1.0, "note": "",
            "updated_utc": "2026-01-01T00:00:00Z"})";
}

/// Says how long something takes, as a row of docs/scale.md.
template <class Work>
double timed(const char* what, const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::printf("| %s | %.1f s | %.0f MB |\n", what, seconds, common::peak_memory_mb());
  return seconds;
}

}  // namespace

TEST_CASE("a plan of 100,000 cells is planned, looked up and told within a minute and 2 GB", "[slow]") {
  const tests::TemporaryFolder folder;
  const Plan made = a_hundred_thousand();
  const runs::PlanPlace place{folder / "out", "lodestone", "configs", "", 1, folder / "out/results"};
  for (std::size_t i = 0; i < made.cells.size(); i += 10)
    finish_quickly(runs::cell_folder(made, place, made.cells[i].id));
  double seconds = 0.0;
  std::vector<const runs::Cell*> left;
  std::vector<SlurmArray> planned;
  Plan read;
  common::make_folders(place.folder);
  seconds += timed("write the plan", [&] { runs::write_plan(made, place.folder); });
  seconds += timed("read and check it", [&] { read = runs::read_plan(place.folder + "/plan.json"); });
  seconds += timed("find what is not finished",
                   [&] { left = runs::cells_to_run(made, place, runs::wanted_cells(made)); });
  seconds += timed("group it into arrays", [&] { planned = runs::slurm_arrays(made, place, left, 1001); });
  std::size_t bytes = 0;
  seconds += timed("write their lines", [&] {
    for (std::size_t i = 0; i < planned.size(); ++i) {
      const std::string lines = runs::slurm_lines(made, place, planned[i]);
      common::write_file_atomically(place.folder + "/" + std::to_string(i) + ".tasks", lines);
      bytes += lines.size();
    }
  });
  seconds += timed("status", [&] { CHECK(runs::status_of(place.folder).size() == made.cells.size()); });
  CHECK(seconds < 60.0);
  timed("the text for ninja", [&] { CHECK(runs::ninja_text(made, place, left).size() > 1000000); });
  const runs::PlanPlace other{folder / "other", "lodestone", "configs", "", 1, folder / "other/results"};
  for (std::size_t i = 0; i < 1000; i += 10) finish_quickly(runs::cell_folder(made, other, made.cells[i].id));
  runs::KeptResults results(other.results);
  timed("keep 100 finished ones", [&] { results.keep(made, other); });
  const double again = timed("keep again, with nothing new", [&] { results.keep(made, other); });
  timed("find what is kept", [&] { CHECK(results.finished(made, other).size() == 100); });
  std::printf("%zu cells in %zu arrays, %zu bytes of lines\n", left.size(), planned.size(), bytes);
  CHECK(again < 10.0);
  CHECK(common::peak_memory_mb() < 2000.0);
  CHECK(read.cells.size() == made.cells.size());
}

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
  common::write_file_atomically(folder / "scontrol", "#!/bin/sh\necho \"asked: $*\"\nexit 1\n");
  std::filesystem::permissions(folder / "scontrol", std::filesystem::perms::owner_all);
  const auto run = [&](const std::string& id, const std::string& meanwhile = "") {
    SlurmArray array;
    array.tasks = {{3, &made.cells[0]}, {17, made.find(id)}};
    common::write_file_atomically(folder / "tasks", runs::slurm_lines(made, place, array));
    const std::string shell =
        "export SLURM_ARRAY_TASK_ID=17 SLURM_JOB_ID=99 PATH=\"$0:$PATH\"; "
        "sh \"$0/task.sh\" \"$0/tasks\" & " +
        meanwhile + " wait $!";
    const int code = common::run_command({"sh", "-c", shell, folder.path()}).exit_code;
    return std::make_pair(code, common::read_file(runs::log_file(made, place, id)));
  };
  CHECK(run("fails").first == 3);
  CHECK(run("fails").second.find("something broke") != std::string::npos);
  CHECK(run("a") == std::make_pair(0, "in " + place.folder + "/a\n"));
  CHECK(std::filesystem::exists(place.folder + "/a/run.json"));
  CHECK_FALSE(std::filesystem::exists(place.folder + "/a/training"));
  CHECK(run("b").first == 0);
  const auto late = run("slow", "sleep 1; kill -USR1 $!;");
  CHECK(late.first > 128);  // of the cell, or of the wait that the signal ended
  CHECK(late.second.find("asked: requeue 99") != std::string::npos);
  Plan lines = plan({cell("a", {"x=1\n2"})});
  SlurmArray array;
  array.tasks = {{0, &lines.cells[0]}};
  CHECK_THROWS_WITH(runs::slurm_lines(lines, place, array), Catch::Contains("one line"));
}
