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

double RouteMap::cost_m(const Link& link, double clearance_m, const geometry::KeepOut& keep_out) const {
  const double length_m = (centres_m_[link.second] - centres_m_[link.first]).norm();
  const double wanted = wanted_m(keep_out);
  if (clearance_m >= wanted) return length_m;
  const double lacking = (wanted - clearance_m) / (wanted - keep_out.margin_m);
  return length_m * (1.0 + config_.clearance_cost * lacking);
}

/// Of the open cells; with `unhindered` of those to which nothing is in the way.
std::optional<std::size_t> RouteMap::nearest(const geometry::Vector2& point_m, const std::vector<bool>& open,
                                             const geometry::KeepOut& keep_out, bool unhindered) const {
  std::optional<std::size_t> best;
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t cell = 0; cell < centres_m_.size(); ++cell) {
    const double distance_m = (centres_m_[cell] - point_m).norm();
    if (!open[cell] || !(distance_m < least_m)) continue;
    if (unhindered && !(keep_out.clearance_m(point_m, centres_m_[cell]) > keep_out.margin_m)) continue;
    best = cell;
    least_m = distance_m;
  }
  return best;
}

std::vector<geometry::Vector2> RouteMap::route(const geometry::Vector2& from_m, const geometry::Vector2& to_m,
                                               const geometry::KeepOut& keep_out) const {
  std::vector<bool> open;
  for (const Vector2& centre_m : centres_m_)
    open.push_back(keep_out.clearance_m(centre_m, centre_m) > keep_out.margin_m);
  const auto end = nearest(to_m, open, keep_out, true);
  auto start = nearest(from_m, open, keep_out, true);
  if (!start)
    start = nearest(from_m, open, keep_out, false);  // it lies too near to a zone, and must get away
  if (!start || !end || (centres_m_[*end] - to_m).norm() > std::sqrt(2.0) * region_.cell_m()) return {};
  CellGraph graph(centres_m_.size());
  for (const Link& link : links_) {
    if (!open[link.first] || !open[link.second]) continue;
    const double clearance_m = keep_out.clearance_m(centres_m_[link.first], centres_m_[link.second]);
    if (clearance_m > keep_out.margin_m)
      boost::add_edge(link.first, link.second, LinkCost(cost_m(link, clearance_m, keep_out)), graph);
  }
  const std::vector<CellVertex> way = cheapest(graph, centres_m_, *start, *end);
  if (way.empty()) return {};
  std::vector<Vector2> points = {from_m};
  for (const CellVertex cell : way) points.push_back(centres_m_[cell]);
  points.push_back(to_m);
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
