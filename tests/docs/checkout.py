"""The reader's machine: a checkout of this tree with what was built of it, a home, and a shell in which a page's lines are run."""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

import shorter

HERE = pathlib.Path(__file__).resolve().parent

SHORTER_PROGRAM = """#!{python}
import os, sys
sys.path.insert(0, {here!r})
import shorter
os.execv({program!r}, [{program!r}, *shorter.shortened({page!r}, sys.argv[1:])])
"""

# In the sample nothing is built again: presets and targets are looked up.
CMAKE_OF_THE_SAMPLE = """#!{python}
import os, subprocess, sys
words = sys.argv[1:]
def there(*command, line=None):
    told = subprocess.run(command, capture_output=True, text=True)
    if told.returncode != 0 or (line is not None and line not in told.stdout):
        sys.exit("cmake: no " + " ".join(words) + "\\n" + told.stdout + told.stderr)
if words[:1] == ["--install"]:
    os.execv({cmake!r}, [{cmake!r}, *words])
if len(words) == 2 and words[0] == "--preset":
    there({cmake!r}, "--list-presets", line='"' + words[1] + '"')
elif len(words) == 3 and words[:2] == ["--build", "--preset"]:
    there({cmake!r}, "--build", "--list-presets", line='"' + words[2] + '"')
elif len(words) == 4 and words[0] == "--build" and words[2] == "--target":
    there("ninja", "-C", words[1], "-t", "query", words[3])
else:
    sys.exit("the cmake of tests/docs/checkout.py does not know: " + " ".join(words))
"""

# scripts/bench-python takes this for its interpreter: fewer environments, one round of a second.
PYTHON_OF_THE_SAMPLE = """#!/bin/sh
exec /usr/bin/python3 "$@" 64 1 1
"""


def write_program(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(0o755)


class Checkout:
    """`whole`: nothing is shortened, and what the pages say to build is built."""

    def __init__(self, folder, source, build, python_packages, whole):
        self.root, self.home, self.tools = folder / "lodestone", folder / "home", folder / "bin"
        self.pristine, self.state, self.outputs = folder / "pristine", folder / "environment", folder / "outputs"
        self.program, self.whole, self.page = build / "apps/lodestone", whole, ""
        self.servers = []
        for each in (self.root, self.home, self.tools, self.pristine, self.outputs):
            each.mkdir(parents=True)
        listed = subprocess.run(["git", "-C", source, "ls-files", "-z", "--cached", "--others", "--exclude-standard"], check=True, stdout=subprocess.PIPE)
        for name in listed.stdout.decode().split("\0"):
            if (source / name).is_file():
                (self.pristine / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(source / name, self.pristine / name)
        self.environment = {name: value for name, value in os.environ.items()
                            if not name.startswith(("LODESTONE_", "PYTHON")) and name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        self.environment.update(HOME=str(self.home), PATH=f"{self.tools}:{os.environ['PATH']}", PYTHONDONTWRITEBYTECODE="1")
        self.install_packages(python_packages)
        (self.root / "build").mkdir()
        (self.tools / "lodestone").symlink_to(self.root / "build/release/apps/lodestone")
        if not whole:
            self.take_build(build)

    def install_packages(self, folder):
        """Gymnasium and the others, as if the reader had installed them."""
        site = subprocess.run(["/usr/bin/python3", "-c", "import site; print(site.getusersitepackages())"], env=self.environment, check=True,
                              stdout=subprocess.PIPE, text=True).stdout.strip()
        pathlib.Path(site).mkdir(parents=True)
        (pathlib.Path(site) / "lodestone_tests.pth").write_text(f"{folder}\n")

    def take_build(self, build):
        """build/dev is what has been built for the tests, and so is build/release, but for the program."""
        (self.root / "build/dev").symlink_to(build)
        release = self.root / "build/release"
        release.mkdir()
        for each in build.iterdir():
            if each.name != "apps":
                (release / each.name).symlink_to(each)
        write_program(self.tools / "cmake", CMAKE_OF_THE_SAMPLE.format(python=sys.executable, cmake=shutil.which("cmake")))
        write_program(self.tools / "shorter-python", PYTHON_OF_THE_SAMPLE)
        self.environment["PYTHON"] = str(self.tools / "shorter-python")

    def begin(self, page):
        """What the pages before have made is gone, but for builds; the shell is a new one."""
        self.page = page
        for each in self.root.iterdir():
            if each.name != "build":
                shutil.rmtree(each) if each.is_dir() else each.unlink()
        subprocess.run(["cp", "-a", f"{self.pristine}/.", self.root], check=True)
        self.state.write_text("")
        if not self.whole:
            write_program(self.root / "build/release/apps/lodestone",
                          SHORTER_PROGRAM.format(python=sys.executable, here=str(HERE), program=str(self.program), page=page))
            shorter.plan(self.root / "configs/plans/quickstart.json")

    def start(self, text):
        """A line in a shell that knows what the lines before have exported."""
        self.output = self.outputs / str(len(list(self.outputs.iterdir())))
        with self.output.open("w") as output:
            return subprocess.Popen(["bash", "-c", f"set -o pipefail\n. {self.state}\n{text}\nstatus=$?\nexport -p > {self.state}\nexit $status"],
                                    cwd=self.root, env=self.environment, stdin=subprocess.DEVNULL, stdout=output, stderr=output, start_new_session=True)

    def said(self):
        return "\n".join(self.output.read_text(errors="replace").replace("\r", "\n").splitlines()[-12:])

    def run(self, text, limit_s):
        """What is wrong with a line that does not end well; "" else."""
        running = self.start(text)
        try:
            code = running.wait(limit_s)
        except subprocess.TimeoutExpired:
            os.killpg(running.pid, signal.SIGKILL)
            running.wait()
            return f"takes more than {limit_s} s: shorten it in tests/docs/shorter.py, or list it in tests/docs/listed.py"
        if "No test cases matched" in self.output.read_text(errors="replace"):  # Catch2 calls that a success
            return self.said()
        return "" if code == 0 else f"ends with {code}:\n{self.said()}"

    def serve(self, text, ready, limit_s):
        """A line that goes on until Ctrl-C; what is wrong where it does not get `ready`, which is given what it printed."""
        running = self.start(text)
        deadline = time.monotonic() + limit_s
        while not ready(self.output.read_text()):
            if running.poll() is not None:
                return f"ends with {running.returncode}:\n{self.said()}"
            if time.monotonic() > deadline:
                self.servers.append(running)
                self.end_servers()
                return f"is not ready within {limit_s} s:\n{self.said()}"
            time.sleep(0.1)
        self.servers.append(running)
        return ""

    def end_servers(self):
        """Ctrl-C in their terminals; what is wrong with how they end."""
        wrong = ""
        for running in self.servers:
            os.killpg(running.pid, signal.SIGINT)
            try:
                if running.wait(60) not in (0, 130):
                    wrong = f"after Ctrl-C it ends with {running.returncode}"
            except subprocess.TimeoutExpired:
                os.killpg(running.pid, signal.SIGKILL)
                running.wait()
                wrong = "does not end by Ctrl-C"
        self.servers.clear()
        return wrong
