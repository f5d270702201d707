#include "lodestone/session/coil_wiring.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodestone/physics/described_coil.h"
#include "lodestone/physics/needle.h"
#include "lodestone/physics/per_coil.h"

namespace lodestone::session {

namespace {

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

std::vector<int> crossing_order(const physics::RigDescription& rig) {
  constexpr double kSame = 1e-6;  // of a cosine
  std::vector<geometry::Vector2> fields;
  for (std::size_t coil = 0; coil < rig.coils.count(); ++coil) {
    const physics::DescribedCoil described(rig.coils.coil(coil), rig.coils.measured);
    const geometry::Vector2 field = described.in_plane_per_ampere({0.0, 0.0}).head<2>();
    fields.push_back(field.norm() > 0.0 ? geometry::Vector2(field.normalized()) : field);
  }
  std::vector<int> order = {0};
  while (order.size() < fields.size()) {
    const geometry::Vector2& last = fields[static_cast<std::size_t>(order.back())];
    int next = -1;
    double least = 2.0;
    for (int coil = 0; coil < static_cast<int>(fields.size()); ++coil) {
      if (std::find(order.begin(), order.end(), coil) != order.end()) continue;
      const double cosine = std::abs(last.dot(fields[static_cast<std::size_t>(coil)]));
      if (cosine > least - kSame) continue;
      least = cosine;
      next = coil;
    }
    order.push_back(next);
  }
  return order;
}

WiringInference::WiringInference(const physics::RigDescription& rig,
                                 std::shared_ptr<const physics::CoilFields> fields)
    : coils_(std::move(fields)),
      needle_(rig.needle),
      dish_radius_m_(rig.dish.radius_m),
      order_(crossing_order(rig)),
      evidence_(rig.coils.count()),
      moved_(rig.coils.count(), 0) {
  constexpr double kAbove_m = 1e-6;
  for (std::size_t coil = 0; coil < rig.coils.count(); ++coil) {
    const geometry::Vector2 to_m = rig.coils.coil(coil).middle_m().head<2>();
    directions_.push_back(to_m.norm() > kAbove_m ? geometry::Vector2(to_m.normalized())
                                                 : geometry::Vector2(geometry::Vector2::Zero()));
  }
}

std::shared_ptr<const physics::CoilFields> WiringInference::field_for(const physics::RigDescription& rig) {
  return physics::CoilFields::shared(rig.coils, rig.dish.radius_m, kSeenOutside_m);
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
  for (std::size_t coil = 0; coil < coils(); ++coil) {
    for (const bool reversed : {false, true}) {
      physics::PerCoil current_A{};
      current_A[coil] = reversed ? -pulse.current_A : pulse.current_A;
      const auto off_field_rad = [&](const geometry::Pose2& pose) {
        return angle_between(along(pose), turning_field_T(coils_, current_A, needle_, pose));
      };
      if (ends_free)
        evidence_.add(asked, coil, reversed,
                      heading_against(off_field_rad(pulse.before), off_field_rad(pulse.after)));
      if (!pulled) continue;
      const physics::Wrench load =
          physics::magnetic_wrench(needle_, middle_m, along(pulse.after), coils_, current_A);
      evidence_.add(asked, coil, reversed,
                    shift_against(angle_between(shift_m, {load.force_x_N, load.force_y_N})));
    }
  }
  return true;
}

PossibleWirings WiringInference::possible() const {
  // Of more coils there is more to be wrong about, and neighbours lie closer.
  return evidence_.possible(kRuledOut * std::max(1.0, static_cast<double>(coils()) / physics::kFourCoils));
}

bool WiringInference::explained() const {
  int moved = 0;
  for (const int count : moved_) moved += count;
  return evidence_.least() <= 0.25 * kContradiction * moved;
}

namespace {

/// Coil that `asked` is known to drive, or -1.
int known_coil(const PossibleWirings& possible, int asked) {
  const std::vector<CoilAnswer>& answers = possible.answers[static_cast<std::size_t>(asked)];
  return answers.size() == 1 ? answers.front().coil : -1;
}

/// Whom to ask next.
class ProbeOrder {
 public:
  explicit ProbeOrder(const WiringInference& inference) : inference_(inference) {}

  struct Next {
    int asked;
    bool strongly;  ///< to move the needle elsewhere, rather than a little
  };
  /// Each coil that is not known has two pulses: the first one turns the needle, the second one draws it.
  /// Where a known coil draws the needle back from the wall, it does so first; where nothing has been ruled
  /// out for long, every coil has its turn, with many strong pulses.
  Next next(const PossibleWirings& possible, const geometry::Vector2& position_m, double far_m) {
    constexpr int kFew = 2;
    constexpr int kMany = 6;
    const int too_many = 2 * (coils() - 1);  // pulses without news: a round of the others
    since_news_ = possible.open() < left_ ? 0 : since_news_ + 1;
    left_ = possible.open();
    const bool anybody = since_news_ > too_many;
    if (to_go_ == 0) {
      const bool far = position_m.norm() > far_m;
      for (int back = 0; far && back_ < kMany && back < coils(); ++back) {
        if (outwards(possible, back, position_m) > -0.6) continue;
        ++back_;
        return {back, true};
      }
      back_ = 0;
      const auto of_use = [&] {
        if (known_coil(possible, asked()) < 0) return true;
        return anybody && !(far && outwards(possible, asked(), position_m) > 0.6);
      };
      do turn_ = (turn_ + 1) % coils();
      while (!of_use());
      to_go_ = anybody ? kMany + ++rounds_ % 3 : kFew;  // never twice the same tour
    }
    --to_go_;
    return {asked(), anybody};
  }

 private:
  int coils() const { return static_cast<int>(inference_.coils()); }
  int asked() const { return inference_.order()[static_cast<std::size_t>(turn_)]; }
  /// How far outwards the coil that answers draws the needle, -1 to 1; 0 where it is not known.
  double outwards(const PossibleWirings& possible, int asked, const geometry::Vector2& position_m) const {
    const int coil = known_coil(possible, asked);
    return coil < 0 ? 0.0
                    : inference_.direction(static_cast<std::size_t>(coil)).dot(position_m) /
                          std::max(1e-6, position_m.norm());
  }

  const WiringInference& inference_;
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
  const int all = static_cast<int>(inference.coils());
  const int stuck_pulses = 2 * all;
  constexpr double kGrowth = 1.3;
  constexpr double kFar = 0.4;  // of the dish's radius
  ProbeOrder order(inference);
  control::PoseEstimate seen = sensor.observe();
  double current_A = probe.current_A;
  int stuck = 0;
  for (int i = 0; i < probe.max_pulses_each * all; ++i) {
    const PossibleWirings possible = inference.possible();
    if (possible.open() == 1) return;
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
    if (stuck < stuck_pulses) continue;
    // No coil has an effect: more current, and an end to it when there is no more.
    if (current_A >= probe.max_current_A) return;
    current_A = std::min(kGrowth * current_A, probe.max_current_A);
    stuck = 0;
  }
}

std::string possible_answers(const PossibleWirings& possible, int asked,
                             const physics::CoilsDescription& coils) {
  std::string text;
  for (const CoilAnswer& answer : possible.answers[static_cast<std::size_t>(asked)])
    text += (text.empty() ? "coil " : ", or coil ") + coils.name(static_cast<std::size_t>(answer.coil)) +
            (answer.sign < 0 ? " reversed" : "");
  return text;
}

std::string wiring_remedy(const WiringInference& inference, const rig::RigConfig& rig) {
  const std::vector<CoilWiring> possible = inference.possible().listed;
  if (!inference.explained())
    return "the needle's motion fits no wiring of these coils: is it the needle that the camera sees, and do "
           "coils, dish and calibration describe this bench?";
  if (possible.size() > 1)
    return "the needle's motion leaves " +
           std::string(possible.size() == PossibleWirings::kMostListed ? "at least " : "") +
           std::to_string(possible.size()) +
           " wirings possible: place it 1 to 2 cm off the centre where it lies free, and try again, with "
           "more "
           "test_current_A where it sticks";
  if (possible.front() == CoilWiring(inference.coils())) return "";
  const rig::RigConfig right = rewired(rig, possible.front());
  return "set rig.serial.output=" + common::Json(right.serial.output).dump() +
         " and rig.coils.polarity=" + common::Json(right.coils.polarity).dump() + ", or change the wires";
}

rig::RigConfig rewired(rig::RigConfig rig, const CoilWiring& found) {
  std::vector<std::int64_t> output;
  for (std::size_t coil = 0; coil < found.coil.size(); ++coil)
    output.push_back(static_cast<std::int64_t>(rig.serial.output_of(coil)) + 1);
  rig.serial.output = output;
  const std::vector<std::int64_t> polarity = rig.coils.polarity;
  for (std::size_t asked = 0; asked < found.coil.size(); ++asked) {
    const auto coil = static_cast<std::size_t>(found.coil[asked]);
    rig.serial.output[coil] = output[asked];
    rig.coils.polarity[coil] = polarity[asked] * found.sign[asked];
  }
  return rig;
}

}  // namespace lodestone::session
