#pragma once
// Every message that a page may send, as docs/console-protocol.md lists them: what fuzzing spoils.
#include <string>
#include <vector>

namespace lodestone::tests {

inline std::vector<std::string> sample_messages() {
  return {
      R"({"do": "more", "of": "image"})",
      R"({"do": "more", "of": "state"})",
      R"({"do": "beat", "visible": true, "focused": true})",
      R"({"do": "stop", "by": "button"})",
      R"({"do": "operate"})",
      R"({"do": "yield"})",
      R"({"do": "refuse"})",
      R"({"do": "arm"})",
      R"({"do": "disarm"})",
      R"({"do": "rearm", "reason": "the needle left the fence", "clears": true})",
      R"({"do": "controller", "name": "planner"})",
      R"({"do": "unattended", "on": true})",
      R"({"do": "go", "to": [0.5, 0.25], "towards": [0.75, 0.5]})",
      R"({"do": "draw", "points": [[0.25, 0.5], [0.5, 0.5], [0.75, 0.25]], "closed": false})",
      R"({"do": "draw", "csv": "x_m,y_m\n0.01,0\n0,0.01\n-0.01,0\n"})",
      R"({"do": "draw", "shape": "square"})",
      R"({"do": "follow"})",
      R"({"do": "hand", "drive": [0.5, -1]})",
      R"({"do": "end"})",
      R"({"do": "place"})",
      R"({"do": "record", "on": true})",
      R"({"do": "runs"})",
      R"({"do": "replay", "name": "a"})",
      R"({"do": "job", "verb": "collect"})",
      R"({"do": "job", "verb": null})",
      R"({"do": "answer", "yes": true})",
  };
}

}  // namespace lodestone::tests
