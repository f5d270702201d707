#include "lodestone/session/tracked_pose_sensor.h"

#include <cmath>

namespace lodestone::session {

control::PoseEstimate TrackedPoseSensor::look() {
  if (wait_) wait_();
  const vision::Sighting sighting = detector_.look();
  const vision::Track track = tracker_.see(sighting);
  if (track.search)
    detector_.search();
  else if (track.located && sighting.candidates.size() > 1)
    detector_.expect(track.pose.position_m());
  control::PoseEstimate estimate;
  estimate.stamp_s = sighting.stamp_s;
  estimate.valid = track.seen;
  estimate.reason = track.reason;
  estimate.pose = track.pose;
  estimate.position_sigma_m = std::sqrt(track.covariance(0, 0) + track.covariance(1, 1));
  estimate.heading_sigma_rad = std::sqrt(track.covariance(2, 2));
  estimate.innovation = tracker_.innovation();
  return estimate;
}

control::PoseEstimate TrackedPoseSensor::observe() {
  const double start_s = clock_.now_s();
  double before_s = start_s;
  control::PoseEstimate estimate = look();
  for (std::int64_t again = 1; again < config_.looks && !estimate.valid; ++again) {
    const double now_s = clock_.now_s();
    if (now_s + (now_s - before_s) > start_s + config_.looks_s) break;
    before_s = now_s;
    estimate = look();
  }
  return estimate;
}

void TrackedPoseSensor::forget() {
  tracker_.forget();
  detector_.reset();
}

}  // namespace lodestone::session
