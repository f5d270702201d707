#include "onnx_columns.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "lodestone/common/files.h"
#include "lodestone/common/json.h"
#include "lodestone/common/shell.h"
#include "temporary_folder.h"

using namespace lodestone;

TEST_CASE("columns are taken, measured and put side by side in ONNX Runtime", "[unit]") {
  inference::OnnxModel model("columns");
  exports::OnnxColumns g(model);
  model.input({"x", {"batch", std::int64_t{4}}});
  const std::string vectors = g.reshaped("x", {0, 2, 2});
  const std::string lengths = g.length(vectors, false);
  const std::string long_ones = g.above(lengths, 6.0);
  const std::string some = g.any(long_ones, true);
  const std::string picked = g.where(some, g.columns("x", 1, 2), g.constant({7.0F, 8.0F}, {1, 2}));
  model.node("Identity", {g.row({lengths, g.as_float(some), g.scaled(picked, 2.0)})}, {}, "y");
  model.output({"y", {"batch", std::int64_t{5}}});

  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "columns.onnx", model.encode());
  const common::Json inputs = {{"x", {{"shape", {2, 4}}, {"numbers", {3, 4, 6, 8, 0, 1, 3, 4}}}}};
  common::write_file_atomically(folder / "inputs.json", inputs.dump());
  const common::CommandResult run =
      common::run_command({"node", LODESTONE_SOURCE_DIR "/tests/node/onnx_outputs.js",
                           folder / "columns.onnx", folder / "inputs.json"});
  INFO(run.output);
  REQUIRE(run.exit_code == 0);
  CHECK(common::Json::parse(run.output).at("y").at("numbers").get<std::vector<float>>() ==
        std::vector<float>{5, 10, 1, 8, 12, 1, 5, 0, 14, 16});
}
