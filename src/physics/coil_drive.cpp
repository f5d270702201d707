#include "lodestone/physics/coil_drive.h"

#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "lodestone/common/config.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/physics/standing_coil.h"

namespace lodestone::physics {
namespace {

constexpr std::size_t kDirections = 120;
using Direction = geometry::Vector2;

Direction direction_of(std::size_t index) {
  const double angle_rad = 2.0 * geometry::kPi * static_cast<double>(index) / kDirections;
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

/// Field along and across a direction (T), pull along and across (T/m) on a needle that lies along it.
using Effect = Eigen::Vector4d;

/// Currents, as shares of each coil's largest, for a field and a pull along one direction: bounded least
/// squares of the four effects, with a little weight on the currents themselves, so that of equal ones the
/// smallest are found.
class Allocation {
 public:
  explicit Allocation(const RigDescription& rig) : rig_(rig) {
    const double half_m = 0.5 * rig.needle.chain_m;
    for (std::size_t coil = 0; coil < rig.coils.count(); ++coil) {
      const StandingCoil exact(rig.coils.coil(coil));
      const double most_A = rig.coils.largest_A(coil);
      const Eigen::Vector2d field_T = most_A * exact.per_ampere(Eigen::Vector3d::Zero()).head<2>();
      strongest_T_ = std::max(strongest_T_, field_T.norm());
      lowest_.push_back(rig.coils.smallest_A(coil) < 0.0 ? -1.0 : 0.0);
      for (std::size_t i = 0; i < kDirections; ++i) {
        const Direction along = direction_of(i), across(-along.y(), along.x());
        const Eigen::Vector3d pole_m(half_m * along.x(), half_m * along.y(), 0.0);
        const Eigen::Vector2d pull =
            most_A * (exact.per_ampere(pole_m) - exact.per_ampere(-pole_m)).head<2>() / rig.needle.chain_m;
        steepest_T_per_m_ = std::max(steepest_T_per_m_, pull.norm());
        effects_[i].emplace_back(field_T.dot(along), field_T.dot(across), pull.dot(along), pull.dot(across));
      }
    }
    if (!(strongest_T_ > 0.0 && steepest_T_per_m_ > 0.0))
      throw common::InvalidConfig("coils.max_current_A", rig.coils.max_current_A,
                                  "be above 0, or no field can be made (drive.kind = field)");
  }

  double steepest_T_per_m() const { return steepest_T_per_m_; }

  /// Shares for a pull of so much (T/m) along a direction; empty where the coils cannot make it.
  std::vector<double> shares(std::size_t direction, double pull_T_per_m) const {
    std::vector<double> highest(lowest_.size(), 1.0), lowest = lowest_;
    std::vector<double> found = solved(direction, pull_T_per_m, lowest, highest);
    for (std::size_t one = 0; one < found.size(); ++one)
      for (std::size_t other = one + 1; other < found.size(); ++other) {
        if (!rig_.coils.apart(one, other) || found[one] == 0.0 || found[other] == 0.0) continue;
        const std::size_t off = against_field(one, direction) > against_field(other, direction) ? one : other;
        lowest[off] = highest[off] = 0.0;
        found = solved(direction, pull_T_per_m, lowest, highest);
      }
    return makes(found, direction, pull_T_per_m) ? found : std::vector<double>{};
  }

 private:
  double wanted_T() const { return rig_.drive.field_share * strongest_T_; }
  double against_field(std::size_t coil, std::size_t direction) const {
    return -effects_[direction][coil][0];
  }

  std::vector<double> solved(std::size_t direction, double pull_T_per_m, const std::vector<double>& lowest,
                             const std::vector<double>& highest) const {
    constexpr double kOfCurrents = 1e-3;
    constexpr int kMostSweeps = 1000;
    const Effect weight(1.0 / strongest_T_, 1.0 / strongest_T_, 1.0 / steepest_T_per_m_,
                        1.0 / steepest_T_per_m_);
    std::vector<Effect> column;
    for (const Effect& effect : effects_[direction]) column.push_back(weight.cwiseProduct(effect));
    std::vector<double> share(column.size(), 0.0);
    Effect left = weight.cwiseProduct(Effect(wanted_T(), 0.0, pull_T_per_m, 0.0));
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
      double moved = 0.0;
      for (std::size_t coil = 0; coil < share.size(); ++coil) {
        const double size = column[coil].squaredNorm();
        const double best =
            (column[coil].dot(left) + size * share[coil]) / (size + kOfCurrents * kOfCurrents);
        const double next = std::clamp(best, lowest[coil], highest[coil]);
        left -= (next - share[coil]) * column[coil];
        moved = std::max(moved, std::abs(next - share[coil]));
        share[coil] = next;
      }
      if (moved < 1e-7) break;
    }
    return share;
  }

  /// Enough of a field to turn the needle, and field and pull less than 25 degrees off: four coils of which
  /// opposite ones are never on together cannot have both along every direction.
  bool makes(const std::vector<double>& share, std::size_t direction, double pull_T_per_m) const {
    constexpr double kEnough = 0.3, kAside = 0.466, kShort = 0.95;
    Effect sum = Effect::Zero();
    for (std::size_t coil = 0; coil < share.size(); ++coil) sum += share[coil] * effects_[direction][coil];
    return sum[0] > kEnough * wanted_T() && std::abs(sum[1]) < kAside * sum[0] &&
           sum[2] > kShort * pull_T_per_m && std::abs(sum[3]) < kAside * sum[2];
  }

  const RigDescription& rig_;
  std::array<std::vector<Effect>, kDirections> effects_;  // of each coil at its largest current
  std::vector<double> lowest_;
  double strongest_T_ = 0.0;
  double steepest_T_per_m_ = 0.0;
};

/// The first direction along which the coils cannot pull so much; kDirections: none.
std::size_t first_without(const Allocation& allocation, double pull_T_per_m) {
  for (std::size_t i = 0; i < kDirections; i += 5)
    if (allocation.shares(i, pull_T_per_m).empty()) return i;
  return kDirections;
}

/// Currents, as shares, for every direction, and the largest pull that all of them have.
struct Round {
  double pull_T_per_m = 0.0;
  std::vector<std::vector<double>> shares;
};

Round strongest_round(const Allocation& allocation) {
  constexpr double kStep = 0.93, kLeast = 0.02;
  std::size_t lacking = 0;
  for (double part = 2.0; part > kLeast; part *= kStep) {
    const double pull_T_per_m = part * allocation.steepest_T_per_m();
    const std::size_t without = first_without(allocation, pull_T_per_m);
    lacking = std::max(lacking, without % kDirections);
    if (without != kDirections) continue;
    Round round{pull_T_per_m, {}};
    for (std::size_t i = 0; i < kDirections; ++i) round.shares.push_back(allocation.shares(i, pull_T_per_m));
    const auto none = [](const std::vector<double>& shares) { return shares.empty(); };
    if (std::none_of(round.shares.begin(), round.shares.end(), none)) return round;
  }
  throw common::ConfigError(
      fmt::format("rig.coils.each: these coils cannot pull the needle along {:g} deg at the dish centre with "
                  "a field that "
                  "turns it there; coils are needed on more sides, or bipolar ones (rig.drive.kind = field)",
                  360.0 * static_cast<double>(lacking) / kDirections));
}

}  // namespace

PerCoil opposed_pairs_A(const geometry::Vector2& axis_drive_A) {
  return {std::max(axis_drive_A.x(), 0.0), std::max(-axis_drive_A.x(), 0.0), std::max(axis_drive_A.y(), 0.0),
          std::max(-axis_drive_A.y(), 0.0)};
}

CoilDrive::CoilDrive(const RigDescription& rig)
    : coils_(rig.coils.count()), full_drive_A_(rig.coils.max_current_A) {
  if (rig.drive.kind == DriveKind::kOpposedPairs) return;
  const Round round = strongest_round(Allocation(rig));
  for (const std::vector<double>& shares : round.shares) {
    PerCoil current_A(coils_);
    for (std::size_t coil = 0; coil < coils_; ++coil)
      current_A[coil] = shares[coil] * rig.coils.largest_A(coil);
    by_direction_A_.push_back(current_A);
  }
  for (std::size_t coil = 0; coil < coils_; ++coil) {
    largest_A_[coil] = rig.coils.largest_A(coil);
    smallest_A_[coil] = rig.coils.smallest_A(coil);
    for (std::size_t other = coil + 1; other < coils_; ++other)
      if (rig.coils.apart(coil, other)) apart_.emplace_back(coil, other);
  }
  full_pull_N_ = rig.needle.moment_A_m2 * round.pull_T_per_m;
}

PerCoil CoilDrive::along(double direction_rad) const {
  const double turn = direction_rad / (2.0 * geometry::kPi);
  const double place = (turn - std::floor(turn)) * kDirections;
  const auto before = static_cast<std::size_t>(place) % kDirections;
  const double share = place - std::floor(place);
  const PerCoil& one = by_direction_A_[before];
  const PerCoil& next = by_direction_A_[(before + 1) % kDirections];
  PerCoil between(coils_);
  for (std::size_t coil = 0; coil < coils_; ++coil)
    between[coil] = (1.0 - share) * one[coil] + share * next[coil];
  for (const auto& [one_coil, other] : apart_)
    between[std::abs(between[one_coil]) < std::abs(between[other]) ? one_coil : other] = 0.0;
  return between;
}

PerCoil CoilDrive::current_A(const geometry::Vector2& drive_A) const {
  if (by_direction_A_.empty()) return opposed_pairs_A(drive_A);
  const double size_A = drive_A.norm();
  if (size_A == 0.0) return PerCoil(coils_);
  PerCoil current_A = along(std::atan2(drive_A.y(), drive_A.x()));
  double share = size_A / full_drive_A_;
  for (std::size_t coil = 0; coil < coils_; ++coil) {
    const double most_A = current_A[coil] < 0.0 ? smallest_A_[coil] : largest_A_[coil];
    if (current_A[coil] != 0.0) share = std::min(share, most_A / current_A[coil]);
  }
  for (double& one_A : current_A) one_A *= share;
  return current_A;
}

}  // namespace lodestone::physics
