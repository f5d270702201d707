#include "lodestone/runs/plan.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>
#include <system_error>
#include <utility>

#include "hand_written.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"

namespace lodestone::runs {
namespace {

namespace fs = std::filesystem;
using common::ConfigError;
using common::Json;

constexpr const char* kPlanFile = "/plan.json";
constexpr std::size_t kLargestPlan = 256 << 20;  // bytes of a file: a million cells
constexpr std::int64_t kLeastMinutes = 3;        // a cell is told to save one minute before its time is up
const std::set<std::string> kVerbs = {"adapt",  "bench oracle",   "bench rigs",   "collect",
                                      "deploy", "train-dynamics", "train-policy", "train-segmenter"};

/// Calls `use` with every {ID} of a text, and puts in its place what that returns.
template <class Use>
std::string with_folders(std::string text, Use use) {
  for (std::size_t open = text.find('{'); open != std::string::npos;) {
    const std::size_t close = text.find('}', open);
    if (close == std::string::npos) break;
    const std::string folder = use(text.substr(open + 1, close - open - 1));
    text.replace(open, close - open + 1, folder);
    open = text.find('{', open + folder.size());
  }
  return text;
}

/// All keys of a cell.
Json known_of_cell() {
  Cell cell;
  cell.seed = cell.memory_mb = cell.minutes = 1;
  return common::artefact_to_json(cell);
}

/// All keys of a plan.
Json known_of_plan() {
  Plan plan;
  plan.memory_mb = plan.minutes = 1;
  return common::artefact_to_json(plan);
}

void check_limits(const std::optional<std::int64_t>& memory_mb, const std::optional<std::int64_t>& minutes,
                  const std::string& what) {
  if (memory_mb.value_or(1) < 1)
    throw ConfigError(what + ": memory_mb = " + std::to_string(*memory_mb) + " must be at least 1");
  if (minutes.value_or(kLeastMinutes) < kLeastMinutes)
    throw ConfigError(what + ": minutes = " + std::to_string(*minutes) + " must be at least " +
                      std::to_string(kLeastMinutes));
}

/// An id is a folder below the plan's, and none of the engines' own.
void check_id(const std::string& id, const std::string& subfolder) {
  const auto fail = [&](const std::string& why) { throw ConfigError("cell \"" + id + "\": " + why); };
  std::istringstream parts(id + "/");
  for (std::string part; std::getline(parts, part, '/');)
    if (part.empty() || part == "." || part.find("..") != std::string::npos)
      fail("an id is the name of a folder below the plan's");
  for (const char* own : {"stamps", "slurm", "stop", "plan.json", "run.json", "config.json", "manifest.json",
                          "preset.json", "build.ninja", "ninja.log"})
    if (subfolder.empty() && id.substr(0, id.find('/')) == own)
      fail(std::string(own) + " is the plan's own; choose another id");
  if (id.size() > 4 && id.compare(id.size() - 4, 4, ".log") == 0)
    fail("what ends in .log is what another cell says; choose another id");
}

}  // namespace

std::vector<std::string> Cell::needs() const {
  std::vector<std::string> ids;
  for (const std::string& setting : settings)
    with_folders(setting, [&](const std::string& id_of_other) {
      if (std::find(ids.begin(), ids.end(), id_of_other) == ids.end()) ids.push_back(id_of_other);
      return std::string();
    });
  return ids;
}

const Cell* Plan::find(const std::string& id) const {
  const auto found =
      std::find_if(cells.begin(), cells.end(), [&](const Cell& cell) { return cell.id == id; });
  return found == cells.end() ? nullptr : &*found;
}

void check_verb(const std::string& verb, const std::string& what) {
  if (kVerbs.count(verb) > 0) return;
  std::string known;
  for (const std::string& each : kVerbs) known += (known.empty() ? "" : ", ") + each;
  throw ConfigError(what + ": verb = \"" + verb + "\" is none that goes on where it was: " + known);
}

void Plan::validate() const {
  if (cells.empty()) throw ConfigError("a plan needs at least one cell");
  check_limits(memory_mb, minutes, "the plan");
  std::set<std::string> before;
  for (const Cell& cell : cells) {
    check_id(cell.id, subfolder);
    const std::string what = "cell \"" + cell.id + "\"";
    check_verb(cell.verb, what);
    for (const std::string& need : cell.needs())
      if (before.count(need) == 0)
        throw ConfigError(what + " needs {" + need + "}, which is no cell before it in the plan");
    check_limits(cell.memory_mb, cell.minutes, what);
    if (!before.insert(cell.id).second) throw ConfigError(what + " is in the plan twice");
  }
  for (const Cell& cell : cells)
    for (std::size_t end = cell.id.find('/'); end != std::string::npos; end = cell.id.find('/', end + 1))
      if (before.count(cell.id.substr(0, end)) > 0)
        throw ConfigError("cell \"" + cell.id + "\" would lie in the folder of cell \"" +
                          cell.id.substr(0, end) + "\"");
}

Plan read_plan(const std::string& path) {
  Json json = common::read_json_file(path, kLargestPlan);
  Json whole = common::artefact_to_json(Plan{});
  if (!json.is_object() || !json.contains("cells") || !json["cells"].is_array())
    throw ConfigError(path + ": a plan is an object with a list \"cells\"");
  check_hand_written(json, known_of_plan(), path);
  const Json known = known_of_cell();
  const Json defaults = common::artefact_to_json(Cell{});
  for (Json& cell : json["cells"]) {
    if (!cell.is_object()) throw ConfigError(path + ": a cell must be a JSON object {...}");
    check_hand_written(cell, known, path + ": a cell");
    Json completed = defaults;
    completed.update(cell);
    cell = std::move(completed);
  }
  whole.update(json);
  return common::artefact_from_json<Plan>(whole, path);
}

std::string preset_file(const PlanPlace& place, const Cell& cell) {
  return (fs::path(place.configs) / cell.config).string();
}

std::string cell_folder(const Plan& plan, const PlanPlace& place, const std::string& id) {
  return place.folder + "/" + (plan.subfolder.empty() ? "" : plan.subfolder + "/") + id;
}

std::vector<std::string> cell_arguments(const Plan& plan, const PlanPlace& place, const Cell& cell) {
  std::vector<std::string> out;
  std::istringstream words(cell.verb);
  for (std::string word; words >> word;) out.push_back(word);
  const auto add = [&out](const char* flag, const std::string& value) {
    out.insert(out.end(), {flag, value});
  };
  if (!cell.config.empty()) add("--config", preset_file(place, cell));
  if (!place.rig_file.empty()) add("--rig", place.rig_file);
  for (const std::string& setting : cell.settings)
    add("--set", with_folders(setting, [&](const std::string& id) { return cell_folder(plan, place, id); }));
  add("--seed", std::to_string(cell.seed.value_or(plan.seed) + cell.seed_offset));
  add("--threads", std::to_string(cell.all_threads ? place.threads : place.cell_threads));
  add("--out", cell_folder(plan, place, cell.id));
  out.emplace_back("--resume");
  return out;
}

void write_plan(const Plan& plan, const std::string& folder) {
  common::make_folders(folder);
  common::write_artefact(folder + kPlanFile, plan);
}

bool holds_plan(const std::string& folder) { return fs::exists(folder + kPlanFile); }

Plan find_plan(const std::string& folder) {
  auto plan = common::find_artefact<Plan>(folder + kPlanFile);
  if (!plan)
    throw ConfigError(folder + " holds no plan (" + (kPlanFile + 1) + "): name a folder that one was run in");
  return std::move(*plan);
}

namespace {

/// Folders may come and go meanwhile, and links lead nowhere: what cannot be looked at is passed over.
void find_runs_below(const std::string& folder, std::vector<std::string>& found) {
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    std::error_code unknown;
    if (!entry->is_directory(unknown)) continue;
    const std::string path = entry->path().string();
    if (find_run(path))
      found.push_back(path);
    else if (!entry->is_symlink(unknown))
      find_runs_below(path, found);
  }
}

}  // namespace

std::string last_said(const std::string& log) {
  if (!fs::exists(log)) return "it said nothing";
  std::istringstream lines(common::read_file(log));
  std::string last = "it said nothing";
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) last = line.substr(line.find_last_of('\r') + 1);
  return last;
}

std::vector<StatusRow> status_of(const std::string& folder) {
  std::vector<StatusRow> rows;
  std::error_code unknown;
  const auto add = [&rows, &unknown](const std::string& name, const std::string& path) {
    const bool there = fs::is_directory(path, unknown);
    rows.push_back({name, there ? find_run(path) : std::nullopt, there && is_running(path), path});
  };
  if (const auto plan = common::find_artefact<Plan>(folder + kPlanFile)) {
    std::set<std::string> open;
    for (const Cell& cell : plan->cells) {
      add(cell.id, cell_folder(*plan, {folder, "", ""}, cell.id));
      StatusRow& row = rows.back();
      if (row.state && row.state->finished) continue;
      open.insert(cell.id);
      if (row.running) continue;
      for (const std::string& need : cell.needs())
        if (row.waits_for.empty() && open.count(need) > 0) row.waits_for = need;
      if (row.waits_for.empty() && fs::exists(row.path + ".log")) row.failure = last_said(row.path + ".log");
    }
  } else if (find_run(folder)) {
    add(folder, folder);
  } else if (fs::is_directory(folder, unknown)) {
    std::vector<std::string> found;
    find_runs_below(folder, found);
    std::sort(found.begin(), found.end());
    for (const std::string& path : found) add(path, path);
  }
  if (rows.empty())
    throw ConfigError("status: " + folder + " holds no run and no plan; name the --out of a run");
  return rows;
}

}  // namespace lodestone::runs
