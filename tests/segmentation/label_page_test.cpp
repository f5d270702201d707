#include "lodestone/segmentation/label_page.h"

#include <catch2/catch.hpp>

#include "lodestone/common/files.h"
#include "segmentation/own_frames.h"
#include "temporary_folder.h"

using namespace lodestone;

TEST_CASE("the page holds images and labels, and no name breaks out of it") {
  const tests::TemporaryFolder folder;
  tests::OwnFrames own = tests::own_frames(10);
  own.frames.names[3] = "</script><b>3";
  const segmentation::FrameLabels labels = segmentation::propose_labels(own.frames, own.bench);
  const std::string file = folder / "labels.html";
  segmentation::write_label_page(file, own.frames, labels, {3, 7}, own.bench, "lodestone <go on>");
  const std::string page = common::read_file(file);
  CHECK(page.find("</script><b>") == std::string::npos);
  CHECK(page.find("\\u003c/script>\\u003cb>3") != std::string::npos);
  CHECK(page.find("lodestone &lt;go on>") != std::string::npos);
  std::size_t images = 0;
  for (std::size_t at = page.find("\"jpeg\""); at != std::string::npos; at = page.find("\"jpeg\"", at + 1))
    ++images;
  CHECK(images == 2);
}
