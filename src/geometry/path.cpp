#include "lodestone/geometry/path.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "lodestone/common/csv_table.h"
#include "lodestone/common/spelling.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::geometry {

using common::DataError;

namespace {

/// Of a CSV file of points, with a heading for each of them or for none.
struct Rows {
  std::vector<Vector2> points_m;
  std::vector<double> heading_rad;
};

/// `may_head`: there may be a column of headings.
Rows read_rows(const std::string& file, bool may_head) {
  common::CsvTable table(file);
  const bool headed = may_head && table.header() == std::vector<std::string>{"x_m", "y_m", "heading_rad"};
  if (!headed && table.header() != std::vector<std::string>{"x_m", "y_m"})
    throw DataError(file + ":1: the header must be x_m,y_m" + (may_head ? " or x_m,y_m,heading_rad" : "") +
                    ", found \"" + common::joined(table.header(), ",") + "\"");
  Rows rows;
  while (table.next()) {
    table.check_width();
    rows.points_m.emplace_back(table.number(0), table.number(1));
    if (headed) rows.heading_rad.push_back(table.number(2));
  }
  if (rows.points_m.empty())
    throw DataError(file + ": no points; expected at least one row below the header");
  return rows;
}

}  // namespace

Path::Path(std::vector<Vector2> points_m, bool closed) : points_m_(std::move(points_m)), closed_(closed) {
  if (points_m_.size() < 2)
    throw DataError("a path needs at least two points, got " + std::to_string(points_m_.size()));
  if (closed_ && points_m_.front() != points_m_.back()) points_m_.push_back(points_m_.front());
  arc_m_.push_back(0.0);
  for (std::size_t i = 1; i < points_m_.size(); ++i)
    arc_m_.push_back(arc_m_.back() + (points_m_[i] - points_m_[i - 1]).norm());
  if (!(arc_m_.back() > 0.0)) throw DataError("a path needs two different points: its length is zero");
}

Path Path::square(double side_m) {
  const double h = side_m / 2.0;
  return Path({{h, -h}, {h, h}, {-h, h}, {-h, -h}}, true);
}

Path Path::circle(double radius_m, int segments) {
  std::vector<Vector2> points;
  for (int i = 0; i < segments; ++i) {
    const double angle = 2.0 * kPi * i / segments;
    points.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle));
  }
  return Path(std::move(points), true);
}

std::vector<Vector2> read_points_csv(const std::string& file) { return read_rows(file, false).points_m; }

Path Path::from_csv(const std::string& file) {
  Rows rows = read_rows(file, true);
  const bool closed = rows.points_m.size() > 2 && rows.points_m.front() == rows.points_m.back();
  Path path(std::move(rows.points_m), closed);
  if (rows.heading_rad.empty()) return path;
  return path.with_heading(PathHeading::column(std::move(rows.heading_rad)));
}

Path Path::with_heading(PathHeading heading) const {
  if (heading.rule() == HeadingRule::kColumn && heading.points() != points_m_.size())
    throw DataError("a path of " + std::to_string(points_m_.size()) + " points has " +
                    std::to_string(heading.points()) + " headings: give one for each point");
  Path path = *this;
  path.heading_ = std::move(heading);
  return path;
}

Path::Place Path::place(double arc_m) const {
  const double length = length_m();
  if (closed_) {
    arc_m = std::fmod(arc_m, length);
    if (arc_m < 0.0) arc_m += length;
  }
  arc_m = std::clamp(arc_m, 0.0, length);
  const auto upper = std::upper_bound(arc_m_.begin() + 1, arc_m_.end() - 1, arc_m);
  const auto i = static_cast<std::size_t>(upper - arc_m_.begin());
  const double step = arc_m_[i] - arc_m_[i - 1];
  const double t = step > 0.0 ? (arc_m - arc_m_[i - 1]) / step : 0.0;
  return {i - 1, t};
}

Vector2 Path::at(double arc_m) const {
  const Place on = place(arc_m);
  const Vector2& from_m = points_m_[on.point];
  return from_m + on.share * (points_m_[on.point + 1] - from_m);
}

std::optional<double> Path::heading_rad(double arc_m) const {
  const Place on = place(arc_m);
  // A path that ends in the same point twice ends in the direction of the way there.
  std::size_t from = on.point;
  while (from > 0 && points_m_[from + 1] == points_m_[from]) --from;
  return heading_.at(on.point, on.share, points_m_[from + 1] - points_m_[from]);
}

std::vector<Pose2> Path::poses(double step_m) const {
  std::vector<Pose2> drawn;
  if (heading_.rule() == HeadingRule::kNone) return drawn;
  const auto count = std::max<std::int64_t>(1, std::llround(length_m() / step_m));
  for (std::int64_t i = 0; i < count; ++i) {
    const double arc_m = length_m() * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const Vector2 point_m = at(arc_m);
    drawn.push_back({point_m.x(), point_m.y(), *heading_rad(arc_m)});
  }
  return drawn;
}

Path::Nearest Path::nearest(const Vector2& position_m) const {
  Nearest best{points_m_.front(), 0.0, std::numeric_limits<double>::infinity()};
  for (std::size_t i = 1; i < points_m_.size(); ++i) {
    const Vector2 along = points_m_[i] - points_m_[i - 1];
    const double square = along.squaredNorm();
    const double t =
        square > 0.0 ? std::clamp((position_m - points_m_[i - 1]).dot(along) / square, 0.0, 1.0) : 0.0;
    const Vector2 point = points_m_[i - 1] + t * along;
    const double distance = (position_m - point).norm();
    if (distance < best.distance_m) best = {point, arc_m_[i - 1] + t * std::sqrt(square), distance};
  }
  return best;
}

std::vector<Vector2> Path::corners_m(double min_turn_rad) const {
  std::vector<Vector2> vertices;  // without repetitions, the last one not the first again
  for (const Vector2& point : points_m_)
    if (vertices.empty() || point != vertices.back()) vertices.push_back(point);
  if (closed_) vertices.pop_back();
  const std::size_t count = vertices.size();
  std::vector<Vector2> corners;
  for (std::size_t i = 0; i < count; ++i) {
    const bool end = !closed_ && (i == 0 || i + 1 == count);
    const Vector2 in = vertices[i] - vertices[(i + count - 1) % count];
    const Vector2 out = vertices[(i + 1) % count] - vertices[i];
    const double turn_rad = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
    if (end || std::abs(turn_rad) >= min_turn_rad) corners.push_back(vertices[i]);
  }
  return corners;
}

}  // namespace lodestone::geometry
