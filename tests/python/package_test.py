"""The package as it is installed: without Gymnasium, without LibTorch, with stubs and words on everything."""
import inspect
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import lodestone
import support

folder = pathlib.Path(lodestone.__file__).parent


def alone(code):
    """Runs code where only the package and Debian's own are found."""
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(folder.parent)})


class Package(unittest.TestCase):
    def test_it_imports_without_gymnasium(self):
        made = alone("import sys, lodestone; lodestone.Policy; lodestone.save_policy\n"
                     "assert not [m for m in sys.modules if m.split('.')[0] in ('torch', 'gymnasium')]")
        self.assertEqual((made.returncode, made.stderr), (0, ""))

    def test_an_environment_says_what_is_missing(self):
        for name, needed in (("make_vec", "Gymnasium"), ("MbsEnv", "Gymnasium"), ("Sb3VecEnv", "Gymnasium|Stable-Baselines3")):
            made = alone(f"import lodestone; lodestone.{name}")
            self.assertRegex(made.stderr.strip().splitlines()[-1],
                             rf"^ImportError: lodestone\.{name} needs ({needed}), which is not installed: pip install ")

    def test_it_links_no_libtorch(self):
        linked = subprocess.run(["ldd", lodestone._lodestone.__file__], capture_output=True, text=True, check=True).stdout
        self.assertIn("libstdc++", linked)
        self.assertNotRegex(linked, r"libtorch|libc10|not found")

    def test_every_public_name_is_explained(self):
        for name in lodestone.__all__:
            thing = getattr(lodestone, name)
            self.assertTrue((thing.__doc__ or "").strip(), name)
            for member, value in vars(thing).items() if inspect.isclass(thing) else ():
                if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, (classmethod, property))):
                    self.assertTrue(inspect.getdoc(getattr(thing, member)), f"{name}.{member}")

    def test_the_stubs_name_what_is_there(self):
        self.assertTrue((folder / "py.typed").is_file())
        stubs = (folder / "_lodestone.pyi").read_text()
        core = lodestone._lodestone
        names = {name for name in dir(core) if not name.startswith("_")}
        self.assertEqual(set(re.findall(r"^(?:class|def) (\w+)", stubs, re.M)), names)
        for name in names:
            if inspect.isclass(getattr(core, name)):
                body = re.search(rf"^class {name}:\n((?:    .*\n?)+)", stubs, re.M)[1]
                ours = {member for member in vars(getattr(core, name)) if not member.startswith("_")}
                self.assertEqual(set(re.findall(r"^    def ([a-z]\w*)", body, re.M)), ours, name)

    def test_a_policy_comes_back_as_it_was_saved(self):
        random = np.random.default_rng(1)
        layers = [(random.normal(size=(16, 8)), random.normal(size=16)), (random.normal(size=(2, 16)), [0.1, -0.2])]
        shipped = lodestone.Policy.load(support.models / "centre")
        contract = {"encoder": shipped.encoder, "action": shipped.action, "goal": shipped.goal, "rig": shipped.rig}
        with tempfile.TemporaryDirectory() as place:
            lodestone.save_policy(f"{place}/policy", layers, contract=contract)
            policy = lodestone.Policy.load(pathlib.Path(place) / "policy")
        self.assertEqual((policy.encoder, policy.action, policy.goal, policy.rig, policy.hidden),
                         (shipped.encoder, shipped.action, "centre", shipped.rig, [16]))
        seen = random.normal(size=(5, 8)).astype(np.float32)
        (w1, b1), (w2, b2) = layers
        np.testing.assert_allclose(policy.act(seen), np.tanh(np.maximum(seen @ w1.T + b1, 0.0) @ w2.T + b2), atol=1e-5)

    def test_a_policy_replaces_a_policy_and_nothing_else(self):
        shipped = lodestone.Policy.load(support.models / "centre")
        contract = {"encoder": shipped.encoder, "action": shipped.action, "goal": shipped.goal, "rig": shipped.rig}
        layers = [(np.zeros((2, 8)), [0.1, -0.2])]
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place)
            for _ in range(2):
                lodestone.save_policy(folder / "policy", layers, contract=contract)
            (folder / "thesis.txt").write_text("words")
            with self.assertRaisesRegex(lodestone.ConfigError, "holds no policy: name a new folder"):
                lodestone.save_policy(folder, layers, contract=contract)
            self.assertEqual(sorted(entry.name for entry in folder.iterdir()), ["policy", "thesis.txt"])

    def test_a_policy_drives_the_coils_that_its_rig_lists(self):
        shipped = lodestone.Policy.load(support.models / "centre")
        np.testing.assert_allclose(shipped.drives([0.5, -0.2]), [0.5 * shipped.action["scale"], 0, 0, 0.2 * shipped.action["scale"]])
        six = json.loads((support.source / "configs/rigs/six_planar.json").read_text())
        layers = [(np.zeros((2, 8)), [0.1, -0.2])]
        contract = {"encoder": shipped.encoder, "action": shipped.action, "goal": "centre",
                    "rig": {key: six[key] for key in ("coils", "drive")}}
        with tempfile.TemporaryDirectory() as place:
            lodestone.save_policy(f"{place}/policy", layers, contract=contract)
            policy = lodestone.Policy.load(f"{place}/policy")
        centre, aside = policy.drives([1.0, 0.0]), policy.drives([[1.0, 0.0], [0.0, 0.0]], position=[0.02, 0.01])
        self.assertEqual((centre.shape, aside.shape), ((6,), (2, 6)))
        self.assertEqual(np.argmax(centre), 0)  # the coil that stands along +x
        self.assertTrue(np.all(centre >= 0.0) and np.all(aside[1] == 0.0))
        self.assertGreater(np.abs(centre - aside[0]).max(), 0.1)

    def test_transitions_are_those_of_the_file(self):
        table = lodestone.Transitions.load(support.source / "tests/data/version_2.h5")
        rows = len(table)
        self.assertGreater(rows, 0)
        size = table.state.shape[1]
        for name, shape in (("state", (rows, size)), ("action", (rows, 2)), ("next_state", (rows, size)),
                            ("terminated", (rows,)), ("truncated", (rows,)), ("zero_current", (rows,)), ("episode", (rows,))):
            self.assertEqual(getattr(table, name).shape, shape, name)
        same = table.episode[1:] == table.episode[:-1]
        np.testing.assert_array_equal(table.state[1:][same], table.next_state[:-1][same])
        self.assertIn(table.info["action_unit"], ("A", "percent"))


support.main()
