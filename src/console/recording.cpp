#include "lodestone/console/recording.h"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>
#include <thread>

#include "lodestone/common/clock.h"
#include "lodestone/common/csv_table.h"
#include "lodestone/common/error.h"
#include "lodestone/common/thread_name.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/imaging/annotate.h"
#include "lodestone/imaging/video_writer.h"

namespace lodestone::console {
namespace {

using common::Json;

constexpr double kFrame_s = 0.1;
constexpr double kScale = 0.6;  // of the camera's image

// What is not known is an empty cell.
const std::vector<std::string> kColumns = {
    "time_s",       "x_mm",         "y_mm",         "heading_deg",  "target_x_mm", "target_y_mm", "error_mm",
    "current_px_A", "current_mx_A", "current_py_A", "current_my_A", "pose_age_ms", "jitter_ms"};

std::string cell(const std::optional<double>& value) { return value ? fmt::format("{:.6g}", *value) : ""; }

std::string row(const BenchSample& sample, double start_s, bool sphere) {
  const auto& pose = sample.pose;
  const auto& target_m = sample.target_m;
  const auto of = [](const auto& known, auto&& value) {
    return known ? std::optional<double>(value(*known)) : std::nullopt;
  };
  std::vector<std::optional<double>> values = {
      sample.time_s - start_s,
      of(pose, [](const auto& p) { return 1e3 * p.x_m; }),
      of(pose, [](const auto& p) { return 1e3 * p.y_m; }),
      sphere ? std::nullopt : of(pose, [](const auto& p) { return geometry::kDegPerRad * p.heading_rad; }),
      of(target_m, [](const auto& t) { return 1e3 * t.x(); }),
      of(target_m, [](const auto& t) { return 1e3 * t.y(); }),
      sample.error_mm};
  values.insert(values.end(), sample.current_A.begin(), sample.current_A.end());
  values.insert(values.end(), {sample.pose_age_ms, sample.jitter_ms});
  std::string line;
  for (const auto& value : values) line += (line.empty() ? "" : ",") + cell(value);
  return line;
}

std::string joined_columns() {
  std::string line;
  for (const std::string& column : kColumns) line += (line.empty() ? "" : ",") + column;
  return line;
}

/// A name as we give them: nothing that leads elsewhere.
bool is_name(const std::string& name) {
  return !name.empty() && name.size() < 64 && std::all_of(name.begin(), name.end(), [](unsigned char letter) {
    return std::isalnum(letter) != 0 || letter == '-' || letter == '_';
  });
}

double last_time_s(const std::string& file) {
  double last_s = 0.0;
  common::CsvTable table(file);
  const std::size_t column = table.column("time_s");
  while (table.next()) last_s = table.number(column);
  return last_s;
}

std::size_t rows_of(const std::string& file) {
  std::size_t rows = 0;
  common::CsvTable table(file);
  while (table.next()) ++rows;
  return rows;
}

bool is_there(const std::string& file) {
  std::error_code unknown;
  return std::filesystem::exists(file, unknown);
}

}  // namespace

struct Recording::State {
  State(const std::string& path, Source from) : source(std::move(from)), file(path) {
    rows.open(file + ".csv", std::ios::trunc);
    rows << joined_columns() << std::endl;
    if (!rows) throw common::IoError(file + ".csv cannot be written: check that the disk has room");
    annotation.bench = source.bench;
    annotation.max_current_A = source.max_current_A;
    thread = std::thread([this] { run(); });
  }

  Source source;
  std::string file;
  std::ofstream rows;
  imaging::Annotation annotation;
  std::unique_ptr<imaging::VideoWriter> video;
  std::optional<double> start_s;
  std::int64_t samples = 0;
  std::atomic<bool> over{false};
  std::thread thread;

  void run() {
    common::name_thread("recording");
    common::SteadyClock wall;
    try {
      for (double next_s = wall.now_s(); !over; next_s += kFrame_s) {
        record(source.state(), source.image());
        wall.sleep_until(next_s + kFrame_s);
      }
      if (video) video->finish();
    } catch (const common::Error& error) {
      source.failed(error.what());
    }
  }

  void record(const BenchState& state, const std::shared_ptr<const imaging::Frame>& frame) {
    if (state.sample && state.samples != samples) {
      samples = state.samples;
      if (!start_s) start_s = state.sample->time_s;
      rows << row(*state.sample, *start_s, source.bench.sphere) << std::endl;
      if (!rows) throw common::IoError(file + ".csv cannot be written: the disk is full");
    }
    if (!frame || !start_s) return;  // film and rows begin together
    cv::Mat image = frame->image.clone();
    if (state.camera) draw(state, image);
    if (!video)
      video = std::make_unique<imaging::VideoWriter>(file + ".mp4", image.size(), 1.0 / kFrame_s, kScale);
    video->write(image);
  }

  void draw(const BenchState& state, cv::Mat& image) {
    annotation.pose.reset();
    annotation.error_m.reset();
    annotation.no_pose_reason = state.pose ? state.pose->reason : "";
    if (state.pose && state.pose->valid) {
      annotation.pose = state.pose->pose;
      annotation.position_sigma_m = state.pose->position_sigma_m;
      annotation.last_seen_m = state.pose->pose.position_m();
      if (state.target_m) annotation.error_m = (*state.target_m - *annotation.last_seen_m).norm();
    }
    annotation.target_m = state.target_m;
    annotation.target_heading_rad = state.target_heading_rad;
    annotation.reference_m = state.plan_m;
    annotation.reference_headings = state.plan_headings;
    annotation.travelled_m = {state.trail_m};
    annotation.coil_current_A = state.on_A.list();
    annotation.task = state.run ? state.run->task : common::name_of(state.mode);
    annotation.time_s = state.now_s - *start_s;
    imaging::annotate(image, *state.camera, annotation);
  }
};

Recording::Recording(const std::string& folder, const std::string& name, Source source)
    : state_(std::make_unique<State>(folder + "/" + name, std::move(source))) {}

Recording::~Recording() {
  state_->over = true;
  state_->thread.join();
}

std::vector<RecordingInfo> recordings_in(const std::string& folder) {
  std::vector<RecordingInfo> found;
  std::error_code failed;
  for (std::filesystem::directory_iterator entry(folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const std::string name = entry->path().stem().string();
    if (entry->path().extension() != ".csv" || !is_name(name)) continue;
    try {
      found.push_back({name, is_there(folder + "/" + name + ".mp4"), last_time_s(entry->path().string())});
    } catch (const common::Error&) {
      // Cut off by a kill in its first line: nothing to see.
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.name > b.name; });
  return found;
}

std::string new_recording_name(const std::string& folder) {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  const std::string time = fmt::format("{:%Y%m%d-%H%M%S}", fmt::gmtime(now));
  std::string name = time;
  for (int again = 2; is_there(folder + "/" + name + ".csv"); ++again)
    name = fmt::format("{}-{}", time, again);
  return name;
}

Json read_recording(const std::string& folder, const std::string& name) {
  if (!is_name(name)) throw common::DataError("there is no such recording");
  const std::string file = folder + "/" + name + ".csv";
  const std::size_t rows = rows_of(file), step = rows / kMostReplayed + 1;
  common::CsvTable table(file);
  Json samples = Json::array();
  const auto value = [&](const std::string& column) -> Json {
    const std::size_t at = table.column(column);
    return table.text(at).empty() ? Json() : Json(table.number(at));
  };
  for (std::size_t row = 0; table.next(); ++row) {
    table.check_width();
    if (row % step != 0) continue;
    Json sample;
    for (const char* column :
         {"time_s", "x_mm", "y_mm", "heading_deg", "error_mm", "pose_age_ms", "jitter_ms"})
      sample[column] = value(column);
    const Json target_x = value("target_x_mm");
    sample["target_mm"] = target_x.is_null() ? Json() : Json({target_x, value("target_y_mm")});
    sample["current_A"] = {value("current_px_A"), value("current_mx_A"), value("current_py_A"),
                           value("current_my_A")};
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace lodestone::console
