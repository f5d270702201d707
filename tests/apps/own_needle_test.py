"""A segmenter learns a needle of one's own from a film of it: labels proposed, looked through, learned from.
usage: own_needle_test.py LODESTONE SOURCE"""
import json
import pathlib
import subprocess
import sys
import tempfile

program, source = sys.argv[1], pathlib.Path(sys.argv[2])


def run(*arguments, code=0):
    made = subprocess.run([program, *map(str, arguments), "--no-reexec"], capture_output=True, text=True)
    assert made.returncode == code, f"{arguments}\n{made.stdout}\n{made.stderr}"
    return made.stdout + made.stderr


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    film = folder / "needle.avi"
    run("calibrate", "--film", film, "--out", folder / "no", code=2)
    run("calibrate", "--rendered", "--seed", 5, "--set", "scene.tape_hue_deg=[22,28]", "--film", film, "--places", 24, "--out",
        folder / "calibration")
    small = ("--set", "training.samples=16", "--set", "training.validation_samples=8", "--set", "training.evaluation_samples=4",
             "--set", "training.epochs=1", "--set", "training.batch_size=8", "--set", "frames.crops=2", "--set", "frames.corrected=5")
    common = ("train-segmenter", *small, "--set", f"frames.from={source}/models/segmenter", "--frames", film, "--calibration",
              folder / "calibration/calibration.json")
    text = run(*common, "--out", folder / "needle")
    assert "labels.html" in text and "--labels labels.json" in text, text
    labels = json.loads((folder / "needle/labels.json").read_text())
    assert len(labels["labels"]) == 24 and labels["taped"], labels
    assert sum("pose" in label for label in labels["labels"]) >= 20, labels
    page = (folder / "needle/labels.html").read_text()
    assert page.count('"jpeg"') == 5, page.count('"jpeg"')
    text = run(*common, "--out", folder / "needle", code=2)
    assert "labels.json is there already" in text, text

    # What a person has said of an image counts.
    for label in labels["labels"][:3]:
        label["pose"], label["by_person"] = None, True
    (folder / "mine.json").write_text(json.dumps(labels))
    text = run(*common, "--labels", folder / "mine.json", "--out", folder / "segmenter")
    frames = json.loads((folder / "segmenter/evaluation.json").read_text())["frames"]
    assert frames["before"]["n"] == frames["after"]["n"] >= 5, frames
    assert "of images that were held back" in text, text
    assert (folder / "segmenter/checkpoint/manifest.json").exists()
    text = run(*common, "--set", "frames.count=12", "--labels", folder / "mine.json", "--out", folder / "other", code=1)
    assert "has 24 labels, and there are 12 images" in text, text
