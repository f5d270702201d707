#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/data/coverage.h"

namespace lodestone::report {

/// Points of one curve: step, value.
using Curve = std::vector<std::pair<double, double>>;

/// One step of a run: what it was told, where it ran and what it logged. A file that is not there is null.
struct StepData {
  std::string name;                   ///< "collect", "dynamics", "policy" or "deploy"
  common::Json config;                ///< config.json
  common::Json manifest;              ///< manifest.json
  common::Json result;                ///< evaluation.json of dynamics, result.json of policy
  std::vector<common::Json> metrics;  ///< metrics.jsonl, one object a line

  bool present() const {
    return !config.is_null() || !manifest.is_null() || !result.is_null() || !metrics.empty();
  }
};

/// Trials on one kind of rig.
struct DeployData {
  std::string rig;       ///< "explored" or "unseen"
  common::Json summary;  ///< summary.json
  common::Json trials;   ///< trials.json
};

/// A trial of which there is a video.
struct FilmedTrial {
  std::string name;        ///< for example "unseen-policy-square-0"
  std::string last_image;  ///< JPEG
};

/// Everything found in a run folder: DIR/collect, DIR/dynamics, DIR/policy, DIR/deploy/{explored,unseen}.
struct RunData {
  std::string folder;
  StepData collect;
  std::optional<data::Coverage> coverage;
  StepData dynamics;
  StepData policy;
  StepData deploy;
  std::vector<DeployData> rigs;
  std::vector<FilmedTrial> filmed;  ///< of DIR/deploy/videos, by name
};

/// Reads what is there; missing files are no fault. Throws DataError naming a file that is damaged, and
/// ConfigError when the folder does not exist. A last line of metrics.jsonl that a killed run left
/// half-written is dropped.
RunData read_run(const std::string& folder);

/// A JSON file, or null where there is none. Throws DataError when it is damaged.
common::Json read_if_there(const std::string& path);
/// The objects of a .jsonl file, one a line; none where there is no file.
std::vector<common::Json> read_lines(const std::string& path);

/// The curve of the first of `keys` that the log holds; empty when none is there.
Curve curve(const std::vector<common::Json>& metrics, std::initializer_list<const char*> keys);

/// A number under nested keys ({"baselines", "knn10", "position_rms_mm"}); nullopt when absent or not a
/// number.
std::optional<double> number_at(const common::Json& json, std::initializer_list<const char*> path);

}  // namespace lodestone::report
