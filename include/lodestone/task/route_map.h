#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/geometry/keep_out.h"
#include "lodestone/task/region.h"

namespace lodestone::task {

/// When ways are searched: where there are zones to keep out of, always, or never.
enum class RouteUse { kZones, kAlways, kNever };
inline std::vector<std::string> names_of(RouteUse) { return {"zones", "always", "never"}; }

/// Whose pulses show where the needle can be brought: those that were recorded, or ones in the simulator that
/// was learned from them.
enum class MovesFrom { kRecorded, kSimulated };
inline std::vector<std::string> names_of(MovesFrom) { return {"recorded", "simulated"}; }

/// How ways to a point are searched and followed.
struct RouteConfig {
  RouteUse use = RouteUse::kZones;
  double clearance_m = 0.003;
  double clearance_cost = 4.0;
  MovesFrom moves = MovesFrom::kRecorded;
  std::int64_t simulated_pulses = 100;
  std::int64_t least_moves = 1;
  double waypoint_radius_m = 0.004;
  double stray_m = 0.010;
  RegionConfig region;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field(
        "use", use, "",
        "when the needle is led to a point by a way that was searched: where there are zones to keep out of "
        "(safety.keep_out, trials.obstacles), always, or never");
    v.field(
        "clearance_m", clearance_m, "m",
        "a way on which the needle's ends, whichever way it lies, come nearer to a zone's margin than this "
        "costs more",
        {0.0, 0.1});
    v.field("clearance_cost", clearance_cost, "",
            "so many times its length more where its middle can only just pass, in proportion before",
            {0.0, 1000.0});
    v.field(
        "moves", moves, "",
        "pulses that show where the needle can be brought, where a simulator is named (dynamics): those that "
        "it was trained on, or ones that are driven in it");
    v.field("simulated_pulses", simulated_pulses, "", "of the latter so many from every cell of the dish",
            {1, 100000});
    v.field("least_moves", least_moves, "",
            "pulses from a cell to another that there must be for a way to lead there", {1, 1000000});
    v.field("waypoint_radius_m", waypoint_radius_m, "m",
            "the next point of the way is aimed at once the needle is sensed this close to one", {1e-4, 0.1});
    v.field("stray_m", stray_m, "m", "a needle this far off its way has a new one searched", {1e-3, 0.1});
    v.group("region", region, "how the part of the dish that can be reached is mapped from recorded pulses");
  }
};

/// The ways on which a needle can be brought from one cell of its reachable region to another: a graph of
/// cells, between which recorded pulses moved it. Zones to keep out of come with each question, for they may
/// move.
class RouteMap {
 public:
  /// Cells of `region`, and between them the `moves` of which there are `config.least_moves`. Without any
  /// moves every cell leads to the eight around it.
  RouteMap(Region region, const std::vector<Move>& moves, const RouteConfig& config);

  /// The cheapest way (A*, Boost.Graph) from a place over the middles of cells to another, both included, on
  /// which the needle's sides keep the margin. Empty where there is none, and where `to_m` lies further than
  /// a cell from all that can be reached.
  std::vector<geometry::Vector2> route(const geometry::Vector2& from_m, const geometry::Vector2& to_m,
                                       const geometry::KeepOut& keep_out) const;
  /// Whether the straight way stays within the region, and in it keeps `least_m` of clearance.
  bool straight(const geometry::Vector2& from_m, const geometry::Vector2& to_m,
                const geometry::KeepOut& keep_out, double least_m) const;
  /// The clearance of the needle's middle from which on more of it is worth nothing.
  double wanted_m(const geometry::KeepOut& keep_out) const {
    return keep_out.any_way_m() + config_.clearance_m;
  }

  const RouteConfig& config() const { return config_; }
  const Region& region() const { return region_; }
  /// Middles of the cells that recorded pulses came to or left, but that are not in the region.
  const std::vector<geometry::Vector2>& dead_m() const { return dead_m_; }

 private:
  using Link = std::pair<std::size_t, std::size_t>;
  using Allowed = std::function<bool(const geometry::Vector2& centre_m)>;
  void link_neighbours();
  void link_recorded(const std::vector<Move>& moves);
  double cost_m(double length_m, double clearance_m, const geometry::KeepOut& keep_out) const;
  /// The cell nearest to a point, of those that are allowed.
  std::optional<std::size_t> nearest(const geometry::Vector2& point_m, const Allowed& allowed) const;

  Region region_;
  RouteConfig config_;
  std::vector<geometry::Vector2> centres_m_;  // of the region's cells
  std::vector<Link> links_;
  std::vector<geometry::Vector2> dead_m_;
};

}  // namespace lodestone::task
