#!/usr/bin/env python3
"""Fails when src/M/x.cpp has no tests/M/x_test.cpp, unless docs/architecture.md says why.

Exceptions are the rows `| src/M/x.cpp | reason |` of its section "Sources without a test of their own", ten at most.

usage: check_mirrors.py ROOT    checks the tree; `--self-test` checks that the checker finds planted faults.
"""
import pathlib
import re
import sys
import tempfile

SECTION = "## Sources without a test of their own"
MOST = 10


def faults(root):
    page = (root / "docs/architecture.md").read_text()
    section = page.partition(SECTION)[2].partition("\n## ")[0]
    excepted = dict(re.findall(r"^\| `(src/\S+\.cpp)` \| *(\S.*?) *\|$", section, re.M))
    found = []
    for path in sorted((root / "src").rglob("*.cpp")):
        name = str(path.relative_to(root))
        tested = (root / "tests" / path.parent.name / f"{path.stem}_test.cpp").is_file()
        if not tested and name not in excepted:
            found.append(f"{name}: has no tests/{path.parent.name}/{path.stem}_test.cpp")
        if tested and name in excepted:
            found.append(f"{name}: has a test, and is listed in docs/architecture.md as having none")
    found += [f"{name}: listed in docs/architecture.md, but is not there" for name in excepted if not (root / name).is_file()]
    if len(excepted) > MOST:
        found.append(f"docs/architecture.md lists {len(excepted)} sources without a test, {MOST} at most")
    return found


def self_test():
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        for part in ("docs", "src/task", "tests/task"):
            (root / part).mkdir(parents=True)
        (root / "src/task/a.cpp").touch()
        (root / "src/task/b.cpp").touch()
        (root / "tests/task/a_test.cpp").touch()
        for rows, count in (
            ("", 1),  # b has none
            ("| `src/task/b.cpp` | a table |\n", 0),
            ("| `src/task/b.cpp` | |\n", 1),  # without a reason
            ("| `src/task/a.cpp` | it has one |\n| `src/task/b.cpp` | a table |\n", 1),
            ("| `src/task/b.cpp` | a table |\n| `src/task/c.cpp` | gone |\n", 1),
            ("\n## Another section\n\n| `src/task/b.cpp` | a table |\n", 1),
        ):
            (root / "docs/architecture.md").write_text(f"{SECTION}\n\n{rows}")
            if len(faults(root)) != count:
                sys.exit(f"the checker found {faults(root)} with {rows!r}, expected {count} faults")
    print("the checker finds planted faults")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    if sys.argv[1] == "--self-test":
        self_test()
    else:
        lines = faults(pathlib.Path(sys.argv[1]))
        print("\n".join(lines) or "every source has its test")
        sys.exit(bool(lines))
