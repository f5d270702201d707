#include "lodestone/session/driver_conformance.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "lodestone/common/clock.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/statistics.h"
#include "lodestone/rig/driver_camera.h"
#include "lodestone/rig/driver_coils.h"
#include "lodestone/session/driver_detector.h"

namespace lodestone::session {

namespace {

using common::HardwareError;
using common::Json;

constexpr double kMargin_s = 0.05;  // of this program's own
constexpr double kPulse_s = 0.3;
constexpr double kLongPulse_s = 2.0;
constexpr double kLongest_s = 9.0;   // that the firmware of the coil controller can be told
constexpr double kRefused_s = 0.02;  // of what must be refused, for drivers that do not
constexpr double kReady_s = 1.0;     // after a fault was cleared
constexpr int kPings = 100;
constexpr int kLooks = 30;

void go_on() {
  if (common::interrupted()) throw common::Interrupted("rig conform: stopped");
}

void pass(double time_s) {
  constexpr double kLook_s = 0.02;
  common::SteadyClock clock;
  const double until_s = clock.now_s() + time_s;
  for (go_on(); clock.now_s() < until_s; go_on())
    clock.sleep_until(std::min(until_s, clock.now_s() + kLook_s));
}

/// Collects what was tried; an exception is a failure.
class Items {
 public:
  bool failed() const { return !all_.empty() && !all_.back().passed; }
  void add(const std::string& what, const std::function<std::string()>& seen) {
    go_on();
    try {
      all_.push_back({what, true, seen()});
    } catch (const common::Interrupted&) {
      throw;
    } catch (const common::ConfigError&) {
      throw;  // it is not the driver that is wrong
    } catch (const std::exception& error) {
      all_.push_back({what, false, error.what()});
    }
  }
  std::vector<ConformanceItem> all() && { return std::move(all_); }

 private:
  std::vector<ConformanceItem> all_;
};

/// Times of many answers.
std::string timed(rig::DriverLink& link, const Json& request, int times) {
  const common::SteadyClock clock;
  std::vector<double> took_ms;
  for (int i = 0; i < times; ++i) {
    const double begun_s = clock.now_s();
    link.ask(request);
    took_ms.push_back(1e3 * (clock.now_s() - begun_s));
  }
  return fmt::format("{}: median {:.1f} ms, {:.1f} ms at most", link.name(), common::median(took_ms),
                     *std::max_element(took_ms.begin(), took_ms.end()));
}

class CoilsConformance {
 public:
  CoilsConformance(const OpenDriver& open, const rig::DriverConfig& config,
                   const physics::CoilsDescription& coils, double test_current_A)
      : open_(open), config_(config), coils_(coils), test_current_A_(test_current_A) {}

  std::vector<ConformanceItem> run() && {
    items_.add("answers within " + fmt::format("{:g} s", config_.reply_timeout_s), [this] {
      Line line(*this);
      return timed(line.link, {{"do", "ping"}}, kPings);
    });
    if (items_.failed()) return std::move(items_).all();
    items_.add("is off before the first pulse", [this] {
      Line line(*this);
      return check_off(line.link);
    });
    if (items_.failed()) return std::move(items_).all();
    for (std::size_t coil = 0; coil < coils_.count(); ++coil)
      items_.add("coil " + coils_.name(coil) + ": its current, no other, and an end",
                 [this, coil] { return check_coil(coil); });
    items_.add("a pulse replaces the one before", [this] { return check_replaced(); });
    items_.add("stop ends a pulse", [this] { return check_stop(); });
    items_.add("refuses more current than a coil may have", [this] {
      const double beyond_A = 1.01 * coils_.largest_A(0) + 0.1;
      return check_refused({{0, beyond_A}}, kRefused_s, "a current beyond the largest one");
    });
    items_.add("refuses a pulse that is too long", [this] {
      return check_refused({{0, asked_A(0)}}, long_s() + 1.0, "a pulse beyond max_pulse_s");
    });
    check_apart();
    items_.add("refuses what it does not know, and goes on", [this] {
      Line line(*this);
      std::string said;
      try {
        line.link.ask({{"do", "levitate"}});
      } catch (const rig::DriverRefused& refused) {
        said = refused.what();
      }
      if (said.empty()) throw HardwareError("it took a request \"levitate\" for one that it knows");
      line.link.ask({{"do", "ping"}});
      return said;
    });
    items_.add("switches off after 0.5 s of silence, and latches it", [this] { return check_silence(); });
    items_.add("switches off when its program has gone", [this] { return check_gone(); });
    return std::move(items_).all();
  }

 private:
  /// A stream of its own for each item, which ends with a stop, whatever was found out.
  struct Line {
    explicit Line(const CoilsConformance& of)
        : link(of.open_, "coils", rig::coils_hello(of.coils_, of.long_s()), of.config_.start_timeout_s,
               of.config_.reply_timeout_s) {}
    ~Line() {
      try {
        if (stops) link.stop();
      } catch (const std::exception&) {
        // it was given up
      }
    }
    rig::DriverLink link;
    bool stops = true;
  };

  /// Of the pulse that only the end of the stream ends: it must outlast the next start.
  double long_s() const { return std::min(config_.start_timeout_s + kLongPulse_s, kLongest_s); }
  double asked_A(std::size_t coil) const { return std::min(test_current_A_, coils_.largest_A(coil)); }

  void pulse(rig::DriverLink& link, const std::vector<std::pair<std::size_t, double>>& current_A,
             double duration_s) const {
    std::vector<double> all(coils_.count(), 0.0);
    for (const auto& [coil, one_A] : current_A)
      all[coil] = one_A * static_cast<double>(coils_.polarity[coil]);
    link.ask({{"do", "pulse"}, {"current_A", all}, {"duration_s", duration_s}});
  }
  rig::CoilStatus status(rig::DriverLink& link) const {
    rig::CoilStatus status = rig::coil_status(link.ask({{"do", "status"}}).content, coils_.count());
    for (std::size_t coil = 0; coil < coils_.count(); ++coil)
      status.current_A[coil] *= static_cast<double>(coils_.polarity[coil]);
    if (!status.faults.empty()) throw HardwareError("it reports a fault: " + status.faults.front());
    return status;
  }
  /// That all coils have what they were asked for.
  std::string check_currents(rig::DriverLink& link, std::size_t driven, double asked_A) const {
    const rig::CoilStatus now = status(link);
    for (std::size_t coil = 0; coil < coils_.count(); ++coil) {
      const double wants_A = coil == driven ? asked_A : 0.0;
      if (!(std::abs(now.current_A[coil] - wants_A) < std::max(rig::kDriverOff_A, 0.25 * wants_A)))
        throw HardwareError(fmt::format("coil {} has {:.2f} A, {:.2f} A were asked for", coils_.name(coil),
                                        now.current_A[coil], wants_A));
    }
    return driven < coils_.count() ? fmt::format("{:.2f} A of {:.2f} A", now.current_A[driven], asked_A)
                                   : std::string("no current");
  }
  std::string check_off(rig::DriverLink& link) const { return check_currents(link, coils_.count(), 0.0); }

  std::string check_coil(std::size_t coil) const {
    Line line(*this);
    rig::DriverLink& link = line.link;
    pulse(link, {{coil, asked_A(coil)}}, kPulse_s);
    pass(0.5 * kPulse_s);
    const std::string seen = check_currents(link, coil, asked_A(coil));
    pass(0.5 * kPulse_s + rig::kDriverOffWithin_s + kMargin_s);
    return seen + ", " + check_off(link) + " after its end";
  }

  std::string check_replaced() const {
    if (coils_.count() < 2) return "one coil only";
    Line line(*this);
    rig::DriverLink& link = line.link;
    pulse(link, {{0, asked_A(0)}}, kPulse_s);
    pass(0.3 * kPulse_s);
    pulse(link, {{1, asked_A(1)}}, kLongPulse_s);
    pass(rig::kDriverOffWithin_s + kMargin_s);
    const std::string seen = check_currents(link, 1, asked_A(1));
    link.stop();
    return seen + " in the second coil";
  }

  std::string check_stop() const {
    Line line(*this);
    rig::DriverLink& link = line.link;
    pulse(link, {{0, asked_A(0)}}, kLongPulse_s);
    pass(0.1);
    link.stop();
    pass(rig::kDriverOffWithin_s + kMargin_s);
    return check_off(link) + fmt::format(" {:g} s later", rig::kDriverOffWithin_s);
  }

  std::string check_refused(const std::vector<std::pair<std::size_t, double>>& current_A, double duration_s,
                            const std::string& what) const {
    Line line(*this);
    rig::DriverLink& link = line.link;
    try {
      pulse(link, current_A, duration_s);
    } catch (const rig::DriverRefused& refused) {
      check_off(link);
      return refused.what();
    }
    throw HardwareError("it took " + what);
  }

  void check_apart() {
    for (std::size_t one = 0; one < coils_.count(); ++one)
      for (std::size_t other = one + 1; other < coils_.count(); ++other) {
        if (!coils_.apart(one, other)) continue;
        items_.add("refuses " + coils_.name(one) + " and " + coils_.name(other) + " together",
                   [this, one, other] {
                     return check_refused({{one, asked_A(one)}, {other, asked_A(other)}}, kRefused_s,
                                          "coils that are never on together");
                   });
      }
  }

  std::string check_silence() const {
    Line line(*this);
    rig::DriverLink& link = line.link;
    pulse(link, {{0, asked_A(0)}}, kLongPulse_s);
    pass(rig::kDriverSilence_s + rig::kDriverOffWithin_s + kMargin_s);
    const rig::CoilStatus silent = rig::coil_status(link.ask({{"do", "status"}}).content, coils_.count());
    for (std::size_t coil = 0; coil < coils_.count(); ++coil)
      if (std::abs(silent.current_A[coil]) >= rig::kDriverOff_A)
        throw HardwareError(
            fmt::format("coil {} still has {:.2f} A", coils_.name(coil), silent.current_A[coil]));
    if (silent.faults.empty()) throw HardwareError("the coils are off, and it reports no fault");
    try {
      pulse(link, {{0, asked_A(0)}}, kPulse_s);
      throw HardwareError("it takes a pulse before its fault was cleared");
    } catch (const rig::DriverRefused&) {
      // as it must
    }
    link.ask({{"do", "clear"}});
    pass(kReady_s);
    pulse(link, {{0, asked_A(0)}}, kPulse_s);
    return "off; it says: " + silent.faults.front();
  }

  std::string check_gone() const {
    const common::SteadyClock clock;
    double begun_s = 0.0;
    {
      Line line(*this);
      pulse(line.link, {{0, asked_A(0)}}, long_s());
      begun_s = clock.now_s();
      pass(0.1);
      line.stops = false;
    }
    pass(rig::kDriverOffWithin_s + kMargin_s);
    Line line(*this);
    const std::string seen = check_off(line.link);
    const double back_s = clock.now_s() - begun_s;
    if (back_s >= long_s()) throw HardwareError("it was back only after the pulse would have ended");
    return seen + fmt::format(" when it is back, {:.1f} s into a pulse of {:.1f} s", back_s, long_s());
  }

  const OpenDriver& open_;
  const rig::DriverConfig& config_;
  const physics::CoilsDescription& coils_;
  double test_current_A_;
  Items items_;
};

/// Ages and rate of what a driver hands out.
class Looks {
 public:
  void add(double stamp_s) {
    const double now_s = common::SteadyClock().now_s();
    // What it takes to tell the age is no time of the thing.
    constexpr double kJitter_s = 0.02;
    if (!stamps_s_.empty() && stamp_s < stamps_s_.back() - kJitter_s)
      throw HardwareError("its time went back");
    stamps_s_.push_back(stamp_s);
    oldest_s_ = std::max(oldest_s_, now_s - stamp_s);
  }
  std::string told() const {
    constexpr double kLeast_s = 0.05;
    const double passed_s = stamps_s_.back() - stamps_s_.front();
    if (!(passed_s > kLeast_s)) throw HardwareError("all of them are of one time: what is age_s?");
    return fmt::format("{:.0f} a second, {:.0f} ms old at most",
                       static_cast<double>(stamps_s_.size() - 1) / passed_s, 1e3 * oldest_s_);
  }

 private:
  std::vector<double> stamps_s_;
  double oldest_s_ = 0.0;
};

}  // namespace

std::vector<ConformanceItem> check_coils_driver(const OpenDriver& open, const rig::DriverConfig& config,
                                                const physics::CoilsDescription& coils,
                                                double test_current_A) {
  return CoilsConformance(open, config, coils, test_current_A).run();
}

std::vector<ConformanceItem> check_sensor_driver(const OpenDriver& open, const rig::DriverConfig& config,
                                                 const physics::NeedleConfig& needle) {
  Items items;
  items.add("says where the needle is", [&] {
    DriverDetector detector(config, needle, open);
    Looks looks;
    int seen = 0;
    for (int i = 0; i < kLooks; ++i) {
      const vision::Sighting sighting = detector.look();
      looks.add(sighting.stamp_s);
      seen += !sighting.candidates.empty();
      pass(0.01);
    }
    return fmt::format("seen {} of {} times, {}", seen, kLooks, looks.told());
  });
  return std::move(items).all();
}

std::vector<ConformanceItem> check_camera_driver(const OpenDriver& open, const rig::DriverConfig& config,
                                                 double timeout_s) {
  Items items;
  items.add("hands out images", [&] {
    rig::DriverCamera camera(open, config.start_timeout_s);
    Looks looks;
    cv::Size size;
    for (int i = 0; i < kLooks; ++i) {
      const imaging::Frame frame = camera.grab(timeout_s);
      looks.add(frame.stamp_s);
      if (i > 0 && frame.image.size() != size) throw HardwareError("its images are of more than one size");
      size = frame.image.size();
    }
    return fmt::format("{} x {} px, {}", size.width, size.height, looks.told());
  });
  return std::move(items).all();
}

}  // namespace lodestone::session
