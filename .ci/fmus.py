"""Checks FMUs with FMPy, Ecos and libcosim, and follows docs/fmi.md. Usage: fmus.py ENG LIBRARY FOLDER

ENG is the command, LIBRARY the library of Eng, FOLDER gets the FMUs. FMPy must find nothing wrong in the FMU of any example, for
FMI 2.0 and 3.0. Under FMPy an FMU must have the bits of `englang`, also after its state went through a file to another process.
Exits with 1 where something differs.

Ecos and libcosim are importers in C++ by other authors: Ecos reads FMUs by fmi4c, libcosim by the FMI Library, which many tools use.
They step the same FMUs, and must get the bits of `englang` at their own communication points. The importer `fmi-sim` in Rust
is not used: it locks 343 packages, Arrow among them.

`fmus.py continue FMU STATE` takes the last steps from the state in a file and prints their bits. `fmus.py ecos FMU` and
`fmus.py libcosim FMU` print the bits of all steps under that importer.
"""

import ctypes
import os
import pathlib
import re
import struct
import subprocess
import sys
import time

import fmpy
import fmpy.validation

root = pathlib.Path(__file__).parent.parent
STEPS, KEPT = 100, 40


def run(words, where):
    done = subprocess.run(words, cwd=where, capture_output=True, text=True)
    assert done.returncode == 0, (words, done.stdout, done.stderr)
    return done.stdout


class Instance:
    """An FMU of either version under FMPy."""

    def __init__(self, path):
        self.description = fmpy.read_model_description(path)
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.two = self.description.fmiVersion == "2.0"
        folder = fmpy.extract(path)
        begin = time.perf_counter()
        self.fmu = fmpy.instantiate_fmu(folder, self.description, "CoSimulation")
        self.took = time.perf_counter() - begin

    def set(self, name, value):
        (self.fmu.setReal if self.two else self.fmu.setFloat64)([self.references[name]], [value])

    def get(self, name):
        return (self.fmu.getReal if self.two else self.fmu.getFloat64)([self.references[name]])[0]

    def start(self):
        if self.two:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def state(self):
        state = self.fmu.getFMUstate() if self.two else self.fmu.getFMUState()
        saved = self.fmu.serializeFMUstate(state) if self.two else self.fmu.serializeFMUState(state)
        (self.fmu.freeFMUstate if self.two else self.fmu.freeFMUState)(state)
        return bytes(saved)

    def restore(self, saved):
        state = self.fmu.deSerializeFMUstate(saved) if self.two else self.fmu.deserializeFMUState(saved)
        (self.fmu.setFMUstate if self.two else self.fmu.setFMUState)(state)
        (self.fmu.freeFMUstate if self.two else self.fmu.freeFMUState)(state)


def torque(step):
    return 10.0*(step % 7)/7.0


def bits(value):
    return struct.pack(">d", value).hex()


def steps(one, first, last):
    """The bits of the speed of a rotor after each step."""
    found = []
    for step in range(first, last):
        one.set("brake", torque(step))
        one.fmu.doStep(0.01*step, 0.01)
        found.append(bits(one.get("speed")))
    return found


def validate(build):
    """Looks for mistakes in the FMU of every example, with all channels as outputs.

    FMPy loads no library here, so a short file stands for it: the real one would be compressed for each FMU.
    """
    for path in sorted((root / "examples").glob("*/*.eng")):
        text = path.read_text()
        subjects = [["--model", model] for model in re.findall(r"^model (\w+)", text, re.M)]
        # a file that takes its model from another one
        subjects = subjects or [["--analysis", re.findall(r"^analysis (\w+) =", text, re.M)[0]]]
        for version in ("2", "3"):
            for subject in subjects:
                made = build(path, f"{path.stem}-{version}.fmu", "--fmi", version, "--outputs", "*", *subject)
                problems = fmpy.validation.validate_fmu(made)
                assert not problems, (path, version, problems)
                pathlib.Path(made).unlink()
        print(f"{path.relative_to(root)}: no finding", flush=True)


def advanced(model, ends):
    """The bits of the same steps by the module `englang`, to the ends of the steps (s)."""
    import englang

    simulation = englang.load(model).model("Rotor").simulation({"inertia": "0.05 kg*m^2"})
    speed, found = simulation.watch("speed"), []
    for step, end in enumerate(ends):
        simulation.set_input("brake", f"{torque(step)!r} N*m")
        simulation.advance(end)
        found.append(bits(speed()[0]))
    return found


def compare(build, model, folder):
    """Steps an FMU of each version, two at a time, and continues from its state in another process."""
    expected, both = advanced(model, [0.01*step + 0.01 for step in range(STEPS)]), []
    for version in ("2", "3"):
        made = build(model, f"rotor-{version}.fmu", "--fmi", version)
        one = Instance(made)
        one.set("inertia", 0.05)
        one.start()
        both.append((version, made, one))
    for version, made, one in both:
        begun = steps(one, 0, KEPT)
        (folder / "state").write_bytes(one.state())
        whole = begun + steps(one, KEPT, STEPS)
        assert whole == expected, version
        words = [sys.executable, __file__, "continue", made, str(folder / "state")]
        assert run(words, folder).split() == expected[KEPT:], version
        begin = time.perf_counter()
        for _ in range(10000):
            one.get("speed")
        call = (time.perf_counter() - begin)/10000
        print(f"FMI {version}: the bits of advance; instantiated in {1e3*one.took:.0f} ms, {1e6*call:.1f} us a call of FMPy")
        one.fmu.terminate()
        one.fmu.freeInstance()


def under_ecos(fmu):
    """The bits of the speed after each step under Ecos."""
    # the wheel of Ecos needs this library and does not bring it; the wheel of `tbb` does
    ctypes.CDLL(str(pathlib.Path(sys.prefix) / "lib/libtbb.so.12"), mode=ctypes.RTLD_GLOBAL)
    import ecospy

    structure = ecospy.EcosSimulationStructure()
    structure.add_model("one", fmu)
    structure.add_parameter_set("chosen", {"one::inertia": 0.05})
    simulation, found = ecospy.EcosSimulation(structure=structure, step_size=0.01), []
    simulation.init(parameter_set="chosen")
    for step in range(STEPS):
        simulation.set_real("one::brake", torque(step))
        simulation.step(1)
        found.append(bits(simulation.get_real("one::speed")))
    simulation.terminate()
    return found


def under_libcosim(fmu):
    """The bits of the speed after each step under libcosim. It counts time in nanoseconds."""
    from libcosimpy import CosimExecution, CosimLogging, CosimManipulator, CosimObserver, CosimSlave

    CosimLogging.log_output_level(CosimLogging.CosimLogLevel.WARNING)
    execution, found = CosimExecution.CosimExecution.from_step_size(10_000_000), []
    one = execution.add_local_slave(CosimSlave.CosimLocalSlave(fmu, "one"))
    references = {variable.name.decode(): variable.reference for variable in execution.slave_variables(one)}
    manipulator, observer = CosimManipulator.CosimManipulator.create_override(), CosimObserver.CosimObserver.create_last_value()
    execution.add_manipulator(manipulator)
    execution.add_observer(observer)
    assert execution.real_initial_value(one, references["inertia"], 0.05)
    for step in range(STEPS):
        manipulator.slave_real_values(one, [references["brake"]], [torque(step)])
        assert execution.step()
        found.append(bits(observer.last_real_values(one, [references["speed"]])[0]))
    return found


# The FMI Library of libcosim 0.0.6 asks for a start value of the time, which the standard forbids. Later versions of the FMI Library do
# not (its issue 21). libcosim reads a description twice.
KNOWN = "Start attribute is required for this causality, variability and initial combination"


def others(model, folder):
    """Steps the FMUs under importers of other authors."""
    points, now = [], 0.0
    for _ in range(STEPS):
        now += 0.01
        points.append(now)
    whole = [step*10_000_000/1e9 for step in range(STEPS + 1)]
    nanoseconds = [begin + (end - begin) for begin, end in zip(whole, whole[1:])]
    for importer, version, ends in (("ecos", "2", points), ("ecos", "3", points), ("libcosim", "2", nanoseconds)):
        made = folder / f"rotor-{version}.fmu"
        printed = run([sys.executable, __file__, importer, str(made)], folder)
        complaints = [line for line in printed.splitlines() if re.search(r"\[(error|warning)\]", line)]
        assert len(complaints) <= 2 and all(line.endswith(KNOWN) for line in complaints), (importer, complaints)
        assert re.findall(r"^[0-9a-f]{16}$", printed, re.M) == advanced(model, ends), (importer, version, printed)
        print(f"FMI {version} under {importer}: the bits of advance")


def follow(page, folder, eng):
    """Writes the files of a page, runs its commands and its Python."""
    shown = ""
    for kind, name, text in re.findall(r"^```(\w+) ?([^\n]*)\n(.*?)^```$", page.read_text(), re.M | re.S):
        if name:
            (folder / name).write_text(text)
        elif kind == "console":
            commands = [line.replace("eng ", f"{eng} ", 1) if line.startswith("eng ") else line for line in text.splitlines()]
            shown = "".join(run(["sh", "-c", command], folder) for command in commands)
        elif kind == "text":
            assert shown.endswith(text), (shown, text)
        elif kind == "python":
            print(run([sys.executable, "-c", text], folder), end="")


if sys.argv[1] == "continue":
    last = Instance(sys.argv[2])
    last.restore(pathlib.Path(sys.argv[3]).read_bytes())
    print("\n".join(steps(last, KEPT, STEPS)))
elif sys.argv[1] == "ecos":
    print("\n".join(under_ecos(sys.argv[2])))
elif sys.argv[1] == "libcosim":
    print("\n".join(under_libcosim(sys.argv[2])))
else:
    eng, library, folder = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
    folder.mkdir(parents=True, exist_ok=True)
    os.environ["ENG_LIBRARY"] = str(library)

    def build(model, name, *words):
        run([str(eng), "build", str(model), "--to", "fmu", "--out", str(folder / name), *words], folder)
        return str(folder / name)

    follow(root / "docs/fmi.md", folder, eng)
    compare(build, folder / "rotor.eng", folder)
    others(folder / "rotor.eng", folder)
    short = folder / library.name
    version = run([str(eng), "--version"], folder).split()[-1]
    short.write_text(f"eng-library-version={version}\n")
    os.environ["ENG_LIBRARY"] = str(short)
    validate(build)
