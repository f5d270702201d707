#include "lodestone/rl/dynamics_training.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>

#include "dynamics_member.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/metrics.h"
#include "lodestone/common/progress.h"
#include "lodestone/common/random.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/nets/tensors.h"

namespace lodestone::rl {
namespace {

using common::Json;

constexpr const char* kKind = "dynamics_training";

RowTensors row_tensors(const data::Dataset& dataset) {
  const data::TransitionTable table = data::flatten(dataset);
  const std::int64_t rows = table.size();
  return {nets::tensor_from(table.state, {rows, table.state_size}),
          nets::tensor_from(table.action, {rows, data::kActionSize}),
          nets::tensor_from(table.next_state, {rows, table.state_size})};
}

/// SHA-256 of the training rows: a run resumes only on the data it began with.
std::string fingerprint(const RowTensors& rows) {
  return common::sha256(inference::encode_safetensors(
      nets::to_arrays({{"s", rows.state}, {"a", rows.action}, {"n", rows.next_state}})));
}

/// The ensemble while it learns, with its files.
class Training {
 public:
  Training(const data::Dataset& dataset, const TrainDynamicsConfig& config, std::string folder)
      : config_(config), folder_(std::move(folder)), pool_(static_cast<std::size_t>(config.threads)) {
    const DynamicsTrainingConfig& training = config.training;
    const auto seed = static_cast<std::uint64_t>(config.seed);
    model_.config = config.model;
    model_.info = dataset.info;
    model_.split = {common::derive_seed(seed, "dynamics split"), training.validation_fraction,
                    training.test_fraction};
    const data::Split split = data::split_by_episode(dataset, training.validation_fraction,
                                                     training.test_fraction, model_.split.seed);
    const RowTensors train = row_tensors(split.train);
    const RowTensors validation = row_tensors(split.validation);
    if (train.size() < 2 || validation.size() < 1) {
      throw common::DataError(
          "training needs rows with current in every part of the split: " + std::to_string(train.size()) +
          " to train, " + std::to_string(validation.size()) +
          " to validate; collect more or change the fractions");
    }
    data_sha256_ = fingerprint(train);
    model_.start_states = nets::to_array(train.state);
    model_.training_rows = {nets::to_array(train.state.to(torch::kFloat32)),
                            nets::to_array(train.action.to(torch::kFloat32)),
                            nets::to_array(train.next_state.to(torch::kFloat32))};
    model_.members = nets::make_dynamics_members(config.model, dataset.info.layout, seed);
    std::int64_t index = 0;
    for (const auto& network : model_.members) {
      network->fit_normalisers(train.state, train.action, train.next_state);
      members_.push_back(
          std::make_unique<DynamicsMember>(network, train, validation, training, seed, index++));
    }
  }

  /// Takes up the training checkpoint, or begins anew when the run was ended before it wrote one.
  void resume() {
    const std::string where = training_folder();
    if (!std::filesystem::exists(where)) {
      common::log_info("there is no " + where + " yet: training from the start");
      forget_metrics_after(0);
      return;
    }
    const nets::Checkpoint checkpoint = nets::load_checkpoint(where, kKind);
    const std::string what = "checkpoint " + where;
    try {
      if (checkpoint.config != settings()) {
        throw common::ConfigError(what +
                                  " was made with other settings; resume with the run's own config.json");
      }
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
    forget_metrics_after(epoch_);
  }

  DynamicsTrainingResult run() {
    const common::SteadyClock clock;
    const double start_s = clock.now_s();
    double saved_s = start_s;
    std::optional<common::MetricsLog> metrics;
    if (!folder_.empty()) metrics.emplace(folder_);
    common::Progress progress("train dynamics", config_.training.epochs);
    while (epoch_ < config_.training.epochs && !all_stopped()) {
      pool_.for_each(members_.size(), [this](std::size_t k) { members_[k]->run_epoch(epoch_); });
      ++epoch_;
      progress.update(epoch_, note());
      if (metrics) {
        metrics->write(epoch_, {{"train_loss", mean(&DynamicsMember::train_loss)},
                                {"validation_loss", mean(&DynamicsMember::validation_loss)},
                                {"best_validation_loss", mean(&DynamicsMember::best_validation_loss)}});
      }
      const double now_s = clock.now_s();
      if (common::interrupted()) stop_for_user();
      if (!folder_.empty() && now_s - saved_s >= config_.training.checkpoint_interval_s) {
        save();
        saved_s = now_s;
      }
      if (config_.training.max_seconds > 0.0 && now_s - start_s >= config_.training.max_seconds) break;
    }
    progress.finish(note());
    if (!folder_.empty()) save();
    return finish(clock.now_s() - start_s);
  }

 private:
  std::string training_folder() const { return folder_ + "/training"; }

  /// What must not change between a run and its resumption.
  Json settings() const {
    Json json = common::config_to_json(config_);
    for (const char* key : {"threads", "data"}) json.erase(key);
    for (const char* key : {"max_seconds", "checkpoint_interval_s"}) json["training"].erase(key);
    return json;
  }

  void save() const {
    nets::Checkpoint checkpoint;
    checkpoint.kind = kKind;
    checkpoint.config = settings();
    checkpoint.facts["epoch"] = epoch_;
    checkpoint.facts["data_sha256"] = data_sha256_;
    for (std::size_t k = 0; k < members_.size(); ++k) {
      const std::string part = "member_" + std::to_string(k);
      checkpoint.parts[part] = members_[k]->tensors();
      checkpoint.facts[part] = members_[k]->facts();
    }
    nets::save_checkpoint(training_folder(), checkpoint);
  }

  [[noreturn]] void stop_for_user() const {
    if (folder_.empty()) throw common::Interrupted("training of the dynamics was interrupted");
    save();
    throw common::Interrupted("training of the dynamics was interrupted after epoch " +
                              std::to_string(epoch_) + "; go on with --resume --out " + folder_);
  }

  /// Drops the rows of epochs that a killed run wrote after its last checkpoint; they will be run again.
  void forget_metrics_after(std::int64_t epoch) const {
    const std::string path = folder_ + "/metrics.jsonl";
    if (!std::filesystem::exists(path)) return;
    std::istringstream lines(common::read_file(path));
    std::string kept;
    for (std::string line; std::getline(lines, line);) {
      const Json row = Json::parse(line, nullptr, /*allow_exceptions=*/false);
      if (row.is_object() && row.value("step", epoch + 1) <= epoch) kept += line + "\n";
    }
    common::write_file_atomically(path, kept);
  }

  bool all_stopped() const {
    for (const auto& member : members_) {
      if (!member->stopped()) return false;
    }
    return true;
  }

  double mean(double (DynamicsMember::*value)() const) const {
    double sum = 0.0;
    for (const auto& member : members_) sum += ((*member).*value)();
    return sum / static_cast<double>(members_.size());
  }

  std::string note() const {
    std::ostringstream text;
    text.precision(4);
    text << "loss " << mean(&DynamicsMember::train_loss) << ", validation "
         << mean(&DynamicsMember::validation_loss);
    return text.str();
  }

  DynamicsTrainingResult finish(double seconds) {
    DynamicsTrainingResult result;
    result.epochs = epoch_;
    result.train_loss = mean(&DynamicsMember::train_loss);
    result.validation_loss = mean(config_.training.keep_best ? &DynamicsMember::best_validation_loss
                                                             : &DynamicsMember::validation_loss);
    result.seconds = seconds;
    for (const auto& member : members_) member->finish();
    result.model = std::move(model_);
    return result;
  }

  TrainDynamicsConfig config_;
  std::string folder_;
  common::ThreadPool pool_;
  nets::DynamicsModel model_;
  std::vector<std::unique_ptr<DynamicsMember>> members_;
  std::string data_sha256_;
  std::int64_t epoch_ = 0;
};

}  // namespace

DynamicsTrainingResult train_dynamics(const data::Dataset& dataset, const TrainDynamicsConfig& config,
                                      const std::string& folder, bool resume) {
  data::check_dataset(dataset, config.data.empty() ? dataset.info.source : config.data);
  LODESTONE_CHECK(!(resume && folder.empty()), "resuming needs the folder of the run");
  Training training(dataset, config, folder);
  if (resume) training.resume();
  return training.run();
}

}  // namespace lodestone::rl
