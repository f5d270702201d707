#include "lodestone/physics/coil_fields.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/physics/described_coil.h"
#include "lodestone/physics/four_coils.h"

namespace lodestone::physics {
namespace {

constexpr double kOfNeedle_m = 0.5e-3;  // beyond the dish, for the needle's ends

void check_reach(const CoilsDescription& coils, double dish_radius_m, double margin_m) {
  const double needed_m = dish_radius_m + kOfNeedle_m + margin_m;
  if (!coils.any_measured() || coils.measured.disc_radius_m() >= needed_m) return;
  throw common::ConfigError(
      fmt::format("coils.measured: the coils were measured up to {:.1f} mm from the dish centre in the "
                  "needle's plane, and {:.1f} mm are needed: a dish of {:.1f} mm (dish.radius_m), {:.1f} mm "
                  "for the needle's ends and {:.1f} mm for how far the dish may lie from where it should "
                  "(simulation.deviation)",
                  1e3 * coils.measured.disc_radius_m(), 1e3 * needed_m, 1e3 * dish_radius_m,
                  1e3 * kOfNeedle_m, 1e3 * margin_m));
}

}  // namespace

CoilFields::CoilFields(std::shared_ptr<const FieldTable> table) : ring_(std::move(table)) {
  LODESTONE_CHECK(ring_ != nullptr, "a field table is needed");
  reach_m_ = ring_->reach_m();
  for (int coil = 0; coil < kFourCoils; ++coil) {
    const geometry::Vector2 middle_m = ring_->geometry().centre_distance_m * coil_direction(coil);
    middles_m_.emplace_back(middle_m.x(), middle_m.y(), 0.0);
  }
}

CoilFields::CoilFields(const CoilsDescription& coils, double dish_radius_m, double margin_m,
                       double spacing_m) {
  if (coils.each.empty()) {
    *this = CoilFields(make_field_table(coils.geometry, dish_radius_m, margin_m, spacing_m));
    return;
  }
  check_reach(coils, dish_radius_m, margin_m);
  reach_m_ = dish_radius_m + kOfNeedle_m + margin_m;
  described_ = coils.each;
  measured_ = coils.measured;
  for (const CoilDescription& coil : described_) {
    const DescribedCoil field(coil, measured_);
    tables_.emplace_back([&](const geometry::Vector2& point_m) { return field.in_plane_per_ampere(point_m); },
                         reach_m_, spacing_m);
    middles_m_.push_back(coil.middle_m());
  }
  if (!measured_.background_T.empty())
    background_.emplace_back(
        [&](const geometry::Vector2& point_m) {
          return measured_.sum(measured_.background_T, {point_m.x(), point_m.y(), 0.0});
        },
        reach_m_, spacing_m);
}

std::shared_ptr<const CoilFields> CoilFields::shared(const CoilsDescription& coils, double dish_radius_m,
                                                     double margin_m, double spacing_m) {
  struct Held {
    std::array<double, 3> sizes;
    std::weak_ptr<const CoilFields> fields;
  };
  static std::mutex mutex;
  static std::vector<Held> all;
  const std::array<double, 3> sizes = {dish_radius_m, margin_m, spacing_m};
  const std::lock_guard<std::mutex> lock(mutex);
  all.erase(std::remove_if(all.begin(), all.end(), [](const Held& held) { return held.fields.expired(); }),
            all.end());
  for (const Held& held : all)
    if (const auto fields = held.fields.lock(); held.sizes == sizes && fields && fields->of(coils))
      return fields;
  const auto made = std::make_shared<const CoilFields>(coils, dish_radius_m, margin_m, spacing_m);
  all.push_back({sizes, made});
  return made;
}

bool CoilFields::of(const CoilsDescription& coils) const {
  if (planar()) return coils.each.empty() && ring_->geometry() == coils.geometry;
  if (coils.each.empty() || !(measured_ == coils.measured)) return false;
  return std::equal(described_.begin(), described_.end(), coils.each.begin(), coils.each.end(),
                    [](const CoilDescription& a, const CoilDescription& b) {
                      return static_cast<const CoilWinding&>(a) == b && a.gain == b.gain &&
                             a.position_m == b.position_m && a.axis == b.axis &&
                             a.harmonics_T_per_A == b.harmonics_T_per_A;
                    });
}

geometry::Vector2 CoilFields::in_plane(std::size_t coil, const geometry::Vector2& point_m) const {
  const int index = static_cast<int>(coil);
  return from_coil_frame(index, ring_->per_ampere(to_coil_frame(index, point_m)));
}

Eigen::Vector3d CoilFields::per_ampere(std::size_t coil, const geometry::Vector2& point_m) const {
  if (!planar()) return tables_[coil].at(point_m);
  const geometry::Vector2 field = in_plane(coil, point_m);
  return {field.x(), field.y(), 0.0};
}

Eigen::Vector3d CoilFields::background_T(const geometry::Vector2& point_m) const {
  return background_.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : background_.front().at(point_m);
}

}  // namespace lodestone::physics
