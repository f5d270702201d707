#include "lodestone/physics/field_allocation.h"

#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/physics/coil_fields.h"

namespace lodestone::physics {
namespace {

constexpr std::size_t kDirections = 120;
constexpr std::size_t kPlaces = 9;  // along each axis
using Direction = geometry::Vector2;
using Shares = std::vector<double>;  // of each coil's largest current

Direction direction_of(std::size_t index) {
  const double angle_rad = 2.0 * geometry::kPi * static_cast<double>(index) / kDirections;
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

/// Field along and across a direction (T), pull along and across (T/m) on a needle that lies along it.
using Effect = Eigen::Vector4d;

/// What is asked of all coils together along a direction.
struct Wanted {
  double field_T = 0.0;
  double pull_T_per_m = 0.0;
};

/// What one coil at its largest current does at a place to a needle that lies along a direction.
struct CoilEffect {
  Direction field_T, pull_T_per_m;

  Effect along(const Direction& along) const {
    const Direction across(-along.y(), along.x());
    return {field_T.dot(along), field_T.dot(across), pull_T_per_m.dot(along), pull_T_per_m.dot(across)};
  }
};

/// The pull is what the field differs by between the needle's poles.
CoilEffect effect_of(const CoilsDescription& coils, const CoilFields& fields, std::size_t coil,
                     double chain_m, const geometry::Vector2& position_m, const Direction& along) {
  const double most_A = coils.largest_A(coil);
  const geometry::Vector2 pole_m = 0.5 * chain_m * along;
  return {most_A * fields.per_ampere(coil, position_m).head<2>(),
          most_A *
              (fields.per_ampere(coil, position_m + pole_m) - fields.per_ampere(coil, position_m - pole_m))
                  .head<2>() /
              chain_m};
}

/// Bounded least squares of the four effects, coil by coil, with a little weight on the currents themselves.
/// `unit`: what field and pull count in.
Shares solved(const std::vector<Effect>& effects, const Effect& wanted, const Wanted& unit,
              const Shares& lowest, const Shares& highest) {
  constexpr double kOfCurrents = 1e-3;
  constexpr int kMostSweeps = 1000;
  const Effect weight(1.0 / unit.field_T, 1.0 / unit.field_T, 1.0 / unit.pull_T_per_m,
                      1.0 / unit.pull_T_per_m);
  std::vector<Effect> column;
  column.reserve(effects.size());
  for (const Effect& effect : effects) column.push_back(weight.cwiseProduct(effect));
  Shares share(column.size(), 0.0);
  Effect left = weight.cwiseProduct(wanted);
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double moved = 0.0;
    for (std::size_t coil = 0; coil < share.size(); ++coil) {
      const double size = column[coil].squaredNorm();
      const double best = (column[coil].dot(left) + size * share[coil]) / (size + kOfCurrents * kOfCurrents);
      const double next = std::clamp(best, lowest[coil], highest[coil]);
      left -= (next - share[coil]) * column[coil];
      moved = std::max(moved, std::abs(next - share[coil]));
      share[coil] = next;
    }
    if (moved < 1e-7) break;
  }
  return share;
}

/// The same, with one off of each two coils that may not be on together.
Shares nearest_shares(const CoilsDescription& coils, const std::vector<Effect>& effects, const Effect& wanted,
                      const Wanted& unit) {
  Shares highest(effects.size(), 1.0), lowest;
  for (std::size_t coil = 0; coil < effects.size(); ++coil)
    lowest.push_back(coils.smallest_A(coil) < 0.0 ? -1.0 : 0.0);
  Shares found = solved(effects, wanted, unit, lowest, highest);
  for (std::size_t one = 0; one < found.size(); ++one)
    for (std::size_t other = one + 1; other < found.size(); ++other) {
      if (!coils.apart(one, other) || found[one] == 0.0 || found[other] == 0.0) continue;
      const std::size_t off = effects[one][0] < effects[other][0] ? one : other;  // it helps less
      lowest[off] = highest[off] = 0.0;
      found = solved(effects, wanted, unit, lowest, highest);
    }
  return found;
}

/// What the coils can do to a needle at one place.
class Place {
 public:
  Place(const RigDescription& rig, const CoilFields& fields, const geometry::Vector2& position_m)
      : coils_(rig.coils) {
    for (std::size_t coil = 0; coil < coils_.count(); ++coil)
      for (std::size_t i = 0; i < kDirections; ++i) {
        const Direction along = direction_of(i);
        const CoilEffect effect = effect_of(coils_, fields, coil, rig.needle.chain_m, position_m, along);
        strongest_T_ = std::max(strongest_T_, effect.field_T.norm());
        steepest_T_per_m_ = std::max(steepest_T_per_m_, effect.pull_T_per_m.norm());
        effects_[i].push_back(effect.along(along));
      }
  }

  /// Of any coil alone at its largest current.
  double strongest_T() const { return strongest_T_; }
  double steepest_T_per_m() const { return steepest_T_per_m_; }

  /// `unit`: what field and pull count in.
  Shares nearest(std::size_t direction, const Wanted& wanted, const Wanted& unit) const {
    return nearest_shares(coils_, effects_[direction], Effect(wanted.field_T, 0.0, wanted.pull_T_per_m, 0.0),
                          unit);
  }

  /// Enough of a field to turn the needle, and field and pull less than 25 degrees off: four coils of which
  /// opposite ones are never on together cannot have both along every direction.
  bool makes(const Shares& share, std::size_t direction, const Wanted& wanted) const {
    constexpr double kEnough = 0.3, kAside = 0.466, kShort = 0.95;
    Effect sum = Effect::Zero();
    for (std::size_t coil = 0; coil < share.size(); ++coil) sum += share[coil] * effects_[direction][coil];
    return sum[0] > kEnough * wanted.field_T && std::abs(sum[1]) < kAside * sum[0] &&
           sum[2] > kShort * wanted.pull_T_per_m && std::abs(sum[3]) < kAside * sum[2];
  }

 private:
  const CoilsDescription& coils_;
  std::array<std::vector<Effect>, kDirections> effects_;  // of each coil at its largest current
  double strongest_T_ = 0.0;
  double steepest_T_per_m_ = 0.0;
};

/// The first direction along which the coils cannot make what is wanted; kDirections: none.
std::size_t first_without(const Place& place, const Wanted& wanted, const Wanted& unit, std::size_t step) {
  for (std::size_t i = 0; i < kDirections; i += step)
    if (!place.makes(place.nearest(i, wanted, unit), i, wanted)) return i;
  return kDirections;
}

/// The field that the description asks for, with the largest pull that every direction can have; where not
/// every one can, that of one coil, `as_they_can`.
Wanted strongest_at(const Place& centre, double field_share, const Wanted& unit, bool as_they_can) {
  constexpr double kStep = 0.93, kLeast = 0.02;
  std::size_t lacking = 0;
  for (double part = 2.0; part > kLeast; part *= kStep) {
    const Wanted wanted{field_share * unit.field_T, part * unit.pull_T_per_m};
    const std::size_t without = first_without(centre, wanted, unit, 5);
    lacking = std::max(lacking, without % kDirections);
    if (without == kDirections && first_without(centre, wanted, unit, 1) == kDirections) return wanted;
  }
  if (as_they_can) return {field_share * unit.field_T, unit.pull_T_per_m};
  throw common::ConfigError(
      fmt::format("rig.coils.each: these coils cannot pull the needle along {:g} deg at the dish centre with "
                  "a field that turns it there; coils are needed on more sides, or bipolar ones "
                  "(rig.drive.kind = field)",
                  360.0 * static_cast<double>(lacking) / kDirections));
}

}  // namespace

FieldAllocation::FieldAllocation(const RigDescription& rig)
    : coils_(rig.coils.count()),
      description_(rig.coils),
      fields_(CoilFields::shared(rig.coils, rig.dish.radius_m)),
      chain_m_(rig.needle.chain_m),
      apart_(rig.coils) {
  const Place centre(rig, *fields_, geometry::Vector2::Zero());
  strongest_T_ = centre.strongest_T();
  steepest_T_per_m_ = centre.steepest_T_per_m();
  const Wanted unit{strongest_T_, steepest_T_per_m_};
  if (!(unit.field_T > 0.0 && unit.pull_T_per_m > 0.0))
    throw common::InvalidConfig("coils.max_current_A", rig.coils.max_current_A,
                                "be above 0, or no field can be made (drive.kind = field)");
  const Wanted wanted =
      strongest_at(centre, rig.drive.field_share, unit, rig.drive.kind == DriveKind::kIndependent);
  field_T_ = wanted.field_T;
  pull_T_per_m_ = wanted.pull_T_per_m;
  // The middle of a needle comes no nearer to the wall along its own direction.
  half_side_m_ = std::max(rig.dish.radius_m - 0.5 * rig.needle.chain_m, 1e-3);
  current_A_.reserve(kPlaces * kPlaces * kDirections * coils_);
  const auto at = [this](std::size_t index) {
    return half_side_m_ * (2.0 * static_cast<double>(index) / (kPlaces - 1) - 1.0);
  };
  for (std::size_t row = 0; row < kPlaces; ++row)
    for (std::size_t column = 0; column < kPlaces; ++column) {
      const geometry::Vector2 corner_m(at(column), at(row));
      const double distance_m = corner_m.norm();
      const Place place(
          rig, *fields_,
          distance_m > half_side_m_ ? geometry::Vector2(corner_m * half_side_m_ / distance_m) : corner_m);
      for (std::size_t i = 0; i < kDirections; ++i) {
        const Shares shares = place.nearest(i, wanted, unit);
        for (std::size_t coil = 0; coil < coils_; ++coil)
          current_A_.push_back(shares[coil] * rig.coils.largest_A(coil));
      }
    }
}

std::shared_ptr<const FieldAllocation> FieldAllocation::shared(const RigDescription& rig) {
  struct Held {
    std::string of;
    std::weak_ptr<const FieldAllocation> allocation;
  };
  static std::mutex mutex;
  static std::vector<Held> all;
  const std::string of = common::config_to_json(rig).dump();
  const std::lock_guard<std::mutex> lock(mutex);
  all.erase(
      std::remove_if(all.begin(), all.end(), [](const Held& held) { return held.allocation.expired(); }),
      all.end());
  for (const Held& held : all)
    if (const auto allocation = held.allocation.lock(); held.of == of && allocation) return allocation;
  const auto made = std::make_shared<const FieldAllocation>(rig);
  all.push_back({of, made});
  return made;
}

/// Adds what a place has for a direction, in steps of the table's own.
void FieldAllocation::add(double share, std::size_t node, double place, PerCoil& sum_A) const {
  const auto before = static_cast<std::size_t>(place) % kDirections;
  const double next_share = place - std::floor(place);
  const double* one = &current_A_[(node * kDirections + before) * coils_];
  const double* next = &current_A_[(node * kDirections + (before + 1) % kDirections) * coils_];
  for (std::size_t coil = 0; coil < coils_; ++coil)
    sum_A[coil] += share * ((1.0 - next_share) * one[coil] + next_share * next[coil]);
}

PerCoil FieldAllocation::current_A(double direction_rad, const geometry::Vector2& position_m) const {
  const double turn = direction_rad / (2.0 * geometry::kPi);
  const double place = (turn - std::floor(turn)) * kDirections;
  const auto along = [this](double at_m) {
    const double node = 0.5 * (at_m / half_side_m_ + 1.0) * (kPlaces - 1);
    return std::clamp(node, 0.0, static_cast<double>(kPlaces - 1));
  };
  const double x = along(position_m.x()), y = along(position_m.y());
  const auto column = std::min(static_cast<std::size_t>(x), kPlaces - 2);
  const auto row = std::min(static_cast<std::size_t>(y), kPlaces - 2);
  const double right = x - static_cast<double>(column), up = y - static_cast<double>(row);
  PerCoil sum_A(coils_);
  add((1.0 - right) * (1.0 - up), row * kPlaces + column, place, sum_A);
  add(right * (1.0 - up), row * kPlaces + column + 1, place, sum_A);
  add((1.0 - right) * up, (row + 1) * kPlaces + column, place, sum_A);
  add(right * up, (row + 1) * kPlaces + column + 1, place, sum_A);
  apart_.keep(sum_A);
  return sum_A;
}

PerCoil FieldAllocation::current_A(const geometry::Vector2& field_share, const geometry::Vector2& pull_share,
                                   const geometry::Vector2& position_m) const {
  const double field = field_share.norm(), pull = pull_share.norm();
  if (field == 0.0 && pull == 0.0) return PerCoil(coils_);
  const Direction along = field > 0.0 ? Direction(field_share / field) : Direction(pull_share / pull);
  const Direction across(-along.y(), along.x());
  const double distance_m = position_m.norm();
  const geometry::Vector2 place_m =
      distance_m > half_side_m_ ? geometry::Vector2(position_m * half_side_m_ / distance_m) : position_m;
  std::vector<Effect> effects;
  effects.reserve(coils_);
  for (std::size_t coil = 0; coil < coils_; ++coil)
    effects.push_back(effect_of(description_, *fields_, coil, chain_m_, place_m, along).along(along));
  const Effect wanted(field_T_ * field, 0.0, pull_T_per_m_ * pull_share.dot(along),
                      pull_T_per_m_ * pull_share.dot(across));
  const Shares shares = nearest_shares(description_, effects, wanted, {strongest_T_, steepest_T_per_m_});
  PerCoil current_A(coils_);
  for (std::size_t coil = 0; coil < coils_; ++coil)
    current_A[coil] = shares[coil] * description_.largest_A(coil);
  return current_A;
}

}  // namespace lodestone::physics
