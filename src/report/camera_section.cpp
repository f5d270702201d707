#include "lodestone/common/base64.h"
#include "lodestone/report/html.h"
#include "sections.h"

namespace lodestone::report {

std::string camera_section(const RunData& run) {
  std::string panels;
  for (const FilmedTrial& trial : run.filmed) {
    panels += "<figure><img alt=\"The last camera image of " + escape(trial.name) +
              ", with dish, needle, way and currents drawn in" + "\" src=\"data:image/jpeg;base64," +
              common::base64(trial.last_image) + "\"><figcaption>" + escape(trial.name) +
              "</figcaption></figure>\n";
  }
  return "<p>The last image of filmed trials, as the camera gave it to the localiser, with what the "
         "controller "
         "believed drawn in: the dish where the calibration puts it (white), the estimated needle (orange, "
         "its "
         "head yellow), the way so far, the target or path, and the currents of the last pulse. The videos "
         "lie "
         "beside the run's other files, in deploy/videos.</p>\n<div class=\"panels\">" +
         panels + "</div>";
}

}  // namespace lodestone::report
