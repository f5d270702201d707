#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::physics {

enum class ObstacleShape { kDisc, kPolygon };
inline std::vector<std::string> names_of(ObstacleShape) { return {"disc", "polygon"}; }

/// A solid body that stands on the floor of the dish, as high as the fluid.
struct ObstacleConfig {
  ObstacleShape shape = ObstacleShape::kDisc;
  std::vector<double> centre_m = {0.0, 0.0};
  double radius_m = 2e-3;  // D
  std::vector<double> corners_m;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("shape", shape, "", "disc, or polygon: any outline that does not cross itself");
    v.field("centre_m", centre_m, "m", "of disc: [x, y] from the dish centre", {-0.5, 0.5});
    v.field("radius_m", radius_m, "m", "of disc", {1e-4, 0.5});
    v.field("corners_m", corners_m, "m",
            "of polygon: [x, y, x, y, ...] of its corners from the dish centre, in turn, either way round",
            {-0.5, 0.5});
  }
  /// Throws ConfigError when the keys are no such outline.
  void validate() const;

  /// The polygon's corners, or the disc's middle.
  std::vector<geometry::Vector2> points_m() const;
  /// What a picture of it shows: a disc as a polygon of many corners.
  std::vector<geometry::Vector2> outline_m() const;
  /// How far from the dish centre it reaches.
  double reach_m() const;
};

/// All that is within a distance of a straight line between two points: a needle with round ends.
struct Capsule {
  geometry::Vector2 tail_m;
  geometry::Vector2 head_m;
  double radius_m;
};

/// The solid bodies in a dish.
class Obstacles {
 public:
  /// A place where a capsule and an obstacle are near each other.
  struct Touch {
    geometry::Vector2 at_m;     ///< on the capsule's axis
    geometry::Vector2 towards;  ///< unit vector from there to the obstacle
    double clearance_m;         ///< between the surfaces; negative where they overlap
  };

  /// None.
  Obstacles() = default;
  /// Throws ConfigError.
  explicit Obstacles(const std::vector<ObstacleConfig>& configs);

  bool empty() const { return bodies_.empty(); }
  /// Adds every place where a clearance is at most `within_m`: both ends of a needle that lies along a side,
  /// both sides of a notch. The axis itself must be clear of the bodies.
  void find(const Capsule& capsule, double within_m, std::vector<Touch>& touches) const;
  /// Whether the axis itself passes through a body.
  bool on_axis(const Capsule& capsule) const;
  /// Whether no body reaches into the capsule.
  bool clear_of(const Capsule& capsule) const;

 private:
  /// All that is within a distance of a polygon, or of a point.
  struct Body {
    std::vector<geometry::Vector2> corners_m;  // counter-clockwise
    double rounding_m;
    geometry::Vector2 middle_m;
    double reach_m;  // of it about its middle
  };

  static void find_at_corner(const Body& body, std::size_t corner, const Capsule& capsule, double within_m,
                             std::vector<Touch>& touches);
  static void find_at_side(const Body& body, std::size_t side, const Capsule& capsule, double within_m,
                           std::vector<Touch>& touches);

  std::vector<Body> bodies_;
};

}  // namespace lodestone::physics
