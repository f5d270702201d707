#include "lodestone/common/shell.h"

#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("a quoted word arrives as it was, and a command says how it ended") {
  for (const char* text : {"plain", "", "it's", "a \"b\" $HOME `x` \\ *", "two\nlines"}) {
    const common::CommandResult said = common::run_command({"printf", "%s", text});
    CHECK(said.output == text);
    CHECK(said.exit_code == 0);
  }
  const common::CommandResult failed = common::run_command({"sh", "-c", "echo out; echo err >&2; exit 3"});
  CHECK(failed.output == "out\nerr\n");
  CHECK(failed.exit_code == 3);
  CHECK(common::run_command({"sh", "-c", "kill -9 $$"}).exit_code == 137);
  CHECK(common::run_command({"there-is-no-such-program"}).exit_code == 127);
}
