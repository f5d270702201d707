"""pip installs the package into a virtual environment. Arguments as ever, and the build tree that is there already."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

import support


class Pip(unittest.TestCase):
    def test_it_is_installed_and_imports(self):
        with tempfile.TemporaryDirectory() as place:
            def run(*words):
                made = subprocess.run([str(word) for word in words], capture_output=True, text=True, cwd=place, env={"PATH": "/usr/local/bin:/usr/bin:/bin"})
                self.assertEqual(made.returncode, 0, made.stdout + made.stderr)
                return made.stdout

            run(sys.executable, "-m", "venv", "--system-site-packages", "env")
            python = pathlib.Path(place) / "env/bin/python"
            run(python, "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index", "--config-settings", f"build-dir={sys.argv[4]}", support.source)
            shown = run(python, "-c", "import lodestone; print(lodestone.__file__, lodestone.__version__, lodestone.Policy.load("
                                      f"{str(support.models / 'centre')!r})([0.01, 0.0, 0.1], [0.0, 0.0]))")
            self.assertIn(f"{place}/env/lib", shown)
            self.assertIn("lodestone", run(python, "-m", "pip", "list"))
            self.assertIn("Requires-Dist: numpy", "".join(path.read_text() for path in pathlib.Path(place).rglob("METADATA") if "lodestone" in path.parent.name))


support.main()
