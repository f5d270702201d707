#include "lodestone/runs/engines.h"

#include "lodestone/common/error.h"
#include "lodestone/runs/ninja_engine.h"
#include "lodestone/runs/slurm_engine.h"

namespace lodestone::runs {

std::vector<std::string> engine_names() { return {"ninja", "slurm"}; }

std::unique_ptr<Engine> make_engine(const std::string& name) {
  if (name == "ninja") return std::make_unique<NinjaEngine>();
  if (name == "slurm") return std::make_unique<SlurmEngine>();
  throw common::ConfigError("--engine " + name + " must be ninja or slurm");
}

}  // namespace lodestone::runs
