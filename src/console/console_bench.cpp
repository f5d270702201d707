#include "lodestone/console/console_bench.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <functional>
#include <memory>
#include <regex>
#include <thread>
#include <utility>

#include "lodestone/common/build_facts.h"
#include "lodestone/common/child_process.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/realtime.h"
#include "lodestone/common/resource_use.h"
#include "lodestone/common/statistics.h"
#include "lodestone/console/console.h"
#include "lodestone/console/live_view.h"
#include "lodestone/console/page_client.h"
#include "lodestone/experiments/busy_processors.h"
#include "lodestone/experiments/emulated_rig.h"
#include "lodestone/experiments/pulse_watch.h"

namespace lodestone::console {
namespace {

using common::percentile;
using Level = BenchEvent::Level;

constexpr double kPatience_s = 60.0;
// What serves pages; the others drive, look for the needle, or stand for the camera and the firmware.
constexpr const char* kServing[] = {"web", "web-pages", "feed", "clerk", "dead-man"};

double now_s() {
  static const common::SteadyClock clock;
  return clock.now_s();
}

double serving_s() {
  const auto used_s = common::processor_seconds_by_thread();
  double sum_s = 0.0;
  for (const char* name : kServing)
    if (const auto found = used_s.find(name); found != used_s.end()) sum_s += found->second;
  return sum_s;
}

/// The console in front of an emulated bench, as `console --emulate` has it.
struct EmulatedConsole {
  EmulatedConsole(const ConsoleBenchConfig& config, const std::string& folder)
      : rig(experiments::make_emulated_rig(
            config.deployment.rig, static_cast<std::uint64_t>(config.deployment.rig_seed),
            &config.deployment.sensor.scene, static_cast<std::uint64_t>(config.deployment.sensor_seed))),
        pulses(*rig.bench) {
    ConsoleParts parts;
    parts.bench.config = config.deployment;
    std::optional<experiments::SimulatorSource> simulator;
    if (!config.dynamics.empty()) simulator = experiments::load_simulator(config.deployment, config.dynamics);
    parts.bench.sources = {simulator ? experiments::planner_source(config.deployment, *simulator)
                                     : experiments::baseline_source(config.deployment)};
    parts.bench.connect = [this, deployment = config.deployment] {
      return session::make_bench_session(rig.description, deployment.sensor, deployment.safety,
                                         [this](const geometry::Pose2& pose) { rig.bench->place(pose); });
    };
    parts.rig_kind = parts.rig_name = "emulated";
    parts.folder = folder + "/console";
    parts.runs = folder;
    parts.port = 0;
    console = std::make_unique<Console>(std::move(parts));
  }

  experiments::EmulatedRig rig;
  experiments::PulseWatch pulses;
  std::unique_ptr<Console> console;
};

/// A page in a thread of its own, which asks for each next image, and operates where it shall.
class Viewer {
 public:
  Viewer(std::uint16_t port, bool operates) : thread_([this, port, operates] { look(port, operates); }) {}
  ~Viewer() {
    over_ = true;
    thread_.join();
  }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  /// Said by the operator at its next beat, at most 10 ms from now.
  void say(const common::Json& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    to_say_.push_back(message);
  }
  std::vector<double> ages_s() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return ages_s_;
  }
  std::int64_t images() const { return images_; }

 private:
  void look(std::uint16_t port, bool operates) {
    common::name_thread("viewer");
    std::optional<common::RealtimeThread> realtime;
    if (operates) realtime.emplace();  // stands for another machine
    try {
      PageClient page(port);
      if (operates) page.say({{"do", "operate"}});
      page.want("image");
      page.want("state");
      double beat_s = -1e9;
      while (!over_) {
        const auto heard = page.hear(operates ? 0.005 : 0.1);
        if (heard && heard->image) note(heard->content);
        if (heard && heard->image)
          page.want("image");
        else if (heard && heard->content.find("\"kind\":\"state\"") != std::string::npos)
          page.want("state");
        if (!operates) continue;
        if (now_s() - beat_s > 0.1) {
          page.beat();
          beat_s = now_s();
        }
        const std::lock_guard<std::mutex> lock(mutex_);
        for (const common::Json& message : std::exchange(to_say_, {})) page.say(message);
      }
    } catch (const common::IoError& error) {
      if (!over_) common::log_warning(std::string("bench console: a page: ") + error.what());
    }
  }
  void note(const std::string& image) {
    double taken_s = 0.0;
    std::memcpy(&taken_s, image.data(), sizeof taken_s);
    ++images_;
    const std::lock_guard<std::mutex> lock(mutex_);
    ages_s_.push_back(now_s() - taken_s);
  }

  mutable std::mutex mutex_;
  std::vector<common::Json> to_say_;
  std::vector<double> ages_s_;
  std::atomic<std::int64_t> images_{0};
  std::atomic<bool> over_{false};
  std::thread thread_;
};

void pause(double time_s) {
  common::SteadyClock clock;
  clock.sleep_until(clock.now_s() + time_s);
  if (common::interrupted()) throw common::Interrupted("bench console: stopped by the user");
}

/// Throws HardwareError where it does not come to that.
void wait_for(const Console& console, const std::function<bool(const BenchState&)>& there, const char* what) {
  for (const double until_s = now_s() + kPatience_s; !there(console.state());) {
    if (now_s() > until_s)
      throw common::HardwareError(std::string("bench console: the bench was not ") + what +
                                  " within a minute: " + console.state().reason);
    pause(0.002);
  }
}
void wait_for(const Console& console, Mode mode) {
  wait_for(
      console, [mode](const BenchState& state) { return state.mode == mode; }, common::name_of(mode).c_str());
}

void arm(const Console& console, Viewer& by) {
  wait_for(console, Mode::kDisarmed);
  by.say({{"do", "arm"}});
  wait_for(console, Mode::kArmed);
  wait_for(
      console, [](const BenchState& state) { return state.camera && state.pose && state.pose->valid; },
      "seen by its camera");
}

}  // namespace

ConsoleBench::ConsoleBench(const ConsoleBenchConfig& config, std::string folder, std::string program)
    : config_(config), folder_(std::move(folder)), program_(std::move(program)) {
  result_.machine = common::build_and_host_facts();
}

void ConsoleBench::add(const std::string& figure, double value, const char* unit, double bound) {
  result_.figures.push_back(experiments::at_most(figure, value, unit, bound));
}

void ConsoleBench::time_first_image() {
  for (std::int64_t start = 0; start < config_.starts; ++start) {
    const double begun_s = now_s();
    common::ChildProcess child({program_, "console", "--virtual", "--no-open", "--port", "0", "--out",
                                folder_ + "/start-" + std::to_string(start)});
    std::string told;
    std::smatch port;
    const std::regex url("http://[^:]+:([0-9]+)/");
    while (!std::regex_search(told, port, url)) {
      const auto part = child.read(1.0);
      if (!part || now_s() - begun_s > kPatience_s)
        throw common::HardwareError("bench console: the console did not start: " + told);
      told += *part;
    }
    PageClient page(static_cast<std::uint16_t>(std::stoi(port[1])));
    page.want("image");
    bool seen = false;
    while (!seen && now_s() - begun_s < kPatience_s)
      if (const auto heard = page.hear(1.0)) seen = heard->image;
    if (!seen) throw common::HardwareError("bench console: there was no image within a minute");
    result_.first_image_s.push_back(now_s() - begun_s);
    child.interrupt();
    while (child.read(1.0)) {
    }
    child.finish();
    pause(0.0);
  }
  add("first image after the command, median", percentile(result_.first_image_s, 0.5), "s",
      config_.first_image_bound_s);
}

void ConsoleBench::time_one_page() {
  EmulatedConsole bench(config_, folder_);
  Viewer page(bench.console->port(), true);
  arm(*bench.console, page);
  const double begun_s = now_s();
  const double served_s = serving_s();
  const std::int64_t images = page.images();
  pause(config_.look_s);
  const double looked_s = now_s() - begun_s;
  result_.server_share = (serving_s() - served_s) / looked_s;
  result_.images_per_s = static_cast<double>(page.images() - images) / looked_s;
  std::vector<double> ages_ms;
  for (const double age_s : page.ages_s()) ages_ms.push_back(1e3 * age_s);
  ages_ms.erase(ages_ms.begin(), ages_ms.begin() + images);
  result_.image_median_ms = percentile(ages_ms, 0.5);
  result_.image_p99_ms = percentile(ages_ms, 0.99);
  add("image from camera to page, median", *result_.image_median_ms, "ms", config_.image_bound_ms);
  add("serving one page", *result_.server_share, "processors", config_.server_bound);

  const ImageMap map(*bench.console->state().camera);
  common::RandomStream random(static_cast<std::uint64_t>(config_.deployment.seed), "clicks");
  const double radius_m = 0.5 * config_.deployment.rig.dish.radius_m;
  for (std::int64_t click = 0; click < config_.clicks; ++click) {
    const geometry::Vector2 at_m = task::draw_in_disc(radius_m, random);
    const double clicked_s = now_s();
    page.say({{"do", "go"}, {"to", map.json(at_m)}});
    for (const double until_s = clicked_s + kPatience_s; bench.pulses.last_wall_s() < clicked_s;
         pause(0.0005))
      if (now_s() > until_s)
        throw common::HardwareError("bench console: a click led to no pulse: " +
                                    bench.console->state().reason);
    result_.click_ms.push_back(1e3 * (bench.pulses.last_wall_s() - clicked_s));
    pause(2.0);
    page.say({{"do", "end"}});
    wait_for(*bench.console, Mode::kArmed);
    pause(random.uniform(0.3, 0.8));  // at any time of a look
  }
  add("click to first pulse, largest", percentile(result_.click_ms, 1.0), "ms",
      1e3 * config_.deployment.loop.period_s());
}

void ConsoleBench::drive_before_many() {
  result_.square = drive_square("alone");
  const experiments::BusyProcessors busy;
  result_.busy_square = drive_square("on a busy machine");
}

WatchedSquare ConsoleBench::drive_square(const std::string& how) {
  EmulatedConsole bench(config_, folder_);
  Viewer page(bench.console->port(), true);
  arm(*bench.console, page);
  std::vector<std::unique_ptr<Viewer>> others;
  for (std::int64_t i = 1; i < config_.viewers; ++i)
    others.push_back(std::make_unique<Viewer>(bench.console->port(), false));
  PageClient mute(bench.console->port());  // asks, and never reads
  for (int i = 0; i < 20; ++i) mute.want("image");
  common::log_info("bench console: a square before " + std::to_string(config_.viewers) + " pages, " + how);
  page.say({{"do", "draw"}, {"shape", "square"}});
  pause(0.2);
  const double begun_s = now_s();
  const std::int64_t from = bench.pulses.pulses();
  const std::int64_t images = page.images();
  page.say({{"do", "follow"}});
  wait_for(*bench.console, Mode::kRunning);
  while (bench.console->state().mode == Mode::kRunning) {
    pause(0.1);
    try {
      mute.want("image");
    } catch (const common::IoError&) {
      // Nobody has to keep a page that does not read.
    }
  }
  WatchedSquare square;
  const BenchState after = bench.console->state();
  if (after.mode != Mode::kArmed) square.stop_reason = after.reason;
  square.pulses = bench.pulses.pulses() - from;
  square.images_per_s = static_cast<double>(page.images() - images) / (now_s() - begun_s);
  square.lost_real_time_s = bench.rig.bench->lost_s();
  const std::vector<double> deviations_ms =
      bench.pulses.deviations_ms(config_.deployment.loop.period_s(), from);
  if (deviations_ms.empty())
    throw common::HardwareError("bench console: the square had no pulses: " + after.reason);
  static_cast<experiments::PeriodDeviation&>(square) = experiments::PeriodDeviation(deviations_ms);
  add("control period " + how + ": deviation, p99", square.deviation_p99_ms, "ms", config_.jitter_bound_ms);
  add("square " + how + ": not finished", square.stop_reason.empty() ? 0.0 : 1.0, "", 0.0);
  return square;
}

}  // namespace lodestone::console
