#include "lodestone/data/pulse_cutting.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::data {
namespace {

constexpr double kGapSpacings = 1.5;  // of the median distance of rows
constexpr double kGapPulses = 0.5;    // of a pulse
constexpr double kOnItsWay = 0.3;     // of a pulse: a change that has not arrived
constexpr double kShortShare = 0.25;  // of the driven time, to find the length of a pulse
constexpr double kShortestPeriod_s = 1e-3;
constexpr double kLongestPeriod_s = 60.0;
constexpr std::size_t kMostPulses = 1'000'000;

/// Rows `first` to `last` with one drive; it acts from the time of the first to that of the last. `settled`:
/// the row from which on the drive has arrived.
struct Stretch {
  std::size_t first = 0;
  std::size_t last = 0;
  std::size_t settled = 0;
  bool off = false;
  bool after_gap = false;
};

class Cutter {
 public:
  Cutter(const std::vector<LogSample>& samples, const CuttingRule& rule, const std::string& place)
      : samples_(samples), rule_(rule), place_(place) {}

  CutLog cut() {
    find_lengths();
    find_gaps();
    const std::vector<Stretch> all = stretches(cut_.longest_gap_s, kOnItsWay * longest_on_s());
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].after_gap) connected_ = false;
      if (all[i].off)
        cut_rest(all[i], std::max(rested_until_s_, time(all[i].first)));
      else if (rule_.on_s > 0.0)
        cut_step(all[i], i + 1 < all.size() && !all[i + 1].after_gap ? &all[i + 1] : nullptr);
      else
        cut_driven(all[i]);
    }
    std::sort(cut_.left_out.begin(), cut_.left_out.end(),
              [](const LeftOutSpan& a, const LeftOutSpan& b) { return a.from_s < b.from_s; });
    return std::move(cut_);
  }

 private:
  double time(std::size_t row) const { return samples_[row].time_s; }
  double seconds(const Stretch& stretch) const { return time(stretch.last) - time(stretch.first); }
  bool off(std::size_t row) const { return samples_[row].drive.isZero(0.0); }
  bool same(std::size_t a, std::size_t b) const {
    return off(a) == off(b) &&
           (samples_[a].drive - samples_[b].drive).cwiseAbs().maxCoeff() <= rule_.same_drive;
  }

  /// How long the current of a step is on.
  double longest_on_s() const { return rule_.on_s > 0.0 ? rule_.on_s : cut_.period_s; }

  /// Median distance of rows, and the length of a pulse where it is not given.
  void find_lengths() {
    if (samples_.size() < 2)
      throw common::DataError(place_ + ": holds no two rows: nothing has happened between them");
    std::vector<double> distances_s;
    for (std::size_t i = 1; i < samples_.size(); ++i) distances_s.push_back(time(i) - time(i - 1));
    cut_.spacing_s = common::median(distances_s);
    cut_.period_s = rule_.period_s;
    if (cut_.period_s <= 0.0) {
      const double widest_s = 2.0 * kGapSpacings * cut_.spacing_s;
      const double roughly_s = rule_.on_s > 0.0 ? rule_.on_s : typical(stretches(widest_s, 0.0), 0.5);
      const std::vector<Stretch> all = stretches(widest_s, kOnItsWay * roughly_s);
      cut_.period_s = rule_.on_s > 0.0 ? typical_repetition(all) : typical(all, kShortShare);
    }
    if (cut_.period_s >= kShortestPeriod_s && cut_.period_s <= kLongestPeriod_s) return;
    throw common::DataError(
        fmt::format("{}: rows are {:g} s apart and pulses last {:g} s, which must be within {:g} .. {:g} s: "
                    "correct the unit of "
                    "time",
                    place_, cut_.spacing_s, cut_.period_s, kShortestPeriod_s, kLongestPeriod_s));
  }

  /// The length below which this share of the driven time lies.
  double typical(const std::vector<Stretch>& all, double share) const {
    std::vector<double> lengths_s;
    double sum_s = 0.0;
    for (const Stretch& stretch : all) {
      if (stretch.off) continue;
      lengths_s.push_back(seconds(stretch));
      sum_s += lengths_s.back();
    }
    if (lengths_s.empty())
      throw common::DataError(place_ +
                              ": no row has a current: nothing can be learned from it (correct the unit of " +
                              "the currents, or current_noise_A)");
    std::sort(lengths_s.begin(), lengths_s.end());
    double below_s = 0.0;
    for (const double length_s : lengths_s)
      if ((below_s += length_s) >= share * sum_s) return length_s;
    return lengths_s.back();
  }

  /// The time from one stretch with current to the next, below which a quarter of them are.
  double typical_repetition(const std::vector<Stretch>& all) const {
    std::vector<double> times_s;
    const Stretch* before = nullptr;
    for (const Stretch& stretch : all) {
      if (stretch.after_gap) before = nullptr;
      if (stretch.off) continue;
      if (before != nullptr) times_s.push_back(time(stretch.first) - time(before->first));
      before = &stretch;
    }
    if (times_s.empty())
      throw common::DataError(place_ + ": no two pulses follow one another: give control_period_s");
    return common::percentile(std::move(times_s), kShortShare);
  }

  void find_gaps() {
    cut_.longest_gap_s = rule_.longest_gap_s;
    if (cut_.longest_gap_s <= 0.0)
      cut_.longest_gap_s =
          std::min(kLongestPeriod_s, std::max(kGapSpacings * cut_.spacing_s, kGapPulses * cut_.period_s));
    for (std::size_t i = 1; i < samples_.size(); ++i)
      if (time(i) - time(i - 1) > cut_.longest_gap_s) leave_out(LeftOut::kGap, time(i - 1), time(i), i - 1);
  }

  /// Rows with the same drive, one after the other; those shorter than `shortest_s` belong to the next.
  std::vector<Stretch> stretches(double longest_gap_s, double shortest_s) const {
    std::vector<Stretch> all;
    bool after_gap = true;
    for (std::size_t i = 0; i + 1 < samples_.size(); ++i) {
      if (time(i + 1) - time(i) > longest_gap_s) {
        after_gap = true;
        continue;
      }
      if (after_gap || !same(all.back().settled, i)) {
        const bool on_its_way = !after_gap && seconds(all.back()) < shortest_s;
        if (on_its_way)
          all.back().settled = i;
        else
          all.push_back({i, i, i, false, after_gap});
        all.back().off = off(i);
      }
      all.back().last = i + 1;
      after_gap = false;
    }
    return all;
  }

  void cut_driven(const Stretch& stretch) {
    const double period_s = cut_.period_s;
    const double margin_s = rule_.tolerance * period_s;
    const double end_s = time(stretch.last);
    double from_s = time(stretch.first);
    if (end_s - from_s < period_s - margin_s) {
      leave_out(LeftOut::kOtherLength, from_s, end_s, stretch.first);
      return;
    }
    while (end_s - from_s >= period_s - margin_s) {
      const double to_s = next_cut(stretch, from_s);
      put(from_s, to_s, mean_drive(stretch, from_s, to_s));
      from_s = to_s;
    }
    if (from_s < end_s) leave_out(LeftOut::kRemainder, from_s, end_s, row_before(from_s));
  }

  /// A current that is on for a while, and off until the step is over.
  void cut_step(const Stretch& on, const Stretch* off) {
    const double from_s = time(on.first);
    const double margin_s = rule_.tolerance * cut_.period_s;
    const bool long_enough =
        off != nullptr && off->off && time(off->last) >= from_s + cut_.period_s - margin_s;
    if (std::abs(seconds(on) - rule_.on_s) > rule_.tolerance * rule_.on_s || !long_enough) {
      leave_out(LeftOut::kOtherLength, from_s, time(on.last), on.first);
      return;
    }
    rested_until_s_ = next_cut(*off, from_s);
    put(from_s, rested_until_s_, mean_drive(on, from_s, time(on.last)));
  }

  void cut_rest(const Stretch& stretch, double from_s) {
    const double end_s = time(stretch.last);
    if (from_s >= end_s) return;
    while (end_s - from_s >= (2.0 - rule_.tolerance) * cut_.period_s) {
      const double to_s = next_cut(stretch, from_s);
      put(from_s, to_s, geometry::Vector2::Zero());
      from_s = to_s;
    }
    put(from_s, end_s, geometry::Vector2::Zero());
  }

  /// One pulse later: the end of the stretch or a row where they are near, else just there.
  double next_cut(const Stretch& stretch, double from_s) const {
    const double wanted_s = from_s + cut_.period_s;
    const double margin_s = rule_.tolerance * cut_.period_s;
    const double end_s = time(stretch.last);
    if (std::abs(end_s - wanted_s) <= margin_s || wanted_s > end_s) return end_s;
    const std::size_t row = row_before(wanted_s);
    const double below_s = time(row);
    const double above_s = time(std::min(row + 1, stretch.last));
    const double near_s = wanted_s - below_s <= above_s - wanted_s ? below_s : above_s;
    return std::abs(near_s - wanted_s) <= margin_s && near_s > from_s ? near_s : wanted_s;
  }

  std::size_t row_before(double time_s) const {
    const auto after = std::upper_bound(samples_.begin(), samples_.end(), time_s,
                                        [](double t, const LogSample& s) { return t < s.time_s; });
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - samples_.begin() - 1));
  }

  /// Over the part of a pulse in which the drive has arrived.
  geometry::Vector2 mean_drive(const Stretch& stretch, double from_s, double to_s) const {
    geometry::Vector2 sum = geometry::Vector2::Zero();
    double sum_s = 0.0;
    for (std::size_t i = std::max(stretch.settled, row_before(from_s)); i < stretch.last && time(i) < to_s;
         ++i) {
      const double part_s = std::min(to_s, time(i + 1)) - std::max(from_s, time(i));
      sum += part_s * samples_[i].drive;
      sum_s += part_s;
    }
    return sum_s > 0.0 ? geometry::Vector2(sum / sum_s) : samples_[stretch.settled].drive;
  }

  /// At a row, or interpolated between two.
  std::pair<geometry::Pose2, std::int64_t> pose_at(double time_s) {
    const std::size_t row = row_before(time_s);
    const LogSample& before = samples_[row];
    if (before.time_s == time_s || row + 1 == samples_.size()) return {before.pose, before.line};
    const LogSample& after = samples_[row + 1];
    const double part = (time_s - before.time_s) / (after.time_s - before.time_s);
    const geometry::Vector2 position_m =
        before.pose.position_m() + part * (after.pose.position_m() - before.pose.position_m());
    const double turn_rad = geometry::wrap_angle(after.pose.heading_rad - before.pose.heading_rad);
    ++cut_.interpolated;
    return {{position_m.x(), position_m.y(), geometry::wrap_angle(before.pose.heading_rad + part * turn_rad)},
            part < 0.5 ? before.line : after.line};
  }

  void put(double from_s, double to_s, const geometry::Vector2& drive) {
    if (cut_.pulses.size() == kMostPulses)
      throw common::DataError(fmt::format("{}: makes more than {} pulses of {:g} s: correct control_period_s",
                                          place_, kMostPulses, cut_.period_s));
    CutPulse pulse;
    pulse.from_s = from_s;
    pulse.to_s = to_s;
    pulse.drive = drive;
    pulse.follows = connected_;
    if (connected_) {
      pulse.before = cut_.pulses.back().after;
      pulse.line_before = cut_.pulses.back().line_after;
    } else {
      std::tie(pulse.before, pulse.line_before) = pose_at(from_s);
    }
    std::tie(pulse.after, pulse.line_after) = pose_at(to_s);
    cut_.pulses.push_back(pulse);
    connected_ = true;
  }

  void leave_out(LeftOut why, double from_s, double to_s, std::size_t row) {
    cut_.left_out.push_back({why, from_s, to_s, samples_[row].line});
    connected_ = false;
  }

  const std::vector<LogSample>& samples_;
  const CuttingRule& rule_;
  const std::string& place_;
  CutLog cut_;
  bool connected_ = false;
  double rested_until_s_ = -std::numeric_limits<double>::infinity();  // of the last step with a rest in it
};

}  // namespace

CutLog cut_pulses(const std::vector<LogSample>& samples, const CuttingRule& rule, const std::string& place) {
  return Cutter(samples, rule, place).cut();
}

}  // namespace lodestone::data
