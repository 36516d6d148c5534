//! The message codes of assembling, running and reducing (`07`) and of the command line (`99`), and all codes
//! with their explanations.
//!
//! The compiler's codes are in [`eng_compiler::codes`], those of the grammar in [`mod@eng_grammar::codes`].

pub use eng_compiler::codes::INTERNAL;
pub use eng_grammar::Code;

eng_grammar::codes! {
    RUNNING:

    OPTIONS = "E0701", "an option of a simulation has no meaning",
        "A program that embeds a model states an impossible step, tolerance or spectral radius. The message states the possible values.",
        "", "";
    BODY = "E0702", "a body has a mass or inertia that no body can have",
        "The inertia about the centre of mass must be positive definite, and none of its principal moments may exceed the sum of the other two. Check the unit, the sign of the products, and the reference point, which is the centre of mass.",
        "body rod { mass = 1 kg; inertia = [1, 1, 1] g*m^2; products_of_inertia = [2, 0, 0] g*m^2 }",
        "body rod { mass = 1 kg; inertia = [1, 1, 1] g*m^2; products_of_inertia = [0.2, 0, 0] g*m^2 }";
    OPEN_LOOP = "E0703", "the mechanism cannot be assembled: a loop stays open",
        "No positions fulfil all constraints. The message states the remaining gap. Causes are a wrong length, a marker on the wrong side, different axes, a `start` that the loop does not allow, or a position from which the search does not find the right one: then state a `guess` near it.",
        "", "";
    WRONG_BRANCH = "E0704", "the mechanism assembles only on another branch",
        "The joints close, but a `branch` condition does not hold in any position that was found. State a `guess` near the wanted position, or another `branch` in the block of the joint.",
        "", "";
    START_VELOCITY = "E0705", "start velocities contradict each other",
        "A velocity that `start` states does not fit the joints, the drives or other stated velocities. Remove one of them.",
        "", "";
    REDUNDANT = "E0706", "constraint equations repeat each other",
        "Two joints hold the same freedom, such as two revolutes on one axis. The distribution of their reactions is not determined. Replace one of them by a joint with fewer equations, or by a journal.",
        "joint left = Revolute(bar.left, block.left)\njoint right = Revolute(bar.right, block.right)",
        "joint left = Revolute(bar.left, block.left)\njoint right = PointOnLine(bar.right, block.right)";
    SINGULAR = "E0707", "accelerations are not determined",
        "A body without mass or inertia can move: the message names such bodies. Or the mechanism is at a position where it locks or can continue in two ways. Then the message names the constraint equations that depend on each other there. Start a few degrees away.",
        "body rod { mass = 0.6 kg; inertia = [0, 0, 0] g*m^2 }",
        "body rod { mass = 0.6 kg; inertia = [3.1, 0.12, 3] g*m^2 }";
    NOT_FINITE = "E0708", "an element gives a value that is no number",
        "An expression divides by zero, or takes the root of a negative number or the logarithm of a number that is not positive. The message names the element and the moment.",
        "apply force k/norm(a.origin - b.origin)*b.x on a against b",
        "apply force k/norm(a.origin - b.origin, floor: 1 um)*b.x on a against b";
    NO_STEP = "E0709", "a step has no solution, however small",
        "The equations jump or are very stiff at this moment: a force with `if` that jumps, a mechanism at the end of its reach. Make the force continuous, or look at the outputs just before that moment.",
        "", "";
    STEP_TOO_SMALL = "E0710", "the step falls below the resolution of numbers",
        "The motion is not smooth at this moment: a force or the rate of a state jumps or grows without bound. Make the force or rate continuous. The message names the body or the state whose error needs the small step.",
        "", "";
    REQUIRED = "E0711", "a `require` fails during the run",
        "A class has a condition for every step, and this condition fails: a pin touches its shell, a spring is blocked. The author of the class wrote the text of the message. Eng keeps the results up to this moment.",
        "", "";
    PROJECTION = "E0712", "a position cannot be projected onto the constraints",
        "Positions are projected onto the constraints. This fails if a step is too long for the motion, or if the mechanism locks or reaches its end.",
        "", "";
    OUTSIDE_TABLE = "E0713", "a table is read outside its points",
        "A table without `extrapolation` has no value there. The message names the table, its argument and the range of its points. State more points, shorten the run, make the table `periodic`, or state an `extrapolation`.",
        "table push(t: Time) -> Force = points([0, 0.1] s, [0, 1] N)",
        "table push(t: Time) -> Force = points([0, 0.1] s, [0, 1] N, extrapolation: hold)";
    CYCLE_STANDS = "E0714", "the cycle angle does not advance",
        "The duration is an angle, but the crank is at rest or oscillates. Give a time, or state a start velocity of the crank. `eng check` warns of a cycle whose angle the joints hold, such as that of a block: W0765.",
        "analysis run = transient(Engine(), duration: 4 rev, sample: 1 deg)",
        "analysis run = transient(Engine(), duration: 100 ms, sample: 0.1 ms)";
    CHECKPOINT = "E0715", "a checkpoint cannot be used",
        "The checkpoint is damaged, or belongs to another model, other parameters or another version. Start the run from its beginning.",
        "", "";
    ROUNDING = "E0716", "a tolerance is smaller than the rounding errors",
        "The tolerance requires errors of a step, or of the solution of its equations, below the rounding errors of this model with numbers of 16 digits. The message states the least possible tolerance, or the least length after `resolve`, of which the tolerance of positions is a thousandth. Bodies far from the origin and angles of many turns need a larger one.",
        "analysis run = transient(Engine(), duration: 4 rev, tolerance: 1e-12)",
        "analysis run = transient(Engine(), duration: 4 rev, tolerance: 1e-3)";
    INPUT = "E0717", "an input cannot be set like this",
        "A program sets an input to a number within the limits of the input. Only `interpolation: cubic` takes rates, only `linear` and `cubic` take the value of the next point, and a cubic input has no jump. An input that an analysis drives by a function of time cannot be set.",
        "", "";
    NO_FIELD = "E0719", "a field has no solution",
        "A kernel such as the oil film of a bearing cannot be made of its numbers, or it has no solution at a moment of the motion. The message names the reason: an opening that ends at an open end, or a pressure below that of the cavity.",
        "", "";
    PARAMETER_REQUIRED = "E0720", "parameters do not fulfil a `require`",
        "The class, or the language for masses and inertias, has a condition that these parameters do not fulfil. The author of the class wrote the text of the message.",
        "body rod { mass = -1 kg; inertia = [1, 1, 1] g*m^2 }",
        "body rod { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }";
    PARAMETER_NOT_FINITE = "E0721", "with these parameters a value is no number",
        "The expressions of the named item contain a division by zero, a root of a negative number or a direction of length zero.",
        "param length: Length = 0 mm\nlet stiffness = 1 N*m/length^2",
        "param length: Length = 100 mm in (1 mm, 1 m)\nlet stiffness = 1 N*m/length^2";
    PARAMETER_LIMITS = "E0722", "a parameter is outside its limits",
        "The limits after `in` are open: the value lies strictly between them.",
        "param length: Length = 3 m in (1 mm, 2 m)",
        "param length: Length = 1 m in (1 mm, 2 m)";
    TURNING = "E0740", "the linearised motion has no constant coefficients",
        "Bodies turn, and coefficients of the small motions turn with them: the shapes of a flexible body, unequal inertia, a joint or load beside the axis. Or time alone changes the coefficients: a stiffness that is a function of time, a shaken pivot, a varying load beside the axis. Eigenvalues with the coefficients held at one moment then give wrong whirl, damping and stability. The message names the bodies or elements and the reason. A change that moves no eigenvalue by more than a thousandth of its size is reported and not refused. If the motion repeats, `over:` with its period gives the modes of the period. `frozen: true` holds the coefficients at one moment, for frequencies well above the speed, and the result states this.",
        "analysis modes = linear(Rotor(), after: 1 s)",
        "analysis modes = linear(Rotor(), after: 1 s, over: 1 rev)";
    NOT_REPEATING = "E0741", "the motion does not repeat after the stated period",
        "`linear` with `over:` searches for a motion that repeats after this time or angle, up to whole turns. The message names the body with the largest deviation. Check the period (a four-stroke cycle has two turns), loads that depend on time, and bodies that drift or turn freely at speeds of their own. If the state is too far from a motion that repeats, the help proposes a nearer start: with the quasi-static start or with `after:`.",
        "analysis modes = linear(Engine(), after: 3 rev, over: 1 rev)",
        "analysis modes = linear(Engine(), after: 3 rev, over: 2 rev)";
    NO_PERIOD = "E0742", "`over` is an angle, and nothing turns",
        "`over:` is an angle, but the model has no cycle and no body turns. Give the period as a time.",
        "analysis modes = linear(Column(), over: 1 rev)",
        "analysis modes = linear(Column(), over: 20 ms)";
    UNSTEADY = "E0743", "the state of `linear` is neither rest nor a steady motion",
        "A body moves, or forces do not balance, and stiffness, damping or inertia changes along the motion: a pendulum at its turning point, a slider on its way, a model that was assembled and not balanced. Eigenvalues of that moment describe no motion. Take the quasi-static start, or let the motion decay with `after:`. If it repeats, `over:` with its period gives its modes. `frozen: true` holds the coefficients at the moment.",
        "analysis modes = linear(Pendulum(), start: assembled)",
        "analysis modes = linear(Pendulum())";
    NO_EQUILIBRIUM = "E0744", "a `static` analysis finds no equilibrium",
        "At rest, joints, springs, contacts and drives must balance the loads; drives hold their positions. The message names the body or element that moves on: a body that nothing holds, a pin in a film (films carry only while pins turn: `turning: true`), a contact that is never reached, a state of an element that changes. A position that `start` states is only the first value of the search; `at: 30 deg` holds the cycle's angle.",
        "model Loose { gravity = [0, 0, -9.81] m/s^2\nbody stone { mass = 1 kg; inertia = [1, 1, 1] g*m^2 } }\nanalysis rest = static(Loose())",
        "model Held { gravity = [0, 0, -9.81] m/s^2\nbody stone { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }\njoint hold = Fixed(stone.origin, ground) }\nanalysis rest = static(Held())";
    NOT_KINEMATIC = "E0775", "a `kinematic` analysis does not determine the motion",
        "A kinematic analysis has no forces that decide a motion: joints, drives, pins in the middle of their shells and the turning cycle must determine every body. The message names the cause: a free motion, a load that depends on the past, pins that cannot all be in the middle, a speed that jumps, or a position with several continuations.",
        "model Arm { gravity = [0, 0, 0] m/s^2\nbody arm { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }\nstart arm.angular_velocity = [0, 0, 60] rpm }\nanalysis turn = kinematic(Arm(), over: 1 s)",
        "model Arm { gravity = [0, 0, 0] m/s^2\nbody arm { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }\ndrive turn = PrescribedRotation(arm.origin, ground, speed: 60 rpm) }\nanalysis turn = kinematic(Arm(), over: 1 s)";
    GROWS = "E0745", "no vibration about this state is steady",
        "A frequency response is the vibration to which the motion settles under a sinusoidal input. A mode of the motion grows by itself, so the motion settles nowhere. The message names the mode. Correct the instability, for instance whirl of a lightly loaded journal or a falling torque curve, or linearise about another state by `after:`. With coefficients held by `frozen: true` a growth is no property of the motion: it is told and not refused.",
        "analysis shaken = response(Rotor(speed: 9000 rpm), to: push, of: [shaft.x], from: 10 Hz, up_to: 1 kHz)",
        "analysis shaken = response(Rotor(speed: 3000 rpm), to: push, of: [shaft.x], from: 10 Hz, up_to: 1 kHz)";
    KINKED = "E0746", "the state of a linearisation is at a kink whose sides differ",
        "A stop that just touches, a spring that acts from one position on, `if`, `max`, `min` or `abs` with a condition that is just met: the load has one slope on one side and another slope on the other. Small motions then obey no linear equations, so they have no modes and no frequency response. Where both slopes are equal the analysis goes on with them. An output that `response` or the matrices of `linear` ask for may have such a kink, too, as the absolute value of a displacement has at zero: then the message names the output. With `over:` the state is a motion: it must not rest at such a kink, and no load may jump on its way, because small motions meet the jump at another moment. The motion may pass kinks at which loads only bend. Move the state away from the kink by a load or a play, or round the law.",
        "analysis modes = linear(Stop(height: 0 mm))",
        "analysis modes = linear(Stop(height: -0.1 mm))";
    LOCKED = "E0760", "the mechanism locks",
        "Its geometry allows no further motion at this position: a rod shorter than the throw, a guide whose axis is across the motion, two joints that require different motions. Forces play no part. The message names the loop of bodies, the lengths between their joints and the axes.",
        "", "";
    NO_TURN = "W0761", "the machine does not complete its cycle",
        "`eng check` turns the assembled machine through one period, or without a cycle through one turn of its fastest drive. It uses the geometry alone: no forces, pins in the middle of their shells. At the stated angle or time the machine locks. The message names the loop of bodies, the lengths between their joints and the axes. A run fails at this position, or the crank turns back.",
        "", "";
    HANGING = "W0762", "nothing holds a body against a motion",
        "The body is connected to others, but no joint, film or force holds it against some motion: a coupling turns it and does not carry it. It falls, and bodies that it carries fall with it.",
        "", "";
    JUMPS = "E0770", "a force, a torque or the rate of a state jumps, and the motion stays at the jump",
        "A value by `if` jumps where its condition changes, and the loads drive the motion back to this place from both sides. So the steps become shorter without end. The message names the element and the size of the jump. Connect the two values by a slope.",
        "apply force (if v > 0 m/s then -20 N else 20 N)*b.y on a against b",
        "apply force -20 N*tanh(v/(1 mm/s))*b.y on a against b";
    STOPPED = "E0771", "a run was stopped before its end",
        "At the pace of its steps the run would take days or years. The message names the cause of the short steps: a stated step, a load that jumps, a body on a very stiff support, or a motion that grows without bound. Correct the cause. `eng run --patient` lets the run continue for any time.",
        "", "";
    FAR_GUESS = "E0772", "a body is guessed where no joint reaches",
        "The search for the assembled position begins at the `guess`. From a distance of a thousand times the model's size it does not find the intended position: a unit is wrong.",
        "body crank { mass = 20 kg; inertia = [1, 1, 1] kg*m^2; guess position = [10, 1e9, 0] um }",
        "body crank { mass = 20 kg; inertia = [1, 1, 1] kg*m^2; guess position = [10, 10, 0] um }";
    RUNAWAY = "E0773", "a body runs away from the model",
        "The body is a million times the model's size from the ground's origin and kept accelerating on its way: a force with the wrong sign drives it, or a table has a number in a wrong unit. Bodies in free flight or under a constant force, and runs that begin far away, give no message.",
        "let push = if place < 0 mm then stiffness*place else 0 N",
        "let push = if place < 0 mm then -stiffness*place else 0 N";
    DEMANDED = "E0774", "a constraint demands a velocity or a position that jumps",
        "A drive or a joint states a motion with a corner: `max`, `min`, `abs`, an `if`, the end of a table that is held, or the end of a `wrapped` angle. At the corner the demanded velocity jumps, and bodies follow it by an impulse alone. An impulse needs a law about its loss of energy, and Eng has none. Where only the demanded acceleration jumps, the run continues. Round the corner: ramp the speed over some time.",
        "drive turn = PrescribedAngle(shaft.main, rail, angle_at: ramp)",
        "drive turn = PrescribedAngle(shaft.main, rail, angle_at: smooth_ramp)";
    ADVISED = "W0711", "an `advise` fails during the run",
        "The run continues, but its class reports a doubt. Each element gives one message, at the first moment. The author of the class wrote the text of the message.",
        "", "";
    NO_BALANCE = "W0712", "no quasi-static start was found",
        "A turning engine starts where its films and flexible bodies balance the loads of the steady motion. Here the named element prevents this: a journal that cannot carry its load, a mechanism that locks. The run starts as assembled, and rings at first. Correct the cause, or write `start: assembled`.",
        "", "";
    NOT_PERIODIC = "W0713", "the cycle does not repeat",
        "`periodic` ended after the stated number of `cycles`. The message names the channel that changes most, and the factor by which deviations of the motion shrink or grow in each cycle. With a factor well below 1, allow more cycles. Near 1 the motion never repeats: whirl of a lightly loaded journal, a resonance, a speed that drifts. If the changes neither shrink nor follow from earlier ones, as with impacts, the message has no factor. Eng keeps the last cycle.",
        "", "";
    WHIRL = "W0714", "a journal whirls at about half speed",
        "The pin circles at about half the shaft's speed and does not return after a cycle. A film that carries little load is unstable in this way. Load the journal, widen the clearance, take thinner oil or a shorter bearing, or check whether the load of the model is too small.",
        "", "";
    UPSIDE_DOWN = "W0715", "a balance or a steady motion is unstable",
        "The forces are in balance, but the smallest push leads away from it: a pendulum above its pivot, a column compressed beyond its buckling load. The run remains there until rounding or a load moves the body. If this is not intended, begin beside the balance with `guess`. The message names the body that leaves it, and the rate.",
        "", "";
    BENT_AS_IF_LOADS_TURNED = "W0745", "a turning flexible body starts bent as if all loads turned with it",
        "A load that is fixed in space, such as weight, bends a turning shaft as at rest. A load that turns with the shaft, such as an unbalance, bends it 1/(1 − Ω²/ω²) times as much (speed Ω, bending frequency ω). The motion that repeats after a turn or a cycle distinguishes them. Here the start found none, for the stated reason: a speed that changes, shafts without a common period, a load in resonance with an undamped shape, equations that the iteration does not solve. So all loads are treated as turning, and the body rings at first. Give the model a cycle or constant speeds, damp the shape, or begin with `start: assembled`.",
        "", "";
    ACCEPT_UNUSED = "W0750", "an `accept` accepts nothing",
        "No lint of this name gives a warning for this item, in any analysis of the file. An unnecessary acceptance would hide a later mistake: remove it.",
        "joint big_end = Revolute(rod.big, crank.pin) { accept loose }",
        "joint big_end = Revolute(rod.big, crank.pin)";
    INERTIA = "W0751", "the inertia of a body does not fit its mass and size",
        "The radius of gyration is the root of inertia over mass. It has four limits. The first is 0.13 to 2.6 times the distance from the centre of mass to the farthest marker, if this distance is more than 20 mm. The lower end applies to bodies with markers on both sides of the centre of mass. The upper end applies above three radii of a ball of steel of the same mass. The second limit is 2.6 times the largest such distance in the model. The third limit is 0.3 times the radius of gyration of a ball of tungsten of the same mass, which has the least inertia of all bodies. The fourth limit is twenty radii of the ball of steel. Outside these limits a unit is probably wrong. The same holds if the centre of mass is far from all markers. In a body with its markers in line, the moments across the line are the large ones. The centre of mass of a rod is between its ends. If the values are intended, write `accept inertia` in the body.",
        "body rod { mass = 0.62 kg; inertia = [0.12, 3.0, 3.1] kg*m^2 }",
        "body rod { mass = 0.62 kg; inertia = [0.12, 3.0, 3.1] g*m^2 }";
    GRAVITY = "W0752", "gravity is neither 0 nor that of the earth",
        "Gravity is usually 9.7 to 10.1 m/s^2 or 0: a unit or a component is probably wrong. In an engine with gas it acts neither towards the heads nor along the crankshaft. If the value is intended, write `accept gravity` in the model.",
        "model Engine { gravity = [0, -9.81, 0] mm/s^2 }",
        "model Engine { gravity = [0, -9.81, 0] m/s^2 }";
    PERIOD = "W0753", "a periodic table does not fit the cycle",
        "The cycle's period is no whole number of half turns, or of periods of the table: a four-stroke engine's pressure over 720 deg in a cycle of 360 deg is read at other angles in every second cycle. If this is intended, write `accept period` in the model.",
        "cycle angle = rotation(crank.flange, ground) { period = 360 deg }",
        "cycle angle = rotation(crank.flange, ground) { period = 720 deg }";
    LOOSE = "W0754", "nothing holds a body in some direction",
        "No joint holds the body, and no force depends on its displacement or its velocity. The message appears in a machine with a cycle or films, and for a body that turns and falls along its axis. The rotation of a body that starts with a spin and the rotation of the cycle do not count. Gas, gravity and loads hold nothing. If this is intended, write `accept loose` in the body.",
        "journal main[j in 1..5] = Impedance(pin: crank.main[j], shell: block.main[j], diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 12 mPa*s)",
        "journal main[j in 1..5] = Impedance(pin: crank.main[j], shell: block.main[j], diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 12 mPa*s)\njoint thrust = PointOnPlane(crank.main[3], block.main[3])";
    APART = "W0755", "markers of an element are far apart",
        "A joint puts a point on a line, far from the other marker, and the point does not move along the line: the rod and the piston belong to different cylinders. The limit is twice the smaller radius of gyration of the two bodies, and for a piston under gas also a fifth of the bore. Or a slide whose position only its guide decides begins at the model's origin, 10 mm or more from the other marker: state its position. If this is intended, write `accept apart` in the element.",
        "joint wrist[i in 1..4] = PointOnLine(rod[i].small, piston[5 - i].pin)",
        "joint wrist[i in 1..4] = PointOnLine(rod[i].small, piston[i].pin)";
    SWAPPED = "W0756", "the markers of an element are in each other's places",
        "At the start the shell turns at more than twice the speed of the pin. The film's frame, its angles and its tables are those of the shell: pin and shell are probably swapped. Or a force between a part in its guide and a shaft in its bearing, such as that of a tappet on its cam, loads the guide and not the part. If this is intended, as for a rotating bush, write `accept swapped` in the element.",
        "journal main = Short(pin: block.main, shell: crank.main, diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 12 mPa*s)",
        "journal main = Short(pin: crank.main, shell: block.main, diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 12 mPa*s)";
    ASKEW = "W0766", "the axes of an angle or a film are not parallel",
        "At the start the z axes of the two markers are more than 5 degrees apart. An angle `rotation(a, b)`, a torsional spring and a cycle measure the angle of a.x about b.z. If b.z is across the shaft, this angle is not the rotation of the shaft. A film assumes a pin parallel to its shell. If this is intended, write `accept askew` in the element.",
        "marker support = at([0, 0, 100] mm, z: [1, 0, 0])\nforce shaft = TorsionSpring(disc.hub, support, stiffness: 10 N*m/rad)",
        "marker support = at([0, 0, 100] mm)\nforce shaft = TorsionSpring(disc.hub, support, stiffness: 10 N*m/rad)";
    IDLE = "W0757", "a coupling slips at the start, or a body or element does nothing",
        "The ends of a torsional spring turn at speeds that differ by more than a tenth, so that the spring winds up at once. A pure damper, a torque that repeats with each turn, and a disc that oscillates on a spring to the ground get no warning. Or a body is fixed to the ground and no other element acts on it. Or a spring, film or gas acts between bodies that are joined rigidly. A flywheel that is joined to the ground instead of the crank causes both. If this is intended, write `accept idle`.",
        "joint bolts = Fixed(flywheel.hub, ground)",
        "joint bolts = Fixed(flywheel.hub, crank.flange)";
    BENDING_START = "W0767", "start velocities agree only if flexible bodies vibrate",
        "With rigid bodies the stated velocities contradict the joints, the drives or each other. A flexible body can bend or twist at the missing rate, so the run starts, with a strong vibration. Usually the speed of a shaft is stated twice, with two numbers. State it once.",
        "start crank.angular_velocity = [0, 0, 4000] rpm\ndrive dyno = PrescribedRotation(crank.flange, ground, speed: 2000 rpm)",
        "start crank.angular_velocity = [0, 0, 4000] rpm\ndrive dyno = PrescribedRotation(crank.flange, ground, speed: 4000 rpm)";
    LONG_STEP = "W0758", "a fixed step turns the cycle by more than 10 degrees",
        "Gas, films and stroke change much within such a step, and fixed steps have no error control. Remove `step`, or state a shorter one. If this is intended, write `accept step` in the model.",
        "analysis run = transient(Engine(), duration: 4 rev, step: 1 ms)",
        "analysis run = transient(Engine(), duration: 4 rev)";
    SINKS = "W0764", "a spring does not carry the weight on it",
        "With the stiffness at the start, a body sinks under its weight by more than half of the model's length. A stiffness in N/mm was probably typed as N/m. Or the springs of a body push it along gravity before any motion, with 0.4 to 3 times the weight that they carry: a preload or gravity has probably the wrong sign. Bodies that an element with states holds, and bodies that turn as they sink, are not checked. Gas holds its piston, and not the engine on its mounts. If this is intended, write `accept sag` in the element.",
        "force strut = LinearSpring(car.seat, wheel.hub, stiffness: 22 N/m, free_length: 460 mm)",
        "force strut = LinearSpring(car.seat, wheel.hub, stiffness: 22 kN/m, free_length: 460 mm)";
    SAMPLING = "W0763", "samples are far apart for the speed of the cycle, or the run is short",
        "The cycle turns by more than 30 degrees between two samples, or a stated duration is less than 5 degrees. `sample: 2 rev` was probably meant as `2 deg`, and `duration: 4 deg` as `4 rev`. If this is intended, write `accept sampling` in the model.",
        "analysis run = transient(Engine(), duration: 4 rev, sample: 100 deg)",
        "analysis run = transient(Engine(), duration: 4 rev, sample: 1 deg)";
    CYCLE = "W0765", "the cycle oscillates, stands still, or runs backwards under a gas trace",
        "A gas trace is a function of a cycle angle that increases. If the angle decreases at the start, gas is compressed after it has burnt: it brakes the engine instead of driving it. If the angle oscillates, as that of a rod does, or does not change, as that of a block on its mounts, a cycle, a duration and samples in revolutions never end: a run of such a duration is refused (E0714). The cycle's angle is that of the crank from the ground, and it increases at the speed that the start and the drive state. If this is intended, write `accept cycle` in the model.",
        "cycle angle = rotation(ground, crank.flange) { period = 720 deg }",
        "cycle angle = rotation(crank.flange, ground) { period = 720 deg }";
    CYLINDER = "W0759", "a cylinder's gas does not fit the motion of its piston",
        "The check turns the machine through its cycle by its geometry. It warns of these cases. A firing angle is more than 15 degrees from the dead centre of its piston. All cylinders have the same firing angle, or some have the same while others fire alone. One piston of several has no gas. Bore over stroke is outside 0.6 to 1.7. Rod over throw is outside 2 to 10. Piston and head collide. The rod is between piston and head, so that gas pulls it. The head moves and the piston does not. The head is on the crank. The piston does not move. The bore is slanted to the crankshaft. If a case is intended, write `accept firing`, `bore`, `mirrored` or `swapped` in the element.",
        "force gas[i in 1..4] = GasPressure(piston[i].bore, block.liner[i], bore: 86 mm, pressure: indicated)",
        "force gas[i in 1..4] = GasPressure(piston[i].bore, block.liner[i], bore: 86 mm, pressure: indicated, firing: firing[i])";
    NOISE = "W0716", "an output is lost in the noise of the steps",
        "`periodic` ended because the motion repeats to within the tolerance of its steps, but this output still changes irregularly from cycle to cycle. It is a small difference of large values, or a derivative of a small motion, which enlarges the errors of the steps. The message names a tolerance with which these errors are below `change`.",
        "analysis steady = periodic(Engine())",
        "analysis steady = periodic(Engine(), tolerance: 0.01)";
    DAMPED_AWAY = "W0717", "the steps damp a vibration that they do not follow",
        "A stiff spring holds a body, and the start of the motion, or a blow, makes it vibrate. The vibration is larger than the tolerance of positions and faster than the steps follow, so the integration's own damping takes its energy: amplitude and forces of this vibration are wrong. Stiff joints that follow their loads give no message. The message names the body, the frequency and a step. Take a smaller `step` or `tolerance`, damp the spring, or begin in balance.",
        "analysis hit = transient(Hammer(), duration: 10 ms, sample: 0.1 ms, step: 0.1 ms)",
        "analysis hit = transient(Hammer(), duration: 10 ms, sample: 0.1 ms)";
    OVERLOOKED = "W0718", "a fixed step passes a stop or another kink",
        "A force bends where the argument of an `if`, `max`, `min` or `abs` changes its sign, or at the end of a table. Steps under error control end there. A stated step does not. It uses the force at its ends only, so a stop may act late, with a false depth, or not at all. The message names the element and the largest depth. It appears if the class states the depth that matters (`resolve`), or if the step passes a whole interval of the law, such as a thin stop.",
        "analysis drop = transient(Bench(), duration: 60 ms, sample: 1 ms, step: 1 ms)",
        "analysis drop = transient(Bench(), duration: 60 ms, sample: 1 ms)";
    SHARED = "W0772", "a kinematic analysis does not determine some reactions",
        "Several joints or films hold the same motions, such as five main bearings that hold one shaft. How they share a load depends on stiffnesses and clearances, which a kinematic analysis does not have. The channels that contain such reactions are not in its results. All other channels are right. Replace joints by such with fewer equations, or compute these reactions by `transient` or `periodic` with films or flexible bodies.",
        "joint left = Revolute(bar.left, block.left)\njoint right = Revolute(bar.right, block.right)",
        "joint left = Revolute(bar.left, block.left)\njoint right = PointOnLine(bar.right, block.right)";
    INDEPENDENT = "W0719", "an output does not depend on the input of a response",
        "The response of the output is zero at every frequency: no load that the input changes reaches it. Causes are a wrong path, a load that the input does not enter, or another part of the model. A vector is named only if the input moves none of its components. Zero is the right answer if the output is meant to be unmoved.",
        "analysis shaken = response(Cart(), to: push, of: [other.travel], from: 1 Hz, up_to: 100 Hz)",
        "analysis shaken = response(Cart(), to: push, of: [rail.travel], from: 1 Hz, up_to: 100 Hz)";
    PARAMETER_ADVISED = "W0720", "parameters do not follow an `advise`",
        "The run continues, but the class doubts these parameters: a clearance that may be diametral instead of radial. The author of the class wrote the text of the message.",
        "", "";
}

eng_grammar::codes! {
    REDUCING:

    MESH = "E0730", "a mesh cannot be read",
        "The file is missing, does not have its stated format, or its elements make no structure. The message names the line, the card or the element.",
        "flexible crank { mesh = nastran(\"crnk.bdf\", units: mm_tonne_s) }",
        "flexible crank { mesh = nastran(\"crank.bdf\", units: mm_tonne_s) }";
    MESH_MARKER = "E0731", "a marker does not fit its mesh",
        "The node, set or ring is missing, or an element turns a marker on a single node of a solid, which has no rotation. Several nodes with a tie have a rotation.",
        "flexible rod { marker big = node(17) }",
        "flexible rod { marker big = ring(center: [0, 0, 0] mm, axis: z, radius: 24 mm, width: 20 mm) }";
    REDUCTION = "E0732", "a flexible body cannot be reduced",
        "A part of the mesh is connected to nothing, a matrix makes no sense, or so many modes do not exist. The message names the cause.",
        "", "";
    STACK = "E0735", "stacked sections make no mesh",
        "An outline crosses itself or has no area, neighbours have no common area, the elements are larger than a section is wide, outlines run too close to each other, or there would be too many nodes. The message names the section, counted from 1 along the axis, and the place in its plane.",
        "mesh = stack(axis: z, size: 10 mm, sections: [disc(20 mm, length: 50 mm), disc(20 mm, length: 50 mm, center: [50, 0] mm)])",
        "mesh = stack(axis: z, size: 10 mm, sections: [disc(20 mm, length: 50 mm), disc(20 mm, length: 50 mm, center: [30, 0] mm)])";
    MESH_UNITS = "W0730", "with the stated units, size or material make no engine part",
        "Finite-element files don't state their units. Length, density and stiffness are compared with those of solids that exist.",
        "flexible crank { mesh = nastran(\"crank.bdf\", units: si) }",
        "flexible crank { mesh = nastran(\"crank.bdf\", units: mm_tonne_s) }";
    UNREAD = "E0733", "a mesh holds stiffness, mass or constraints that are not read",
        "A body that is reduced without them would be another one. Unknown cards and keywords count, too. Replace them in the file by cards that Eng reads, state them in the model, or take matrices of the code that reads them. If the body does not need them, list them in `ignore`.",
        "flexible crank { mesh = nastran(\"crank.bdf\", units: mm_tonne_s) }",
        "flexible crank { mesh = nastran(\"crank.bdf\", units: mm_tonne_s, ignore: [\"CBEND\"]) }";
    ELEMENT_RULE = "E0734", "an element's own rule is not reproduced",
        "Codes integrate elements of one shape in several ways: reduced with artificial stiffness against hourglasses, with incompatible modes, hybrid. Frequencies differ by some per cent up to a half. Eng does not silently replace a rule that it does not reproduce digit by digit: change the type in the file, or state `element_rules = exact` for full integration.",
        "flexible rod { mesh = calculix(\"c3d8r.inp\", units: si) }",
        "flexible rod { mesh = calculix(\"c3d8r.inp\", units: si); element_rules = exact }";
    IGNORED_NOTHING = "W0733", "`ignore` of a mesh names a card that the file does not hold",
        "The file has no card or keyword of this name: a spelling mistake, or the file has changed. Names are those of the message that stopped the reduction.",
        "flexible rod { mesh = nastran(\"rod.bdf\", units: si, ignore: [\"CBUHS\"]) }",
        "flexible rod { mesh = nastran(\"rod.bdf\", units: si, ignore: [\"CBEND\"]) }";
    DECK_SUPPORT = "W0734", "the supports of a deck are not used",
        "The deck holds nodes (SPC, *BOUNDARY), but the body takes its supports from the text, and without any it is free. `support = deck` uses the supports of the deck. `ignore` leaves them out without a message.",
        "flexible block { mesh = nastran(\"block.bdf\", units: si) }",
        "flexible block { mesh = nastran(\"block.bdf\", units: si); support = deck }";
    MESH_DOUBT = "W0735", "a mesh was read as its own code reads it, and may be intended otherwise",
        "A card names a continuation that is missing: its own code reads the card without it, but a line may have been lost.",
        "", "";
    REDUCED = "W0732", "the reduction of a body is doubtful",
        "Ignored shells give mass and no stiffness, elements that their code integrates in a reduced way are integrated in full, matrices of another code have few digits or belong to a held structure, or masses disagree. The message names the case and its size.",
        "", "";
}

eng_grammar::codes! {
    COMMANDING:

    JUMPING = "W0770", "a run continues in very short steps, because a force, a torque or the rate of a state jumps",
        "The motion stays at a jump of a value by `if`, because the loads drive it back to this place from both sides. The run is right but slow. A slope in place of the jump makes it fast.",
        "apply force (if v > 0 m/s then -20 N else 20 N)*b.y on a against b",
        "apply force -20 N*tanh(v/(1 mm/s))*b.y on a against b";
    SLOWING = "W0771", "a run slows down",
        "At the pace of its last steps its remaining time is more than ten minutes, and ten times the first estimate: the steps become shorter. The message names the cause. The run continues and is right, unless a motion grows without bound.",
        "", "";
    USAGE = "E9902", "the command line is wrong",
        "The command line has a word that no command takes, an impossible value, or an unknown parameter. `eng help` and `eng help COMMAND` list the possibilities.",
        "", "";
    SYSTEM = "E9903", "the operating system refused",
        "A file is missing, cannot be read or is no file. The message names the file and the reason of the operating system.",
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
    // by number, so that errors, warnings and notes of one stage are together
    all.sort_by_key(|code| (code.code.get(1..3), code.code));
    all
}

/// The code of a name, in upper or lower case.
pub fn find(name: &str) -> Option<&'static Code> {
    all()
        .into_iter()
        .find(|code| code.code.eq_ignore_ascii_case(name))
}
