#include <cstdio>
#include <memory>

#include "lodestone/common/files.h"
#include "lodestone/common/log.h"
#include "lodestone/common/run_folder.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/nets/blas.h"
#include "lodestone/nets/dynamics.h"
#include "lodestone/rl/dynamics_evaluation.h"
#include "lodestone/rl/dynamics_training.h"
#include "verb.h"

namespace lodestone::apps {
namespace {

using rl::TrainDynamicsConfig;

void train_dynamics(const CommonOptions& options) {
  const auto config = resolve_config<TrainDynamicsConfig>(options);
  if (options.out.empty()) throw common::ConfigError("train-dynamics needs --out, the folder of the run");
  if (config.data.empty()) {
    throw common::ConfigError(
        "train-dynamics needs transitions: --set data=FILE.h5 (from collect or import)");
  }
  nets::use_one_blas_thread();
  data::Dataset dataset = data::read_recordings(config.data);
  if (config.transitions > 0) dataset = data::first_transitions(std::move(dataset), config.transitions);
  const common::Json json = common::config_to_json(config);
  common::start_run_folder(options.out, "train-dynamics", json, config.seed, options.resume);
  rl::DynamicsTrainingResult result = rl::train_dynamics(dataset, config, options.out, options.resume);
  const data::Dataset test = rl::select_split(result.model, dataset, "test");
  const rl::DynamicsEvaluation evaluation = rl::evaluate_dynamics(result.model, test);

  common::Json metrics = rl::to_json(evaluation);
  metrics["split"] = "test";
  metrics["transitions"] = dataset.transitions();
  metrics["validation_loss"] = result.validation_loss;
  metrics["train_loss"] = result.train_loss;
  metrics["epochs"] = result.epochs;
  metrics["train_seconds"] = result.seconds;
  nets::save_dynamics(options.out + "/checkpoint", result.model, json, metrics);
  common::write_file_atomically(options.out + "/evaluation.json", metrics.dump(2) + "\n");
  char line[256];
  std::snprintf(line, sizeof line,
                "test split (%lld rows): position %.3f mm RMS; no motion %.3f, ten nearest neighbours %.3f",
                static_cast<long long>(evaluation.n), evaluation.one_step.position_rms_mm,
                evaluation.no_motion.position_rms_mm, evaluation.nearest_neighbours.position_rms_mm);
  common::log_info(line);
  common::log_info("wrote " + options.out + "/checkpoint and evaluation.json");
}

}  // namespace

void add_train_dynamics(CLI::App& program, ConfigCatalogue& catalogue) {
  CLI::App* verb =
      program.add_subcommand("train-dynamics", "learn the model-based simulator (MBS) from transitions");
  auto options = std::make_shared<CommonOptions>();
  catalogue["train-dynamics"] = [options] { return describe_resolved<TrainDynamicsConfig>(*options); };
  add_common_options(*verb, *options, /*with_resume=*/true);
  verb->callback([options] { train_dynamics(*options); });
}

}  // namespace lodestone::apps
