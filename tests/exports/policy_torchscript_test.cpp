#include "lodestone/exports/policy_torchscript.h"

#include <torch/csrc/jit/serialization/import.h>
#include <catch2/catch.hpp>
#include <sstream>

#include "exports/policies.h"
#include "lodestone/nets/tensors.h"

using namespace lodestone;
using exports::GoldenEpisode;
using exports::PolicyContract;

namespace {

torch::jit::Module loaded(const PolicyContract& contract, torch::jit::ExtraFilesMap& files) {
  std::istringstream bytes(nets::encode_script(policy_torchscript(contract)));
  return torch::jit::load(bytes, c10::nullopt, files);
}

/// Of all episodes at one step.
at::Tensor rows(const std::vector<GoldenEpisode>& episodes, std::size_t step, const std::string& name) {
  std::vector<double> numbers;
  for (const GoldenEpisode& episode : episodes) {
    const std::vector<float>& row = episode[step].inputs.at(name);
    numbers.insert(numbers.end(), row.begin(), row.end());
  }
  const auto count = static_cast<std::int64_t>(episodes.size());
  return nets::tensor_from(numbers, {count, static_cast<std::int64_t>(numbers.size()) / count}, at::kFloat);
}

/// Largest difference of a current, in units of the largest.
double error_in_torchscript(const PolicyContract& contract) {
  torch::jit::ExtraFilesMap none;
  torch::jit::Module module = loaded(contract, none);
  const std::vector<GoldenEpisode> episodes = golden_episodes(contract);
  const auto count = static_cast<std::int64_t>(episodes.size());
  at::Tensor memory =
      nets::tensor_from(std::vector<double>(static_cast<std::size_t>(count * contract.memory_size())),
                        {count, contract.memory_size()}, at::kFloat);
  double worst = 0.0;
  for (std::size_t step = 0; step < episodes.front().size(); ++step) {
    std::vector<torch::jit::IValue> inputs;
    for (const exports::ContractValue& value : contract.inputs())
      inputs.emplace_back(value.name == "memory" ? memory : rows(episodes, step, value.name));
    const torch::jit::IValue out = module.forward(inputs);
    if (contract.remembers()) memory = out.toTuple()->elements()[1].toTensor();
    const std::vector<double> current_A =
        nets::to_vector(contract.remembers() ? out.toTuple()->elements()[0].toTensor() : out.toTensor());
    REQUIRE(current_A.size() == 4 * episodes.size());
    for (std::size_t i = 0; i < current_A.size(); ++i)
      worst = std::max(worst,
                       std::abs(current_A[i] - episodes[i / 4][step].current_A[i % 4]) / contract.scale_A());
  }
  return worst;
}

}  // namespace

TEST_CASE("released policies as TorchScript give our currents when they are loaded back", "[unit]") {
  for (const std::string& folder : tests::released_policies()) {
    const double error = error_in_torchscript(PolicyContract(inference::load_policy(folder)));
    WARN(folder << ": differs by " << error << " of the largest current at most");
    CHECK(error < 1e-5);
  }
}

TEST_CASE("every kind of policy as TorchScript gives our currents", "[unit]") {
  for (const inference::Policy& policy : tests::policies_of_every_kind()) {
    CAPTURE(task::encoder_to_json(policy.encoder).dump());
    CHECK(error_in_torchscript(PolicyContract(policy)) < 1e-5);
  }
}

TEST_CASE("a TorchScript file has its metadata as extra files", "[unit]") {
  const PolicyContract contract(inference::load_policy(LODESTONE_SOURCE_DIR "/models/centre"));
  torch::jit::ExtraFilesMap files = {
      {"golden.json", ""}, {"contract.json", ""}, {"rig.json", ""}, {"lodestone", ""}};
  loaded(contract, files);
  const auto metadata = contract.metadata();
  for (const char* key : {"golden", "contract", "rig"})
    CHECK(files.at(std::string(key) + ".json") == metadata.at(key));
  CHECK(files.at("lodestone") == metadata.at("lodestone"));
}
