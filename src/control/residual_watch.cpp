#include "lodestone/control/residual_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lodestone::control {
namespace {

constexpr std::size_t kDraws = 19;
constexpr double kUsualShare = 0.12;   // of surprises: simulators are not perfect either
constexpr double kChangedShare = 0.4;  // of them on a rig that it is worth telling of
constexpr double kEnough = 9.0;        // evidence, natural logarithm

}  // namespace

ResidualWatch::ResidualWatch(MotionModel model, double still_m, double still_rad)
    : model_(std::move(model)), stalls_(still_m, still_rad), random_(1, "residual watch") {}

void ResidualWatch::reset() {
  random_ = common::RandomStream(1, "residual watch");
  evidence_ = 0.0;
  stalls_.reset();
}

bool ResidualWatch::changed() const { return evidence_ > kEnough; }

void ResidualWatch::check(const SeenPulse& pulse, const task::DriveGain& gain) {
  if (pulse.drive_A.isZero(0.0) || stalls_.repeats(pulse)) return;
  const geometry::Drive drive_A = std::exp(gain.log_mean) * pulse.drive_A;
  draws_.assign(1, {pulse.before, drive_A, pulse.after});
  for (std::size_t k = 0; k < kDraws; ++k) {
    const double factor = std::exp(gain.log_mean + gain.log_sigma * random_.normal());
    draws_.push_back({pulse.before, drive_A, model_.draw(pulse.before, factor * pulse.drive_A, random_)});
  }
  model_.judge(draws_, ratio_);
  const bool surprising = ratio_.front() < *std::min_element(ratio_.begin() + 1, ratio_.end());
  evidence_ += surprising ? std::log(kChangedShare / kUsualShare)
                          : std::log((1.0 - kChangedShare) / (1.0 - kUsualShare));
  evidence_ = std::max(0.0, evidence_);
}

}  // namespace lodestone::control
