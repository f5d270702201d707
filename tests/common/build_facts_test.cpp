#include "lodestone/common/build_facts.h"

#include <catch2/catch.hpp>

using namespace lodestone::common;

TEST_CASE("a manifest says when, where and by what build it was made") {
  const Json facts = build_and_host_facts();
  for (const char* key : {"lodestone", "git_commit", "compiler", "host", "processor", "time_utc"}) {
    CAPTURE(key);
    CHECK_FALSE(facts.at(key).get<std::string>().empty());
  }
  CHECK(facts.at("processors").get<int>() > 0);
  const std::string now = utc_now();
  REQUIRE(now.size() == std::string("2024-05-31T12:00:00Z").size());
  CHECK(now[10] == 'T');
  CHECK(now.back() == 'Z');
}
