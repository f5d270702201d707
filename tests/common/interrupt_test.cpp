#include "lodestone/common/interrupt.h"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <string>

using namespace lodestone;

namespace {

/// What a child says on a pipe before `signals` end it, and how it ended.
std::pair<std::string, int> last_words_of_child(const std::vector<int>& signals) {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    // Catch's own handlers are not what is tested.
    for (const int signal_number : signals) std::signal(signal_number, SIG_DFL);
    common::install_interrupt_handler();
    common::SignalSafeStop words(ends[1], {'o', 'f', 'f'});
    for (const int signal_number : signals) std::raise(signal_number);
    _exit(0);
  }
  close(ends[1]);
  char text[16];
  std::string said;
  for (ssize_t count = 0; (count = read(ends[0], text, sizeof text)) > 0;)
    said.append(text, static_cast<std::size_t>(count));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return {said, status};
}

}  // namespace

TEST_CASE("a program that a signal ends still says its last words") {
  for (const int signal_number : {SIGHUP, SIGABRT, SIGQUIT}) {
    const auto [said, status] = last_words_of_child({signal_number});
    CAPTURE(signal_number);
    CHECK(said == "off");
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == signal_number);
  }
  CHECK(last_words_of_child({SIGINT}).first.empty());  // the first one only asks
  CHECK(last_words_of_child({SIGINT, SIGINT}).first == "off");
}
