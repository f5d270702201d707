#include "lodestone/data/dataset_info.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;
using Catch::Matchers::Contains;

TEST_CASE("what a recording says of itself comes back, and what is missing is named") {
  data::DatasetInfo info;
  info.layout = data::StateLayout::kPosition;
  info.action_unit = "percent";
  info.action_scale = 100.0;
  info.one_axis_at_a_time = true;
  info.rig = {{"dish", {{"radius_m", 0.0425}}}};
  common::Json json = data::info_to_json(info);
  const data::DatasetInfo back = data::info_from_json(json, "a.journal");
  CHECK(data::info_to_json(back) == json);
  CHECK(back.layout == info.layout);
  CHECK(back.one_axis_at_a_time);
  json["layout"] = "round";
  CHECK_THROWS_WITH(data::info_from_json(json, "a.journal"), Contains("a.journal") && Contains("round"));
  json = data::info_to_json(info);
  json.erase("action_scale");
  CHECK_THROWS_WITH(data::info_from_json(json, "a.journal"), Contains("action_scale"));
}
