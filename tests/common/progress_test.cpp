#include "lodestone/common/progress.h"

#include <catch2/catch.hpp>

#include "common/captured_stderr.h"

using namespace lodestone;

TEST_CASE("progress that is no terminal's is a plain line now and then, and one at the end") {
  const std::string text = tests::captured_stderr([] {
    common::Progress progress("training", 200);
    for (int step = 0; step <= 100; ++step) progress.update(step);
    progress.finish("loss 0.5");
    progress.finish("again");
  });
  CHECK_THAT(text, Catch::StartsWith("training  50 %  took 0 s  loss 0.5\n"));
  CHECK(text.find("again") == std::string::npos);
}
