#include "lodestone/common/metrics.h"

#include <cmath>

#include "lodestone/common/clock.h"
#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/common/tensorboard.h"

namespace lodestone::common {

MetricsLog::MetricsLog(const std::string& folder)
    : path_(folder + "/metrics.jsonl"),
      lines_(path_, std::ios::app),
      events_(std::make_unique<TensorBoardWriter>(folder)),
      start_s_(SteadyClock().now_s()) {
  if (!lines_) throw IoError("cannot write " + path_);
}

MetricsLog::~MetricsLog() = default;

void MetricsLog::write(std::int64_t step, const Scalars& scalars) {
  Json line = {{"step", step}, {"wall_s", std::round((SteadyClock().now_s() - start_s_) * 1e3) / 1e3}};
  for (const auto& [name, value] : scalars) line[name] = value;
  lines_ << line.dump() << std::endl;
  if (!lines_) throw IoError("cannot write " + path_ + ": is the disk full?");
  events_->write(step, scalars);
}

void MetricsLog::write_image(std::int64_t step, const std::string& tag, std::string_view png,
                             std::int64_t width, std::int64_t height) {
  events_->write_image(step, tag, png, width, height);
}

}  // namespace lodestone::common
