#include "lodestone/session/camera_detector.h"

#include <catch2/catch.hpp>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "control/fakes.h"
#include "lodestone/common/error.h"
#include "lodestone/control/control_loop.h"
#include "lodestone/safety/supervisor.h"
#include "lodestone/session/sensing.h"
#include "lodestone/session/tracked_pose_sensor.h"
#include "paper_scenes.h"
#include "session/pose_sensor_conformance.h"

using namespace lodestone;

namespace {

const std::string kSegmenter = std::string(LODESTONE_SOURCE_DIR) + "/models/segmenter";

std::shared_ptr<const vision::Segmenter> shipped_segmenter() {
  static const auto segmenter = vision::Segmenter::load(kSegmenter);
  return segmenter;
}

/// A camera whose images a test may spoil.
class SpoiledCamera final : public rig::Camera {
 public:
  explicit SpoiledCamera(rig::Camera& camera) : camera_(camera) {}
  imaging::Frame grab(double timeout_s) override {
    imaging::Frame frame = camera_.grab(timeout_s);
    if (++count_ > good) spoil(frame);
    return frame;
  }
  int good = 5;  // two of them before the run begins
  std::function<void(imaging::Frame&)> spoil = [](imaging::Frame&) {};

 private:
  rig::Camera& camera_;
  int count_ = 0;
};

/// A virtual rig with its own camera.
struct Bench {
  explicit Bench(std::uint64_t seed = 1)
      : rig(rig::VirtualRigConfig{}, seed),
        renderer(std::make_shared<const imaging::SceneRenderer>(imaging::draw_scene(scene(), seed))),
        camera(rig, renderer, common::RandomStream(seed, "noise")) {}

  static imaging::SceneConfig scene() {
    imaging::SceneConfig config = tests::paper_scenes();
    config.bench = rig::bench_of({});
    return config;
  }
  session::CameraDetector detector(rig::Camera& source) const {
    return {source, shipped_segmenter(), physics::RigDescription{}, scene().lens, {}};
  }

  rig::VirtualRig rig;
  std::shared_ptr<const imaging::SceneRenderer> renderer;
  rig::RenderedCamera camera;
};

}  // namespace

TEST_CASE("the camera sensor keeps the contract of a pose sensor") {
  Bench bench;
  session::CameraDetector detector = bench.detector(bench.camera);
  session::TrackedPoseSensor sensor(detector, {}, {}, bench.rig.clock());
  tests::check_pose_sensor(sensor, bench.rig.clock());
}

TEST_CASE("it calibrates itself and finds the needle wherever it is placed") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Bench bench(seed);
    session::CameraDetector detector = bench.detector(bench.camera);
    session::TrackedPoseSensor sensor(detector, {}, {}, bench.rig.clock());
    for (const geometry::Pose2& pose :
         {geometry::Pose2{0.02, -0.01, 2.5}, geometry::Pose2{-0.025, 0.005, -1.5},
          geometry::Pose2{0.0, 0.0, 0.0}}) {
      bench.rig.place(pose);
      sensor.forget();
      const control::PoseEstimate estimate = sensor.observe();
      REQUIRE(estimate.valid);
      CHECK((estimate.pose.position_m() - pose.position_m()).norm() < 0.8e-3);
      CHECK(std::abs(geometry::wrap_angle(estimate.pose.heading_rad - pose.heading_rad)) < 0.03);
      CHECK(estimate.position_sigma_m > 0.0);
      CHECK(estimate.position_sigma_m < 1e-3);
    }
  }
}

TEST_CASE("a spoiled image stops the coils, names the fault, and keeps what was recorded") {
  struct Fault {
    const char* name;
    std::function<void(imaging::Frame&)> spoil;
  };
  cv::Mat first;
  const std::vector<Fault> faults = {
      {"empty", [](imaging::Frame& frame) { frame.image.release(); }},
      {"320x240", [](imaging::Frame& frame) { frame.image = cv::Mat::zeros(240, 320, CV_8UC3); }},
      {"channel", [](imaging::Frame& frame) { frame.image = cv::Mat::zeros(1024, 1280, CV_8U); }},
      {"overexposed", [](imaging::Frame& frame) { frame.image.setTo(cv::Scalar::all(255)); }},
      {"frozen",
       [&first](imaging::Frame& frame) {
         if (first.empty()) first = frame.image;
         frame.image = first;
       }},
      {"does not answer", [](imaging::Frame&) { throw common::HardwareError("camera: does not answer"); }},
  };
  for (const Fault& fault : faults) {
    Bench bench;
    SpoiledCamera camera(bench.camera);
    camera.spoil = fault.spoil;
    session::CameraDetector detector = bench.detector(camera);
    session::TrackedPoseSensor sensor(detector, {}, {}, bench.rig.clock());
    tests::RecordingCoils recording;
    safety::Supervisor coils(recording, {}, tests::paper_rig(), bench.rig.clock());
    task::ActionConfig action = tests::paper_action();
    action.scale = 15.0;
    control::ControlLoop loop({}, action, coils, sensor, bench.rig.clock());
    tests::FunctionController controller(
        [](const task::Observation&) { return geometry::Vector2(0.5, 0.0); });
    control::PointReference reference({0.0, 0.0}, 60.0);
    const control::LoopOutcome outcome = loop.run(controller, reference);
    CAPTURE(fault.name, outcome.stop_reason);
    CHECK_FALSE(outcome.completed);
    CHECK_THAT(outcome.stop_reason, Catch::Contains(fault.name));
    CHECK_FALSE(recording.on);
    CHECK(recording.stops > 0);
    CHECK(outcome.steps.size() >= 3);
    CHECK(outcome.steps.size() <= 5);
  }
}

TEST_CASE("a camera that slips pauses the run, and one that is put back lets it go on") {
  Bench bench;
  bench.rig.place({0.01, 0.0, 0.0});
  SpoiledCamera camera(bench.camera);
  bool slipped = false;
  camera.spoil = [&slipped](imaging::Frame& frame) {
    if (!slipped) return;
    const cv::Mat image = frame.image.clone();  // 6 px are 0.6 mm
    const cv::Mat aside = (cv::Mat_<double>(2, 3) << 1, 0, 6, 0, 1, 0);
    cv::warpAffine(image, frame.image, aside, image.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  };
  session::CameraDetector detector = bench.detector(camera);
  session::TrackedPoseSensor sensor(detector, {}, {}, bench.rig.clock());
  tests::RecordingCoils recording;
  safety::Supervisor coils(recording, {}, tests::paper_rig(), bench.rig.clock());
  const physics::RigDescription rig = tests::paper_rig();  // which is looked for, too
  control::ControlLoop loop({}, tests::paper_action(), coils, sensor, bench.rig.clock(), &rig);
  tests::FunctionController controller([](const task::Observation&) { return geometry::Vector2(0.2, 0.0); });
  control::PointReference reference({0.0, 0.0}, 4.0);
  std::vector<control::StepRecord> steps;
  const control::LoopOutcome outcome = loop.run(controller, reference, [&](const control::StepRecord& step) {
    steps.push_back(step);
    slipped = steps.size() >= 4 && steps.size() < 8;
  });
  CAPTURE(outcome.stop_reason);
  CHECK(outcome.completed);
  REQUIRE(steps.size() > 10);
  CHECK(steps[2].estimate.valid);
  CHECK_FALSE(steps[2].current_A == physics::PerCoil{});
  for (std::size_t i = 5; i < 8; ++i) {  // the first image is not believed alone
    CHECK_FALSE(steps[i].estimate.valid);
    CHECK(steps[i].estimate.camera_moved);
    CHECK(steps[i].current_A == physics::PerCoil{});
    CHECK_THAT(steps[i].estimate.reason, Catch::Contains("the camera has slipped: the dish's rim is 0."));
  }
  CHECK(steps[10].estimate.valid);
  CHECK_FALSE(steps[10].current_A == physics::PerCoil{});
}

TEST_CASE("a camera that stands far from its calibration sees nothing, though it never saw the rim") {
  Bench bench;
  common::RandomStream random(1, "empty");
  imaging::Calibration calibration = imaging::calibrate_from_dish({bench.renderer->render({}, random).image},
                                                                  Bench::scene().bench, Bench::scene().lens);
  calibration.camera = imaging::moved(calibration.camera, {0.0, 0.0, 0.0}, {6e-3, 0.0, 0.0});
  session::CameraDetector detector(bench.camera, shipped_segmenter(), physics::RigDescription{},
                                   Bench::scene().lens, {}, calibration);
  vision::Sighting sighting;
  for (int i = 0; i < 12; ++i) sighting = detector.look();
  CHECK(sighting.camera == vision::CameraPlace::kUnknown);
  CHECK(sighting.candidates.empty());
}

TEST_CASE("an image without a dish is no reason to guess") {
  Bench bench;
  SpoiledCamera camera(bench.camera);
  camera.good = 0;
  camera.spoil = [](imaging::Frame& frame) { frame.image.setTo(cv::Scalar::all(90)); };
  session::CameraDetector detector = bench.detector(camera);
  CHECK_THROWS_AS(detector.look(), common::DataError);
}

TEST_CASE("an empty dish gives no pose, and a reason") {
  Bench bench;
  SpoiledCamera camera(bench.camera);
  camera.good = 0;
  common::RandomStream random(1, "frames");
  camera.spoil = [&](imaging::Frame& frame) { frame.image = bench.renderer->render({}, random).image; };
  session::CameraDetector detector = bench.detector(camera);
  for (int i = 0; i < 2; ++i) {
    const vision::Sighting sighting = detector.look();
    CHECK(sighting.candidates.empty());
    CHECK_THAT(sighting.reason, Catch::Contains("no needle"));
  }
}

TEST_CASE("sensing by camera goes on bitwise after a restart, and is calibrated to a fifth of a millimetre") {
  session::SensingConfig config;
  config.segmenter = kSegmenter;
  const session::Sensing sensing(config, {});
  const session::SeenBench seen = sensing.calibrated_bench(7);
  REQUIRE(seen.calibration);
  CHECK(imaging::floor_error(seen.calibration->camera, seen.renderer->scene().camera, sensing.bench()).rms_m <
        0.2e-3);
  rig::VirtualRig rig({}, 1);
  const auto straight = sensing.make(rig, seen, common::RandomStream(1, "noise"));
  straight->observe();
  const auto resumed = sensing.make(rig, seen, common::RandomStream(2, "other"));
  resumed->restore(straight->save());
  straight->forget();
  const common::Json before = rig.save();
  const geometry::Pose2 one = straight->observe().pose;
  rig.restore(before);
  const geometry::Pose2 two = resumed->observe().pose;
  CHECK(one.x_m == two.x_m);
  CHECK(one.y_m == two.y_m);
  CHECK(one.heading_rad == two.heading_rad);
}
