#!/usr/bin/env python3
"""Fails when an include or a link line points up the ladder of modules, sideways, or to LibTorch where that is left out.

The ladder is the table of docs/architecture.md: a module, what it holds, and what it may include besides itself and common.

usage: check_arrows.py ROOT    checks the tree; `--self-test` checks that the checker finds planted faults.
"""
import pathlib
import re
import sys
import tempfile

# Modules whose files may include LibTorch's headers, and of those a public header that describes networks.
SEES_TORCH = {"nets", "segmentation", "dynamics", "rl"}
# Modules that a program can be linked from without LibTorch.
LINKS_WITHOUT_TORCH = {"common", "geometry", "physics", "data", "task", "imaging", "runs", "inference", "vision", "rig", "env", "emulation",
                       "control", "safety", "session", "report", "python"}
MAY_SEE_TORCH = {"src/experiments/speed_figures.cpp", "src/experiments/speed_figures.h"}  # time LibTorch itself
# Who may see where the needle really is: the virtual rig with its rendered camera and simulated sensor, the emulation,
# scoring with whatever hands the truth to it, and of all that drives the oracle alone, which tells scoring what can be reached.
SEES_TRUTH = re.compile(
    r"/(rig/(virtual_rig|rendered_camera)|session/(simulated_detector|sensing|rig_session|ground_truth)"
    r"|emulation/live_bench|experiments/(oracle|oracle_predictions|trial|trial_recording|score|recorder|deployment|fault_injection|emulation_bench|track_checks|tracking_bench))\.(h|cpp)$")
TRUTH = re.compile(r"\btrue_(pose|x_m|y_m|heading)\w*")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.M)


def ladder_of(root):
    """Module: what it may include, from low to high."""
    rows = re.findall(r"^\| `(\w+)` \| .* \| *(.*?) *\|$", (root / "docs/architecture.md").read_text(), re.M)
    return {module: set(allowed.split(", ")) - {""} for module, allowed in rows if module != "apps"}


def folders_of(root, module):
    """Where the headers and sources of a module lie; those of the package of Python are at the top."""
    if module == "python":
        return (root / "python" / "src",)
    return (root / "include" / "lodestone" / module, root / "src" / module)


def faults(root):
    ladder = ladder_of(root)
    found = [f"docs/architecture.md: {module} may include {other}, which is no module"
             for module, allowed in ladder.items() for other in allowed - set(ladder)]
    for module, allowed in ladder.items():
        for folder in folders_of(root, module):
            for path in sorted(folder.rglob("*")):
                if path.suffix not in (".h", ".cpp"):
                    continue
                for include in INCLUDE.findall(path.read_text()):
                    name = path.relative_to(root)
                    parts = include.split("/")
                    if parts[0] != "lodestone" or len(parts) < 3:
                        continue
                    target = parts[1]
                    if target not in ladder:
                        found.append(f"{name}: includes {include}, which is in no known module")
                    elif target not in allowed | {module, "common"}:
                        found.append(f"{name}: {module} may not include {target} ({include})")
                if path.suffix == ".cpp":
                    own = f"lodestone/{module}/{path.stem}.h"
                    listed = [i for i in INCLUDE.findall(path.read_text()) if i.startswith("lodestone/")]
                    if (root / "include" / own).exists() and (not listed or listed[0] != own):
                        found.append(f"{path.relative_to(root)}: its own header {own} must come first")
    for top in ("include", "src", "apps", "python"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix in (".h", ".cpp") and not SEES_TRUTH.search(str(path)):
                for line, text in enumerate(path.read_text().splitlines(), 1):
                    if TRUTH.search(text.split("//")[0]):
                        found.append(f"{path.relative_to(root)}:{line}: may not see a true pose")
    for folder in sorted((root / "src").iterdir()):
        if folder.is_dir() and folder.name not in ladder:
            found.append(f"src/{folder.name} is not on the ladder of modules")
    return found + torch_faults(root, ladder) + link_faults(root, ladder)


def torch_header(path, root, known):
    """A LibTorch header that `path` sees, however many headers away, or None."""
    if path not in known:
        known[path] = None  # until it is known, so that a circle ends
        for include in INCLUDE.findall(path.read_text()):
            if include.startswith(("torch/", "ATen/", "c10/")):
                known[path] = include
                break
            for place in (root / "include" / include, path.parent / include):
                if place.is_file():
                    known[path] = torch_header(place, root, known)
                    break
            if known[path]:
                break
    return known[path]


def torch_faults(root, ladder):
    """Files of the modules without LibTorch, and of the program, that see one of its headers."""
    found = []
    known = {}
    folders = [root / "apps"]
    for module in set(ladder) - SEES_TORCH:
        folders += folders_of(root, module)
    for folder in folders:
        for path in sorted(folder.rglob("*")):
            if path.suffix not in (".h", ".cpp") or str(path.relative_to(root)) in MAY_SEE_TORCH:
                continue
            header = torch_header(path, root, known)
            if header:
                found.append(f"{path.relative_to(root)}: sees {header}, which only {', '.join(sorted(SEES_TORCH))} may")
    return found


def link_faults(root, ladder):
    """Link lines that go up the ladder, or to LibTorch where that is left out."""
    found = []
    links = {}
    torch = set()
    for module, allowed in ladder.items():
        path = (root / "python" if module == "python" else root / "src" / module) / "CMakeLists.txt"
        text = path.read_text() if path.is_file() else ""
        links[module] = set(re.findall(r"lodestone::(\w+)", text))
        for call in re.findall(r"lodestone_module\(([^)]*)\)", text):
            words = call.split()
            if "TORCH" in words or "TORCH_LIBRARIES" in call:
                torch.add(module)
            if "DEPENDS" in words:
                links[module] |= set(words[words.index("DEPENDS") + 1:]) & set(ladder)
        for target in sorted(links[module] - allowed - {module, "common"}):
            found.append(f"src/{module}/CMakeLists.txt: {module} may not link {target}")
    for module in sorted(LINKS_WITHOUT_TORCH):
        reached, todo = {module}, [module]
        while todo:
            for target in links.get(todo.pop(), ()):
                if target not in reached:
                    reached.add(target)
                    todo.append(target)
        for target in sorted(reached & torch):
            found.append(f"src/{module}/CMakeLists.txt: {module} links LibTorch by way of {target}")
    return found


def self_test():
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        for part in ("docs", "include/lodestone/task", "include/lodestone/rl", "src/task", "src/rl"):
            (root / part).mkdir(parents=True)
        page = root / "docs/architecture.md"
        page.write_text("| `common` | low | |\n| `geometry` | - | |\n| `task` | a, b | geometry |\n| `rl` | high | task, geometry |\n")
        header = root / "include/lodestone/task/a.h"
        for text, count in (
            ("#include <vector>\n#include \"lodestone/common/error.h\"\n", 0),
            ("#include \"lodestone/rl/td3.h\"\n", 1),
            ("#include <torch/torch.h>\n", 1),
            ("#include \"lodestone/task/b.h\"\n", 2),  # both headers see it
            ("#include \"lodestone/nowhere/x.h\"\n", 1),
            ("void f() { rig.true_pose(); }\n", 1),
            ("// nobody sees the true_pose() here\n", 0),
        ):
            header.write_text(text)
            (root / "include/lodestone/task/b.h").write_text("#include <ATen/core/Tensor.h>\n" if "b.h" in text else "")
            if len(faults(root)) != count:
                sys.exit(f"the checker found {faults(root)} in {text!r}, expected {count} faults")
        header.write_text("")
        (root / "src/rl/CMakeLists.txt").write_text("lodestone_module(rl TORCH\n  SOURCES x.cpp\n  DEPENDS task)\n")
        for text, count in (
            ("lodestone_module(task SOURCES a.cpp DEPENDS common geometry)\n", 0),
            ("lodestone_module(task SOURCES a.cpp DEPENDS common rl)\n", 2),  # up the ladder, and to LibTorch
            ("lodestone_module(task TORCH SOURCES a.cpp)\n", 1),
        ):
            (root / "src/task/CMakeLists.txt").write_text(text)
            if len(faults(root)) != count:
                sys.exit(f"the checker found {faults(root)} in {text!r}, expected {count} faults")
        page.write_text(page.read_text().replace("task, geometry", "task, geometri"))
        if not any("geometri, which is no module" in fault for fault in faults(root)):
            sys.exit("the checker did not find a misspelt module in the table")
    print("the checker finds planted faults")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    if sys.argv[1] == "--self-test":
        self_test()
    else:
        lines = faults(pathlib.Path(sys.argv[1]))
        print("\n".join(lines) or "every include points down the ladder of modules")
        sys.exit(bool(lines))
