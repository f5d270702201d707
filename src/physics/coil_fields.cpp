#include "lodestone/physics/coil_fields.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/physics/four_coils.h"
#include "lodestone/physics/standing_coil.h"

namespace lodestone::physics {

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
  reach_m_ = dish_radius_m + 0.5e-3 + margin_m;
  described_ = coils.each;
  for (const CoilDescription& coil : described_) {
    const StandingCoil exact(coil);
    tables_.emplace_back(
        [&](const geometry::Vector2& point_m) { return exact.beside_winding_per_ampere(point_m); }, reach_m_,
        spacing_m);
    middles_m_.push_back(coil.middle_m());
  }
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
  if (coils.each.empty()) return false;
  return std::equal(described_.begin(), described_.end(), coils.each.begin(), coils.each.end(),
                    [](const CoilDescription& a, const CoilDescription& b) {
                      return static_cast<const CoilWinding&>(a) == b && a.gain == b.gain &&
                             a.position_m == b.position_m && a.axis == b.axis;
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

}  // namespace lodestone::physics
