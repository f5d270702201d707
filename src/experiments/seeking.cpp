#include "lodestone/experiments/seeking.h"

#include <memory>

#include "lodestone/common/error.h"

namespace lodestone::experiments {

Teleoperator seeking_planner(const CollectionConfig& config, const SimulatorSource& simulator,
                             const control::PlannerConfig& planner,
                             const control::IdentificationConfig& identification,
                             const control::GoalSeekerConfig& seek, std::int64_t session) {
  const auto seed = static_cast<std::uint64_t>(config.seed);
  const auto index = static_cast<std::uint64_t>(session);
  const auto seeker = std::make_shared<control::GoalSeeker>(
      std::make_unique<control::Planner>(simulator.simulator, planner,
                                         common::derive_seed(seed, "collect/planner", index)),
      seek, config.rig.dish.radius_m, common::RandomStream(seed, "collect/targets", index));
  Teleoperator teleoperator;
  teleoperator.controller = seeker.get();
  teleoperator.action = simulator.action;
  teleoperator.episode_over = [seeker] { return seeker->stuck(); };
  if (identification.enabled && simulator.simulator->sampled)
    teleoperator.identifier = std::make_shared<control::RigIdentifier>(simulator.simulator, identification,
                                                                       simulator.drive_per_A());
  teleoperator.save = [seeker, identifier = teleoperator.identifier] {
    const common::Json state = {{"seeker", seeker->save()},
                                {"identifier", identifier ? identifier->save() : common::Json()}};
    return state.dump();
  };
  teleoperator.restore = [seeker, identifier = teleoperator.identifier](const std::string& text) {
    const common::Json state = common::parse_json(text, "collection state");
    try {
      seeker->restore(state.at("seeker").get<std::string>());
      if (identifier) identifier->restore(state.at("identifier"));
    } catch (const common::Json::exception& error) {
      throw common::DataError(std::string("collection state is malformed: ") + error.what());
    }
  };
  return teleoperator;
}

}  // namespace lodestone::experiments
