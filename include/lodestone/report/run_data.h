#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/data/coverage.h"
#include "lodestone/runs/deployment_results.h"

namespace lodestone::report {

/// Points of one curve: step, value.
using Curve = std::vector<std::pair<double, double>>;

/// One step of a run: what it was told, where it ran and what it logged. A file that is not there is null.
struct StepData {
  std::string name;                   ///< "collect", "dynamics", "policy", "cost_to_go" or "deploy"
  common::Json config;                ///< config.json
  common::Json manifest;              ///< manifest.json
  std::vector<common::Json> metrics;  ///< metrics.jsonl, one object a line

  bool present() const { return !config.is_null() || !manifest.is_null() || !metrics.empty(); }
};

/// Trials on one kind of rig.
struct DeployData {
  std::string rig;  ///< "explored", "unseen" or "real"
  runs::RigSummary summary;
  /// Who drove besides the baseline: "policy" or "planner".
  std::string driver() const { return summary.controller.value_or("policy"); }
  std::optional<std::vector<runs::TrialRecord>> trials;
  double success_radius_mm = 3.0;  ///< around a target, by which the trials were scored
};

/// A trial of which there is a video.
struct FilmedTrial {
  std::string name;        ///< for example "unseen-policy-square-0"
  std::string last_image;  ///< JPEG
};

/// Everything found in a run folder: DIR/collect, DIR/dynamics, DIR/policy, DIR/cost_to_go, DIR/deploy. The
/// folder of a deployment counts as a run that holds nothing else.
struct RunData {
  std::string folder;
  bool deployment_only = false;  ///< the folder is a deployment's own
  StepData collect;
  std::optional<data::Coverage> coverage;
  std::optional<runs::CollectionFacts> recorded;  ///< of collect
  StepData dynamics;
  std::optional<runs::DynamicsEvaluation> evaluation;  ///< of dynamics
  StepData policy;
  std::optional<runs::PolicyResult> trained;  ///< of policy
  StepData cost_to_go;                        ///< what poses cost, for the planner
  std::optional<runs::PolicyResult> cost_to_go_trained;
  StepData deploy;
  runs::Provenance provenance;  ///< of the policy that was deployed
  std::vector<DeployData> rigs;
  std::optional<runs::ReachMap> reach;  ///< where the needle can be brought, where ways were searched
  std::vector<FilmedTrial> filmed;      ///< of DIR/deploy/videos, by name
};

/// Reads what is there; missing files are no fault. Throws DataError naming a file that is damaged, and
/// ConfigError when the folder does not exist. A last line of metrics.jsonl that a killed run left
/// half-written is dropped.
RunData read_run(const std::string& folder);

/// The objects of a .jsonl file, one a line; none where there is no file.
std::vector<common::Json> read_lines(const std::string& path);

/// The curve of that name; empty where the log holds none.
Curve curve(const std::vector<common::Json>& metrics, const char* name);

}  // namespace lodestone::report
