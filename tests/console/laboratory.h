#pragma once
// A bench on which the console's threads are tried, and its operator.
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/console/bench.h"
#include "lodestone/experiments/routing.h"

namespace lodestone::tests {

using console::Bench;
using console::BenchState;
using console::Goal;
using console::Mode;

/// A virtual bench in real time, seen by the simulated sensor, under the baseline; and an operator whose page
/// beats as long as it is there.
struct Laboratory {
  explicit Laboratory(std::vector<geometry::Zone> keep_out = {}, const std::string& keep_out_file = {}) {
    config.safety.keep_out = std::move(keep_out);
    config.safety.keep_out_file = keep_out_file;
    config.loop.rest_s = 0.1;
    config.sensor.kind = "simulated";
    config.trials.point_seconds = 1.0;
    Bench::Parts parts;
    parts.config = config;
    experiments::ControllerSource broken = experiments::baseline_source(config);
    broken.name = "broken";
    broken.make = [](std::uint64_t) -> std::unique_ptr<control::Controller> {
      throw std::runtime_error("its weights are gone");
    };
    parts.routes = experiments::route_map(config, nullptr, nullptr);
    parts.sources = {experiments::baseline_source(config), broken};
    parts.connect = [this] {
      if (unplugged) throw common::HardwareError("no rig on this port");
      return session::make_virtual_session(config.rig, config.sensor, config.safety, {}, true);
    };
    parts.tell = [this](const console::BenchEvent& event) {
      const std::lock_guard<std::mutex> lock(mutex);
      events += event.text + "\n";
    };
    bench = std::make_unique<Bench>(parts);
    page = std::thread([this] {
      while (!over) {
        if (beats) bench->beat(visible, focused);
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
      }
    });
  }
  ~Laboratory() {
    over = true;
    page.join();
  }

  bool reach(const std::function<bool(const BenchState&)>& there) {
    for (int i = 0; i < 2000; ++i) {
      if (there(bench->state())) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    UNSCOPED_INFO("mode " << common::name_of(bench->state().mode) << ": " << bench->state().reason);
    return false;
  }
  bool reach(Mode mode) {
    return reach([mode](const BenchState& state) { return state.mode == mode; });
  }
  /// What an order came to; empty: done.
  std::string ask(const std::function<void(Bench::Done)>& order) {
    std::atomic<bool> answered{false};
    std::string why_not;
    order([&](const std::string& text) {
      why_not = text;
      answered = true;
    });
    while (!answered) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return why_not;
  }
  std::string arm() {
    return ask([this](Bench::Done done) { bench->arm(std::move(done)); });
  }
  std::string rearm(const std::string& reason) {
    return ask([&](Bench::Done done) { bench->rearm(reason, true, std::move(done)); });
  }
  bool told(const std::string& text) {
    return reach([&](const BenchState&) {
      const std::lock_guard<std::mutex> lock(mutex);
      return events.find(text) != std::string::npos;
    });
  }

  experiments::DeploymentConfig config;
  std::atomic<bool> unplugged{false}, beats{true}, visible{true}, focused{true}, over{false};
  std::mutex mutex;
  std::string events;
  std::unique_ptr<Bench> bench;
  std::thread page;
};

inline Goal point(double x_m, double y_m) {
  Goal goal;
  goal.task = "point";
  goal.target_m = {x_m, y_m};
  return goal;
}

}  // namespace lodestone::tests
