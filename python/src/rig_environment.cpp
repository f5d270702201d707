#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <unistd.h>

#include <cstring>
#include <mutex>

#include "arrays.h"
#include "bindings.h"
#include "environment_config.h"
#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/saturation.h"
#include "stepped_loop.h"

namespace lodestone::python {
namespace {

/// What is played, and the groups of `lodestone deploy` that say on what.
struct RigEnvironmentConfig : EnvironmentConfig {
  rig::RigConfig rig;
  session::SensingConfig sensor;
  safety::SafetyConfig safety;
  control::ControlLoopConfig loop;

  template <class Visitor>
  void visit(Visitor& v) {
    EnvironmentConfig::visit(v);
    v.group("rig", rig, "the rig");
    v.group("sensor", sensor, "how poses are sensed");
    v.group("safety", safety, "limits of the supervisor");
    v.group("loop", loop, "timing of the control loop");
  }
};

RigEnvironmentConfig read_config(const std::string& text) {
  auto config =
      common::config_from_json<RigEnvironmentConfig>(common::parse_json(text, "environment"), "environment");
  config.rig.validate();
  if (config.task.within == task::Within::kReachable)
    throw common::InvalidConfig("task.within", common::name_of(config.task.within),
                                "be disc: where a recording moved the needle, no rig can tell");
  env::adopt_rig(config.rig, config.task, config.encoder, config.action);
  return config;
}

/// One rig in its control loop, behind its supervisor, played by the rules of the learned simulator's
/// environments. What counts is what the sensor sees. Any thread may step; one waits for the other.
class RigEnvironment {
 public:
  using Ask = std::function<void(double x_m, double y_m, double heading_rad)>;

  RigEnvironment(const std::string& config, std::uint64_t rig_seed, std::uint64_t sensor_seed, Ask ask)
      : config_(read_config(config)), rig_seed_(rig_seed), sensor_seed_(sensor_seed), ask_(std::move(ask)) {
    const py::gil_scoped_release released;
    begin(0);
  }
  ~RigEnvironment() {
    if (getpid() != process_) {  // forked off: there is no thread to wait for
      static_cast<void>(loop_.release());
      static_cast<void>(rig_.release());
      return;
    }
    const py::gil_scoped_release released;
    loop_.reset();
    rig_.reset();
  }
  RigEnvironment(const RigEnvironment&) = delete;
  RigEnvironment& operator=(const RigEnvironment&) = delete;

  std::int64_t observation_size() const { return episodes_->spec().observation_size; }
  std::int64_t action_size() const { return config_.action.size; }
  std::string contract() const {
    return contract_of(config_, common::config_to_json<physics::RigDescription>(config_.rig)).dump();
  }

  py::array reset(std::optional<std::uint64_t> seed) {
    check_process();
    std::vector<float> observation;
    {
      const py::gil_scoped_release released;
      const std::lock_guard<std::mutex> lock(mutex_);
      if (seed) begin(*seed);
      loop_->end();
      episodes_->begin(0, [this](common::RandomStream& random) { return place(random); });
      observation = episodes_->observation();
    }
    return array_of(std::move(observation), {observation_size()});
  }

  /// (observation, reward, terminated, truncated, success, reason of a stop)
  py::tuple step(const py::handle& action) {
    check_process();
    const Rows<float> given = read_rows<float>(action, "action", action_size());
    if (given.count != 1)
      throw py::value_error("action is of several rows, must be [" + std::to_string(action_size()) + "]");
    std::string stopped;
    {
      const py::gil_scoped_release released;
      const std::lock_guard<std::mutex> lock(mutex_);
      episodes_->drive(0, given.numbers.data());
      const std::optional<geometry::Pose2> next =
          loop_->step(geometry::saturated(geometry::as_drive(given.numbers.data(), config_.action.size)));
      env::StepEnd end;
      end.truncated = !next;
      if (!next) stopped = loop_->stop_reason();
      if (episodes_->finish(0, next.value_or(episodes_->pose(0)), end)) loop_->end();
    }
    const env::StepResult& result = episodes_->result();
    return py::make_tuple(array_of(result.final_observation, {observation_size()}), result.reward[0],
                          result.terminated[0] != 0, result.truncated[0] != 0, result.success[0] != 0,
                          stopped);
  }

  /// The newest image, [rows, columns, 3] RGB.
  py::array image() {
    check_process();
    if (rig_->camera() == nullptr)
      throw common::ConfigError(
          "sensor.kind = \"simulated\": there is no camera to see through; use \"camera\"");
    const std::shared_ptr<const imaging::Frame> latest = rig_->latest_image();
    const cv::Mat& bgr = latest ? latest->image : rig_->camera()->frame().image;
    if (bgr.empty()) throw common::ConfigError("there is no image yet; call reset() first");
    std::vector<std::uint8_t> rgb;
    rgb.reserve(bgr.total() * 3);
    for (int row = 0; row < bgr.rows; ++row)
      for (const std::uint8_t* pixel = bgr.ptr(row); pixel != bgr.ptr(row) + 3 * bgr.cols; pixel += 3)
        rgb.insert(rgb.end(), {pixel[2], pixel[1], pixel[0]});
    return array_of(std::move(rgb), {bgr.rows, bgr.cols, 3});
  }

  void rearm() {
    const py::gil_scoped_release released;
    const std::lock_guard<std::mutex> lock(mutex_);
    rig_->clear_faults();
    rig_->coils().rearm();
  }

 private:
  /// From the beginning of a seed; a virtual rig is made anew.
  void begin(std::uint64_t seed) {
    if (!rig_ || !config_.rig.real()) connect(seed);
    env::EpisodeSettings settings;
    settings.task = config_.task;
    settings.encoder = config_.encoder;
    settings.action = config_.action;
    settings.seed = seed;
    episodes_.emplace(settings, env::SensorNoise{}, "rig");
  }

  /// What cannot be made leaves what there was: a real rig is opened once, a virtual one takes no device.
  void connect(std::uint64_t seed) {
    std::unique_ptr<session::RigSession> rig;
    if (config_.rig.real()) {
      session::AskedOperator::Ask ask;
      if (ask_)
        ask = [this](const geometry::Pose2& pose) {
          const py::gil_scoped_acquire acquired;
          ask_(pose.x_m, pose.y_m, pose.heading_rad);
        };
      rig = session::make_bench_session(config_.rig, config_.sensor, config_.safety, std::move(ask));
    } else {
      session::VirtualSeeds seeds;
      seeds.rig = rig_seed_;
      seeds.scene = sensor_seed_;
      seeds.sensor_noise = common::RandomStream(seed, "rig/sensor noise");
      seeds.scatter = common::RandomStream(seed, "rig/scatter");
      rig = session::make_virtual_session(config_.rig, config_.sensor, config_.safety, seeds);
    }
    auto loop = std::make_unique<SteppedLoop>(*rig, config_.loop, config_.action, config_.rig);
    loop_ = std::move(loop);  // before the rig that the old one drives goes
    rig_ = std::move(rig);
  }

  /// Has the needle placed somewhere in the disc of starts: where the sensor then sees it.
  geometry::Pose2 place(common::RandomStream& random) {
    constexpr int kTries = 10000;
    for (int tried = 0; tried < kTries; ++tried) {
      const geometry::Vector2 start_m = task::draw_in_disc(config_.task.start_radius_m(), random);
      const geometry::Pose2 start{start_m.x(), start_m.y(), random.uniform(-geometry::kPi, geometry::kPi)};
      if (!rig_->fits(start)) continue;
      loop_->end();
      rig_->place(start);
      if (const std::optional<geometry::Pose2> seen = loop_->begin()) return *seen;
      throw common::HardwareError(loop_->stop_reason());
    }
    throw common::ConfigError("task.start_radius: no start inside the dish was found; use a smaller radius");
  }

  void check_process() const {
    if (getpid() != process_)
      throw common::ConfigError(
          "environment: it was made in another process, and its rig has stayed there; make it in the process "
          "that steps it");
  }

  RigEnvironmentConfig config_;
  std::uint64_t rig_seed_, sensor_seed_;
  Ask ask_;
  pid_t process_ = getpid();
  std::mutex mutex_;
  std::unique_ptr<session::RigSession> rig_;
  std::unique_ptr<SteppedLoop> loop_;
  std::optional<env::EpisodeBatch> episodes_;
};

}  // namespace

void bind_rig(py::module_& module) {
  py::class_<RigEnvironment>(module, "RigEnvironment")
      .def(py::init<const std::string&, std::uint64_t, std::uint64_t, RigEnvironment::Ask>(),
           py::arg("config"), py::arg("rig_seed"), py::arg("sensor_seed"), py::arg("ask"))
      .def_property_readonly("observation_size", &RigEnvironment::observation_size)
      .def_property_readonly("action_size", &RigEnvironment::action_size)
      .def("contract", &RigEnvironment::contract)
      .def("reset", &RigEnvironment::reset, py::arg("seed"))
      .def("step", &RigEnvironment::step, py::arg("action"))
      .def("image", &RigEnvironment::image)
      .def("rearm", &RigEnvironment::rearm);
}

}  // namespace lodestone::python
