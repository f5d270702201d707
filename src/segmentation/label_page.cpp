#include "lodestone/segmentation/label_page.h"

#include "lodestone/common/artefact.h"
#include "lodestone/common/base64.h"
#include "lodestone/common/files.h"
#include "lodestone/imaging/image_file.h"

namespace lodestone::segmentation {
namespace {

constexpr const char* kHead = R"html(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Labels of the needle</title>
<style>
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 1200px; margin: 2rem auto; padding: 0 1rem; }
#images { display: grid; grid-template-columns: repeat(auto-fill, minmax(300px, 1fr)); gap: 1.5rem; }
figure { margin: 0; }
canvas { width: 100%; display: block; cursor: crosshair; }
figcaption { overflow-wrap: anywhere; }
button { font: inherit; padding: .3rem .8rem; margin: .3rem .3rem 0 0; }
pre { overflow-x: auto; }
</style>
</head>
<body>
<h1>Is this the needle?</h1>
<p>A line lies along the needle as it was found, its dot on the head (the end with the tape). Where that is wrong: <b>Flip</b> turns it round; two
clicks into the image draw it anew, the head first; <b>No needle</b> takes it away. Images whose label is right need nothing.</p>
<p><button id="save" type="button">Save labels.json</button> <span id="said"></span></p>
<div id="images"></div>
<p>Then:</p>
)html";

constexpr const char* kScript = R"html(<script>
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const middle = 0.5 * data.size_px;  // of the canvas, where a pixel reaches from its number to the next
const toPixel = (x, y) => [middle + x / data.pixel_m, middle - y / data.pixel_m];

function show(place) {
  const label = data.labels.labels[place.index];
  const figure = document.createElement("figure");
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 2 * data.size_px;
  const caption = document.createElement("figcaption");
  const image = new Image();
  let first = null;
  const draw = () => {
    const pen = canvas.getContext("2d");
    pen.setTransform(2, 0, 0, 2, 0, 0);
    pen.drawImage(image, 0, 0);
    const words = first ? "now click the tail" : label.pose ? "" : label.by_person ? "no needle" : label.reason || "no needle";
    caption.textContent = label.frame + (words ? ": " + words : "");
    const dot = (u, v) => { pen.beginPath(); pen.arc(u, v, 3, 0, 7); pen.fillStyle = "#f0e442"; pen.fill(); };
    if (first) return dot(...first);
    if (!label.pose) return;
    const [u, v] = toPixel(label.pose.x_m, label.pose.y_m);
    const half = data.half_m / data.pixel_m;
    const du = half * Math.cos(label.pose.heading_rad), dv = -half * Math.sin(label.pose.heading_rad);
    pen.beginPath();
    pen.moveTo(u - du, v - dv);
    pen.lineTo(u + du, v + dv);
    pen.strokeStyle = "#d55e00";
    pen.stroke();
    dot(u + du, v + dv);
  };
  const button = (words, act) => {
    const made = document.createElement("button");
    made.type = "button";
    made.textContent = words;
    made.addEventListener("click", () => { first = null; act(); draw(); });
    return made;
  };
  canvas.addEventListener("click", (event) => {
    const box = canvas.getBoundingClientRect();
    const at = [(event.clientX - box.left) * data.size_px / box.width, (event.clientY - box.top) * data.size_px / box.height];
    if (first === null) {
      first = at;
    } else {
      const [head, tail] = [first, at];
      first = null;
      label.pose = {
        x_m: (0.5 * (head[0] + tail[0]) - middle) * data.pixel_m, y_m: (middle - 0.5 * (head[1] + tail[1])) * data.pixel_m,
        heading_rad: Math.atan2(tail[1] - head[1], head[0] - tail[0])};
    }
    draw();
  });
  image.addEventListener("load", draw);
  image.src = "data:image/jpeg;base64," + place.jpeg;
  figure.append(canvas, caption,
    button("Flip", () => { if (label.pose) label.pose.heading_rad += label.pose.heading_rad > 0 ? -Math.PI : Math.PI; }),
    button("No needle", () => { label.pose = null; label.by_person = true; }));
  document.getElementById("images").append(figure);
}

data.shown.forEach(show);
document.getElementById("save").addEventListener("click", () => {
  for (const place of data.shown) data.labels.labels[place.index].by_person = true;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([JSON.stringify(data.labels, null, 1)], {type: "application/json"}));
  link.download = "labels.json";
  link.click();
  document.getElementById("said").textContent = "saved where your browser keeps downloads";
});
</script>
</body>
</html>
)html";

/// Text between tags.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

/// JSON inside a script element, which a name with "</script>" would end.
std::string inside_script(const common::Json& json) {
  std::string out;
  for (const char c : json.dump()) out += c == '<' ? "\\u003c" : std::string(1, c);
  return out;
}

}  // namespace

void write_label_page(const std::string& file, const FrameViews& frames, const FrameLabels& labels,
                      const std::vector<std::size_t>& shown, const imaging::BenchGeometry& bench,
                      const std::string& go_on) {
  common::Json data;
  data["labels"] = common::artefact_to_json(labels);
  data["size_px"] = frames.view.size_px();
  data["pixel_m"] = frames.view.pixel_m();
  data["half_m"] = 0.5 * bench.needle_length_m;
  data["shown"] = common::Json::array();
  for (const std::size_t index : shown)
    data["shown"].push_back(
        {{"index", index}, {"jpeg", common::base64(imaging::encoded_image(frames.images[index], ".jpg"))}});
  common::write_file_atomically(file, std::string(kHead) + "<pre>" + plain(go_on) + "</pre>\n" +
                                          "<script type=\"application/json\" id=\"data\">" +
                                          inside_script(data) + "</script>\n" + kScript);
}

}  // namespace lodestone::segmentation
