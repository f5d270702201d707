"""A Slurm cluster of two nodes on this machine, in a temporary folder, for as long as a `with` block lasts."""
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "scontrol")

CONFIGURATION = """
ClusterName=lodestone
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CryptoType=crypto/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=2,sched_min_interval=0,bf_interval=2
SlurmdParameters=config_overrides
SlurmdTimeout=8
KillWait=10
MinJobAge=10
ReturnToService=2
MaxArraySize={max_array_size}
MaxJobCount={max_job_count}
NodeName=n1 NodeAddr=127.0.0.1 NodeHostname={host} Port={ports[1]} CPUs=2 RealMemory=100000
NodeName=n2 NodeAddr=127.0.0.1 NodeHostname={host} Port={ports[2]} CPUs=2 RealMemory=100000
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class Cluster:
    """Daemons run in the foreground as children of this process, and are killed at the end of the block, jobs included."""

    def __init__(self, max_array_size=1001, max_job_count=10000):
        missing = [name for name in PROGRAMS if shutil.which(name) is None]
        if missing:
            sys.exit(f"Slurm cannot be started here: {', '.join(missing)} missing; apt-get install slurm-wlm munge")
        if os.geteuid() != 0:
            sys.exit("Slurm cannot be started here: this test needs to be root, as slurmd does")
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="slurm-"))
        self.folder.chmod(0o755)  # munged refuses a socket that others cannot reach
        (self.folder / "state").mkdir()
        self.daemons = {}
        self.environment = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf")}
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], folder=self.folder, ports=free_ports(3),
            max_array_size=max_array_size, max_job_count=max_job_count))

    def __enter__(self):
        try:
            key = self.folder / "munge.key"
            key.write_bytes(os.urandom(128))
            key.chmod(0o400)
            self.start("munged", "--foreground", "--force", "--num-threads=2", *(f"--{option}={self.folder}/munge.{ending}" for option, ending in (
                ("socket", "socket"), ("key-file", "key"), ("pid-file", "pid"), ("log-file", "log"), ("seed-file", "seed"))))
            self.wait_for(lambda: (self.folder / "munge.socket").exists(), "munged does not answer")
            self.start_controller()
            for node in ("n1", "n2"):
                self.start_node(node)
            self.wait_for(lambda: self.ask("sinfo", "-h", "-N", "-o", "%T").split() == ["idle"] * 2, "the nodes do not come up")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for daemon in self.daemons.values():
            daemon.terminate()
        for process in self.of_jobs():
            os.kill(process, signal.SIGKILL)
        for daemon in self.daemons.values():
            try:
                daemon.wait(timeout=10)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def start(self, name, *arguments, called=None):
        log = open(self.folder / f"{called or name}.out", "a")
        self.daemons[called or name] = subprocess.Popen([shutil.which(name), *arguments], env=self.environment, stdout=log, stderr=log)

    def start_controller(self):
        self.start("slurmctld", "-D", "-f", self.environment["SLURM_CONF"])
        self.wait_for(lambda: "UP" in self.ask("scontrol", "ping"), "slurmctld does not answer")

    def start_node(self, node):
        self.start("slurmd", "-D", "-N", node, "-f", self.environment["SLURM_CONF"], called=node)

    def kill(self, name):
        """Without a word, as a machine that loses its power; what runs on a node goes with it."""
        self.daemons[name].kill()
        self.daemons[name].wait()
        for process in self.of_jobs(node=name):
            os.kill(process, signal.SIGKILL)

    def of_jobs(self, node=None):
        """What runs the jobs of this cluster (slurmstepd, first) and their processes: each has the cluster's configuration
        in its environment."""
        stewards, tasks = [], []
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                environment = (process / "environ").read_bytes().decode(errors="replace").split("\0")
                steward = (process / "cmdline").read_bytes().startswith(b"slurmstepd")
                parent = int((process / "stat").read_text().rpartition(")")[2].split()[1])
            except OSError:
                continue
            if f"SLURM_CONF={self.environment['SLURM_CONF']}" not in environment:
                continue
            if steward and node is None:
                stewards.append(int(process.name))
            elif any(entry.startswith("SLURM_JOB_ID=") for entry in environment) and node in (None, *(
                    entry.partition("=")[2] for entry in environment if entry.startswith("SLURMD_NODENAME="))):
                tasks.append(int(process.name))
                if node is not None and b"slurmstepd" in pathlib.Path(f"/proc/{parent}/cmdline").read_bytes():
                    stewards.append(parent)
        return stewards + tasks

    def ask(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=60).stdout

    def wait_for(self, condition, complaint, seconds=60):
        deadline = time.time() + seconds
        while not condition():
            if time.time() > deadline:
                logs = "".join(f"\n== {log.name}\n{log.read_text()[-1500:]}" for log in sorted(self.folder.glob("*.log")) + sorted(self.folder.glob("*.out")))
                raise AssertionError(f"Slurm cannot be used here: {complaint}{logs}")
            time.sleep(0.2)
