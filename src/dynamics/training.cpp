#include "lodestone/dynamics/training.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

#include <ATen/TensorOperators.h>
#include <ATen/ops/cat.h>

#include "lodestone/common/artefact.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/random.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/dynamics/evaluation.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/nets/tensors.h"
#include "lodestone/runs/curves.h"
#include "lodestone/runs/resumable_run.h"
#include "member.h"
#include "symmetry.h"

namespace lodestone::dynamics {
namespace {

using common::Json;

constexpr const char* kTrainingKind = "dynamics_training";

RowTensors row_tensors(const data::Dataset& dataset) {
  const data::TransitionTable table = data::flatten(dataset);
  const std::int64_t rows = table.size();
  return {nets::tensor_from(table.state, {rows, table.state_size}),
          nets::tensor_from(table.action, {rows, table.action_size}),
          nets::tensor_from(table.next_state, {rows, table.state_size})};
}

/// What a model was trained on, as a rig would have recorded it on which drives count for `gain` times as
/// much.
RowTensors rehearsed(const Model& model, double gain) {
  const auto rows = [](const inference::Array& array) { return nets::to_tensor(array).to(at::kDouble); };
  const TrainingRows& of = model.training_rows;
  return {rows(of.state), rows(of.action) / gain, rows(of.next_state)};
}

RowTensors joined(const RowTensors& a, const RowTensors& b) {
  return {at::cat({a.state, b.state}), at::cat({a.action, b.action}), at::cat({a.next_state, b.next_state})};
}

RowTensors repeated(const RowTensors& rows, std::int64_t times) {
  const auto of = [times](const at::Tensor& tensor) { return tensor.repeat({times, 1}); };
  return {of(rows.state), of(rows.action), of(rows.next_state)};
}

/// New rows as often as leaves `rehearsal` to the old ones.
std::int64_t repetitions(std::int64_t fresh, std::int64_t old, double rehearsal) {
  const double wanted = static_cast<double>(old) * (1.0 - rehearsal) / std::max(rehearsal, 1e-9);
  return std::max<std::int64_t>(1, std::llround(wanted / static_cast<double>(fresh)));
}

void check_same_quantities(const data::DatasetInfo& from, const data::DatasetInfo& here,
                           const std::string& folder) {
  if (from.layout != here.layout || from.action_size != here.action_size ||
      from.action_unit != here.action_unit || from.action_scale != here.action_scale ||
      from.one_axis_at_a_time != here.one_axis_at_a_time)
    throw common::ConfigError("warm_start.from: " + folder +
                              " was trained on other quantities than these recordings (state, size, unit or "
                              "largest drive); learn from nothing: leave warm_start.from out");
}

/// SHA-256 of the training rows: a run resumes only on the data it began with.
std::string fingerprint(const RowTensors& rows) {
  return common::sha256(inference::encode_safetensors(
      nets::to_arrays({{"s", rows.state}, {"a", rows.action}, {"n", rows.next_state}})));
}

/// The ensemble while it learns, with its files.
class Training : public runs::ResumableWork {
 public:
  Training(const data::Dataset& dataset, const TrainDynamicsConfig& config)
      : config_(config), pool_(static_cast<std::size_t>(config.threads)) {
    TrainingConfig training = config.training;
    training.symmetry = symmetry_of(training.symmetry, /*exact=*/true, dataset.info, "training.symmetry");
    const auto seed = static_cast<std::uint64_t>(config.seed);
    model_.config = config.model;
    // The networks of a start are as they are; its windings need not be those of the rig that it goes on
    // with.
    const bool exact = config.model.symmetry_exact && config.warm_start.from.empty();
    model_.config.symmetry = symmetry_of(config.model.symmetry, exact, dataset.info, "model.symmetry");
    if (training.symmetry != inference::Symmetry::kNone && model_.config.tells_view())
      throw common::ConfigError(
          "training.symmetry shows every pulse from all sides alike, from which model.symmetry_exact = false "
          "cannot learn what differs between them; leave out one of the two");
    model_.info = dataset.info;
    model_.split = split_of(config);
    const data::Split split = data::split_by_episode(dataset, training.validation_fraction,
                                                     training.test_fraction, model_.split.seed);
    RowTensors train = row_tensors(split.train);
    const RowTensors validation = row_tensors(split.validation);
    if (train.size() < 2 || validation.size() < 1) {
      throw common::DataError(
          "training needs rows with current in every part of the split: " + std::to_string(train.size()) +
          " to train, " + std::to_string(validation.size()) +
          " to validate; collect more or change the fractions");
    }
    const WarmStartConfig& start = config.warm_start;
    if (start.from.empty()) {
      model_.members = make_members(model_.config, dataset.info.rows(), seed);
      for (const auto& network : model_.members)
        network->fit_normalisers(train.state, train.action, train.next_state);
      remember(train);
    } else {
      Model from = load_model(start.from);
      check_same_quantities(from.info, dataset.info, start.from);
      for (const auto& network : from.members) network->scale_drive(start.drive_gain);
      model_.members = std::move(from.members);
      const RowTensors old = rehearsed(from, start.drive_gain);
      remember(joined(old, train));
      if (start.rehearsal > 0.0)
        train = joined(old, repeated(train, repetitions(train.size(), old.size(), start.rehearsal)));
    }
    data_sha256_ = fingerprint(train);
    std::int64_t index = 0;
    for (const auto& network : model_.members)
      members_.push_back(std::make_unique<Member>(network, train, validation, training, seed, index++));
  }

  runs::Progress progress() const override {
    const TrainingConfig& training = config_.training;
    const bool out_of_time = training.max_seconds > 0.0 && seconds_ >= training.max_seconds;
    return {epoch_, training.epochs, epoch_ >= training.epochs || all_stopped() || out_of_time, note()};
  }

  void step(common::MetricsLog& metrics) override {
    const double start_s = clock_.now_s();
    pool_.for_each(members_.size(), [this](std::size_t k) { members_[k]->run_epoch(epoch_); });
    ++epoch_;
    metrics.write(epoch_, {{runs::curves::kTrainLoss, mean(&Member::train_loss)},
                           {runs::curves::kValidationLoss, mean(&Member::validation_loss)}});
    seconds_ += clock_.now_s() - start_s;
  }

  void save(const std::string& folder) override {
    nets::Checkpoint checkpoint;
    checkpoint.kind = kTrainingKind;
    checkpoint.config = common::config_to_json(config_);
    checkpoint.facts["epoch"] = epoch_;
    checkpoint.facts["data_sha256"] = data_sha256_;
    for (std::size_t k = 0; k < members_.size(); ++k) {
      const std::string part = "member_" + std::to_string(k);
      checkpoint.parts[part] = members_[k]->tensors();
      checkpoint.facts[part] = members_[k]->facts();
    }
    nets::save_checkpoint(folder + "/training", checkpoint);
  }

  void load(const std::string& folder) override {
    const std::string where = folder + "/training";
    const nets::Checkpoint checkpoint = nets::load_checkpoint(where, kTrainingKind);
    const std::string what = "checkpoint " + where;
    try {
      if (checkpoint.facts.at("data_sha256") != data_sha256_) {
        throw common::ConfigError(what + " was made from other transitions than " + config_.data);
      }
      epoch_ = checkpoint.facts.at("epoch").get<std::int64_t>();
      for (std::size_t k = 0; k < members_.size(); ++k) {
        const std::string part = "member_" + std::to_string(k);
        members_[k]->restore(checkpoint.parts.at(part), checkpoint.facts.at(part), what + ", " + part);
      }
    } catch (const Json::exception& error) {
      throw common::CheckpointError(what + ": facts are malformed: " + error.what());
    } catch (const std::out_of_range&) {
      throw common::CheckpointError(what + ": a member of the ensemble is missing");
    }
  }

  TrainingResult finish(double seconds) {
    TrainingResult result;
    result.facts.epochs = epoch_;
    result.facts.train_loss = mean(&Member::train_loss);
    result.facts.validation_loss =
        mean(config_.training.keep_best ? &Member::best_validation_loss : &Member::validation_loss);
    result.facts.train_seconds = seconds;
    for (const auto& member : members_) member->finish();
    result.model = std::move(model_);
    return result;
  }

 private:
  /// What the model keeps of its rows.
  void remember(const RowTensors& rows) {
    model_.start_states = nets::to_array(rows.state);
    model_.training_rows = {nets::to_array(rows.state.to(at::kFloat)),
                            nets::to_array(rows.action.to(at::kFloat)),
                            nets::to_array(rows.next_state.to(at::kFloat))};
  }

  bool all_stopped() const {
    for (const auto& member : members_) {
      if (!member->stopped()) return false;
    }
    return true;
  }

  double mean(double (Member::*value)() const) const {
    double sum = 0.0;
    for (const auto& member : members_) sum += ((*member).*value)();
    return sum / static_cast<double>(members_.size());
  }

  std::string note() const {
    std::ostringstream text;
    text.precision(4);
    text << "loss " << mean(&Member::train_loss) << ", validation " << mean(&Member::validation_loss);
    return text.str();
  }

  TrainDynamicsConfig config_;
  common::ThreadPool pool_;
  common::SteadyClock clock_;
  Model model_;
  std::vector<std::unique_ptr<Member>> members_;
  std::string data_sha256_;
  std::int64_t epoch_ = 0;
  double seconds_ = 0.0;  // of this process
};

}  // namespace

TrainDynamicsConfig adopt_start(TrainDynamicsConfig config) {
  if (!config.warm_start.from.empty()) config.model = load_model(config.warm_start.from).config;
  return config;
}

DataSplit split_of(const TrainDynamicsConfig& config) {
  return {common::derive_seed(static_cast<std::uint64_t>(config.seed), "dynamics split"),
          config.training.validation_fraction, config.training.test_fraction};
}

runs::RunRequest run_request(const TrainDynamicsConfig& config, const std::string& folder, bool resume) {
  runs::RunRequest request;
  request.folder = folder;
  request.verb = "train-dynamics";
  request.config = common::config_to_json(config);
  request.seed = config.seed;
  request.resume = resume;
  // Files may be moved; the checkpoint says when they hold other transitions.
  request.free_keys = {"threads", "data", "training.checkpoint_interval_s", "warm_start.from"};
  request.length_keys = {"training.max_seconds"};
  request.inputs = runs::named_inputs(request.config, {"warm_start.from"});
  return request;
}

TrainingResult train_dynamics(const data::Dataset& dataset, const TrainDynamicsConfig& config,
                              runs::RunFolder& run) {
  data::check_dataset(dataset, config.data.empty() ? dataset.info.source : config.data);
  Training work(dataset, config);
  const double seconds =
      runs::run_resumably(run, work, {"train dynamics", "epochs", config.training.checkpoint_interval_s});
  return work.finish(seconds);
}

runs::DynamicsEvaluation train_into(runs::RunFolder& run, const data::Dataset& dataset,
                                    const TrainDynamicsConfig& config) {
  const TrainingResult result = train_dynamics(dataset, config, run);
  runs::DynamicsEvaluation evaluation = evaluate_dynamics(result.model, test_split(result.model, dataset));
  evaluation.split = "test";
  evaluation.transitions = dataset.transitions();
  evaluation.training = result.facts;
  save_model(run.file("checkpoint"), result.model, common::config_to_json(config),
             common::artefact_to_json(evaluation));
  common::write_artefact(run.file(runs::DynamicsEvaluation::kFile), evaluation);
  runs::show_result(run, common::artefact_to_json(evaluation));
  run.finish();
  return evaluation;
}

}  // namespace lodestone::dynamics
