#include "lodestone/experiments/collection_run.h"

#include <utility>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/data/dataset_file.h"

namespace lodestone::experiments {
namespace {

/// All sessions explore so many episodes, then their records are written, then the next round begins.
constexpr std::int64_t kEpisodesPerRound = 4;

/// What goes on with a recording, besides the file.
struct CollectionState {
  static constexpr const char* kFile = "/state.json";
  std::int64_t episodes = 0;
  std::int64_t transitions = 0;
  std::vector<common::Json> sessions;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("episodes", episodes);
    v.field("transitions", transitions);
    v.field("sessions", sessions);
  }
};

}  // namespace

CollectionRun::CollectionRun(const CollectionConfig& config, const Sessions& sessions, bool repeatable,
                             std::int64_t threads, const std::string& folder)
    : config_(config),
      sessions_(sessions),
      repeatable_(repeatable),
      pool_(static_cast<std::size_t>(threads)),
      recording_(folder + "/" + data::kRecordingFile) {}

runs::Progress CollectionRun::progress() const {
  return {transitions_, config_.transitions, transitions_ >= config_.transitions,
          std::to_string(episodes_) + " episodes"};
}

void CollectionRun::open_journal() {
  data::unfold_dataset(recording_);  // begun by a version that kept no journal
  // Episodes that can be driven again need not be on the disk, nor whole behind the last checkpoint.
  const auto after_damage = repeatable_ ? data::AfterDamage::kDrop : data::AfterDamage::kRefuse;
  journal_ = std::make_unique<data::JournalWriter>(data::journal_beside(recording_), dataset_info(config_),
                                                   after_damage);
  stored_ = journal_->episodes();
  if (!repeatable_) {
    episodes_ = stored_;
    transitions_ = journal_->transitions();
  }
  // The file may hold episodes that the state does not know yet: they are explored again, which gives the
  // same numbers, and not written twice.
  if (stored_ < episodes_)
    throw common::DataError(data::journal_beside(recording_) + " holds " + std::to_string(stored_) +
                            " episodes, the state says " + std::to_string(episodes_) +
                            "; start again in another folder");
}

void CollectionRun::step(common::MetricsLog& /*metrics*/) {
  if (!journal_) open_journal();
  if (progress().finished) return;
  for (data::Episode& episode : explore()) {
    if (transitions_ >= config_.transitions) break;
    if (transitions_ + episode.length() > config_.transitions)
      episode = data::first_steps(episode, config_.transitions - transitions_);
    if (episodes_ >= stored_) journal_->write(episode);
    ++episodes_;
    transitions_ += episode.length();
  }
}

std::vector<data::Episode> CollectionRun::explore() {
  std::vector<std::vector<data::Episode>> found(sessions_.size());
  pool_.for_each(sessions_.size(), [&](std::size_t session) {
    // What cannot be repeated is saved episode by episode.
    for (std::int64_t i = 0; i < (repeatable_ ? kEpisodesPerRound : 1); ++i)
      found[session].push_back(sessions_[session]->next_episode(config_.episode_steps));
  });
  std::vector<data::Episode> episodes;
  for (std::vector<data::Episode>& of_session : found)
    for (data::Episode& episode : of_session) episodes.push_back(std::move(episode));
  return episodes;
}

void CollectionRun::save(const std::string& folder) {
  if (journal_) journal_->sync();  // before the state that names its episodes
  CollectionState state{episodes_, transitions_, {}};
  for (const auto& session : sessions_) state.sessions.push_back(session->save());
  common::write_artefact(folder + CollectionState::kFile, state);
}

void CollectionRun::load(const std::string& folder) {
  const auto state = common::read_artefact<CollectionState>(folder + CollectionState::kFile);
  if (state.sessions.size() != sessions_.size())
    throw common::DataError(folder + CollectionState::kFile + " holds " +
                            std::to_string(state.sessions.size()) + " sessions, expected " +
                            std::to_string(sessions_.size()));
  for (std::size_t i = 0; i < sessions_.size(); ++i) sessions_[i]->restore(state.sessions[i]);
  episodes_ = state.episodes;
  transitions_ = state.transitions;
}

RecordingSummary summarise_recording(const runs::RunFolder& run) {
  const std::string recording = run.file(data::kRecordingFile);
  data::fold_journal(recording);
  const data::Dataset dataset = data::read_dataset(recording);
  RecordingSummary summary;
  summary.coverage = data::measure_coverage(dataset);
  runs::CollectionFacts& facts = summary.facts;
  facts.transitions = dataset.transitions();
  facts.transitions_with_current = summary.coverage.transitions;
  facts.coverage = summary.coverage.fraction;
  facts.evenness = summary.coverage.evenness;
  facts.episodes = static_cast<std::int64_t>(dataset.episodes.size());
  facts.placements = dataset.placements();
  facts.placements_per_1000 =
      1000.0 * static_cast<double>(*facts.placements) / static_cast<double>(facts.transitions);
  common::write_artefact(run.file(data::Coverage::kFile), summary.coverage);
  common::write_artefact(run.file(runs::CollectionFacts::kFile), facts);
  return summary;
}

}  // namespace lodestone::experiments
