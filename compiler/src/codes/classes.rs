//! Codes of declarations and their uses: classes, calls, blocks.

eng_grammar::codes! {
    CLASSES:

    NOT_CALLABLE = "E0401", "the called name is neither a function nor a class",
        "Parentheses follow functions, tables and classes. An element of a list takes brackets.",
        "let first = sizes(1)",
        "let first = sizes[1]";
    MISSING_ARGUMENT = "E0402", "an argument is missing",
        "A parameter without a default must be given. The message names it and shows its declaration.",
        "joint pin = Revolute(crank.main)",
        "joint pin = Revolute(crank.main, block.main)";
    UNKNOWN_ARGUMENT = "E0403", "an argument has a name that no parameter has",
        "The names of arguments are those of the parameters of the class or function.",
        "journal film = Short(crank.main, ground, widht: 20 mm)",
        "journal film = Short(crank.main, ground, width: 20 mm)";
    ARGUMENT_TWICE = "E0404", "an argument is given twice",
        "The argument is given by its place and by its name, or twice by its name.",
        "let r = norm(v, floor: 1 mm, floor: 2 mm)",
        "let r = norm(v, floor: 1 mm)";
    TOO_MANY_ARGUMENTS = "E0405", "there are more arguments than parameters",
        "Remove the extra arguments, or give them by name.",
        "let y = sin(3 deg, 4 deg)",
        "let y = sin(3 deg)";
    MISPLACED = "E0406", "an item does not belong here",
        "Bodies belong in models and components, constraints and loads in classes, and the parameters of a class in its parentheses.",
        "force Push(a: Marker) { param load: Force = 3 N }",
        "force Push(a: Marker, load: Force = 3 N) { apply force load*a.x on a }";
    INTERFACE = "E0407", "a class does not fill its interface",
        "The name after the colon is an interface. The class gives each output and function that the interface requires, with the same types. A class may repeat a parameter or output with its type. An interface may extend another interface, if that one extends none itself.",
        "interface Law { param a: Marker; output load: Force }\nforce Push() : Law { apply force [0, 0, 3] N on a }",
        "interface Law { param a: Marker; output load: Force }\nforce Push() : Law { apply force [0, 0, 3] N on a; output load: Force = 3 N }";
    NOT_OF_INTERFACE = "E0408", "a class does not belong to the interface that is expected",
        "A class that is passed as an argument states the interface after its parameters. It has no required parameters besides those of the interface.",
        "part main = Bearing(law: Revolute)",
        "part main = Bearing(law: Short)";
    UNKNOWN_ATTRIBUTE = "E0409", "an attribute is not known",
        "`name = value` sets an attribute of the language: mass, inertia, gravity, period. A value of your own is a `let`.",
        "gravty = [0, -9.81, 0] m/s^2",
        "gravity = [0, -9.81, 0] m/s^2";
    KIND = "E0410", "a class is used as another kind",
        "The word before the name is that of the class: a journal is used by `journal`, a component by `part`.",
        "joint main = Short(crank.main, ground)",
        "journal main = Short(crank.main, ground)";
    CONSTRAINT_FORM = "E0411", "a constraint is not an equation of scalars or vectors",
        "Write `left == right`, of numbers or vectors of one dimension.",
        "constrain dot(a.x, b.x)",
        "constrain dot(a.x, b.x) == 0";
    MISSING_ATTRIBUTE = "E0412", "an attribute is missing",
        "A body has a mass and an inertia, a cycle a period.",
        "body rod { mass = 0.6 kg }",
        "body rod { mass = 0.6 kg; inertia = [3, 0.1, 3] g*m^2 }";
    NO_CYCLE = "E0413", "the model has no cycle",
        "`cycle.angle`, or a duration in degrees, needs a model that states the cycle's angle.",
        "analysis run = transient(M(), duration: 4 rev, sample: 1 deg)",
        "model M { cycle angle = rotation(crank.main, ground) { period = 720 deg } }";
    STATE = "E0414", "a state and its rate do not match",
        "Every `state` has one `der(state) = …` in its class or the interface of the class, and every such line a state.",
        "force Damper(a: Marker) { state p: Pressure = 3 bar }",
        "force Damper(a: Marker) { state p: Pressure = 3 bar; der(p) = -p/1 s }";
    MISSING_VALUE = "E0415", "a definition has no value or no type",
        "Only a `param` may lack a value; then it has a type.",
        "let area: Area",
        "let area: Area = pi/4*bore^2";
    TABLE = "E0416", "the definition of a table does not make sense",
        "A table has one to three arguments and one number as its value, all with types. Its numbers come from `csv` or `points`.",
        "table lift(theta: CrankAngle) = points([0, 30] deg, [0, 4] mm)",
        "table lift(theta: CrankAngle) -> Length = points([0, 30] deg, [0, 4] mm)";
    ANALYSIS = "E0417", "an analysis cannot be made like this",
        "An analysis is `transient(Model(…), …)`, `periodic(Model(…), …)`, `linear(Model(…), …)`, `static(Model(…), …)` or `assemble(Model(…))`. The `start` of a motion is `quasi_static` or `assembled`.",
        "analysis run = transient(Engine, duration: 1 s, sample: 1 ms)",
        "analysis run = transient(Engine(), duration: 1 s, sample: 1 ms)";
    MARKER = "E0418", "the place of a marker cannot be read",
        "A marker is three lengths, `origin`, or `at(place, z: […], x: […])` with directions.",
        "marker pin = 43 mm",
        "marker pin = [43, 0, 0] mm";
    START = "E0419", "this cannot be set at the start",
        "A body's block sets its position and velocity. The model sets any moving quantity.",
        "start crank = 30 deg",
        "start rotation(crank.main, ground) = 30 deg";
    NO_FILM = "E0421", "a class of journals does not fill the interface of films",
        "A journal is a film law. The quasi-static start, the tolerance, tables, orbits and polar diagrams use the parameters and outputs of `std.journals.JournalLaw`. A law of your own has them and declares `: JournalLaw`. A class that is no film is a `force`.",
        "journal Plain(a: Marker, b: Marker) { apply force -1 N/mm*(a.origin - b.origin) on a against b }",
        "force Plain(a: Marker, b: Marker) { apply force -1 N/mm*(a.origin - b.origin) on a against b }";
    STATE_SCALE = "E0425", "a state that starts at zero has no scale",
        "The error of a state may be 1e-5 of the larger of its scale and its largest value so far. A start value other than zero is the scale. A state that starts at zero has no size, so its steps would resolve even 1e-300. State the size above which it matters.",
        "state lift: Length = 0 mm",
        "state lift: Length = 0 mm scale 0.1 mm";
    REPLACED = "E0426", "a class replaces an item of its interface",
        "A class has all items of its interface and adds others. It gives the items that the interface states without a value, and it may give its own value of an output. It replaces no other item, so each name has one meaning in the class and its interface.",
        "interface Law { let gain = 3 }\nforce Push(a: Marker) : Law { let gain = 4; apply force gain*1 N*a.x on a }",
        "interface Law { let gain = 3 }\nforce Push(a: Marker) : Law { let own_gain = 4; apply force own_gain*gain*1 N*a.x on a }";
    SUMMARY = "E0431", "a summary does not belong to this output",
        "`summary least`, `largest` or `mean` makes a column of a table, with a row for each element whose class fills the interface. So it belongs to an output of an interface, and the output is a single number.",
        "force Pull(a: Marker) { output load: Force = 3 N summary largest }",
        "interface Loaded {\n    param a: Marker\n    output load: Force summary largest\n}\nforce Pull() : Loaded { apply force 3 N*a.x on a; output load: Force = 3 N }";
    INPUT = "E0432", "an input has a wrong type or interpolation",
        "An input is a number, or a list of numbers, that a program sets while the model runs. Between two points it follows `interpolation: hold` (the default), `linear` or `cubic`.",
        "model Line { input brake: Torque = 0 N*m, interpolation: spline }",
        "model Line { input brake: Torque = 0 N*m, interpolation: cubic }";
    FIELD = "E0433", "a field does not fit its kernel",
        "A field gets numbers from a solver of its own, a kernel: `reynolds` solves the oil film of a bearing. Its type is a record whose values are results of the kernel. Loads may use the answers (force, moment, torque); outputs and conditions may also use the readings, such as the least film thickness.",
        "record Film { let force: Vector2<Force>; let heat: Power }",
        "record Film { let force: Vector2<Force>; let shear_power: Power }";
    CHANGE = "E0434", "a change after `with` reaches no number",
        "`part unit = Cylinder(…) with { rod.mass = 0.6 kg }` changes a number inside of a part. The path is as for `--set`, without the name of the part. It may also end at an attribute that a body states. Classes, counts and words are arguments: the component needs a parameter for them.",
        "part unit = Cylinder(throw) with { rod.mas = 0.6 kg }",
        "part unit = Cylinder(throw) with { rod.mass = 0.6 kg }";
}
