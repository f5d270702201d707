"""What the tests of the package share. Arguments: the program lodestone, the source tree, the program as_cpp."""
import pathlib
import sys
import unittest

program, source, as_cpp = (pathlib.Path(word) for word in sys.argv[1:4])
models = source / "models"


def main():
    """Runs the tests of the script that calls it, and fails where there are none."""
    suite = unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"])
    result = unittest.TextTestRunner(verbosity=1).run(suite)
    sys.exit(not (result.wasSuccessful() and result.testsRun > 0 and not result.skipped))
