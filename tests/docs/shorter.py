"""How the sample takes less time than the reader would need. The soak uses none of this.

Words are put behind those of a command, which the program thus parses as written, or values of options replaced; `lodestone` and
build/release/apps/lodestone of the sample do that, so that the shell is given the page's text. Keys: a page, or "" for all, and how a command begins; the
longest that fits is taken.
"""
import json

TRIALS = ("trials.count=1", "trials.point_seconds=1", "trials.square_side_m=0.004", "trials.circle_radius_m=0.003",
          "reference.approach_limit_s=1", "score.completion_window_s=1")
SIMULATED = (*TRIALS, "sensor.kind=simulated", "record.enabled=false")
TRAINING = ("training.env_steps=4000", "training.warm_up_steps=1000", "training.evaluate_every=2000", "training.evaluation_episodes=8",
            "training.updates_per_step=0.02")

SETTINGS = {
    ("", "adapt"): ("first.epochs=2", "learning.epochs=1"),
    ("", "bench oracle"): SIMULATED,
    ("", "bench rigs"): TRIALS,
    ("", "bench speed"): ("runs=1", "run_s=0.01", "images=10", "td3_batch=32", "mbs_environments=1000"),
    ("", "collect"): ("transitions=300", "sensor.kind=simulated"),
    ("docs/logs.md", "collect"): ("transitions=30", "sessions=1"),
    ("", "deploy"): SIMULATED,
    ("README.md", "deploy"): TRIALS,
    ("docs/deploy-safely.md", "deploy"): (*SIMULATED, "suture.arrive_limit_s=1"),
    ("docs/drive-a-bench.md", "deploy"): ("trials.point_seconds=2", "safety.max_late_s=1", "safety.max_late_steps=10", "safety.max_pose_age_s=2"),
    ("docs/logs.md", "deploy"): TRIALS,
    ("docs/see-the-needle.md", "deploy"): TRIALS,
    ("", "qualify"): ("minutes=0.5", "sensor.kind=simulated"),
    ("", "train-dynamics"): ("training.epochs=2",),
    ("", "train-policy"): TRAINING,
}
OPTIONS = {
    ("", "bench paper"): ("--list",),
    ("", "bench tasks"): ("--tasks", "still", "--controllers", "baseline", "--trials", "1"),
    ("", "bench paper --scale quick --out runs/quick --only"): ("--report",),
    ("", "console"): ("--port", "0"),
}

# Options whose value is another one.
VALUES = {
    ("", "evaluate segmenter"): {"--frames": "10"},
    ("docs/results.md", "evaluate dynamics"): {"--oracle": "1"},
}

# Settings of the cells of configs/plans/quickstart.json, by verb.
PLAN = {
    "collect": ("transitions=600", "sensor.kind=simulated"),
    "train-dynamics": ("training.epochs=4",),
    "train-policy": TRAINING,
    "deploy": SIMULATED,
}

# Of files that a page has the reader write: settings more, and other values.
FILES = {"rate.json": {"settings": TRAINING, "seeds": 1}}

# Numbers in code.
CODE = {
    ("docs/python.md", "model.learn(32_000)"): "model.learn(2_500)",
}

used = set()


def look_up(table, page, words):
    """What a table has for a command; nothing, an empty tuple."""
    text = " ".join(words) + " "
    fitting = [key for key in table if key[0] in ("", page) and text.startswith(key[1] + " ")]
    if not fitting:
        return ()
    best = max(fitting, key=lambda key: (key[0] == page, len(key[1])))
    used.add(best)
    return table[best]


def shortened(page, words):
    """The words that a command is run with."""
    values = dict(look_up(VALUES, page, words))
    return [*(values.get(before, word) for before, word in zip(["", *words], words)),
            *(word for setting in look_up(SETTINGS, page, words) for word in ("--set", setting)), *look_up(OPTIONS, page, words)]


def hides(words):
    """Whether shortened words set a key twice, so that the program would not look at the page's value."""
    keys = [value.partition("=")[0] for option, value in zip(words, words[1:]) if option == "--set"]
    return len(set(keys)) < len(keys)


def code(page, text):
    for (of, long), short in CODE.items():
        if of == page and long in text:
            used.add((of, long))
            text = text.replace(long, short)
    return text


def file(name, text):
    """A file of JSON with what FILES says of it."""
    changes = FILES.get(name)
    if changes is None:
        return text
    content = json.loads(text)
    return json.dumps({**content, **changes, "settings": [*content["settings"], *changes["settings"]]})


def plan(file):
    """Puts the settings of PLAN behind those of a plan's cells."""
    content = json.loads(file.read_text())
    for cell in content["cells"]:
        cell["settings"] = [*cell.get("settings", ()), *PLAN[cell["verb"]]]
    file.write_text(json.dumps(content))


def faults():
    """Entries that were of no use."""
    return [f"{page or 'all pages'}: shorter.py of tests/docs has {what!r}, which nothing begins with any more"
            for table in (SETTINGS, OPTIONS, VALUES, CODE) for page, what in table if (page, what) not in used]
