#include "lodestone/runs/sweep.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <set>
#include <utility>

#include "hand_written.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/common/statistics.h"

namespace lodestone::runs {
namespace {

namespace fs = std::filesystem;
using common::ConfigError;
using common::Json;

constexpr double kLargestWhole = 9007199254740992.0;  // 2^53: every whole number below is a double

/// One value of one key.
struct Choice {
  std::string key;
  std::string value;  ///< as --set reads it
};

std::string last_part(const std::string& key) { return key.substr(key.rfind('.') + 1); }

/// Names are folders, too.
std::string as_name(const std::string& text) {
  std::string out;
  for (const char c : text) out += std::string("/{}\"\\ ").find(c) == std::string::npos ? c : '_';
  for (std::size_t dots = out.find(".."); dots != std::string::npos; dots = out.find("..")) out[dots] = '_';
  return out;
}

SweepPoint point_of(const std::vector<Choice>& choices) {
  SweepPoint point;
  for (const Choice& choice : choices) {
    const bool ambiguous = std::count_if(choices.begin(), choices.end(), [&](const Choice& other) {
                             return last_part(other.key) == last_part(choice.key);
                           }) > 1;
    point.name += (point.name.empty() ? "" : ",") + as_name(ambiguous ? choice.key : last_part(choice.key)) +
                  "=" + as_name(choice.value);
    point.settings.push_back(choice.key + "=" + choice.value);
  }
  if (point.name.empty()) point.name = "as_it_is";
  return point;
}

std::string value_text(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

Choice draw(const std::string& key, const SweepRange& range, common::RandomStream& random) {
  double value = range.log ? std::exp(random.uniform(std::log(range.from), std::log(range.to)))
                           : random.uniform(range.from, range.to);
  if (range.whole) return {key, std::to_string(std::llround(value))};
  const double unit = std::pow(10.0, 3.0 - std::floor(std::log10(std::max(std::abs(value), 1e-300))));
  value = std::round(value * unit) / unit;  // four digits: what is read is what is run
  return {key, Json(value).dump()};
}

/// Every combination of the grid.
std::vector<std::vector<Choice>> combinations(const std::map<std::string, std::vector<Json>>& grid) {
  std::vector<std::vector<Choice>> all(1);
  for (const auto& [key, values] : grid) {
    std::vector<std::vector<Choice>> longer;
    for (const auto& before : all)
      for (const Json& value : values) {
        longer.push_back(before);
        longer.back().push_back({key, value_text(value)});
      }
    all = std::move(longer);
  }
  return all;
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Dotted names of all numbers in a file of results.
void numbers_in(const Json& json, const std::string& path, std::vector<std::string>& out) {
  if (json.is_number()) out.push_back(path);
  if (!json.is_object()) return;
  for (const auto& [key, value] : json.items()) numbers_in(value, path.empty() ? key : path + "." + key, out);
}

bool better(const Sweep& sweep, double a, double b) { return sweep.lower_is_better ? a < b : a > b; }

}  // namespace

std::int64_t SweepHalving::budget(std::int64_t rung) const {
  std::int64_t out = first;
  for (std::int64_t r = 1; r < rung; ++r) out *= factor;
  return out;
}

void Sweep::check(const std::string& source) const {
  const auto fail = [&](const std::string& what) { throw ConfigError(source + ": " + what); };
  if (verb.empty()) fail("verb is missing: name what is run, such as \"train-policy\"");
  if (score.find('.') == std::string::npos)
    fail("score = \"" + score +
         "\" must name a file of a run and a number in it, such as \"result.success_rate\"");
  if (seeds < 1 || seeds > 100000) fail("seeds = " + std::to_string(seeds) + " must be within [1, 100000]");
  const auto refuse_seed = [&](const std::string& key) {
    if (key == "seed") fail("seed is no setting of a sweep: seeds and first_seed say which ones are run");
  };
  for (const std::string& each : settings) refuse_seed(each.substr(0, each.find('=')));
  if (halving) refuse_seed(halving->key);
  if (first_seed < 0) fail("first_seed = " + std::to_string(first_seed) + " must not be below 0");
  for (const auto& [key, values] : grid) {
    refuse_seed(key);
    if (values.empty()) fail("grid." + key + " holds no value");
    std::set<std::string> seen;
    for (const Json& value : values)
      if (!seen.insert(value_text(value)).second) fail("grid." + key + " holds " + value.dump() + " twice");
    if (random && random->ranges.count(key) > 0) fail(key + " is both in grid and in random.ranges");
    if (halving && halving->key == key) fail(key + " is both in grid and the budget of halving");
  }
  if (random) {
    if (random->count < 1 || random->count > 1000000)
      fail("random.count = " + std::to_string(random->count) + " must be within [1, 1000000]");
    if (random->ranges.empty()) fail("random.ranges is missing: name keys with \"from\" and \"to\"");
    for (const auto& [key, range] : random->ranges) {
      refuse_seed(key);
      if (!(range.from < range.to)) fail("random.ranges." + key + ": from must be below to");
      if (range.log && !(range.from > 0.0))
        fail("random.ranges." + key + ": from must be above 0 on a logarithmic scale");
      if (range.whole && std::max(std::abs(range.from), std::abs(range.to)) > kLargestWhole)
        fail("random.ranges." + key + ": whole numbers lie within 2^53 of zero");
    }
  }
  if (halving) {
    if (halving->key.empty()) fail("halving.key is missing: name the budget, such as \"training.env_steps\"");
    if (halving->first < 1) fail("halving.first = " + std::to_string(halving->first) + " must be at least 1");
    if (halving->factor < 2)
      fail("halving.factor = " + std::to_string(halving->factor) + " must be at least 2");
    if (halving->rungs < 1 || halving->rungs > 20)
      fail("halving.rungs = " + std::to_string(halving->rungs) + " must be within [1, 20]");
    double last = static_cast<double>(halving->first);
    for (std::int64_t rung = 1; rung < halving->rungs; ++rung) last *= static_cast<double>(halving->factor);
    if (last > kLargestWhole)
      fail("halving: " + halving->key + " of the last rung, first * factor^(rungs - 1), is beyond 2^53");
  }
}

Sweep read_sweep(const std::string& path) {
  Json json = common::read_json_file(path);
  Sweep all;
  all.random.emplace();
  all.halving.emplace();
  Json known = common::artefact_to_json(all);
  if (!json.is_object()) throw ConfigError(path + ": a sweep is an object with \"verb\" and \"score\"");
  for (auto entry = json.begin(); entry != json.end();)
    entry = entry->is_null() ? json.erase(entry) : std::next(entry);  // as if left out
  if (json.contains("config") && json["config"].is_string()) json["config"] = Json::array({json["config"]});
  check_hand_written(json, known, path);
  for (const char* list : {"config", "settings"})
    for (const Json& item : json.value(list, Json::array()))
      if (!item.is_string())
        throw ConfigError(path + ": " + list + " must hold texts, not " + common::shown_json(item));
  const Json grid = json.value("grid", Json::object());
  for (const auto& [key, values] : grid.items())
    if (!values.is_array())
      throw ConfigError(path + ": grid." + key + " = " + common::shown_json(values) +
                        " must be a list of the values to try");
  Json whole = common::artefact_to_json(Sweep{});
  whole.update(json);
  for (const char* part : {"random", "halving"}) {
    if (!json.contains(part)) continue;
    check_hand_written(json[part], known[part], path, std::string(part) + ".");
    Json filled = known[part];
    filled.update(json[part]);
    whole[part] = filled;
  }
  if (whole.contains("random") && whole["random"]["ranges"].is_object())
    for (auto& [key, range] : whole["random"]["ranges"].items()) {
      const Json defaults = common::artefact_to_json(SweepRange{});
      if (!range.is_object())
        throw ConfigError(path + ": random.ranges." + key + " must have \"from\" and \"to\"");
      check_hand_written(range, defaults, path, "random.ranges." + key + ".");
      Json filled = defaults;
      filled.update(range);
      range = filled;
    }
  const Sweep sweep = common::artefact_from_json<Sweep>(whole, path);
  sweep.check(path);
  return sweep;
}

std::vector<SweepPoint> points_of(const Sweep& sweep) {
  std::vector<SweepPoint> points;
  std::set<std::string> names;
  const auto add = [&](const std::vector<Choice>& choices) {
    SweepPoint point = point_of(choices);
    const std::string name = point.name;
    for (int twin = 2; !names.insert(point.name).second; ++twin)
      point.name = name + "_" + std::to_string(twin);
    points.push_back(std::move(point));
  };
  std::int64_t number = 0;
  for (const std::vector<Choice>& of_grid : combinations(sweep.grid)) {
    if (!sweep.random) add(of_grid);
    for (std::int64_t i = 0; sweep.random && i < sweep.random->count; ++i) {
      common::RandomStream random(static_cast<std::uint64_t>(sweep.first_seed), "sweep",
                                  static_cast<std::uint64_t>(number++));
      std::vector<Choice> choices = of_grid;
      for (const auto& [key, range] : sweep.random->ranges) choices.push_back(draw(key, range, random));
      add(choices);
    }
  }
  return points;
}

std::string sweep_cell_id(const Sweep& sweep, const SweepPoint& point, std::int64_t rung, std::int64_t seed) {
  const std::string in_rung = sweep.halving ? "rung" + std::to_string(rung) + "/" : "";
  return in_rung + point.name + "/" + std::to_string(seed);
}

std::vector<Cell> sweep_cells(const Sweep& sweep, const std::vector<SweepPoint>& points, std::int64_t rung,
                              const std::string& preset) {
  std::vector<Cell> cells;
  for (std::int64_t s = 0; s < sweep.seeds; ++s)  // every point with one seed first
    for (const SweepPoint& point : points) {
      Cell cell;
      cell.seed = sweep.first_seed + s;
      cell.id = sweep_cell_id(sweep, point, rung, *cell.seed);
      cell.verb = sweep.verb;
      cell.config = preset;
      cell.settings = sweep.settings;
      cell.settings.insert(cell.settings.end(), point.settings.begin(), point.settings.end());
      if (sweep.halving) {
        cell.settings.push_back(sweep.halving->key + "=" + std::to_string(sweep.halving->budget(rung)));
      }
      cells.push_back(std::move(cell));
    }
  return cells;
}

std::optional<double> sweep_score(const Sweep& sweep, const std::string& run_folder) {
  const auto state = find_run(run_folder);
  if (!state || !state->finished) return std::nullopt;
  const std::size_t dot = sweep.score.find('.');
  const std::string file = run_folder + "/" + sweep.score.substr(0, dot) + ".json";
  const Json json = common::read_json_if_there(file);
  if (json.is_null()) {
    std::vector<std::string> there;
    for (const auto& entry : fs::directory_iterator(run_folder))
      if (entry.path().extension() == ".json") there.push_back(entry.path().stem().string());
    std::sort(there.begin(), there.end());
    throw ConfigError("score = \"" + sweep.score + "\": a run of " + sweep.verb + " leaves no " +
                      sweep.score.substr(0, dot) + ".json; it leaves " + listed(there));
  }
  const Json* at = &json;
  const std::string key = sweep.score.substr(dot + 1);
  for (std::size_t begin = 0; at != nullptr && begin <= key.size();) {
    const std::size_t end = std::min(key.find('.', begin), key.size());
    const std::string part = key.substr(begin, end - begin);
    at = at->is_object() && at->contains(part) ? &(*at)[part] : nullptr;
    begin = end + 1;
  }
  if (at == nullptr || !at->is_number()) {
    std::vector<std::string> there;
    numbers_in(json, "", there);
    throw ConfigError("score = \"" + sweep.score + "\": " + file + " has no such number; it has " +
                      listed(there));
  }
  return at->get<double>();
}

namespace {

std::optional<std::array<double, 2>> interval_of(const std::vector<double>& by_seed) {
  if (by_seed.size() < 2) return std::nullopt;
  const common::Interval interval =
      common::bootstrap_interval({by_seed}, common::mean, common::RandomStream(1, "sweep"));
  return std::array<double, 2>{interval.low, interval.high};
}

void hold_against_the_best(std::vector<SweepRow>& rows) {
  for (std::size_t i = 1; i < rows.size(); ++i) {
    std::vector<double> differences;
    for (std::size_t seed = 0; seed < rows[i].scores.size(); ++seed)
      if (rows[i].scores[seed] && rows.front().scores[seed])
        differences.push_back(*rows[i].scores[seed] - *rows.front().scores[seed]);
    if (differences.empty()) continue;
    rows[i].from_best = common::mean(differences);
    rows[i].from_best_interval = interval_of(differences);
  }
}

}  // namespace

std::vector<SweepRow> rung_results(const Sweep& sweep, const std::vector<SweepPoint>& points,
                                   std::int64_t rung, const Plan& plan, const PlanPlace& place) {
  std::vector<SweepRow> rows;
  for (const SweepPoint& point : points) {
    SweepRow row;
    row.point = point;
    row.rung = rung;
    std::vector<double> known;
    for (std::int64_t s = 0; s < sweep.seeds; ++s) {
      const std::string id = sweep_cell_id(sweep, point, rung, sweep.first_seed + s);
      row.scores.push_back(sweep_score(sweep, cell_folder(plan, place, id)));
      if (row.scores.back()) known.push_back(*row.scores.back());
    }
    if (!known.empty()) row.mean = common::mean(known);
    row.interval = interval_of(known);
    rows.push_back(std::move(row));
  }
  std::stable_sort(rows.begin(), rows.end(), [&](const SweepRow& a, const SweepRow& b) {
    if (!a.mean || !b.mean) return a.mean.has_value() && !b.mean.has_value();
    return better(sweep, *a.mean, *b.mean);
  });
  hold_against_the_best(rows);
  return rows;
}

std::vector<SweepPoint> promoted(const Sweep& sweep, const std::vector<SweepRow>& rows) {
  const auto all = static_cast<std::int64_t>(rows.size());
  const std::int64_t kept = std::max<std::int64_t>(1, all / (sweep.halving ? sweep.halving->factor : 1));
  std::vector<SweepPoint> points;
  for (std::int64_t i = 0; i < std::min(all, kept); ++i)
    points.push_back(rows[static_cast<std::size_t>(i)].point);
  return points;
}

}  // namespace lodestone::runs
