#include "lodestone/console/seat.h"

#include <catch2/catch.hpp>

using lodestone::console::Seat;

TEST_CASE("the first who asks operates, the second has to be given the seat") {
  Seat seat;
  CHECK(seat.ask(1, 0.0));
  CHECK(seat.ask(1, 0.0));
  seat.beat(1, 1.0);
  CHECK_FALSE(seat.ask(2, 1.0));
  CHECK(seat.asking() == 2);
  CHECK_FALSE(seat.ask(3, 1.0));  // one question at a time
  CHECK(seat.asking() == 2);
  seat.refuse(3);  // not asked
  CHECK(seat.asking() == 2);
  SECTION("refused") {
    seat.refuse(1);
    CHECK_FALSE(seat.asking());
    CHECK(seat.operates(1));
  }
  SECTION("yielded") {
    seat.yield(2, 1.5);  // not the operator's word
    CHECK(seat.operates(1));
    seat.yield(1, 1.5);
    CHECK(seat.operates(2));
  }
  SECTION("no answer") {
    for (double now_s = 1.5; now_s < 15.9; now_s += 0.5) {
      seat.beat(1, now_s);
      CHECK_FALSE(seat.settle(now_s));
    }
    CHECK(seat.settle(16.1));
    CHECK(seat.operates(2));
  }
  SECTION("gone") {
    CHECK_FALSE(seat.settle(2.9));
    CHECK(seat.settle(3.1));
    CHECK(seat.operates(2));
  }
  SECTION("the operator closes the page") {
    seat.leave(1, 1.2);
    CHECK(seat.operates(2));
    seat.leave(2, 1.3);
    CHECK_FALSE(seat.operating());
  }
  SECTION("who asked closes the page") {
    seat.leave(2, 1.2);
    CHECK_FALSE(seat.asking());
    CHECK(seat.operates(1));
  }
}

TEST_CASE("a seat whose operator is gone is free for who asks") {
  Seat seat;
  CHECK(seat.ask(1, 0.0));
  CHECK(seat.ask(2, 2.1));
}
