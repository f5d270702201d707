"""What Minari itself reads of `lodestone export --data ... --to minari:DIR` are our numbers.

usage: minari_reader_test.py PROGRAM PACKAGES    by Debian's Python; PACKAGES holds minari and gymnasium
"""
import os
import pathlib
import subprocess
import sys
import tempfile

program, packages = sys.argv[1], sys.argv[2]
sys.path.insert(0, packages)
import h5py
import numpy

folder = tempfile.TemporaryDirectory()
root = pathlib.Path(folder.name)
os.environ["MINARI_DATASETS_PATH"] = str(root / "datasets")
import gymnasium
import minari


def lodestone(*arguments):
    return subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def recorded(path):
    """Our episodes, by plain HDF5: observations [T + 1, S] and actions [T, 2] in [-1, 1] of each."""
    with h5py.File(path) as file:
        steps, observations, actions = file["steps"][:], file["observations"][:], file["actions"][:]
        scale, radius = file.attrs["action_scale"], file.attrs["workspace_radius_m"]
    episodes, row, step = [], 0, 0
    for count in steps:
        episodes.append((observations[row:row + count + 1], actions[step:step + count] / scale))
        row, step = row + count + 1, step + count
    return episodes, radius


def rewarded(distance, radius):
    """Eq. 3 of the paper with the defaults of the task."""
    reached = distance[1:] < 0.003
    return -10.0 * numpy.diff(distance) / radius - 0.04 + 10.0 * reached, reached


def check_centre(path):
    lodestone("export", "--data", path, "--to", f"minari:{root}/datasets", "--id", "lodestone/centre-v0", "--set", "task.max_steps=7")
    dataset = minari.load_dataset("lodestone/centre-v0")
    assert dataset.id in minari.list_local_datasets()
    ours, radius = recorded(path)
    assert dataset.total_steps == sum(len(actions) for _, actions in ours)
    assert isinstance(dataset.observation_space, gymnasium.spaces.Box)
    read = list(dataset.iterate_episodes())
    assert [episode.id for episode in read] == list(range(dataset.total_episodes))
    metadata = list(dataset.storage.get_episode_metadata(range(dataset.total_episodes)))
    assert len({facts["seed"] for facts in metadata}) == dataset.total_episodes
    assert all(facts["id"] == i and facts["total_steps"] == len(read[i]) for i, facts in enumerate(metadata))

    left = iter(read)
    for observations, actions in ours:
        begin = 0
        while begin < len(actions):  # one of ours is as many of theirs as the task ends
            episode = next(left)
            steps = len(episode)
            end = begin + steps
            assert numpy.array_equal(episode.observations, observations[begin:end + 1])
            assert numpy.array_equal(episode.actions, actions[begin:end])
            assert all(dataset.observation_space.contains(row) for row in episode.observations)
            assert all(dataset.action_space.contains(row) for row in episode.actions)
            distance = numpy.hypot(*episode.observations[:, :2].T)
            reward, reached = rewarded(distance, radius)
            assert numpy.allclose(episode.rewards, reward, rtol=0, atol=1e-12)
            assert numpy.allclose(episode.infos["distance_m"], distance, rtol=0, atol=1e-15)
            assert numpy.array_equal(episode.infos["is_success"][1:], reached)
            assert episode.terminations.dtype == episode.truncations.dtype == episode.infos["is_success"].dtype == bool
            assert len(episode.infos["distance_m"]) == steps + 1
            assert not episode.terminations[:-1].any() and not episode.truncations[:-1].any()
            assert episode.terminations[-1] == (reached[-1] or distance[-1] > radius)
            assert episode.truncations[-1] == (not episode.terminations[-1])
            assert episode.terminations[-1] or steps == 7 or end == len(actions)
            begin = end
    assert next(left, None) is None


def check_points(path):
    """Goals of their own, from the seed; Minari's own sampling, filtering and splitting."""
    arguments = ["export", "--data", path, "--to", f"minari:{root}/datasets", "--task", "point", "--seed", "3", "--id"]
    said = lodestone(*arguments, "lodestone/points-v0")
    lodestone(*arguments, "lodestone/points-v1")
    dataset, again = (minari.load_dataset(f"lodestone/points-v{version}") for version in (0, 1))
    assert f"steps        {dataset.total_steps}\n" in said
    first = dataset[0]
    assert first.observations.shape[1] == 5
    assert (first.observations[:, 3:] == first.observations[0, 3:]).all()
    assert numpy.allclose(numpy.hypot(*(first.observations[:, :2] - first.observations[:, 3:]).T), first.infos["distance_m"])
    assert len({tuple(episode.observations[0, 3:]) for episode in dataset}) == dataset.total_episodes
    assert all(numpy.array_equal(a.observations, b.observations) for a, b in zip(dataset, again))
    ended = dataset.filter_episodes(lambda episode: bool(episode.terminations[-1]))
    assert ended.total_episodes == sum(bool(episode.terminations[-1]) for episode in dataset)
    parts = minari.split_dataset(dataset, sizes=[2, 3], seed=1)
    assert [part.total_episodes for part in parts] == [2, 3]
    assert len(list(dataset.sample_episodes(3))) == 3
    assert sum(len(episode) for episode in dataset) == dataset.total_steps


def check_pulses():
    """A sphere's recorded pulses: no heading, per cent of drive, single pulses."""
    rows = ["coil,drive_percent,x_before_mm,y_before_mm,x_after_mm,y_after_mm"]
    rows += [f"{'+-'[i % 2]}{'xy'[i // 2 % 2]},{20 + i},{i / 4},{-i / 5},{i / 4 + 0.5},{-i / 5}" for i in range(40)]
    (root / "pulses.csv").write_text("\n".join(rows) + "\n")
    lodestone("export", "--data", root / "pulses.csv", "--to", f"minari:{root}/datasets")
    dataset = minari.load_dataset("lodestone/pulses-v0")
    assert dataset.total_episodes == dataset.total_steps == 40
    assert numpy.allclose(dataset[9].observations[0], [9 / 4e3, -9 / 5e3])
    assert numpy.allclose(dataset[9].actions, [[-0.29, 0.0]])


def needle_log():
    """The lab's log of a needle that is pulled about: 40 stretches of 5 to 25 steps."""
    random = numpy.random.default_rng(1)
    rows = ["camera_frame_number,measured_current_filtered_north,measured_current_filtered_south,measured_current_filtered_east,"
            "measured_current_filtered_west,localization_x,localization_y,localization_angle"]
    frame = 0
    for _ in range(40):
        place, heading = random.uniform(-20, 20, 2), random.uniform(-3, 3)
        for _ in range(random.integers(6, 27)):
            drive = random.uniform(-14, 14, 2)
            north, south, east, west = max(drive[1], 0), max(-drive[1], 0), max(drive[0], 0), max(-drive[0], 0)
            rows.append(f"{frame},{north},{south},{east},{west},{place[0]},{place[1]},{heading}")
            frame += 1
            place, heading = 0.95 * place + 0.2 * drive, heading + random.uniform(-0.3, 0.3)
        frame += 10
    path = root / "needle.csv"
    path.write_text("\n".join(rows) + "\n")
    lodestone("import", path, "--out", root / "needle.h5")
    return root / "needle.h5"


needle = needle_log()
check_centre(needle)
check_points(needle)
check_pulses()
print("Minari reads what was recorded")
