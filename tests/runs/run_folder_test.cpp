#include "lodestone/runs/run_folder.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

namespace {

using lodestone::common::ConfigError;
using lodestone::common::Json;
using lodestone::runs::RunFolder;
using lodestone::runs::RunRequest;
using lodestone::runs::RunStage;

RunRequest request(const std::string& folder, bool resume) {
  RunRequest made;
  made.folder = folder;
  made.verb = "train-policy";
  made.config = {{"threads", 2}, {"td3", {{"discount", 0.9}}}, {"training", {{"env_steps", 100}}}};
  made.resume = resume;
  made.length_keys = {"training.env_steps"};
  return made;
}

}  // namespace

TEST_CASE("a run is fresh, then resumable, then finished, whatever else lies in its folder") {
  const lodestone::tests::TemporaryFolder root;
  const std::string folder = root / "run";
  {
    RunFolder run(request(folder, true));  // there is none to go on with yet
    CHECK(run.stage() == RunStage::kFresh);
    CHECK_FALSE(std::filesystem::exists(folder));
    run.begin();
  }
  CHECK(Json::parse(lodestone::common::read_file(folder + "/manifest.json"))["verb"] == "train-policy");
  lodestone::common::write_file_atomically(folder + "/result.json", "{}");
  {
    RunFolder run(request(folder, true));
    CHECK(run.stage() == RunStage::kResumable);
    run.finish();
  }
  CHECK(RunFolder(request(folder, true)).finished());
  CHECK(lodestone::runs::find_run(folder)->finished);
}

TEST_CASE("a run that goes on by another build, elsewhere or on more threads says so") {
  const lodestone::tests::TemporaryFolder root;
  const std::string folder = root / "run";
  const auto work = [&folder](int threads) {
    RunRequest made = request(folder, true);
    made.config["threads"] = threads;
    RunFolder(made).begin();
    return lodestone::runs::manifests_of(
        Json::parse(lodestone::common::read_file(folder + "/manifest.json")));
  };
  CHECK(work(2).size() == 1);
  CHECK(work(2).size() == 1);  // as before: nothing to say
  const std::vector<Json> there = work(4);
  REQUIRE(there.size() == 2);
  CHECK(there[0]["threads"] == 2);
  CHECK(there[0]["verb"] == "train-policy");
  CHECK_FALSE(there[0].contains("continued"));
  CHECK(there[1]["threads"] == 4);
  CHECK(there[1]["git_commit"] == there[0]["git_commit"]);
  CHECK(work(4).size() == 2);

  Json manifest = Json::parse(lodestone::common::read_file(folder + "/manifest.json"));
  manifest["continued"][0]["git_commit"] = "another";
  lodestone::common::write_file_atomically(folder + "/manifest.json", manifest.dump());
  CHECK(work(4).size() == 3);
  CHECK(lodestone::runs::manifests_of(Json()).empty());

  for (const char* damaged : {"[]", "5", "\"x\"", "{\"continued\": \"x\"}", "{\"continued\": [5]}"}) {
    INFO(damaged);
    lodestone::common::write_file_atomically(folder + "/manifest.json", damaged);
    CHECK(work(4).back()["threads"] == 4);
  }
}

TEST_CASE("a free key frees all below it") {
  const lodestone::tests::TemporaryFolder root;
  const auto stage = [&](const Json& cells) {
    RunRequest made = request(root / "run", true);
    made.config["cells"] = cells;
    made.config["cellsize"] = cells.size();
    made.free_keys = {"threads", "cells"};
    RunFolder run(made);
    run.begin();
    return run.stage();
  };
  CHECK(stage({{{"id", "a"}}}) == RunStage::kFresh);
  CHECK(stage({{{"id", "b"}}}) == RunStage::kResumable);
  CHECK_THROWS_WITH(stage({{{"id", "b"}}, {{"id", "c"}}}), Catch::Contains("cellsize = 2"));
}

TEST_CASE("a run goes on with what its inputs held when it began, wherever they lie now") {
  const lodestone::tests::TemporaryFolder root;
  lodestone::common::make_folders(root / "policy");
  lodestone::common::write_file_atomically(root / "policy/weights", "1");
  const auto asked = [&](const std::string& policy) {
    RunRequest made = request(root / "run", true);
    made.config["drive"] = {{"policy", policy}, {"by", "policy"}};
    made.free_keys.push_back("drive.policy");
    made.inputs =
        lodestone::runs::named_inputs(made.config, {"drive.policy", "drive.by", "td3.discount", "task"});
    return made;
  };
  CHECK(asked(root / "policy").inputs.size() == 1);
  CHECK(asked("").inputs.empty());
  RunFolder(asked(root / "policy")).begin();
  CHECK(RunFolder(asked(root / "policy")).stage() == RunStage::kResumable);
  std::filesystem::rename(root / "policy", root / "moved");
  CHECK(RunFolder(asked(root / "policy")).stage() == RunStage::kResumable);  // gone: whoever reads it says so
  CHECK(RunFolder(asked(root / "moved")).stage() == RunStage::kResumable);
  lodestone::common::write_file_atomically(root / "moved/weights", "2");
  CHECK_THROWS_WITH(RunFolder(asked(root / "moved")),
                    Catch::Contains("drive.policy") && Catch::Contains("holds something else"));
  Json manifest = Json::parse(lodestone::common::read_file(root / "run/manifest.json"));
  manifest.erase("inputs");  // of an older version
  lodestone::common::write_file_atomically(root / "run/manifest.json", manifest.dump());
  CHECK(RunFolder(asked(root / "moved")).stage() == RunStage::kResumable);
  for (const char* forged : {"[]", R"({"inputs": 3})", R"({"inputs": {"drive.policy": 3}})"}) {
    CAPTURE(forged);
    lodestone::common::write_file_atomically(root / "run/manifest.json", forged);
    const bool told = std::string(forged).find("policy") != std::string::npos;
    if (told)
      CHECK_THROWS_AS(RunFolder(asked(root / "moved")), ConfigError);
    else
      CHECK(RunFolder(asked(root / "moved")).stage() == RunStage::kResumable);
  }
  std::filesystem::remove(root / "run/manifest.json");
  CHECK(RunFolder(asked(root / "moved")).stage() == RunStage::kResumable);
}

TEST_CASE("a run that is refused after it began leaves nothing behind") {
  const lodestone::tests::TemporaryFolder root;
  const auto refused = [&](const std::string& folder) {
    RunFolder run(request(folder, true));
    run.begin();
    lodestone::common::write_file_atomically(folder + "/trials.jsonl", "");
    run.abandon();
  };
  refused(root / "new");
  CHECK_FALSE(std::filesystem::exists(root / "new"));
  lodestone::common::make_folders(root / "empty");
  refused(root / "empty");
  CHECK(std::filesystem::is_empty(root / "empty"));
  RunFolder(request(root / "begun", false)).begin();
  refused(root / "begun");  // that goes on with what was there
  CHECK(std::filesystem::exists(root / "begun/run.json"));
}

TEST_CASE("a run that was killed while it began is begun again") {
  const lodestone::tests::TemporaryFolder root;
  RunFolder(request(root / "run", false)).begin();
  std::filesystem::remove(root / "run/config.json");
  RunFolder run(request(root / "run", true));
  CHECK(run.stage() == RunStage::kFresh);
  run.begin();
  CHECK(std::filesystem::exists(root / "run/config.json"));
}

TEST_CASE("a run that was killed at its first word leaves nothing that is in anybody's way") {
  const lodestone::tests::TemporaryFolder root;
  for (const bool resume : {false, true}) {
    const std::string folder = root / (resume ? "resumed" : "again");
    std::filesystem::create_directories(folder);
    lodestone::common::write_file_atomically(folder + "/run.json.tmp4711", "{");
    RunFolder run(request(folder, resume));
    CHECK(run.stage() == RunStage::kFresh);
    run.begin();
    CHECK_FALSE(std::filesystem::exists(folder + "/run.json.tmp4711"));
    CHECK(lodestone::runs::find_run(folder));
  }
}

TEST_CASE("a folder in use is refused: not empty, no run, another verb, other settings by name") {
  const lodestone::tests::TemporaryFolder root;
  const std::string folder = root / "run";
  RunFolder(request(folder, false)).begin();
  CHECK_THROWS_WITH(RunFolder(request(folder, false)), Catch::Contains("--resume"));
  RunRequest other = request(folder, true);
  other.verb = "collect";
  CHECK_THROWS_WITH(RunFolder(other), Catch::Contains("holds a run of train-policy"));
  other = request(folder, true);
  other.config["td3"]["discount"] = 0.5;
  other.config["threads"] = 8;
  CHECK_THROWS_WITH(RunFolder(other), Catch::Contains("td3.discount = 0.5 (there: 0.9)") &&
                                          !Catch::Contains("threads") && !Catch::Contains("env_steps"));
  lodestone::common::write_file_atomically(root / "letter.txt", "dear");
  CHECK_THROWS_WITH(RunFolder(request(root.path(), true)), Catch::Contains("holds no run"));
  CHECK_THROWS_AS(RunFolder(request("", false)), ConfigError);
}

TEST_CASE("a finished run goes on when it is told to go further") {
  const lodestone::tests::TemporaryFolder root;
  const std::string folder = root / "run";
  {
    RunFolder run(request(folder, false));
    run.finish();
  }
  RunRequest longer = request(folder, true);
  longer.config["training"]["env_steps"] = 200;
  {
    RunFolder run(longer);
    CHECK(run.stage() == RunStage::kResumable);
    run.begin();
    CHECK_FALSE(lodestone::runs::find_run(folder)->finished);
  }
  CHECK(Json::parse(lodestone::common::read_file(folder + "/config.json"))["training"]["env_steps"] == 200);
}

TEST_CASE("one process at a time works in a folder") {
  const lodestone::tests::TemporaryFolder root;
  const std::string folder = root / "run";
  {
    RunFolder run(request(folder, false));
    run.begin();
    CHECK(lodestone::runs::is_running(folder));
    CHECK_THROWS_WITH(RunFolder(request(folder, true)), Catch::Contains("another process"));
  }
  CHECK_FALSE(lodestone::runs::is_running(folder));
}

TEST_CASE("a damaged state is named") {
  const lodestone::tests::TemporaryFolder root;
  RunFolder(request(root / "run", false)).begin();
  lodestone::common::write_file_atomically(root / "run/run.json", "{\"verb\": 3}");
  CHECK_THROWS_WITH(RunFolder(request(root / "run", true)), Catch::Contains("run.json: verb"));
}
