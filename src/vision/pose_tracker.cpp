#include "lodestone/vision/pose_tracker.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "lodestone/geometry/angle.h"

namespace lodestone::vision {

namespace {

using geometry::Vector2;

constexpr std::size_t kMostPlaces = 4;
constexpr double kGate = 13.816;     // chi-square of 2 degrees of freedom, 99.9 %
constexpr double kFloor_m = 0.1e-3;  // RMS distance
constexpr double kFloor_rad = 0.15 * geometry::kRadPerDeg;
constexpr double kRest_m = 0.05e-3;  // what a needle that sticks may still settle by
// What the pull does, in units of the pull that breaks the needle loose: fitted to recorded steps of the
// explorer and of the planner on virtual rigs.
constexpr double kSticksBelow = 0.23;  // where half of all pulses move nothing,
constexpr double kSticksPower = 1.8;   // and how soon that changes
constexpr double kSlip_m = 3.3e-3;     // grows with the square of the pull,
constexpr double kOfSphere = 3.0;      // times as far: it rolls on after a pulse (computed)
constexpr double kSlipLinear = 1.2;    // and straight on from here
constexpr double kSpread_m = 0.5e-3;   // of a slip, and these shares of its length:
constexpr double kSpreadAlong = 0.5;
constexpr double kSpreadAcross = 0.25;
constexpr double kWild = 0.15;          // of all slips go anywhere:
constexpr double kWildSpread_m = 1e-3;  // so wide, and by its length
constexpr double kOtherwise = 0.002;    // of all pulses do what no learned simulator says
constexpr double kCutSticks = 0.5;      // of pulses cut short have moved nothing yet
constexpr double kReach = 0.95;         // of the dish's radius is as far as a middle comes
constexpr double kLearn = 0.1;          // weight of the last pulse in what is learned
constexpr double kLogGain = 0.3;        // standard deviation, before anything is learned
constexpr double kLogGainDrift = 0.02;
constexpr int kUnforeseen = 3;  // looks that agree are a needle outside the gate: somebody has moved it
constexpr int kSurprising = 2;  // and within it, but so far from where it was expected
constexpr double kSurprise_m = 3e-3;
constexpr double kFurthest_m =
    15e-3;                           // from every expected place that a slip may end, besides its own length
constexpr double kHardlyAny = 0.01;  // of all needles stick so often
constexpr double kAgree_m = 1e-3;
constexpr double kBeyondWall_m = 1e-3;

/// A spread, but no smaller than the floor.
Eigen::Matrix2d floored_m2(const Eigen::Matrix2d& covariance_m2) {
  const double missing_m2 = std::max(0.0, kFloor_m * kFloor_m - covariance_m2.trace());
  return covariance_m2 + 0.5 * missing_m2 * Eigen::Matrix2d::Identity();
}

Eigen::Matrix2d noise_m2(const Rod& rod) { return floored_m2(rod.covariance.topLeftCorner<2, 2>()); }

double sticking(double ratio) { return 1.0 / (1.0 + std::pow(ratio / kSticksBelow, kSticksPower)); }

double slip_m(double ratio, double unit_m) {
  return unit_m * (ratio < kSlipLinear ? ratio * ratio : kSlipLinear * (2.0 * ratio - kSlipLinear));
}

/// By the logarithm of the ratio.
double slip_slope_m(double ratio, double unit_m) {
  return unit_m * 2.0 * ratio * std::min(ratio, kSlipLinear);
}

double distance2(const Vector2& offset_m, const Eigen::Matrix2d& covariance_m2) {
  return offset_m.dot(covariance_m2.inverse() * offset_m);
}

double density(const Vector2& offset_m, const Eigen::Matrix2d& covariance_m2) {
  return std::exp(-0.5 * distance2(offset_m, covariance_m2)) /
         (2.0 * geometry::kPi * std::sqrt(covariance_m2.determinant()));
}

/// The Gaussian with the mean and the covariance of a mixture of two.
Place merged(const Place& a, const Place& b) {
  Place both;
  both.weight = a.weight + b.weight;
  both.mean_m = (a.weight * a.mean_m + b.weight * b.mean_m) / both.weight;
  const auto part = [&](const Place& place) {
    const Vector2 off_m = place.mean_m - both.mean_m;
    return Eigen::Matrix2d(place.weight / both.weight * (place.covariance_m2 + off_m * off_m.transpose()));
  };
  both.covariance_m2 = part(a) + part(b);
  return both;
}

/// The Gaussian with the mean and the covariance of them all.
Place all_of(const std::vector<Place>& places) {
  return std::accumulate(places.begin() + 1, places.end(), places.front(), merged);
}

/// What merging two costs: an upper bound of the discrimination lost (Runnalls, IEEE Trans. AES 43, 2007).
double cost(const Place& a, const Place& b) {
  const auto entropy = [](const Place& place) {
    return place.weight * std::log(place.covariance_m2.determinant());
  };
  return 0.5 * (entropy(merged(a, b)) - entropy(a) - entropy(b));
}

}  // namespace

PoseTracker::PoseTracker(const TrackerConfig& config, const physics::RigDescription& rig)
    : config_(config),
      rig_(rig),
      field_(rig),
      slip_unit_m_(rig.needle.is_sphere() ? kOfSphere * kSlip_m : kSlip_m) {
  forget();
}

void PoseTracker::forget() {
  lose();
  background_.forget();
}

void PoseTracker::lose() {
  heading_.reset();
  places_.clear();
  slip_.reset();
  pulses_.clear();
  before_pulse_.clear();
  log_gain_ = 0.0;
  log_gain_variance_ = kLogGain * kLogGain;
  scatter_ = 1.0;
  doubtful_.reset();
  agreeing_ = 0;
  innovation_.reset();
  on_trial_.reset();
}

PoseTracker::Slip PoseTracker::slip_from(const Vector2& from_m, const physics::PerCoil& current_A) const {
  const Vector2 pull_N = field_.pull_N(current_A, from_m);
  const double size_N = pull_N.norm();
  Slip slip;
  slip.from_m = from_m;
  if (size_N > 0.0) slip.along = pull_N / size_N;
  slip.ratio = std::exp(log_gain_) * size_N / rig_.breakaway_N();
  slip.to_m = from_m + slip_m(slip.ratio, slip_unit_m_) * slip.along;
  const double reach_m = kReach * rig_.dish.radius_m;
  if (slip.to_m.norm() > reach_m) slip.to_m *= reach_m / slip.to_m.norm();
  return slip;
}

Eigen::Matrix2d PoseTracker::spread_m2(const Slip& slip) const {
  const double length_m = slip_m(slip.ratio, slip_unit_m_);
  const double along_m2 = std::pow(kSpread_m + kSpreadAlong * length_m, 2) +
                          log_gain_variance_ * std::pow(slip_slope_m(slip.ratio, slip_unit_m_), 2);
  const double across_m2 = std::pow(kSpread_m + kSpreadAcross * length_m, 2);
  const Vector2 across(-slip.along.y(), slip.along.x());
  return scatter_ *
         (along_m2 * slip.along * slip.along.transpose() + across_m2 * across * across.transpose());
}

Eigen::Matrix2d PoseTracker::wild_spread_m2(const Slip& slip) const {
  return scatter_ * std::pow(kWildSpread_m + slip_m(slip.ratio, slip_unit_m_), 2) *
         Eigen::Matrix2d::Identity();
}

/// Field and friction: it stays, slips along the pull, or goes anywhere near.
std::vector<Place> PoseTracker::after_slip(const Place& place, const physics::PerCoil& current_A) const {
  const Slip slip = slip_from(place.mean_m, current_A);
  const double sticks = sticking(slip.ratio);
  const double slips = place.weight * (1.0 - sticks);
  return {{place.mean_m, place.covariance_m2 + kRest_m * kRest_m * Eigen::Matrix2d::Identity(),
           sticks * place.weight},
          {slip.to_m, place.covariance_m2 + spread_m2(slip), (1.0 - kWild) * slips},
          {slip.to_m, place.covariance_m2 + wild_spread_m2(slip), kWild * slips}};
}

/// What a learned simulator says, from the one place where it was seen; and a few go anywhere.
std::vector<Place> PoseTracker::after_outcomes(const std::vector<physics::PulseOutcome>& outcomes,
                                               const Slip& likeliest) const {
  const Place& from = places_.front();
  std::vector<Place> after;
  for (const physics::PulseOutcome& outcome : outcomes) {
    const Vector2 sigma_m(std::hypot(kRest_m, outcome.sigma_x_m), std::hypot(kRest_m, outcome.sigma_y_m));
    after.push_back({outcome.mean.position_m(),
                     from.covariance_m2 + Eigen::Matrix2d(sigma_m.cwiseAbs2().asDiagonal()),
                     (1.0 - kOtherwise) * outcome.weight});
  }
  after.push_back({all_of(after).mean_m, from.covariance_m2 + wild_spread_m2(likeliest), kOtherwise});
  return after;
}

void PoseTracker::pulse(const physics::PerCoil& current_A,
                        const std::vector<physics::PulseOutcome>& outcomes) {
  pulse_counted_ = current_A != physics::PerCoil{};
  if (pulse_counted_) background_.pulse();
  before_pulse_.clear();
  if (places_.empty()) return;
  const auto field_rad = field_.direction_rad(current_A, places_.front().mean_m);
  if (!field_rad) return;
  before_pulse_ = places_;
  const Slip likeliest = slip_from(places_.front().mean_m, current_A);
  pulses_.push_back({*field_rad, sticking(likeliest.ratio), (likeliest.to_m - likeliest.from_m).norm(),
                     pulses_.empty() ? outcomes : std::vector<physics::PulseOutcome>{}});
  if (outcomes.empty() || pulses_.size() > 1) {
    std::vector<Place> after;
    for (const Place& place : places_)
      for (const Place& next : after_slip(place, current_A)) after.push_back(next);
    places_ = after;
  } else {
    places_ = after_outcomes(outcomes, likeliest);
  }
  if (pulses_.size() == 1)
    slip_ = likeliest;
  else
    slip_.reset();  // what moved it how far is not known any more
  log_gain_variance_ += kLogGainDrift * kLogGainDrift;
  merge();
}

void PoseTracker::pulse_cut() {
  if (std::exchange(pulse_counted_, false)) background_.pulse_cut();
  if (before_pulse_.empty()) return;
  Pulse& cut = pulses_.back();
  cut.cut = true;
  cut.outcomes.clear();  // of whole pulses
  cut.sticks = std::max(cut.sticks, kCutSticks);
  slip_.reset();
  for (Place& place : places_) place.weight *= 1.0 - kCutSticks;
  for (const Place& place : before_pulse_)
    places_.push_back({place.mean_m, place.covariance_m2, kCutSticks * place.weight});
  before_pulse_.clear();
  merge();
}

void PoseTracker::merge() {
  while (places_.size() > kMostPlaces) {
    std::size_t first = 0, second = 1;
    double least = cost(places_[0], places_[1]);
    for (std::size_t i = 0; i < places_.size(); ++i)
      for (std::size_t j = i + 1; j < places_.size(); ++j)
        if (const double c = cost(places_[i], places_[j]); c < least) {
          least = c;
          first = i;
          second = j;
        }
    places_[first] = merged(places_[first], places_[second]);
    places_.erase(places_.begin() + static_cast<std::ptrdiff_t>(second));
  }
  std::stable_sort(places_.begin(), places_.end(),
                   [](const Place& a, const Place& b) { return a.weight > b.weight; });
}

bool PoseTracker::gated(const Rod& candidate) const {
  return std::any_of(places_.begin(), places_.end(), [&](const Place& place) {
    return distance2(candidate.pose.position_m() - place.mean_m, place.covariance_m2 + noise_m2(candidate)) <=
           kGate;
  });
}

double PoseTracker::likelihood(const Rod& candidate) const {
  double sum = 0.0;
  for (const Place& place : places_)
    sum += place.weight *
           density(candidate.pose.position_m() - place.mean_m, place.covariance_m2 + noise_m2(candidate));
  return sum;
}

/// What may be the needle: a pose may err.
std::vector<Rod> PoseTracker::in_the_dish(const std::vector<Rod>& candidates) const {
  std::vector<Rod> inside;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(inside), [&](const Rod& rod) {
    return rig_.fits(rod.pose, kBeyondWall_m + 3.0 * std::sqrt(noise_m2(rod).trace()));
  });
  if (rig_.needle.is_sphere())  // whoever sees it may say anything of a heading: it has none
    for (Rod& rod : inside) rod.pose.heading_rad = rod.covariance(2, 2) = 0.0;
  return inside;
}

bool PoseTracker::within(double distance_m, const Rod& candidate) const {
  return std::any_of(places_.begin(), places_.end(), [&](const Place& place) {
    return (candidate.pose.position_m() - place.mean_m).norm() <= distance_m;
  });
}

/// What no pulse has left where it was, and what lies where the needle is expected, which may stick.
std::vector<Rod> PoseTracker::foreground(const std::vector<Rod>& candidates) const {
  std::vector<Rod> moving;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(moving), [&](const Rod& rod) {
    return !background_.holds(rod) || (gated(rod) && within(kSurprise_m, rod));
  });
  return moving;
}

/// The candidate that the needle is, if one of those within the gate is far likelier than the others.
std::optional<std::size_t> PoseTracker::choose(const std::vector<Rod>& candidates) const {
  double sum = 0.0;
  double best = 0.0;
  std::optional<std::size_t> chosen;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!gated(candidates[i])) continue;
    const double here = likelihood(candidates[i]);
    sum += here;
    if (chosen && here <= best) continue;
    best = here;
    chosen = i;
  }
  return chosen && best >= config_.min_needle_probability * sum ? chosen : std::nullopt;
}

/// How many looks have to agree before it is believed to be there.
int PoseTracker::looks_needed(const Rod& candidate) const {
  if (places_.empty()) return kSurprising;
  if (!gated(candidate)) return kUnforeseen;
  return within(kSurprise_m, candidate) ? 1 : kSurprising;
}

/// Whether it may be something that has lain there all along: what is further away than the pulses since take
/// a needle and was not seen to stir.
bool PoseTracker::may_be_still(const Rod& candidate) const {
  if (places_.empty() || pulses_.empty() || gated(candidate)) return false;
  double reach_m = kFurthest_m;
  for (const Pulse& pulse : pulses_) reach_m += pulse.slip_m;
  return !within(reach_m, candidate) && !background_.has_stirred(candidate);
}

/// Whether so many looks in a row have shown it there.
bool PoseTracker::confirmed(const Rod& candidate) {
  const bool agrees =
      doubtful_ && (candidate.pose.position_m() - doubtful_->pose.position_m()).norm() <= kAgree_m;
  agreeing_ = agrees ? agreeing_ + 1 : 1;
  doubtful_ = candidate;
  return agreeing_ >= looks_needed(candidate);
}

/// Whether it is not the needle after all.
bool PoseTracker::gives_away(const Rod& seen) {
  if (!on_trial_) return false;
  if (!lies_alike(seen, *on_trial_)) {
    on_trial_.reset();
    return false;
  }
  for (const Pulse& pulse : pulses_)
    if (!pulse.cut) trial_ *= pulse.sticks;
  return trial_ < kHardlyAny;
}

void PoseTracker::start(const Rod& candidate) {
  lose();
  places_.push_back({candidate.pose.position_m(), noise_m2(candidate), 1.0});
}

Track PoseTracker::see(const Sighting& sighting) {
  innovation_.reset();
  before_pulse_.clear();
  pulse_counted_ = false;
  Track track;
  const std::vector<Rod> inside = in_the_dish(sighting.candidates);
  if (inside.empty()) {
    track.search = true;
    track.reason = sighting.reason.empty() ? "no needle in view" : sighting.reason;
    if (!sighting.candidates.empty())
      track.reason =
          "what is seen reaches through the wall of the dish: check rig.dish.radius_m, rig.needle.length_m "
          "and the calibration";
    return track;
  }
  background_.see(inside);
  const std::vector<Rod> candidates = foreground(inside);
  const std::optional<std::size_t> chosen = candidates.size() == 1 ? 0 : choose(candidates);
  if (!chosen) {
    track.search = true;
    track.reason = candidates.empty() ? "what is seen stays put while pulses turn the needle: it is none"
                                      : "more than one needle in view, or something like one";
    return track;
  }
  const Rod& needle = candidates[*chosen];
  const bool foreseen = !places_.empty() && gated(needle);
  const std::optional<Rod> before = doubtful_;
  if (!confirmed(needle)) {
    track.search = !places_.empty() && !foreseen;
    track.reason = places_.empty() ? "a needle is seen for the first time: one image is not believed"
                                   : "something is seen where the needle is not expected";
    return track;
  }
  if (may_be_still(needle)) {
    track.search = true;
    track.reason = "something is seen far from where the needle can be: it is believed when a pulse stirs it";
    return track;
  }
  if (gives_away(needle)) {
    lose();
    background_.add(needle);
    track.search = true;
    track.reason = "what was taken for the needle stays put: it is none";
    return track;
  }
  const bool unexpected = !places_.empty() && !foreseen;
  const bool repeated = agreeing_ > 1;
  if (!foreseen) start(needle);
  update(needle);
  background_.except(needle);
  if (unexpected) {
    on_trial_ = needle;
    trial_ = 1.0;
  }
  if (repeated && !rig_.needle.is_sphere())  // the tape of the look before counts, too
    heading_.see(before->pose.heading_rad, std::sqrt(before->covariance(2, 2)), before->tape_log_odds);
  track.located = true;
  track.pose = needle.pose;
  track.pose.x_m = places_.front().mean_m.x();
  track.pose.y_m = places_.front().mean_m.y();
  track.covariance = needle.covariance;
  track.covariance.topLeftCorner<2, 2>() = places_.front().covariance_m2;
  if (rig_.needle.is_sphere()) {
    track.seen = true;
    return track;
  }
  track.covariance(2, 2) = std::max(needle.covariance(2, 2), kFloor_rad * kFloor_rad);
  double head =
      heading_.see(needle.pose.heading_rad, std::sqrt(track.covariance(2, 2)), needle.tape_log_odds);
  if (head < 0.5) {
    track.pose.heading_rad = geometry::wrap_angle(needle.pose.heading_rad + geometry::kPi);
    head = 1.0 - head;
  }
  head_ = head;
  track.seen = head >= config_.min_head_probability;
  track.either_way = !track.seen;
  if (!track.seen) track.reason = "head and tail cannot be told apart";
  return track;
}

void PoseTracker::update(const Rod& seen) {
  const Vector2 now_m = seen.pose.position_m();
  const Eigen::Matrix2d noise = noise_m2(seen);
  if (!pulses_.empty()) {
    const Place all = all_of(places_);
    innovation_ = distance2(now_m - all.mean_m, all.covariance_m2 + noise);
    if (slip_) pulses_.front().sticks = learn(now_m, noise);
  }
  for (const Pulse& pulse : pulses_)
    if (pulse.outcomes.empty())
      heading_.pulse(pulse.field_rad, pulse.sticks);
    else
      heading_.pulse(pulse.outcomes, head_);
  std::vector<Place> after;
  for (const Place& place : places_) {
    const Eigen::Matrix2d spread = place.covariance_m2 + noise;
    const Eigen::Matrix2d gain = place.covariance_m2 * spread.inverse();
    const Vector2 off_m = now_m - place.mean_m;
    after.push_back({place.mean_m + gain * off_m, (Eigen::Matrix2d::Identity() - gain) * place.covariance_m2,
                     place.weight * density(off_m, spread) + 1e-300});
  }
  Place one = all_of(after);
  one.weight = 1.0;
  one.covariance_m2 = floored_m2(one.covariance_m2);
  places_ = {one};
  slip_.reset();
  pulses_.clear();
  doubtful_.reset();
  agreeing_ = 0;
}

/// How far the pulse has moved it, against what was expected: an extended Kalman filter of the logarithm of
/// the gain, and a running mean of the scatter. Returns the probability that it has not stirred.
double PoseTracker::learn(const Vector2& now_m, const Eigen::Matrix2d& noise) {
  const Slip& slip = *slip_;
  const Eigen::Matrix2d both_m2 = 2.0 * noise;  // of this look and the one before
  const double sticks = sticking(slip.ratio);
  const Vector2 off_m = now_m - slip.to_m;
  const Eigen::Matrix2d slip_m2 = spread_m2(slip) + both_m2;
  const double stuck = sticks * density(now_m - slip.from_m, both_m2);
  const double wild = (1.0 - sticks) * kWild * density(off_m, wild_spread_m2(slip) + both_m2);
  const double slipped = (1.0 - sticks) * (1.0 - kWild) * density(off_m, slip_m2);
  const double share = slipped / (stuck + wild + slipped + 1e-300);
  scatter_ *= std::exp(kLearn * share * (std::min(distance2(off_m, slip_m2), kGate) / 2.0 - 1.0));
  scatter_ = std::clamp(scatter_, 0.1, 10.0);
  const double slope_m = slip_slope_m(slip.ratio, slip_unit_m_);
  const double gain = log_gain_variance_ * slope_m / slip.along.dot(slip_m2 * slip.along);
  log_gain_ = std::clamp(log_gain_ + share * gain * slip.along.dot(off_m), -2.0, 2.0);
  log_gain_variance_ *= 1.0 - share * gain * slope_m;
  return stuck / (stuck + wild + slipped + 1e-300);
}

}  // namespace lodestone::vision
