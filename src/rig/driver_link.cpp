#include "lodestone/rig/driver_link.h"

#include <fmt/core.h>

#include <algorithm>
#include <mutex>
#include <utility>

#include "lodestone/common/clock.h"
#include "lodestone/common/shown.h"

namespace lodestone::rig {

namespace {

constexpr double kSendTimeout_s = 0.1;
constexpr std::size_t kLengthBytes = 4;
constexpr std::size_t kMostText = 1U << 20U;
constexpr std::size_t kMostBytes = 1U << 28U;

/// Length (little-endian) and text.
std::vector<std::uint8_t> frame_of(const common::Json& content) {
  const std::string text = content.dump();
  std::vector<std::uint8_t> frame(kLengthBytes + text.size());
  for (std::size_t i = 0; i < kLengthBytes; ++i)
    frame[i] = static_cast<std::uint8_t>(text.size() >> (8 * i) & 0xffU);
  std::copy(text.begin(), text.end(), frame.begin() + kLengthBytes);
  return frame;
}

std::string what_of(const common::Json& request) { return request.value("do", std::string()); }

}  // namespace

double DriverReply::number(const char* key, double least, double most) const {
  const common::Json found = content.value(key, common::Json());
  if (!found.is_number() || !(found.get<double>() >= least && found.get<double>() <= most))
    throw common::HardwareError(
        fmt::format("the driver says {} = {}, a number from {:g} to {:g} belongs there", key,
                    common::shown_json(found), least, most));
  return found.get<double>();
}

DriverLink::DriverLink(const OpenStream& open, const std::string& role, common::Json hello,
                       double start_timeout_s, double reply_timeout_s)
    : stream_(open()), reply_timeout_s_(reply_timeout_s), images_(role == "camera") {
  hello["do"] = "hello";
  hello["protocol"] = kDriverProtocol;
  hello["role"] = role;
  const common::Json said = ask(hello, start_timeout_s).content;
  const auto named = said.find("name");
  if (named != said.end() && named->is_string()) name_ += " " + common::shown(named->get<std::string>());
  const auto spoken = said.find("protocol");
  if (spoken == said.end() || *spoken != kDriverProtocol) {
    close();
    throw common::HardwareError(fmt::format("{} speaks protocol {}, this program {}", name_,
                                            spoken == said.end() ? "nothing" : common::shown_json(*spoken),
                                            kDriverProtocol));
  }
  // Where this program dies of a signal, the driver of coils still hears of it.
  if (role == "coils" && stream_->descriptor() >= 0)
    signal_safe_stop_ = std::make_unique<common::SignalSafeStop>(stream_->descriptor(),
                                                                 frame_of({{"id", 0}, {"do", "stop"}}));
}

void DriverLink::close() noexcept {
  open_ = false;
  const std::lock_guard<common::PriorityMutex> lock(writing_);
  signal_safe_stop_.reset();
  stream_.reset();
}

std::int64_t DriverLink::send(const common::Json& request, std::optional<std::int64_t> stops) {
  const std::lock_guard<common::PriorityMutex> lock(writing_);
  if (stops && *stops != stops_)
    throw DriverRefused("the pulse was given up: another thread has stopped the coils");
  if (stream_ == nullptr)
    throw common::HardwareError(name_ + " was given up, since it failed or did not answer");
  common::Json numbered = {{"id", ++last_id_}};
  numbered.update(request);
  const std::vector<std::uint8_t> frame = frame_of(numbered);
  const common::DeviceWrite writing;
  stream_->write(frame.data(), frame.size(), kSendTimeout_s);
  return last_id_;
}

void DriverLink::read(std::uint8_t* bytes, std::size_t count, double until_s) {
  const common::SteadyClock clock;
  for (std::size_t done = 0; done < count;) {
    const double left_s = until_s - clock.now_s();
    if (left_s <= 0.0) throw common::HardwareError(name_ + " does not answer in time");
    done += stream_->read(bytes + done, count - done, left_s);
  }
}

DriverReply DriverLink::read_reply(double until_s) {
  std::uint8_t head[kLengthBytes];
  read(head, sizeof head, until_s);
  std::size_t length = 0;
  for (std::size_t i = 0; i < kLengthBytes; ++i) length |= std::size_t{head[i]} << (8 * i);
  if (length > kMostText)
    throw common::HardwareError(
        fmt::format("{} sends \"{}\" where a length belongs: does it print to standard output?", name_,
                    common::shown(std::string(head, head + sizeof head))));
  std::string text(length, '\0');
  read(reinterpret_cast<std::uint8_t*>(text.data()), length, until_s);
  DriverReply reply{common::parse_json(text, name_), {}};
  if (!reply.content.is_object())
    throw common::HardwareError(name_ + " sends " + common::shown_json(reply.content) +
                                " where an object belongs");
  if (const auto bytes = reply.content.find("bytes"); bytes != reply.content.end()) {
    if (!images_ || !bytes->is_number_unsigned() || bytes->get<std::uint64_t>() > kMostBytes)
      throw common::HardwareError(name_ + " says that " + common::shown_json(*bytes) + " bytes follow");
    reply.bytes.resize(bytes->get<std::size_t>());
    read(reply.bytes.data(), reply.bytes.size(), until_s);
  }
  return reply;
}

DriverReply DriverLink::await(std::int64_t id, const common::Json& request, double until_s) {
  while (true) {
    DriverReply reply = read_reply(until_s);
    const common::Json of = reply.content.value("id", common::Json());
    if (of != id) {  // a stop that went ahead
      if (!of.is_number_integer()) continue;
      answered_ahead_ = of.get<std::int64_t>();
      refused_ahead_ = reply.content.value("error", common::Json());
      continue;
    }
    const auto error = reply.content.find("error");
    if (error == reply.content.end()) return reply;
    throw_refused(request, *error);
  }
}

void DriverLink::throw_refused(const common::Json& request, const common::Json& error) const {
  throw DriverRefused(
      name_ + " refuses " + what_of(request) + ": " +
      common::shown(error.is_string() ? error.get<std::string>() : common::shown_json(error)));
}

/// What `exchange` gets in time; whatever it meets but a refusal closes the link.
DriverReply DriverLink::answered(const common::Json& request, double timeout_s,
                                 const std::function<DriverReply(double until_s)>& exchange) {
  try {
    return exchange(common::SteadyClock().now_s() + timeout_s);
  } catch (const DriverRefused&) {
    throw;  // it is in order
  } catch (const common::Interrupted&) {
    throw;
  } catch (const common::Error& error) {
    close();
    throw common::HardwareError(
        fmt::format("{} (asked for {}, {:g} s)", error.what(), what_of(request), timeout_s));
  }
}

DriverReply DriverLink::ask(const common::Json& request, double timeout_s) {
  const std::lock_guard<common::PriorityMutex> lock(asking_);
  return answered(request, timeout_s, [&](double until_s) { return await(send(request), request, until_s); });
}

DriverReply DriverLink::ask_unless_stopped(const common::Json& request, std::int64_t stops) {
  const std::lock_guard<common::PriorityMutex> lock(asking_);
  return answered(request, reply_timeout_s_,
                  [&](double until_s) { return await(send(request, stops), request, until_s); });
}

void DriverLink::stop() {
  const common::Json request = {{"do", "stop"}};
  ++stops_;
  std::unique_lock<common::PriorityMutex> lock(asking_, std::try_to_lock);
  std::int64_t ahead = 0;
  if (!lock) {
    ahead = send(request);
    lock.lock();
  }
  answered(request, reply_timeout_s_, [&](double until_s) {
    if (ahead != 0 && answered_ahead_ >= ahead) {
      if (!refused_ahead_.is_null()) throw_refused(request, refused_ahead_);
      return DriverReply{};
    }
    return await(ahead != 0 ? ahead : send(request), request, until_s);
  });
  ++stops_;  // a pulse that was begun meanwhile is none any more
}

}  // namespace lodestone::rig
