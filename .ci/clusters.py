"""Studies on real schedulers: Slurm, HyperQueue, GNU parallel, Dask; and Sobol indices by SALib.

    python3 .ci/clusters.py ENG FOLDER [STEP …]

Installs the schedulers by apt and pip (as root) and fails if one cannot be installed. Slurm runs without systemd, as
one node of this machine. The wheel of HyperQueue has its server and worker but not its command `hq`, so a stand-in
reads the words of `hq submit` and gives them to that server. Every collected table must have the bytes of one local
run, whatever was killed in between.
"""

import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

PENDULUM = """use std.joints.Revolute

model Swing {
    param length: Length = 400 mm in (10 mm, 2 m)
    param load: Mass = 1.2 kg
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body bob { mass = load; inertia = [2, 2, 2] g*m^2; marker top = [0, 1, 0]*length }
    joint pin = Revolute(bob.top, pivot)
    start pin.angle = 30 deg
    output height = dot(bob.origin.origin, ground.y) as mm
}

analysis swing = transient(Swing(), duration: 0.5 s, sample: 10 ms)
"""

ISHIGAMI = """model Ishigami {
    param x1: 1 = 0
    param x2: 1 = 0
    param x3: 1 = 0
    output y = sin(x1) + 7*sin(x2)^2 + 0.1*x3^4*sin(x1)
}

analysis shot = assemble(Ishigami())
"""

# the points of the large study; one of them is outside of the limits
POINTS = 10_000
# the points of the others
FEW = 1_000


def say(text):
    print(text, flush=True)


def run(words, code=0, **more):
    """The output of a command that must end with an exit code."""
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **more)
    if done.returncode != code:
        sys.exit(f"{words} ended with {done.returncode}, not {code}:\n{done.stdout}")
    return done.stdout


def install():
    needed = {"sbatch": "slurm-wlm", "munged": "munge", "parallel": "parallel"}
    missing = [package for tool, package in needed.items() if not shutil.which(tool)]
    if missing:
        env = os.environ | {"DEBIAN_FRONTEND": "noninteractive"}
        run(["apt-get", "update", "-q"], env=env)
        run(["apt-get", "install", "-y", "-q", "--no-install-recommends", *missing], env=env)
    packages = ["hyperqueue", "distributed", "SALib", "pyarrow", "polars"]
    run([sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *packages])


def wait(what, ready, seconds):
    """Waits until a function is true, and returns its value. The limit is in seconds of a machine with little else to do."""
    until = time.monotonic() + 4*seconds
    while not (found := ready()):
        if time.monotonic() > until:
            sys.exit(f"{what} did not come in {4*seconds} s")
        time.sleep(0.05)
    return found


def processes(name, belongs):
    """Numbers of the processes of a program for which a function of their folder in /proc is true."""
    found = []
    for process in Path("/proc").iterdir():
        if process.name.isdigit():
            try:
                if (process / "exe").resolve().name == name and belongs(process):
                    found.append(int(process.name))
            except OSError:
                # it has ended
                continue
    return found


def workers(folder):
    """Numbers of the processes of `eng` whose working folder this is."""
    return processes("eng", lambda process: (process / "cwd").resolve() == folder)


def end(process):
    """Kills a process, if it has not ended by itself."""
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass


def parent(process):
    """Number of the process that started another one; of one that has ended its own."""
    try:
        text = Path(f"/proc/{process}/stat").read_text()
    except FileNotFoundError:
        return process
    # the name of the program is in parentheses and may have blanks
    return int(text.rsplit(")", 1)[1].split()[1])


class Studies:
    """The studies of a folder, with the local run to compare with."""

    def __init__(self, eng, folder):
        self.folder = folder.resolve()
        self.eng = str(Path(eng).resolve())
        self.env = os.environ | {"ENG": self.eng, "ENG_CACHE": str(self.folder / "cache")}
        (self.folder / "swing.eng").write_text(PENDULUM)
        random.seed(1)
        rows = [(random.uniform(100, 1900), random.uniform(0.5, 3)) for _ in range(POINTS)]
        rows[FEW // 2] = (3000, 1)
        for name, count in [("large", POINTS), ("small", FEW)]:
            lines = [f"{length},{load}\n" for length, load in rows[:count]]
            (self.folder / f"{name}.csv").write_text("length [mm],load [kg]\n" + "".join(lines))

    def call(self, *words, code=0):
        return run([self.eng, *words], code, cwd=self.folder, env=self.env)

    def plan(self, design, scheduler, out, *more):
        words = ["plan", "swing.eng", "--analysis", "swing", "--design", f"{design}.csv"]
        script = self.folder / f"{out}.sh"
        script.write_text(self.call(*words, "--to", scheduler, "--out", out, *more))
        return script

    def table(self, out):
        return self.folder / out / "swing.points.parquet"

    def same(self, out, design):
        """Compares the table of a study with that of one local run."""
        if self.table(out).read_bytes() != self.table(f"local-{design}").read_bytes():
            sys.exit(f"{out}: its table is not that of the local run")
        files = sum(len(names) for _, _, names in os.walk(self.folder / out))
        say(f"   {out}: the same bytes as one local run; {files} files")
        return files

    def local(self):
        """The tables to compare with."""
        for design in ["large", "small"]:
            began = time.monotonic()
            words = ["run", "swing.eng", "--analysis", "swing", "--design", f"{design}.csv", "--quiet"]
            # exit code 1: a point has failed
            self.call(*words, "--out", f"local-{design}", code=1)
            self.call("collect", f"local-{design}", code=1)
            say(f"   local, {design}: {time.monotonic() - began:.1f} s")


class Slurm:
    """Slurm on one node, with all its files in a folder.

    It begins tasks once a second, as many as the node has processors: more than the machine has save time.
    """

    def __init__(self, folder, env):
        self.folder = folder
        folder.mkdir()
        host = run(["hostname", "-s"]).strip()
        socket = folder / "munge.socket"
        key = folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        (folder / "slurm.conf").write_text(f"""ClusterName=ci
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={socket},cred_expire=5
CredType=cred/munge
CryptoType=crypto/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,sched_interval=1,bf_interval=1
ReturnToService=2
MaxArraySize=1001
SlurmdTimeout=6
KillWait=1
JobRequeue=1
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
SlurmctldPort=16817
SlurmdPort=16818
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
NodeName={host} NodeAddr=127.0.0.1 CPUs=4 RealMemory=1000 State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
""")
        self.env = env | {"SLURM_CONF": str(folder / "slurm.conf")}
        self.daemons = {}
        self.start("munged", "--foreground", "--force", f"--socket={socket}", f"--key-file={key}",
                   f"--pid-file={folder}/munged.pid", f"--log-file={folder}/munged.log", f"--seed-file={folder}/seed")
        wait("munge", socket.exists, 10)
        for name in ["slurmctld", "slurmd"]:
            self.start(name, "-D", "-f", str(folder / "slurm.conf"))
        self.is_idle = lambda: "idle" in self.says("sinfo", "--noheader", "--format=%t")
        wait("the node of Slurm", self.is_idle, 30)

    def start(self, name, *words):
        log = open(self.folder / f"{name}.out", "ab")
        tool = shutil.which(name) or f"/usr/sbin/{name}"
        self.daemons[name] = (subprocess.Popen([tool, *words], stdout=log, stderr=log, env=self.env), words)

    def says(self, *words):
        done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, env=self.env)
        return done.stdout

    def kill(self, name):
        process, words = self.daemons[name]
        process.kill()
        process.wait()
        return words

    def drained(self):
        return not self.says("squeue", "--noheader").strip()

    def stop(self):
        for process, _ in reversed(list(self.daemons.values())):
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()


def on_slurm(studies):
    slurm = Slurm(studies.folder / "slurm", studies.env)
    try:
        script = studies.plan("large", "slurm", "on-slurm", "--per-task", "100")
        began = time.monotonic()
        submit = lambda: run(["sh", str(script)], cwd=studies.folder, env=slurm.env)
        submit()
        part = studies.folder / "on-slurm" / "swing"
        parts = lambda: len(list(part.glob("*.parquet")))
        wait("parts", lambda: parts() >= 20, 60)
        # a worker dies
        end(wait("a worker", lambda: workers(studies.folder), 20)[0])
        wait("parts", lambda: parts() >= 40, 60)
        # the node dies with all its processes
        words = slurm.kill("slurmd")
        # a task is the process of `eng` itself, below its slurmstepd
        tasks = workers(studies.folder)
        for process in list(map(parent, tasks)) + tasks:
            end(process)
        say("   " + studies.call("status", "on-slurm").splitlines()[0])
        wait("the loss of the node", lambda: "down" in slurm.says("sinfo", "--noheader", "--format=%t"), 60)
        slurm.start("slurmd", *words)
        wait("the end of the tasks", slurm.drained, 150)
        say(f"   Slurm: a worker and the node killed, {time.monotonic() - began:.1f} s")
        # Slurm runs the tasks of the lost node again, but not the one that was killed
        status = studies.call("status", "on-slurm").splitlines()[0]
        say("   " + status)
        if int(status.split()[-2]) > 100:
            sys.exit("more is missing than the points of the killed worker")
        # the same script computes the rest
        submit()
        wait("the end of the tasks", slurm.drained, 100)
        files = studies.same("on-slurm", "large")
        if files > 200:
            sys.exit(f"{files} files are more than 200")
    finally:
        slurm.stop()


# reads the words of `hq submit` and gives them to a server and a worker of HyperQueue
HQ = '''#!{python}
import sys
from hyperqueue import Job, LocalCluster
from hyperqueue.cluster import WorkerConfig
from hyperqueue.ffi.protocol import ResourceRequest

words = sys.argv[1:]
assert words.pop(0) == "submit", words
array, cpus = "1-1", 1
while (word := words.pop(0)) != "--":
    if word == "--array":
        array = words.pop(0)
    elif word == "--cpus":
        cpus = int(words.pop(0))
    elif word in ("--name", "--stdout", "--stderr"):
        words.pop(0)
    else:
        assert word == "--wait", word
first, last = map(int, array.split("-"))
# the client numbers tasks from 0, the command as stated
number = ["sh", "-c", 'export HQ_TASK_ID="$0"; exec "$@"']
with LocalCluster() as cluster:
    cluster.start_worker(WorkerConfig(cores=2))
    client = cluster.client()
    job = Job(max_fails=None)
    for task in range(first, last + 1):
        job.program([*number, str(task), *words], resources=ResourceRequest(cpus=cpus))
    sys.exit(0 if client.wait_for_jobs([client.submit(job)], raise_on_error=False) else 1)
'''


def on_hyperqueue(studies):
    tools = studies.folder / "tools"
    tools.mkdir()
    (tools / "hq").write_text(HQ.format(python=sys.executable))
    (tools / "hq").chmod(0o755)
    script = studies.plan("small", "hq", "on-hq", "--per-task", "50")
    began = time.monotonic()
    env = studies.env | {"PATH": f"{tools}:{os.environ['PATH']}"}
    # exit code 1: a point has failed
    run(["sh", str(script)], 1, cwd=studies.folder, env=env)
    say(f"   HyperQueue: {time.monotonic() - began:.1f} s")
    studies.same("on-hq", "small")


def on_parallel(studies):
    part = studies.folder / "on-parallel" / "swing"
    for _ in range(10):
        shutil.rmtree(part.parent, ignore_errors=True)
        script = studies.plan("small", "parallel", "on-parallel", "--per-task", "20")
        began = time.monotonic()
        words = ["sh", str(script), "--jobs", "2", "--will-cite"]
        first = subprocess.Popen(words, cwd=studies.folder, env=studies.env, stdout=subprocess.PIPE,
                                 stderr=subprocess.STDOUT, text=True)
        wait("parts", lambda: len(list(part.glob("*.parquet"))) >= 3, 60)
        end(wait("a worker", lambda: workers(studies.folder), 20)[0])
        said, _ = first.communicate(timeout=240)
        # with exit code 1 nothing is missing: the worker had written its points already
        if first.returncode != 1:
            break
    if first.returncode != 2 or "points are missing" not in said:
        sys.exit(f"the killed worker is not noticed: {first.returncode}\n{said}")
    run(words, 1, cwd=studies.folder, env=studies.env)
    say(f"   GNU parallel: a worker killed, run again, {time.monotonic() - began:.1f} s")
    studies.same("on-parallel", "small")


def on_dask(studies):
    from distributed import Client, LocalCluster

    slices = 20

    def one(index):
        words = [studies.eng, "run", "swing.eng", "--analysis", "swing", "--design", "small.csv", "--quiet"]
        words += ["--slice", f"{index}/{slices}", "--threads", "1", "--out", "on-dask"]
        return subprocess.run(words, cwd=studies.folder, env=studies.env).returncode

    began = time.monotonic()
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            codes = client.gather(client.map(one, range(1, slices + 1)))
    if sorted(codes) != [0] * (slices - 1) + [1]:
        sys.exit(f"Dask: the slices ended with {codes}")
    studies.call("collect", "on-dask", code=1)
    say(f"   Dask: {time.monotonic() - began:.1f} s")
    studies.same("on-dask", "small")


def scaling(studies):
    """Time of one worker against that of two, as processes of GNU parallel."""
    spent, processor = {}, {}
    used = lambda: sum(os.times()[2:4])
    for jobs in [1, 2]:
        script = studies.plan("large", "parallel", f"jobs-{jobs}")
        began, before = time.monotonic(), used()
        run(["sh", str(script), "--jobs", str(jobs), "--will-cite"], 1, cwd=studies.folder, env=studies.env)
        spent[jobs], processor[jobs] = time.monotonic() - began, used() - before
        studies.same(f"jobs-{jobs}", "large")
    share = spent[1] / (2 * spent[2])
    # told and not demanded: other work of the machine slows two workers more than one
    say(f"   one worker {spent[1]:.1f} s, two workers {spent[2]:.1f} s: {100 * share:.0f} % of twice the speed; "
        f"processor time {processor[1]:.1f} s and {processor[2]:.1f} s")


def sobol(studies):
    """First-order and total indices of the Ishigami function against their closed forms (a = 7, b = 0.1)."""
    import numpy
    import pyarrow.parquet
    from SALib.analyze import sobol as indices
    from SALib.sample import sobol as samples

    pi = numpy.pi
    problem = {"num_vars": 3, "names": ["x1", "x2", "x3"], "bounds": [[-pi, pi]] * 3}
    points = samples.sample(problem, 4096, calc_second_order=False, seed=1)
    (studies.folder / "ishigami.eng").write_text(ISHIGAMI)
    numpy.savetxt(studies.folder / "shots.csv", points, fmt="%.17g", delimiter=",", header="x1,x2,x3", comments="")
    began = time.monotonic()
    studies.call("run", "ishigami.eng", "--analysis", "shot", "--design", "shots.csv", "--quiet", "--out", "shots")
    studies.call("collect", "shots")
    table = pyarrow.parquet.read_table(studies.folder / "shots" / "shot.points.parquet")
    y = table["y"].to_numpy()
    exact = numpy.sin(points[:, 0]) + 7 * numpy.sin(points[:, 1]) ** 2 + 0.1 * points[:, 2] ** 4 * numpy.sin(points[:, 0])
    if abs(y - exact).max() > 1e-12:
        sys.exit("the values of the Ishigami function differ")
    found = indices.analyze(problem, y, calc_second_order=False, seed=1)
    first = 0.5 * (1 + 0.1 * pi**4 / 5) ** 2
    both = 8 * 0.1**2 * pi**8 / 225
    variance = first + 7**2 / 8 + both
    closed = {"S1": [first, 7**2 / 8, 0], "ST": [first + both, 7**2 / 8, both]}
    worst = max(abs(found[kind] - numpy.array(values) / variance).max() for kind, values in closed.items())
    say(f"   Sobol indices: {len(y)} points in {time.monotonic() - began:.1f} s; largest error {worst:.4f}")
    if worst > 0.02:
        sys.exit("the indices differ by more than 0.02")


def page(studies):
    """Does what docs/sweeps.md shows: writes its files, runs its commands and its snippets."""
    folder = studies.folder / "page"
    folder.mkdir()
    tools = studies.folder / "path"
    tools.mkdir()
    (tools / "eng").symlink_to(studies.eng)
    env = studies.env | {"PATH": f"{tools}:{os.environ['PATH']}"}
    text = (Path(__file__).parent.parent / "docs" / "sweeps.md").read_text()
    done = 0
    for info, block in re.findall(r"^```(\w+[^\n]*)\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
        kind, _, name = info.partition(" ")
        if kind in ("eng", "csv"):
            (folder / name).write_text(block)
        elif kind == "console":
            # a point of the page fails, with exit code 1
            for line in block.splitlines():
                words = ["sh", "-c", line]
                ended = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=folder, env=env)
                if ended.returncode not in (0, 1):
                    sys.exit(f"{line} ended with {ended.returncode}:\n{ended.stdout}")
        elif kind == "python":
            (folder / "snippet.py").write_text(block)
            run([sys.executable, "snippet.py"], cwd=folder, env=env)
            done += 1
    say(f"   docs/sweeps.md: {done} snippets")


STEPS = [on_slurm, on_hyperqueue, on_parallel, on_dask, scaling, sobol, page]


def main():
    # the daemons of Slurm end also when this script is stopped
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    eng, folder = sys.argv[1], Path(sys.argv[2])
    began = time.monotonic()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    install()
    say(f"   installed: {time.monotonic() - began:.1f} s")
    studies = Studies(eng, folder)
    studies.local()
    for step in STEPS:
        if len(sys.argv) < 4 or step.__name__ in sys.argv[3:]:
            step(studies)
    say(f"   all in {time.monotonic() - began:.0f} s")


main()
