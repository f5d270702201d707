#include "lodestone/console/answer.h"

#include <exception>

#include "lodestone/common/shown.h"

namespace lodestone::console {

Response answer(const Access& access, const Pages& pages, const RequestHead& head) {
  if (std::optional<Response> refusal = access.judge(head)) return *refusal;
  const bool is_socket = head.target == kSocketTarget;
  if (is_socket && head.upgrade) return told(101, "");
  if (is_socket) {
    Response refusal = told(426, "this is a WebSocket");
    refusal.headers.push_back({"Upgrade", "websocket"});
    return refusal;
  }
  if (head.upgrade) return told(404, std::string("the WebSocket is at ") + kSocketTarget);
  try {
    return pages(head);
  } catch (const std::exception& error) {  // a file that cannot be read ends no server
    return told(500, common::escaped(error.what()));
  }
}

}  // namespace lodestone::console
