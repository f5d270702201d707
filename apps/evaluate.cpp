#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/dynamics/evaluation.h"
#include "lodestone/experiments/oracle_predictions.h"
#include "lodestone/nets/blas.h"
#include "lodestone/rig/rendered_camera.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/segmentation/evaluation.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

struct EvaluateOptions {
  std::string checkpoint;
  std::string data;
  std::string split = "all";
  std::int64_t oracle = 0;
  std::int64_t draws = 0;
  std::int64_t threads = 0;
};

/// The virtual rig that a recording is of, by the run of `collect` that it lies in.
experiments::CollectionConfig recorded_by(const std::string& data) {
  const std::string file = (std::filesystem::path(data).parent_path() / "config.json").string();
  const char* const why = ": name the recording where `collect` has put it, in its run";
  if (!std::filesystem::exists(file)) throw common::DataError("--oracle: there is no " + file + why);
  const common::Json run = common::read_json_file(file);
  common::Json rig;
  for (const char* key : {"rig", "rig_seed", "loop"}) {
    if (!run.contains(key)) throw common::DataError("--oracle: " + file + " has no " + key + why);
    rig[key] = run[key];
  }
  return common::config_from_json<experiments::CollectionConfig>(rig, file);
}

void evaluate_dynamics(const EvaluateOptions& options) {
  nets::use_one_blas_thread();
  std::optional<experiments::CollectionConfig> recorded;
  if (options.oracle > 0) recorded = recorded_by(options.data);
  const dynamics::Model model = dynamics::load_model(options.checkpoint);
  const data::Dataset dataset = data::read_any_dataset(options.data);
  const data::Dataset rows = options.split == "test" ? dynamics::test_split(model, dataset) : dataset;
  runs::DynamicsEvaluation evaluation = dynamics::evaluate_dynamics(model, rows);
  evaluation.split = options.split;
  if (options.draws > 0) dynamics::add_drawn_open_loop(model, rows, options.draws, evaluation);
  if (recorded) {
    common::ThreadPool pool(static_cast<std::size_t>(options.threads));
    experiments::add_oracle(*recorded, rows, options.oracle, pool, *evaluation.baselines);
  }
  std::printf("%s\n", common::artefact_to_json(evaluation).dump(2).c_str());
}

struct SegmenterOptions {
  std::string checkpoint;
  std::int64_t frames = 1000;
  std::int64_t seed = 1;
  std::int64_t threads = 0;
  double widen = 0.25;
  std::string rig_file;
};

/// What `--rig` holds; the paper's rig without one.
rig::RigConfig rig_of(const std::string& file) {
  if (file.empty()) return {};
  return common::config_from_json<rig::RigConfig>(common::read_json_file(file), file);
}

void evaluate_segmenter(const SegmenterOptions& options) {
  nets::use_one_blas_thread();
  const auto segmenter = vision::Segmenter::load(options.checkpoint);
  imaging::SceneConfig scenes =
      imaging::widened(segmentation::training_scenes(options.checkpoint), options.widen);
  scenes.bench = rig::bench_of(rig_of(options.rig_file));
  vision::LocaliserConfig localiser;
  localiser.rod = vision::rod_of(scenes.bench);
  common::ThreadPool pool(static_cast<std::size_t>(options.threads));
  const segmentation::SegmenterEvaluation evaluation = segmentation::evaluate_segmenter(
      segmenter, scenes, localiser, options.frames, static_cast<std::uint64_t>(options.seed), pool);
  common::Json json = common::artefact_to_json(evaluation);
  json["ranges_widened_by"] = options.widen;
  std::printf("%s\n", json.dump(2).c_str());
  if (evaluation.clean.poses == 0)
    throw common::DataError("evaluate segmenter: " + segmentation::in_words(evaluation));
}

void add_segmenter(Verb& evaluate) {
  Verb& verb = evaluate.add_verb(
      "segmenter",
      "errors of whole localisation, in mm and degrees, over rendered images of benches unlike any "
      "in training, clean and partly covered");
  const auto options = std::make_shared<SegmenterOptions>();
  verb.add_option("--checkpoint", &options->checkpoint, "folder of the segmenter checkpoint")
      .named("DIR")
      .required();
  verb.add_option("--rig", &options->rig_file, "rig.json: the rig whose images are rendered").named("FILE");
  verb.add_option("--frames", &options->frames, "scenes; each is seen clean and partly covered")
      .within(1, 1000000)
      .with_default();
  verb.add_option("--seed", &options->seed, "seed of the scenes").within(0, kNoBound).with_default();
  verb.add_option("--threads", &options->threads, "threads; 0 means one per processor")
      .within(0, 1024)
      .with_default();
  verb.add_option("--widen", &options->widen, "how much longer every range of the scenes is than in training")
      .within(0.0, 2.0)
      .with_default();
  verb.run = [options] { evaluate_segmenter(*options); };
}

void add_dynamics(Verb& evaluate) {
  Verb& verb = evaluate.add_verb(
      "dynamics",
      "one-step and open-loop errors of a dynamics checkpoint, in mm and degrees, beside two baselines, and "
      "how often the regions of the distributions that it predicts hold what was recorded");
  const auto options = std::make_shared<EvaluateOptions>();
  verb.add_option("--checkpoint", &options->checkpoint, "folder of the dynamics checkpoint")
      .named("DIR")
      .required();
  verb.add_option("--data", &options->data, "transitions: .h5, or .csv of recorded pulses")
      .named("FILE")
      .required();
  verb.add_option(
          "--split", &options->split,
          "all rows, or the test rows that were set aside when the checkpoint was trained on this file")
      .one_of({"all", "test"})
      .with_default();
  verb.add_option("--draws", &options->draws,
                  "also open loop in the mean of so many runs, each of which draws what it meets, of the "
                  "simulator and of the nearest neighbours; 0: not")
      .within(0, 256)
      .with_default();
  verb.add_option("--oracle", &options->oracle,
                  "also what the virtual rig that was recorded would have foretold itself, as the mean of so "
                  "many draws of its scatter (minutes with 16); 0: not")
      .within(0, 10000)
      .with_default();
  verb.add_option("--threads", &options->threads, "threads of --oracle; 0 means one per processor")
      .within(0, 1024)
      .with_default();
  verb.run = [options] { evaluate_dynamics(*options); };
}

}  // namespace

void add_evaluate(Verb& program) {
  Verb& verb = program.add_verb("evaluate", "measure a checkpoint on data; prints JSON");
  add_dynamics(verb);
  add_segmenter(verb);
  add_evaluate_field(verb);
}

}  // namespace lodestone::apps
