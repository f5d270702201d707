#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/progress.h"
#include "lodestone/common/run_folder.h"
#include "lodestone/control/collection.h"
#include "lodestone/data/coverage.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/nets/blas.h"
#include "models.h"
#include "verb.h"

namespace lodestone::apps {

namespace {

struct CollectConfig {
  control::CollectionConfig collection;
  std::int64_t threads = 1;

  template <class Visitor>
  void visit(Visitor& v) {
    collection.visit(v);
    v.field("threads", threads, "", "one rig is explored by one thread; kept for uniformity", {0, 1024});
  }
  void validate() const { collection.rig.validate(); }
};

/// Between two writes of the state this many episodes may have to be explored again by --resume: about a
/// second.
constexpr std::int64_t kEpisodesPerState = 100;

/// The part of a configuration that decides the data.
common::Json deciding(CollectConfig config) {
  config.threads = 1;
  return common::config_to_json(config);
}

void write_state(const std::string& file, const control::Collection& collection, std::int64_t episodes,
                 std::int64_t transitions) {
  const common::Json state = {
      {"episodes", episodes}, {"transitions", transitions}, {"collection", collection.save()}};
  common::write_file_atomically(file, state.dump());
}

void check_same_run(const std::string& folder, const CollectConfig& config) {
  const common::Json stored = common::read_json_file(folder + "/config.json");
  if (deciding(common::config_from_json<CollectConfig>(stored, folder + "/config.json")) != deciding(config))
    throw common::ConfigError("--resume: the configuration differs from " + folder +
                              "/config.json; use the same --config and --set as before, or another --out");
}

/// Writes coverage.json and says what was recorded.
void report(const std::string& folder, const std::string& dataset_file) {
  const data::Dataset dataset = data::read_dataset(dataset_file);
  const data::Coverage coverage = data::measure_coverage(dataset);
  common::write_file_atomically(folder + "/coverage.json", data::coverage_to_json(coverage).dump(1) + "\n");
  std::printf("%lld transitions in %lld episodes: %s\n", static_cast<long long>(dataset.transitions()),
              static_cast<long long>(dataset.episodes.size()), dataset_file.c_str());
  std::printf(
      "coverage: %lld of %lld cells of position, heading and drive visited (%.1f %%), evenness %.3f\n",
      static_cast<long long>(coverage.visited), static_cast<long long>(coverage.cells),
      100.0 * coverage.fraction, coverage.evenness);
}

void collect(const CommonOptions& options) {
  auto config = resolve_config<CollectConfig>(options);
  if (options.out.empty())
    throw common::ConfigError("collect: --out DIR is missing; name the folder to write into");
  nets::use_one_blas_thread();
  choose_segmenter(config.collection.sensor);
  const std::int64_t total = config.collection.transitions;
  const std::string dataset_file = options.out + "/transitions.h5";
  const std::string state_file = options.out + "/state.json";
  const bool going_on = options.resume && std::filesystem::exists(state_file);
  if (options.resume && !going_on && std::filesystem::exists(dataset_file)) {
    check_same_run(options.out, config);
    common::log_info("collect: " + options.out + " is finished already");
    report(options.out, dataset_file);
    return;
  }
  control::Collection collection(config.collection);
  std::int64_t episodes = 0;
  std::int64_t transitions = 0;
  if (going_on) {
    check_same_run(options.out, config);
    const common::Json state = common::read_json_file(state_file);
    collection.restore(state.at("collection"));
    episodes = state.at("episodes").get<std::int64_t>();
    transitions = state.at("transitions").get<std::int64_t>();
  } else {
    common::start_run_folder(options.out, "collect", common::config_to_json(config), config.collection.seed,
                             false);
    write_state(state_file, collection, 0, 0);
  }
  auto writer = std::make_unique<data::DatasetWriter>(dataset_file, control::dataset_info(config.collection),
                                                      going_on && std::filesystem::exists(dataset_file));
  // The file may hold episodes that the state does not know yet: they are explored again, which gives the
  // same numbers, and not written twice.
  const std::int64_t stored = writer->episodes();
  if (stored < episodes)
    throw common::DataError(dataset_file + " holds " + std::to_string(stored) + " episodes, the state says " +
                            std::to_string(episodes) + "; start again in another folder");
  common::Progress progress("collect", total);
  try {
    while (transitions < total) {
      const data::Episode episode = collection.next_episode(total - transitions);
      if (episodes >= stored) writer->write(episode);
      ++episodes;
      transitions += episode.length();
      if (episodes % kEpisodesPerState == 0) write_state(state_file, collection, episodes, transitions);
      progress.update(transitions, std::to_string(episodes) + " episodes");
    }
  } catch (const common::Interrupted&) {
    throw common::Interrupted("collect: stopped after " + std::to_string(transitions) + " of " +
                              std::to_string(total) +
                              " transitions; `--resume` with the same options goes on");
  }
  progress.finish();
  writer.reset();
  report(options.out, dataset_file);
  std::filesystem::remove(state_file);
}

}  // namespace

void add_collect(CLI::App& program, ConfigCatalogue& catalogue) {
  catalogue["collect"] = [] { return common::describe_config<CollectConfig>(); };
  CLI::App* verb =
      program.add_subcommand("collect", "explore a virtual rig and record its transitions (phase 1)");
  auto options = std::make_shared<CommonOptions>();
  add_common_options(*verb, *options, true);
  verb->add_option_function<std::string>(
      "--sensor",
      [options](const std::string& kind) {
        options->overrides.push_back("sensor.kind=" + common::Json(kind).dump());
      },
      "camera or simulated");
  verb->callback([options] { collect(*options); });
}

}  // namespace lodestone::apps
