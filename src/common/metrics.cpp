#include "lodestone/common/metrics.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "lodestone/common/clock.h"
#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/tensorboard.h"

namespace lodestone::common {
namespace {

/// Drops lines beyond a step, and a last one that was left half-written.
void trim(const std::string& path, std::int64_t last_step) {
  if (!std::filesystem::exists(path)) return;
  const std::string content = read_file(path);
  std::istringstream lines(content);
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    const std::optional<Json> row = find_json(line);
    if (!row || !row->is_object()) continue;
    const auto step = row->find("step");
    const bool keep = step == row->end()
                          ? last_step == kEveryStep
                          : step->is_number() && step->get<double>() <= static_cast<double>(last_step);
    if (keep) kept += line + "\n";
  }
  if (kept != content) write_file_atomically(path, kept);
}

/// {"a": {"b": 1}} as {"a.b": 1}; lists stay whole.
void flatten(const Json& json, const std::string& before, Json& flat) {
  for (const auto& [key, value] : json.items())
    if (value.is_object())
      flatten(value, before + key + ".", flat);
    else
      flat[before + key] = value;
}

Json flat(const Json& json) {
  Json made = Json::object();
  flatten(json, "", made);
  return made;
}

}  // namespace

MetricsLog::MetricsLog(std::string folder, std::int64_t last_step, double earlier_s, Json config)
    : folder_(std::move(folder)),
      last_step_(last_step),
      earlier_s_(earlier_s),
      config_(std::move(config)),
      start_s_(SteadyClock().now_s()) {
  trim(folder_ + "/metrics.jsonl", last_step);
}

MetricsLog::~MetricsLog() = default;

void MetricsLog::write(std::int64_t step, const Scalars& scalars) {
  const std::string path = folder_ + "/metrics.jsonl";
  if (!lines_.is_open()) lines_.open(path, std::ios::app);
  const double wall_s = earlier_s_ + SteadyClock().now_s() - start_s_;
  Json line = {{"step", step}, {"wall_s", std::round(wall_s * 1e3) / 1e3}};
  for (const auto& [name, value] : scalars) line[name] = value;
  lines_ << line.dump() << std::endl;
  if (!lines_) throw IoError("cannot write " + path + ": " + std::strerror(errno));
  events().write(step, scalars);
}

void MetricsLog::write_image(std::int64_t step, const std::string& tag, std::string_view png,
                             std::int64_t width, std::int64_t height) {
  events().write_image(step, tag, png, width, height);
}

void MetricsLog::write_result(std::int64_t step, const Json& result) {
  Scalars figures;
  const Json values = flat(result);
  for (const auto& [key, value] : values.items())
    if (value.is_number()) figures.emplace_back("final/" + key, value.get<double>());
  events().write(step, figures);
  events().end_session();
}

TensorBoardWriter& MetricsLog::events() {
  if (!events_) {
    events_ = std::make_unique<TensorBoardWriter>(folder_);
    if (last_step_ != kEveryStep) events_->start_at(last_step_ == kNoStep ? 0 : last_step_ + 1);
    if (!config_.empty()) {
      events_->write_text(0, "config", "```json\n" + config_.dump(2) + "\n```\n");
      events_->start_session(flat(config_));
    }
  }
  return *events_;
}

}  // namespace lodestone::common
