#include <cstdio>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/log.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/dynamics/training.h"
#include "lodestone/nets/blas.h"
#include "lodestone/rig/rig_config.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

using dynamics::TrainDynamicsConfig;

/// What is trained, and the rig that the recordings should be of.
struct DynamicsRunConfig {
  TrainDynamicsConfig training;
  rig::RigConfig rig;

  template <class Visitor>
  void visit(Visitor& v) {
    training.visit(v);
    v.group("rig", rig, "the rig, where one is named: recordings of another are refused");
  }
};

void print_evaluation(const runs::DynamicsEvaluation& evaluation) {
  char line[256];
  std::snprintf(line, sizeof line,
                "test split (%lld rows): position %.3f mm RMS; no motion %.3f, ten nearest neighbours %.3f",
                static_cast<long long>(evaluation.n.value_or(0)), evaluation.one_step.position_rms_mm,
                evaluation.baselines->no_motion.position_rms_mm,
                evaluation.baselines->nearest_neighbours.position_rms_mm);
  common::log_info(line);
}

void train_dynamics(const CommonOptions& options) {
  const auto [asked, rig] = resolve_config<DynamicsRunConfig>(options);
  const TrainDynamicsConfig config = dynamics::adopt_start(asked);
  if (config.data.empty()) {
    throw common::ConfigError(
        "train-dynamics needs transitions: --set data=FILE.h5 (from collect or import)");
  }
  nets::use_one_blas_thread();
  runs::RunFolder run(dynamics::run_request(config, options.out, options.resume));
  const std::string file = run.file(runs::DynamicsEvaluation::kFile);
  if (run.finished()) {
    common::log_info("train-dynamics: " + run.path() + " is finished already");
    return print_evaluation(common::read_artefact<runs::DynamicsEvaluation>(file));
  }
  data::Dataset dataset = data::read_recordings(config.data);
  check_rig(options, rig, dataset.info.rig, "the recordings are");
  if (config.transitions > 0) dataset = data::first_transitions(std::move(dataset), config.transitions);
  const runs::DynamicsEvaluation evaluation = dynamics::train_into(run, dataset, config);
  print_evaluation(evaluation);
  common::log_info("wrote " + run.path() + "/checkpoint and evaluation.json");
}

}  // namespace

void add_train_dynamics(Verb& program) {
  Verb& verb = program.add_verb("train-dynamics", "learn the model-based simulator (MBS) from transitions");
  add_common_options(verb, configure<DynamicsRunConfig>(verb, train_dynamics), /*with_resume=*/true);
}

}  // namespace lodestone::apps
