"""What tutorials.py must find, planted in a page, is found; and a page without faults has none.

usage: planted_test.py SOURCE BUILD PYTHON_PACKAGES
"""
import pathlib
import sys
import tempfile

import listed
import pages
import shorter
from checkout import Checkout
from tutorials import Tutorials

GOOD = """Checks:

    build/release/apps/lodestone check models/centre

```python
print("as is")
```

```
export WHERE=models/centre
lodestone check $WHERE      # what was exported is there for the next
```
"""
PLANTED = (  # a page, what the fault says
    (GOOD, ""),
    ("```\nlodestone check models/centre --dee\n```\n", "--dee"),
    ("\n    lodestone deploy --models models/centre --trails 3 --out runs/x\n", "--trails"),
    ("\n    lodestone collect --set transitions=many --out runs/x\n", "transitions"),
    ("\n    build/release/apps/lodestone check models/nowhere\n", "models/nowhere"),
    ("\n    lodestone check models/centre && scripts/nothing | cat\n", "scripts/nothing"),
    ("\n    apt-get moo --listed\n    lodestone collect --config configs/quickstart/colect.json\n", "colect.json"),
    ("\n    apt-get moo build/release/nothing.hex\n", "nothing.hex"),
    ("\n    build/dev/tests/data/test_data \"no such test\"\n", "No test cases matched"),
    ("```python\nimport nothing_of_this_name\n```\n", "nothing_of_this_name"),
    ("```python\nthis is no Python\n```\n", "SyntaxError"),
    ("```c\nint a = \"text\";\nundeclared();\n```\n", "undeclared"),
    ("```rust\nfn main() {}\n```\n", "rust"),
)
TABLES = {"NOT_RUN": {("planted.md", "apt-get moo"): "moos", ("planted.md", "lodestone collect"): "takes long"}, "SOAK_ONLY": {},
          "ON_THE_VIRTUAL_RIG": {}, "FILES": {}, "NO_COMMANDS": {}}


def expect(condition, what):
    if not condition:
        sys.exit(f"tests/docs does not find what was planted: {what}")


def main(source, build, python_packages):
    with tempfile.TemporaryDirectory(prefix="lodestone-docs-") as name:
        folder = pathlib.Path(name)
        checkout = Checkout(folder, source, build, python_packages, whole=False)
        for text, said in PLANTED:
            tutorials = Tutorials(checkout, {name: listed.Table(name, entries) for name, entries in TABLES.items()}, folder, 60)
            tutorials.page("planted.md", text)
            if said:
                expect(len(tutorials.faults) == 1 and said in tutorials.faults[0], f"{text!r}: {tutorials.faults}")
            else:
                expect(not tutorials.faults and tutorials.run_count == 4, f"{text!r}: {tutorials.faults}, {tutorials.run_count} run")
        found = pages.commands_in_text("planted.md", ["as `lodestone deploy --trails 3` and `deploy`, not `cat --help`"], tutorials.verbs)
        expect([place.text for place in found] == ["deploy --trails 3"], found)
        tutorials.text(found)
        expect("--trails" in tutorials.faults[-1], tutorials.faults)
    expect(any("bench speed" in fault for fault in shorter.faults()), shorter.faults())
    expect(shorter.shortened("docs/any.md", ["bench", "speed", "--out", "x"])[4:6] == ["--set", "runs=1"], "bench speed")
    expect(shorter.shortened("docs/results.md", "evaluate dynamics --oracle 16 --draws 16".split()) ==
           "evaluate dynamics --oracle 1 --draws 16".split(), "a value that is shortened")
    expect(shorter.hides(shorter.shortened("docs/any.md", ["deploy", "--set", "trials.count=5"])), "a key set twice")
    expect(not shorter.hides(shorter.shortened("docs/any.md", ["deploy", "--set", "seed=5"])), "a key set once")
    expect(not any("bench speed" in fault for fault in shorter.faults()), shorter.faults())
    stale = listed.Table("NOT_RUN", TABLES["NOT_RUN"])
    stale.look_up(pages.Place("planted.md", 1, "apt-get moo"))
    expect(len(stale.faults()) == 1 and "lodestone collect" in stale.faults()[0], stale.faults())
    print("what was planted was found")


if __name__ == "__main__":
    main(*(pathlib.Path(argument).resolve() for argument in sys.argv[1:4]))
