#include "lodestone/console/console.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <functional>
#include <thread>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/console/page_client.h"
#include "temporary_folder.h"

using namespace lodestone;
using common::Json;
using console::Console;
using console::Mode;
using console::PageClient;

namespace {

constexpr double kPatience_s = 20.0;

/// A virtual bench in real time under the baseline, without a camera.
struct Room {
  Room() {
    experiments::DeploymentConfig config;
    config.sensor.kind = "simulated";
    config.loop.rest_s = 0.1;
    console::ConsoleParts parts;
    parts.bench.config = config;
    parts.bench.sources = {experiments::baseline_source(config)};
    parts.bench.connect = [config] {
      return session::make_virtual_session(config.rig, config.sensor, config.safety, {}, true);
    };
    parts.rig_name = parts.rig_kind = "virtual";
    parts.folder = folder / "console";
    parts.runs = folder.path();
    parts.port = 0;
    console = std::make_unique<Console>(std::move(parts));
    reach([this] { return console->state().mode == Mode::kDisarmed; });
  }
  static void reach(const std::function<bool()>& there) {
    for (int i = 0; i < 2000 && !there(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    REQUIRE(there());
  }

  /// Sooner or later.
  void has_on_record(const std::string& text) const {
    reach([&] { return common::read_file(folder / "console/events.jsonl").find(text) != std::string::npos; });
  }

  tests::TemporaryFolder folder;
  std::unique_ptr<Console> console;
};

/// The next message of a kind; beats meanwhile, where the page operates. Others are passed over.
Json heard(PageClient& page, const std::string& kind, bool beats = true) {
  for (int i = 0; i < static_cast<int>(kPatience_s / 0.05); ++i) {
    if (beats) page.beat();
    const auto message = page.hear(0.05);
    if (!message || message->image) continue;
    Json json = Json::parse(message->content);
    if (json["kind"] == kind) return json;
  }
  FAIL("no " << kind << " was heard");
  return {};
}

Json asked(PageClient& page, const Json& message) {
  page.say(message);
  for (;;) {
    Json answer = heard(page, "answer");
    if (answer["to"] == message["do"]) return answer;
  }
}

Json state_of(PageClient& page) {
  page.want("state");
  return heard(page, "state");
}

void beat_until(PageClient& page, const Console& console, Mode mode) {
  for (int i = 0; i < static_cast<int>(kPatience_s / 0.05) && console.state().mode != mode; ++i) {
    page.beat();
    page.hear(0.05);
  }
  REQUIRE(console.state().mode == mode);
}

}  // namespace

TEST_CASE("one page operates, the others watch, and everybody may stop") {
  const Room room;
  PageClient first(room.console->port()), second(room.console->port());
  const Json hello = heard(first, "hello");
  CHECK(hello["controllers"][0] == "baseline");
  CHECK(hello["events"].size() >= 1);
  CHECK(asked(first, {{"do", "operate"}})["ok"] == true);
  CHECK(asked(second, {{"do", "arm"}})["ok"] == false);
  CHECK(room.console->state().mode == Mode::kDisarmed);
  CHECK(asked(first, {{"do", "arm"}})["ok"] == true);
  CHECK(room.console->state().mode == Mode::kArmed);
  CHECK(state_of(first)["you_operate"] == true);
  CHECK(state_of(second)["you_operate"] == false);
  CHECK(asked(second, {{"do", "stop"}, {"by", "space"}})["ok"] == true);
  Room::reach([&] { return room.console->state().mode == Mode::kStopped; });
  const Json stopped = state_of(second);
  CHECK_THAT(stopped["reason"].get<std::string>(), Catch::Contains("said stop (space)"));
  CHECK(asked(first, {{"do", "rearm"}, {"reason", "something else"}})["ok"] == false);
  CHECK(asked(first, {{"do", "rearm"}, {"reason", stopped["reason"]}})["ok"] == true);

  second.say({{"do", "operate"}});
  Room::reach([&] { return !state_of(first)["asking"].is_null(); });
  CHECK(state_of(first)["asking_left_s"] > 10.0);
  first.say({{"do", "yield"}});
  Room::reach([&] { return state_of(second)["you_operate"] == true; });
  CHECK(asked(first, {{"do", "disarm"}})["ok"] == false);
  CHECK(asked(second, {{"do", "disarm"}})["ok"] == true);
  room.has_on_record("operates: page " + hello["you"].dump() + " handed over");
}

TEST_CASE("a path that is drawn is shown, followed, recorded, and played again") {
  const Room room;
  PageClient page(room.console->port());
  CHECK(asked(page, {{"do", "operate"}})["ok"] == true);
  page.say({{"do", "draw"}, {"csv", "x_m,y_m\n0,0\n0.5,0\n"}});
  const Json far = heard(page, "plan");
  CHECK(far["ok"] == false);
  CHECK_THAT(far["text"].get<std::string>(), Catch::Contains("outside the dish"));
  CHECK(asked(page, {{"do", "follow"}})["ok"] == false);
  page.say({{"do", "draw"}, {"csv", "x_m,y_m\nnonsense\n"}});
  CHECK(heard(page, "plan")["ok"] == false);
  page.say({{"do", "draw"}, {"csv", "x_m,y_m\n0,0\n0.004,0\n"}});
  const Json plan = heard(page, "plan");
  CHECK(plan["ok"] == true);
  CHECK(plan["length_mm"].get<double>() == Approx(4.0));
  CHECK_THAT(asked(page, {{"do", "follow"}})["text"].get<std::string>(), Catch::Contains("arm it first"));
  CHECK(asked(page, {{"do", "arm"}})["ok"] == true);
  CHECK(asked(page, {{"do", "record"}, {"on", true}})["ok"] == true);
  CHECK(asked(page, {{"do", "follow"}})["ok"] == true);
  beat_until(page, *room.console, Mode::kRunning);
  CHECK(asked(page, {{"do", "controller"}, {"name", "hand"}})["ok"] == false);
  beat_until(page, *room.console, Mode::kArmed);  // it ends with its path
  CHECK(asked(page, {{"do", "record"}, {"on", false}})["ok"] == true);
  page.say({{"do", "runs"}});
  const Json lists = heard(page, "runs");
  REQUIRE(lists["recordings"].size() == 1);
  CHECK(lists["recordings"][0]["video"].is_null());  // no camera, no film
  page.say({{"do", "replay"}, {"name", lists["recordings"][0]["name"]}});
  const Json replay = heard(page, "replay");
  CHECK(replay["samples"].size() > 5);
  CHECK(asked(page, {{"do", "replay"}, {"name", "../../etc/passwd"}})["ok"] == false);
  const std::string record = common::read_file(room.folder / "console/events.jsonl");
  CHECK(record.find("run begins: path, baseline") != std::string::npos);
  CHECK(record.find("run ended: done") != std::string::npos);
}

TEST_CASE("a page that leaves in the middle of a run stops it, and whoever comes back is told why") {
  const Room room;
  {
    PageClient page(room.console->port());
    CHECK(asked(page, {{"do", "operate"}})["ok"] == true);
    CHECK(asked(page, {{"do", "arm"}})["ok"] == true);
    CHECK(asked(page, {{"do", "draw"}, {"shape", "centre"}})["ok"] == true);
    beat_until(page, *room.console, Mode::kRunning);
  }
  Room::reach([&] { return room.console->state().mode == Mode::kStopped; });
  room.has_on_record("nobody operates: page 1 is gone");
  PageClient again(room.console->port());
  CHECK(asked(again, {{"do", "operate"}})["ok"] == true);
  CHECK_THAT(state_of(again)["reason"].get<std::string>(), Catch::Contains("silent"));
}

TEST_CASE("what cannot be is refused, and a page that talks nonsense is sent away") {
  const Room room;
  PageClient page(room.console->port());
  CHECK(asked(page, {{"do", "operate"}})["ok"] == true);
  CHECK_THAT(asked(page, {{"do", "go"}, {"to", {0.5, 0.5}}})["text"].get<std::string>(),
             Catch::Contains("not calibrated"));
  CHECK(asked(page, {{"do", "job"}, {"verb", "format the disk"}})["ok"] == false);
  CHECK(asked(page, {{"do", "answer"}, {"yes", true}})["ok"] == false);
  page.say({{"do", "launch"}});
  CHECK(heard(page, "bye", false)["text"].get<std::string>().find("not known") != std::string::npos);
  CHECK_THROWS_AS(
      [&] {
        for (int i = 0; i < 1000; ++i) page.hear(0.05);
      }(),
      common::IoError);
}

TEST_CASE("two consoles cannot have one port, and one folder that cannot be written is told") {
  const Room room;
  console::ConsoleParts parts;
  parts.bench.sources = {experiments::baseline_source({})};
  parts.bench.connect = []() -> std::unique_ptr<session::RigSession> {
    throw common::HardwareError("none here");
  };
  parts.folder = room.folder / "second";
  parts.port = room.console->port();
  CHECK_THROWS_AS(Console(parts), common::IoError);
  parts.port = 0;
  parts.folder = "/proc/nowhere";
  CHECK_THROWS_AS(Console(parts), common::IoError);
}

TEST_CASE("a console ends in the middle of whatever its pages ask for") {
  for (int round = 0; round < 5; ++round) {
    Room room;
    PageClient page(room.console->port());
    CHECK(asked(page, {{"do", "operate"}})["ok"] == true);
    CHECK(asked(page, {{"do", "arm"}})["ok"] == true);
    CHECK(asked(page, {{"do", "draw"}, {"shape", "centre"}})["ok"] == true);
    beat_until(page, *room.console, Mode::kRunning);
    std::thread asks([&] {
      try {
        for (;;) {
          page.want("state");
          page.say({{"do", "runs"}});
          page.beat();
          page.hear(0.002);
        }
      } catch (const common::IoError&) {  // the console is gone
      }
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    room.console.reset();
    asks.join();
    const std::string record = common::read_file(room.folder / "console/events.jsonl");
    CHECK(record.find("the console ends") != std::string::npos);
    CHECK(record.find("coils off, as measured") != std::string::npos);
  }
}
