#include "lodestone/experiments/fault_injection.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/control/control_loop.h"
#include "lodestone/emulation/emulated_bench.h"
#include "lodestone/emulation/lockstep_port.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/rig/serial_coils.h"
#include "lodestone/safety/supervisor.h"

namespace lodestone::experiments {

namespace {

constexpr double kFlowing_A = 0.1;  // more than this in a coil is current
constexpr double kDrive_A = 5.0;
constexpr double kLineDown_s = 1.5;
constexpr double kHeldPulse_s = 4.0;

/// Looks at the needle as a good localiser would, or fails as a camera can.
class KnownPoseSensor final : public control::PoseSensor {
 public:
  KnownPoseSensor(rig::VirtualRig& rig, const common::Clock& clock) : rig_(rig), clock_(clock) {}
  control::PoseEstimate observe() override {
    if (stalled) throw common::HardwareError("camera: no image within 0.5 s");
    control::PoseEstimate estimate;
    if (old_frame) return last_;
    estimate.stamp_s = clock_.now_s() + stamp_error_s;
    stamp_error_s = 0.0;
    estimate.pose = rig_.true_pose();
    estimate.valid = !needle_gone;
    if (needle_gone) estimate.reason = "no needle in the image";
    if (needle_outside) estimate.pose.x_m = 0.2;
    last_ = estimate;
    return estimate;
  }
  bool stalled = false;
  bool old_frame = false;
  bool needle_gone = false;
  bool needle_outside = false;
  /// Of the next image only: the PC's wall clock was set between its arrival and its use.
  double stamp_error_s = 0.0;

 private:
  rig::VirtualRig& rig_;
  const common::Clock& clock_;
  control::PoseEstimate last_;
};

/// Any drive, as an explorer would.
class RandomDrive final : public control::Controller {
 public:
  explicit RandomDrive(common::RandomStream random) : random_(random) {}
  void reset() override {}
  geometry::Drive act(const task::Observation&) override {
    const geometry::Vector2 drive(random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 1.0));
    return drive.cwiseSign().cwiseProduct(drive.cwiseAbs() * 0.7 + geometry::Vector2(0.3, 0.3));
  }

 private:
  common::RandomStream random_;
};

/// One line per step, flushed, as the program's own records.
class Record {
 public:
  explicit Record(const std::string& file) : path_(file), file_(file, std::ios::trunc) {}
  void write(const control::StepRecord& step) {
    if (disk_full) {
      std::ofstream full("/dev/full");
      full << step.time_s << std::endl;
      if (!full) throw common::IoError("cannot write " + path_ + ": check the space on the disk");
    }
    file_ << step.time_s << ',' << step.action.x() << ',' << step.action.y() << std::endl;
    if (!file_) throw common::IoError("cannot write " + path_ + ": check the space on the disk");
  }
  std::int64_t lines() const {
    std::ifstream in(path_);
    return std::count(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>(), '\n');
  }
  bool disk_full = false;

 private:
  std::string path_;
  std::ofstream file_;
};

/// The whole chain, and a watch over it that knows the truth.
struct Chain {
  Chain(std::uint64_t seed, const std::string& folder)
      : rig(rig::VirtualRigConfig{}, seed),
        bench(rig),
        clock(bench.clock()),
        sensor(rig, clock),
        controller(common::RandomStream(seed, "drill/drive")),
        record(folder + "/record.csv") {
    serial.max_pulse_s = 0.5;
    timing.max_invalid_poses = 10;  // a run is 6 s long, and must show that it stops
    action.scale = kDrive_A;
    bench.watch = [this](double now_s, const physics::PerCoil& current_A) { watch(now_s, current_A); };
  }

  void connect();
  void start_anew() { supervisor.emplace(*coils, safety::SafetyConfig{}, rig.config(), clock); }

  void watch(double now_s, const physics::PerCoil& current_A) {
    bool flowing = false;
    for (std::size_t i = 0; i < current_A.size(); ++i) {
      const double size_A = std::abs(current_A[i]);
      largest_A = std::max(largest_A, size_A);
      flowing = flowing || size_A > kFlowing_A;
    }
    if (flowing && on_since_s < 0.0) on_since_s = now_s;
    if (!flowing) on_since_s = -1.0;
    if (flowing) {
      longest_on_s = std::max(longest_on_s, now_s - on_since_s);
      // Only the stretch in which the fault was injected, and whatever comes after the run was stopped.
      if (injected_s >= 0.0 && (on_since_s <= injected_s || run_over_s >= 0.0)) last_on_s = now_s;
    }
    if (inject && flowing && now_s >= inject_at_s && now_s - on_since_s > 0.04) {
      injected_s = now_s;
      last_on_s = now_s;
      const auto put = std::move(inject);  // now, in the middle of the pulse; the bench's step is over
      inject = nullptr;
      put(*this);
    }
  }

  rig::VirtualRig rig;
  emulation::EmulatedBench bench;
  common::Clock& clock;
  KnownPoseSensor sensor;
  RandomDrive controller;
  Record record;
  rig::SerialConfig serial;
  task::ActionConfig action;
  control::ControlLoopConfig timing;
  std::vector<std::uint8_t> last_request;  // bytes of the last frame that the PC sent, for replaying
  bool host_dead = false;

  double inject_at_s = 0.0;
  std::function<void(Chain&)> inject;
  double injected_s = -1.0;
  double run_over_s = -1.0;
  double last_on_s = 0.0;
  double on_since_s = -1.0;
  double longest_on_s = 0.0;
  double largest_A = 0.0;

  // Last, so that they can still stop the bench when they go.
  std::unique_ptr<rig::SerialCoils> coils;
  std::optional<safety::Supervisor> supervisor;
};

/// The host is gone: whoever calls into it gets nothing more.
struct HostKilled {};

/// The PC's end of the line, where faults are injected between two looks, and where a dead PC stays dead.
class FaultyPort final : public rig::SerialPort {
 public:
  explicit FaultyPort(Chain& chain) : chain_(chain), port_(chain.bench) {}
  std::size_t read(std::uint8_t* bytes, std::size_t most, double timeout_s) override {
    if (chain_.host_dead) throw HostKilled();
    return port_.read(bytes, most, timeout_s);
  }
  void write(const std::uint8_t* bytes, std::size_t count, double timeout_s) override {
    if (chain_.host_dead) throw HostKilled();
    chain_.last_request.assign(bytes, bytes + count);
    port_.write(bytes, count, timeout_s);
  }
  void discard_input() override { port_.discard_input(); }

 private:
  Chain& chain_;
  emulation::LockstepPort port_;
};

void Chain::connect() {
  coils = std::make_unique<rig::SerialCoils>(serial, rig.config().coils,
                                             [this] { return std::make_unique<FaultyPort>(*this); });
}

struct FaultKind {
  std::string name;
  bool stops;  ///< whether the run must end
  std::function<void(Chain&)> inject;
  std::function<void(Chain&)> clear;
};

std::vector<std::uint8_t> noise(std::size_t count, std::uint64_t seed) {
  common::RandomStream random(seed, "drill/noise");
  std::vector<std::uint8_t> bytes(count);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(256.0 * random.uniform());
  return bytes;
}

/// Calls `each` for every byte of the next frames, with its place in the frame (0: the first delimiter).
std::function<bool(std::uint8_t&)> per_byte(int frames, std::function<bool(int place, std::uint8_t&)> each) {
  auto place = std::make_shared<int>(-1);
  auto left = std::make_shared<int>(frames);
  return [place, left, each](std::uint8_t& byte) {
    if (*left <= 0) return true;
    const bool delimiter = byte == 0;
    *place = delimiter && *place > 0 ? -1 : *place + 1;
    const bool ended = *place < 0;
    const int at = ended ? 1000 : *place;
    const bool keep = each(at, byte);
    if (ended) --*left;
    return keep;
  };
}

using Filter = emulation::EmulatedBench::ByteFilter;

/// Behind the filters that are there already, so that two faults of one line do not hide each other.
void add_filter(Filter& filter, const Filter& more) {
  filter = [before = filter, more](std::uint8_t& byte) { return (!before || before(byte)) && more(byte); };
}

void no_filters(Chain& chain) {
  chain.bench.to_device_filter = nullptr;
  chain.bench.to_host_filter = nullptr;
}
void nothing(Chain&) {}

/// A fault that is there until it is cleared, and ends the run.
FaultKind lasting(const std::string& name, const std::function<void(Chain&, bool there)>& put) {
  return {name, true, [put](Chain& chain) { put(chain, true); }, [put](Chain& chain) { put(chain, false); }};
}

/// On the line: requests and answers that are lost, cut, twisted or come twice.
std::vector<FaultKind> tolerated_faults() {
  return {
      {"garbage bytes to the firmware", false, [](Chain& c) { c.bench.inject_to_device(noise(200, 1)); },
       nothing},
      {"garbage bytes to the PC", false, [](Chain& c) { c.bench.inject_to_host(noise(200, 2)); }, nothing},
      {"truncated frame", false,
       [](Chain& c) {
         add_filter(c.bench.to_device_filter,
                    per_byte(1, [](int place, std::uint8_t&) { return place < 7; }));
       },
       no_filters},
      {"single bit flips", false,
       [](Chain& c) {
         add_filter(c.bench.to_device_filter, per_byte(2, [](int place, std::uint8_t& byte) {
                      if (place == 5) byte ^= 0x10;
                      return true;
                    }));
       },
       no_filters},
      {"lost acknowledgement", false,
       [](Chain& c) {
         add_filter(c.bench.to_host_filter, per_byte(2, [](int, std::uint8_t&) { return false; }));
       },
       no_filters},
      {"duplicated acknowledgement", false,
       [](Chain& c) {
         auto seen = std::make_shared<std::vector<std::uint8_t>>();
         auto* const bench = &c.bench;
         add_filter(c.bench.to_host_filter, per_byte(3, [seen, bench](int place, std::uint8_t& byte) {
                      seen->push_back(byte);
                      if (place == 1000) {
                        bench->inject_to_host(*seen);
                        seen->clear();
                      }
                      return true;
                    }));
       },
       no_filters},
      {"repeated pulse frame", false, [](Chain& c) { c.bench.inject_to_device(c.last_request); }, nothing},
      {"reordered frames", false,
       [](Chain& c) {
         // An old frame comes once more after newer ones, as a buffer on the way might give it.
         auto old = std::make_shared<std::vector<std::uint8_t>>(c.last_request);
         auto* const bench = &c.bench;
         add_filter(c.bench.to_device_filter, per_byte(3, [old, bench](int place, std::uint8_t&) {
                      if (place == 1000) bench->inject_to_device(*old);
                      return true;
                    }));
       },
       no_filters},
  };
}

/// Of the line, the firmware, the motor controllers and the coils.
std::vector<FaultKind> device_faults() {
  const auto silence = [](std::uint8_t&) { return false; };
  const auto each_coil = [](Chain& c, const auto& put) {
    for (std::size_t i = 0; i < c.rig.config().coils.count(); ++i) put(c.bench, static_cast<int>(i));
  };
  return {
      {"line dead", true,
       [silence](Chain& c) {
         add_filter(c.bench.to_host_filter, silence);
         add_filter(c.bench.to_device_filter, silence);
       },
       no_filters},
      lasting("port unplugged", [](Chain& c, bool there) { c.bench.set_plugged(!there); }),
      lasting("PC killed", [](Chain& c, bool there) { c.host_dead = there; }),
      {"firmware hangs", true, [](Chain& c) { c.bench.arduino().hang(); }, nothing},
      lasting("motor controller tx open",
              [](Chain& c, bool there) { c.bench.controller(0).tx_open = there; }),
      lasting("motor controller rx open",
              [](Chain& c, bool there) { c.bench.controller(1).rx_open = there; }),
      lasting("motor controller without power",
              [](Chain& c, bool there) { c.bench.controller(0).powered = !there; }),
      lasting("over-current",
              [each_coil](Chain& c, bool there) {
                each_coil(c, [there](auto& bench, int i) { bench.short_coil(i, there ? 0.08 : 1.0); });
                for (int i = 0; i < 2 && !there; ++i) c.bench.controller(i).restart();
              }),
      lasting("coil too hot",
              [each_coil](Chain& c, bool there) {
                each_coil(c, [there](auto& bench, int i) { bench.heat_coil(i, there ? 150.0 : 22.0); });
              }),
      lasting("motor controller too hot",
              [](Chain& c, bool there) { c.bench.controller(1).board_C = there ? 95.0 : 30.0; }),
      lasting("supply drops to 12 V",
              [](Chain& c, bool there) { c.bench.set_supply_V(there ? 12.0 : 34.0); }),
      lasting("emergency stop of a motor controller",
              [](Chain& c, bool there) { c.bench.controller(1).emergency_stop = there; }),
      lasting("emergency stop", [](Chain& c, bool there) { c.bench.arduino().set_emergency_stop(there); }),
      lasting(kStuckOutput,
              [](Chain& c, bool there) {
                c.bench.stick_driver(1, there ? 0.3 : std::numeric_limits<double>::quiet_NaN());
              }),
      {kWeldedContactor, false, [](Chain& c) { c.bench.weld_contactor(true); },
       [](Chain& c) { c.bench.weld_contactor(false); }},
  };
}

/// Of camera, needle and PC.
std::vector<FaultKind> faults_beyond_device() {
  return {
      lasting("camera stalls", [](Chain& c, bool there) { c.sensor.stalled = there; }),
      lasting("camera shows an old frame", [](Chain& c, bool there) { c.sensor.old_frame = there; }),
      lasting("needle leaves the view", [](Chain& c, bool there) { c.sensor.needle_gone = there; }),
      lasting("needle seen outside the fence", [](Chain& c, bool there) { c.sensor.needle_outside = there; }),
      lasting("disk full", [](Chain& c, bool there) { c.record.disk_full = there; }),
      // Where another fault stops the run first, no image comes to show them.
      lasting("clock jumps forward",
              [](Chain& c, bool there) { c.sensor.stamp_error_s = there ? -3600.0 : 0.0; }),
      lasting("clock jumps back",
              [](Chain& c, bool there) { c.sensor.stamp_error_s = there ? 3600.0 : 0.0; }),
  };
}

/// All of them in the order of the list, those of the device first.
const std::vector<FaultKind>& faults() {
  static const std::vector<FaultKind> kinds = [] {
    std::vector<FaultKind> all;
    for (const auto& part : {tolerated_faults(), device_faults(), faults_beyond_device()})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }();
  return kinds;
}

const FaultKind& kind_of(const std::string& fault) {
  const auto kind = std::find_if(faults().begin(), faults().end(),
                                 [&](const FaultKind& each) { return each.name == fault; });
  LODESTONE_CHECK(kind != faults().end(), "a fault of the list, not '" + fault + "'");
  return *kind;
}

using Faults = std::vector<const FaultKind*>;

std::string names_of(const Faults& kinds) {
  std::string names;
  for (const FaultKind* kind : kinds) names += (names.empty() ? "" : " + ") + kind->name;
  return names;
}

/// Runs the loop for a while, with these faults in it, all at once.
FaultResult run_with(Chain& chain, const Faults& kinds, double duration_s) {
  FaultResult result;
  chain.injected_s = -1.0;
  chain.run_over_s = -1.0;
  chain.inject = nullptr;
  if (!kinds.empty())
    chain.inject = [kinds](Chain& of) {
      for (const FaultKind* kind : kinds) kind->inject(of);
    };
  const std::int64_t repeats = chain.coils->repeats();
  const std::int64_t lines = chain.record.lines();
  const std::int64_t fired = chain.coils->state().pulses;
  control::PointReference reference({0.0, 0.0}, duration_s);
  control::ControlLoop loop(chain.timing, chain.action, *chain.supervisor, chain.sensor, chain.clock);
  {
    const control::LoopOutcome outcome =
        loop.run(chain.controller, reference, [&](const control::StepRecord& step) {
          chain.record.write(step);
          ++result.steps;
          if (step.estimate.valid && !step.last) ++result.asked;
        });
    result.stopped = !outcome.completed;
    result.reason = chain.host_dead ? "the PC was killed" : outcome.stop_reason;
  }
  chain.run_over_s = chain.bench.now_s();
  chain.bench.advance_to(chain.bench.now_s() + 2.0 * kLineDown_s);
  result.recorded = chain.record.lines() - lines;
  if (kinds.empty()) return result;
  result.fault = names_of(kinds);
  result.injected_s = chain.injected_s;
  result.on_after_s = chain.injected_s >= 0.0 ? chain.last_on_s - chain.injected_s : 0.0;
  const auto broken = [&](const std::string& what) {
    result.unsafe = true;
    result.reason = what + (result.reason.empty() ? "" : " (" + result.reason + ")");
  };
  if (chain.injected_s < 0.0) broken("the fault was never injected");
  if (result.on_after_s > kOffWithin_s) broken("current flowed for too long");
  const bool stops =
      std::any_of(kinds.begin(), kinds.end(), [](const FaultKind* kind) { return kind->stops; });
  if (stops && !result.stopped) broken("the run went on");
  // What is tolerated alone may be too much together: a request is repeated three times.
  if (!stops && result.stopped && kinds.size() == 1) broken("the run was stopped");
  for (const FaultKind* kind : kinds) kind->clear(chain);
  if (!result.stopped) {
    result.pulses = (chain.coils->state().pulses - fired + 65536) % 65536;
    if (result.pulses != result.asked) broken("pulses were lost or fired twice");
    if (result.reason.empty())
      result.reason = "tolerated, " + std::to_string(chain.coils->repeats() - repeats) + " requests repeated";
  }
  return result;
}

/// What an operator does after a stop: removes the fault, clears the latch, starts again.
void start_again(Chain& chain) {
  chain.bench.advance_to(chain.bench.now_s() + 1.0);
  constexpr int kAttempts = 10;
  for (int attempt = 1;; ++attempt) {
    try {
      chain.coils->clear_faults();
      const rig::CoilControllerState state = chain.coils->state();
      if (state.faults.empty() && state.ready) break;
      if (attempt == kAttempts)
        throw common::HardwareError("the bench does not recover: " +
                                    (state.faults.empty() ? "not ready" : state.faults.front()));
    } catch (const common::HardwareError&) {
      if (attempt == kAttempts) throw;
    }
    chain.bench.advance_to(chain.bench.now_s() + 0.5);
  }
  chain.start_anew();
}

const FaultKind* any_fault(common::RandomStream& random) {
  const auto index = static_cast<std::size_t>(random.uniform() * static_cast<double>(faults().size()));
  return &faults()[std::min(index, faults().size() - 1)];
}

bool excluded(const FaultKind* one, const FaultKind* other) {
  for (const ExcludedFaults& pair : kExcludedFaults)
    if ((one->name == pair.one && other->name == pair.other) ||
        (one->name == pair.other && other->name == pair.one))
      return true;
  return one == other;
}

Faults any_pair(common::RandomStream& random) {
  Faults pair;
  do {
    pair = {any_fault(random), any_fault(random)};
  } while (excluded(pair[0], pair[1]));
  return pair;
}

constexpr double kMinute_s = 60.0;

/// Minute by minute, each with the faults that `draw` gives, at any moment of it.
HourReport run_for_long(std::uint64_t seed, const char* stream, const std::string& folder,
                        const std::function<Faults(common::RandomStream&)>& draw,
                        const std::function<bool(const HourReport&)>& over) {
  common::RandomStream random(seed, stream);
  Chain chain(seed, folder);
  chain.connect();
  chain.start_anew();
  HourReport report;
  const double start_s = chain.bench.now_s();
  const auto drive = [&](const Faults& kinds, double duration_s) {
    FaultResult result = run_with(chain, kinds, duration_s);
    const bool unasked = kinds.empty() && result.stopped;
    if (unasked) result.reason += " - stopped without a fault";
    result.unsafe = result.unsafe || unasked;
    report.pulses += result.asked;
    report.unsafe += result.unsafe ? 1 : 0;
    if (!kinds.empty() || unasked) report.faults.push_back(result);
    if (result.stopped) start_again(chain);
    report.simulated_s = chain.bench.now_s() - start_s;
  };
  while (!over(report)) {
    const Faults kinds = draw(random);
    const double minute_s = chain.bench.now_s();
    chain.inject_at_s = minute_s + random.uniform(5.0, 50.0);
    drive(kinds, kMinute_s);
    const double left_s = minute_s + kMinute_s - chain.bench.now_s();
    if (left_s >= 1.0 && !over(report)) drive({}, left_s);
  }
  report.longest_on_s = chain.longest_on_s;
  report.largest_current_A = chain.largest_A;
  return report;
}

}  // namespace

std::vector<std::string> fault_names() {
  std::vector<std::string> names;
  for (const FaultKind& kind : faults()) names.push_back(kind.name);
  return names;
}

std::vector<std::string> device_fault_names() {
  std::vector<std::string> names = fault_names();
  names.resize(names.size() - faults_beyond_device().size());
  return names;
}

FaultResult inject_held_fault(const std::string& fault, std::uint64_t seed, const std::string& folder) {
  const FaultKind& kind = kind_of(fault);
  Chain chain(seed, folder);
  chain.serial.max_pulse_s = kHeldPulse_s;
  chain.connect();
  chain.inject_at_s = chain.bench.now_s() + 1.0;
  chain.inject = kind.inject;
  FaultResult result;
  result.fault = fault;
  result.held = true;
  const double end_s = chain.bench.now_s() + kHeldPulse_s - 0.5;
  try {
    chain.coils->apply({{kDrive_A, 0.0, -kDrive_A, 0.0}, kHeldPulse_s});
    while (chain.bench.now_s() < end_s) {
      chain.bench.advance_to(chain.bench.now_s() + 0.05);
      const rig::CoilStatus status = chain.coils->status();
      if (!status.faults.empty()) throw common::HardwareError(status.faults.front());
    }
    result.reason = "tolerated";
  } catch (const common::HardwareError& error) {
    result.stopped = true;
    result.reason = error.what();
    chain.coils->stop();
  } catch (const HostKilled&) {
    result.stopped = true;
    result.reason = "the PC was killed";
  }
  if (!result.stopped) chain.coils->stop();
  chain.run_over_s = chain.bench.now_s();
  chain.bench.advance_to(chain.bench.now_s() + 2.0);
  result.injected_s = chain.injected_s;
  // Where the run must not end, the pulse goes on; it has ended with the stop.
  if (result.stopped) result.on_after_s = chain.last_on_s - chain.injected_s;
  const bool still_on = chain.on_since_s >= 0.0;
  if (chain.injected_s < 0.0 || still_on || result.on_after_s > kOffWithin_s ||
      kind.stops != result.stopped) {
    result.unsafe = true;
    result.reason += chain.injected_s < 0.0 ? " - the fault was never injected"
                     : still_on             ? " - current still flows"
                                            : " - too late, or not as it must be";
  }
  return result;
}

FaultResult inject_fault(const std::string& fault, std::uint64_t seed, const std::string& folder) {
  const FaultKind& kind = kind_of(fault);
  Chain chain(seed, folder);
  chain.connect();
  chain.start_anew();
  chain.inject_at_s = chain.bench.now_s() + 2.0;
  return run_with(chain, {&kind}, 6.0);
}

HourReport inject_for_an_hour(std::int64_t pulses, std::uint64_t seed, const std::string& folder) {
  // A bench that does not recover fires no more pulses; the faults then outnumber the minutes.
  const std::int64_t most_faults = 2 * pulses / 100;
  return run_for_long(
      seed, "drill/hour", folder, [](common::RandomStream& random) { return Faults{any_fault(random)}; },
      [&](const HourReport& report) {
        return report.pulses >= pulses || static_cast<std::int64_t>(report.faults.size()) >= most_faults;
      });
}

HourReport inject_pairs(double duration_s, std::uint64_t seed, const std::string& folder) {
  return run_for_long(seed, "drill/pairs", folder, any_pair, [duration_s](const HourReport& report) {
    return report.simulated_s >= duration_s &&
           static_cast<double>(report.faults.size()) >= duration_s / kMinute_s;
  });
}

}  // namespace lodestone::experiments
