#include "lodestone/rig/free_running_camera.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <condition_variable>
#include <functional>
#include <limits>
#include <mutex>
#include <thread>

#include "lodestone/common/error.h"

using namespace lodestone;

namespace {

/// Gives an image for every ticket, numbered from 1; none while unplugged.
struct Tickets {
  std::mutex mutex;
  std::condition_variable changed;
  int left = 0;
  int given = 0;
  std::atomic<bool> unplugged{false};

  void add(int count) {
    const std::lock_guard<std::mutex> lock(mutex);
    left += count;
    changed.notify_all();
  }
};

class TicketCamera final : public rig::Camera {
 public:
  explicit TicketCamera(std::shared_ptr<Tickets> tickets) : tickets_(std::move(tickets)) {}
  imaging::Frame grab(double timeout_s) override {
    if (tickets_->unplugged) throw common::HardwareError("the cable is out");
    std::unique_lock<std::mutex> lock(tickets_->mutex);
    if (!tickets_->changed.wait_for(lock, std::chrono::duration<double>(timeout_s),
                                    [&] { return tickets_->left > 0; }))
      throw common::HardwareError("no ticket");
    --tickets_->left;
    ++tickets_->given;
    return {cv::Mat(2, 2, CV_8UC3, cv::Scalar::all(tickets_->given)), 0.1 * tickets_->given};
  }

 private:
  std::shared_ptr<Tickets> tickets_;
};

/// Does the same again and again beside the test, until it goes out of scope, by the end of the test or by a
/// failure.
class Beside {
 public:
  explicit Beside(std::function<void()> work)
      : thread_([this, work = std::move(work)] {
          while (!over_) work();
        }) {}
  ~Beside() {
    over_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> over_{false};
  std::thread thread_;
};

std::shared_ptr<const imaging::Frame> wait_for_stamp(const rig::FreeRunningCamera& camera, double stamp_s) {
  for (;;) {
    const auto frame = camera.latest();
    if (frame && frame->stamp_s >= stamp_s) return frame;
    std::this_thread::yield();
  }
}

}  // namespace

TEST_CASE("who watches sees the newest image without waiting, the loop gets one that came after it asked") {
  const auto tickets = std::make_shared<Tickets>();
  rig::FreeRunningCamera camera(std::make_unique<TicketCamera>(tickets), 0.02);
  CHECK(camera.latest() == nullptr);
  tickets->add(5);
  const auto seen = wait_for_stamp(camera, 0.5);
  CHECK(seen->image.at<cv::Vec3b>(0, 0)[0] == 5);
  int added = 5;
  {
    const Beside later([&] {
      tickets->add(1);
      ++added;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    });
    CHECK(camera.grab(60.0).stamp_s > 0.5);  // not the one that was there
  }
  CHECK(seen->stamp_s == 0.5);  // what was taken stays as it is
  wait_for_stamp(camera, 0.1 * (added - 0.5));
  CHECK_THROWS_AS(camera.grab(0.05), common::HardwareError);
}

TEST_CASE("a camera that fails says why, and one that comes back goes on") {
  const auto tickets = std::make_shared<Tickets>();
  tickets->unplugged = true;
  rig::FreeRunningCamera camera(std::make_unique<TicketCamera>(tickets), 0.02);
  std::string said;
  while (said != "the cable is out") {
    try {
      camera.grab(0.02);
    } catch (const common::HardwareError& error) {
      said = error.what();
    }
  }
  tickets->unplugged = false;
  tickets->add(1);
  CHECK(wait_for_stamp(camera, 0.05)->stamp_s == 0.1);
}

TEST_CASE("watchers do not hold the loop up") {
  const auto tickets = std::make_shared<Tickets>();
  tickets->add(std::numeric_limits<int>::max());
  rig::FreeRunningCamera camera(std::make_unique<TicketCamera>(tickets), 0.02, 1e-4);  // without a pause it
  // would hold one processor against everybody, where this user may go first
  const Beside watcher([&] {
    const auto frame = camera.latest();
    if (frame) static_cast<void>(frame->image.at<cv::Vec3b>(1, 1));
  });
  double last_s = 0.0;
  for (int i = 0; i < 200; ++i) {
    const imaging::Frame frame = camera.grab(60.0);
    CHECK(frame.stamp_s > last_s);
    last_s = frame.stamp_s;
  }
}
