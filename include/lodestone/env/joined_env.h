#pragma once

#include <memory>
#include <vector>

#include "lodestone/env/vec_env.h"

namespace lodestone::env {

/// Several batches of environments as one, in their order: the mixes of section V-C.
class JoinedEnv final : public VecEnv {
 public:
  /// At least one; all must have the same sizes of observation and action.
  explicit JoinedEnv(std::vector<std::unique_ptr<VecEnv>> parts);

  EnvSpec spec() const override { return spec_; }
  const std::vector<float>& reset() override;
  const StepResult& step(const std::vector<float>& actions) override;
  Snapshot save() const override;
  void load(const Snapshot& snapshot) override;

 private:
  std::vector<std::unique_ptr<VecEnv>> parts_;
  EnvSpec spec_;
  StepResult result_;
};

}  // namespace lodestone::env
