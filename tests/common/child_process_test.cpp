#include "lodestone/common/child_process.h"

#include <catch2/catch.hpp>

using lodestone::common::ChildProcess;

namespace {
std::string all_of(ChildProcess& child) {
  std::string text;
  while (const auto part = child.read(10.0)) text += *part;
  return text;
}
}  // namespace

TEST_CASE("a child is heard to its end, and says how it ended") {
  ChildProcess child({"/bin/sh", "-c", "echo out; echo err >&2; exit 3"});
  const std::string text = all_of(child);
  CHECK(text.find("out") != std::string::npos);
  CHECK(text.find("err") != std::string::npos);
  CHECK(child.finish() == 3);
}

TEST_CASE("a child is interrupted as by Ctrl-C, and does not outlive who listens") {
  {
    ChildProcess child(
        {"/bin/sh", "-c", "trap 'echo asked; exit 130' INT; echo ready; while :; do sleep 0.01; done"});
    std::string text;
    while (text.find("ready") == std::string::npos) text += child.read(10.0).value();
    child.interrupt();
    CHECK(all_of(child).find("asked") != std::string::npos);
    CHECK(child.finish() == 130);
  }
  ChildProcess forgotten({"/bin/sleep", "1000"});
}

TEST_CASE("a program that is not there") {
  ChildProcess child({"/nowhere/at/all"});
  CHECK(all_of(child).empty());
  CHECK(child.finish() == 127);
}
