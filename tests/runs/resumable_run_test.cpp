#include "lodestone/runs/resumable_run.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <sstream>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

namespace {

using namespace lodestone;
using common::Json;

/// Counts, and writes each number into the metrics; its process dies at `dies_at`.
struct Counting : runs::ResumableWork {
  std::int64_t count = 0;
  std::int64_t total = 6;
  std::int64_t dies_at = -1;
  std::int64_t gives_up_at = -1;
  int saved = 0;
  int loaded = 0;

  runs::Progress progress() const override { return {count, total, count >= total, std::to_string(count)}; }
  void step(common::MetricsLog& metrics) override {
    if (count == gives_up_at) throw common::Interrupted("in the middle");
    ++count;
    metrics.write(count, {{"count", static_cast<double>(count)}});
    if (count == dies_at) throw std::runtime_error("killed");
  }
  void save(const std::string& folder) override {
    common::write_json(folder + "/count.json", count);
    ++saved;
  }
  void load(const std::string& folder) override {
    count = common::read_json_if_there(folder + "/count.json").get<std::int64_t>();
    ++loaded;
  }
};

runs::RunRequest resumable_request(const std::string& folder) {
  runs::RunRequest made;
  made.folder = folder;
  made.verb = "count";
  made.config = Json::object();
  made.resume = true;
  return made;
}

std::vector<int> steps(const std::string& folder) {
  std::istringstream lines(common::read_file(folder + "/metrics.jsonl"));
  std::vector<int> found;
  for (std::string line; std::getline(lines, line);) found.push_back(Json::parse(line).at("step").get<int>());
  return found;
}

}  // namespace

TEST_CASE("a killed run goes on from its last checkpoint, and its curves repeat no step") {
  const tests::TemporaryFolder folder;
  for (const bool checkpointed : {false, true}) {
    const std::string path = folder / (checkpointed ? "with" : "without");
    {
      runs::RunFolder run(resumable_request(path));
      Counting work;
      work.dies_at = checkpointed ? 4 : 1;
      if (checkpointed) {
        work.total = 2;  // up to its first checkpoint
        runs::run_resumably(run, work, {"counting", "numbers", 1e9});
        work.total = 6;
      }
      CHECK_THROWS_WITH(runs::run_resumably(run, work, {"counting", "numbers", 1e9}), "killed");
    }
    CHECK(steps(path).back() == (checkpointed ? 4 : 1));
    runs::RunFolder run(resumable_request(path));
    CHECK(run.stage() == runs::RunStage::kResumable);
    Counting work;
    runs::run_resumably(run, work, {"counting", "numbers", 1e9});
    CHECK(work.loaded == (checkpointed ? 1 : 0));
    CHECK(steps(path) == std::vector<int>{1, 2, 3, 4, 5, 6});
    CHECK(run.state().done == 6);
    CHECK(run.state().checkpoint == 6);
    CHECK_FALSE(run.finished());  // that is for the caller to say
  }
}

TEST_CASE("work that is interrupted in a step goes on from its last checkpoint, and says how") {
  const tests::TemporaryFolder folder;
  {
    runs::RunFolder run(resumable_request(folder / "run"));
    Counting work;
    work.gives_up_at = 3;
    CHECK_THROWS_WITH(runs::run_resumably(run, work, {"counting", "numbers", 0.0}),
                      Catch::Contains("count: stopped after 3 of 6 numbers") && Catch::Contains("--resume"));
    CHECK(work.saved == 3);
  }
  CHECK(runs::find_run(folder / "run")->checkpoint == 3);
  CHECK(runs::find_run(folder / "run")->note == "3");
  runs::RunFolder run(resumable_request(folder / "run"));
  Counting work;
  runs::run_resumably(run, work, {"counting", "numbers", 1e9});
  CHECK(steps(folder / "run") == std::vector<int>{1, 2, 3, 4, 5, 6});
}

TEST_CASE("what is said to be done is what a run goes on from") {
  const tests::TemporaryFolder folder;
  runs::RunFolder run(resumable_request(folder / "run"));
  Counting work;
  work.gives_up_at = 0;
  CHECK_THROWS_WITH(runs::run_resumably(run, work, {"counting", "numbers", 1e9}),
                    Catch::Contains("stopped after 0 of 6"));
  work.gives_up_at = 3;
  CHECK_THROWS_WITH(runs::run_resumably(run, work, {"counting", "numbers", 1e9}),
                    Catch::Contains("stopped after 1 of 6"));  // the first is saved at once
  CHECK(runs::find_run(folder / "run")->done == 1);
  CHECK(runs::find_run(folder / "run")->total == 6);
}

TEST_CASE("what is refused before anything is done leaves no run behind") {
  const tests::TemporaryFolder folder;
  struct Refused : Counting {
    std::int64_t after = 0;
    void step(common::MetricsLog& metrics) override {
      if (count == after) throw common::ConfigError("no such place");
      Counting::step(metrics);
    }
  };
  for (const std::int64_t after : {0, 2}) {
    runs::RunFolder run(resumable_request(folder / "run"));
    Refused work;
    work.after = after;
    CHECK_THROWS_WITH(runs::run_resumably(run, work, {"counting", "numbers", 0.0}), "no such place");
    CHECK(std::filesystem::exists(folder / "run") == (after > 0));
  }
}

TEST_CASE("checkpoints are written as often as asked for") {
  const tests::TemporaryFolder folder;
  runs::RunFolder run(resumable_request(folder / "run"));
  Counting work;
  runs::run_resumably(run, work, {"counting", "numbers", 0.0});
  CHECK(work.saved == 6);
}

TEST_CASE("what a run came to stands beside its curves, with how it was configured") {
  const tests::TemporaryFolder folder;
  runs::RunRequest request = resumable_request(folder / "run");
  request.config = {{"model", {{"rate", 0.5}}}};
  runs::RunFolder run(request);
  Counting work;
  runs::run_resumably(run, work, {"counting", "numbers", 0.0});
  runs::show_result(run, {{"errors", {{"rms_mm", 0.25}}}});
  std::string events;
  for (const auto& entry : std::filesystem::directory_iterator(run.path()))
    if (entry.path().extension() == ".lodestone") events += common::read_file(entry.path().string());
  for (const char* tag : {"config", "model.rate", "count", "final/errors.rms_mm", "session_end_info"})
    CHECK(events.find(tag) != std::string::npos);
}
