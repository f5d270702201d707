#include "lodestone/common/interrupt.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstring>

#include "lodestone/common/error.h"

namespace lodestone::common {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;  // a signal handler can reach nothing else

constexpr std::size_t kMostWords = 64;
struct Slot {
  std::atomic<bool> taken{false};
  std::atomic<int> descriptor{-1};  // below 0: nothing to say
  std::size_t count = 0;
  std::array<std::uint8_t, kMostWords> bytes{};
};
std::array<Slot, 8> g_slots;

void say(const Slot& slot) {
  const int descriptor = slot.descriptor;
  if (descriptor < 0) return;
  const ssize_t written = write(descriptor, slot.bytes.data(), slot.count);
  static_cast<void>(written);  // there is nobody left to tell
}

extern "C" void on_fatal_signal(int signal_number) {
  for (const Slot& slot : g_slots) say(slot);
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

extern "C" void on_signal(int signal_number) {
  if (g_interrupted != 0) {
    for (const Slot& slot : g_slots) say(slot);
    _exit(128 + signal_number);
  }
  g_interrupted = 1;
}

/// Once; handlers that somebody else has set stay.
void install_fatal_handlers() {
  static const bool installed = [] {
    for (const int signal_number : {SIGHUP, SIGQUIT, SIGILL, SIGABRT, SIGBUS, SIGFPE, SIGSEGV}) {
      struct sigaction before {};
      sigaction(signal_number, nullptr, &before);
      if (before.sa_handler != SIG_DFL) continue;
      struct sigaction action {};
      action.sa_handler = on_fatal_signal;
      sigemptyset(&action.sa_mask);
      sigaction(signal_number, &action, nullptr);
    }
    return true;
  }();
  static_cast<void>(installed);
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

SignalSafeStop::SignalSafeStop(int descriptor, std::vector<std::uint8_t> bytes) : slot_(-1) {
  LODESTONE_CHECK(bytes.size() <= kMostWords, "at most 64 bytes");
  install_fatal_handlers();
  for (std::size_t i = 0; i < g_slots.size(); ++i) {
    if (g_slots[i].taken.exchange(true)) continue;
    slot_ = static_cast<int>(i);
    g_slots[i].count = bytes.size();
    std::copy(bytes.begin(), bytes.end(), g_slots[i].bytes.begin());
    g_slots[i].descriptor = descriptor;
    return;
  }
  LODESTONE_CHECK(false, "at most eight at a time");
}

SignalSafeStop::~SignalSafeStop() {
  g_slots[static_cast<std::size_t>(slot_)].descriptor = -1;
  g_slots[static_cast<std::size_t>(slot_)].taken = false;
}

}  // namespace lodestone::common
