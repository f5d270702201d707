#include "lodestone/runs/ninja_engine.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <initializer_list>
#include <thread>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "runs/cells.h"
#include "temporary_folder.h"

using namespace lodestone;
using runs::Plan;
using tests::cell;
using tests::plan;

namespace {

/// A program that does what a verb does to its folder, fails where the folder is named "bad", and notes each
/// start.
std::string fake_program(const lodestone::tests::TemporaryFolder& folder) {
  const std::string path = folder / "fake";
  common::write_file_atomically(path, R"(#!/bin/sh
verb=$1
while [ $# -gt 0 ]; do if [ "$1" = --out ]; then out=$2; fi; shift; done
echo "$out" >> "$(dirname "$0")/started"
case "$out" in *bad) echo "something broke" >&2; exit 1 ;; esac
mkdir -p "$out"
printf '{"verb":"%s","finished":true,"unit":"","done":1,"total":1,"seconds":0,"note":"","updated_utc":""}' $verb > "$out/run.json"
)");
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

}  // namespace

TEST_CASE(
    "ninja runs what is not finished, once, in the order of needs, and a failure is named after the others "
    "ended") {
  const tests::TemporaryFolder folder;
  const runs::PlanPlace place{folder / "out of $5", fake_program(folder), "configs", "", 2};
  Plan made =
      plan({cell("a"), cell("b", {"data={a}/x"}), cell("bad"), cell("c", {"data={bad}/x"}), cell("it's")});
  runs::NinjaEngine engine;
  CHECK_THROWS_WITH(
      runs::run_plan(made, place, engine, "plan"),
      Catch::Contains("2 of 5 cells are not finished, 1 of them because they wait for others") &&
          Catch::Contains("bad: something broke"));
  CHECK(std::filesystem::exists(place.folder + "/it's/run.json"));
  const std::vector<runs::StatusRow> rows = runs::status_of(place.folder);
  REQUIRE(rows.size() == 5);
  CHECK(rows[0].state->finished);
  CHECK_FALSE(rows[3].state);
  CHECK(rows[2].failure == "something broke");
  CHECK(rows[2].waits_for.empty());
  CHECK(rows[3].waits_for == "bad");
  CHECK(rows[3].failure.empty());
  CHECK(rows[0].failure.empty());
  runs::run_plan(made, place, engine, "plan", "b");
  const std::string started = common::read_file(folder / "started");
  CHECK(started.find("/a\n") < started.find("/b\n"));
  CHECK(started.find("/b\n") == started.rfind("/b\n"));
  CHECK_THROWS_WITH(runs::run_plan(made, place, engine, "plan", "nowhere"), Catch::Contains("nowhere"));
}

TEST_CASE("cells that cannot fill the machine share its threads") {
  const tests::TemporaryFolder folder;
  const runs::PlanPlace place{folder / "out", fake_program(folder), "configs", "", 4};
  const Plan made = plan({cell("a"), cell("b", {"data={a}/x"}), cell("c", {"data={a}/x"}), cell("d"),
                          cell("e", {"data={b}/x"}), cell("f"), cell("g"), cell("h")});
  const auto threads_of = [&](std::initializer_list<int> which) {
    std::vector<const runs::Cell*> cells;
    for (const int i : which) cells.push_back(&made.cells[static_cast<std::size_t>(i)]);
    std::filesystem::create_directories(place.folder);
    runs::NinjaEngine engine;
    engine.start(made, place, cells);
    while (!engine.ended()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const std::string text = common::read_file(place.folder + "/build.ninja");
    const std::string flag = "'--threads' '";
    return text.substr(text.find(flag) + flag.size(), 1);
  };
  CHECK(threads_of({0}) == "4");
  CHECK(threads_of({0, 1}) == "2");
  CHECK(threads_of({0, 3, 5}) == "1");
  CHECK(threads_of({0, 1, 2, 3, 5, 6, 7}) == "1");
}

TEST_CASE("a plan that is stopped waits for cells that save what they have") {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "saving", R"(#!/bin/sh
trap 'sleep 0.5; touch "$(dirname "$0")/saved"; exit 130' TERM
touch "$(dirname "$0")/started"
while :; do sleep 0.02; done
)");
  std::filesystem::permissions(folder / "saving", std::filesystem::perms::owner_all);
  const runs::PlanPlace place{folder / "out", folder / "saving", "configs"};
  const Plan made = plan({cell("a")});
  std::filesystem::create_directories(place.folder);
  runs::NinjaEngine engine;
  engine.start(made, place, {&made.cells[0]});
  const auto wait = [] { std::this_thread::sleep_for(std::chrono::milliseconds(5)); };
  while (!std::filesystem::exists(folder / "started")) wait();
  engine.stop();
  while (!engine.ended()) wait();
  CHECK(std::filesystem::exists(folder / "saved"));
}
