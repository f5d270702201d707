#include "lodestone/common/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "lodestone/common/clock.h"

namespace lodestone::common {
namespace {

constexpr double kTerminalPeriod_s = 0.2;
constexpr double kPlainPeriod_s = 10.0;
constexpr int kBarWidth = 24;

std::string duration_text(double seconds) {
  const int whole = static_cast<int>(seconds + 0.5);
  if (whole >= 3600) return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
  if (whole >= 60) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} s", whole);
}

}  // namespace

Progress::Progress(std::string label, std::int64_t total)
    : label_(std::move(label)),
      total_(std::max<std::int64_t>(total, 1)),
      start_s_(SteadyClock().now_s()),
      terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (!finished_ && terminal_ && drawn_s_ > 0.0) std::fputc('\n', stderr);
}

void Progress::update(std::int64_t done, const std::string& note) {
  if (first_ < 0) first_ = done;  // a resumed run starts in the middle
  done_ = done;
  const double now_s = SteadyClock().now_s();
  if (now_s - std::max(drawn_s_, terminal_ ? -1e9 : start_s_) <
      (terminal_ ? kTerminalPeriod_s : kPlainPeriod_s))
    return;
  drawn_s_ = now_s;
  draw(note, false);
}

void Progress::finish(const std::string& note) {
  if (finished_) return;
  finished_ = true;
  draw(note, true);
}

void Progress::draw(const std::string& note, bool last) {
  const double elapsed_s = SteadyClock().now_s() - start_s_;
  const double fraction = std::clamp(static_cast<double>(done_) / static_cast<double>(total_), 0.0, 1.0);
  std::string time = "took " + duration_text(elapsed_s);
  if (!last) {
    const auto gained = static_cast<double>(done_ - std::max<std::int64_t>(first_, 0));
    time = gained > 0.0 ? duration_text(elapsed_s / gained * static_cast<double>(total_ - done_)) + " left"
                        : "estimating";
  }
  const std::string tail = note.empty() ? "" : "  " + note;
  if (terminal_) {
    const int filled = static_cast<int>(fraction * kBarWidth);
    std::string bar(static_cast<std::size_t>(kBarWidth), '.');
    std::fill(bar.begin(), bar.begin() + filled, '#');
    std::fprintf(stderr, "\r\033[K%s [%s] %3.0f %%  %s%s%s", label_.c_str(), bar.c_str(), 100.0 * fraction,
                 time.c_str(), tail.c_str(), last ? "\n" : "");
  } else {
    std::fprintf(stderr, "%s %3.0f %%  %s%s\n", label_.c_str(), 100.0 * fraction, time.c_str(), tail.c_str());
  }
  std::fflush(stderr);
}

}  // namespace lodestone::common
