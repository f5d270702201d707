#include "fuzz.h"
#include "inference/random_policy.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/inference/dynamics.h"
#include "lodestone/inference/policy.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// A checkpoint whose manifest and parts are spoiled in turn. Most often they are sealed again: a seal that
/// is wrong hides what lies behind it.
class SpoiledCheckpoint {
 public:
  SpoiledCheckpoint(std::string folder, const tests::Soak& soak)
      : folder_(std::move(folder)), spoiler_(soak.seed(), folder_.substr(folder_.rfind('/'))) {
    manifest_ = common::Json::parse(common::read_file(folder_ + "/manifest.json"));
    for (const auto& [file, entry] : manifest_["files"].items())
      parts_.emplace_back(file, common::read_file(folder_ + "/" + file));
  }

  void spoil() {
    for (const auto& [file, content] : parts_) tests::write_bytes(folder_ + "/" + file, content);
    common::Json manifest = manifest_;
    switch (spoiler_.below(4)) {
      case 0:
        manifest = spoiler_.json(manifest);
        break;
      case 1:
        return tests::write_bytes(folder_ + "/manifest.json",
                                  spoiler_.bytes(manifest.dump(), parts_.front().second));
      default:
        spoil_part(manifest);
    }
    if (manifest.is_object()) {
      manifest.erase("sha256");
      manifest["sha256"] = common::sha256(manifest.dump());
    }
    tests::write_bytes(folder_ + "/manifest.json", manifest.dump());
  }

 private:
  void spoil_part(common::Json& manifest) {
    const auto& [file, good] = spoiler_.one_of(parts_);
    const std::string content =
        spoiler_.below(2) == 0 ? with_header(good) : spoiler_.bytes(good, spoiler_.one_of(parts_).second);
    tests::write_bytes(folder_ + "/" + file, content);
    manifest["files"][file]["bytes"] = content.size();
    manifest["files"][file]["sha256"] = common::sha256(content);
  }

  /// The same numbers behind another header.
  std::string with_header(const std::string& good) {
    const auto length = static_cast<std::size_t>(static_cast<unsigned char>(good[0])) +
                        256 * static_cast<std::size_t>(static_cast<unsigned char>(good[1]));
    const std::string header = spoiler_.json(common::Json::parse(good.substr(8, length))).dump();
    std::string content(8, '\0');
    for (std::size_t i = 0; i < 4; ++i) content[i] = static_cast<char>(header.size() >> (8 * i));
    return content + header + good.substr(8 + length);
  }

  std::string folder_;
  tests::Spoiler spoiler_;
  common::Json manifest_;
  std::vector<std::pair<std::string, std::string>> parts_;
};

void write_small_dynamics(const std::string& folder) {
  common::RandomStream random(3, "dynamics");
  inference::Checkpoint checkpoint;
  checkpoint.kind = "dynamics";
  inference::DynamicsConfig config;
  config.hidden = {3};
  config.batch_norm = false;
  checkpoint.facts["model"] = common::config_to_json(config);
  data::DatasetInfo info;
  info.workspace_radius_m = 0.04;
  checkpoint.facts["dataset"] = data::info_to_json(info);
  const auto ones = [](std::int64_t count) {
    return inference::Array(std::vector<float>(static_cast<std::size_t>(count), 1.0F), {count});
  };
  checkpoint.parts["member_0"] = {{"input_mean", ones(5)},
                                  {"input_std", ones(5)},
                                  {"output_mean", ones(3)},
                                  {"output_std", ones(3)},
                                  {"layers.0.weight", tests::random_array({3, 5}, random)},
                                  {"layers.0.bias", ones(3)},
                                  {"layers.2.weight", tests::random_array({3, 3}, random)},
                                  {"layers.2.bias", ones(3)}};
  checkpoint.parts["rows"] = {{"start_states", tests::random_array({4, 3}, random)},
                              {"state", tests::random_array({4, 3}, random)},
                              {"action", tests::random_array({4, 2}, random)},
                              {"next_state", tests::random_array({4, 3}, random)}};
  inference::save_checkpoint(folder, checkpoint);
}

}  // namespace

TEST_CASE("a spoiled policy is loaded or refused by name", "[soak]") {
  const tests::Soak soak("spoiled policies (manifest, safetensors)", 1000, 100'000);
  const tests::TemporaryFolder folder;
  inference::Policy policy;
  policy.hidden = {4, 3};
  policy.region = task::Region::from_json({{"cell_m", 0.004}, {"cells", {{0, 0}, {1, 0}}}});
  tests::draw_weights(policy, 4);
  inference::save_policy(folder / "policy", policy, common::Json::object(), common::Json::object());
  SpoiledCheckpoint spoiled(folder / "policy", soak);
  const std::int64_t accepted = tests::fuzz(
      soak, [&] { spoiled.spoil(); },
      [&] {
        const inference::Policy loaded = inference::load_policy(folder / "policy");
        const inference::Actor actor = loaded.actor();
        std::vector<float> action(2);
        inference::Actor::Workspace workspace;
        const std::vector<float> observation(static_cast<std::size_t>(actor.observation_size()), 0.5F);
        actor.act(observation.data(), 1, action.data(), workspace);
        CHECK(std::isfinite(action[0]));
      });
  CHECK(accepted > soak.count() / 100);
  CHECK(accepted < soak.count() / 2);
}

TEST_CASE("a spoiled simulator is loaded or refused by name", "[soak]") {
  const tests::Soak soak("spoiled simulators (manifest, safetensors)", 1000, 100'000);
  const tests::TemporaryFolder folder;
  write_small_dynamics(folder / "dynamics");
  SpoiledCheckpoint spoiled(folder / "dynamics", soak);
  const std::int64_t accepted = tests::fuzz(
      soak, [&] { spoiled.spoil(); },
      [&] {
        const inference::DynamicsModel model = inference::load_dynamics(folder / "dynamics");
        std::vector<double> state(3, 0.01);
        const std::vector<double> drive = {5.0, -5.0};
        inference::FoldedDynamics::Workspace workspace;
        model.members.front().predict(state.data(), drive.data(), 1, state.data(), workspace);
      });
  CHECK(accepted > soak.count() / 100);
  CHECK(accepted < soak.count() / 2);
}
