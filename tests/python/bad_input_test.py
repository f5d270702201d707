"""Whatever is handed in: an exception of Python of the right kind, in one line, and never a crash."""
import os
import pathlib
import random
import sys
import tempfile
import unittest

import gymnasium
import numpy as np

import lodestone
import support

sys.path.append(str(support.source / "tests/apps"))
import soak

dynamics = lodestone.Dynamics.load(support.models / "dynamics_best")
policy = lodestone.Policy.load(support.models / "centre")
CONTRACT = {"encoder": policy.encoder, "action": policy.action, "goal": policy.goal, "rig": policy.rig}
LAYERS = [(np.ones((4, 8)), np.ones(4)), (np.ones((2, 4)), np.zeros(2))]
ALLOWED = (TypeError, ValueError, lodestone.Error, gymnasium.error.ClosedEnvironmentError, gymnasium.error.ResetNeeded)
CALLS, SAMPLE = 10_000, 400
SPOILED = object()  # a file or folder that is damaged anew for every call


class Words(unittest.TestCase):
    def check(self, kind, words, call, *arguments, **named):
        with self.assertRaisesRegex(kind, words) as caught:
            call(*arguments, **named)
        self.assertNotIn("\n", str(caught.exception))

    def test_files(self):
        for load in (lodestone.Dynamics.load, lodestone.Policy.load):
            self.check(FileNotFoundError, "^checkpoint nowhere: no such folder; give the folder that holds manifest.json$", load, "nowhere")
            self.check(lodestone.NotFoundError, "no such folder", load, pathlib.Path("nowhere"))
            self.check(TypeError, "", load, 7)
        self.check(lodestone.CheckpointError, 'is of kind "policy", expected "dynamics"', lodestone.Dynamics.load, support.models / "centre")
        self.check(FileNotFoundError, "nowhere.h5", lodestone.Transitions.load, "nowhere.h5")
        self.check(lodestone.DataError, "not an HDF5 file", lodestone.Transitions.load, support.source / "README.md")
        self.check(FileNotFoundError, "nowhere.json does not exist", lodestone.MbsEnv, dynamics, "nowhere.json")
        with tempfile.TemporaryDirectory() as place:
            folder, binary = pathlib.Path(place, "folder.json"), pathlib.Path(place, "binary.json")
            folder.mkdir()
            binary.write_bytes(b"\xff\xfe")
            self.check(lodestone.IoError, "folder.json cannot be read: Is a directory", lodestone.MbsEnv, dynamics, folder)
            self.check(lodestone.ConfigError, "binary.json is no JSON", lodestone.MbsEnv, dynamics, binary)
        with tempfile.TemporaryDirectory() as place:
            (pathlib.Path(place) / "file").touch()
            self.check(lodestone.IoError, "file", lodestone.save_policy, f"{place}/file/policy", LAYERS, contract=CONTRACT)

    def test_arrays(self):
        self.check(ValueError, r"^pose is of shape \[2\], must be \[3\]$", policy, [0, 0], [0, 0])
        self.check(ValueError, r"^pose\[2\] is nan, must be a finite number$", policy, [0, 0, np.nan], [0, 0])
        self.check(ValueError, r"^target\[0\] is -inf", policy, [0, 0, 0], [-np.inf, 0])
        self.check(TypeError, "^pose is of dtype complex128, must be real numbers", policy, [0, 0, 1j], [0, 0])
        self.check(TypeError, "^target is of dtype bool", policy, [0, 0, 0], [True, False])
        self.check(ValueError, r"^observation is of shape \[3, 7\], must be \[8\] or \[N, 8\]$", policy.act, np.zeros((3, 7)))
        for threads in (-1, 1025, 1 << 70):
            self.check(ValueError, f"^threads is {threads}, must be within 0 .. 1024$", lodestone.make_vec, dynamics, 2, threads=threads)
        self.check(ValueError, "^state and action are of 2 and 1 rows", dynamics.predict, np.zeros((2, 3)), [0, 0])
        environments = lodestone.make_vec(dynamics, 3)
        environments.reset(seed=1)
        self.check(ValueError, r"^actions are of 2 rows, must be \[3, 2\]: one for each environment$", environments.step, np.zeros((2, 2)))
        spoiled = np.zeros((3, 2), np.float32)
        spoiled[1, 0] = np.nan
        self.check(ValueError, r"^actions\[1, 0\] is nan, must be a finite number$", environments.step, spoiled)
        self.check(TypeError, "^actions is of dtype object", environments.step, np.array([[None, 0]] * 3))

    def test_configurations(self):
        """The words of `lodestone train-policy`."""
        self.check(lodestone.ConfigError, "^planner: unknown key horizn = 1; did you mean horizon[?]$", lodestone.Planner, dynamics, horizn=1)
        self.check(lodestone.ConfigError, "planner.*horizon = 0 must be within 1 .. 50|horizon = 0", lodestone.Planner, dynamics, horizon=0)
        self.check(lodestone.ConfigError, 'task.goal = "center" must be one of centre, point, pose', lodestone.MbsEnv, dynamics, {"goal": "center"})
        self.check(lodestone.ConfigError, "task = 'center', must be one of centre, point, pose", lodestone.MbsEnv, dynamics, "center")
        self.check(lodestone.ConfigError, "start_radius", lodestone.MbsEnv, dynamics, task={"start_radius": 0.0})
        self.check(lodestone.ConfigError, "mbs.disagreement", lodestone.MbsEnv, lodestone.Dynamics.load(support.models / "dynamics_paper"), mbs={"disagreement_stop_m": 0.1})
        self.check(TypeError, "unexpected argument 'tsk'", lodestone.MbsEnv, dynamics, tsk={})
        self.check(ValueError, "^num_envs is 0, must be within 1 .. 1048576$", lodestone.make_vec, dynamics, 0)
        self.check(TypeError, "^num_envs is 1.5, must be a whole number$", lodestone.make_vec, dynamics, 1.5)
        self.check(ValueError, "^seed is -1, must be within", lodestone.make_vec(dynamics).reset, seed=-1)
        self.check(ValueError, "options", lodestone.MbsEnv(dynamics).reset, options={"place": 1})

    def test_policies_that_cannot_be(self):
        with tempfile.TemporaryDirectory() as place:
            to = f"{place}/policy"
            save = lodestone.save_policy
            self.check(lodestone.CheckpointError, r'"l1.weight" is \[4, 7\] float32, expected \[4, 8\] float32', save, to, [(np.ones((4, 7)), np.ones(4)), LAYERS[1]], contract=CONTRACT)
            self.check(ValueError, r"^l1.weight\[0, 0\] is nan", save, to, [(np.full((4, 8), np.nan), np.ones(4)), LAYERS[1]], contract=CONTRACT)
            self.check(ValueError, r"^layers\[0\] holds 1 arrays", save, to, [(np.ones((4, 8)),)], contract=CONTRACT)
            self.check(lodestone.ConfigError, "^save_policy: contract lacks encoder", save, to, LAYERS, contract={"action": {}, "goal": "", "rig": None})
            self.check(lodestone.ConfigError, "contract is not that of an environment", save, to, LAYERS, contract={**CONTRACT, "encoder": {"heading": 3}})
            self.check((lodestone.ConfigError, lodestone.CheckpointError), "", save, to, [], contract=CONTRACT)
            self.assertEqual(os.listdir(place), [])


class Mutations(unittest.TestCase):
    """Calls that are right, with something wrong put into them."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.random = random.Random(soak.seed)
        self.count = CALLS if soak.whole else SAMPLE

    def spoiled_files(self):
        """A checkpoint or a recording with bytes changed or cut off."""
        place = pathlib.Path(self.folder.name)
        source = self.random.choice([support.models / "centre/manifest.json", support.models / "centre/actor.safetensors",
                                     support.source / "tests/data/version_2.h5", support.models / "dynamics_paper/manifest.json"])
        content = bytearray(source.read_bytes())
        for _ in range(self.random.randint(1, 8)):
            content[self.random.randrange(len(content))] = self.random.randrange(256)
        if self.random.random() < 0.3:
            del content[self.random.randrange(len(content)):]
        if source.suffix == ".h5":
            (place / "spoiled.h5").write_bytes(content)
            return str(place / "spoiled.h5")
        for file in source.parent.iterdir():
            (place / file.name).write_bytes(content if file == source else file.read_bytes())
        return str(place)

    def value(self, depth=0):
        pick = self.random
        plain = [None, True, -1, 0, 1, 2, 3, 8, 1 << 70, -1 << 70, 0.5, float("nan"), float("inf"), 1e308, "", "centre", "\0", "\ud800", b"x",
                 "x" * 5000, object(), int, 1j, {}, {"goal": "pose"}, {"task": 1}, {1: 2}, [], (), [[]], [None], "nowhere.json"]
        if depth > 2 or pick.random() < 0.4:
            return pick.choice(plain)
        kind = pick.randrange(5)
        if kind == 0:
            return [self.value(depth + 1) for _ in range(pick.randint(0, 4))]
        if kind == 1:
            return {str(self.value(depth + 3)): self.value(depth + 1) for _ in range(pick.randint(0, 3))}
        shape = [pick.choice([0, 1, 2, 3, 4, 8]) for _ in range(pick.randint(0, 4))]
        dtype = pick.choice(["f4", "f8", "f2", "i4", "u1", "?", "c8", "O", "U3", "M8[s]", ">f8", "V4"])
        array = np.zeros(shape, dtype)
        if kind == 3 and dtype in ("f4", "f8") and array.size:
            array.flat[pick.randrange(array.size)] = pick.choice([np.nan, np.inf, -np.inf, 1e30])
        if kind == 4 and array.ndim > 1:
            return array.T[::-1]
        return array

    def targets(self):
        environment, environments = lodestone.MbsEnv(dynamics), lodestone.make_vec(dynamics, 3, threads=1)
        environment.reset(seed=1)
        environments.reset(seed=1)
        closed, many_closed = lodestone.MbsEnv(dynamics), lodestone.make_vec(dynamics, 2, threads=1)
        closed.close()
        many_closed.close()
        planner = lodestone.Planner(dynamics, candidates=8, elites=2, iterations=1)
        pose, target = [0.01, 0.0, 0.1], [0.0, 0.0]
        return [(policy, [pose, target, None], {}), (planner, [pose, target], {}), (policy.act, [np.zeros((2, 8), np.float32)], {}),
                (policy.drives, [[0.1, 0.2]], {}), (dynamics.predict, [np.zeros((2, 3)), np.zeros((2, 2))], {}),
                (environments.step, [np.zeros((3, 2))], {}), (environments.reset, [], {"seed": 3, "options": None}),
                (environment.step, [[0.1, 0.1]], {}), (environment.reset, [], {"seed": 3, "options": None}),
                (closed.step, [[0.1, 0.1]], {}), (many_closed.step, [np.zeros((2, 2))], {}), (many_closed.reset, [], {"seed": 1}),
                (lodestone.MbsEnv, [dynamics, {"goal": "centre", "max_steps": 5}], {"encoder": {"heading": "none"}, "mbs": {}}),
                (lodestone.make_vec, [dynamics, 2, {"goal": "point"}], {"threads": 1, "seed": 1, "action": {"dead_band": 0.1}}),
                (lodestone.Planner, [dynamics], {"seed": 1, "horizon": 1}),
                (lodestone.save_policy, [f"{self.folder.name}/saved", LAYERS], {"contract": CONTRACT}),
                (lodestone.Policy.load, [SPOILED], {}), (lodestone.Dynamics.load, [SPOILED], {}),
                (lodestone.Transitions.load, [SPOILED], {})]

    def mutated(self, arguments, named):
        arguments, named = list(arguments), dict(named)
        for _ in range(self.random.randint(1, 2)):
            kind = self.random.randrange(8)
            if arguments and kind < 5:
                place = self.random.randrange(len(arguments))
                inner = arguments[place]
                if isinstance(inner, dict) and kind < 3:
                    arguments[place] = {**inner, self.random.choice(["goal", "max_steps", "alpha", "x", *inner]): self.value()}
                else:
                    arguments[place] = self.value()
            elif named and kind < 7:
                key = self.random.choice(list(named))
                inner = named[key]
                named[key] = {**inner, self.random.choice([*inner, "x"]): self.value()} if isinstance(inner, dict) else self.value()
            elif kind == 7 and arguments:
                arguments.pop()
        return [self.spoiled_files() if argument is SPOILED else argument for argument in arguments], named

    def test_no_call_does_harm(self):
        before = policy.act(np.ones(8, np.float32))
        targets = self.targets()
        refused = 0
        where = os.getcwd()
        os.chdir(self.folder.name)  # whatever a name may be taken for lies here
        self.addCleanup(os.chdir, where)
        for _ in range(self.count):
            call, arguments, named = self.random.choice(targets)
            arguments, named = self.mutated(arguments, named)
            try:
                call(*arguments, **named)
            except ALLOWED as error:
                refused += 1
                if isinstance(error, lodestone.Error):
                    self.assertTrue(str(error) and "\n" not in str(error), repr(error))
            except Exception as error:
                raise AssertionError(f"{call} {arguments!r:.500} {named!r:.500}: {error!r}") from error
        np.testing.assert_array_equal(policy.act(np.ones(8, np.float32)), before)
        self.assertGreater(refused, self.count // 2)
        soak.told(self.count, "spoiled calls of the package")


support.main()
