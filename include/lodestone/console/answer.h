#pragma once

#include <functional>

#include "lodestone/console/access.h"
#include "lodestone/console/request_head.h"
#include "lodestone/console/response.h"

namespace lodestone::console {

/// What lies at a target, for who may ask.
using Pages = std::function<Response(const RequestHead&)>;

/// Where the WebSocket is.
inline constexpr const char* kSocketTarget = "/ws";

/// The answer to any request: what `access` refuses, 101 to what may become a WebSocket, else the page; 500
/// with the message of a page that throws.
Response answer(const Access& access, const Pages& pages, const RequestHead& head);

}  // namespace lodestone::console
