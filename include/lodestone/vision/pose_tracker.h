#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/vision/background.h"
#include "lodestone/vision/commanded_field.h"
#include "lodestone/vision/heading_filter.h"
#include "lodestone/vision/sighting.h"

namespace lodestone::vision {

/// When what images show is believed.
struct TrackerConfig {
  double min_head_probability = 0.99;
  double min_needle_probability = 0.99;
  std::int64_t looks = 3;
  double looks_s = 0.1;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("min_head_probability", min_head_probability, "",
            "that head and tail are told apart rightly, by the tape and by the fields since the head was "
            "last seen, below which there is no pose",
            {0.5, 0.999});
    v.field("min_needle_probability", min_needle_probability, "",
            "where several things look like the needle, that one of them is it, by where it can have come, "
            "below which there is no pose",
            {0.5, 0.999});
    v.field("looks", looks, "", "images that are taken of one step where the first leaves a doubt", {1, 10});
    v.field("looks_s", looks_s, "s",
            "but none that would come later than this, if it takes as long as looks do: pulses shall come "
            "evenly",
            {0.0, 10.0});
  }
};

/// One of the places where the needle may be.
struct Place {
  geometry::Vector2 mean_m = geometry::Vector2::Zero();
  Eigen::Matrix2d covariance_m2 = Eigen::Matrix2d::Zero();
  double weight = 1.0;
};

/// What is believed after a look.
struct Track {
  bool located = false;  ///< in this look, for sure, if not which end is the head
  bool seen = false;     ///< that, too
  bool search = false;   ///< the next look should be of the whole dish
  std::string reason;    ///< why not
  geometry::Pose2 pose;
  /// The needle may as well lie the other way round: located, but which end is the head is not told.
  bool either_way = false;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of x_m, y_m, heading_rad
};

/// Follows the needle from look to look: where it can have come says which of several candidates it is,
/// whether something else was seen, and, with the tape, which end is the head.
///
/// Its place is a mixture of at most four Gaussians. After a pulse it lies where it lay (stick), somewhere
/// along the pull (slip), or anywhere near. How strong the pull really is and how widely slips scatter is
/// learned on the way, and forgotten with the track. Its heading is a
/// histogram (HeadingFilter), as a turn that may end anywhere on an arc is no Gaussian. Errors of a picture
/// repeat while the needle lies still, so that certainty has a floor. What is seen outside the gate
/// (chi-square, 99.9 %) is not believed until three looks in a row agree that the needle is there: somebody
/// has moved it. Two have to agree on a needle that is new, or further from every expected place than 3 mm.
/// What pulses leave where it was is background (Background), and never the needle but where that is
/// expected; and what is seen so far away after a pulse that no slip explains it is the needle once a pulse
/// has stirred it. What was taken for it elsewhere than expected is given up when it stays put through pulses
/// that hardly any needle would.
class PoseTracker {
 public:
  PoseTracker(const TrackerConfig& config, const physics::RigDescription& rig);

  /// The needle may be anywhere.
  void forget();
  /// The coils were asked for a pulse, which takes the needle to one of these outcomes from the pose that was
  /// seen; as far as field and friction tell where nobody says.
  void pulse(const physics::PerCoil& current_A, const std::vector<physics::PulseOutcome>& outcomes = {});
  /// The coils went off before that pulse was over: it may have moved the needle, or not, and a needle that
  /// stays put is none the less one. Before the next look.
  void pulse_cut();
  Track see(const Sighting& sighting);

  /// Where it may be now, heaviest first; empty before it was seen.
  const std::vector<Place>& places() const { return places_; }
  /// Squared distance between the last place that was seen and the expected one, in units of the spread that
  /// was expected (normalised innovation, 2 degrees of freedom on average); nothing where none was expected.
  std::optional<double> innovation() const { return innovation_; }

 private:
  struct Slip {
    geometry::Vector2 from_m, to_m;
    geometry::Vector2 along = {1.0, 0.0};  ///< the pull,
    double ratio = 0.0;                    ///< and how strong it is against the one that breaks it loose
  };

  struct Pulse {
    double field_rad;
    double sticks;                                ///< probability that the needle has not stirred,
    double slip_m;                                ///< and how far it is expected to have come where it has
    std::vector<physics::PulseOutcome> outcomes;  ///< where a learned simulator knows better
    bool cut = false;                             ///< before it was over
  };

  std::vector<Rod> in_the_dish(const std::vector<Rod>& candidates) const;
  std::vector<Rod> foreground(const std::vector<Rod>& candidates) const;
  std::optional<std::size_t> choose(const std::vector<Rod>& candidates) const;
  double likelihood(const Rod& candidate) const;
  bool gated(const Rod& candidate) const;
  bool within(double distance_m, const Rod& candidate) const;
  bool may_be_still(const Rod& candidate) const;
  int looks_needed(const Rod& candidate) const;
  bool confirmed(const Rod& candidate);
  void lose();
  void start(const Rod& candidate);
  void update(const Rod& seen);
  bool gives_away(const Rod& seen);
  double learn(const geometry::Vector2& now_m, const Eigen::Matrix2d& noise_m2);
  void merge();
  std::vector<Place> after_slip(const Place& place, const physics::PerCoil& current_A) const;
  std::vector<Place> after_outcomes(const std::vector<physics::PulseOutcome>& outcomes,
                                    const Slip& likeliest) const;
  Slip slip_from(const geometry::Vector2& from_m, const physics::PerCoil& current_A) const;
  Eigen::Matrix2d spread_m2(const Slip& slip) const;
  Eigen::Matrix2d wild_spread_m2(const Slip& slip) const;

  TrackerConfig config_;
  physics::RigDescription rig_;
  CommandedField field_;
  double slip_unit_m_;  // of how far pulls take it
  HeadingFilter heading_;
  double head_ = 0.0;  // probability that it is where the last look said
  std::vector<Place> places_;
  std::optional<Slip> slip_;         // of the one pulse since the needle was seen
  std::vector<Pulse> pulses_;        // since it was seen
  bool pulse_counted_ = false;       // the last one made a field
  std::vector<Place> before_pulse_;  // where it may have been before the last one, if that made a field
  double log_gain_ = 0.0;            // of the pull,
  double log_gain_variance_ = 0.0;   // and how well it is known
  double scatter_ = 1.0;             // of the slip about what is expected, as a factor on its variance
  std::optional<Rod> doubtful_;      // what was seen last, believed or not,
  int agreeing_ = 0;                 // there by so many looks in a row
  Background background_;
  std::optional<Rod>
      on_trial_;        // what was believed to be the needle outside the gate, and has not moved yet;
  double trial_ = 1.0;  // and the probability that a needle would have stuck so often
  std::optional<double> innovation_;
};

}  // namespace lodestone::vision
