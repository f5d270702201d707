#include "lodestone/session/tracked_pose_sensor.h"

#include <algorithm>
#include <cmath>

namespace lodestone::session {

control::PoseEstimate TrackedPoseSensor::look() {
  if (wait_) wait_();
  const vision::Sighting sighting = detector_.look();
  const vision::Track track = tracker_.see(sighting);
  searching_ = track.search || (searching_ && !track.located);
  if (track.search)
    detector_.search();
  else if (track.located && sighting.candidates.size() > 1)
    detector_.expect(track.pose.position_m());
  control::PoseEstimate estimate;
  estimate.stamp_s = sighting.stamp_s;
  estimate.valid = track.seen;
  estimate.reason = track.reason;
  estimate.pose = track.pose;
  estimate.either_way = track.either_way;
  estimate.position_covariance_m2 = track.covariance.topLeftCorner<2, 2>();
  estimate.position_sigma_m = std::sqrt(track.covariance(0, 0) + track.covariance(1, 1));
  estimate.heading_sigma_rad = std::sqrt(track.covariance(2, 2));
  estimate.innovation = tracker_.innovation();
  estimate.blind = sighting.camera != vision::CameraPlace::kKept;
  estimate.camera_moved = sighting.camera == vision::CameraPlace::kMoved;
  return estimate;
}

/// The first look of a step comes in the middle of an image, one right after it waits for a whole one; and
/// one of the whole dish takes longer.
control::PoseEstimate TrackedPoseSensor::timed_look() {
  constexpr double kForgotten = 0.98;  // a step
  const double start_s = clock_.now_s();
  const bool searched = searching_;
  const control::PoseEstimate estimate = look();
  double& longest_s = searched ? longest_search_s_ : longest_near_s_;
  longest_s = std::max(kForgotten * longest_s, clock_.now_s() - start_s);
  return estimate;
}

control::PoseEstimate TrackedPoseSensor::observe() {
  const bool hurry = !tracker_.places().empty();  // nothing moves a needle that has not been seen yet
  const double until_s = clock_.now_s() + config_.looks_s;
  control::PoseEstimate estimate = timed_look();
  for (std::int64_t again = 1; again < config_.looks && !estimate.valid; ++again) {
    if (hurry && clock_.now_s() + (searching_ ? longest_search_s_ : longest_near_s_) > until_s) break;
    estimate = timed_look();
  }
  return estimate;
}

void TrackedPoseSensor::acquire() {
  if (tracker_.places().empty()) observe();
}

void TrackedPoseSensor::forget() {
  tracker_.forget();
  detector_.reset();
  searching_ = true;
  longest_near_s_ = kNear_s;
  longest_search_s_ = kSearch_s;
}

}  // namespace lodestone::session
