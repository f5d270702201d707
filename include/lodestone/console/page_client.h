#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "lodestone/common/json.h"

namespace lodestone::console {

/// A page without a browser: speaks the console's protocol for benches and tests. For one thread.
class PageClient {
 public:
  struct Received {
    bool image = false;
    std::string content;
  };
  /// Throws IoError where nobody answers, or does not let it in.
  explicit PageClient(std::uint16_t port);
  ~PageClient();
  PageClient(const PageClient&) = delete;
  PageClient& operator=(const PageClient&) = delete;

  /// Throws IoError where the connection is gone.
  void say(const common::Json& message);
  void beat() { say({{"do", "beat"}, {"visible", true}, {"focused", true}}); }
  void want(const char* what) { say({{"do", "more"}, {"of", what}}); }
  /// The next message; nothing where none comes in time. Throws IoError where the connection is gone.
  std::optional<Received> hear(double timeout_s);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodestone::console
