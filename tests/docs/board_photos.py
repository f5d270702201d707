"""What somebody would photograph: shots/*.png and a video of the printed board, tilted this way and that, and dish.png of the virtual rig.

usage: board_photos.py LODESTONE CHECKOUT    where PYTHONPATH has the package; by Debian's Python, which has numpy and Pillow
"""
import pathlib
import subprocess
import sys

import lodestone
import numpy
from PIL import Image, ImageFilter

program, root = sys.argv[1], pathlib.Path(sys.argv[2])

LENS = numpy.array([[4717.0, 0, 640], [0, 4717.0, 512], [0, 0, 1]])  # of the virtual rig, as the configuration has it
DISTANCE_M, PIXELS_PER_M = 0.4717, 600 / 0.0254
TILTS_RAD = ((0, 0, 0.05), (0.45, 0, 0), (-0.45, 0.1, 0.3), (0, 0.45, -0.2), (0.1, -0.45, 0.1), (0.3, 0.3, 0.6))


def turned(x, y, z):
    def about(axis, angle):
        turn = numpy.eye(3)
        one, other = [i for i in range(3) if i != axis]
        turn[one, one] = turn[other, other] = numpy.cos(angle)
        turn[one, other], turn[other, one] = -numpy.sin(angle), numpy.sin(angle)
        return turn
    return numpy.diag([1, -1, -1]) @ about(0, x) @ about(1, y) @ about(2, z)


subprocess.run([program, "calibrate", "--print-board", root / "printed.png"], check=True, capture_output=True)
board = Image.open(root / "printed.png").convert("L").filter(ImageFilter.GaussianBlur(1.2))
(root / "printed.png").unlink()
to_print = numpy.array([[PIXELS_PER_M, 0, board.width / 2], [0, -PIXELS_PER_M, board.height / 2], [0, 0, 1]])
(root / "shots").mkdir()
for number, tilt in enumerate(TILTS_RAD):
    turn = turned(*tilt)
    seen = LENS @ numpy.column_stack([turn[:, 0], turn[:, 1], [0, 0, DISTANCE_M]])
    back = to_print @ numpy.linalg.inv(seen)
    photo = board.transform((1280, 1024), Image.PERSPECTIVE, tuple((back / back[2, 2]).flatten()[:8]), Image.BICUBIC, fillcolor=128)
    photo.save(root / f"shots/{number}.png")
    with (root / "board.mjpeg").open("ab") as video:  # one picture after the other
        for _ in range(3):
            photo.save(video, "JPEG", quality=95)

rig = lodestone.RigEnv(render_mode="rgb_array", task="centre")
rig.reset(seed=1)
Image.fromarray(rig.render()).save(root / "dish.png")
