#include "lodestone/common/interrupt.h"

#include <unistd.h>
#include <csignal>

namespace lodestone::common {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;  // a signal handler can reach nothing else

extern "C" void on_signal(int signal_number) {
  if (g_interrupted != 0) _exit(128 + signal_number);
  g_interrupted = 1;
}

}  // namespace

void install_interrupt_handler() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() noexcept { return g_interrupted != 0; }

}  // namespace lodestone::common
