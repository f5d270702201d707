#include "lodestone/session/coil_wiring.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodestone/physics/per_coil.h"
#include "lodestone/safety/check.h"

namespace lodestone::session {

namespace {

constexpr const char* kNames[physics::kFourCoils] = {"+x", "-x", "+y", "-y"};
constexpr double kDegree = 3.14159265358979323846 / 180.0;

// What a camera tells apart from noise, and what is too far off for the field of a coil. Wide, because the
// needle sticks before it has quite turned and the description of the rig is not exact.
constexpr double kTurned_rad = 6.0 * kDegree;
constexpr double kShifted_m = 0.7e-3;
constexpr double kMisaligned_rad = 40.0 * kDegree;
constexpr double kOpposed_rad = 150.0 * kDegree;
constexpr double kPulledAcross_rad = 90.0 * kDegree;
// A needle that turns far shifts by its uneven friction as well as by the pull.
constexpr double kTooFarTurned_rad = 30.0 * kDegree;
// An end of the needle that is nearer to the wall is held by it.
constexpr double kWallGap_m = 1e-3;
// What a camera that is not quite calibrated may see beyond the wall; further out is no needle.
constexpr double kSeenOutside_m = 3e-3;

constexpr double kContradiction = 4.0;
constexpr double kDoubt = 0.2;
/// Two contradictions rule a wiring out, one does not.
constexpr double kRuledOut = 1.75 * kContradiction;

double angle_between(const geometry::Vector2& a, const geometry::Vector2& b) {
  return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}

geometry::Vector2 along(const geometry::Pose2& pose) {
  return {std::cos(pose.heading_rad), std::sin(pose.heading_rad)};
}

/// Mean field over the two poles of the needle: what turns it.
geometry::Vector2 turning_field_T(const physics::CoilArray& coils, const physics::PerCoil& current_A,
                                  const physics::NeedleConfig& needle, const geometry::Pose2& pose) {
  const geometry::Vector2 pole_m = 0.5 * needle.chain_m * along(pose);
  return 0.5 * (coils.field_T(current_A, pose.position_m() + pole_m) +
                coils.field_T(current_A, pose.position_m() - pole_m));
}

/// A needle in a field turns into it; one that points straight against it may stay.
double heading_against(double off_before_rad, double off_after_rad) {
  if (off_before_rad > kOpposed_rad && off_after_rad > kOpposed_rad) return kDoubt;
  const double graded = kContradiction * std::pow(off_after_rad / kMisaligned_rad, 2);
  const bool underway = off_after_rad < off_before_rad - kTurned_rad;
  return std::min(graded, underway ? kDoubt : kContradiction);
}

double shift_against(double off_pull_rad) {
  return std::min(kContradiction, kContradiction * std::pow(off_pull_rad / kPulledAcross_rad, 4));
}

}  // namespace

std::vector<CoilWiring> every_coil_wiring() {
  std::vector<CoilWiring> all;
  CoilWiring wiring;
  do {
    for (int signs = 0; signs < 1 << physics::kFourCoils; ++signs) {
      for (int i = 0; i < physics::kFourCoils; ++i)
        wiring.sign[static_cast<std::size_t>(i)] = (signs >> i & 1) != 0 ? -1 : 1;
      all.push_back(wiring);
    }
  } while (std::next_permutation(wiring.coil.begin(), wiring.coil.end()));
  return all;
}

WiringInference::WiringInference(const physics::RigDescription& rig,
                                 std::shared_ptr<const physics::FieldTable> table)
    : coils_(std::move(table)), needle_(rig.needle), dish_radius_m_(rig.dish.radius_m) {}

std::shared_ptr<const physics::FieldTable> WiringInference::field_for(const physics::RigDescription& rig) {
  return physics::make_field_table(rig.coils.geometry, rig.dish.radius_m, kSeenOutside_m);
}

bool WiringInference::within(const geometry::Pose2& pose, double radius_m) const {
  const geometry::Vector2 half_m = 0.5 * needle_.length_m * along(pose);
  return std::max((pose.position_m() + half_m).norm(), (pose.position_m() - half_m).norm()) < radius_m;
}

bool WiringInference::add(const ProbePulse& pulse) {
  const double seen_m = dish_radius_m_ + kSeenOutside_m;
  if (!within(pulse.before, seen_m) || !within(pulse.after, seen_m)) return false;
  const geometry::Vector2 shift_m = pulse.after.position_m() - pulse.before.position_m();
  const double turn_rad = std::abs(geometry::wrap_angle(pulse.after.heading_rad - pulse.before.heading_rad));
  const bool shifted = shift_m.norm() > kShifted_m;
  if (!shifted && turn_rad < kTurned_rad) return false;
  const auto asked = static_cast<std::size_t>(pulse.asked);
  ++moved_[asked];
  const double free_m = dish_radius_m_ - kWallGap_m;
  const bool ends_free = within(pulse.after, free_m);
  const bool pulled = shifted && turn_rad < kTooFarTurned_rad && (ends_free || within(pulse.before, free_m));
  const geometry::Vector2 middle_m = 0.5 * (pulse.before.position_m() + pulse.after.position_m());
  for (std::size_t coil = 0; coil < against_.size(); ++coil) {
    for (std::size_t reversed = 0; reversed < 2; ++reversed) {
      physics::PerCoil current_A{};
      current_A[coil] = reversed == 0 ? pulse.current_A : -pulse.current_A;
      const auto off_field_rad = [&](const geometry::Pose2& pose) {
        return angle_between(along(pose), turning_field_T(coils_, current_A, needle_, pose));
      };
      double& sum = against_[asked][coil][reversed];
      if (ends_free) sum += heading_against(off_field_rad(pulse.before), off_field_rad(pulse.after));
      if (!pulled) continue;
      const physics::Wrench load =
          physics::magnetic_wrench(needle_, middle_m, along(pulse.after), coils_, current_A);
      sum += shift_against(angle_between(shift_m, {load.force_x_N, load.force_y_N}));
    }
  }
  return true;
}

double WiringInference::against(const CoilWiring& wiring) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < against_.size(); ++i)
    sum += against_[i][static_cast<std::size_t>(wiring.coil[i])][wiring.sign[i] > 0 ? 0 : 1];
  return sum;
}

double WiringInference::least_against() const {
  const std::vector<CoilWiring> all = every_coil_wiring();
  double least = against(all.front());
  for (const CoilWiring& wiring : all) least = std::min(least, against(wiring));
  return least;
}

std::vector<CoilWiring> WiringInference::possible() const {
  const double least = least_against();
  std::vector<CoilWiring> left;
  for (const CoilWiring& wiring : every_coil_wiring())
    if (against(wiring) < least + kRuledOut) left.push_back(wiring);
  return left;
}

bool WiringInference::explained() const {
  int moved = 0;
  for (const int count : moved_) moved += count;
  return least_against() <= 0.25 * kContradiction * moved;
}

namespace {

/// Coil that `asked` is known to drive, or -1.
int known_coil(const std::vector<CoilWiring>& possible, std::size_t asked) {
  for (const CoilWiring& wiring : possible)
    if (wiring.coil[asked] != possible.front().coil[asked] ||
        wiring.sign[asked] != possible.front().sign[asked])
      return -1;
  return possible.front().coil[asked];
}

/// How far outwards the coil that answers draws the needle, -1 to 1; 0 where it is not known.
double outwards(const std::vector<CoilWiring>& possible, int asked, const geometry::Vector2& position_m) {
  const int coil = known_coil(possible, static_cast<std::size_t>(asked));
  return coil < 0 ? 0.0 : physics::coil_direction(coil).dot(position_m) / std::max(1e-6, position_m.norm());
}

/// Whom to ask next.
class ProbeOrder {
 public:
  struct Next {
    int asked;
    bool strongly;  ///< to move the needle elsewhere, rather than a little
  };
  /// Each coil that is not known has two pulses: the first one turns the needle, the second one draws it.
  /// Where a known coil draws the needle back from the wall, it does so first; where nothing has been ruled
  /// out for long, every coil has its turn, with many strong pulses.
  Next next(const std::vector<CoilWiring>& possible, const geometry::Vector2& position_m, double far_m) {
    constexpr int kFew = 2;
    constexpr int kMany = 6;
    constexpr int kLong = 6;  // pulses without news
    since_news_ = possible.size() < left_ ? 0 : since_news_ + 1;
    left_ = possible.size();
    const bool anybody = since_news_ > kLong;
    if (to_go_ == 0) {
      const bool far = position_m.norm() > far_m;
      for (int back = 0; far && back_ < kMany && back < physics::kFourCoils; ++back) {
        if (outwards(possible, back, position_m) > -0.6) continue;
        ++back_;
        return {back, true};
      }
      back_ = 0;
      const auto of_use = [&] {
        if (known_coil(possible, static_cast<std::size_t>(asked())) < 0) return true;
        return anybody && !(far && outwards(possible, asked(), position_m) > 0.6);
      };
      do turn_ = (turn_ + 1) % physics::kFourCoils;
      while (!of_use());
      to_go_ = anybody ? kMany + ++rounds_ % 3 : kFew;  // never twice the same tour
    }
    --to_go_;
    return {asked(), anybody};
  }

 private:
  int asked() const {
    // +x, +y, -x, -y: each field lies across the one before, where nothing is swapped.
    constexpr std::array<int, physics::kFourCoils> kTurn = {0, 2, 1, 3};
    return kTurn[static_cast<std::size_t>(turn_)];
  }
  int turn_ = -1;
  int to_go_ = 0;
  int back_ = 0;
  int rounds_ = 0;
  int since_news_ = 0;
  std::size_t left_ = 0;
};

}  // namespace

void probe_wiring(WiringInference& inference, rig::Coils& coils, control::PoseSensor& sensor,
                  common::Clock& clock, const WiringProbe& probe) {
  constexpr int kStuckPulses = 2 * physics::kFourCoils;
  constexpr double kGrowth = 1.3;
  constexpr double kFar = 0.4;  // of the dish's radius
  ProbeOrder order;
  control::PoseEstimate seen = sensor.observe();
  double current_A = probe.current_A;
  int stuck = 0;
  for (int i = 0; i < probe.max_pulses; ++i) {
    const std::vector<CoilWiring> possible = inference.possible();
    if (possible.size() == 1) return;
    const auto [asked, strongly] =
        order.next(possible, seen.pose.position_m(), kFar * inference.dish_radius_m());
    const double asked_A = strongly ? probe.max_current_A : current_A;
    rig::CoilPulse pulse;
    pulse.current_A[static_cast<std::size_t>(asked)] = asked_A;
    pulse.duration_s = probe.pulse_s;
    coils.apply(pulse);
    clock.sleep_until(clock.now_s() + probe.pulse_s + probe.rest_s);
    sensor.expect_nothing();  // nobody knows yet where such a pulse takes the needle
    const control::PoseEstimate after = sensor.observe();
    const bool moved = seen.valid && after.valid && inference.add({asked, asked_A, seen.pose, after.pose});
    seen = after;
    stuck = moved ? 0 : stuck + 1;
    if (stuck < kStuckPulses) continue;
    // No coil has an effect: more current, and an end to it when there is no more.
    if (current_A >= probe.max_current_A) return;
    current_A = std::min(kGrowth * current_A, probe.max_current_A);
    stuck = 0;
  }
}

std::string possible_answers(const std::vector<CoilWiring>& possible, int asked) {
  const auto i = static_cast<std::size_t>(asked);
  std::string text;
  for (int coil = 0; coil < physics::kFourCoils; ++coil) {
    for (const int sign : {1, -1}) {
      if (std::none_of(possible.begin(), possible.end(), [&](const CoilWiring& wiring) {
            return wiring.coil[i] == coil && wiring.sign[i] == sign;
          }))
        continue;
      text +=
          (text.empty() ? "coil " : ", or coil ") + std::string(kNames[coil]) + (sign < 0 ? " reversed" : "");
    }
  }
  return text;
}

std::string wiring_remedy(const WiringInference& inference, const rig::RigConfig& rig) {
  const std::vector<CoilWiring> possible = inference.possible();
  if (!inference.explained())
    return "the needle's motion fits no wiring of four coils: is it the needle that the camera sees, and do "
           "coils, dish and calibration describe this bench?";
  if (possible.size() > 1)
    return "the needle's motion leaves " + std::to_string(possible.size()) +
           " wirings possible: place it 1 to 2 cm off the centre where it lies free, and try again, with "
           "more "
           "test_current_A where it sticks";
  if (possible.front() == CoilWiring{}) return "";
  const rig::RigConfig right = rewired(rig, possible.front());
  return "set rig.serial.output=" + common::Json(right.serial.output).dump() +
         " and rig.coils.polarity=" + common::Json(right.coils.polarity).dump() + ", or change the wires";
}

rig::RigConfig rewired(rig::RigConfig rig, const CoilWiring& found) {
  const std::vector<std::int64_t> output = rig.serial.output;
  const std::vector<std::int64_t> polarity = rig.coils.polarity;
  for (std::size_t asked = 0; asked < found.coil.size(); ++asked) {
    const auto coil = static_cast<std::size_t>(found.coil[asked]);
    rig.serial.output[coil] = output[asked];
    rig.coils.polarity[coil] = polarity[asked] * found.sign[asked];
  }
  return rig;
}

}  // namespace lodestone::session
