#include "lodestone/common/log.h"

#include <catch2/catch.hpp>

#include "common/captured_stderr.h"

using namespace lodestone;

TEST_CASE("messages are one line each, with their level, on standard error") {
  const std::string text = tests::captured_stderr([] {
    common::log_info("all is well");
    common::log_warning("the coils are {warm}");  // braces are no format
  });
  CHECK_THAT(text, Catch::Contains("info all is well\n"));
  CHECK_THAT(text, Catch::Contains("warning the coils are {warm}\n"));
}
