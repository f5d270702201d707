#include "lodestone/common/thread_pool.h"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

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

}  // namespace

struct ThreadPool::State {
  std::vector<std::thread> workers;
  std::mutex mutex;
  std::condition_variable wake;
  std::condition_variable done;
  const std::function<void(std::size_t)>* body = nullptr;
  std::size_t shards = 0;
  std::atomic<std::size_t> next{0};
  std::size_t busy = 0;
  std::size_t generation = 0;
  bool stopping = false;
  std::exception_ptr failure;

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
    std::unique_lock<std::mutex> lock(mutex);
    while (true) {
      wake.wait(lock, [&] { return stopping || generation != seen; });
      if (stopping) return;
      seen = generation;
      const auto* run = body;
      const std::size_t count = shards;
      lock.unlock();
      work(*run, count);
      lock.lock();
      if (--busy == 0) done.notify_one();
    }
  }
};

ThreadPool::ThreadPool(std::size_t threads) : state_(std::make_unique<State>()) {
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  flush_denormals_to_zero();
  for (std::size_t i = 1; i < threads; ++i) state_->workers.emplace_back([this] { state_->loop(); });
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->stopping = true;
  }
  state_->wake.notify_all();
  for (std::thread& worker : state_->workers) worker.join();
}

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
    state_->next.store(0);
    state_->busy = state_->workers.size();
    state_->failure = nullptr;
    ++state_->generation;
  }
  state_->wake.notify_all();
  state_->work(body, shards);
  std::unique_lock<std::mutex> lock(state_->mutex);
  state_->done.wait(lock, [&] { return state_->busy == 0; });
  if (state_->failure) std::rethrow_exception(state_->failure);
}

}  // namespace lodestone::common
