#include "lodestone/console/run_list.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "lodestone/common/error.h"
#include "lodestone/console/recording.h"
#include "lodestone/runs/plan.h"

namespace lodestone::console {
namespace {

using common::Json;

bool is_plain(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '0' && letter <= '9') || std::string("-._~/").find(letter) != std::string::npos;
}

std::vector<runs::StatusRow> rows_below(const std::string& folder) {
  try {
    return runs::status_of(folder);
  } catch (const common::ConfigError&) {
    return {};  // a folder without runs
  }
}

const char* state_of(const runs::StatusRow& row) {
  return row.state->finished ? "finished" : row.running ? "running" : "stopped";
}

}  // namespace

std::string percent_encoded(const std::string& path) {
  std::string address;
  for (const char letter : path)
    address += is_plain(letter) ? std::string(1, letter)
                                : fmt::format("%{:02X}", static_cast<unsigned char>(letter));
  return address;
}

Json run_list(const std::string& folder) {
  Json runs = Json::array();
  for (const runs::StatusRow& row : rows_below(folder)) {
    if (!row.state) continue;
    std::error_code unknown;
    const bool report = std::filesystem::exists(row.path + "/report.html", unknown);
    const std::string name = std::filesystem::path(row.path).lexically_relative(folder).string();
    runs.push_back({{"name", name},
                    {"verb", row.state->verb},
                    {"state", state_of(row)},
                    {"done", row.state->done},
                    {"total", row.state->total},
                    {"unit", row.state->unit},
                    {"note", row.state->note},
                    {"updated_utc", row.state->updated_utc},
                    {"report", report ? Json(kRuns + percent_encoded(name) + "/report.html") : Json()}});
  }
  return runs;
}

Json recording_list(const std::string& folder) {
  Json films = Json::array();
  for (const RecordingInfo& info : recordings_in(folder))
    films.push_back({{"name", info.name},
                     {"video", info.video ? Json(kRecordings + info.name + ".mp4") : Json()},
                     {"seconds", info.seconds}});
  return films;
}

}  // namespace lodestone::console
