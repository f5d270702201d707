#include <cstdio>
#include <memory>

#include "lodestone/data/dataset_file.h"
#include "lodestone/nets/blas.h"
#include "lodestone/nets/dynamics.h"
#include "lodestone/rl/dynamics_evaluation.h"
#include "verb.h"

namespace lodestone::apps {
namespace {

struct EvaluateOptions {
  std::string checkpoint;
  std::string data;
  std::string split = "all";
};

void evaluate_dynamics(const EvaluateOptions& options) {
  nets::use_one_blas_thread();
  nets::DynamicsModel model = nets::load_dynamics(options.checkpoint);
  const data::Dataset dataset = data::read_any_dataset(options.data);
  common::Json json =
      rl::to_json(rl::evaluate_dynamics(model, rl::select_split(model, dataset, options.split)));
  json["split"] = options.split;
  std::printf("%s\n", json.dump(2).c_str());
}

}  // namespace

void add_evaluate(CLI::App& program, ConfigCatalogue&) {
  CLI::App* verb = program.add_subcommand("evaluate", "measure a checkpoint on data; prints JSON");
  verb->require_subcommand(1);
  CLI::App* dynamics = verb->add_subcommand(
      "dynamics",
      "one-step and open-loop errors of a dynamics checkpoint, in mm and degrees, beside two baselines");
  auto options = std::make_shared<EvaluateOptions>();
  dynamics->add_option("--checkpoint", options->checkpoint, "folder of the dynamics checkpoint")
      ->type_name("DIR")
      ->required();
  dynamics->add_option("--data", options->data, "transitions: .h5, or .csv of recorded pulses")
      ->type_name("FILE")
      ->required();
  dynamics
      ->add_option(
          "--split", options->split,
          "all rows, or the test rows that were set aside when the checkpoint was trained on this file")
      ->check(CLI::IsMember({"all", "test"}))
      ->capture_default_str();
  dynamics->callback([options] { evaluate_dynamics(*options); });
}

}  // namespace lodestone::apps
