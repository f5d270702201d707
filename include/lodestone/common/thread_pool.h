#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

namespace lodestone::common {

/// What is asked for, or one per processor where that is 0.
std::int64_t thread_count(std::int64_t asked);

/// Sets flush-to-zero for denormal numbers in this thread while it lives, and then what was set before: for
/// programs of others, whose arithmetic is theirs.
class DenormalsFlushed {
 public:
  DenormalsFlushed();
  ~DenormalsFlushed();
  DenormalsFlushed(const DenormalsFlushed&) = delete;
  DenormalsFlushed& operator=(const DenormalsFlushed&) = delete;

 private:
  unsigned before_;
};

/// A fixed set of workers for data-parallel loops. The caller works too, so ThreadPool(1) starts no thread.
/// Work is cut into shards by the caller; results must not depend on which worker runs a shard.
/// Every worker sets flush-to-zero for denormal numbers, and so does the thread that makes the pool, for
/// good.
class ThreadPool {
 public:
  /// threads: 1 or more; 0 means one per processor. Throws IoError where so many cannot be started.
  explicit ThreadPool(std::size_t threads = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  std::size_t size() const;

  /// Calls body(shard) once for every shard in [0, shards) and returns when all are done.
  /// The first exception thrown by a body is rethrown here. Not reentrant.
  void for_each(std::size_t shards, const std::function<void(std::size_t)>& body);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodestone::common
