#pragma once

#include <optional>
#include <string>

namespace lodestone::console {

/// Who sees to it that the needle does no harm while the coils are driven.
enum class Driving {
  kNobody,      ///< no run
  kAttended,    ///< a controller, before the eyes of an operator
  kUnattended,  ///< a controller, with the supervisor alone in charge
  kByHand,      ///< the operator, for as long as a key or stick is held
};

/// The dead man's switch: what is heard of the operator's page, and when that no longer is enough for what is
/// driven. Times are of any clock that does not stop.
class Attendance {
 public:
  /// So long an operator may be silent: three beats.
  static constexpr double kSilence_s = 0.3;

  void begin(Driving driving) { driving_ = driving; }
  void end() { driving_ = Driving::kNobody; }
  Driving driving() const { return driving_; }

  /// The page's heartbeat.
  void beat(double now_s, bool visible, bool focused);
  /// The operator holds a drive.
  void held(double now_s) { held_s_ = now_s; }
  /// Another page attends from now on.
  void handed_over(double now_s);

  /// Why what is driven has to end now; nothing while it is attended as it should be.
  std::optional<std::string> lapse(double now_s) const;

 private:
  Driving driving_ = Driving::kNobody;
  double beat_s_ = -1e9;
  double held_s_ = -1e9;
  bool visible_ = false;
  bool focused_ = false;
};

}  // namespace lodestone::console
