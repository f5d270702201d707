#pragma once

#include <string>
#include <vector>

#include "lodestone/runs/engine.h"

namespace lodestone::runs {

/// The build.ninja of some of a plan's cells, each after those of them that it needs. Its only outputs are
/// stamps: ninja may delete the outputs of what it interrupts.
std::string ninja_text(const Plan& plan, const PlanPlace& place, const std::vector<const Cell*>& cells);

/// Runs cells on this machine, as many at a time as the place has threads; fewer cells than threads share
/// these (results do not depend on it). They stop when this process dies.
class NinjaEngine final : public Engine {
 public:
  void start(const Plan& plan, const PlanPlace& place, const std::vector<const Cell*>& cells) override;
  bool ended() override;
  void stop() override;

 private:
  int process_ = -1;
};

}  // namespace lodestone::runs
