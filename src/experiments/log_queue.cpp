#include "lodestone/experiments/log_queue.h"

#include <exception>
#include <mutex>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/thread_name.h"

namespace lodestone::experiments {
namespace {

constexpr std::size_t kMostWaiting = 64;  // an image of the camera and a step are two

}  // namespace

LogQueue::LogQueue(const std::string& path, const std::map<std::string, std::string>& facts, Writes writes)
    : log_(path, facts) {
  if (writes == Writes::kInBackground) thread_ = std::thread([this] { run(); });
}

LogQueue::~LogQueue() {
  try {
    finish();
  } catch (const common::Error&) {
    // Who wants to know calls finish().
  }
}

void LogQueue::tell(Entry entry) {
  check();
  if (!thread_.joinable()) {
    write(entry);
    return check();
  }
  {
    const std::lock_guard<common::PriorityMutex> lock(mutex_);
    waiting_.push_back(std::move(entry));
  }
  told_.notify_one();
}

bool LogQueue::behind() const {
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  return waiting_.size() >= kMostWaiting;
}

void LogQueue::finish() {
  join();
  if (!std::exchange(finished_, true)) write([](exports::RigLog& log) { log.finish(); });
  check();
}

void LogQueue::join() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard<common::PriorityMutex> lock(mutex_);
    over_ = true;
  }
  told_.notify_one();
  thread_.join();
}

void LogQueue::run() {
  common::name_thread("log");
  std::unique_lock<common::PriorityMutex> lock(mutex_);
  while (true) {
    told_.wait(lock, [this] { return over_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const Entry entry = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    write(entry);
    lock.lock();
  }
}

void LogQueue::write(const Entry& entry) {
  std::string fault;
  try {
    check();
    entry(log_);
  } catch (const std::exception& error) {
    fault = error.what();
  }
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  if (fault_.empty()) fault_ = fault;
}

void LogQueue::check() const {
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  if (!fault_.empty()) throw common::IoError(fault_);
}

}  // namespace lodestone::experiments
