#include "lodestone/physics/coil_fit.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/physics/described_coil.h"
#include "lodestone/physics/standing_coil.h"

namespace lodestone::physics {
namespace {

constexpr Eigen::Index kOfCoil = 6;  // moved by three, tilted by two, logarithm of the gain
constexpr Eigen::Index kBackground = 3;
constexpr int kMostRounds = 12;
constexpr double kMostLeftByCoils = 0.1;  // of the field
constexpr double kLeastNoise_T = 1e-7;
constexpr std::size_t kLeastOfCoil = 4;  // samples

using CoilChange = Eigen::Matrix<double, kOfCoil, 1>;  // in units of what a description leaves open
const CoilChange kOpen = (CoilChange() << 5e-3, 5e-3, 5e-3, 0.1, 0.1, 0.1).finished();

/// A frame across the axis, which tilts are about.
std::array<Eigen::Vector3d, 2> across(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d helper =
      std::abs(axis.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d one = axis.cross(helper).normalized();
  return {one, axis.cross(one)};
}

CoilDescription changed(const CoilDescription& coil, const CoilChange& change) {
  const CoilChange by = change.cwiseProduct(kOpen);
  CoilDescription out = coil;
  for (Eigen::Index i = 0; i < 3; ++i) out.position_m[static_cast<std::size_t>(i)] += by[i];
  const auto sides = across(coil.unit_axis());
  const Eigen::Vector3d axis = (coil.unit_axis() + by[3] * sides[0] + by[4] * sides[1]).normalized();
  out.axis = {axis.x(), axis.y(), axis.z()};
  out.gain = coil.gain * std::exp(by[5]);
  return out;
}

/// Coils of a description, and by how much each is to be changed.
class Fitter {
 public:
  Fitter(const CoilsDescription& described, const FieldSamples& samples)
      : samples_(samples), measured_(described.measured) {
    for (std::size_t coil = 0; coil < described.count(); ++coil) {
      coils_.push_back(described.coil(coil));
      check_outside(coils_.back());
    }
    changes_ = Eigen::VectorXd::Zero(unknowns());
  }

  /// To the samples that are used; begins where the last fit ended.
  void fit(const std::vector<bool>& used) {
    for (int round = 0; round < kMostRounds; ++round)
      if (step(used) < 1e-6) break;
  }

  CoilDescription coil(std::size_t index) const {
    return changed(coils_[index], changes_.segment<kOfCoil>(static_cast<Eigen::Index>(index) * kOfCoil));
  }
  Eigen::Vector3d background_T() const { return changes_.tail<kBackground>(); }

  FieldError error(const std::vector<bool>& of) const {
    const std::vector<Eigen::Vector3d> predicted_T = predict();
    return field_error([&](std::size_t i) { return predicted_T[i]; }, samples_, of);
  }

 private:
  Eigen::Index unknowns() const { return static_cast<Eigen::Index>(coils_.size()) * kOfCoil + kBackground; }

  void check_outside(const CoilDescription& coil) const {
    if (coil.measured()) return;
    for (const Eigen::Vector3d& point_m : samples_.position_m)
      if (coil.winds_at(point_m, kClearOfWinding_m))
        throw common::DataError(
            fmt::format("the sample at ({:.1f}, {:.1f}, {:.1f}) mm lies in the winding of coil {} "
                        "as it is described",
                        1e3 * point_m.x(), 1e3 * point_m.y(), 1e3 * point_m.z(), coil.name));
  }

  std::vector<Eigen::Vector3d> predict() const {
    std::vector<Eigen::Vector3d> field_T(samples_.size(), background_T());
    for (std::size_t i = 0; i < samples_.size(); ++i)
      field_T[i] += measured_.sum(measured_.background_T, samples_.position_m[i]);
    for (std::size_t index = 0; index < coils_.size(); ++index) {
      const DescribedCoil exact(coil(index), measured_);
      for (std::size_t i = 0; i < samples_.size(); ++i)
        if (const double current_A = samples_.current_A[i][static_cast<Eigen::Index>(index)];
            current_A != 0.0)
          field_T[i] += current_A * exact.per_ampere(samples_.position_m[i]);
    }
    return field_T;
  }

  /// One round of Gauss and Newton. Returns by how much it changed anything.
  double step(const std::vector<bool>& used) {
    constexpr double kProbe = 1e-3;
    const Eigen::Index size = unknowns();
    const std::vector<Eigen::Vector3d> predicted_T = predict();
    std::vector<Eigen::MatrixXd> slopes(samples_.size(), Eigen::MatrixXd::Zero(3, size));
    for (std::size_t index = 0; index < coils_.size(); ++index)
      for (Eigen::Index which = 0; which < kOfCoil; ++which) {
        const Eigen::Index at = static_cast<Eigen::Index>(index) * kOfCoil;
        const CoilChange here = changes_.segment<kOfCoil>(at);
        const StandingCoil ahead(changed(coils_[index], here + kProbe * CoilChange::Unit(which)));
        const StandingCoil behind(changed(coils_[index], here - kProbe * CoilChange::Unit(which)));
        for (std::size_t i = 0; i < samples_.size(); ++i) {
          const double current_A = samples_.current_A[i][static_cast<Eigen::Index>(index)];
          if (!used[i] || current_A == 0.0) continue;
          const Eigen::Vector3d& point_m = samples_.position_m[i];
          slopes[i].col(at + which) =
              current_A / (2.0 * kProbe) * (ahead.per_ampere(point_m) - behind.per_ampere(point_m));
        }
      }
    double squares = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i)
      if (used[i]) {
        squares += (samples_.field_T[i] - predicted_T[i]).squaredNorm();
        count += 3;
      }
    const double noise_T =
        std::max(std::sqrt(squares / static_cast<double>(std::max<std::size_t>(count, 1))), kLeastNoise_T);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      if (!used[i]) continue;
      slopes[i].rightCols<kBackground>().setIdentity();
      normal += slopes[i].transpose() * slopes[i];
      right += slopes[i].transpose() * (samples_.field_T[i] - predicted_T[i]);
    }
    normal /= noise_T * noise_T;
    right /= noise_T * noise_T;
    const Eigen::Index of_coils = size - kBackground;
    normal.diagonal().head(of_coils).array() += 1.0;
    right.head(of_coils) -= changes_.head(of_coils);
    const Eigen::VectorXd change = normal.ldlt().solve(right);
    if (!change.allFinite()) throw common::DataError("the samples do not tell where the coils are");
    changes_ += change;
    return change.head(of_coils).cwiseAbs().maxCoeff();
  }

  const FieldSamples& samples_;
  const MeasuredRegion measured_;
  std::vector<CoilDescription> coils_;
  Eigen::VectorXd changes_;  // of each coil, and the background (T)
};

void check_number(const CoilsDescription& coils, const FieldSamples& samples) {
  if (samples.coils != coils.count())
    throw common::DataError(
        fmt::format("the samples are of {} coils, the rig has {}", samples.coils, coils.count()));
}

}  // namespace

FieldError field_error(const CoilsDescription& coils, const FieldSamples& samples) {
  check_number(coils, samples);
  return Fitter(coils, samples).error(std::vector<bool>(samples.size(), true));
}

CoilFit fit_coils(const CoilsDescription& described, const FieldSamples& samples) {
  check_number(described, samples);
  if (described.any_measured())
    throw common::DataError(
        "the rig's coils are what a magnetometer saw (harmonics_T_per_A): there is no winding to place");
  const std::size_t least = kLeastOfCoil * described.count();
  if (samples.size() < least)
    throw common::DataError(
        fmt::format("{} samples are too few for {} coils: at least {} are needed, some hundred are better",
                    samples.size(), samples.coils, least));
  const std::vector<bool> all(samples.size(), true);
  std::vector<bool> held_out(samples.size()), others(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    held_out[i] = i % 5 == 4;
    others[i] = !held_out[i];
  }
  CoilFit fit;
  Fitter fitter(described, samples);
  fit.described = fitter.error(all);
  fitter.fit(others);
  fit.held_out = fitter.error(held_out);
  if (!(fit.held_out.relative_rms <= kMostLeftByCoils))
    throw common::DataError(
        fmt::format("even where they fit best, air-core coils leave {:.0f} % of the field unexplained (at "
                    "most {:.0f}): have the "
                    "coils cores, is a column in another unit, are two of them swapped, or are coils "
                    "described far from where "
                    "they are?",
                    100.0 * fit.held_out.relative_rms, 100.0 * kMostLeftByCoils));
  fitter.fit(all);
  fit.fitted = fitter.error(all);
  fit.coils = described;
  fit.coils.each.clear();
  for (std::size_t index = 0; index < described.count(); ++index) {
    const CoilDescription before = described.coil(index), after = fitter.coil(index);
    CoilShift shift;
    shift.name = after.name;
    for (std::size_t i = 0; i < 3; ++i) shift.moved_m[i] = after.position_m[i] - before.position_m[i];
    shift.tilted_deg =
        geometry::kDegPerRad * std::acos(std::clamp(before.unit_axis().dot(after.unit_axis()), -1.0, 1.0));
    shift.gain = after.gain / before.gain;
    fit.shifts.push_back(shift);
    fit.coils.each.push_back(after);
  }
  const Eigen::Vector3d background_T = fitter.background_T();
  fit.background_T = {background_T.x(), background_T.y(), background_T.z()};
  return fit;
}

}  // namespace lodestone::physics
