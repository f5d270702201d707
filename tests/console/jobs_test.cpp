#include "lodestone/console/jobs.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <functional>
#include <mutex>
#include <thread>

#include "lodestone/common/error.h"
#include "temporary_folder.h"

using namespace lodestone;
using console::Bench;
using console::JobKind;
using console::Jobs;
using console::Mode;

namespace {

bool reach(const std::function<bool()>& there) {
  for (int i = 0; i < 2000; ++i) {
    if (there()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

bool running(const Jobs& jobs) { return jobs.now().value("running", false); }

}  // namespace

TEST_CASE("jobs run one at a time, have the rig meanwhile, are asked and ended") {
  const tests::TemporaryFolder folder;
  experiments::DeploymentConfig config;
  config.sensor.kind = "simulated";
  Bench::Parts parts;
  parts.config = config;
  parts.sources = {experiments::baseline_source(config)};
  parts.connect = [&] {
    return session::make_virtual_session(config.rig, config.sensor, config.safety, {}, true);
  };
  parts.tell = [](const console::BenchEvent&) {};
  Bench bench(parts);
  const std::string run =
      R"({"verb": "collect", "finished": false, "unit": "transitions", "done": 3, "total": 5,
                              "seconds": 1.0, "note": "half", "updated_utc": "2026-01-01T00:00:00Z"})";
  const std::string begin = "mkdir $0; echo '" + run + "' > $0/run.json; exec sleep 1000";
  std::vector<JobKind> kinds = {{"run", {"/bin/sh", "-c", begin, "{out}"}, {}, false},
                                {"quick", {"/bin/sh", "-c", "echo {out}; printf 'a\\rb\\n'"}, {}, false},
                                {"broken", {"/bin/sh", "-c", "exit 7"}, {}, false},
                                {"long", {"/bin/sleep", "1000"}, {}, true},
                                {"walk",
                                 {},
                                 [](session::Dialogue& dialogue) {
                                   dialogue.say("port: fine\n");
                                   if (!dialogue.confirm("Energise +x?")) throw common::Error("not ready");
                                   dialogue.say("+x: fine\n");
                                 },
                                 true}};
  Jobs jobs(bench, kinds, folder.path(), [](const std::string&) {});
  CHECK(jobs.now().is_null());
  REQUIRE(reach([&] { return bench.state().mode == Mode::kDisarmed; }));
  CHECK_FALSE(jobs.start("unknown").empty());
  CHECK_FALSE(jobs.end().empty());

  REQUIRE(jobs.start("quick").empty());
  REQUIRE(reach([&] { return !running(jobs); }));
  CHECK_THAT(jobs.now()["text"].get<std::string>(),
             Catch::StartsWith(folder.path() + "/quick-") && Catch::EndsWith("\nb\ndone\n"));
  CHECK(bench.state().mode == Mode::kDisarmed);

  REQUIRE(jobs.start("run").empty());
  REQUIRE(reach([&] { return jobs.now()["done"] == 3; }));
  CHECK(jobs.now()["total"] == 5);
  CHECK(jobs.now()["note"] == "half");
  REQUIRE(jobs.end().empty());
  REQUIRE(reach([&] { return !running(jobs); }));

  REQUIRE(jobs.start("broken").empty());
  REQUIRE(reach([&] { return !running(jobs); }));
  CHECK_THAT(jobs.now()["text"].get<std::string>(), Catch::Contains("exit code 7"));

  REQUIRE(jobs.start("long").empty());
  CHECK_THAT(jobs.start("quick"), Catch::Contains("long is under way"));
  REQUIRE(reach([&] { return bench.state().mode == Mode::kDisconnected; }));
  CHECK_THAT(bench.state().reason, Catch::Contains("long"));
  REQUIRE(jobs.end().empty());
  REQUIRE(reach([&] { return !running(jobs); }));
  CHECK_THAT(jobs.now()["text"].get<std::string>(), Catch::Contains("ended by the operator"));
  REQUIRE(reach([&] { return bench.state().mode == Mode::kDisarmed; }));

  for (const bool yes : {true, false}) {
    CHECK_FALSE(jobs.answer(yes).empty());
    REQUIRE(jobs.start("walk").empty());
    REQUIRE(reach([&] { return !jobs.question().is_null(); }));
    CHECK(jobs.question() == "Energise +x?");
    REQUIRE(jobs.answer(yes).empty());
    REQUIRE(reach([&] { return !running(jobs); }));
    CHECK_THAT(jobs.now()["text"].get<std::string>(), Catch::Contains(yes ? "+x: fine" : "not ready"));
    REQUIRE(reach([&] { return bench.state().mode == Mode::kDisarmed; }));
  }
  REQUIRE(jobs.start("long").empty());  // ends with its owner
}
