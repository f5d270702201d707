#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "lodestone/imaging/bench.h"
#include "lodestone/imaging/camera_model.h"

namespace lodestone::imaging {

enum EdgeKind {
  kFloor,
  kRimInside,
  kRimOutside,
  kCoilPlusX,
  kCoilMinusX,
  kCoilPlusY,
  kCoilMinusY,
  kEdgeKinds
};
const char* name_of(EdgeKind kind);
inline bool is_circle(EdgeKind kind) { return kind <= kRimOutside; }

/// A point of an edge of the bench, in the dish frame.
struct EdgePoint {
  EdgeKind kind = kFloor;
  int part = 0;  ///< circles are cut into kParts, each with its own direction of contrast
  Eigen::Vector3d point_m;
  Eigen::Vector3d along;    ///< unit tangent
  Eigen::Vector3d outward;  ///< unit, away from the dish centre
};
constexpr int kParts = 12;

std::vector<EdgePoint> edges_of(const BenchGeometry& bench, int per_circle, int per_line);

/// Where a camera sees an edge point.
struct SeenEdge {
  Eigen::Vector2d pixel;
  Eigen::Vector2d normal;  ///< unit, outward across the edge
};
SeenEdge see(const CameraModel& camera, const EdgePoint& edge);

/// Edges nearer than this to each other are blurred into one.
constexpr double kApart_px = 5.0;

/// Whether it is in view, not hidden by the dish wall or a coil, and clear of the neighbouring edge.
class Visibility {
 public:
  Visibility(const CameraModel& camera, const BenchGeometry& bench);
  bool operator()(const EdgePoint& edge, const Eigen::Vector2d& pixel, double margin_px) const;
  /// How far from an edge the next one is seen. Beside a circle that is the wall's other edge. Beside a base
  /// line it is the upper end of the coil's bore, which is a narrow strip where the camera is high up or
  /// nearly above the coil's face, or the dish's rim; less than 0 where the rim hides the line.
  double room_px(const EdgePoint& edge) const;

 private:
  bool clear_of_neighbour(const EdgePoint& edge) const;

  const BenchGeometry& bench_;
  Eigen::Vector3d eye_;
  double pixel_m_;
  double width_px_;
  double height_px_;
};

/// Grey value between pixels, linear. (u, v) must lie inside by one pixel.
float sample(const cv::Mat_<float>& image, double u_px, double v_px);

/// Where the image's edge is on the normal through a predicted place.
struct EdgeHit {
  bool found = false;
  double offset_px = 0.0;  ///< along the normal
  double contrast = 0.0;   ///< grey levels per pixel there, positive where it brightens outwards
};
/// How far an edge may be looked for, `most_px` at most, and not as far as another one `room_px` beside it.
double reach_within_px(double room_px, double most_px);

/// Looks within +-reach_px. `sign` is the wanted sign of the contrast.
EdgeHit find_edge(const cv::Mat_<float>& image, const SeenEdge& seen, double reach_px, double sign,
                  double least_contrast);

}  // namespace lodestone::imaging
