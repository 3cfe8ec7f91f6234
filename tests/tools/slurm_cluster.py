"""Slurm of two nodes on this machine's loopback: slurmctld, two slurmd and munged of their own, in a folder of their own."""
import contextlib
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch")
SECONDS_TO_START = 60

CONFIGURATION = """\
ClusterName=vpm
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
StateSaveLocation={folder}/state
SlurmctldPidFile={folder}/slurmctld.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmdLogFile={folder}/slurmd.%n.log
SlurmdSpoolDir={folder}/spool.%n
SlurmdTimeout=10
MinJobAge=300
MaxArraySize=2001
ReturnToService=2
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0
SlurmdParameters=config_overrides
NodeName=n1 NodeAddr=127.0.0.1 NodeHostname={host} Port={port1} CPUs={cores} RealMemory=2000
NodeName=n2 NodeAddr=127.0.0.1 NodeHostname={host} Port={port2} CPUs={cores} RealMemory=2000
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
"""


def missing():
    """Returns the names of the programs that are not installed."""
    return [name for name in PROGRAMS if not shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin:/sbin")]


def free_ports(count):
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]


class Cluster:
    """Context manager. `environment` is what commands of Slurm need."""

    def __init__(self, folder, cores=16):
        self.folder = pathlib.Path(folder)
        self.processes = {}
        port, port1, port2 = free_ports(3)
        for name in ("state", "spool.n1", "spool.n2"):
            (self.folder / name).mkdir(parents=True)
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], folder=self.folder, port=port, port1=port1, port2=port2, cores=cores))
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        self.environment = os.environ | {"SLURM_CONF": str(self.folder / "slurm.conf"), "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin"}

    def __enter__(self):
        try:
            self.start("munged", "-F", "-f", f"--socket={self.folder}/munge.socket", f"--key-file={self.folder}/munge.key",
                       f"--pid-file={self.folder}/munged.pid", f"--log-file={self.folder}/munged.log", f"--seed-file={self.folder}/munged.seed")
            self.wait_until("munged", lambda: (self.folder / "munge.socket").exists())
            self.start("slurmctld", "-D", "-c")
            for node in ("n1", "n2"):
                self.start_node(node)
            self.wait_until("Slurm", lambda: self.say("sinfo", "-h", "-o", "%D %t").split() == ["2", "idle"])
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for process in reversed(self.processes.values()):
            if process.poll() is None:
                process.terminate()
        for process in self.processes.values():
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()

    def start(self, *command, name=None):
        log = open(self.folder / f"{name or command[0]}.out", "wb")
        environment = self.environment | ({"VPM_NODE": name} if name else {})
        self.processes[name or command[0]] = subprocess.Popen(command, env=environment, stdout=log, stderr=log, stdin=subprocess.DEVNULL)

    def start_node(self, node):
        self.start("slurmd", "-D", "-N", node, name=node)

    def kill_node(self, node):
        """Kills the node's daemon and all that it started, as a machine that loses power."""
        of_cluster, of_node = f"SLURM_CONF={self.folder}/slurm.conf", (f"VPM_NODE={node}", f"SLURMD_NODENAME={node}")
        for entry in pathlib.Path("/proc").iterdir():
            with contextlib.suppress(OSError):
                words = entry.joinpath("environ").read_bytes().decode(errors="replace").split("\0") if entry.name.isdigit() else []
                if of_cluster in words and any(word in words for word in of_node):
                    os.kill(int(entry.name), signal.SIGKILL)
        self.processes[node].wait()

    def say(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, check=False).stdout

    def wait_until(self, what, condition):
        end = time.monotonic() + SECONDS_TO_START
        while not condition():
            if time.monotonic() > end:
                raise SystemExit(f"{what} does not start: see {self.folder}\n" + self.say("sinfo", "-N", "-l"))
            time.sleep(0.1)

