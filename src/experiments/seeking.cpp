#include "lodestone/experiments/seeking.h"

#include <utility>

#include "lodestone/common/error.h"

namespace lodestone::experiments {

Teleoperator goal_seeking(const CollectionConfig& config, std::unique_ptr<control::Controller> controller,
                          const control::GoalSeekerConfig& seek, std::int64_t session) {
  const auto seeker = std::make_shared<control::GoalSeeker>(
      std::move(controller), seek, config.rig.dish.radius_m,
      common::RandomStream(static_cast<std::uint64_t>(config.seed), "collect/targets",
                           static_cast<std::uint64_t>(session)));
  Teleoperator teleoperator;
  teleoperator.controller = seeker.get();
  teleoperator.episode_over = [seeker] { return seeker->stuck(); };
  teleoperator.save = [seeker] { return seeker->save(); };
  teleoperator.restore = [seeker](const std::string& state) { seeker->restore(state); };
  return teleoperator;
}

Teleoperator goal_seeking(const CollectionConfig& config, const SimulatorSource& simulator,
                          const control::PlannerConfig& planner,
                          const control::IdentificationConfig& identification,
                          const control::GoalSeekerConfig& seek, std::int64_t session) {
  const std::uint64_t seed = common::derive_seed(static_cast<std::uint64_t>(config.seed), "collect/planner",
                                                 static_cast<std::uint64_t>(session));
  Teleoperator teleoperator = goal_seeking(
      config, std::make_unique<control::Planner>(simulator.simulator, planner, seed), seek, session);
  teleoperator.action = simulator.action;
  if (!identification.enabled || !simulator.simulator->sampled) return teleoperator;
  const auto identifier =
      std::make_shared<control::RigIdentifier>(simulator.simulator, identification, simulator.drive_per_A());
  teleoperator.identifier = identifier;
  teleoperator.save = [identifier, save = teleoperator.save] {
    return common::Json{{"seeker", save()}, {"identifier", identifier->save()}}.dump();
  };
  teleoperator.restore = [identifier, restore = teleoperator.restore](const std::string& text) {
    const common::Json state = common::parse_json(text, "collection state");
    try {
      restore(state.at("seeker").get<std::string>());
      identifier->restore(state.at("identifier"));
    } catch (const common::Json::exception& error) {
      throw common::DataError(std::string("collection state is malformed: ") + error.what());
    }
  };
  return teleoperator;
}

}  // namespace lodestone::experiments
