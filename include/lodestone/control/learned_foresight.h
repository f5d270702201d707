#pragma once

#include <memory>

#include "lodestone/control/foresight.h"
#include "lodestone/control/learned_simulator.h"

namespace lodestone::control {

/// As a learned simulator has it, which it shares: each member of the ensemble is a way, and what a pulse
/// does is the same at any time.
class LearnedForesight final : public Foresight {
 public:
  explicit LearnedForesight(std::shared_ptr<const LearnedSimulator> model);
  const Facts& facts() const override { return facts_; }
  void foresee(std::size_t way, std::size_t periods, const double* state, const double* drive,
               std::int64_t rows, common::RandomStream& random, double* next) override;
  std::shared_ptr<Foresight> clone() const override { return std::make_shared<LearnedForesight>(*this); }

 private:
  std::shared_ptr<const LearnedSimulator> model_;
  Facts facts_;
  inference::FoldedDynamics::Workspace workspace_;
};

}  // namespace lodestone::control
