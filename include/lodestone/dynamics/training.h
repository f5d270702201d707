#pragma once

#include <cstdint>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/data/dataset.h"
#include "lodestone/dynamics/model.h"
#include "lodestone/runs/run_folder.h"
#include "lodestone/runs/training_results.h"

namespace lodestone::dynamics {

enum class Optimiser { kSgd, kAdam, kAdamW };
inline std::vector<std::string> names_of(Optimiser) { return {"sgd", "adam", "adamw"}; }
enum class Schedule { kConstant, kCosine };
inline std::vector<std::string> names_of(Schedule) { return {"constant", "cosine"}; }
enum class Loss { kL2, kHuber };
inline std::vector<std::string> names_of(Loss) { return {"l2", "huber"}; }

/// How the dynamics networks learn. The defaults are the paper's (section IV-B1) where it says, plain
/// otherwise.
struct TrainingConfig {
  std::int64_t epochs = 100;
  std::int64_t batch_size = 64;
  Optimiser optimiser = Optimiser::kSgd;
  double learning_rate = 0.01;
  double momentum = 0.9;      ///< of sgd
  double weight_decay = 0.0;  ///< L2 for sgd and adam, decoupled for adamw
  Schedule schedule = Schedule::kConstant;
  Loss loss = Loss::kL2;
  double huber_delta = 1.0;  ///< in standard deviations of the output
  double mean_weight = 0.0;  ///< of the mean's squared error, beside a mixture's likelihood
  inference::Symmetry symmetry = inference::Symmetry::kNone;
  double validation_fraction = 0.1;
  double test_fraction = 0.1;
  bool keep_best = true;      ///< end with the weights of the best validation loss
  std::int64_t patience = 0;  ///< a member stops after so many epochs without improvement; 0: never
  bool bootstrap = false;     ///< each member learns from its own draw of the rows, with replacement
  double max_seconds = 0.0;   ///< stop after this wall time (then results depend on the machine); 0: never
  double checkpoint_interval_s = 10.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("epochs", epochs, "", "passes over the training rows", {1, 100000});
    v.field("batch_size", batch_size, "rows", "rows per step", {2, 65536});
    v.field("optimiser", optimiser, "", "optimiser");
    v.field("learning_rate", learning_rate, "", "step size, at its start", {1e-8, 10.0});
    v.field("momentum", momentum, "", "momentum of sgd", {0.0, 0.9999});
    v.field("weight_decay", weight_decay, "", "L2 penalty (sgd, adam) or decoupled decay (adamw)",
            {0.0, 1.0});
    v.field("schedule", schedule, "", "how the step size goes on: constant, or half a cosine down to 0");
    v.field("loss", loss, "",
            "training loss on normalised output; mixtures have their likelihood instead (and mean_weight)");
    v.field("huber_delta", huber_delta, "", "normalised error above which huber is linear", {1e-3, 100.0});
    v.field("mean_weight", mean_weight, "",
            "a mixture learns its likelihood and, so much, that its mean is near: pulses that look random at "
            "first are otherwise given up to wide Gaussians",
            {0.0, 1e3});
    v.field(
        "symmetry", symmetry, "",
        "of the rig, as in model.symmetry, learned from data: every epoch sees each row in one of the ways "
        "that look the same, and the network may come to differ between them");
    v.field("validation_fraction", validation_fraction, "",
            "fraction of the episodes to choose weights by (keep_best, patience)", {0.01, 0.9});
    v.field("test_fraction", test_fraction, "", "fraction of the episodes set aside for the final figures",
            {0.01, 0.9});
    v.field("keep_best", keep_best, "", "keep the weights of the best validation loss");
    v.field("patience", patience, "epochs", "stop a member after so long without improvement; 0: never",
            {0, 100000});
    v.field("bootstrap", bootstrap, "", "each member draws its own rows with replacement");
    v.field("max_seconds", max_seconds, "s", "stop after this wall time; 0: no limit", {0.0, 1e7});
    v.field("checkpoint_interval_s", checkpoint_interval_s, "s", "time between training checkpoints",
            {0.0, 1e6});
  }
};

/// Learning that goes on from a trained model, on another rig of its kind.
struct WarmStartConfig {
  std::string from;
  double drive_gain = 1.0;
  double rehearsal = 0.5;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("from", from, "",
            "folder of a dynamics checkpoint to go on from, whose networks (model) are taken; empty: from "
            "nothing");
    v.field("drive_gain", drive_gain, "", "how strongly the rig answers to a drive, where that model's is 1",
            {0.1, 10.0});
    v.field("rehearsal", rehearsal, "",
            "share of the training rows that are that model's own, their drives divided by the gain; the new "
            "ones "
            "are repeated as often as that takes",
            {0.0, 0.99});
  }
};

/// Everything `lodestone train-dynamics` is told.
struct TrainDynamicsConfig {
  std::int64_t seed = 1;
  std::int64_t threads = 0;
  std::string data;
  std::int64_t transitions = 0;
  DynamicsConfig model;
  TrainingConfig training;
  WarmStartConfig warm_start;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of every random stream of the run", {0, 9e15});
    v.field("threads", threads, "", "threads; 0 means one per processor", {0, 1024});
    v.field("data", data, "",
            "transitions: .h5, or .csv of recorded pulses; several of one rig with commas between them");
    v.field("transitions", transitions, "", "use only the first so many; 0: all", {0, 1e9});
    v.group("model", model, "the networks");
    v.group("training", training, "how they learn");
    v.group("warm_start", warm_start, "what they begin with");
  }
};

/// The configuration with the networks of the model that it goes on from, where it does. Throws
/// CheckpointError.
TrainDynamicsConfig adopt_start(TrainDynamicsConfig config);

/// Which episodes of its data are set aside.
DataSplit split_of(const TrainDynamicsConfig& config);

struct TrainingResult {
  Model model;
  /// Losses are normalised: of training the mean of the members' last epoch; of validation squared error
  /// (of mixtures what they learn: negative log-likelihood, and training.mean_weight), mean of the members'
  /// kept weights.
  runs::TrainingFacts facts;
};

/// The run of a configuration, and which of its keys may change when it is gone on with.
runs::RunRequest run_request(const TrainDynamicsConfig& config, const std::string& folder, bool resume);

/// Trains the ensemble, one member per thread; results depend on the seed alone, not on threads. Writes
/// metrics (train_loss, validation_loss per epoch) and, every so often, `training` into the run's folder,
/// from which a resumption goes on bitwise. Throws DataError (NaN, empty split), CheckpointError, ConfigError
/// (resuming with other data, going on from a model of other quantities), and Interrupted after saving when
/// the user asked to stop.
TrainingResult train_dynamics(const data::Dataset& dataset, const TrainDynamicsConfig& config,
                              runs::RunFolder& run);

/// The same, with its figures on the episodes that were set aside: writes `checkpoint` and evaluation.json
/// into the run's folder, and finishes it.
runs::DynamicsEvaluation train_into(runs::RunFolder& run, const data::Dataset& dataset,
                                    const TrainDynamicsConfig& config);

}  // namespace lodestone::dynamics
