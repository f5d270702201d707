#pragma once

#include <map>
#include <string>

#include "lodestone/inference/array.h"

namespace lodestone::nets {

/// A network for programs that run TorchScript.
struct ScriptModule {
  std::string source;           ///< its methods, in TorchScript (Python's syntax); one of them is forward
  inference::Arrays constants;  ///< what they read as self.NAME
  std::map<std::string, std::string> extra_files;  ///< kept beside it in the file
};

/// The content of the file that torch::jit::load and torch.jit.load read. Throws LogicFault, with LibTorch's
/// words, where the source is not TorchScript.
std::string encode_script(const ScriptModule& script);

}  // namespace lodestone::nets
