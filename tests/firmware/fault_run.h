#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "bus_rig.h"

namespace lodestone::tests {

/// A seeded run of a rig (BusRig, or one that looks like it) under faults: a host that pulses any axis at
/// random, what the faults do to it, and a watch over the true current of every coil.
template <class Rig>
class FaultRun {
 public:
  using Way = BusRig::Way;
  using Bytes = std::vector<BusRig::Arriving>;
  static constexpr double kOffWithin_s = 0.6;
  static constexpr double kOn_A = 0.05;
  static constexpr double kBusy_s = 1.6;  ///< the host pulses until then

  Rig rig;

  explicit FaultRun(std::uint64_t seed) : allowed_until_s_(rig.current_A.size(), 0.0), random_(seed) {
    rig.watch = [this] { look(); };
  }

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double any_size(double low, double high) { return low * std::pow(high / low, uniform(0.0, 1.0)); }
  int coils() const { return static_cast<int>(rig.current_A.size()); }
  int any(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }

  double now_s() const { return rig.now_s; }
  void at(double time_s, std::function<void()> event) { events_.emplace(time_s, std::move(event)); }
  /// From now on every byte of that way passes `change`, until then.
  void attack(Way way, double until_s, std::function<Bytes(std::uint8_t)> change) {
    attacks_.push_back({way, until_s, std::move(change)});
    rig.attack = [this](Way of, std::int64_t, std::uint8_t byte) { return attacked(of, byte); };
  }
  /// Something has happened that ends every pulse.
  void pulses_end() { allowed_until_s_.assign(allowed_until_s_.size(), now_s() + kOffWithin_s); }
  /// Something has happened that brings current by itself.
  void current_comes() { caused_until_s_ = now_s() + kOffWithin_s; }
  /// What the host does wrong.
  double silent_from_s = 1e9, back_to_back_from_s = 1e9, flood_from_s = 1e9, hello_at_s = 1e9;

  /// How long current flowed that no pulse and no cause of the last 0.6 s accounts for.
  double drive() {
    connect();
    wait(0.4);
    while (now_s() < kBusy_s) {
      if (now_s() < back_to_back_from_s) wait(uniform(0.01, 0.25));
      if (silent()) break;
      if (now_s() >= flood_from_s) flood();
      if (now_s() >= hello_at_s) {
        hello_at_s = 1e9;
        connect();
      }
      if (!silent()) pulse();
      if (chance(0.15)) {
        wait(uniform(0.0, 0.2));
        if (!silent() && answered(wire::kStop, {})) pulses_end();
      }
    }
    if (chance(0.5) && !silent() && answered(wire::kStop, {})) pulses_end();
    wait(std::max(0.0, *std::max_element(allowed_until_s_.begin(), allowed_until_s_.end()) - now_s()) + 0.6);
    return unaccounted_s_;
  }

 private:
  using Times = std::vector<double>;  // [coils]
  struct Attack {
    Way way;
    double until_s;
    std::function<Bytes(std::uint8_t)> change;
  };

  Bytes attacked(Way of, std::uint8_t byte) {
    Bytes arriving = {{byte, 0.0}};
    for (const Attack& attack : attacks_) {
      if (attack.way != of || now_s() > attack.until_s) continue;
      Bytes changed;
      for (const BusRig::Arriving& one : arriving)
        for (const BusRig::Arriving& other : attack.change(one.byte))
          changed.push_back({other.byte, one.later_s + other.later_s});
      arriving = std::move(changed);
    }
    return arriving;
  }
  void look() {
    const bool closed = rig.contactor();
    if (closed && !closed_ && closings_left_-- > 0) current_comes();
    closed_ = closed;
    for (std::size_t coil = 0; coil < allowed_until_s_.size(); ++coil)
      if (std::abs(rig.current_A[coil]) > kOn_A &&
          now_s() > std::max(allowed_until_s_[coil], caused_until_s_))
        unaccounted_s_ += BusRig::kStep_s;
    while (!events_.empty() && events_.begin()->first <= now_s()) {
      const std::function<void()> event = std::move(events_.begin()->second);
      events_.erase(events_.begin());
      event();
    }
  }

  bool silent() const { return now_s() >= silent_from_s; }
  /// A pulse that the protocol lets a silent host have ends as any; a longer one may last no longer than
  /// after any other cause.
  void fall_silent() {
    silent_from_s = now_s();
    for (double& until_s : allowed_until_s_)
      if (until_s - kOffWithin_s > heard_s_ + 1e-3 * wire::kHostSilenceMs) until_s = heard_s_ + kOffWithin_s;
  }
  /// The host waits and now and then looks at the status, so that it counts as alive.
  void wait(double seconds) {
    const double end_s = now_s() + seconds;
    while (now_s() < end_s) {
      rig.run(std::min(end_s - now_s(), 0.1));
      if (silent()) {
        fall_silent();
        rig.run(end_s - now_s());
        return;
      }
      if (now_s() < end_s) ask(wire::kStatus, {}, false);
    }
  }
  std::uint8_t ask(std::uint8_t type, const std::vector<std::uint8_t>& body, bool again) {
    heard_s_ = now_s();
    return rig.ask(type, body, again);
  }
  /// Asks up to three times. The type of the reply, 0: none.
  std::uint8_t persist(std::uint8_t type, const std::vector<std::uint8_t>& body) {
    for (int tries = 0; tries < 3 && !silent(); ++tries) {
      const std::uint8_t reply = ask(type, body, tries > 0);
      if (reply != 0) return reply;
      rig.run(0.05);
    }
    return 0;
  }
  bool answered(std::uint8_t type, const std::vector<std::uint8_t>& body) {
    return persist(type, body) == (type | wire::kReply);
  }
  void connect() {
    const auto session = static_cast<std::uint8_t>(++sessions_);
    if (answered(wire::kHello, {wire::kProtocolVersion, session, 2, 3, 4})) pulses_end();
    ++closings_left_;
    answered(wire::kConfigure, rig.limits());
  }
  void pulse() {
    const std::size_t all = allowed_until_s_.size();
    std::vector<int> current_mA(all, 0);
    for (std::size_t axis = 0; axis < all; axis += 2)
      if (chance(0.7))
        current_mA[axis + static_cast<std::size_t>(any(2))] =
            static_cast<int>(uniform(-15000, 15000) * (chance(0.5) ? 0.4 : 1.0));
    const bool is_long = chance(0.2);
    const auto length_ms = static_cast<std::uint16_t>(is_long ? uniform(500, 2000) : uniform(5, 400));
    const double longest_s = 1e-3 * length_ms + kOffWithin_s;
    const Times before_s = allowed_until_s_;
    for (std::size_t coil = 0; coil < all; ++coil)  // it may arrive although its answer does not
      if (current_mA[coil] != 0)
        allowed_until_s_[coil] = std::max(before_s[coil], now_s() + 0.15 + longest_s);
    const std::uint8_t reply = persist(wire::kPulse, rig.pulse_body(current_mA, length_ms));
    if (reply == (wire::kPulse | wire::kReply))  // what was before it has ended
      for (std::size_t coil = 0; coil < all; ++coil)
        allowed_until_s_[coil] =
            current_mA[coil] != 0 ? now_s() + longest_s : std::min(before_s[coil], now_s() + kOffWithin_s);
    if (reply != wire::kRefused) return;
    allowed_until_s_ = before_s;
    const std::uint8_t reason = rig.replies.back().body[1];
    if (reason == wire::kRefusedSession || reason == wire::kRefusedSequence) connect();
    if (reason == wire::kRefusedFault && clears_ < 2 && chance(0.5)) {
      ++clears_;
      ++closings_left_;
      persist(wire::kClear, {});
    }
    wait(0.1);
  }
  void flood() {
    flood_from_s = 1e9;
    const double end_s = now_s() + uniform(0.01, 0.3);
    const bool noise = chance(0.5);
    while (now_s() < end_s) {
      for (int i = 0; i < 4; ++i)
        if (noise)
          rig.from_host(static_cast<std::uint8_t>(any(256)));
        else
          ask(wire::kStatus, {}, false);
      rig.step();
    }
  }

  std::multimap<double, std::function<void()>> events_;
  std::vector<Attack> attacks_;
  Times allowed_until_s_;  ///< current in each coil, by its pulses
  std::mt19937_64 random_;
  double caused_until_s_ = 0.0;  ///< current in any, by other causes
  double unaccounted_s_ = 0.0;
  double heard_s_ = 0.0;
  bool closed_ = false;    ///< what the contactor is told
  int closings_left_ = 0;  ///< one for each CONFIGURE and CLEAR
  int sessions_ = 0;
  int clears_ = 0;
};

}  // namespace lodestone::tests
