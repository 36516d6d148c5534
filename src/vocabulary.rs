//! The words of the language, its built-in names and its own lints, with a sentence about each for `eng explain`.

/// A word with a sentence about it.
pub(crate) type About = (&'static str, &'static str);

/// The page that has more about a word.
pub(crate) const PAGE: &str = "docs/language.md";

/// Words of the grammar and names that every text knows.
pub const WORDS: &[About] = &[
    (
        "accept",
        "`accept NAME` in the block of a use, a body or a model: the lint of this name gives no warning there",
    ),
    (
        "advise",
        "`advise NAME: condition else \"text\"`: a warning if the condition does not hold",
    ),
    (
        "against",
        "`apply force f on a against b`: the opposite load acts on b, at the same place",
    ),
    (
        "analysis",
        "`analysis run = transient(Model(), …)`: a model with a kind of computation: transient, periodic, linear, response, static, kinematic or assemble; `docs/language.md#analyses` describes them",
    ),
    ("and", "`a and b`: both conditions hold"),
    (
        "apply",
        "`apply force f on a against b`, `apply torque t on a against b`: a load of a class on its markers",
    ),
    (
        "as",
        "`output x = … as mm`: the unit in which a number is written; it changes no value",
    ),
    (
        "at",
        "`marker m = at(origin, z: [1, 0, 0])`: a marker by its position and axes",
    ),
    (
        "body",
        "`body rod { mass = …; inertia = …; marker big = … }`: a rigid body",
    ),
    (
        "branch",
        "`branch travel > 0 mm` in the block of a joint: the side that the assembly takes where a closed chain has two",
    ),
    (
        "by",
        "`0 deg..360 deg by 10 deg`: the distance of the values of a range; `at(…, by: angle)`: the turn about an axis",
    ),
    (
        "choice",
        "`choice End = timing_end | driving_end`: a type whose values are words",
    ),
    (
        "component",
        "`component Crank(throw: Length) { … }`: bodies, markers and joints that a `part` puts into a model",
    ),
    (
        "const",
        "`const name = value` beside the models of a file: a number that no analysis changes",
    ),
    (
        "constrain",
        "`constrain a == b` in a class: an equation of positions that the bodies fulfil at every moment",
    ),
    (
        "cycle",
        "`cycle angle = rotation(a, b) { period = 720 deg }`: the angle that counts turns; `cycle.angle` and `cycle.rate` read it",
    ),
    ("default", "a reserved word: it names nothing yet"),
    (
        "der",
        "`der(x)` is the exact rate of x; `der(state) = …` gives the rate of a state",
    ),
    (
        "dimension",
        "`dimension Force = Mass*Acceleration`: a name for a dimension",
    ),
    (
        "drive",
        "a class whose constraints take power: `drive turn = PrescribedRotation(a, b, speed: 1000 rpm)`",
    ),
    (
        "else",
        "the other branch of an `if`, or the text of a `require` or `advise`",
    ),
    ("false", "the truth value that does not hold"),
    (
        "field",
        "`field film: … = reynolds(…)` in a class: numbers that a solver of partial differential equations gives",
    ),
    (
        "figure",
        "a picture in a `report`; `eng explain history` and the other kinds tell their arguments",
    ),
    (
        "flexible",
        "`flexible crank { mesh = …; modes = … }`: a body with a mesh, which modes reduce",
    ),
    (
        "fn",
        "`fn f(x: Length) -> Area = x^2`: a function of the text",
    ),
    (
        "for",
        "`[… for i in 1..4]`: a list with one value for each i",
    ),
    (
        "force",
        "a class that applies loads: `force spring = LinearSpring(a, b, …)`; in a class also `apply force`",
    ),
    (
        "from",
        "`unit degC = K from 273.15 K`: the zero of a unit; `wrapped(x, 360 deg, from: 0 deg)`: the first angle of a period",
    ),
    (
        "ground",
        "the frame at rest: a marker at the origin with the axes ground.x, ground.y and ground.z",
    ),
    (
        "guess",
        "`guess path = value`: where the assembly begins its search; the motion does not keep it",
    ),
    (
        "if",
        "`if condition then a else b` is a value; `joint j if condition = …` makes an item of a model only where it holds",
    ),
    (
        "in",
        "`x in (low, high)`: limits of a parameter; `v in m`: a vector along the axes of a marker; `i in 1..4`: an index",
    ),
    (
        "input",
        "`input push: Force = 0 N, interpolation: linear`: a parameter that an analysis or a program changes during a run",
    ),
    (
        "interface",
        "`interface Stop { … }`: the common part of several classes, which name it after a colon",
    ),
    (
        "interpolation",
        "the values of an input between two points of time: `hold`, `linear`, `cubic`; those of a table: `cubic`, `monotone`",
    ),
    (
        "joint",
        "a class of constraints between markers: `joint pin = Revolute(rod.big, crank.pin)`",
    ),
    (
        "journal",
        "a class of bearings with a film: `journal main = Impedance(pin, shell, …)`",
    ),
    (
        "let",
        "`let name = value`: a name for a value, which may depend on the motion",
    ),
    (
        "marker",
        "`marker big = [0, 60, 0] mm`: a point with axes on a body; a marker of a model is on the ground",
    ),
    (
        "model",
        "`model Engine { … }`: a machine that an analysis computes",
    ),
    ("not", "`not a`: the condition does not hold"),
    (
        "on",
        "`apply force f on a`: the marker on which a load acts; `place a on b`: the marker at which it is placed",
    ),
    ("or", "`a or b`: at least one condition holds"),
    (
        "output",
        "`output height = … as mm`: a column of the results",
    ),
    (
        "param",
        "`param bore: Length = 86 mm in (10 mm, 1 m)`: a number that `--set`, a sweep or a use changes",
    ),
    (
        "part",
        "`part crank = Crank(throw: 45 mm)`: a component in a model or in another component",
    ),
    (
        "pi",
        "3.14159…, a number without unit; `180 deg` is the angle",
    ),
    (
        "place",
        "`place a on b` in a class: the assembly looks for positions in which the origin of a lies on that of b",
    ),
    (
        "point",
        "`dimension Temperature = point TemperatureDifference`: a quantity with a zero of its own, whose differences are another dimension",
    ),
    (
        "record",
        "`record Solid { let density: Density … }`: named values that belong together",
    ),
    (
        "report",
        "`report name { figure …; value … }`: figures and numbers of results, on one page",
    ),
    (
        "require",
        "`require condition else \"text\"`: the run ends where the condition does not hold",
    ),
    (
        "resolve",
        "`resolve length` in a class: the length that decides the accuracy of positions and the depth of a step beyond a kink",
    ),
    (
        "scale",
        "`state p: Pressure = … scale 1 bar`: the size from which errors of a state are measured",
    ),
    (
        "start",
        "`start pin.angle = 30 deg`: a position or velocity at the start",
    ),
    (
        "state",
        "`state p: Pressure = 1 bar` in a class: an unknown with the rate `der(p) = …`",
    ),
    (
        "summary",
        "`output load = … as N summary largest`: a column of the table of its interface",
    ),
    (
        "table",
        "`table lift(t: Angle) -> Length = csv(…)` or `points(…)`: a function by its points",
    ),
    ("then", "the branch of an `if` whose condition holds"),
    ("time", "the time since the start of the run"),
    (
        "torque",
        "`apply torque t on a against b`: a moment of a class on its markers",
    ),
    ("true", "the truth value that holds"),
    ("unit", "`unit kN = 1e3 N`: a name for a unit"),
    (
        "use",
        "`use std.joints.Revolute`: names of a module of the library or of another file; `eng explain std.joints` lists them",
    ),
    ("value", "a number in a `report`"),
    (
        "with",
        "`part a = Engine() with { rod.mass = 0.65 kg }`: other values for parts of a part",
    ),
];

/// The lints that no class of the library states.
pub const LINTS: [About; eng_system::lint::BUILT_IN.len()] = [
    (
        eng_system::lint::INERTIA,
        "the inertia of a body does not fit its mass and its markers",
    ),
    (
        eng_system::lint::GRAVITY,
        "gravity is neither zero nor that of the earth, or has an unusual direction in an engine",
    ),
    (
        eng_system::lint::DAMPING,
        "all modes of a flexible body are damped by more than 20 %",
    ),
    (
        eng_system::lint::LOOSE,
        "nothing holds a body in some direction",
    ),
    (
        eng_system::lint::APART,
        "markers of one element are far apart",
    ),
    (
        eng_system::lint::SWAPPED,
        "the shell of a journal turns and its pin does not, or a force loads a guide and not its part",
    ),
    (
        eng_system::lint::ASKEW,
        "the axes of an angle or of a film are not parallel",
    ),
    (
        eng_system::lint::IDLE,
        "an element does nothing: its ends do not move against each other, or turn at different speeds from the start",
    ),
    (
        eng_system::lint::STEP,
        "a fixed step is long for the speed of the cycle",
    ),
    (
        eng_system::lint::SAMPLING,
        "samples are far apart for the speed of the cycle, or the run ends before a turn",
    ),
    (
        eng_system::lint::SAG,
        "a spring is too soft for the weight that it carries, or pushes along gravity",
    ),
    (
        eng_system::lint::TURNS,
        "an angle of many turns: degrees are perhaps meant",
    ),
    (
        eng_system::lint::UNIT_NAME,
        "a value has the name of a unit",
    ),
    (
        eng_system::lint::PERIOD,
        "the period of a table or of the cycle does not fit the cycle",
    ),
    (
        eng_system::lint::FIRING,
        "a cylinder fires far from its dead centre, or all fire at once",
    ),
    (eng_system::lint::BORE, "a bore does not fit the stroke"),
    (
        eng_system::lint::MIRRORED,
        "a piston is on the other side of its crank",
    ),
    (
        eng_system::lint::CYCLE,
        "the angle of the cycle oscillates, or falls while gas tables fire",
    ),
    (
        eng_system::lint::UNLOADED,
        "no element loads a marker of a static term of a flexible body",
    ),
];

/// The sentence about a word or a built-in name.
pub(crate) fn word(name: &str) -> Option<String> {
    let (name, about) = WORDS.iter().find(|(word, _)| *word == name)?;
    Some(format!(
        "`{name}` is a word of the language: {about} ({PAGE})"
    ))
}

/// The sentence about a lint of the program.
pub(crate) fn lint(name: &str) -> Option<String> {
    let (name, about) = LINTS.iter().find(|(lint, _)| *lint == name)?;
    Some(format!(
        "`{name}` is a lint: {about}. `accept {name}` in the block of the item accepts it ({PAGE}#lints)"
    ))
}
