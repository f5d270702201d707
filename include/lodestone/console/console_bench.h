#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/json.h"
#include "lodestone/experiments/bounded_figure.h"
#include "lodestone/experiments/deployment.h"
#include "lodestone/experiments/period_deviation.h"

namespace lodestone::console {

/// What `bench console` measures, and what it must keep to.
struct ConsoleBenchConfig {
  experiments::DeploymentConfig deployment;
  std::int64_t threads = 1;
  std::string dynamics;
  std::int64_t starts = 5;
  double look_s = 10.0;
  std::int64_t clicks = 20;
  std::int64_t viewers = 10;
  double first_image_bound_s = 2.0;
  double image_bound_ms = 120.0;
  double server_bound = 0.25;
  double jitter_bound_ms = 5.0;

  ConsoleBenchConfig() {
    deployment.loop.rest_s = 0.2333;  // a period of a third of a second
    deployment.loop.decide_s = 0.12;
  }
  template <class Visitor>
  void visit(Visitor& v) {
    deployment.visit(v);
    v.field("threads", threads, "", "not used", {0, 1024});
    v.field("dynamics", dynamics, "",
            "folder of the dynamics checkpoint that the planner plans in; empty: the baseline drives");
    v.field("starts", starts, "", "programs to start, for the time to the first image", {1, 1000});
    v.field("look_s", look_s, "s", "how long one page looks on, for the age of its images", {1.0, 3600.0});
    v.field("clicks", clicks, "", "targets to click on", {1, 10000});
    v.field("viewers", viewers, "", "pages that look on at 20 images a second while squares are driven",
            {0, 30});
    v.field("first_image_bound_s", first_image_bound_s, "s", "median from the command to the first image",
            {0.1, 100.0});
    v.field("image_bound_ms", image_bound_ms, "ms", "median from the camera to a page", {1.0, 10000.0});
    v.field("server_bound", server_bound, "processors",
            "of what serves one page, beside localiser and camera", {0.01, 10.0});
    v.field("jitter_bound_ms", jitter_bound_ms, "ms", "99th percentile of the period's deviation",
            {0.1, 1000.0});
  }
  void validate() const { deployment.rig.validate(); }
};

/// A square under the eyes of many.
struct WatchedSquare : experiments::PeriodDeviation {
  std::int64_t pulses = 0;
  double images_per_s = 0.0;  ///< of each page that reads
  double lost_real_time_s = 0.0;
  std::string stop_reason;  ///< empty: it was driven to its end

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("pulses", pulses);
    experiments::PeriodDeviation::visit(v);
    v.field("images_per_s", images_per_s);
    v.field("lost_real_time_s", lost_real_time_s);
    v.field("stop_reason", stop_reason);
  }
};

/// `console.json`. A part that was not measured is absent.
struct ConsoleBenchResult {
  static constexpr const char* kFile = "console.json";
  common::Json machine;
  std::vector<double> first_image_s;
  std::optional<double> image_median_ms, image_p99_ms, images_per_s;
  std::optional<double> server_share;  ///< of one processor
  std::vector<double> click_ms;        ///< to the first pulse
  std::optional<WatchedSquare> square, busy_square;
  std::vector<experiments::BoundedFigure> figures;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("machine", machine);
    v.field("first_image_s", first_image_s);
    v.field("image_median_ms", image_median_ms);
    v.field("image_p99_ms", image_p99_ms);
    v.field("images_per_s", images_per_s);
    v.field("server_share", server_share);
    v.field("click_ms", click_ms);
    v.field("square", square);
    v.field("busy_square", busy_square);
    v.field("figures", figures);
  }
};

/// Measures the console in front of an emulated bench (the real firmware, a GigE Vision camera), part by
/// part. They throw HardwareError where there is no emulator, and Interrupted.
class ConsoleBench {
 public:
  /// `folder` exists; `program` is this one, which is started for the first part. `config` must outlive the
  /// bench.
  ConsoleBench(const ConsoleBenchConfig& config, std::string folder, std::string program);

  void time_first_image();
  /// One page looks on, and clicks.
  void time_one_page();
  /// Squares before all viewers and one page that reads nothing, alone and with every processor busy.
  void drive_before_many();
  const ConsoleBenchResult& result() const { return result_; }

 private:
  WatchedSquare drive_square(const std::string& how);
  void add(const std::string& figure, double value, const char* unit, double bound);

  const ConsoleBenchConfig& config_;
  std::string folder_, program_;
  ConsoleBenchResult result_;
};

}  // namespace lodestone::console
