#include "lodestone/runs/plan.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/runs/ninja_engine.h"
#include "temporary_folder.h"

using namespace lodestone;
using runs::Cell;
using runs::Plan;

namespace {

Cell cell(const std::string& id, std::vector<std::string> settings = {}) {
  Cell made;
  made.id = id;
  made.verb = "collect";
  made.settings = std::move(settings);
  return made;
}

Plan plan(std::vector<Cell> cells) {
  Plan made;
  made.cells = std::move(cells);
  return made;
}

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

TEST_CASE("a plan read from a file has defaults, and says what is wrong with it") {
  const tests::TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    common::write_file_atomically(folder / "plan.json", text);
    return runs::read_plan(folder / "plan.json");
  };
  const Plan good = read(R"({"cells": [{"id": "a", "verb": "collect"},
                                       {"id": "b", "verb": "train-dynamics", "settings": ["data={a}/x.h5,{a}/y.h5"]}]})");
  CHECK(good.cells[1].needs() == std::vector<std::string>{"a"});
  CHECK(good.seed == 1);
  CHECK(good.cells[0].config.empty());
  CHECK_THROWS_WITH(read(R"({"cells": [{"id": "a", "verb": "collect", "sedd": 1}]})"),
                    Catch::Contains("sedd"));
  CHECK_THROWS_WITH(read(R"({"cells": []})"), Catch::Contains("at least one cell"));
  CHECK_THROWS_WITH(read(R"({"cells": [{"id": "a", "verb": "dance"}]})"), Catch::Contains("dance"));
  CHECK_THROWS_WITH(plan({cell("b", {"data={a}/x"}), cell("a")}).validate(), Catch::Contains("{a}"));
  CHECK_THROWS_WITH(plan({cell("a"), cell("a")}).validate(), Catch::Contains("twice"));
  CHECK_THROWS_AS(plan({cell("../a")}).validate(), common::ConfigError);
}

TEST_CASE("a cell's command names its folder, its seed and the folders it needs") {
  Plan made = plan({cell("a"), cell("b", {"data={a}/x.h5"})});
  made.subfolder = "cells";
  made.seed = 4;
  made.cells[1].seed_offset = 9000;
  made.cells[1].config = "best/collect.json";
  const runs::PlanPlace place{"out", "lodestone", "configs", "", 3};
  CHECK(runs::cell_arguments(made, place, made.cells[1]) ==
        std::vector<std::string>{"collect", "--config", "configs/best/collect.json", "--set",
                                 "data=out/cells/a/x.h5", "--seed", "9004", "--threads", "1", "--out",
                                 "out/cells/b", "--resume"});
}

TEST_CASE(
    "ninja runs what is not finished, once, in the order of needs, and a failure is named after the others "
    "ended") {
  const tests::TemporaryFolder folder;
  const runs::PlanPlace place{folder / "out of $5", fake_program(folder), "configs", "", 2};
  Plan made =
      plan({cell("a"), cell("b", {"data={a}/x"}), cell("bad"), cell("c", {"data={bad}/x"}), cell("it's")});
  CHECK_THROWS_WITH(runs::run_plan(made, place, "plan"), Catch::Contains("2 of 5 cells are not finished") &&
                                                             Catch::Contains("bad: something broke"));
  CHECK(std::filesystem::exists(place.folder + "/it's/run.json"));
  const std::vector<runs::StatusRow> rows = runs::status_of(place.folder);
  REQUIRE(rows.size() == 5);
  CHECK(rows[0].state->finished);
  CHECK_FALSE(rows[3].state);
  runs::run_plan(made, place, "plan", "b");
  const std::string started = common::read_file(folder / "started");
  CHECK(started.find("/a\n") < started.find("/b\n"));
  CHECK(started.find("/b\n") == started.rfind("/b\n"));
  CHECK_THROWS_WITH(runs::run_plan(made, place, "plan", "nowhere"), Catch::Contains("nowhere"));
}

TEST_CASE("status finds a run, and all runs below a folder") {
  const tests::TemporaryFolder folder;
  for (const char* name : {"x/one", "two"}) {
    runs::RunFolder run({folder / name, "collect", common::Json::object()});
    run.begin();
    if (std::string(name) == "two") run.finish();
  }
  CHECK(runs::status_of(folder / "two").at(0).state->finished);
  const std::vector<runs::StatusRow> rows = runs::status_of(folder.path());
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].name == folder / "two");
  CHECK_FALSE(rows[1].state->finished);
  CHECK_FALSE(rows[1].running);
  CHECK_THROWS_AS(runs::status_of(folder / "x/nothing"), common::ConfigError);
}
