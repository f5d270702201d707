#include "lodestone/runs/plan.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "runs/cells.h"
#include "temporary_folder.h"

using namespace lodestone;
using runs::Plan;
using tests::cell;
using tests::plan;

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
  CHECK(read(R"({"minutes": 90, "cells": [{"id": "a", "verb": "collect", "memory_mb": 500}]})")
            .cells[0]
            .memory_mb == 500);
  CHECK_THROWS_WITH(read(R"({"minutes": 2, "cells": [{"id": "a", "verb": "collect"}]})"),
                    Catch::Contains("minutes = 2 must be at least 3"));
  CHECK_THROWS_WITH(read(R"({"cells": [{"id": "a", "verb": "dance"}]})"), Catch::Contains("dance"));
  CHECK_THROWS_WITH(plan({cell("b", {"data={a}/x"}), cell("a")}).validate(), Catch::Contains("{a}"));
  CHECK_THROWS_WITH(plan({cell("a"), cell("a")}).validate(), Catch::Contains("twice"));
  CHECK_THROWS_AS(plan({cell("../a")}).validate(), common::ConfigError);
}

TEST_CASE("an id is a folder of its own, and none of the engines'") {
  const auto refused = [](const std::vector<std::string>& ids, const std::string& why) {
    std::vector<runs::Cell> cells;
    for (const std::string& id : ids) cells.push_back(tests::cell(id));
    CHECK_THROWS_WITH(tests::plan(cells).validate(), Catch::Contains(why));
  };
  for (const char* id : {"", "/a", "a//b", ".", "a/./b", "..", "a/..", "a/"})
    refused({id}, "an id is the name of a folder");
  for (const char* own : {"stamps", "slurm/a", "stop", "run.json", "ninja.log/a"})
    refused({own}, "is the plan's own");
  refused({"a", "a.log"}, "what ends in .log");
  refused({"a/b", "a"}, "would lie in the folder of cell \"a\"");
  CHECK_NOTHROW(tests::plan({tests::cell("a/b"), tests::cell("ab"), tests::cell("a/stamps")}).validate());
  runs::Plan apart = tests::plan({tests::cell("stamps")});
  apart.subfolder = "cells";
  CHECK_NOTHROW(apart.validate());
}

TEST_CASE("verbs that do not go on where they were are no cells") {
  for (const char* verb : {"adapt", "bench rigs", "collect", "deploy"})
    CHECK_NOTHROW(runs::check_verb(verb, "x"));
  for (const char* verb : {"evaluate dynamics", "bench paper", "bench", ""})
    CHECK_THROWS_WITH(runs::check_verb(verb, "x"),
                      Catch::Contains("x: verb = ") && Catch::Contains("bench rigs"));
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

TEST_CASE("status finds a run, and all runs below a folder") {
  const tests::TemporaryFolder folder;
  for (const char* name : {"x/one", "two"}) {
    runs::RunFolder run({folder / name, "collect", common::Json::object()});
    run.begin();
    if (std::string(name) == "two") run.finish();
  }
  std::filesystem::create_symlink("round", folder / "x/round");  // leads to itself
  std::filesystem::create_symlink("nowhere", folder / "x/lost");
  CHECK(runs::status_of(folder / "two").at(0).state->finished);
  const std::vector<runs::StatusRow> rows = runs::status_of(folder.path());
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].name == folder / "two");
  CHECK_FALSE(rows[1].state->finished);
  CHECK_FALSE(rows[1].running);
  CHECK_THROWS_AS(runs::status_of(folder / "x/nothing"), common::ConfigError);
}
