//! The message codes of assembling, running and reducing (`07`) and of the command line (`99`), and all codes with their explanations.
//!
//! The compiler's codes stand in [`eng_compiler::codes`], those of the grammar in [`mod@eng_grammar::codes`].

pub use eng_compiler::codes::INTERNAL;
pub use eng_grammar::Code;

eng_grammar::codes! {
    RUNNING:

    OPTIONS = "E0701", "an option of a simulation has no meaning",
        "A program that embeds a model asks for a step, tolerance or spectral radius that cannot be. The message says what can.",
        "", "";
    BODY = "E0702", "a body has a mass or inertia that no body can have",
        "The inertia about the centre of mass is positive definite, and none of its principal moments exceeds the sum of the other two. Check the unit, the sign of the products, and that it is about the centre of mass.",
        "body rod { mass = 1 kg; inertia = [1, 1, 1] g*m^2; products_of_inertia = [2, 0, 0] g*m^2 }",
        "body rod { mass = 1 kg; inertia = [1, 1, 1] g*m^2; products_of_inertia = [0.2, 0, 0] g*m^2 }";
    OPEN_LOOP = "E0703", "the mechanism cannot be assembled: a loop stays open",
        "No positions fulfil all constraints. The gap says by how much: a wrong length, a marker on the wrong side, axes that differ, or a start position from which the right one is not found.",
        "", "";
    WRONG_BRANCH = "E0704", "the mechanism assembles only on another branch",
        "The joints close, but a `branch` condition does not hold in any position that was found. State a `guess` near the wanted position, or another `branch` at the use.",
        "", "";
    START_VELOCITY = "E0705", "start velocities contradict each other",
        "What is stated by `start` does not fit the joints, the drives or other stated velocities. Leave one of them out.",
        "", "";
    REDUNDANT = "E0706", "constraint equations repeat each other",
        "Two joints hold the same thing, such as two revolutes on one axis. Their reactions could be shared in any way. Let one of them hold less, or make it a journal.",
        "joint left = Revolute(bar.left, block.left)\njoint right = Revolute(bar.right, block.right)",
        "joint left = Revolute(bar.left, block.left)\njoint right = PointOnLine(bar.right, block.right)";
    SINGULAR = "E0707", "accelerations are not determined",
        "Something can move that has no mass or inertia: the message names such bodies. Or the mechanism stands where it locks or can go on in two ways: then the message names the constraint equations that depend on each other there; start a few degrees away.",
        "body rod { mass = 0.6 kg; inertia = [0, 0, 0] g*m^2 }",
        "body rod { mass = 0.6 kg; inertia = [3.1, 0.12, 3] g*m^2 }";
    NOT_FINITE = "E0708", "an element gives something that is no number",
        "Something is divided by zero, or a root or logarithm is taken of a number that has none. The message names the element and the moment.",
        "apply force k/norm(a.origin - b.origin)*b.x on a against b",
        "apply force k/norm(a.origin - b.origin, floor: 1 um)*b.x on a against b";
    NO_STEP = "E0709", "a step has no solution, however small",
        "The equations jump or are very stiff at this moment: a force with `if` that jumps, a mechanism at the end of its reach. Make the force continuous, or look at the outputs just before.",
        "", "";
    STEP_TOO_SMALL = "E0710", "the step falls below what numbers resolve",
        "The motion is not smooth at this moment: a force or the rate of a state jumps or grows without bound. Make it continuous. The message names the body or the state whose error asks for the small step.",
        "", "";
    REQUIRED = "E0711", "a `require` fails during the run",
        "The class asks for a condition at every step, and here it fails: a pin touches its shell, a spring is blocked. The text is its author's. What was computed before is kept.",
        "", "";
    PROJECTION = "E0712", "a position does not come back to the constraints",
        "Between steps the positions are put back on the constraints. That fails where a step is too long for the motion, or where the mechanism locks or reaches its end.",
        "", "";
    OUTSIDE_TABLE = "E0713", "a table is read outside its points",
        "A table without `extrapolation` has no value there. The message names the table, where it is read and from where to where its points go. State more points, shorten the run, make the table `periodic`, or say what holds outside.",
        "table push(t: Time) -> Force = points([0, 0.1] s, [0, 1] N)",
        "table push(t: Time) -> Force = points([0, 0.1] s, [0, 1] N, extrapolation: hold)";
    CYCLE_STANDS = "E0714", "the cycle angle does not advance",
        "The duration is an angle, but the crank stands or swings. Give a time, or start the crank turning.",
        "analysis run = transient(Engine(), duration: 4 rev, sample: 1 deg)",
        "analysis run = transient(Engine(), duration: 100 ms, sample: 0.1 ms)";
    CHECKPOINT = "E0715", "a checkpoint cannot be used",
        "It is damaged, or of another model, other parameters or another version. Start the run from its beginning.",
        "", "";
    ROUNDING = "E0716", "a tolerance is below rounding",
        "The tolerance asks for errors of a step, or for a solution of its equations, below what numbers of 16 digits resolve of this model. The message says the least that can be kept. Bodies far from the origin and angles of many turns need a larger one.",
        "analysis run = transient(Engine(), duration: 4 rev, tolerance: 1e-12)",
        "analysis run = transient(Engine(), duration: 4 rev, tolerance: 1e-3)";
    PARAMETER_REQUIRED = "E0720", "parameters do not fulfil a `require`",
        "The class, or the language for masses and inertias, asks for a condition that these parameters do not fulfil. The text is the author's.",
        "body rod { mass = -1 kg; inertia = [1, 1, 1] g*m^2 }",
        "body rod { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }";
    PARAMETER_NOT_FINITE = "E0721", "with these parameters something is no number",
        "A division by zero, a root of a negative number or a direction of length zero, in what the named thing is made of.",
        "param length: Length = 0 mm\nlet stiffness = 1 N*m/length^2",
        "param length: Length = 100 mm in (1 mm, 1 m)\nlet stiffness = 1 N*m/length^2";
    PARAMETER_LIMITS = "E0722", "a parameter is outside its limits",
        "The limits after `in` are open: the value lies strictly between them.",
        "param length: Length = 3 m in (1 mm, 2 m)",
        "param length: Length = 1 m in (1 mm, 2 m)";
    TURNING = "E0740", "the linearised motion has no constant coefficients",
        "Bodies turn, and something about the small motions turns with them: the shapes of a flexible body, unequal inertia, a joint or load beside the axis. Or time alone changes them: a stiffness that is a function of time, a pivot that is shaken, a load that swells beside the axis. Eigenvalues with the coefficients held at one moment then give wrong whirl, damping and stability. The message names the bodies or elements and the reason. A change that moves no eigenvalue by more than a thousandth of its size is told and not refused. Where the motion repeats, `over:` with its period gives the modes of the period; `frozen: true` asks for the picture of a moment all the same, for frequencies well above the speed; the result is marked so.",
        "analysis modes = linear(Rotor(), after: 1 s)",
        "analysis modes = linear(Rotor(), after: 1 s, over: 1 rev)";
    NOT_REPEATING = "E0741", "the motion does not repeat after the stated period",
        "`linear` with `over:` looks for a motion that after this time or angle is the same again, up to whole turns. The message names the body that is farthest off. Check the period (a four-stroke cycle has two turns), loads that depend on time, bodies that drift or turn freely at speeds of their own. Where such a motion is close by and the state is too far from it, the help says so: begin nearer, with the quasi-static start or with `after:`.",
        "analysis modes = linear(Engine(), after: 3 rev, over: 1 rev)",
        "analysis modes = linear(Engine(), after: 3 rev, over: 2 rev)";
    NO_PERIOD = "E0742", "there is no period of that kind",
        "`over:` is an angle, but the model has no cycle and no body turns. Give the period as a time.",
        "analysis modes = linear(Column(), over: 1 rev)",
        "analysis modes = linear(Column(), over: 20 ms)";
    UNSTEADY = "E0743", "`linear` is asked for at a state that is neither rest nor a steady motion",
        "A body moves, or forces do not balance, and on the way from there stiffness, damping or inertia changes: a pendulum at its turning point, a slider under way, a model that was assembled and not balanced. Eigenvalues of that moment hold for no motion. Take the quasi-static start, or let the motion die out with `after:`; where it repeats, `over:` with its period gives its modes; `frozen: true` asks for the picture of the moment all the same.",
        "analysis modes = linear(Pendulum(), start: assembled)",
        "analysis modes = linear(Pendulum())";
    NO_EQUILIBRIUM = "E0744", "a `static` analysis finds no equilibrium",
        "At rest joints, springs, contacts and drives, which stay where they are, must balance the loads. The message names the thing that moves on: a body that nothing holds, a pin in a film (films carry only while pins turn: `turning: true`), a contact that is never reached, a state of an element that changes. What `start` states is only where the search begins; `at: 30 deg` holds the cycle's angle.",
        "model Loose { gravity = [0, 0, -9.81] m/s^2\nbody stone { mass = 1 kg; inertia = [1, 1, 1] g*m^2 } }\nanalysis rest = static(Loose())",
        "model Held { gravity = [0, 0, -9.81] m/s^2\nbody stone { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }\njoint hold = Fixed(stone.origin, ground) }\nanalysis rest = static(Held())";
    LOCKED = "E0760", "the mechanism locks",
        "Its geometry lets it go no further at this position: a rod shorter than the throw, a guide whose axis lies across the motion, two joints that ask for different motions. Forces have no part in it. The message names the loop of bodies, the lengths between their joints and the axes.",
        "", "";
    NO_TURN = "W0761", "the machine does not come through its cycle",
        "`eng check` turns the assembled machine through one period, without a cycle one turn of its fastest drive, by its geometry alone: no forces, pins in the middle of their shells. At the stated angle or time it goes no further. The message names the loop of bodies, the lengths between their joints and the axes. A run that comes there fails, or the crank turns back.",
        "", "";
    HANGING = "W0762", "a body hangs on nothing",
        "No joint, film or force of the text holds it against a motion, though one joins it to others: a coupling turns it and does not carry it. It falls, and what hangs on it falls with it.",
        "", "";
    JUMPS = "E0770", "a force, a torque or the rate of a state jumps, and the motion stays at the jump",
        "A value by `if` changes at once where its condition does, and the motion is driven back to that place from both sides: steps fall without end. The message names the element and the size of the jump. Join the two values by a slope.",
        "apply force (if v > 0 m/s then -20 N else 20 N)*b.y on a against b",
        "apply force -20 N*tanh(v/(1 mm/s))*b.y on a against b";
    STOPPED = "E0771", "a run was stopped before its end",
        "At the pace of its steps its end lies days or years ahead. The message names what makes the steps short: a step that is stated, a load that jumps, a body that is very stiffly held or grows without bound. Mend that; `eng run --patient` goes on however long it takes.",
        "", "";
    FAR_GUESS = "E0772", "a body is guessed where no joint reaches",
        "A `guess` is where the search for the assembled position begins. From a thousand times the size of the model it does not end near what is meant: a unit is wrong.",
        "body crank { mass = 20 kg; inertia = [1, 1, 1] kg*m^2; guess position = [10, 1e9, 0] um }",
        "body crank { mass = 20 kg; inertia = [1, 1, 1] kg*m^2; guess position = [10, 10, 0] um }";
    ASTRAY = "E0773", "a body runs away from the model",
        "It is a million times the model's size away from the ground's origin, and came there ever faster: a force with the wrong sign drives it on, or a table holds a number in a wrong unit. A body that flies, or that a constant force drives, is not meant, nor a run that begins far away.",
        "let push = if place < 0 mm then stiffness*place else 0 N",
        "let push = if place < 0 mm then -stiffness*place else 0 N";
    ADVISED = "W0711", "an `advise` fails during the run",
        "The run goes on, but its class takes this for doubtful. It is said once for each element, at the first moment. The text is its author's.",
        "", "";
    NO_BALANCE = "W0712", "no quasi-static start was found",
        "A turning engine starts where its films and flexible bodies balance the loads of the steady motion. Here the thing that is named stands in the way: a journal that cannot carry its load, a mechanism that locks. The run starts as assembled, and rings at first. Mend it, or write `start: assembled`.",
        "", "";
    NOT_PERIODIC = "W0713", "the cycle does not repeat",
        "`periodic` gave up after the stated number of `cycles`. The message names the channel that changes most, and the factor by which deviations of the motion shrink or grow a cycle. With a factor well below 1, allow more cycles; near 1 the motion never repeats: whirl of a lightly loaded journal, a resonance, a speed that creeps. Where the changes neither shrink nor follow from those before, as with impacts, no factor is told. The last cycle is kept.",
        "", "";
    WHIRL = "W0714", "a journal whirls at about half speed",
        "The pin moves at about half the shaft's speed and does not come back after a cycle: a film that carries little load is unstable so. Load it, widen the clearance, take thinner oil or a shorter bearing, or see whether the load of the model is too small.",
        "", "";
    UPSIDE_DOWN = "W0715", "a balance or a steady motion is unstable",
        "The forces are in balance, but the least push leads away from it: a pendulum above its pivot, a column pressed beyond its load. The run stays there until rounding or a load moves it. Where that is not meant, begin beside it with `guess`; the message names the body that leaves it and how fast.",
        "", "";
    BENT_AS_IF_LOADS_TURNED = "W0745", "a turning flexible body starts bent as if all loads turned with it",
        "A load that is still in space, such as weight, bends a turning shaft as at rest; one that turns with it, such as an unbalance, bends it by 1/(1 − Ω²/ω²). The start tells them apart by the motion that repeats after a turn or a cycle. Here there is none, for the reason given: a speed that changes, shafts whose turns never meet, a load in resonance with a shape that nothing damps, equations that are not solved. So all loads are taken to turn, and the body rings at first. Give the model a cycle or constant speeds, damp the shape, or begin with `start: assembled`.",
        "", "";
    ACCEPT_UNHEARD = "W0750", "an `accept` accepts nothing",
        "No lint of this name has anything to say of the item it stands in, in any analysis of the file. An acceptance that is not needed would hide a later mistake: take it away.",
        "joint big_end = Revolute(rod.big, crank.pin) { accept loose }",
        "joint big_end = Revolute(rod.big, crank.pin)";
    INERTIA = "W0751", "the inertia of a body does not fit its mass and size",
        "The radius of gyration, the root of inertia over mass, is compared with the way from the centre of mass to the markers (0.13 to 2.6 of it; the lower limit where markers stand on both sides, the upper one above three radii of a ball of steel; both where the farthest marker is 20 mm away or more), with that of all bodies, with a ball of tungsten, which has the least inertia of all bodies of a mass, and with twenty radii of a ball of steel. Outside, a unit is probably wrong; so is a centre of mass that is far from all markers. Of a body with its markers in line the moments across that line are the large ones. The centre of mass of a rod is between its ends. `accept inertia` in the body takes it for meant.",
        "body rod { mass = 0.62 kg; inertia = [0.12, 3.0, 3.1] kg*m^2 }",
        "body rod { mass = 0.62 kg; inertia = [0.12, 3.0, 3.1] g*m^2 }";
    GRAVITY = "W0752", "gravity is neither 0 nor that of the earth",
        "9.7 to 10.1 m/s^2 pass, and 0. A unit or a component is probably wrong. In an engine with gas it acts neither towards the heads nor along the crankshaft. `accept gravity` in the model takes it for meant.",
        "model Engine { gravity = [0, -9.81, 0] mm/s^2 }",
        "model Engine { gravity = [0, -9.81, 0] m/s^2 }";
    PERIOD = "W0753", "a periodic table does not fit the cycle",
        "The cycle's period is no whole number of half turns, or of periods of the table: a four-stroke's pressure over 720 deg in a cycle of 360 deg is read at other angles each time. `accept period` in the model takes it for meant.",
        "cycle angle = rotation(crank.flange, ground) { period = 360 deg }",
        "cycle angle = rotation(crank.flange, ground) { period = 720 deg }";
    LOOSE = "W0754", "nothing holds a body in some direction",
        "No joint holds it, and no force answers its displacement or its velocity, while the machine has a cycle or films, or while it turns and falls along its axis. The turning of a body that starts with a spin is not asked. Gas, gravity and loads hold nothing. The turning of the cycle is left out. `accept loose` in the body takes it for meant.",
        "journal main[j in 1..5] = Impedance(pin: crank.main[j], shell: block.main[j], diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 12 mPa*s)",
        "journal main[j in 1..5] = Impedance(pin: crank.main[j], shell: block.main[j], diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 12 mPa*s)\njoint thrust = PointOnPlane(crank.main[3], block.main[3])";
    APART = "W0755", "markers of an element stand far apart",
        "A point on a line that stands beside the other marker and does not move along the line: a rod and a piston of different cylinders. The limit is twice the smaller radius of gyration of the two bodies; for a piston under gas also a fifth of the bore. Or a slide that nothing but its guide places: it stands where the model's origin is, 10 mm or more from the other marker. State where it begins. `accept apart` in the element takes it for meant.",
        "joint wrist[i in 1..4] = PointOnLine(rod[i].small, piston[5 - i].pin)",
        "joint wrist[i in 1..4] = PointOnLine(rod[i].small, piston[i].pin)";
    SWAPPED = "W0756", "a shell turns on a pin that does not",
        "At the start the shell turns at more than twice the speed of the pin. The film's frame, its angles and its tables are those of the shell: pin and shell are probably swapped. `accept swapped` in the journal takes it for meant, as for a rotating bush.",
        "journal main = Short(pin: block.main, shell: crank.main, diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 12 mPa*s)",
        "journal main = Short(pin: crank.main, shell: block.main, diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 12 mPa*s)";
    ASKEW = "W0766", "the axes of an angle or a film are not parallel",
        "At the start the z axes of the two markers are more than 5 degrees apart. An angle `rotation(a, b)`, a torsional spring and a cycle measure how far a.x is turned about b.z: across a shaft this is no angle of the shaft. A film takes the pin for parallel to its shell. `accept askew` in the element takes it for meant.",
        "marker support = at([0, 0, 100] mm, z: [1, 0, 0])\nforce shaft = TorsionSpring(disc.hub, support, stiffness: 10 N*m/rad)",
        "marker support = at([0, 0, 100] mm)\nforce shaft = TorsionSpring(disc.hub, support, stiffness: 10 N*m/rad)";
    IDLE = "W0757", "a coupling slips at the start, or a body or element does nothing",
        "The ends of a torsional spring turn at speeds that differ by more than a tenth, so that it winds up at once (a mere damper does not); a body is held on the ground and nothing else touches it; or a spring, film or gas acts between bodies that are joined rigidly. A flywheel that was joined to the ground instead of the crank does both. `accept idle` takes it for meant.",
        "joint bolts = Fixed(flywheel.hub, ground)",
        "joint bolts = Fixed(flywheel.hub, crank.flange)";
    LONG_STEP = "W0758", "a fixed step turns the cycle by more than 10 degrees",
        "Gas, films and stroke change much within such a step, and no error is controlled. Leave `step` out, or state a shorter one. `accept step` in the model takes it for meant.",
        "analysis run = transient(Engine(), duration: 4 rev, step: 1 ms)",
        "analysis run = transient(Engine(), duration: 4 rev)";
    SINKS = "W0764", "a spring is too soft for the weight that it carries",
        "With the stiffness at the start, a body sinks under its weight by more than half of the size of the model. Stiffness of N/mm was probably typed as N/m. Bodies that an element with states holds, and those that turn as they sink, are not asked. `accept sag` in the element takes it for meant.",
        "force strut = LinearSpring(car.seat, wheel.hub, stiffness: 22 N/m, free_length: 460 mm)",
        "force strut = LinearSpring(car.seat, wheel.hub, stiffness: 22 kN/m, free_length: 460 mm)";
    SAMPLING = "W0763", "samples are far apart for the speed of the cycle, or the run is short",
        "The cycle turns by more than 30 degrees between two samples, or a run is stated to end after less than 5. `sample: 2 rev` was probably meant as `2 deg`, `duration: 4 deg` as `4 rev`. `accept sampling` in the model takes it for meant.",
        "analysis run = transient(Engine(), duration: 4 rev, sample: 100 deg)",
        "analysis run = transient(Engine(), duration: 4 rev, sample: 1 deg)";
    CYCLE = "W0765", "the cycle swings, or runs backwards under a gas trace",
        "A gas trace is written over a cycle angle that grows. Where the angle falls at the start, gas is compressed after it has burnt: it brakes the engine that it should drive. The angle of a rod swings to and fro: a cycle, a duration and samples in revolutions never end. The cycle is the angle of the crank from the ground, and grows at the speed that the start and the drive state. `accept cycle` in the model takes it for meant.",
        "cycle angle = rotation(ground, crank.flange) { period = 720 deg }",
        "cycle angle = rotation(crank.flange, ground) { period = 720 deg }";
    CYLINDER = "W0759", "a cylinder's gas does not fit the motion of its piston",
        "The machine is turned through its cycle by its geometry. A firing angle is more than 15 degrees from the piston's dead centre, the same for all cylinders, or the same for some of them while others fire alone; one piston of several has no gas; bore over stroke is outside 0.6 to 1.7; rod over throw is outside 2 to 10; piston and head run together; the rod stands between piston and head, so that gas pulls it; the head moves and the piston does not; the head is on the crank; the piston does not move; the bore is slanted to the crankshaft. `accept firing`, `bore`, `mirrored` or `swapped` in the element takes it for meant.",
        "force gas[i in 1..4] = GasPressure(piston[i].bore, block.liner[i], bore: 86 mm, pressure: indicated)",
        "force gas[i in 1..4] = GasPressure(piston[i].bore, block.liner[i], bore: 86 mm, pressure: indicated, firing: firing[i])";
    NOISE = "W0716", "an output is lost in the noise of the steps",
        "`periodic` ended because the motion repeats to within the tolerance of its steps, but this output goes on changing from cycle to cycle, without any order. It is a small difference of large values, or a derivative of a small motion: the errors of the steps are enlarged in it. The message names the tolerance that would bring them below `change`.",
        "analysis steady = periodic(Engine())",
        "analysis steady = periodic(Engine(), tolerance: 0.01)";
    DAMPED_AWAY = "W0717", "the steps damp a vibration away that they do not follow",
        "A stiff spring holds a body, and what the motion begins with, or a blow, makes it vibrate. The vibration is larger than the tolerance of positions and faster than the steps follow, so the integration's own damping takes its energy: amplitude and forces of this vibration are wrong. It is not said of stiff joints that follow their loads. The message names the body, the frequency and a step. Take a smaller `step` or `tolerance`, damp the spring, or begin in balance.",
        "analysis hit = transient(Hammer(), duration: 10 ms, sample: 0.1 ms, step: 0.1 ms)",
        "analysis hit = transient(Hammer(), duration: 10 ms, sample: 0.1 ms)";
    PARAMETER_ADVISED = "W0720", "parameters do not follow an `advise`",
        "The run goes on, but the class takes these parameters for doubtful: a clearance that may be diametral instead of radial. The text is its author's.",
        "", "";
}

eng_grammar::codes! {
    REDUCING:

    MESH = "E0730", "a mesh cannot be read",
        "The file is not there, not what its format says, or its elements make no structure. The message names the line, the card or the element.",
        "flexible crank { mesh = nastran(\"crnk.bdf\", units: mm_tonne_s) }",
        "flexible crank { mesh = nastran(\"crank.bdf\", units: mm_tonne_s) }";
    MESH_MARKER = "E0731", "a marker does not stand on its mesh as it should",
        "The node, set or ring is not there, or an element turns a marker that stands on the node of a solid, which has no rotation. Gathered nodes have one.",
        "flexible rod { marker big = node(17) }",
        "flexible rod { marker big = ring(center: [0, 0, 0] mm, axis: z, radius: 24 mm, width: 20 mm) }";
    REDUCTION = "E0732", "a flexible body cannot be reduced",
        "A part of the mesh hangs together with nothing, a matrix makes no sense, or modes of that number do not exist. The message says which.",
        "", "";
    MESH_UNITS = "W0730", "with the stated units, size or material make no engine part",
        "Finite-element files don't state their units. Length, density and stiffness are compared with those of solids that exist.",
        "flexible crank { mesh = nastran(\"crank.bdf\", units: si) }",
        "flexible crank { mesh = nastran(\"crank.bdf\", units: mm_tonne_s) }";
    UNREAD = "E0733", "a mesh holds stiffness, mass or constraints that are not read",
        "A body reduced without them would be another one. Cards and keywords that are not known count, too. Replace them in the file by what is read, state them in the model, take matrices of the code that reads them; or list in `ignore` what the body can do without.",
        "flexible crank { mesh = nastran(\"crank.bdf\", units: mm_tonne_s) }",
        "flexible crank { mesh = nastran(\"crank.bdf\", units: mm_tonne_s, ignore: [\"CBUSH\"]) }";
    ELEMENT_RULE = "E0734", "an element's own rule is not reproduced",
        "Codes integrate elements of one shape in several ways: reduced with artificial stiffness against hourglasses, with incompatible modes, hybrid. Frequencies differ by some percent up to a half. What is not reproduced digit by digit is not computed by another rule without a word: change the type in the file, or state `element_rules = exact` for full integration.",
        "flexible rod { mesh = calculix(\"c3d8r.inp\", units: si) }",
        "flexible rod { mesh = calculix(\"c3d8r.inp\", units: si); element_rules = exact }";
    IGNORED_NOTHING = "W0733", "`ignore` of a mesh names what it does not hold",
        "Nothing of this name is left out of the file: a spelling mistake, or the file has changed. Names are those of the message that stopped the reduction.",
        "flexible rod { mesh = nastran(\"rod.bdf\", units: si, ignore: [\"CBUHS\"]) }",
        "flexible rod { mesh = nastran(\"rod.bdf\", units: si, ignore: [\"CBUSH\"]) }";
    DECK_SUPPORT = "W0734", "the supports of a deck are not used",
        "The deck holds nodes (SPC, *BOUNDARY), but the body takes its supports from the text: without any it is free. `support = deck` holds what the deck holds; `ignore` leaves it out without a word.",
        "flexible block { mesh = nastran(\"block.bdf\", units: si) }",
        "flexible block { mesh = nastran(\"block.bdf\", units: si); support = deck }";
    MESH_DOUBT = "W0735", "a mesh was read as its own code reads it, and may be meant otherwise",
        "A card calls a continuation that is not there: its own code reads the card without it, but a line may have been lost.",
        "", "";
    REDUCED = "W0732", "something about a reduced body is doubtful",
        "Shells that are ignored give mass and no stiffness, elements are integrated in full that their code reduces, matrices of another code have few digits or are of a held structure, masses disagree. The message says which, and by how much.",
        "", "";
}

eng_grammar::codes! {
    COMMANDING:

    JUMPING = "W0770", "a run goes on in very short steps, for a force, a torque or the rate of a state jumps",
        "The motion stays where a value by `if` changes at once, and is driven back to that place from both sides. The run is right but slow; a slope in place of the jump makes it fast.",
        "apply force (if v > 0 m/s then -20 N else 20 N)*b.y on a against b",
        "apply force -20 N*tanh(v/(1 mm/s))*b.y on a against b";
    SLOWING = "W0771", "a run slows down",
        "Its rest takes more than ten minutes at the pace of its last steps, and ten times as long as it seemed to take before: steps become shorter as the motion goes on. The message names what makes them short. The run goes on and is right, unless something grows without bound.",
        "", "";
    USAGE = "E9902", "the command line cannot be followed",
        "A word that no command takes, a value that is none, a parameter that is not there. `eng help` and `eng help COMMAND` tell what there is.",
        "", "";
    SYSTEM = "E9903", "the system refused",
        "A file is not there, cannot be read or is no file. The message names it, and what the system said.",
        "", "";
}

/// All codes of all stages, in order.
pub fn all() -> Vec<&'static Code> {
    let mut all: Vec<&Code> = eng_grammar::CODES
        .iter()
        .chain(eng_compiler::codes::all())
        .chain(RUNNING)
        .chain(REDUCING)
        .chain(COMMANDING)
        .collect();
    // by number; errors, warnings and notes of one stage stand together
    all.sort_by_key(|code| (code.code.get(1..3), code.code));
    all
}

/// The code of a name, in upper or lower case.
pub fn find(name: &str) -> Option<&'static Code> {
    all()
        .into_iter()
        .find(|code| code.code.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use eng_grammar::{Diagnostics, SourceMap, parse};
    use std::collections::BTreeSet;

    #[test]
    fn every_code_has_one_meaning_and_an_explanation() {
        let mut seen = BTreeSet::new();
        for code in all() {
            assert!(seen.insert(code.code), "{} stands twice", code.code);
            assert!(
                !code.title.is_empty() && !code.title.ends_with('.'),
                "{}",
                code.code
            );
            assert!(code.meaning.ends_with('.'), "{}", code.code);
            assert_eq!(
                code.wrong.is_empty(),
                code.right.is_empty(),
                "{}",
                code.code
            );
        }
        assert!(seen.len() > 100);
    }

    /// The examples are of the language; those that reading itself refuses are tested beside the grammar.
    #[test]
    fn examples_can_be_read() {
        for code in all().into_iter().filter(|c| !c.code.starts_with("E01")) {
            for text in [code.wrong, code.right] {
                let mut sources = SourceMap::new();
                let id = sources.add("example.eng", text);
                let mut diagnostics = Diagnostics::new();
                parse(text, id, &mut diagnostics);
                let found: Vec<_> = diagnostics.iter().collect();
                assert!(found.is_empty(), "{}: {text}\n{found:#?}", code.code);
            }
        }
    }
}
