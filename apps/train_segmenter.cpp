#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "lodestone/common/log.h"
#include "lodestone/common/shell.h"
#include "lodestone/imaging/calibration.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/nets/blas.h"
#include "lodestone/rig/camera_source.h"
#include "lodestone/rig/rendered_camera.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/runs/resumable_run.h"
#include "lodestone/segmentation/evaluation.h"
#include "lodestone/segmentation/frame_labels.h"
#include "lodestone/segmentation/label_page.h"
#include "lodestone/segmentation/training.h"
#include "models.h"
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

constexpr double kGetFrame_s = 5.0;
constexpr const char* kAccept = "accept";  // of frames.labels

/// The images of a source, evenly over all of them, as a segmenter sees them whole.
segmentation::FrameViews read_frames(const segmentation::FramesConfig& config,
                                     const vision::Segmenter& segmenter, const imaging::BenchGeometry& bench,
                                     const imaging::LensConfig& lens) {
  rig::CameraSourceConfig source;
  source.source = config.source;
  const std::unique_ptr<rig::Camera> camera = rig::open_camera(source);
  const auto next = [&] {
    cv::Mat grabbed = camera->grab(kGetFrame_s).image;
    if (grabbed.type() != CV_8UC3)
      throw common::DataError(
          config.source +
          ": an image is not of 8 bits in three colours; the tape's colour tells the needle's "
          "head: film it in colour");
    return grabbed;
  };
  cv::Mat image = next();
  const imaging::Calibration calibration = config.calibration.empty()
                                               ? imaging::calibrate_from_dish({image}, bench, lens)
                                               : imaging::read_calibration(config.calibration);
  segmentation::FrameViews frames{segmenter.view_of(calibration.camera, bench.dish_radius_m), {}, {}};
  const auto most = static_cast<std::size_t>(config.count);
  std::size_t stride = 1;
  std::size_t index = 0;
  for (;; ++index) {
    if (index % stride == 0) {
      frames.images.push_back(frames.view.cut(image, frames.view.whole()));
      frames.names.push_back("image " + std::to_string(index));
    }
    if (frames.images.size() == 2 * most) {  // every second one of them will do
      for (std::size_t i = 0; i < most; ++i) {
        frames.images[i] = frames.images[2 * i];
        frames.names[i] = frames.names[2 * i];
      }
      frames.images.resize(most);
      frames.names.resize(most);
      stride *= 2;
    }
    try {
      image = next();
    } catch (const common::HardwareError&) {
      break;  // that was the last one
    }
  }
  common::log_info(config.source + ": " + std::to_string(index + 1) +
                   " images, up to its end or one that cannot be read");
  constexpr std::size_t kFewest = 8;
  if (frames.images.size() < kFewest)
    throw common::DataError(config.source + " has " + std::to_string(frames.images.size()) +
                            " images, at least " + std::to_string(kFewest) +
                            " are needed, some hundred in which the needle moves are better");
  const std::size_t there = frames.images.size(), count = std::min(there, most);
  for (std::size_t i = 0; i < count; ++i) {
    frames.images[i] = frames.images[i * there / count];
    frames.names[i] = frames.names[i * there / count];
  }
  frames.images.resize(count);
  frames.names.resize(count);
  return frames;
}

/// The command that goes on with labels.json, with all that this one was given.
std::string going_on(const segmentation::FramesConfig& config, const CommonOptions& options) {
  std::string command = "lodestone train-segmenter";
  const auto add = [&command](const std::string& option, const std::string& value) {
    if (value.empty()) return;
    const bool plain = value.find_first_of(" \t\n'\"\\$`!*?[]{}()<>|&;#~") == std::string::npos;
    command += " " + option + " " + (plain ? value : common::shell_quoted(value));
  };
  add("--rig", options.rig_file);
  for (const std::string& file : options.config_files) add("--config", file);
  if (options.config_files.empty()) add("--config", "configs/vision/fine_tune.json");
  for (const Override& value : options.overrides)
    if (value.option.rfind("--set", 0) == 0) add("--set", value.assignment);
  if (options.seed) add("--seed", std::to_string(*options.seed));
  add("--frames", config.source);
  add("--calibration", config.calibration);
  add("--labels", "labels.json");
  add("--out", options.out + "/segmenter");
  return command;
}

/// Proposes labels and leaves them where a person can look through them.
void propose(const segmentation::FramesConfig& config, const segmentation::FrameViews& frames,
             const imaging::BenchGeometry& bench, const CommonOptions& options) {
  const std::string& out = options.out;
  const std::string file = out + "/" + segmentation::FrameLabels::kFile;
  if (out.empty())
    throw common::ConfigError("train-segmenter: --out DIR is missing; name the folder to write into");
  if (std::filesystem::exists(file))
    throw common::ConfigError(file + " is there already: go on with --labels " + file +
                              " and an --out of its own, or name another --out");
  const segmentation::FrameLabels labels = segmentation::propose_labels(frames, bench);
  common::make_folders(out);
  common::write_artefact(file, labels);
  const std::string go_on = going_on(config, options);
  segmentation::write_label_page(out + "/labels.html", frames, labels,
                                 segmentation::doubtful(labels, static_cast<std::size_t>(config.corrected)),
                                 bench, go_on);
  const auto found =
      std::count_if(labels.labels.begin(), labels.labels.end(),
                    [](const segmentation::FrameLabel& label) { return label.pose.has_value(); });
  common::log_info("the needle was told in " + std::to_string(found) + " of " +
                   std::to_string(labels.labels.size()) + " images" +
                   (labels.taped || bench.sphere ? "" : "; its ends look alike, so that it has no tape"));
  common::log_info("open " + out +
                   "/labels.html, look through the labels on it, save labels.json, and go on with");
  common::log_info("  " + go_on);
}

/// Images of a laboratory's own needle, with labels, and what they are learned by.
class OwnFrames {
 public:
  /// Makes `config` that of the segmenter that goes on learning.
  OwnFrames(TrainSegmenterConfig& config, const CommonOptions& options) : bench_(config.scenes.bench) {
    if (config.frames.from.empty()) config.frames.from = shipped_folder("models") + "/segmenter";
    before_ = vision::Segmenter::load(config.frames.from);
    config.segmenter = before_->config();
    frames_ = std::make_unique<segmentation::FrameViews>(
        read_frames(config.frames, *before_, bench_, config.scenes.lens));
    if (config.frames.labels.empty()) {
      propose(config.frames, *frames_, bench_, options);
      return;
    }
    labels_ = config.frames.labels == kAccept
                  ? segmentation::propose_labels(*frames_, bench_)
                  : segmentation::read_labels(config.frames.labels, frames_->names);
    const std::size_t count = labels_.labels.size();
    held_from_ =
        count - static_cast<std::size_t>(std::lround(config.frames.held_back * static_cast<double>(count)));
    const std::vector<std::size_t> learned = segmentation::usable(labels_, 0, held_from_);
    constexpr std::size_t kFewest = 4;
    if (learned.size() < kFewest)
      throw common::DataError(config.frames.source + ": the needle is labelled in " +
                              std::to_string(learned.size()) + " of " + std::to_string(held_from_) +
                              " images to learn from: label more of them");
    // A fifth of what is learned from chooses the weights.
    const auto to_choose =
        learned.end() - static_cast<std::ptrdiff_t>(std::max<std::size_t>(1, learned.size() / 5));
    training_ = segmentation::FrameTraining{
        inference::load_checkpoint(config.frames.from, vision::Segmenter::kKind).parts.at("network"),
        *frames_, labels_, std::vector<std::size_t>(learned.begin(), to_choose),
        std::vector<std::size_t>(to_choose, learned.end())};
  }

  /// Whether there are labels to learn from; else they have been proposed, and a person comes next.
  bool ready() const { return training_.has_value(); }
  const segmentation::FrameTraining& training() const { return *training_; }

  /// Of images that nothing was learned from, by the segmenter that it began with and by the one it became.
  common::Json compare(const vision::Segmenter& after) const {
    std::vector<cv::Mat> images;
    std::vector<geometry::Pose2> poses;
    for (std::size_t i = held_from_; i < labels_.labels.size(); ++i) {
      if (!labels_.labels[i].pose) continue;
      images.push_back(frames_->images[i]);
      poses.push_back(*labels_.labels[i].pose);
    }
    const vision::RodConfig rod = vision::rod_of(bench_);
    const auto score = [&](const vision::Segmenter& segmenter) {
      return segmentation::evaluate_views(segmenter, frames_->view, rod, images, poses);
    };
    const segmentation::LocalisationScore was = score(*before_), is = score(after);
    const auto words = [](const segmentation::LocalisationScore& of) {
      return std::to_string(of.poses) + " of " + std::to_string(of.n) + " (" + segmentation::in_words(of) +
             ")";
    };
    common::log_info("of images that were held back, it has a pose in " + words(is) + "; before, in " +
                     words(was));
    return {{"before", common::artefact_to_json(was)}, {"after", common::artefact_to_json(is)}};
  }

 private:
  const imaging::BenchGeometry bench_;
  std::shared_ptr<const vision::Segmenter> before_;
  std::unique_ptr<segmentation::FrameViews> frames_;
  segmentation::FrameLabels labels_;
  std::size_t held_from_ = 0;
  std::optional<segmentation::FrameTraining> training_;
};

void train_segmenter(const CommonOptions& options) {
  const auto whole = resolve_config<SegmenterRunConfig>(options);
  TrainSegmenterConfig config = whole.training;
  config.scenes.bench = rig::bench_of(whole.rig);
  nets::use_one_blas_thread();
  std::unique_ptr<OwnFrames> own;
  if (!config.frames.source.empty()) {
    own = std::make_unique<OwnFrames>(config, options);
    if (!own->ready()) return;
  }
  runs::RunRequest request = segmentation::run_request(config, options.out, options.resume);
  request.config = common::config_to_json(whole);
  runs::RunFolder run(request);
  if (run.finished()) {
    common::log_info("train-segmenter: " + run.path() + " is finished already");
    return;
  }
  const segmentation::SegmenterTrainingResult result =
      segmentation::train_segmenter(config, run, own ? &own->training() : nullptr);

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
  if (own) metrics["frames"] = own->compare(*segmenter);
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
  Verb& verb =
      program.add_verb("train-segmenter", "learn to see the needle, from rendered images and from your own");
  auto& options = configure<SegmenterRunConfig>(verb, train_segmenter);
  add_common_options(verb, options, /*with_resume=*/true);
  add_shorthand(
      verb, options, "--frames", "frames.source", Shorthand::kText,
      "video or images of your own needle: proposes labels, and with --labels goes on learning from them");
  add_shorthand(verb, options, "--labels", "frames.labels", Shorthand::kText,
                "labels.json of the images of --frames, or accept: as they are proposed");
  add_shorthand(verb, options, "--calibration", "frames.calibration", Shorthand::kText,
                "calibration.json of the camera of --frames");
}

}  // namespace lodestone::apps
