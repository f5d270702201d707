#include "lodestone/common/interrupt.h"

#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <vector>

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

std::atomic<bool> g_spoken{false};       // a signal has switched the devices off, or is about to
std::atomic<int> g_writes{0};            // DeviceWrites alive
thread_local volatile int t_writes = 0;  // of them in this thread
std::atomic<bool> g_raw{false};
termios g_terminal_before{};

void say(const Slot& slot) {
  const int descriptor = slot.descriptor;
  if (descriptor < 0) return;
  const ssize_t written = write(descriptor, slot.bytes.data(), slot.count);
  static_cast<void>(written);  // there is nobody left to tell
}

/// Switches the devices off, after whatever is being written to them, and puts the terminal back.
void speak() {
  g_spoken = true;
  // A write of this very thread will never end; it is cut short, and the devices drop half a message.
  for (int wait = 0; wait < 50 && g_writes > t_writes; ++wait) {
    const timespec moment{0, 1000000};
    nanosleep(&moment, nullptr);
  }
  for (const Slot& slot : g_slots) say(slot);
  if (g_raw) tcsetattr(STDIN_FILENO, TCSANOW, &g_terminal_before);
}

extern "C" void on_fatal_signal(int signal_number) {
  speak();
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

extern "C" void on_signal(int signal_number) {
  if (g_interrupted != 0) {
    speak();
    _exit(128 + signal_number);
  }
  g_interrupted = 1;
}

/// A stack of its own for handlers of this thread: one that has overflowed its stack could call none.
void use_signal_stack() {
  static thread_local std::vector<char> memory;
  if (!memory.empty()) return;
  memory.resize(64 * 1024);
  stack_t stack{};
  stack.ss_sp = memory.data();
  stack.ss_size = memory.size();
  stack_t before{};
  if (sigaltstack(nullptr, &before) == 0 && (before.ss_flags & SS_DISABLE) != 0) sigaltstack(&stack, nullptr);
}

/// Once; handlers that somebody else has set stay. A file that may not grow was only an error until now.
void install_fatal_handlers() {
  static const bool installed = [] {
    for (const int signal_number :
         {SIGHUP, SIGQUIT, SIGILL, SIGABRT, SIGBUS, SIGFPE, SIGSEGV, SIGSYS, SIGPIPE, SIGALRM, SIGVTALRM,
          SIGPROF, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ, SIGPOLL}) {
      struct sigaction before {};
      sigaction(signal_number, nullptr, &before);
      if (before.sa_handler != SIG_DFL && signal_number != SIGXFSZ) continue;
      struct sigaction action {};
      action.sa_handler = on_fatal_signal;
      action.sa_flags = SA_ONSTACK;
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
  std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupted() noexcept { return g_interrupted != 0; }

SignalSafeStop::SignalSafeStop(int descriptor, std::vector<std::uint8_t> bytes) : slot_(-1) {
  LODESTONE_CHECK(bytes.size() <= kMostWords, "at most 64 bytes");
  install_fatal_handlers();
  use_signal_stack();
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

DeviceWrite::DeviceWrite() {
  ++g_writes;
  t_writes = t_writes + 1;
  if (!g_spoken) return;
  t_writes = t_writes - 1;
  --g_writes;
  throw Interrupted("a signal has switched the device off");
}

DeviceWrite::~DeviceWrite() {
  t_writes = t_writes - 1;
  --g_writes;
}

RawTerminal::RawTerminal() {
  LODESTONE_CHECK(!g_raw, "one raw terminal at a time");
  tcgetattr(STDIN_FILENO, &g_terminal_before);
  install_fatal_handlers();
  g_raw = true;
  termios raw = g_terminal_before;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
}

RawTerminal::~RawTerminal() {
  tcsetattr(STDIN_FILENO, TCSANOW, &g_terminal_before);
  g_raw = false;
}

}  // namespace lodestone::common
