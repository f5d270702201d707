#include "lodestone/physics/coils_description.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodestone/common/config.h"
#include "lodestone/physics/four_coils.h"
#include "lodestone/physics/per_coil.h"

namespace lodestone::physics {
namespace {

constexpr const char* kFourNames[kFourCoils] = {"+x", "-x", "+y", "-y"};

/// What is said of a coil that has a fault of which only the others tell.
void check_among(const std::vector<CoilDescription>& each, std::size_t coil) {
  constexpr double kSamePlace_m = 1e-3;
  const std::string key = fmt::format("each[{}]", coil);
  const CoilDescription& one = each[coil];
  try {
    one.validate();
  } catch (const common::InvalidConfig& error) {  // where it was not read, but made
    throw common::ConfigError(key + "." + error.what());
  }
  for (std::size_t other = 0; other < coil; ++other) {
    if (each[other].name == one.name)
      throw common::InvalidConfig(key + ".name", one.name,
                                  fmt::format("not be that of each[{}], too: is it listed twice?", other));
    if (!one.measured() && (each[other].middle_m() - one.middle_m()).norm() < kSamePlace_m)
      throw common::InvalidConfig(
          key + ".position_m", one.position_m,
          fmt::format("be another place than that of coil {}: is it listed twice?", each[other].name));
  }
  for (const std::string& name : one.not_with)
    if (name == one.name || std::none_of(each.begin(), each.end(),
                                         [&](const CoilDescription& other) { return other.name == name; }))
      throw common::InvalidConfig(key + ".not_with", one.not_with,
                                  "hold names of other coils, which " + name + " is not");
}

/// Harmonics say nothing without the box that they were measured in, and that one nothing without them.
void check_measured(const CoilsDescription& coils) {
  coils.measured.validate();
  if (coils.any_measured() == !coils.measured.empty()) return;
  throw common::InvalidConfig(
      "measured.centre_m", coils.measured.centre_m,
      coils.measured.empty() ? "be given, with low_m and high_m: coils have harmonics_T_per_A"
                             : "be [], with low_m, high_m and background_T: no coil has harmonics_T_per_A");
}

}  // namespace

void CoilsDescription::validate() const {
  if (each.empty())
    geometry.validate();  // its keys are among these
  else
    geometry.CoilWinding::validate();
  if (each.size() > kMostCoils)
    throw common::InvalidConfig("each", each.size(), fmt::format("list at most {} coils", kMostCoils));
  for (std::size_t coil = 0; coil < each.size(); ++coil) {
    check_among(each, coil);
    if (each[coil].max_current_A > max_current_A)
      throw common::InvalidConfig(
          fmt::format("each[{}].max_current_A", coil), each[coil].max_current_A,
          fmt::format("be at most max_current_A = {}, the largest of all", max_current_A));
  }
  check_measured(*this);
  const auto need_all = [&](const char* key, const auto& list) {
    if (list.size() == count()) return;
    if (each.empty()) throw common::InvalidConfig(key, list, "hold four numbers: +x, -x, +y, -y");
    throw common::InvalidConfig(
        key, list, fmt::format("hold {} numbers, one for each coil that coils.each lists", count()));
  };
  need_all("resistance_20C_ohm", resistance_20C_ohm);
  need_all("inductance_H", inductance_H);
  need_all("polarity", polarity);
  if (std::count(polarity.begin(), polarity.end(), 0) > 0)
    throw common::InvalidConfig("polarity", polarity, "hold 1 or -1 for each coil");
}

std::size_t CoilsDescription::count() const { return each.empty() ? kFourCoils : each.size(); }

CoilDescription CoilsDescription::plain_coil() const {
  CoilDescription coil;
  static_cast<CoilWinding&>(coil) = geometry;
  return coil;
}

CoilDescription CoilsDescription::coil(std::size_t coil) const {
  LODESTONE_CHECK(coil < count(), "coil " + std::to_string(coil) + " of " + std::to_string(count()));
  if (!each.empty()) return each[coil];
  CoilDescription one = plain_coil();
  const geometry::Vector2 direction = coil_direction(static_cast<int>(coil));
  one.name = kFourNames[coil];
  one.position_m = {geometry.centre_distance_m * direction.x(), geometry.centre_distance_m * direction.y(),
                    0.0};
  one.axis = {direction.x(), direction.y(), 0.0};
  one.bipolar = true;
  one.not_with = {kFourNames[coil ^ 1U]};
  return one;
}

double CoilsDescription::largest_A(std::size_t coil) const {
  return each.empty() || each[coil].max_current_A == 0.0 ? max_current_A : each[coil].max_current_A;
}

double CoilsDescription::smallest_A(std::size_t coil) const {
  return each.empty() || each[coil].bipolar ? -largest_A(coil) : 0.0;
}

std::string CoilsDescription::name(std::size_t coil) const {
  if (coil >= count()) return std::to_string(coil);
  return each.empty() ? kFourNames[coil] : each[coil].name;
}

bool CoilsDescription::any_measured() const {
  return std::any_of(each.begin(), each.end(), [](const CoilDescription& coil) { return coil.measured(); });
}

bool CoilsDescription::apart(std::size_t one, std::size_t other) const {
  if (each.empty()) return one != other && one / 2 == other / 2;
  const auto names = [&](std::size_t of, std::size_t what) {
    const std::vector<std::string>& not_with = each[of].not_with;
    return std::find(not_with.begin(), not_with.end(), each[what].name) != not_with.end();
  };
  return names(one, other) || names(other, one);
}

}  // namespace lodestone::physics
