#include "lodestone/exports/policy_onnx.h"

#include <catch2/catch.hpp>

#include "exports/policies.h"
#include "lodestone/common/files.h"
#include "lodestone/common/shell.h"
#include "temporary_folder.h"

using namespace lodestone;
using exports::GoldenEpisode;
using exports::PolicyContract;

namespace {

/// Numbers of an input of all episodes at one step.
common::Json batch(const std::vector<GoldenEpisode>& episodes, std::size_t step, const std::string& name) {
  std::vector<float> numbers;
  for (const GoldenEpisode& episode : episodes) {
    const std::vector<float>& row = episode[step].inputs.at(name);
    numbers.insert(numbers.end(), row.begin(), row.end());
  }
  return {{"shape", {episodes.size(), numbers.size() / episodes.size()}}, {"numbers", numbers}};
}

common::Json steps_of(const PolicyContract& contract, const std::vector<GoldenEpisode>& episodes) {
  common::Json steps = common::Json::array();
  for (std::size_t step = 0; step < episodes.front().size(); ++step) {
    steps.push_back(common::Json::object());
    for (const exports::ContractValue& value : contract.inputs())
      if (value.name != "memory") steps.back()[value.name] = batch(episodes, step, value.name);
  }
  if (contract.remembers()) {
    const auto rows = static_cast<std::int64_t>(episodes.size());
    const std::vector<float> zeros(static_cast<std::size_t>(rows * contract.memory_size()));
    steps.front()["memory"] = {{"shape", {rows, contract.memory_size()}}, {"numbers", zeros}};
  }
  return steps;
}

/// Largest difference of a current, in units of the largest.
double error_in_onnxruntime(const PolicyContract& contract) {
  const tests::TemporaryFolder folder;
  const std::vector<GoldenEpisode> episodes = golden_episodes(contract);
  common::write_file_atomically(folder / "policy.onnx", policy_onnx(contract));
  common::write_file_atomically(folder / "steps.json", steps_of(contract, episodes).dump());
  const common::CommandResult run =
      common::run_command({"node", LODESTONE_SOURCE_DIR "/tests/node/onnx_steps.js", folder / "policy.onnx",
                           folder / "steps.json"});
  INFO(run.output);
  REQUIRE(run.exit_code == 0);
  const common::Json steps = common::Json::parse(run.output);
  REQUIRE(steps.size() == episodes.front().size());
  double worst = 0.0;
  for (std::size_t step = 0; step < steps.size(); ++step) {
    const auto current_A = steps[step].at("current").at("numbers").get<std::vector<double>>();
    REQUIRE(current_A.size() == 4 * episodes.size());
    for (std::size_t i = 0; i < current_A.size(); ++i) {
      const double error_A = current_A[i] - episodes[i / 4][step].current_A[i % 4];
      worst = std::max(worst, std::abs(error_A) / contract.scale_A());
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("released policies as ONNX give our currents in ONNX Runtime", "[unit]") {
  for (const std::string& folder : tests::released_policies()) {
    const double error = error_in_onnxruntime(PolicyContract(inference::load_policy(folder)));
    WARN(folder << ": differs by " << error << " of the largest current at most");
    CHECK(error < 1e-5);
  }
}

TEST_CASE("every kind of policy as ONNX gives our currents in ONNX Runtime", "[unit]") {
  for (const inference::Policy& policy : tests::policies_of_every_kind()) {
    CAPTURE(task::encoder_to_json(policy.encoder).dump());
    CHECK(error_in_onnxruntime(PolicyContract(policy)) < 1e-5);
  }
}

TEST_CASE("an ONNX file says what it takes and gives, of what rig, and what it must answer", "[unit]") {
  const PolicyContract contract(inference::load_policy(LODESTONE_SOURCE_DIR "/models/any_rig"));
  const std::string bytes = policy_onnx(contract);
  for (const auto& [key, value] : contract.metadata()) {
    CAPTURE(key);
    CHECK(bytes.find(key + "\x12") != std::string::npos);
    CHECK(bytes.find(value) != std::string::npos);
  }
  CHECK(bytes.find("where the target will be when the pulse is over") != std::string::npos);
  CHECK(bytes.find("max_current_A") != std::string::npos);
}
