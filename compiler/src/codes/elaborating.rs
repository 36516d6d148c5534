//! Codes of elaboration: instances, numbers, files. They are about values; those of checking are about types.
//! The lint of tables (`W0760`) is here, too, because elaboration finds it.

eng_grammar::codes! {
    ELABORATING:

    INDEX_OUTSIDE = "E0501", "an index is outside its array",
        "Indices of lists count from 1; items that are declared with a binder have its values as indices: `pin[i in 2..4]` has no `pin[1]`.",
        "body rod[i in 1..4] { mass = 1 kg }\noutput weight = rod[5].mass",
        "body rod[i in 1..4] { mass = 1 kg }\noutput weight = rod[4].mass";
    ENDLESS = "E0502", "a definition uses itself without end",
        "A component that contains itself, or parts whose arguments need each other, have no first instance. More than 100 nested uses give the same message.",
        "component Link(a: Marker) { part next = Link(a) }",
        "part link[i in 1..4] = Link(a)";
    TOO_MANY_INSTANCES = "E0503", "a model has too many instances",
        "The model has more than 20 000 bodies, elements, parts and indices. Perhaps the range of a binder is longer than intended.",
        "body rod[i in 1..40000] { mass = 1 kg }",
        "body rod[i in 1..4] { mass = 1 kg }";
    NOT_KNOWN = "E0504", "a value must be a constant",
        "The points of a table, limits, exponents and ranges are fixed when the model is compiled; a `param` changes afterwards. Make it a `const`, or use it at a place that may vary.",
        "param top: Length = 4 mm\ntable lift(theta: CrankAngle) -> Length = points([0, 30] deg, [0 mm, top], extrapolation: hold)",
        "const top = 4 mm\ntable lift(theta: CrankAngle) -> Length = points([0, 30] deg, [0 mm, top], extrapolation: hold)";
    DIVISION_BY_ZERO = "E0505", "a division by zero",
        "The divisor is zero with the constants of this model.",
        "const gaps = cylinders - cylinders\nlet pitch = 400 mm/gaps",
        "const gaps = cylinders - 1\nlet pitch = 400 mm/gaps";
    NO_RATE = "E0506", "a value has no known time derivative",
        "Accelerations, reactions and states of other elements follow from the solution of the equations; their rates do not. An input that holds its values jumps and has no rate; with `interpolation: linear` or `cubic` it has one. Positions, angles and velocities have a `der`.",
        "output jerk = der(pin.acceleration) in ground",
        "output acceleration = pin.acceleration in ground";
    LATE_ACCELERATION = "E0507", "an acceleration is used outside outputs, through a function or in a message",
        "Accelerations follow from the forces. A function that is passed as an argument and takes `der` of a velocity can be used in outputs only, and a message cannot show one.",
        "fn rate(v: Velocity) -> Acceleration = der(v)\nforce drag = Drag(ball.origin, ground, law: rate)",
        "fn damp(v: Velocity) -> Acceleration = v/1 s\nforce drag = Drag(ball.origin, ground, law: damp)";
    DIRECTION = "E0508", "a direction has the length zero, or two are parallel",
        "A direction of length zero has no meaning. Only the direction of `x:` and `z:` counts, and not their length. If both are stated, x is made perpendicular to z, so they must not be parallel.",
        "marker main = at(origin, z: [0, 0, 0])",
        "marker main = at(origin, z: [0, 0, 1])";
    GROUND_ALONE = "E0509", "`ground` needs another marker beside it",
        "As an argument, `ground` is a marker at the place of the element's other marker at the start. Without another marker it has no place: name a marker of the model.",
        "joint pin = Revolute(ground, ground)",
        "marker rail = [0, 0, 0] mm\njoint pin = Revolute(crank.main, rail)";
    LENGTHS = "E0510", "two lists differ in length",
        "With the constants of this model, lists of different lengths are added, equated or paired, or a vector is made of other than three numbers.",
        "const spread = [i*1 mm for i in 1..2]\nlet place = [1, 2, 3] mm + spread",
        "const spread = [i*1 mm for i in 1..3]\nlet place = [1, 2, 3] mm + spread";
    UNMOVED = "E0511", "a constraint does not depend on the motion",
        "Both sides depend on parameters alone, so no motion can satisfy the equation. A condition on parameters is a `require`.",
        "joint Rod(a: Marker, b: Marker, length: Length) { constrain length == 100 mm }",
        "joint Rod(a: Marker, b: Marker, length: Length) { constrain norm(a.origin - b.origin) == length }";
    ELEMENT_TOO_LARGE = "E0512", "one element is too large",
        "One element or output touches at most 64 markers, 64 states, 256 equations, 16 rotations, 1024 channels of others and 4096 numbers, and takes at most 100 000 operations. Divide it into several.",
        "", "";
    REQUIRED = "E0513", "a `require` does not hold",
        "The class or model has a condition that the constants of this model do not fulfil. The author of the condition wrote the text of the message.",
        "require cylinders > 4 else \"this crank is for more than four cylinders\"",
        "const cylinders = 6\nrequire cylinders > 4 else \"this crank is for more than four cylinders\"";
    MESSAGE_FORM = "E0514", "a message shows something other than a number or a text",
        "The braces contain an expression whose value is a number, a text or a list of them. A message of a report takes only names: give other expressions a name with `let`.",
        "require gap > 1 mm else \"the gap at {marker} is too small\"",
        "require gap > 1 mm else \"the gap is {abs(gap) as um}\"";
    TWO_CYCLES = "E0515", "a model has several cycles",
        "The model and its components state one cycle angle between them.",
        "cycle angle = rotation(crank.main, ground) { period = 720 deg }\npart second = EngineWithCycle()",
        "cycle angle = rotation(crank.main, ground) { period = 720 deg }\npart second = EngineWithoutCycle()";
    LONG_RANGE = "E0516", "a range is endless or too long",
        "The step is zero, or it has the wrong sign, or there are more than 100 000 values.",
        "analysis sweep[b in 80 mm .. 90 mm by -1 mm] = assemble(M(bore: b))",
        "analysis sweep[b in 80 mm .. 90 mm by 1 mm] = assemble(M(bore: b))";
    ANALYSIS_VALUE = "E0517", "a number of an analysis is out of its range",
        "`duration`, `sample`, `step` and `tolerance` are positive; `rho` is from 0 to below 1; `change` is positive and below 1, `cycles` a whole number from 2.",
        "analysis run = transient(M(), duration: 0 s, sample: 1 ms)",
        "analysis run = transient(M(), duration: 1 s, sample: 1 ms)";
    FILE = "E0518", "a data file cannot be read",
        "Data files lie in the folder of the model or below it, and are UTF-8 text. A module in a folder reads files beside itself.",
        "table gas(theta: CrankAngle) -> AbsolutePressure = csv(\"../gas.csv\", columns: [\"theta [deg]\", \"p [bar]\"])",
        "table gas(theta: CrankAngle) -> AbsolutePressure = csv(\"gas.csv\", columns: [\"theta [deg]\", \"p [bar]\"])";
    FILE_CONTENT = "E0519", "a data file does not hold the stated columns or numbers",
        "The first row is the header, its names are those in `columns`, and every row below holds finite numbers in these columns. Lines that begin with # are skipped.",
        "", "";
    COLUMN_UNIT = "E0520", "a column has another unit than its table",
        "The unit in the brackets of a column's name is a unit of the table's dimension; without brackets the column is in 1.",
        "table gas(theta: CrankAngle) -> AbsolutePressure = csv(\"gas.csv\", columns: [\"theta [deg]\", \"p [mm]\"])",
        "table gas(theta: CrankAngle) -> AbsolutePressure = csv(\"gas.csv\", columns: [\"theta [deg]\", \"p [bar]\"])";
    TABLE_POINTS = "E0521", "the points of a table define no function",
        "Arguments increase, and there are at least two points. The points of a periodic table span at most a period. If they span a whole period, the last value equals the first.",
        "table lift(theta: CrankAngle) -> Length = points([0, 30, 30] deg, [0, 4, 5] mm)",
        "table lift(theta: CrankAngle) -> Length = points([0, 30, 60] deg, [0, 4, 5] mm)";
    MOTION = "E0522", "a value of the motion is used in place of a parameter",
        "Masses, places of markers, gravity and arguments of components are fixed during a run; positions and time are not. Use them in classes and outputs.",
        "gravity = [0, -1, 0]*1 m/s^2*(1 + time/1 s)",
        "gravity = [0, -9.81, 0] m/s^2";
    OUTPUTS_ONLY = "E0523", "a reaction, or a state of another element, is used outside outputs",
        "Elements can use markers and parameters. Only outputs of the model can use the loads of other elements.",
        "force brake = Brake(crank.main, ground, load: pin.force.x)",
        "output braked = 0.3*pin.force.x as kN";
    NOT_COUNTABLE = "E0524", "a whole number is too large to count with",
        "Counts, indices and the ends of ranges of whole numbers are below 9e15.",
        "const count = 9000000000000000*9000000000000000\nlet all = sum(i for i in 1..count)",
        "const count = 9000\nlet all = sum(i for i in 1..count)";
    FLEXIBLE_NUMBER = "E0525", "a number of a flexible body makes no sense",
        "Radii, widths and numbers of nodes and modes are positive, damping is not negative, Poisson's ratio is below 1/2.",
        "flexible crank { marker main = ring(center: [0, 0, 0] mm, axis: z, radius: 0 mm, width: 20 mm) }",
        "flexible crank { marker main = ring(center: [0, 0, 0] mm, axis: z, radius: 27 mm, width: 20 mm) }";
    FLEXIBLE_MATRICES = "E0526", "a flexible body has one matrix from a file and one from its mesh",
        "Stiffness and mass of two sources do not belong to one structure. Give both from files, or neither.",
        "flexible block { stiffness = op4(\"block.op4\", matrix: \"KGG\") }",
        "flexible block { stiffness = op4(\"block.op4\", matrix: \"KGG\"); mass = op4(\"block.op4\", matrix: \"MGG\") }";
    MODE_MARKER = "E0527", "a mode set or support names a marker that its body does not have",
        "Names in a mode set are names of markers of the flexible body that uses it.",
        "flexible crank { marker main = node(12); modes = static(at: mian) }",
        "flexible crank { marker main = node(12); modes = static(at: main) }";
    SAME_BODY = "E0528", "an element constrains a body against itself",
        "All its markers are on one rigid body, or all on the ground: they never move against each other, so its equations hold nothing.",
        "joint pin = Revolute(pivot, pivot)",
        "joint pin = Revolute(bob.top, pivot)";
    EMPTY_LIST = "E0529", "a minimum or maximum of an empty list",
        "With the constants of this model the list has no element. State the value for this case. A sum of an empty list is zero.",
        "const gaps = 0\nlet least = min(1 mm for i in 1..gaps)",
        "const gaps = 0\nlet least = if gaps > 0 then min(1 mm for i in 1..gaps) else 0 mm";
    CYCLE_PERIOD = "E0530", "the period of the cycle is not positive",
        "The cycle's angle is counted in periods: 360 deg for a two-stroke engine or a machine, 720 deg for a four-stroke engine.",
        "cycle angle = rotation(crank.main, ground) { period = 0 deg }",
        "cycle angle = rotation(crank.main, ground) { period = 720 deg }";
    NOT_HANDED_ON = "E0531", "an analysis gives a model something that it cannot hand on",
        "Arguments of a model in an analysis are numbers, texts, truth values, mode sets, classes, records, and lists of these. A function or a table is defined where it is used; an `input` of the model takes a function or table of time by its name.",
        "analysis soft = transient(Rig(law: soft_spring), duration: 1 s)",
        "analysis soft = transient(Rig(stiffness: 2 N/mm), duration: 1 s)";
    CHANNEL_TWICE = "E0532", "two columns of the results have one name",
        "Every output is a column, named by its path. `time`, `cycle.angle`, `cycle.speed` and the `energy` audit are columns of every run. Rename the output, or the part that it is in.",
        "output time = 2*pi/speed",
        "output revolution_time = 2*pi/speed";
    TOO_MANY_USES = "E0533", "functions and values are put in too often",
        "The compiler inserts a function at each call, and a value of the motion at each use. In a chain of thirty functions that each call the next one twice, the last one would be inserted half a billion times. Give a value that is used twice a name with `let`.",
        "fn a(x: 1) -> 1 = x*x\nfn b(x: 1) -> 1 = a(x)*a(x)\nfn c(x: 1) -> 1 = b(x)*b(x)",
        "fn a(x: 1) -> 1 = x*x\nfn b(x: 1) -> 1 { let y = a(x); y*y }\nfn c(x: 1) -> 1 { let y = b(x); y*y }";
    BELOW_ZERO = "E0534", "a table holds an absolute pressure or a temperature below zero",
        "Absolute pressures count from vacuum and temperatures from 0 K: smaller values do not exist. The numbers are gauge pressures (`barg`), differences, or have another unit or sign.",
        "table gas(theta: CrankAngle) -> AbsolutePressure = points([0, 180, 360] deg, [-0.2, 30, -0.2] bar, periodic: 360 deg)",
        "table gas(theta: CrankAngle) -> AbsolutePressure = points([0, 180, 360] deg, [-0.2, 30, -0.2] barg, periodic: 360 deg)";
    GRID = "E0535", "a file of a table of several arguments does not hold a complete grid",
        "The file has one row for each combination of the points of all arguments, in any order, and no combination twice. Numbers that differ by a billionth of the column's span are one point.",
        "", "";
    NOT_IN_LIST = "E0536", "a list does not hold the number that is looked for",
        "`index_of(list, value)` is the place of a number in a list, from 1; the list must hold it.",
        "const first = index_of([1, 3, 4, 2], 5)",
        "const first = index_of([1, 3, 4, 2], 3)";
    ABSENT = "E0537", "a part is used whose condition does not hold",
        "A body, marker, joint, force, journal, drive or part with `if` after its name exists only where the condition holds. A part that uses it needs the same condition; an output takes an index over a range that may be empty.",
        "const damped = false\nforce damper if damped = Damper(a, b, damping: 1 N*s/m)\noutput load = damper.load",
        "const damped = true\nforce damper if damped = Damper(a, b, damping: 1 N*s/m)\noutput load = damper.load";
    INPUT_DECIDES = "E0538", "an input decides a quantity that cannot change during a run",
        "Loads, rates of states, outputs and conditions may read an input. Structure, geometry, masses, scales, starts and constraints may not: a constraint needs accelerations, and the others are fixed at the start. A torque that follows a speed, for instance a `force` of your own, replaces a drive whose speed is an input; a number that stays during a run is a `param`.",
        "model Line {\n    input weight: Mass = 1 kg\n    body bob { mass = weight }\n}",
        "model Line {\n    param weight: Mass = 1 kg\n    body bob { mass = weight }\n}";
    OTHER_AXES = "E0540", "components along different axes are combined",
        "Components along a marker's axes are numbers: they can only be added to, multiplied with and shown in the same axes. Vectors have no axes and are added in space.",
        "output both = film[1].eccentricity + film[2].eccentricity in shell",
        "output both = vector([film[1].eccentricity.x, film[1].eccentricity.y, 0 mm], shell)\n    + vector([film[2].eccentricity.x, film[2].eccentricity.y, 0 mm], case) in shell";
    NO_CHANNEL_OF_ANALYSIS = "E0541", "an analysis names an input or a channel that its model does not have",
        "`inputs` lists inputs of the model, and `outputs` its channels, by the names that `eng results` and `--set` use: `speed`, `main[2].force.x`. The name of a vector stands for its components, `[*]` for every index. A name may stand in a list once.",
        "analysis small = linear(Driveline(), inputs: [brake], outputs: [sped])",
        "analysis small = linear(Driveline(), inputs: [brake], outputs: [speed])";
    OF_TURN = "E0542", "a number of a turn without forces is used outside of a lint",
        "`largest(x)`, `smallest(x)` and `where_largest(x)` are numbers of a turn of the machine through its cycle, by geometry alone. `eng check` has them after this turn, so only `advise` and its message may use them, directly or through a `let`. A `require` is checked at every step of a run, so it reads the motion itself.",
        "joint liner = Translational(crown.axis, bore)\noutput stroke = largest(liner.travel) - smallest(liner.travel)",
        "joint liner = Translational(crown.axis, bore)\nadvise stroke: largest(liner.travel) - smallest(liner.travel) < 200 mm else \"a long stroke\"";
    NO_UNKNOWN = "E0543", "an equation of `solve` does not depend on its unknown",
        "`solve` changes the unknowns until each value of the function is zero. A value that depends on none of them never changes, and an unknown that no value depends on can have any value. The function perhaps reads another number in place of its argument.",
        "fn distance(x: Length) -> Length = reach - 3 mm\nlet x = solve(distance, 1 mm)",
        "fn distance(x: Length) -> Length = x - 3 mm\nlet x = solve(distance, 1 mm)";
    NO_LIMITS = "E0544", "the limits of a number leave no value",
        "`in (low, high)` states open limits: the number must be above the first and below the second. So the first must be the smaller one.",
        "param bore: Length = 86 mm in (500 mm, 10 mm)",
        "param bore: Length = 86 mm in (10 mm, 500 mm)";
    INTERNAL = "E0599", "the compiler or the runtime contradicts itself",
        "No model should cause this: an earlier check should have reported the mistake. Please report it with the model. Until it is corrected, another form of the text at the named place may help.",
        "", "";
    UNUSED_MARKER = "W0501", "a marker is not used",
        "Nothing refers to the marker. Perhaps another marker was used in its place; otherwise remove it. Markers inside components do not count. An elastic `surface` of a marker is not used if no film that is solved on cells has the marker as its shell.",
        "", "";
    ADVISED = "W0502", "an `advise` does not hold",
        "The model runs, but its class reports a probable mistake. The author of the class wrote the text of the message.",
        "advise teeth > 11 else \"so few teeth are undercut\"",
        "const teeth = 23\nadvise teeth > 11 else \"so few teeth are undercut\"";
    UNTIED = "W0503", "a body is connected to nothing",
        "No joint, force or journal acts on the body: it moves by gravity and its start velocity alone. If this is intended, write `accept loose` in the body. A model without any connection to the ground gives no warning.",
        "", "";
    ADRIFT = "W0504", "bodies have no path to the ground",
        "These bodies are connected with each other, but none of them is connected to the ground: together they fall or drift. If this is intended, write `accept loose`. A model without any connection to the ground gives no warning.",
        "", "";
    UNSERVED = "W0505", "a load on a flexible body has no static mode",
        "Normal modes alone converge slowly under a load at one place: the body seems too stiff there. A static mode at that marker represents the load exactly. A term that lists its freedoms is not changed. A term whose markers have no load gives no mode. A marker that a static term names and no element loads was probably to have a joint, a force or a film; if it is intended, write `accept unloaded` in the body. Constraint modes of a free body that are rigid motions, such as those of a single interface, give no mode and represent no load.",
        "flexible crank { modes = normal(16) }",
        "flexible crank { modes = static(at: [main, pin]) + normal(16) }";
    PERIOD_GAP = "W0506", "the points of a periodic table leave out a part of the period",
        "The last point and the first of the next period are much further apart than the others (more than three times the usual distance and a twentieth of the period). A cubic spline fills this gap with a curve that the points do not determine. State points over the whole period. `interpolation: monotone` remains between the two values and gives no warning.",
        "table lift(theta: CrankAngle) -> Length = points([0, 30, 60] deg, [0, 4, 0] mm, periodic: 360 deg)",
        "table lift(theta: CrankAngle) -> Length = points([0, 30, 60] deg, [0, 4, 0] mm, periodic: 360 deg, interpolation: monotone)";
    MOVES_NOTHING = "W0507", "an element acts between a marker, body or ground and itself",
        "Both ends of a force are on one marker, on one rigid body or on the ground: its two loads cancel. Or an equation of angles is given the same two markers twice: a gear between a wheel and itself holds the wheel. A marker of another body was probably meant. If it is intended, write `accept idle` in the element.",
        "force strut = LinearSpring(block.mount, block.mount, stiffness: 10 N/mm)",
        "force strut = LinearSpring(block.mount, foundation, stiffness: 10 N/mm)";
    TABLE_PEAK = "W0760", "a table reaches a pressure that no engine part can carry",
        "The pressure is above 10,000 bar, three times that of fuel injection. Usually the numbers have another unit than the stated one: pascal read as bar.",
        "table gas(theta: CrankAngle) -> AbsolutePressure = points([0, 360] deg, [6e6, 1e5] bar, extrapolation: hold)",
        "table gas(theta: CrankAngle) -> AbsolutePressure = points([0, 360] deg, [60, 1] bar, extrapolation: hold)";
    MUCH_DAMPING = "W0552", "a flexible body has more damping than any structure",
        "The damping is more than 20 % of the critical one over all frequencies, or more than the critical one: `2` is 200 %, and `2 %` was probably meant. If it is intended, write `accept damping` in the body.",
        "flexible crank { damping = 2 }",
        "flexible crank { damping = 2 % }";
    NO_GRAVITY = "N0501", "no gravity is stated",
        "Without a statement gravity is zero. State it, or state zeros if zero is intended.",
        "model Engine { }",
        "model Engine { gravity = [0, -9.81, 0] m/s^2 }";
}
