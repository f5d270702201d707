#include "lodestone/exports/policy_golden.h"

#include <cmath>

#include "lodestone/common/random.h"
#include "lodestone/control/policy_controller.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/physics/coil_drive.h"

namespace lodestone::exports {
namespace {

constexpr std::uint64_t kEpisodes = 4;
constexpr int kSteps = 16;
constexpr double kStaying = 0.5;   // part of the pulses that move nothing
constexpr double kPulse_m = 5e-3;  // most that the others do, on each axis
constexpr double kPulse_rad = 0.5;
constexpr double kCamera_m = 1e-4;  // most that a camera errs
constexpr double kCamera_rad = 0.01;

/// An episode as the needle and its target go through it, rounded to what other programs take.
class Walk {
 public:
  Walk(const PolicyContract& contract, std::uint64_t index)
      : contract_(contract),
        random_(1, "policy golden", index),
        reach_m_(0.6 * contract.policy().encoder.length_scale_m),
        pose_{within(reach_m_), within(reach_m_), within(geometry::kPi)} {}

  std::map<std::string, std::vector<float>> next_inputs() {
    const bool stays = random_.uniform() < kStaying;
    if (!stays) pose_ = {moved(pose_.x_m), moved(pose_.y_m), pose_.heading_rad + within(kPulse_rad)};
    std::map<std::string, std::vector<float>> inputs;
    put(inputs, "pose",
        {pose_.x_m + within(kCamera_m), pose_.y_m + within(kCamera_m),
         pose_.heading_rad + within(kCamera_rad)});
    put(inputs, "target", {moved(pose_.x_m), moved(pose_.y_m)});
    put(inputs, "target_heading", {within(geometry::kPi)});
    put(inputs, "drive_gain", {within(0.3), std::abs(within(0.3))});
    return inputs;
  }

 private:
  double within(double most) { return random_.uniform(-most, most); }
  double moved(double from_m) {
    const double to_m = from_m + within(kPulse_m);
    return std::abs(to_m) < reach_m_ ? to_m : from_m;
  }
  void put(std::map<std::string, std::vector<float>>& inputs, const char* name,
           const std::vector<double>& numbers) const {
    if (contract_.takes(name)) inputs[name] = {numbers.begin(), numbers.end()};
  }

  const PolicyContract& contract_;
  common::RandomStream random_;
  double reach_m_;
  geometry::Pose2 pose_;
};

/// What a controller would be told; `last` was told before, if anything was.
task::Observation observation_of(const std::map<std::string, std::vector<float>>& inputs,
                                 const task::Observation* last, const geometry::Vector2& last_action) {
  task::Observation observation;
  const std::vector<float>& pose = inputs.at("pose");
  observation.pose = {pose[0], pose[1], pose[2]};
  if (const auto target = inputs.find("target"); target != inputs.end()) {
    observation.target_m = geometry::Vector2(target->second[0], target->second[1]);
    observation.ahead = {{observation.target_m, 0.0}};
  }
  if (const auto heading = inputs.find("target_heading"); heading != inputs.end())
    observation.target_heading_rad = heading->second[0];
  if (const auto gain = inputs.find("drive_gain"); gain != inputs.end())
    observation.drive_gain = task::DriveGain{gain->second[0], gain->second[1]};
  observation.last_action = last_action;
  if (last != nullptr)
    observation.last_displacement_m = observation.pose.position_m() - last->pose.position_m();
  return observation;
}

}  // namespace

std::vector<GoldenEpisode> golden_episodes(const PolicyContract& contract) {
  control::PolicyController controller(contract.policy());
  task::ActionConfig action = contract.policy().action;
  action.scale = contract.scale_A();
  std::vector<GoldenEpisode> episodes(kEpisodes);
  for (std::uint64_t i = 0; i < kEpisodes; ++i) {
    Walk walk(contract, i);
    controller.reset();
    task::Observation seen;
    geometry::Vector2 acted = geometry::Vector2::Zero();
    for (int step = 0; step < kSteps; ++step) {
      GoldenStep golden{walk.next_inputs(), {}};
      seen = observation_of(golden.inputs, step == 0 ? nullptr : &seen, acted);
      acted = controller.act(seen);
      const physics::PerCoil current_A = physics::opposed_pairs_A(task::drive_of(acted, action));
      for (std::size_t coil = 0; coil < current_A.size(); ++coil)
        golden.current_A[coil] = static_cast<float>(current_A[coil]);
      episodes[i].push_back(std::move(golden));
    }
  }
  return episodes;
}

common::Json golden_json(const std::vector<GoldenEpisode>& episodes) {
  common::Json json = common::Json::array();
  for (const GoldenEpisode& episode : episodes) {
    common::Json steps = common::Json::array();
    for (const GoldenStep& step : episode) {
      common::Json one(step.inputs);
      one["current"] = step.current_A;
      steps.push_back(one);
    }
    json.push_back(steps);
  }
  return json;
}

}  // namespace lodestone::exports
