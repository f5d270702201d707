#include "lodestone/console/feed.h"

#include <chrono>
#include <condition_variable>
#include <cstring>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/common/priority_mutex.h"
#include "lodestone/common/thread_name.h"
#include "lodestone/imaging/image_file.h"

namespace lodestone::console {
namespace {

constexpr int kQuality = 75;
constexpr double kLookAgain_s = 0.004;  // for an image that somebody waits for

}  // namespace

std::string image_message(const imaging::Frame& frame, double now_s) {
  std::string message(2 * sizeof(double), '\0');
  std::memcpy(message.data(), &frame.stamp_s, sizeof(double));
  std::memcpy(message.data() + sizeof(double), &now_s, sizeof(double));
  return message + imaging::encoded_image(frame.image, ".jpg", kQuality);
}

struct Feed::State {
  struct Page {
    bool wants_image = false, wants_state = false;
    double last_stamp_s = -1e9;             // of the image it had last
    double image_s = -1e9, state_s = -1e9;  // when it had the last ones, on the wall clock
  };

  explicit State(Source from) : source(std::move(from)), thread([this] { run(); }) {}

  Source source;
  common::SteadyClock wall;
  common::PriorityMutex mutex;
  std::condition_variable_any asked;
  std::map<PageId, Page> pages;
  bool over = false;
  std::thread thread;  // last: uses what is above

  void run() {
    common::name_thread("feed");
    std::shared_ptr<const imaging::Frame> frame;
    std::shared_ptr<const std::string> encoded;
    std::unique_lock<common::PriorityMutex> lock(mutex);
    while (!over) {
      bool waited_for = false;
      const double now_s = wall.now_s();
      std::vector<PageId> for_image, for_state;
      for (auto& [id, page] : pages) {
        waited_for = waited_for || page.wants_image || page.wants_state;
        if (page.wants_image && now_s - page.image_s >= kPeriod_s) for_image.push_back(id);
        if (page.wants_state && now_s - page.state_s >= kPeriod_s) for_state.push_back(id);
      }
      for (const PageId id : for_state) {
        pages[id].wants_state = false;
        pages[id].state_s = now_s;
      }
      lock.unlock();
      for (const PageId id : for_state) source.send_state(id);
      const auto newest = for_image.empty() ? nullptr : source.image();
      if (newest && newest != frame) {
        frame = newest;
        encoded.reset();
      }
      lock.lock();
      if (newest) {
        std::vector<PageId> late;  // with an older image, or none
        for (const PageId id : for_image) {
          const auto found = pages.find(id);
          if (found == pages.end() || found->second.last_stamp_s >= frame->stamp_s) continue;
          found->second = {false, found->second.wants_state, frame->stamp_s, now_s, found->second.state_s};
          late.push_back(id);
        }
        lock.unlock();
        if (!late.empty() && !encoded)
          encoded = std::make_shared<const std::string>(image_message(*frame, source.now_s()));
        for (const PageId id : late) source.send_image(id, encoded);
        lock.lock();
      }
      const auto again = std::chrono::duration<double>(waited_for ? kLookAgain_s : 1.0);
      asked.wait_for(lock, again, [this, waited_for] { return over || (!waited_for && anybody_wants()); });
    }
  }

  bool anybody_wants() const {
    for (const auto& [id, page] : pages)
      if (page.wants_image || page.wants_state) return true;
    return false;
  }
};

Feed::Feed(Source source) : state_(std::make_unique<State>(std::move(source))) {}

Feed::~Feed() { end(); }

void Feed::end() {
  {
    const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
    state_->over = true;
  }
  state_->asked.notify_all();
  if (state_->thread.joinable()) state_->thread.join();
}

void Feed::want_image(PageId page) {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  state_->pages[page].wants_image = true;
  state_->asked.notify_all();
}

void Feed::want_state(PageId page) {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  state_->pages[page].wants_state = true;
  state_->asked.notify_all();
}

void Feed::forget(PageId page) {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  state_->pages.erase(page);
}

}  // namespace lodestone::console
