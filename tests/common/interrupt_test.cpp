#include "lodestone/common/interrupt.h"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <string>
#include <thread>

#include "lodestone/common/error.h"

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

/// Uses up the stack.
int overflow(int depth) {
  if (depth < 0) return 0;
  volatile char room[4096];
  room[0] = static_cast<char>(depth);
  return overflow(depth + 1) + room[0];
}

}  // namespace

TEST_CASE("a stack overflow still switches off") {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGSEGV, SIG_DFL);
    stack_t none{};
    none.ss_flags = SS_DISABLE;
    sigaltstack(&none, nullptr);  // Catch's
    common::SignalSafeStop words(ends[1], {'o', 'f', 'f'});
    _exit(overflow(0) == 1 ? 1 : 0);
  }
  close(ends[1]);
  char text[4] = {};
  CHECK(read(ends[0], text, sizeof text) == 3);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  CHECK(WIFSIGNALED(status));
}

// Two threads write pulses as fast as they can; a signal says its bytes once, and they stay the last ones.
TEST_CASE("nothing follows what a signal says to a device") {
  for (int run = 0; run < 20; ++run) {
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    const pid_t child = fork();
    if (child == 0) {
      std::signal(SIGUSR1, SIG_DFL);
      common::SignalSafeStop words(ends[1], {'o', 'f', 'f'});
      const auto pulses = [&] {
        try {
          for (;;) {
            const common::DeviceWrite writing;
            if (write(ends[1], "on!", 3) != 3) return;
          }
        } catch (const common::Interrupted&) {
          pause();
        }
      };
      std::thread other(pulses);
      std::thread killer([] {
        usleep(3000);
        kill(getpid(), SIGUSR1);
      });
      pulses();
      _exit(0);
    }
    close(ends[1]);
    std::string said;
    char text[4096];
    for (ssize_t count = 0; (count = read(ends[0], text, sizeof text)) > 0;)
      said.append(text, static_cast<std::size_t>(count));
    close(ends[0]);
    waitpid(child, nullptr, 0);
    REQUIRE(said.size() > 3);
    CHECK(said.substr(said.size() - 3) == "off");
    CHECK(said.find("off") == said.size() - 3);
  }
}

TEST_CASE("a program that a signal ends still says its last words") {
  for (const int signal_number :
       {SIGHUP, SIGABRT, SIGQUIT, SIGXFSZ, SIGXCPU, SIGALRM, SIGUSR1, SIGUSR2, SIGPIPE}) {
    const auto [said, status] = last_words_of_child({signal_number});
    CAPTURE(signal_number);
    CHECK(said == "off");
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == signal_number);
  }
  CHECK(last_words_of_child({SIGINT}).first.empty());  // the first one only asks
  CHECK(last_words_of_child({SIGINT, SIGINT}).first == "off");
}
