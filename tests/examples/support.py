"""What the tests of the examples share. Arguments: the program lodestone, the source tree, where the examples are built, and
`with-python` where the package of Python is there.
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

program, source, built = (pathlib.Path(word) for word in sys.argv[1:4])
with_python = "with-python" in sys.argv[4:]
examples, models = source / "examples", source / "models"


def versions(name):
    """The commands that an example is: in C++, and in Python."""
    found = [[built / name]] if (examples / f"{name}.cpp").is_file() else []
    if with_python and (examples / f"{name}.py").is_file():
        found.append([sys.executable, examples / f"{name}.py"])
    return found


def output(*command, cwd=None):
    """What a command prints; it must succeed."""
    made = subprocess.run(list(map(str, command)), capture_output=True, text=True, cwd=cwd)
    if made.returncode != 0:
        raise AssertionError(f"{command} ended with {made.returncode}\n{made.stdout}{made.stderr}")
    return made.stdout


def refusal(*command):
    """The error of a command, which must fail."""
    made = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if made.returncode == 0:
        raise AssertionError(f"{command} succeeded\n{made.stdout}")
    return made.stderr


class InFolder(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)


def main():
    """Runs the tests of the script that calls it, and fails where there are none."""
    suite = unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"])
    result = unittest.TextTestRunner(verbosity=1).run(suite)
    sys.exit(not (result.wasSuccessful() and result.testsRun > 0 and not result.skipped))
