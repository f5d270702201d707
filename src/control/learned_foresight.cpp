#include "lodestone/control/learned_foresight.h"

#include <utility>

namespace lodestone::control {

LearnedForesight::LearnedForesight(std::shared_ptr<const LearnedSimulator> model)
    : model_(std::move(model)),
      facts_{model_->action, model_->state_size, model_->dish_radius_m, model_->members.size(),
             model_->sampled} {}

void LearnedForesight::foresee(std::size_t way, std::size_t /*periods*/, const double* state,
                               const double* drive, std::int64_t rows, common::RandomStream& random,
                               double* next) {
  const inference::FoldedDynamics& member = model_->members[way];
  if (model_->sampled) {
    const auto luck = inference::Luck::draw(static_cast<std::int64_t>(model_->state_size), random);
    member.sample(state, drive, rows, luck, next, workspace_);
  } else {
    member.predict(state, drive, rows, next, workspace_);
  }
}

}  // namespace lodestone::control
