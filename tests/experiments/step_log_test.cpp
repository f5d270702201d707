#include "lodestone/experiments/step_log.h"

#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <ctime>
#include <fstream>

#include "common/event_file.h"
#include "control/fakes.h"
#include "exports/mcap_file.h"
#include "temporary_folder.h"

using namespace lodestone;
using namespace lodestone::tests;
using experiments::StepLog;

namespace {

/// A log of a bench whose time does not pass by itself.
struct LoggedBench {
  explicit LoggedBench(const std::string& path)
      : supervisor(coils, {}, rig, clock), log(path, {}, {{"task", "point"}}, {clock, supervisor, nullptr}) {}

  /// A step at the bench's present time; with a pose, the coils get a pulse after it.
  void step(bool seen, const std::string& reason = "") {
    control::StepRecord record;
    record.time_s = clock.now_s() - 100.0;
    record.estimate.valid = seen;
    record.estimate.reason = reason;
    record.estimate.pose = {0.01, 0.0, 0.5};
    record.estimate.stamp_s = clock.now_s();
    record.current_A = {1.0, 0.0, 0.0, 0.0};
    log.step(record, {geometry::Pose2{0.0, 0.0, 0.0}, std::nullopt});
    supervisor.begin_step(clock.now_s());
    supervisor.observe(record.estimate);
    if (seen) supervisor.apply({record.current_A, 0.1});
    clock.sleep_until(clock.now_s() + 0.3);
  }

  ManualClock clock;
  RecordingCoils coils;
  physics::RigDescription rig;
  safety::Supervisor supervisor;
  StepLog log;
};

/// Files cannot grow beyond this while it lives.
class SmallFiles {
 public:
  explicit SmallFiles(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit = {bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~SmallFiles() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

}  // namespace

TEST_CASE("steps are logged at the rig's own time where that does not pass by itself, the same every time") {
  const TemporaryFolder folder;
  for (const char* name : {"one", "other"}) {
    LoggedBench bench(folder / name);
    for (int i = 0; i < 5; ++i) bench.step(true);
    bench.log.finish();
  }
  CHECK(common::read_file(folder / "one") == common::read_file(folder / "other"));
  const auto messages = mcap_messages(folder / "one");
  CHECK(messages.at("/step").size() == 5);
  CHECK(messages.at("/coils/pulse").size() == 5);
  CHECK(messages.at("/coils/status").size() == 4);  // nothing is reported before the first pulse
  CHECK(messages.at("/needle/pose").size() == 5);
  CHECK(messages.count("/needle/truth") == 0);
  CHECK(messages.count("/camera/image") == 0);
  const Message time(Message(messages.at("/step").at(1)).bytes.at(1));
  CHECK(time.numbers.at(1) == 100);
  CHECK(time.numbers.at(2) == 300'000'000);
}

TEST_CASE("no pulse is logged while nothing is seen, and faults that stop the coils are") {
  const TemporaryFolder folder;
  const std::string path = folder / "log";
  LoggedBench bench(path);
  bench.step(true);
  bench.step(false, "nothing is seen");
  bench.step(true);
  bench.coils.state.faults = {"over-temperature"};
  CHECK_THROWS_AS(bench.step(true), common::HardwareError);
  CHECK_THROWS_AS(bench.step(true), common::HardwareError);
  bench.log.finish();
  const auto messages = mcap_messages(path);
  CHECK(messages.at("/step").size() == 5);
  CHECK(messages.at("/coils/pulse").size() == 4);
  CHECK(Message(messages.at("/log").back()).bytes.at(3) == "the coils report: over-temperature");
}

TEST_CASE("on a rig whose time passes by itself the log has the wall clock's time", "[clock]") {
  const TemporaryFolder folder;
  common::SteadyClock clock;
  RecordingCoils coils;
  const physics::RigDescription rig;
  const safety::Supervisor supervisor(coils, {}, rig, clock);
  StepLog log(folder / "log", {}, {}, {clock, supervisor, nullptr});
  log.step({}, {});
  log.finish();
  const Message time(Message(mcap_messages(folder / "log").at("/step").at(0)).bytes.at(1));
  CHECK(std::abs(static_cast<double>(time.numbers.at(1)) - static_cast<double>(std::time(nullptr))) < 600.0);
}

TEST_CASE("a disk that fills while steps are logged in the background is told at one of the next steps",
          "[clock]") {
  const TemporaryFolder folder;
  common::SteadyClock clock;
  RecordingCoils coils;
  const physics::RigDescription rig;
  const safety::Supervisor supervisor(coils, {}, rig, clock);
  StepLog log(folder / "log", {}, {}, {clock, supervisor, nullptr});
  const SmallFiles small(20'000);
  const auto drive = [&] {
    for (;;) {
      log.step({}, {});
      log.flush();
    }
  };
  CHECK_THROWS_WITH(drive(), Catch::Contains("File too large"));
  CHECK_THROWS_WITH(log.finish(), Catch::Contains("File too large"));
}

TEST_CASE("a log has a name that no other has") {
  const TemporaryFolder folder;
  CHECK(experiments::fresh_log(folder / "session-0") == folder / "session-0.mcap");
  std::ofstream(folder / "session-0.mcap").put('x');
  CHECK(experiments::fresh_log(folder / "session-0") == folder / "session-0-2.mcap");
  std::ofstream(folder / "session-0-2.mcap").put('x');
  CHECK(experiments::fresh_log(folder / "session-0") == folder / "session-0-3.mcap");
}
