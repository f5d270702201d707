#include "lodestone/nets/script_module.h"

#include <torch/csrc/jit/serialization/import.h>
#include <catch2/catch.hpp>
#include <sstream>

#include "lodestone/common/error.h"
#include "lodestone/nets/tensors.h"

using namespace lodestone;

TEST_CASE("a script is read by LibTorch with its constants and the files beside it", "[unit]") {
  nets::ScriptModule script;
  script.source =
      "def twice(self, x):\n    return 2.0 * x\n\ndef forward(self, x):\n    return self.twice(x) + "
      "self.step\n";
  script.constants["step"] = {std::vector<float>{1.0F, -1.0F}, {2}};
  script.extra_files["what.json"] = "{\"unit\": \"A\"}";
  std::istringstream bytes(nets::encode_script(script));
  torch::jit::ExtraFilesMap files = {{"what.json", ""}};
  torch::jit::Module module = torch::jit::load(bytes, c10::nullopt, files);
  CHECK(files.at("what.json") == "{\"unit\": \"A\"}");
  const at::Tensor out = module.forward({nets::tensor_from({3.0, 4.0}, {1, 2}, at::kFloat)}).toTensor();
  CHECK(nets::to_vector(out) == std::vector<double>{7.0, 7.0});
}

TEST_CASE("a script that is none is a fault of the program", "[unit]") {
  CHECK_THROWS_AS(nets::encode_script({"def forward(self, x):\n    return nothing(x)\n", {}, {}}),
                  common::LogicFault);
}
