#include "lodestone/imaging/quiet_stderr.h"

#include <catch2/catch.hpp>
#include <cstdio>

#include "common/captured_stderr.h"

using namespace lodestone;

TEST_CASE("what is printed on standard error while it is quiet goes nowhere, and later lines arrive") {
  const std::string heard = tests::captured_stderr([] {
    std::fprintf(stderr, "before\n");
    {
      const imaging::QuietStderr quiet;
      std::fprintf(stderr, "a library's own line\n");
    }
    std::fprintf(stderr, "after\n");
  });
  CHECK(heard == "before\nafter\n");
}
