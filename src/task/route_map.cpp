#include "lodestone/task/route_map.h"

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/astar_search.hpp>
#include <boost/property_map/property_map.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace lodestone::task {
namespace {

using geometry::Vector2;

using LinkCost = boost::property<boost::edge_weight_t, double>;
using CellGraph =
    boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, boost::no_property, LinkCost>;
using CellVertex = boost::graph_traits<CellGraph>::vertex_descriptor;

// The first cell of a way is one of those around the needle: so many sides of a cell away.
constexpr double kSetOut = 1.5;

/// Thrown by the search once it is at its end: Boost.Graph knows no other way to stop it.
struct Arrived {};

class UntilArrived : public boost::default_astar_visitor {
 public:
  explicit UntilArrived(CellVertex end) : end_(end) {}
  template <class AnyGraph>
  void examine_vertex(CellVertex vertex, const AnyGraph&) const {
    if (vertex == end_) throw Arrived{};
  }

 private:
  CellVertex end_;
};

/// No way costs less than the straight one.
class StraightAway : public boost::astar_heuristic<CellGraph, double> {
 public:
  StraightAway(const std::vector<Vector2>& at_m, CellVertex end) : at_m_(&at_m), end_(end) {}
  double operator()(CellVertex vertex) const { return ((*at_m_)[vertex] - (*at_m_)[end_]).norm(); }

 private:
  const std::vector<Vector2>* at_m_;
  CellVertex end_;
};

/// The vertices from start to end; empty where none lead there.
std::vector<CellVertex> cheapest(const CellGraph& graph, const std::vector<Vector2>& at_m, CellVertex start,
                                 CellVertex end) {
  std::vector<CellVertex> before(boost::num_vertices(graph));
  std::vector<double> cost(boost::num_vertices(graph));
  const auto places = boost::get(boost::vertex_index, graph);
  try {
    boost::astar_search(graph, start, StraightAway(at_m, end),
                        boost::predecessor_map(boost::make_iterator_property_map(before.begin(), places))
                            .distance_map(boost::make_iterator_property_map(cost.begin(), places))
                            .visitor(UntilArrived(end)));
    return {};
  } catch (const Arrived&) {
  }
  std::vector<CellVertex> way = {end};
  while (way.back() != start) way.push_back(before[way.back()]);
  std::reverse(way.begin(), way.end());
  return way;
}

}  // namespace

RouteMap::RouteMap(Region region, const std::vector<Move>& moves, const RouteConfig& config)
    : region_(std::move(region)), config_(config), centres_m_(region_.centres_m()) {
  if (moves.empty())
    link_neighbours();
  else
    link_recorded(moves);
}

void RouteMap::link_neighbours() {
  const double side_m = region_.cell_m();
  for (std::size_t from = 0; from < centres_m_.size(); ++from)
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y) {
        const auto to = region_.find(centres_m_[from] + Vector2(x * side_m, y * side_m));
        if (to && *to != from) links_.emplace_back(from, *to);
      }
}

void RouteMap::link_recorded(const std::vector<Move>& moves) {
  std::map<Link, std::int64_t> seen;
  std::set<Region::Cell> dead;
  for (const Move& move : moves) {
    const auto from = region_.find(move.from_m);
    const auto to = region_.find(move.to_m);
    if (!from) dead.insert(region_.cell_of(move.from_m));
    if (!to) dead.insert(region_.cell_of(move.to_m));
    if (from && to && *from != *to) ++seen[{*from, *to}];
  }
  for (const auto& [link, times] : seen)
    if (times >= config_.least_moves) links_.push_back(link);
  for (const Region::Cell& cell : dead) dead_m_.push_back(region_.centre_m(cell));
}

double RouteMap::cost_m(double length_m, double clearance_m, const geometry::KeepOut& keep_out) const {
  const double wanted = wanted_m(keep_out);
  if (clearance_m >= wanted) return length_m;
  const double lacking = (wanted - clearance_m) / (wanted - keep_out.margin_m);
  return length_m * (1.0 + config_.clearance_cost * lacking);
}

std::optional<std::size_t> RouteMap::nearest(const geometry::Vector2& point_m, const Allowed& allowed) const {
  std::optional<std::size_t> best;
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t cell = 0; cell < centres_m_.size(); ++cell) {
    const double distance_m = (centres_m_[cell] - point_m).norm();
    if (!(distance_m < least_m) || !allowed(centres_m_[cell])) continue;
    best = cell;
    least_m = distance_m;
  }
  return best;
}

std::vector<geometry::Vector2> RouteMap::route(const geometry::Vector2& from_m, const geometry::Vector2& to_m,
                                               const geometry::KeepOut& keep_out) const {
  const auto end = nearest(to_m, [&](const Vector2& centre_m) {
    return keep_out.clearance_m(centre_m, to_m) > keep_out.margin_m;
  });
  if (!end || (centres_m_[*end] - to_m).norm() > std::sqrt(2.0) * region_.cell_m()) return {};
  std::vector<Vector2> at_m = centres_m_;
  const CellVertex start = at_m.size();
  at_m.push_back(from_m);
  CellGraph graph(at_m.size());
  const auto link = [&](CellVertex from, CellVertex to) {
    const double clearance_m = keep_out.clearance_m(at_m[from], at_m[to]);
    if (!(clearance_m > keep_out.margin_m)) return false;
    const double length_m = (at_m[to] - at_m[from]).norm();
    boost::add_edge(from, to, LinkCost(cost_m(length_m, clearance_m, keep_out)), graph);
    return true;
  };
  for (const Link& each : links_) link(each.first, each.second);
  bool gets_away = false;
  for (CellVertex cell = 0; cell < start; ++cell)
    if ((at_m[cell] - from_m).norm() <= kSetOut * region_.cell_m() && link(start, cell)) gets_away = true;
  if (!gets_away) {  // it lies too near to a zone, or off the map
    const auto out = nearest(from_m, [&](const Vector2& centre_m) {
      return keep_out.clearance_m(centre_m, centre_m) > keep_out.margin_m;
    });
    if (!out) return {};
    boost::add_edge(start, *out, LinkCost((at_m[*out] - from_m).norm()), graph);
  }
  std::vector<Vector2> points;
  for (const CellVertex vertex : cheapest(graph, at_m, start, *end)) points.push_back(at_m[vertex]);
  if (!points.empty()) points.push_back(to_m);
  return points;
}

bool RouteMap::straight(const geometry::Vector2& from_m, const geometry::Vector2& to_m,
                        const geometry::KeepOut& keep_out, double least_m) const {
  if (!(keep_out.clearance_m(from_m, to_m) >= least_m)) return false;
  const double steps = std::ceil((to_m - from_m).norm() / (0.5 * region_.cell_m()));
  for (double step = 1.0; step < steps; step += 1.0)
    if (!region_.contains(from_m + step / steps * (to_m - from_m))) return false;
  return true;
}

}  // namespace lodestone::task
