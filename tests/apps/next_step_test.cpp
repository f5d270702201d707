#include "next_step.h"

#include <catch2/catch.hpp>
#include <map>

using lodestone::apps::next_step;

namespace {

std::string after(const std::string& verb, const std::map<std::string, std::string>& given) {
  return next_step(verb, [&given](const std::string& option) {
    const auto found = given.find(option);
    return found == given.end() ? "" : found->second;
  });
}

}  // namespace

TEST_CASE("the steps of a run lie side by side in its folder") {
  CHECK(after("collect", {{"--out", "runs/a/collect"}}) ==
        "lodestone train-dynamics --set data=runs/a/collect/transitions.h5 --out runs/a/dynamics");
  CHECK(after("train-dynamics", {{"--out", "dynamics"}}) ==
        "lodestone train-policy --set dynamics=dynamics/checkpoint --out ./policy");
}

TEST_CASE("a deployment is reported with its run, or as one of its own") {
  CHECK(after("deploy", {{"--out", "runs/a/deploy"}}) == "lodestone report --run runs/a");
  CHECK(after("deploy", {{"--out", "runs/square"}}) == "lodestone report --run runs/square");
}

TEST_CASE("the first line whose options were given is said, and none is invented") {
  CHECK(after("report", {{"--run", "runs/a"}, {"--out", "page.html"}}).rfind("open page.html", 0) == 0);
  CHECK(after("report", {{"--run", "runs/a"}}).rfind("open runs/a/report.html", 0) == 0);
  CHECK(after("calibrate", {{"--out", "c"}}).rfind("look at c/overlay.png", 0) == 0);
  CHECK(after("rig check", {}).empty());
  CHECK(after("config", {{"--print", "deploy"}}).empty());
}
