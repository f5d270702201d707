#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fault_run.h"

namespace lodestone::tests {

/// A kind of fault: `put` makes one that begins then and lasts so long.
template <class Rig>
struct RunFault {
  std::string name;
  std::function<void(FaultRun<Rig>& run, double at_s, double for_s)> put;
};

/// Pairs that no program can survive, and why.
struct ExcludedPair {
  const char* one;
  const char* other;
  const char* why;
};
constexpr ExcludedPair kExcludedPairs[] = {
    {"output stuck at a duty", "contactor welded", "nothing is left that could switch the coil off"},
    {"output stuck at a duty", "current reads zero", "nothing is left that could see the coil's current"},
};

inline bool excluded(const std::string& one, const std::string& other) {
  for (const ExcludedPair& pair : kExcludedPairs)
    if ((one == pair.one && other == pair.other) || (one == pair.other && other == pair.one)) return true;
  return false;
}

/// Of bytes on their way: {dropped, flipped, forged, delayed} at a rate, while it lasts.
template <class Rig>
void add_damaged_bytes(std::vector<RunFault<Rig>>& faults) {
  using Run = FaultRun<Rig>;
  using Way = BusRig::Way;
  using Change = std::function<typename Run::Bytes(Run&, std::uint8_t)>;
  const std::pair<const char*, Change> changes[] = {
      {"dropped", [](Run&, std::uint8_t) { return typename Run::Bytes{}; }},
      {"flipped",
       [](Run& run, std::uint8_t byte) {
         return typename Run::Bytes{{static_cast<std::uint8_t>(byte ^ 1U << run.any(8)), 0.0}};
       }},
      {"forged",
       [](Run& run, std::uint8_t byte) {
         const auto forged = static_cast<std::uint8_t>(run.chance(0.5) ? 0xff : run.any(256));
         return typename Run::Bytes{{byte, 0.0}, {forged, 0.0}};
       }},
      {"delayed",
       [](Run& run, std::uint8_t byte) {
         return typename Run::Bytes{{byte, run.any_size(0.1e-3, 30e-3)}};
       }},
  };
  const std::pair<const char*, Way> ways[] = {{"bytes to the motor controllers ", Way::kToControllers},
                                              {"bytes from the motor controllers ", Way::kToFirmware},
                                              {"bytes from the host ", Way::kFromHost},
                                              {"bytes to the host ", Way::kToHost}};
  for (const auto& [where, way] : ways)
    for (const auto& [what, change] : changes) {
      const bool host = way == Way::kFromHost || way == Way::kToHost;
      if (host && std::string(what) == "delayed") continue;  // a late request: below
      faults.push_back(
          {std::string(where) + what, [way = way, change = change](Run& run, double at_s, double for_s) {
             const double rate = run.any_size(2e-3, 1.0);
             run.at(at_s, [&run, way, change, rate, for_s] {
               run.attack(way, run.now_s() + for_s, [&run, change, rate](std::uint8_t byte) {
                 return run.chance(rate) ? change(run, byte) : typename Run::Bytes{{byte, 0.0}};
               });
             });
           }});
    }
}

/// A fault that is put and cleared.
template <class Rig>
RunFault<Rig> lasting(const std::string& name,
                      std::function<void(FaultRun<Rig>&, bool there, int which)> put) {
  return {name, [put](FaultRun<Rig>& run, double at_s, double for_s) {
            const int which = run.any(run.coils());
            run.at(at_s, [&run, put, which] { put(run, true, which); });
            run.at(at_s + for_s, [&run, put, which] { put(run, false, which); });
          }};
}

template <class Rig>
void add_bus_faults(std::vector<RunFault<Rig>>& faults) {
  using Run = FaultRun<Rig>;
  using Way = BusRig::Way;
  faults.push_back({"duties damaged, each acknowledged by noise", [](Run& run, double at_s, double for_s) {
                      const double rate = run.any_size(0.05, 1.0);
                      run.at(at_s, [&run, rate, for_s] {
                        const auto packet = std::make_shared<std::vector<std::uint8_t>>();
                        const auto last_s = std::make_shared<double>(0.0);
                        run.attack(
                            Way::kToControllers, run.now_s() + for_s,
                            [&run, rate, packet, last_s](std::uint8_t byte) -> typename Run::Bytes {
                              if (run.now_s() - *last_s > 0.5e-3) packet->clear();
                              *last_s = run.now_s();
                              packet->push_back(byte);
                              if (packet->size() != 3 || (*packet)[1] != kDriveDuty || !run.chance(rate))
                                return {{byte, 0.0}};
                              run.rig.noise(0xff, 2e-3);
                              return {{static_cast<std::uint8_t>(byte ^ 0x40), 0.0}};
                            });
                      });
                    }});
  faults.push_back({"noise on the bus", [](Run& run, double at_s, double for_s) {
                      const double every_s = run.any_size(0.2e-3, 20e-3);
                      for (double time_s = at_s; time_s < at_s + for_s; time_s += every_s)
                        run.at(time_s, [&run] {
                          run.rig.noise(static_cast<std::uint8_t>(run.chance(0.5) ? 0xff : run.any(256)),
                                        0.0);
                        });
                    }});
  const auto controller = [&faults](const char* name, auto put) {
    faults.push_back(lasting<Rig>(name, [put](Run& run, bool there, int which) {
      put(run.rig.controllers[static_cast<std::size_t>(which % (run.coils() / 2))], there);
    }));
  };
  using Model = emulation::RoboClawModel;
  controller("motor controller silent", [](Model& model, bool there) { model.tx_open = there; });
  controller("motor controller deaf", [](Model& model, bool there) { model.rx_open = there; });
  controller("motor controller without power", [](Model& model, bool there) { model.powered = !there; });
  controller("emergency stop of a motor controller",
             [](Model& model, bool there) { model.emergency_stop = there; });
  controller("temperature reads wrong",
             [](Model& model, bool there) { model.board_C = there ? 200.0 : 30.0; });
  controller("motor controller resets", [](Model& model, bool there) {
    if (there) model.restart();
  });
  controller("motor controller forgets its settings", [](Model& model, bool there) {
    if (there) model.forget_settings();
  });
}

template <class Rig>
void add_power_faults(std::vector<RunFault<Rig>>& faults) {
  using Run = FaultRun<Rig>;
  faults.push_back({"output stuck at a duty", [](Run& run, double at_s, double) {
                      const auto coil = static_cast<std::size_t>(run.any(run.coils()));
                      const double duty = run.any_size(0.1, 1.0) * (run.chance(0.5) ? 1.0 : -1.0);
                      run.at(at_s, [&run, coil, duty] {
                        run.rig.stuck_duty[coil] = duty;
                        run.current_comes();
                      });
                    }});
  faults.push_back({"contactor welded",
                    [](Run& run, double at_s, double) { run.at(at_s, [&run] { run.rig.welded = true; }); }});
  faults.push_back({"contactor slow", [](Run& run, double at_s, double) {
                      run.at(at_s, [&run] { run.rig.contactor_s = 20e-3; });
                    }});
  faults.push_back(lasting<Rig>("supply browns out", [](Run& run, bool there, int) {
    run.rig.supply_V = there ? run.uniform(6.5, 25.0) : 34.0;
    if (!there) run.current_comes();  // through an output that stuck meanwhile
  }));
  faults.push_back(lasting<Rig>("supply fails", [](Run& run, bool there, int) {
    run.rig.supply_V = there ? 0.0 : 34.0;
    if (!there) run.current_comes();
  }));
  faults.push_back(lasting<Rig>("shorted turns", [](Run& run, bool there, int which) {
    run.rig.impedance[static_cast<std::size_t>(which)] = there ? run.uniform(0.05, 0.7) : 1.0;
  }));
  faults.push_back(lasting<Rig>("current reads zero", [](Run& run, bool there, int which) {
    const auto coil = static_cast<std::size_t>(which);
    run.rig.shunt = nullptr;
    if (there) run.rig.shunt = [coil](std::size_t of, double amps) { return of == coil ? 0.0 : amps; };
  }));
  faults.push_back(lasting<Rig>("current reads too much", [](Run& run, bool there, int which) {
    const auto coil = static_cast<std::size_t>(which);
    const double more_A = run.uniform(0.1, 20.0);
    run.rig.shunt = nullptr;
    if (there)
      run.rig.shunt = [coil, more_A](std::size_t of, double amps) {
        return of == coil ? amps + std::copysign(more_A, amps) : amps;
      };
  }));
}

template <class Rig>
void add_firmware_and_host_faults(std::vector<RunFault<Rig>>& faults) {
  using Run = FaultRun<Rig>;
  faults.push_back({"firmware reset", [](Run& run, double at_s, double) {
                      run.at(at_s, [&run] {
                        run.rig.reset_firmware();
                        run.pulses_end();
                      });
                    }});
  faults.push_back({"firmware hangs until its watchdog", [](Run& run, double at_s, double) {
                      run.at(at_s, [&run] {
                        run.rig.hang();
                        run.pulses_end();
                      });
                    }});
  faults.push_back({"clock wraps round", [](Run& run, double at_s, double) { run.rig.wrap_clock(at_s); }});
  faults.push_back(lasting<Rig>("emergency switch opens", [](Run& run, bool there, int) {
    run.rig.open_switch = there;
    if (there) run.pulses_end();
  }));
  faults.push_back({"host falls silent", [](Run& run, double at_s, double) { run.silent_from_s = at_s; }});
  faults.push_back({"host floods", [](Run& run, double at_s, double) { run.flood_from_s = at_s; }});
  faults.push_back(
      {"host pulses back to back", [](Run& run, double at_s, double) { run.back_to_back_from_s = at_s; }});
  faults.push_back({"host says HELLO again", [](Run& run, double at_s, double) { run.hello_at_s = at_s; }});
}

template <class Rig>
const std::vector<RunFault<Rig>>& run_faults() {
  static const std::vector<RunFault<Rig>> all = [] {
    std::vector<RunFault<Rig>> faults;
    add_damaged_bytes(faults);
    add_bus_faults(faults);
    add_power_faults(faults);
    add_firmware_and_host_faults(faults);
    return faults;
  }();
  return all;
}

/// One run with one or two faults at random times: what is put, and how long current flowed that nothing
/// accounts for.
struct FaultRunResult {
  std::string faults;
  double unaccounted_s = 0.0;
};

template <class Rig>
FaultRunResult run_with_faults(std::uint64_t seed) {
  using Run = FaultRun<Rig>;
  Run run(seed);
  const std::vector<RunFault<Rig>>& all = run_faults<Rig>();
  const auto count = static_cast<int>(all.size());
  const RunFault<Rig>* one = nullptr;
  const RunFault<Rig>* other = nullptr;
  do {
    one = &all[static_cast<std::size_t>(run.any(count))];
    other = run.chance(0.7) ? &all[static_cast<std::size_t>(run.any(count))] : nullptr;
  } while (other != nullptr && (other == one || excluded(one->name, other->name)));
  FaultRunResult result{one->name, 0.0};
  if (other != nullptr) result.faults += " + " + other->name;
  for (const RunFault<Rig>* fault : {one, other}) {
    if (fault == nullptr) continue;
    const double at_s = run.uniform(0.0, Run::kBusy_s);
    const double for_s = run.any_size(1e-3, 3.0);
    fault->put(run, at_s, for_s);
  }
  result.unaccounted_s = run.drive();
  return result;
}

/// Many of them, none of which may leave a coil on; says which faults did.
template <class Rig>
void check_fault_runs(std::int64_t runs, std::uint64_t seed) {
  std::map<std::string, int> unsafe;
  for (std::int64_t i = 0; i < runs; ++i) {
    const std::uint64_t of_run = seed * 1000000u + static_cast<std::uint64_t>(i);
    const FaultRunResult result = run_with_faults<Rig>(of_run);
    if (result.unaccounted_s == 0.0) continue;
    if (unsafe[result.faults]++ == 0)
      UNSCOPED_INFO(result.faults << ", seed " << of_run << ": on for " << result.unaccounted_s << " s");
  }
  CHECK(unsafe.empty());
}

}  // namespace lodestone::tests
