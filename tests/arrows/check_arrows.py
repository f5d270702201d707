#!/usr/bin/env python3
"""Fails when an include points up the ladder of modules, sideways, or to LibTorch from a module without it.

usage: check_arrows.py ROOT    checks the tree; `--self-test` checks that the checker finds planted faults.
"""
import pathlib
import re
import sys
import tempfile

# module: what it may include besides itself and common (docs/architecture.md has the same table)
LADDER = {
    "common": set(),
    "geometry": set(),
    "physics": {"geometry"},
    "data": {"geometry"},
    "task": {"geometry"},
    "imaging": {"geometry"},
    "nets": {"geometry", "data", "task"},
    "vision": {"nets", "imaging", "geometry"},
    "rig": {"physics", "imaging", "data", "geometry"},
    "env": {"physics", "task", "data", "nets", "geometry"},
    "rl": {"env", "nets", "data", "task", "physics", "geometry"},
    "emulation": {"rig", "physics", "imaging", "geometry"},
    "control": {"rig", "physics", "data", "task", "nets", "geometry"},
    "safety": {"control", "rig", "physics", "geometry"},
    "session": {"safety", "control", "rig", "vision", "imaging", "physics", "geometry"},
    "experiments": {"session", "safety", "control", "emulation", "rig", "vision", "imaging", "physics", "data", "task", "nets",
                    "geometry"},
    "report": {"data", "geometry"},
}
WITHOUT_TORCH = {"common", "geometry", "physics", "data", "task", "imaging", "rig", "emulation", "safety", "report"}
# Who may see where the needle really is: the virtual rig with its rendered camera and simulated sensor, the emulation, and
# scoring with whatever hands the truth to it.
SEES_TRUTH = re.compile(
    r"/(hil_figures|rig/(virtual_rig|rendered_camera)|session/(simulated_pose_sensor|sensing|rig_session|ground_truth)"
    r"|emulation/live_bench|experiments/(trial|score|recorder|deployment|fault_injection))\.(h|cpp)$")
TRUTH = re.compile(r"\btrue_(pose|x_m|y_m|heading)\w*")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.M)


def faults(root):
    found = []
    for module, allowed in LADDER.items():
        for folder in (root / "include" / "lodestone" / module, root / "src" / module):
            for path in sorted(folder.rglob("*")):
                if path.suffix not in (".h", ".cpp"):
                    continue
                for include in INCLUDE.findall(path.read_text()):
                    name = path.relative_to(root)
                    if include.startswith(("torch/", "ATen/", "c10/")) and module in WITHOUT_TORCH:
                        found.append(f"{name}: includes {include}, but {module} builds without LibTorch")
                    parts = include.split("/")
                    if parts[0] != "lodestone" or len(parts) < 3:
                        continue
                    target = parts[1]
                    if target not in LADDER:
                        found.append(f"{name}: includes {include}, which is in no known module")
                    elif target not in allowed | {module, "common"}:
                        found.append(f"{name}: {module} may not include {target} ({include})")
                if path.suffix == ".cpp":
                    own = f"lodestone/{module}/{path.stem}.h"
                    listed = [i for i in INCLUDE.findall(path.read_text()) if i.startswith("lodestone/")]
                    if (root / "include" / own).exists() and (not listed or listed[0] != own):
                        found.append(f"{path.relative_to(root)}: its own header {own} must come first")
    for top in ("include", "src", "apps"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix in (".h", ".cpp") and not SEES_TRUTH.search(str(path)):
                for line, text in enumerate(path.read_text().splitlines(), 1):
                    if TRUTH.search(text.split("//")[0]):
                        found.append(f"{path.relative_to(root)}:{line}: may not see a true pose")
    for folder in sorted((root / "src").iterdir()):
        if folder.is_dir() and folder.name not in LADDER:
            found.append(f"src/{folder.name} is not on the ladder of modules")
    return found


def self_test():
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        for part in ("include/lodestone/task", "include/lodestone/rl", "src/task", "src/rl"):
            (root / part).mkdir(parents=True)
        header = root / "include/lodestone/task/a.h"
        for text, count in (
            ("#include <vector>\n#include \"lodestone/common/error.h\"\n", 0),
            ("#include \"lodestone/rl/td3.h\"\n", 1),
            ("#include <torch/torch.h>\n", 1),
            ("#include \"lodestone/nowhere/x.h\"\n", 1),
            ("void f() { rig.true_pose(); }\n", 1),
            ("// nobody sees the true_pose() here\n", 0),
        ):
            header.write_text(text)
            if len(faults(root)) != count:
                sys.exit(f"the checker found {faults(root)} in {text!r}, expected {count} faults")
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
