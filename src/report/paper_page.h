#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/report/html_page.h"
#include "lodestone/report/paper_figures.h"

namespace lodestone::report {

constexpr const char* kMissing = "not run yet";
/// A sentence is built on no fewer training seeds.
constexpr std::int64_t kEnoughSeeds = 5;

std::string formatted(const char* format, double a, double b = 0.0, double c = 0.0);
std::string or_dash(const char* format, const std::optional<double>& value);
/// Followed by its interval or range where there is one that shows; a dash
/// where there is no mean.
std::string with_interval(const char* format, const std::optional<double>& mean,
                          const std::optional<std::array<double, 2>>& interval);
/// Likewise of a share, in percent.
std::string percent_text(const std::optional<double>& share,
                         const std::optional<std::array<double, 2>>& interval);
/// Mean (95 % interval).
std::string error_text(const runs::PooledErrors& errors);
std::string success_text(const runs::PooledErrors& errors);
/// Mean (lowest to highest seed), as below.
std::string success_text(const runs::PooledTraining& training);
std::string steps_to_maximum_text(const runs::PooledTraining& training);
std::string seeds_text(const runs::CellOrigin& origin);
/// Mean difference from the reference with its interval; says of how many trials where those are not all.
std::string from_reference_text(const runs::PooledErrors& errors);
std::string joined(const std::vector<std::string>& parts);
/// Those that the list does not have yet.
void add_new(std::vector<std::string>& list, const std::vector<std::string>& texts);

/// A table of the paper's page, as HTML and Markdown at once.
struct PaperTable {
  std::vector<std::string> headers;
  std::vector<std::vector<std::string>> cells = {};
  int text_columns = 2;
  std::vector<std::string> commits = {};  ///< behind its figures: stand below it

  /// A row whose figures are not there.
  void add_missing(std::vector<std::string> named);
  void add_commits(const runs::CellOrigin& origin);
  std::string html() const;
  std::string markdown() const;
};

template <class Map>
const typename Map::mapped_type* find(const Map& map, const std::string& key) {
  const auto found = map.find(key);
  return found == map.end() ? nullptr : &found->second;
}

/// What every part of the paper's page reads, and adds itself to.
struct PaperPage {
  /// `kept` must outlive it. Paces: of the trainings of Table I, where they were measured.
  explicit PaperPage(const runs::KeptPlan& kept, const runs::KeptPlan& paces = {});

  bool planned(const std::string& prefix) const { return by_id.count(prefix) > 0; }
  /// Null where nothing of it is there.
  const runs::PooledErrors* errors(const std::string& row, const std::string& variant,
                                   const std::string& task) const;
  /// How the policies that did a task were trained, of the seeds that drove; absent where that is not there.
  std::optional<runs::PooledTraining> training_of(const std::string& row, const std::string& task,
                                                  const SeedRecords& driven) const;
  /// Mean evaluation return over steps with two standard deviations, for each group of seeds: name, prefix.
  std::string return_chart(const std::string& id, const std::string& title,
                           const std::vector<std::pair<std::string, std::string>>& lines) const;

  const runs::KeptPlan& kept;
  std::vector<std::pair<std::string, SeedRecords>> groups;
  std::map<std::string, const SeedRecords*> by_id;
  runs::PaperResult result;
  HtmlPage html;
  std::vector<std::pair<std::string, std::string>> drawings = {};  ///< name of the file, drawing
  std::string markdown = {};

  /// A part of the page: what has to be known before its tables, then these, each with its name if it has
  /// one.
  void add_part(const std::string& id, const std::string& title, const std::string& note,
                const std::vector<std::pair<std::string, PaperTable>>& titled_tables,
                const std::string& html_below = "");
};

// The parts, in the order of the page.
void add_transfer(PaperPage& page);      ///< Table II, Fig. 6
void add_training(PaperPage& page);      ///< Table I, Fig. 4
void add_dynamics(PaperPage& page);      ///< section V-A
void add_zones(PaperPage& page);         ///< Fig. 2
void add_mixes(PaperPage& page);         ///< Fig. 5
void add_open_choices(PaperPage& page);  ///< what the paper leaves open
void add_ablations(PaperPage& page);

}  // namespace lodestone::report
