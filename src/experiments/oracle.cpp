#include "lodestone/experiments/oracle.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/named.h"
#include "lodestone/control/planner.h"
#include "lodestone/physics/coil_drive.h"
#include "lodestone/rig/virtual_rig.h"
#include "lodestone/runs/tasks_result.h"

namespace lodestone::experiments {
namespace {

/// Where a needle has been pressed into the wall a little, it is placed so much nearer to the centre.
constexpr double kInwards = 1e-3;
constexpr int kMostInwards = 100;

/// Pulses on a twin of the rig, which begins where that is now.
class TrueForesight final : public control::Foresight {
 public:
  TrueForesight(const rig::VirtualRig& rig, const task::ActionConfig& action,
                const control::ControlLoopConfig& loop)
      : rig_(rig),
        facts_{action, 3, rig.config().dish.radius_m, 1, /*by_chance=*/true},
        loop_(loop),
        coil_drive_(rig.config()),
        twin_(rig.config(), rig.save().at("seed").get<std::uint64_t>(), rig.fields()) {}

  const Facts& facts() const override { return facts_; }

  void foresee(std::size_t /*way*/, std::size_t periods, const double* state, const double* drive,
               std::int64_t rows, common::RandomStream& random, double* next) override {
    if (periods == 0) states_.assign(1, rig_.save());
    common::Json before = after_rest(periods);
    before["scatter"] = common::RandomStream(random.next(), "what the oracle expects").save();
    for (std::int64_t row = 0; row < rows; ++row, state += 3, drive += facts_.action.size, next += 3) {
      const geometry::Drive drive_A = Eigen::Map<const Eigen::VectorXd>(drive, facts_.action.size);
      geometry::Pose2 pose{state[0], state[1], state[2]};
      if (!drive_A.isZero(0.0)) {
        twin_.restore(before);
        if (periods > 0) lay(twin_, pose);
        twin_.coils().apply({coil_drive_.current_A(drive_A, pose.position_m()), loop_.pulse_s});
        rest();
        pose = twin_.true_pose();
      }
      next[0] = pose.x_m;
      next[1] = pose.y_m;
      next[2] = pose.heading_rad;
    }
  }

  std::shared_ptr<Foresight> clone() const override {
    return std::make_shared<TrueForesight>(rig_, facts_.action, loop_);
  }

 private:
  /// The rig as it is now, so many periods later without pulses.
  const common::Json& after_rest(std::size_t periods) {
    while (states_.size() <= periods) {
      twin_.restore(states_.back());
      rest();
      states_.push_back(twin_.save());
    }
    return states_[periods];
  }
  void rest() { twin_.clock().wait_until(twin_.clock().now_s() + loop_.period_s(), nullptr); }

  const rig::VirtualRig& rig_;
  Facts facts_;
  control::ControlLoopConfig loop_;
  physics::CoilDrive coil_drive_;
  rig::VirtualRig twin_;
  std::vector<common::Json> states_;  // [periods from now]
};

class Oracle final : public control::Controller {
 public:
  Oracle(const rig::VirtualRig& rig, std::unique_ptr<control::Controller> planner)
      : rig_(rig), planner_(std::move(planner)) {}

  void reset() override { planner_->reset(); }
  geometry::Drive act(const task::Observation& observation) override {
    task::Observation truth = observation;
    truth.pose = rig_.true_pose();
    truth.drive_gain.reset();
    truth.drift_m.clear();
    return planner_->act(truth);
  }
  std::unique_ptr<control::Controller> clone() const override {
    return std::make_unique<Oracle>(rig_, planner_->clone());
  }

 private:
  const rig::VirtualRig& rig_;
  std::unique_ptr<control::Controller> planner_;
};

}  // namespace

void lay(rig::VirtualRig& twin, geometry::Pose2 pose) {
  for (int i = 0; i < kMostInwards && !twin.fits(pose); ++i) {
    pose.x_m *= 1.0 - kInwards;
    pose.y_m *= 1.0 - kInwards;
  }
  twin.place(pose);
}

ControllerSource oracle_source(const DeploymentConfig& config, const SimulatorSource* simulator) {
  if (config.rig.needle.is_sphere())
    throw common::InvalidConfig("rig.needle.shape", common::name_of(config.rig.needle.shape),
                                "be needle: the oracle does not know spheres");
  ControllerSource source;
  source.name = runs::kOracle;
  source.action.scale = config.rig.coils.max_current_A;
  source.action.size = config.rig.drive_size();
  std::shared_ptr<const inference::CostToGo> cost_to_go;
  if (simulator != nullptr) {
    source.action = simulator->action;
    cost_to_go = simulator->cost_to_go;
  }
  DeploymentConfig around = config;
  around.decorators.lead_s = 0.0;  // it plans for where its target will be
  source.make_for = [config = around, action = source.action, cost_to_go](std::uint64_t seed,
                                                                          const rig::VirtualRig& rig) {
    return decorated(
        std::make_unique<Oracle>(
            rig, std::make_unique<control::Planner>(std::make_shared<TrueForesight>(rig, action, config.loop),
                                                    config.planner, seed, cost_to_go)),
        config, action.scale);
  };
  return source;
}

}  // namespace lodestone::experiments
