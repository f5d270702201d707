#include "lodestone/nets/script_module.h"

#include <torch/csrc/jit/api/module.h>
#include <sstream>

#include "lodestone/common/error.h"
#include "lodestone/nets/tensors.h"

namespace lodestone::nets {

std::string encode_script(const ScriptModule& script) {
  try {
    torch::jit::Module module("LodestoneModule");
    for (const auto& [name, array] : script.constants) module.register_buffer(name, to_tensor(array));
    module.define(script.source);
    std::ostringstream bytes;
    module.save(bytes, {script.extra_files.begin(), script.extra_files.end()});
    return bytes.str();
  } catch (const std::exception& error) {
    throw common::LogicFault(std::string("TorchScript: ") + error.what());
  }
}

}  // namespace lodestone::nets
