#include "lodestone/console/session_log.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;
using console::BenchEvent;
using console::SessionLog;

TEST_CASE("what happens is on disk at once, and later pages are told the last of it") {
  const tests::TemporaryFolder folder;
  const std::string place = folder.path() + "/a/b";
  {
    SessionLog log(place);
    const common::Json first = log.add({BenchEvent::Level::kStop, 1.5, "stop: \"why\"\n"});
    CHECK(first["level"] == "stop");
    CHECK_FALSE(first["utc"].get<std::string>().empty());
    const std::string line = common::read_file(place + "/events.jsonl");
    CHECK(common::Json::parse(line) == first);
    for (std::size_t i = 0; i < SessionLog::kKept; ++i) log.add({BenchEvent::Level::kInfo, 2.0, "more"});
    CHECK(log.last().size() == SessionLog::kKept);
    CHECK(log.last()[0]["text"] == "more");
  }
  SessionLog again(place);
  again.add({BenchEvent::Level::kWarning, 0.0, "\xff"});
  const std::string all = common::read_file(place + "/events.jsonl");
  CHECK(std::count(all.begin(), all.end(), '\n') == SessionLog::kKept + 2);
  CHECK_THROWS_AS(SessionLog("/proc/nowhere"), common::IoError);
}
