"""Every example is short, begins by saying what it is and how it is run, and stands in the table of README.md."""
import re
import unittest

import support

MOST = 60  # lines, which none has


class Shape(unittest.TestCase):
    def test_none_is_long(self):
        files = [path for path in sorted(support.examples.iterdir()) if path.name != "README.md"]
        self.assertGreaterEqual(len(files), 15)
        for path in files:
            with self.subTest(path.name):
                self.assertTrue(path.name == "CMakeLists.txt" or path.suffix in (".cpp", ".h", ".py"), "is no example")
                lines = path.read_text().splitlines()
                self.assertLess(len(lines), MOST)
                self.assertLessEqual(max(map(len, lines)), 130)

    def test_each_says_what_it_is_and_how_it_is_run(self):
        for path in [*support.examples.glob("*.cpp"), *support.examples.glob("*.py")]:
            with self.subTest(path.name):
                lines = path.read_text().splitlines()
                self.assertRegex(lines[0], r'^(// |""")[A-Z].*[.,:;]?')
                run = f"examples/{path.name} " if path.suffix == ".py" else f"build/examples/{path.stem} "
                self.assertIn(run, "\n".join(lines[:6]) + " ")

    def test_the_table_lists_all(self):
        text = (support.examples / "README.md").read_text()
        listed = set(re.findall(r"\]\((\w+\.\w+)\)", text))
        self.assertEqual(listed, {path.name for path in support.examples.iterdir()} - {"README.md", "CMakeLists.txt"})


support.main()
