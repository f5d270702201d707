#include "lodestone/experiments/log_queue.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <future>

#include "exports/mcap_file.h"
#include "lodestone/common/error.h"
#include "temporary_folder.h"

using namespace lodestone;
using experiments::LogQueue;
using tests::TemporaryFolder;

namespace {

LogQueue::Entry event(std::uint64_t second) {
  return [second](exports::RigLog& log) {
    log.event(second * 1'000'000'000, exports::LogLevel::kInfo, "event " + std::to_string(second));
  };
}

}  // namespace

TEST_CASE("a log that is written in the background is the one that is written at once") {
  const TemporaryFolder folder;
  for (const auto& [name, writes] : {std::pair("at_once", LogQueue::Writes::kAtOnce),
                                     std::pair("background", LogQueue::Writes::kInBackground)}) {
    LogQueue queue(folder / name, {{"verb", "test"}}, writes);
    for (std::uint64_t second = 0; second < 50; ++second) queue.tell(event(second));
    queue.finish();
  }
  CHECK(common::read_file(folder / "at_once") == common::read_file(folder / "background"));
  CHECK(tests::mcap_messages(folder / "background").at("/log").size() == 50);
}

TEST_CASE("who tells the log something does not wait for the disk, and is told when it falls behind") {
  const TemporaryFolder folder;
  LogQueue queue(folder / "log", {}, LogQueue::Writes::kInBackground);
  std::promise<void> disk;
  queue.tell([wait = disk.get_future().share()](exports::RigLog&) { wait.wait(); });
  CHECK_FALSE(queue.behind());
  for (std::uint64_t second = 0; second < 64; ++second) queue.tell(event(second));  // none of them waits
  CHECK(queue.behind());
  disk.set_value();
  queue.finish();
  CHECK_FALSE(queue.behind());
  CHECK(tests::mcap_messages(folder / "log").at("/log").size() == 64);
}

TEST_CASE("what a write has failed by is told to who tells the next thing, and at the end") {
  const TemporaryFolder folder;
  for (const auto writes : {LogQueue::Writes::kAtOnce, LogQueue::Writes::kInBackground}) {
    LogQueue queue(folder / "log", {}, writes);
    const auto full = [](exports::RigLog&) { throw common::IoError("No space left on device"); };
    if (writes == LogQueue::Writes::kAtOnce)
      CHECK_THROWS_WITH(queue.tell(full), "No space left on device");
    else
      queue.tell(full);
    bool touched = false;
    const auto tell = [&] {
      for (;;) queue.tell([&touched](exports::RigLog&) { touched = true; });
    };
    CHECK_THROWS_AS(tell(), common::IoError);
    CHECK_THROWS_WITH(queue.finish(), "No space left on device");
    CHECK_FALSE(touched);
  }
}

TEST_CASE("a log that goes without its end has it nevertheless, and a file that cannot be begun is refused") {
  const TemporaryFolder folder;
  { LogQueue(folder / "log", {}, LogQueue::Writes::kInBackground).tell(event(1)); }
  CHECK(tests::mcap_messages(folder / "log").at("/log").size() == 1);
  CHECK_THROWS_AS(LogQueue(folder / "none/log", {}, LogQueue::Writes::kAtOnce), common::IoError);
  std::filesystem::create_symlink("/dev/full", folder / "full");
  CHECK_THROWS_WITH(LogQueue(folder / "full", {}, LogQueue::Writes::kInBackground),
                    Catch::Contains("No space left on device"));
}
