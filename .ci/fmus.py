"""Checks FMUs with FMPy, and follows docs/fmi.md. Usage: fmus.py ENG LIBRARY FOLDER

ENG is the command, LIBRARY the library of Eng, FOLDER gets the FMUs. FMPy must find nothing wrong in the FMU of any example, for
FMI 2.0 and 3.0. Under FMPy an FMU must have the bits of `englang`, also after its state went through a file to another process.
Exits with 1 where something differs.

`fmus.py continue FMU STATE` takes the last steps from the state in a file and prints their bits.
"""

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


def advanced(model):
    """The bits of the same steps by the module `englang`."""
    import englang

    simulation = englang.load(model).model("Rotor").simulation({"inertia": "0.05 kg*m^2"})
    speed, found = simulation.watch("speed"), []
    for step in range(STEPS):
        simulation.set_input("brake", f"{torque(step)!r} N*m")
        simulation.advance(0.01*step + 0.01)
        found.append(bits(speed()[0]))
    return found


def compare(build, model, folder):
    """Steps an FMU of each version, two at a time, and continues from its state in another process."""
    expected, both = advanced(model), []
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
else:
    eng, library, folder = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
    folder.mkdir(parents=True, exist_ok=True)
    os.environ["ENG_LIBRARY"] = str(library)

    def build(model, name, *words):
        run([str(eng), "build", str(model), "--to", "fmu", "--out", str(folder / name), *words], folder)
        return str(folder / name)

    follow(root / "docs/fmi.md", folder, eng)
    compare(build, folder / "rotor.eng", folder)
    short = folder / library.name
    version = run([str(eng), "--version"], folder).split()[-1]
    short.write_text(f"eng-library-version={version}\n")
    os.environ["ENG_LIBRARY"] = str(short)
    validate(build)
