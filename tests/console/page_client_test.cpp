#include "lodestone/console/page_client.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/console/web_server.h"

using namespace lodestone;

TEST_CASE("a page without a browser speaks with a server, and says so where there is none") {
  std::uint16_t port = 0;
  {
    console::WebServer* server = nullptr;
    console::WebServerHandlers handlers;
    handlers.pages = [](const console::RequestHead&) { return console::told(404, "nothing"); };
    handlers.opened = [](console::ClientId) {};
    handlers.text = [&server](console::ClientId client, const std::string& text) {
      server->send(client, text);
    };
    handlers.closed = [](console::ClientId) {};
    handlers.farewell = [](const std::string&) { return std::string(); };
    console::WebServer made({}, console::Access(false, ""), std::move(handlers));
    server = &made;
    port = made.port();
    console::PageClient page(port);
    CHECK_FALSE(page.hear(0.01));
    page.beat();
    const auto echo = page.hear(10.0);
    REQUIRE(echo);
    CHECK_FALSE(echo->image);
    CHECK(common::Json::parse(echo->content)["do"] == "beat");
  }
  CHECK_THROWS_AS(console::PageClient(port), common::IoError);
}
