//! Codes of checking: types and units of values, and the lints of the text (`W055…`).

eng_grammar::codes! {
    CHECKING:

    UNIT_MISSING = "E0301", "a number has no unit where a quantity is expected",
        "Every quantity has a unit. A zero needs one, too.",
        "param bore: Length = 86",
        "param bore: Length = 86 mm";
    DIMENSION = "E0302", "a quantity has another dimension than expected",
        "The dimension of the value does not fit the place: a mass in newtons, a width in bar.",
        "param mass: Mass = 3 N",
        "param mass: Mass = 3 kg";
    OPERANDS = "E0303", "two quantities of different dimensions are added or compared",
        "Both sides of `+`, `-` and of a comparison have one dimension.",
        "let longer = bore + 3 s",
        "let longer = bore + 3 mm";
    ANGLE = "E0304", "two quantities differ by an angle",
        "A written or declared quantity keeps its angle: 66 Hz is a frequency and no angular velocity. A computed quantity may drop it.",
        "param speed: AngularVelocity = 66 Hz",
        "param speed: AngularVelocity = 66 rev/s";
    VALUE_CIRCLE = "E0305", "values are defined by each other",
        "No order of evaluation exists. Give one of the values a number, or solve the relation for it.",
        "let bore = stroke*0.9\nlet stroke = bore/0.9",
        "param stroke: Length = 86 mm\nlet bore = stroke*0.9";
    POINT = "E0306", "a point is used as a difference, or a difference as a point",
        "Temperature, AbsolutePressure and CrankAngle are points on a scale; TemperatureDifference, Pressure and Angle are differences. Two points subtracted give a difference.",
        "param boost: AbsolutePressure = 1 bar\nlet force: Pressure = boost",
        "param boost: AbsolutePressure = 1 bar\nlet force: Pressure = boost - 1 bar";
    POINT_ARITHMETIC = "E0307", "points are added or multiplied",
        "Twice 20 degC has no meaning, and neither has the sum of two temperatures. Add and multiply differences.",
        "let mean = (inlet + outlet)/2",
        "let mean = inlet + (outlet - inlet)/2";
    AFFINE_UNIT = "E0308", "a unit with a shifted zero is used where only its size can count",
        "degC counts from the melting point of ice; in a product or a power only the size of a degree counts, and its unit is K.",
        "param conductivity: ThermalConductivity = 40 W/m/degC",
        "param conductivity: ThermalConductivity = 40 W/m/K";
    WRONG_TYPE = "E0309", "a value has the wrong type",
        "A body is given for a marker, a list for a number, or a text for a quantity. The message names both types.",
        "joint pin = Revolute(rod, crank)",
        "joint pin = Revolute(rod.big_end, crank.pin)";
    COMPONENT_WITHOUT_AXES = "E0311", "a component of a vector is taken in no stated axes",
        "A vector has no axes, so it has no x. State the axes: take the dot product with an axis, or use `local`.",
        "let height = (a.origin - b.origin).y",
        "let height = dot(a.origin - b.origin, b.y)";
    OUTPUT_WITHOUT_FRAME = "E0312", "an output of a vector does not state its axes",
        "Three numbers mean something only along stated axes.",
        "output gap = a.origin - b.origin as mm",
        "output gap = a.origin - b.origin in b as mm";
    FRAME = "E0313", "axes are stated wrongly",
        "After `in` follows a marker, and only vectors can be shown in axes. `vector(c, m)` makes a vector of components along a marker's axes.",
        "output travel = distance in b as mm",
        "output travel = distance as mm";
    LIST_ELEMENTS = "E0314", "the elements of a list differ in type or dimension",
        "A list, the sides of an `if`, and the arguments of `min` and `max` have one dimension.",
        "let sizes = [86 mm, 3 s]",
        "let sizes = [86 mm, 90 mm]";
    LIST_LENGTH = "E0315", "a list has another length than expected",
        "A place has three coordinates, a table as many values as arguments.",
        "marker main = [0, 46] mm",
        "marker main = [0, 46, 0] mm";
    CONDITION = "E0316", "a condition is neither true nor false",
        "After `if`, `require`, `advise` and `branch` follows a comparison.",
        "branch dot(a.z, b.z)",
        "branch dot(a.z, b.z) > 0";
    INDEX = "E0317", "an index is missing, superfluous or not a whole number",
        "An item that is declared with an index is used with one. `[*]` means all of them.",
        "body rod[i in 1..4] { mass = 1 kg }\noutput height = rod.mass",
        "body rod[i in 1..4] { mass = 1 kg }\noutput height = rod[1].mass";
    OPERATOR = "E0318", "an operator does not apply to these operands",
        "Vectors are multiplied by `dot` and `cross`, markers not at all, texts are only compared.",
        "let square = v*v",
        "let square = dot(v, v)";
    POWER = "E0319", "an exponent does not give a dimension",
        "The exponent of a quantity is a small constant: 2, 1/2, 3/2. For other exponents divide by a reference first.",
        "let growth = length^n",
        "let growth = 1 mm*(length/1 mm)^n";
    DERIVATIVE = "E0320", "a velocity is differentiated, or constrained, where only positions can be",
        "Constraints contain positions, angles and time; forces contain positions, velocities and states. State the integral instead.",
        "constrain dot(a.velocity, b.x) == speed",
        "constrain dot(a.origin, b.x) == speed*time";
    ACCELERATION = "E0321", "accelerations and reactions are used outside outputs",
        "Accelerations and reactions follow from the forces. So forces, constraints and conditions cannot depend on them, but outputs can.",
        "require norm(force) < 3 kN else \"too much\"",
        "output load = norm(force) as kN";
    DISPLAY = "E0322", "a unit after `as` has another dimension than the value",
        "`as` chooses the unit in which a value is shown. It does not change the dimension.",
        "output speed = der(angle) as Hz",
        "output speed = der(angle) as rpm";
    UNIT_TWICE = "E0323", "a unit follows something that is not a plain number",
        "The value already has its unit. To show it in another unit, use `as`.",
        "let area = (bore^2) mm^2",
        "let area = bore^2";
    RANGE = "E0324", "a range is not one of counts, or has no step",
        "A range of whole numbers has the step 1; a range of quantities states its step.",
        "analysis sweep[s in 1000 rpm .. 6000 rpm] = assemble(M(speed: s))",
        "analysis sweep[s in 1000 rpm .. 6000 rpm by 500 rpm] = assemble(M(speed: s))";
    STRUCTURAL = "E0325", "a parameter decides a count",
        "The number of bodies is fixed when the model is compiled, and a `param` changes afterwards. Counts are `const`.",
        "param cylinders: Int = 4",
        "const cylinders = 4";
    TOO_DEEP = "E0326", "values build on each other too deeply",
        "More than 100 values or calls depend on each other in a chain. Shorten the chain.",
        "", "";
    NO_WORD = "E0327", "a word is none of its choice",
        "A choice has the words of its definition. Where a choice is expected, as in an argument, in a default or beside `==`, write the word alone. Elsewhere write the name of the choice before it: `End.timing_end`.",
        "part oil_pump = Pump(driven_at: timing)",
        "part oil_pump = Pump(driven_at: timing_end)";
    CASES = "E0328", "an `if` without `else` leaves out a case",
        "`if` is a value, so it has a value in every case. A chain that compares one value with every word of its choice needs no `else`. If a word is added to the choice, each such chain is an error until it has the new case.",
        "let sign = if sense == clockwise then -1",
        "let sign = if sense == clockwise then -1 else if sense == counterclockwise then 1";
    CHOICE = "E0329", "a choice or a value of one is defined wrongly",
        "A choice has two words or more, and each once. A value of a choice must not have the name of one of its words: where the choice is expected, this name means the word.",
        "choice End = timing_end | timing_end",
        "choice End = timing_end | driving_end";
    FLEXIBLE = "E0390", "an unknown word describes a flexible body",
        "A mesh, a matrix, a mode set and a damping have words of their own. The message lists the words that are possible at this place.",
        "flexible crank { mesh = file(\"crank.bdf\") }",
        "flexible crank { mesh = nastran(\"crank.bdf\", units: mm_tonne_s) }";
    NOT_BUILT = "E0391", "this form is reserved for a later version",
        "The language has no meaning for this form yet.",
        "default bearing { width = 20 mm }",
        "const bearing_width = 20 mm";
    ACCEPT_UNKNOWN = "W0550", "an `accept` names a lint that does not exist",
        "`accept NAME` accepts a warning with this name: that of an `advise NAME: …` of a class, or of a lint of the language. Each warning that can be accepted states its name.",
        "accept usul",
        "accept usual";
    MANY_TURNS = "W0551", "an angle in rad is many turns",
        "The angle is more than 20 rad, about three turns. Angles of engines are parts of a turn, so degrees were probably meant. A sine of a plain number of more than a turn gives the same warning: `sin(16)`, or `i*360/7 deg`, which is i*360/(7 deg). If the angle is intended, write `accept turns` in the definition around it.",
        "start crank.angle = 180 rad",
        "start crank.angle = 180 deg";
    UNIT_NAME = "W0553", "a value has the name of a unit",
        "After a number or another unit, the word is the unit: `2 N*m` is a torque, also where a mass `m` is declared. Give the value a longer name. Or keep it, write spaces around the operator (`2 N * m`), and write `accept unit_name` in the definition around it.",
        "param m: Mass = 2 kg",
        "param mass: Mass = 2 kg";
    UNUSED_LET = "W0301", "a value is not used",
        "The model runs. Perhaps another value was used in its place; otherwise remove it.",
        "let volume = area*stroke",
        "output volume = area*stroke";
}
