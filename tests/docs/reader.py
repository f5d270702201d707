"""What a page takes for granted that its reader has: recordings, descriptions, a finished quickstart. By page."""
import csv
import json
import math
import random
import shutil
import subprocess

COILS = {"+x": (1, 0), "-x": (-1, 0), "+y": (0, 1), "-y": (0, -1)}
HERE_MM = 25.0  # as far from the centre as anything lies


def write_rows(file, rows):
    with file.open("w", newline="") as out:
        csv.writer(out).writerows(rows)


def points(checkout, _):
    write_rows(checkout.root / "points.csv", [("x_m", "y_m"), (0, 0), (0.01, 0.02), (-0.015, 0.005)])


def pulses(checkout, _):
    """A sphere that a coil draws towards itself, the more the nearer it lies; weak pulses leave it."""
    draw = random.Random(1)
    rows = [("coil", "drive_percent", "x_before_mm", "y_before_mm", "x_after_mm", "y_after_mm")]
    for _ in range(1200):
        name = draw.choice(list(COILS))
        drive = draw.uniform(5, 100)
        radius, angle = HERE_MM * math.sqrt(draw.random()), draw.uniform(0, 2 * math.pi)
        x, y = radius * math.cos(angle), radius * math.sin(angle)
        far = math.hypot(75 * COILS[name][0] - x, 75 * COILS[name][1] - y)
        pull = max(0.0, drive - 15) * 2.0 / far + draw.gauss(0, 0.02)
        after = (x + pull * (75 * COILS[name][0] - x) / far, y + pull * (75 * COILS[name][1] - y) / far)
        rows.append((name, *(f"{number:.3f}" for number in (drive, x, y, *after))))
    write_rows(checkout.root / "pulses.csv", rows)


def field_samples(checkout, _):
    shutil.copy(checkout.root / "tests/physics/octomag_field.csv", checkout.root / "samples.csv")
    rig = json.loads((checkout.root / "configs/rigs/octomag.json").read_text())
    for coil in rig["coils"]["each"]:
        del coil["harmonics_T_per_A"]
    del rig["coils"]["measured"]
    (checkout.root / "cored.json").write_text(json.dumps(rig))


def six_samples(checkout, _):
    """What a gaussmeter saw of six coils that stand elsewhere than configs/rigs/six_planar.json says, in the needle's plane."""
    draw = random.Random(4)
    rig = json.loads((checkout.root / "configs/rigs/six_planar.json").read_text())
    for coil in rig["coils"]["each"]:
        coil["position_m"] = [at + draw.uniform(-0.002, 0.002) for at in coil["position_m"]]
    built, places = checkout.root / "six-built.json", checkout.root / "six-points.csv"
    built.write_text(json.dumps(rig))
    at = [(draw.uniform(-0.02, 0.02), draw.uniform(-0.02, 0.02)) for _ in range(60)]
    write_rows(places, [("x_m", "y_m"), *at])
    fields = []
    for coil in rig["coils"]["each"]:
        lodestone(checkout, "rig", "field", "--rig", built, "--coil", coil["name"], "--points", places, "--out", "six-field.csv")
        with (checkout.root / "six-field.csv").open() as file:
            fields.append([[float(row[f"B{axis}_T_per_A"]) for axis in "xyz"] for row in csv.DictReader(file)])
    rows = [("x_m", "y_m", "z_m", *(f"current_{coil + 1}_A" for coil in range(6)), "Bx_T", "By_T", "Bz_T")]
    for i, (x, y) in enumerate(at):
        current_A = [draw.uniform(0, 10) for _ in fields]
        field_T = [sum(current * field[i][axis] for current, field in zip(current_A, fields)) + draw.gauss(0, 5e-6) for axis in range(3)]
        rows.append((x, y, 0.0, *current_A, *field_T))
    write_rows(checkout.root / "six-samples.csv", rows)


def odd_log(checkout, _):
    """A log in pixels of 0.09 mm about (640, 512), y down."""
    draw = random.Random(2)
    rows = [("Time [s]", "X_px", "Y_px", "Angle [deg]", "I_east [A]", "I_west [A]", "I_north [A]", "I_south [A]")]
    x_mm = y_mm = heading_deg = 0.0
    for step in range(300):
        drives = [draw.uniform(-14, 14) for _ in range(2)]
        currents = [max(sign * drive, 0) for drive in drives for sign in (1, -1)]
        rows.append((f"{0.3 * step:.1f}", f"{640 + x_mm / 0.09:.2f}", f"{512 - y_mm / 0.09:.2f}", f"{-heading_deg:.2f}",
                     *(f"{current:.3f}" for current in currents)))
        x_mm, y_mm = 0.9 * x_mm + 0.3 * drives[0], 0.9 * y_mm + 0.3 * drives[1]
        heading_deg += draw.uniform(-17, 17)
    write_rows(checkout.root / "odd.csv", rows)


def lodestone(checkout, *words):
    subprocess.run([checkout.program, *words], cwd=checkout.root, env=checkout.environment, check=True, capture_output=True)


def imported_pulses(checkout, kept):
    pulses(checkout, kept)
    lodestone(checkout, "import", "pulses.csv", "--out", "pulses.h5")


def torchscript(checkout, _):
    lodestone(checkout, "export", "--policy", "models/any_rig", "--to", "policy.pt")


def description(file):
    """A rig.json of the reader's."""
    return lambda checkout, _: shutil.copy(checkout.root / "configs/rigs" / file, checkout.root / "my-rig.json")


def board_photos(checkout, _):
    subprocess.run(["/usr/bin/python3", checkout.root / "tests/docs/board_photos.py", checkout.program, checkout.root], cwd=checkout.root,
                   env={**checkout.environment, "PYTHONPATH": str(checkout.program.parents[1] / "python")}, check=True)


def quickstart(checkout, kept):
    shutil.copytree(kept / "quickstart", checkout.root / "runs/quickstart")


def old_run(checkout, kept):
    shutil.copytree(kept / "quickstart/deploy", checkout.root / "runs/old")


HAS = {
    "docs/beyond-the-paper.md": [description("paper.json")],
    "docs/bring-your-own-rig.md": [points, field_samples, six_samples],
    "docs/deploy-safely.md": [quickstart],
    "docs/drive-a-bench.md": [quickstart, description("serial.json")],
    "docs/export.md": [imported_pulses, torchscript],
    "docs/logs.md": [old_run],
    "docs/see-the-needle.md": [quickstart, description("paper.json"), board_photos],
    "docs/train-fast.md": [quickstart],
    "docs/train-from-your-logs.md": [pulses, odd_log],
}

# What pieces of code presuppose, by page and how they begin.
BEFORE_CODE = {
    ("docs/export.md", 'files = {"contract.json"'):
        """import json, torch
description = {"contract.json": ""}
torch.jit.load("policy.pt", _extra_files=description)
pose, target, drive_gain, memory = (torch.zeros(1, len(each["elements"])) for each in json.loads(description["contract.json"])["inputs"].values())
""",
}


def faults(texts):
    """Pages that are not there any more."""
    pages = {*HAS, *(page for page, _ in BEFORE_CODE)}
    return [f"{page}: reader.py of tests/docs has something for it, but there is no such page" for page in sorted(pages - texts.keys())] + [
        f"{page}: reader.py of tests/docs has {beginning!r}, which is not in the page any more"
        for page, beginning in BEFORE_CODE if page in texts and beginning not in texts[page]]
