#!/usr/bin/env python3
"""A plan run by Slurm, through everything that ends tasks, nodes, the controller and the submitting process, has ninja's results.

usage: slurm_test.py LODESTONE SOURCE_FOLDER
"""
import hashlib
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time

from slurm_cluster import Cluster

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
scratch = tempfile.TemporaryDirectory()
root = pathlib.Path(scratch.name)
RESULTS = {"collect": ["transitions.h5"], "train-dynamics": ["checkpoint/manifest.json"],
           "train-policy": ["checkpoint/manifest.json"], "deploy": ["trials.json"]}


def cell(name, verb, *settings, **more):
    return {"id": name, "verb": verb, "settings": list(settings), **more}


cells = [cell("data", "collect", "sensor.kind=simulated", "transitions=1500", config="quickstart/collect.json")]
for i in (1, 2):
    cells += [
        cell(f"dynamics/{i}", "train-dynamics", "data={data}/transitions.h5", "training.epochs=200", "training.checkpoint_interval_s=0.5",
             config="quickstart/dynamics.json", seed=i),
        cell(f"policy/{i}", "train-policy", f"dynamics={{dynamics/{i}}}/checkpoint", "training.env_steps=40000", "training.warm_up_steps=1000",
             "training.evaluate_every=4000", "training.checkpoint_every_s=0.5", config="quickstart/policy.json", seed=i),
        cell(f"deploy/{i}", "deploy", f"policy={{policy/{i}}}/checkpoint", "task=point", "trials.count=2", "sensor.kind=simulated",
             config="best/deploy.json", minutes=20)]
cells.append(cell("deploy/both", "deploy", "policy={policy/1}/checkpoint", "dynamics={dynamics/2}/checkpoint", "task=point", "trials.count=2",
                  "sensor.kind=simulated", config="best/deploy.json", all_threads=True))
(root / "plan.json").write_text(json.dumps({"memory_mb": 500, "keep_checkpoints": False, "cells": cells}))
(root / "failing.json").write_text(json.dumps({"cells": [
    cell("bad", "train-dynamics", "data=/nowhere/transitions.h5"), cell("good", "collect", "sensor.kind=simulated", "transitions=200"),
    cell("waits", "train-dynamics", "data={bad}/transitions.h5"), cell("goes_on", "train-dynamics", "data={good}/transitions.h5", "training.epochs=1")]}))


def plan_run(out, engine, plan="plan.json"):
    return [program, "plan", "run", str(root / plan), "--out", str(root / out), "--engine", engine, "--threads", "2"]


def bench_paper(out, engine, *more):
    return [program, "bench", "paper", "--out", str(root / out), "--engine", engine, "--threads", "2", *more]


def plan_in(out):
    file = root / out / "plan.json"
    return json.loads(file.read_text()) if file.exists() else {"cells": []}


def folder(out, plan, name):
    return root / out / plan.get("subfolder", "") / name


def results(out):
    """Bytes, but for times: a checkpoint's hashes of its tensors."""
    found, plan = {}, plan_in(out)
    for each in plan["cells"]:
        for name in RESULTS[each["verb"]]:
            file = folder(out, plan, each["id"]) / name
            found[each["id"], name] = json.loads(file.read_text())["files"] if name.endswith("manifest.json") else (
                json.loads(file.read_text()) if name.endswith(".json") else hashlib.sha256(file.read_bytes()).hexdigest())
    return found


def state(out, name, plan=None):
    file = folder(out, plan or plan_in(out), name) / "run.json"
    return json.loads(file.read_text()) if file.exists() else {}


class Finished(threading.Thread):
    """When each cell was finished first: it is not to be run again."""

    def __init__(self, out):
        super().__init__(daemon=True)
        self.out, self.first, self.ended = out, {}, False
        self.start()

    def run(self):
        while not self.ended:
            plan = plan_in(self.out)
            for each in plan["cells"]:
                told = state(self.out, each["id"], plan)
                if told.get("finished"):
                    self.first.setdefault(each["id"], told["updated_utc"])
            time.sleep(0.1 if len(plan["cells"]) < 100 else 1.0)

    def check(self):
        self.ended = True
        self.join()
        for name, when in self.first.items():
            assert state(self.out, name)["updated_utc"] == when, f"{name} was run again"


def task_of(cluster, out, name):
    """Job, task and node of a cell that is running; nothing while it is not."""
    for line in cluster.ask("squeue", "-h", "--array", "--states=RUNNING", "-o", "%F %K %k %N").splitlines():
        job, index, key, node = line.split()
        if key != "last" and json.loads((root / out / f"slurm/{key}.json").read_text())["cells"].get(index) == name:
            return f"{job}_{index}", node
    return None


def wait_until_running(cluster, out, name):
    cluster.wait_for(lambda: state(out, name).get("checkpoint") and task_of(cluster, out, name), f"{name} does not begin", 90)
    return task_of(cluster, out, name)


def wait_for_a_policy(cluster, out):
    """That has only begun to learn: its name."""
    def young():
        plan = plan_in(out)
        for each in plan["cells"]:
            told = state(out, each["id"], plan) if each["verb"] == "train-policy" else {}
            if 0 < told.get("done", 0) < 0.5 * told["total"] and task_of(cluster, out, each["id"]):
                found.append(each["id"])
                return True
        return False
    found = []
    cluster.wait_for(young, "no policy is learned", 900)
    return found[0]


def wait_until_elsewhere(cluster, out, name, node):
    cluster.wait_for(lambda: (task_of(cluster, out, name) or ("", node))[1] != node, "the lost node's task is not run on the other", 90)


def submitted(out):
    return sorted(file.name for file in (root / out / "slurm").glob("*.job"))


def begun(cluster, command):
    return subprocess.Popen(command, env=cluster.environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def started(cluster, out, plan="plan.json"):
    return begun(cluster, plan_run(out, "slurm", plan))


def ends(process, code, seconds=150):
    said = process.communicate(timeout=seconds)[1]
    assert process.returncode == code, f"exit {process.returncode}, not {code}:\n{said[-3000:]}"
    return said


def kill_cell(cluster, name):
    """The cell alone, as the kernel does where memory is short; the script that waits for it goes on."""
    found = [process for process in cluster.of_jobs() if f"/{name}\0--resume".encode() in pathlib.Path(f"/proc/{process}/cmdline").read_bytes()]
    assert len(found) == 1, found
    os.kill(found[0], signal.SIGKILL)


def everything_that_ends_tasks(cluster):
    finished = Finished("all")
    running = started(cluster, "all")
    wait_until_running(cluster, "all", "dynamics/1")
    kill_cell(cluster, "dynamics/1")  # is run again by Slurm
    task, _ = wait_until_running(cluster, "all", "dynamics/2")
    cluster.ask("scancel", task)  # is not; what needs it is cancelled with it
    running.kill()
    running.wait()
    cluster.wait_for(lambda: task_of(cluster, "all", "dynamics/2") is None, "scancel does not end a task")
    before = submitted("all")
    running = started(cluster, "all")  # the same command finds what still runs, and submits the rest
    _, node = wait_until_running(cluster, "all", "policy/1")
    assert len(submitted("all")) == len(before) + 4, "cells of the second half are submitted again, and no others"
    cluster.kill(node)
    cluster.kill("slurmctld")
    time.sleep(2)
    cluster.start_controller()
    wait_until_elsewhere(cluster, "all", "policy/1", node)
    ends(running, 0)
    finished.check()
    log = (root / "all/dynamics/1.log").read_text()
    assert "it is run again, and goes on where it was" in log, log
    assert not (root / "all/policy/1/training").exists()
    assert "8 of 8 runs are finished" in (root / "all/slurm/last.log").read_text()
    cluster.start_node(node)


def stopped_and_gone_on(cluster):
    finished = Finished("stopped")
    running = started(cluster, "stopped")
    wait_until_running(cluster, "stopped", "dynamics/1")
    running.send_signal(signal.SIGINT)
    ends(running, 130)
    assert cluster.ask("squeue", "-h") == "", "Ctrl-C left jobs"
    running = started(cluster, "stopped")
    wait_until_running(cluster, "stopped", "policy/1")
    assert "== policy/1 " in told(cluster, "plan", "logs", str(root / "stopped"))
    assert "asked to stop" in told(cluster, "plan", "cancel", str(root / "stopped"))
    ends(running, 130)
    assert cluster.ask("squeue", "-h") == "", "plan cancel left jobs"
    ends(started(cluster, "stopped"), 0)
    finished.check()


def a_cell_that_fails(cluster):
    said = ends(started(cluster, "failing", "failing.json"), 1)
    assert "2 of 4 cells are not finished, 1 of them because they wait for others; the first, bad:" in said, said
    assert state("failing", "goes_on").get("finished"), "a cell that needs nothing that failed was not run"


def told(cluster, *words):
    return subprocess.run([program, *words], env=cluster.environment, capture_output=True, text=True, check=True).stdout


def a_sweep_that_lost_its_command(cluster):
    """Its jobs outlive it, and are cancelled from elsewhere."""
    (root / "sweep.json").write_text(json.dumps({
        "verb": "train-dynamics", "config": ["quickstart/dynamics.json"], "seeds": 2, "score": "evaluation.position_rms_mm",
        "settings": [f"data={root / 'ninja/data/transitions.h5'}", "training.epochs=5000"]}))
    running = subprocess.Popen([program, "sweep", str(root / "sweep.json"), "--out", str(root / "sweep"), "--engine", "slurm"],
                               env=cluster.environment, stderr=subprocess.DEVNULL)
    cluster.wait_for(lambda: cluster.ask("squeue", "-h", "--states=RUNNING"), "the sweep does not begin", 60)
    running.kill()
    running.wait()
    assert cluster.ask("squeue", "-h"), "the jobs ended with the command"
    said = told(cluster, "sweep", "cancel", str(root / "sweep"))
    assert "its jobs are cancelled" in said, said
    cluster.wait_for(lambda: cluster.ask("squeue", "-h") == "", "sweep cancel left jobs")


def the_last_job_reports(cluster):
    """Though the command is gone, and most cells were cancelled."""
    (root / "tiny.json").write_text(json.dumps({"seeds": 1, "ablation_seeds": 1, "transitions": 600, "data_sizes": [300], "trials": 1}))
    running = begun(cluster, bench_paper("paper", "slurm", "--config", str(root / "tiny.json")))
    cluster.wait_for(lambda: (root / "paper/slurm/last.job").exists(), "the last job is not submitted")
    running.kill()
    running.wait()
    arrays = [(root / "paper/slurm" / name).read_text().strip() for name in submitted("paper") if name != "last.job"]
    cluster.ask("scancel", *arrays)
    cluster.wait_for(lambda: cluster.ask("squeue", "-h") == "", "the last job does not end")
    said = (root / "paper/slurm/last.log").read_text()
    assert "not run yet" in said and (root / "paper/report.html").exists(), said


def the_papers_smoke_plan(cluster):
    """All of it, through the same: bit for bit what ninja makes of it."""
    smoke = ("--scale", "smoke")
    subprocess.run(bench_paper("smoke_ninja", "ninja", *smoke), check=True, capture_output=True)
    finished = Finished("smoke")
    running = begun(cluster, bench_paper("smoke", "slurm", *smoke))
    kill_cell(cluster, wait_for_a_policy(cluster, "smoke"))
    cancelled = wait_for_a_policy(cluster, "smoke")
    cluster.ask("scancel", task_of(cluster, "smoke", cancelled)[0])
    running.kill()
    running.wait()
    last, killed_s = root / "smoke/slurm/last.job", time.time()
    cluster.wait_for(lambda: task_of(cluster, "smoke", cancelled) is None, "scancel does not end a task")
    before = submitted("smoke")
    running = begun(cluster, bench_paper("smoke", "slurm", *smoke))
    cluster.wait_for(lambda: last.exists() and last.stat().st_mtime > killed_s, "what was cancelled is not submitted again")
    assert len(submitted("smoke")) > len(before)
    time.sleep(10)  # until the controller has saved what it was given
    moved = wait_for_a_policy(cluster, "smoke")
    _, node = task_of(cluster, "smoke", moved)
    cluster.kill(node)
    cluster.kill("slurmctld")
    time.sleep(2)
    cluster.start_controller()
    wait_until_elsewhere(cluster, "smoke", moved, node)
    cluster.start_node(node)
    ends(running, 0, 7200)
    finished.check()
    made = results("smoke")
    assert made == results("smoke_ninja"), [key for key, value in results("smoke_ninja").items() if made.get(key) != value]
    return len(plan_in("smoke")["cells"])


def main():
    subprocess.run(plan_run("ninja", "ninja"), check=True, capture_output=True)
    expected = results("ninja")
    with Cluster() as cluster:
        a_cell_that_fails(cluster)
        a_sweep_that_lost_its_command(cluster)
        the_last_job_reports(cluster)
        everything_that_ends_tasks(cluster)
        assert results("all") == expected
        stopped_and_gone_on(cluster)
        assert results("stopped") == expected
        count = the_papers_smoke_plan(cluster) if os.environ.get("LODESTONE_SOAK") else 0
    print(f"soak: {len(cells)} cells, and {count} of the paper's smoke plan, by Slurm and by ninja, seed 1")
    print("a plan by Slurm: tasks killed and cancelled, a node and the controller lost, stopped and gone on; the same results")


if __name__ == "__main__":
    main()
