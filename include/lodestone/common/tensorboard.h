#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace lodestone::common {

/// Writes scalars as a TensorBoard event file (TFRecord framing with masked CRC-32C around Event messages;
/// format: tensorflow/core/util/event.proto and lib/io/record_writer).
class TensorBoardWriter {
 public:
  /// Creates `folder`/events.out.tfevents.<time>.lodestone. Throws IoError.
  explicit TensorBoardWriter(const std::string& folder);
  void write(std::int64_t step, const std::vector<std::pair<std::string, double>>& scalars);

 private:
  void write_record(const std::string& event);
  std::ofstream file_;
};

}  // namespace lodestone::common
