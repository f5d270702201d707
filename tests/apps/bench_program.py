"""What the tests on an emulated bench share: the program, as somebody with a real one calls it.
Their arguments begin with LODESTONE SOURCE."""
import os
import pathlib
import subprocess
import sys
import tempfile
import time

lodestone, source = sys.argv[1], pathlib.Path(sys.argv[2])
folder = pathlib.Path(tempfile.mkdtemp(prefix="lodestone-bench-"))
os.chdir(source)  # the shipped segmenter lies here

# A bench's user is seldom root, who may do what others may not: take a port that another holds, go before other
# threads, read any file. Where the tests run as root, the bench and who uses it are somebody without rights.
NOBODY = 65534
as_user = []
if os.geteuid() == 0:
    os.chown(folder, NOBODY, NOBODY)
    os.environ.update(HOME=str(folder), XDG_RUNTIME_DIR=str(folder))
    as_user = ["setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups"]
    if subprocess.run([*as_user, "test", "-x", lodestone, "-a", "-r", source / "models"]).returncode != 0:
        print("the checkout lies where only root may read: tested as root")
        as_user = []

# A machine that is busy with something else may be late; that is not what is tested here.
patient = ["--set", "safety.max_late_s=1", "--set", "safety.max_late_steps=10", "--set", "safety.max_pose_age_s=2"]


def run(*arguments, code=0, env=None, timeout=120):
    done = subprocess.run([*as_user, lodestone, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=timeout, env={**os.environ, **(env or {})})
    text = done.stdout + done.stderr
    assert done.returncode == code, f"{arguments}: exit {done.returncode}, expected {code}\n{text}"
    return text


def expect(text, *parts):
    for part in parts:
        assert part in text, f"{part!r} is missing in:\n{text}"


def start(*arguments, **options):
    return subprocess.Popen([*as_user, lodestone, *map(str, arguments)], stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)


def wait_for(path, process, seconds=60):
    end = time.time() + seconds
    while not path.exists():
        assert process.poll() is None, process.stdout.read()
        assert time.time() < end, f"{path} does not come"
        time.sleep(0.1)
