"""A log in pixels, imported through the calibration of its camera, is where the needle was; its page lies beside it.

usage: import_map_test.py PROGRAM    by Debian's Python, which has numpy and h5py
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy

program = sys.argv[1]
folder = tempfile.TemporaryDirectory()
place = pathlib.Path(folder.name)


def lodestone(*arguments):
    return subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def pixel(camera, x_m, y_m):
    """Where the camera sees a point of the dish floor: a pinhole with radial distortion."""
    x, y, z = numpy.array(camera["rotation"]) @ [x_m, y_m, 0.0] + camera["translation_m"]
    square = (x / z) ** 2 + (y / z) ** 2
    distance = camera["focal_px"] * (1 + camera["k1"] * square + camera["k2"] * square ** 2) / z
    return numpy.array(camera["centre_px"]) + distance * numpy.array([x, y])


lodestone("calibrate", "--rendered", "--out", place / "calibration")
camera = json.loads((place / "calibration/calibration.json").read_text())
random = numpy.random.default_rng(1)
position, heading, truth = numpy.zeros(2), 0.3, []
rows = ["t [s];u [px];v [px];phi [rad];E [A];W [A];N [A];S [A]"]
for step in range(200):
    drive = random.uniform(-14, 14, 2)
    seen = pixel(camera, *position)
    ahead = pixel(camera, *position + 1e-4 * numpy.array([numpy.cos(heading), numpy.sin(heading)])) - seen
    currents = [max(drive[0], 0), max(-drive[0], 0), max(drive[1], 0), max(-drive[1], 0)]
    numbers = [0.3 * step, *seen, numpy.arctan2(ahead[1], ahead[0]), *currents]  # clockwise, as v points down
    rows.append(";".join(f"{number:.6f}".replace(".", ",") for number in numbers))
    truth.append([*position, heading])
    position, heading = 0.9 * position + 0.3e-3 * drive, heading + random.uniform(-0.3, 0.3)
(place / "log.csv").write_text("\n".join(rows) + "\n")

importing = ["import", place / "log.csv", "--out", place / "log.h5", "--map", "time=t,x=u,y=v,heading=phi,currents=E|W|N|S",
             "--calibration", place / "calibration/calibration.json", "--set", "y_down=true"]
said = lodestone(*importing)
assert f"understood   {place / 'log.html'}\n" in said, said
assert "How log.csv was understood" in (place / "log.html").read_text()
with h5py.File(place / "log.h5") as file:
    seen, period_s = file["observations"][:], file.attrs["control_period_s"]
assert abs(period_s - 0.3) < 1e-9
assert seen.shape == (200, 3), seen.shape
off = seen - numpy.array(truth)
assert abs(off[:, :2]).max() < 1e-8, abs(off[:, :2]).max()
assert abs((off[:, 2] + numpy.pi) % (2 * numpy.pi) - numpy.pi).max() < 1e-4

# Without the direction of its angles the needle points elsewhere, and nothing that is there is replaced by mistake.
again = subprocess.run([program, *map(str, importing)], capture_output=True, text=True)
assert again.returncode == 2 and "log.h5 exists already" in again.stderr, again.stderr
lodestone(*importing, "--set", "y_down=false", "--force")
with h5py.File(place / "log.h5") as file:
    assert abs(file["observations"][:, 2] - seen[:, 2]).max() > 0.1
print("a log in pixels is where the needle was")
