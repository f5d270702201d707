#include "next_step.h"

#include <catch2/catch.hpp>

using lodestone::apps::next_step;

TEST_CASE("the steps of a run lie side by side in its folder") {
  CHECK(next_step("collect", {{"--out", "runs/a/collect"}}) ==
        "lodestone train-dynamics --set data=runs/a/collect/transitions.h5 --out runs/a/dynamics");
  CHECK(next_step("train-dynamics", {{"--out", "dynamics"}}) ==
        "lodestone train-policy --set dynamics=dynamics/checkpoint --out ./policy");
}

TEST_CASE("a policy that wants to know its rig's gain is deployed with the simulator that identifies it") {
  std::map<std::string, std::string> given = {
      {"--out", "r/policy"}, {"dynamics", "d"}, {"encoder.drive_gain", "true"}};
  CHECK(next_step("train-policy", given) ==
        "lodestone deploy --policy r/policy/checkpoint --set dynamics=d --task all --out r/deploy");
  given["encoder.drive_gain"] = "false";
  CHECK(next_step("train-policy", given) ==
        "lodestone deploy --policy r/policy/checkpoint --task all --out r/deploy");
}

TEST_CASE("a deployment is reported with its run, or as one of its own") {
  CHECK(next_step("deploy", {{"--out", "runs/a/deploy"}}) == "lodestone report --run runs/a");
  CHECK(next_step("deploy", {{"--out", "runs/square"}}) == "lodestone report --run runs/square");
}

TEST_CASE("proposed labels are looked through, and what has learned from them is evaluated") {
  std::map<std::string, std::string> given = {
      {"--out", "n"}, {"frames.source", "needle.avi"}, {"frames.labels", ""}};
  CHECK(next_step("train-segmenter", given) == "look through n/labels.html: what was told of needle.avi");
  given["frames.labels"] = "labels.json";
  CHECK(next_step("train-segmenter", given) == "lodestone evaluate segmenter --checkpoint n/checkpoint");
  CHECK(next_step("train-segmenter", {{"--out", "n"}, {"frames.source", ""}, {"frames.labels", ""}}) ==
        "lodestone evaluate segmenter --checkpoint n/checkpoint");
}

TEST_CASE("the first line whose options were given is said, and none is invented") {
  CHECK(next_step("report", {{"--run", "runs/a"}, {"--out", "page.html"}}).rfind("open page.html", 0) == 0);
  CHECK(next_step("report", {{"--run", "runs/a"}}).rfind("open runs/a/report.html", 0) == 0);
  CHECK(next_step("calibrate", {{"--out", "c"}}).rfind("look at c/overlay.png", 0) == 0);
  CHECK(next_step("rig check", {}).empty());
  CHECK(next_step("config", {{"--print", "deploy"}}).empty());
}
