#include "lodestone/common/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "lodestone/common/error.h"

#if defined(__SSE3__) || defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace lodestone::common {
namespace {

/// Denormal numbers cost a hundred cycles each and carry nothing here.
void flush_denormals_to_zero() {
#if defined(__SSE3__) || defined(__x86_64__)
  _mm_setcsr(_mm_getcsr() | 0x8040);  // flush-to-zero and denormals-are-zero
#endif
}

unsigned float_mode() {
#if defined(__SSE3__) || defined(__x86_64__)
  return _mm_getcsr();
#else
  return 0;
#endif
}

void set_float_mode([[maybe_unused]] unsigned mode) {
#if defined(__SSE3__) || defined(__x86_64__)
  _mm_setcsr(mode);
#endif
}

/// How long a thread looks again and again before it sleeps: waking one takes longer than a short shard.
constexpr std::chrono::microseconds kSpin{50};

void pause_a_moment() {
#if defined(__SSE3__) || defined(__x86_64__)
  _mm_pause();
#endif
}

/// True as soon as `condition` holds, false when it does not within kSpin.
template <class Condition>
bool spin_until(const Condition& condition) {
  constexpr int kLooksPerClock = 16;
  const auto end = std::chrono::steady_clock::now() + kSpin;
  do {
    for (int look = 0; look < kLooksPerClock; ++look) {
      if (condition()) return true;
      pause_a_moment();
    }
  } while (std::chrono::steady_clock::now() < end);
  return condition();
}

}  // namespace

DenormalsFlushed::DenormalsFlushed() : before_(float_mode()) { flush_denormals_to_zero(); }
DenormalsFlushed::~DenormalsFlushed() { set_float_mode(before_); }

struct ThreadPool::State {
  std::vector<std::thread> workers;
  bool spin = true;  // where every thread has a processor of its own
  std::mutex mutex;
  std::condition_variable wake;
  std::condition_variable done;
  // written before `generation` counts up, read after
  const std::function<void(std::size_t)>* body = nullptr;
  std::size_t shards = 0;
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> busy{0};
  std::atomic<std::size_t> generation{0};
  std::atomic<bool> stopping{false};
  std::exception_ptr failure;

  ~State() {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      stopping = true;
    }
    wake.notify_all();
    for (std::thread& worker : workers) worker.join();
  }

  /// Returns when `condition` holds, which is announced through `announced` under the mutex.
  template <class Condition>
  void wait(std::condition_variable& announced, const Condition& condition) {
    if (spin && spin_until(condition)) return;
    std::unique_lock<std::mutex> lock(mutex);
    announced.wait(lock, condition);
  }

  void work(const std::function<void(std::size_t)>& run, std::size_t count) {
    try {
      for (std::size_t shard = next.fetch_add(1); shard < count; shard = next.fetch_add(1)) run(shard);
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex);
      if (!failure) failure = std::current_exception();
      next.store(count);
    }
  }

  void loop() {
    flush_denormals_to_zero();
    std::size_t seen = 0;
    while (true) {
      wait(wake, [&] { return stopping || generation != seen; });
      if (stopping) return;
      seen = generation;
      work(*body, shards);
      if (busy.fetch_sub(1) == 1) {
        const std::lock_guard<std::mutex> lock(mutex);
        done.notify_one();
      }
    }
  }
};

std::int64_t thread_count(std::int64_t asked) {
  return asked > 0 ? asked : std::max<std::int64_t>(1, std::thread::hardware_concurrency());
}

ThreadPool::ThreadPool(std::size_t threads) : state_(std::make_unique<State>()) {
  const auto processors = static_cast<std::size_t>(thread_count(0));
  if (threads == 0) threads = processors;
  flush_denormals_to_zero();
  state_->spin = threads <= processors;
  try {
    for (std::size_t i = 1; i < threads; ++i)
      state_->workers.emplace_back([state = state_.get()] { state->loop(); });
  } catch (const std::system_error&) {
    throw IoError("cannot start " + std::to_string(threads) + " threads: no more than " +
                  std::to_string(size()) + " can be had now; ask for fewer");
  }
}

ThreadPool::~ThreadPool() = default;

std::size_t ThreadPool::size() const { return state_->workers.size() + 1; }

void ThreadPool::for_each(std::size_t shards, const std::function<void(std::size_t)>& body) {
  if (state_->workers.empty() || shards <= 1) {
    for (std::size_t shard = 0; shard < shards; ++shard) body(shard);
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->body = &body;
    state_->shards = shards;
    state_->next = 0;
    state_->busy = state_->workers.size();
    state_->failure = nullptr;
    ++state_->generation;
  }
  state_->wake.notify_all();
  state_->work(body, shards);
  state_->wait(state_->done, [this] { return state_->busy == 0; });
  if (state_->failure) std::rethrow_exception(state_->failure);
}

}  // namespace lodestone::common
