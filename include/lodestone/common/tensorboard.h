#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lodestone/common/json.h"

namespace lodestone::common {

/// Writes scalars, images, text and hyperparameters as a TensorBoard event file (TFRecord framing with masked
/// CRC-32C around Event messages; formats: tensorflow/core/util/event.proto and lib/io/record_writer,
/// tensorboard/compat/proto/summary.proto, tensorboard/plugins/hparams/plugin_data.proto).
class TensorBoardWriter {
 public:
  /// Creates `folder`/events.out.tfevents.<time>.lodestone. Throws IoError.
  explicit TensorBoardWriter(const std::string& folder);
  /// A resumed run begins: what earlier files of the folder hold from this step on is not shown.
  void start_at(std::int64_t step);
  /// Throws IoError when the disk is full, as write_image() does.
  void write(std::int64_t step, const std::vector<std::pair<std::string, double>>& scalars);
  /// `png`: a whole PNG file of 8-bit RGB, `width` x `height` pixels. Throws LogicFault when it is no PNG.
  void write_image(std::int64_t step, const std::string& tag, std::string_view png, std::int64_t width,
                   std::int64_t height);
  /// What the Text page shows, as Markdown.
  void write_text(std::int64_t step, const std::string& tag, const std::string& markdown);
  /// A row of the HParams page begins: `settings` is an object of numbers, bools and text. Its figures are
  /// the last scalars of every tag.
  void start_session(const Json& settings);
  /// It has ended well; without this it counts as one that still runs.
  void end_session();

 private:
  void write_plugin(std::int64_t step, const std::string& tag, const std::string& tensor,
                    const std::string& plugin, const std::string& content);
  void write_summary(std::int64_t step, const std::string& summary);
  void write_record(const std::string& event);
  std::ofstream file_;
};

}  // namespace lodestone::common
