#include "lodestone/emulation/live_bench.h"

#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

#include "gige_camera.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/common/log.h"
#include "lodestone/common/priority_mutex.h"
#include "lodestone/common/random.h"
#include "lodestone/common/realtime.h"
#include "pseudo_terminal.h"

namespace lodestone::emulation {

namespace {
constexpr double kLook_s = 0.3e-3;
constexpr double kTooLate_s = 0.2;  // behind real time: given up, or the bench would run faster afterwards
}  // namespace

struct LiveBench::State {
  State(const rig::VirtualRigConfig& config, std::uint64_t seed,
        std::shared_ptr<const imaging::SceneRenderer> scene)
      : rig(config, seed), bench(rig), renderer(std::move(scene)), noise(seed, "live camera") {}

  rig::VirtualRig rig;
  EmulatedBench bench;
  PseudoTerminal line;
  std::shared_ptr<const imaging::SceneRenderer> renderer;
  common::RandomStream noise;
  common::PriorityMutex mutex;
  double lost_s = 0.0;
  std::atomic<bool> ending{false};
  std::unique_ptr<GigeCamera> camera;
  std::string no_camera;
  std::thread thread;

  void run() {
    const common::RealtimeThread realtime;  // hardware does not wait until a processor is free
    try {
      const common::SteadyClock clock;
      double offset_s = clock.now_s() - bench.now_s();
      std::vector<std::uint8_t> bytes(256);
      while (!ending) {
        const std::size_t count = line.read(bytes.data(), bytes.size(), kLook_s);
        const std::lock_guard<common::PriorityMutex> lock(mutex);
        if (count > 0) bench.host_write(bytes.data(), count);
        const double behind_s = clock.now_s() - offset_s - bench.now_s();
        if (behind_s > kTooLate_s) {
          offset_s += behind_s;
          lost_s += behind_s;
        }
        bench.advance_to(clock.now_s() - offset_s);
        std::vector<std::uint8_t> out;
        std::uint8_t byte = 0;
        while (bench.host_read(byte)) out.push_back(byte);
        if (!out.empty()) line.write(out.data(), out.size());
      }
    } catch (const std::exception& error) {
      common::log_error(std::string("emulated bench: ") + error.what());
    }
  }

  cv::Mat image() {
    imaging::NeedleView needle;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      needle.pose = rig.true_pose();
    }
    return renderer->render({needle}, noise).image;
  }
};

LiveBench::LiveBench(const rig::VirtualRigConfig& rig, std::uint64_t seed,
                     std::shared_ptr<const imaging::SceneRenderer> renderer)
    : state_(std::make_unique<State>(rig, seed, std::move(renderer))) {
  State& state = *state_;
  if (state.renderer) state.camera = std::make_unique<GigeCamera>([&state] { return state.image(); });
  state.thread = std::thread([&state] { state.run(); });
}

LiveBench::~LiveBench() {
  state_->camera.reset();
  state_->ending = true;
  state_->thread.join();
}

const std::string& LiveBench::port() const { return state_->line.name(); }
const std::string& LiveBench::camera() const {
  return state_->camera ? state_->camera->name() : state_->no_camera;
}

const std::string& LiveBench::camera_serial() const {
  return state_->camera ? state_->camera->serial() : state_->no_camera;
}

geometry::Pose2 LiveBench::true_pose() {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  return state_->rig.true_pose();
}

void LiveBench::place(const geometry::Pose2& pose) {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  state_->rig.place(pose);
}

void LiveBench::with(const std::function<void(EmulatedBench& bench)>& action) {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  action(state_->bench);
}

double LiveBench::lost_s() {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  return state_->lost_s;
}

}  // namespace lodestone::emulation
