#include <memory>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/log.h"
#include "lodestone/nets/blas.h"
#include "lodestone/rig/rendered_camera.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/runs/resumable_run.h"
#include "lodestone/segmentation/evaluation.h"
#include "lodestone/segmentation/training.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

using segmentation::TrainSegmenterConfig;

/// What is trained, and for which rig.
struct SegmenterRunConfig {
  rig::RigConfig rig;
  TrainSegmenterConfig training;

  template <class Visitor>
  void visit(Visitor& v) {
    training.visit(v);
    v.group("rig", rig, "the rig whose images are rendered");
  }
  void validate() const { training.validate(); }  // its keys are among these
};

void train_segmenter(const CommonOptions& options) {
  const auto whole = resolve_config<SegmenterRunConfig>(options);
  TrainSegmenterConfig config = whole.training;
  config.scenes.bench = rig::bench_of(whole.rig);
  nets::use_one_blas_thread();
  runs::RunRequest request = segmentation::run_request(config, options.out, options.resume);
  request.config = common::config_to_json(whole);
  runs::RunFolder run(request);
  if (run.finished()) {
    common::log_info("train-segmenter: " + run.path() + " is finished already");
    return;
  }
  const segmentation::SegmenterTrainingResult result = segmentation::train_segmenter(config, run);

  common::ThreadPool pool(static_cast<std::size_t>(config.threads));
  const auto segmenter = std::make_shared<const vision::Segmenter>(config.segmenter, result.weights);
  vision::LocaliserConfig localiser;
  localiser.rod = vision::rod_of(config.scenes.bench);
  const segmentation::SegmenterEvaluation evaluation = segmentation::evaluate_segmenter(
      segmenter, config.scenes, localiser, config.training.evaluation_samples,
      common::derive_seed(static_cast<std::uint64_t>(config.seed), "evaluation"), pool);
  common::Json metrics = common::artefact_to_json(evaluation);
  metrics["validation_dice"] = result.validation_dice;
  metrics.update(common::artefact_to_json(result.facts));
  vision::save_segmenter(run.file("checkpoint"), config.segmenter, result.weights,
                         common::config_to_json(config), metrics);
  common::write_json(run.file("evaluation.json"), metrics);
  runs::show_result(run, metrics);
  run.finish();
  common::log_info("wrote " + run.path() + "/checkpoint, evaluation.json and predictions.png");
  if (evaluation.clean.poses == 0)
    throw common::DataError("train-segmenter: it sees no needle yet: " + segmentation::in_words(evaluation) +
                            "; train longer or on more images (--set training.epochs=N, training.samples=N)");
  common::log_info(segmentation::in_words(evaluation));
}

}  // namespace

void add_train_segmenter(Verb& program) {
  Verb& verb = program.add_verb("train-segmenter", "learn to see the needle, from rendered images");
  add_common_options(verb, configure<SegmenterRunConfig>(verb, train_segmenter), /*with_resume=*/true);
}

}  // namespace lodestone::apps
