#include "lodestone/console/worker.h"

#include <catch2/catch.hpp>
#include <future>
#include <vector>

TEST_CASE("a worker does what it was asked for, in order, before it ends; and not without bound") {
  std::vector<int> done;
  int refused = 0;
  {
    lodestone::console::Worker worker;
    std::promise<void> go;
    std::shared_future<void> may(go.get_future());
    CHECK(worker.ask([may] { may.wait(); }));
    for (int i = 0; i < 100; ++i) refused += worker.ask([&done, i] { done.push_back(i); }) ? 0 : 1;
    go.set_value();
    worker.end();
    CHECK_FALSE(worker.ask([] {}));
  }
  CHECK(refused > 0);
  REQUIRE(done.size() == 100U - static_cast<unsigned>(refused));
  for (std::size_t i = 0; i < done.size(); ++i) CHECK(done[i] == static_cast<int>(i));
}
