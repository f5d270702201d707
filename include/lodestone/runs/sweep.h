#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/runs/plan.h"

namespace lodestone::runs {

/// Values that random search draws from.
struct SweepRange {
  double from = 0.0;
  double to = 0.0;
  bool log = false;    ///< evenly on a logarithmic scale
  bool whole = false;  ///< whole numbers

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("from", from);
    v.field("to", to);
    v.field("log", log);
    v.field("whole", whole);
  }
};

struct SweepRandom {
  std::int64_t count = 0;  ///< settings that are drawn
  std::map<std::string, SweepRange> ranges;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("count", count);
    v.field("ranges", ranges);
  }
};

/// Successive halving (Jamieson and Talwalkar, 2016): all settings with a small budget, the best of them with
/// a larger one, and so on. Every rung is run from the start.
struct SweepHalving {
  std::string key;  ///< the budget: "training.env_steps"
  std::int64_t first = 0;
  std::int64_t factor = 3;  ///< of the budget from rung to rung, and of the settings that are dropped
  std::int64_t rungs = 1;

  /// Of a rung, from 1. Not more than 2^53 where check() lets it pass.
  std::int64_t budget(std::int64_t rung) const;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("key", key);
    v.field("first", first);
    v.field("factor", factor);
    v.field("rungs", rungs);
  }
};

/// Seeds x settings of one verb, as a user writes it. What is left out has its default.
struct Sweep {
  std::string verb;
  std::vector<std::string> config;    ///< presets, later ones win: files, or names below configs/
  std::vector<std::string> settings;  ///< of every run, key=value
  std::map<std::string, std::vector<common::Json>> grid;  ///< values by key: all combinations
  std::optional<SweepRandom> random;  ///< besides the grid, or within every combination of it
  std::optional<SweepHalving> halving;
  std::int64_t seeds = 1;  ///< the same ones for all settings
  std::int64_t first_seed = 1;
  std::string score;  ///< FILE.KEY... in a run's folder: "result.success_rate" is of result.json
  bool lower_is_better = false;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("verb", verb);
    v.field("config", config);
    v.field("settings", settings);
    v.field("grid", grid);
    v.field("random", random);
    v.field("halving", halving);
    v.field("seeds", seeds);
    v.field("first_seed", first_seed);
    v.field("score", score);
    v.field("lower_is_better", lower_is_better);
  }
  /// Throws ConfigError: no verb or score, no value, bounds the wrong way round, a key twice.
  void check(const std::string& source) const;
};

/// Throws ConfigError naming the file and the key, and DataError.
Sweep read_sweep(const std::string& path);

/// One choice of values.
struct SweepPoint {
  std::string name;  ///< "learning_rate=0.001, batch_size=128", also of folders
  std::vector<std::string> settings;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("name", name);
    v.field("settings", settings);
  }
};

/// All that are tried, in the order of the file.
std::vector<SweepPoint> points_of(const Sweep& sweep);

/// Where one run of it lies. `rung` counts from 1; without halving there is one.
std::string sweep_cell_id(const Sweep& sweep, const SweepPoint& point, std::int64_t rung, std::int64_t seed);

/// The runs of some points in one rung, each with every seed. `preset` is the file that config came to;
/// empty: none.
std::vector<Cell> sweep_cells(const Sweep& sweep, const std::vector<SweepPoint>& points, std::int64_t rung,
                              const std::string& preset);

/// The score of a finished run in its folder; nothing where it is not finished. Throws ConfigError naming
/// what is there instead where it has no such number.
std::optional<double> sweep_score(const Sweep& sweep, const std::string& run_folder);

/// What came of one point, in the largest rung that it was tried in.
struct SweepRow {
  SweepPoint point;
  std::int64_t rung = 1;
  std::vector<std::optional<double>> scores;  ///< by seed; null: not finished
  std::optional<double> mean;
  std::optional<std::array<double, 2>> interval;  ///< 95 %, by drawing seeds anew; absent for fewer than two
  /// The mean of its scores minus those of the best point of its rung, seed by seed, where both have
  /// finished, with the interval of that; absent for the best itself.
  std::optional<double> from_best;
  std::optional<std::array<double, 2>> from_best_interval;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("point", point);
    v.field("rung", rung);
    v.field("scores", scores);
    v.field("mean", mean);
    v.field("interval", interval);
    v.field("from_best", from_best);
    v.field("from_best_interval", from_best_interval);
  }
};

/// `sweep.json` of a sweep's folder: best first, larger rungs before smaller ones.
struct SweepResult {
  static constexpr const char* kFile = "sweep.json";
  std::string verb, score;
  bool lower_is_better = false;
  std::vector<SweepRow> rows;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("verb", verb);
    v.field("score", score);
    v.field("lower_is_better", lower_is_better);
    v.field("rows", rows);
  }
};

/// What a rung came to, best first; points without a finished run last.
std::vector<SweepRow> rung_results(const Sweep& sweep, const std::vector<SweepPoint>& points,
                                   std::int64_t rung, const Plan& plan, const PlanPlace& place);

/// The points that go on to the next rung: the best of `rows`, at least one.
std::vector<SweepPoint> promoted(const Sweep& sweep, const std::vector<SweepRow>& rows);

}  // namespace lodestone::runs
