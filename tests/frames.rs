//! Vectors that elements put out: in any expression they are vectors in space. Checked with the recorded
//! components and the recorded axes of the frames, by matrix arithmetic of its own, and with closed forms.

use crate::support::{outcome, program_with_bar};
use eng::Results;
use std::f64::consts::TAU;

fn results(text: &str, analysis: &str) -> Results {
    outcome(&program_with_bar(text), analysis).results
}

fn column(results: &Results, path: &str) -> Vec<f64> {
    match results.column(path) {
        Some(column) => column.values.clone(),
        None => panic!("no column {path}"),
    }
}

type Triple = [f64; 3];

fn triple(results: &Results, path: &str, sample: usize) -> Triple {
    ["x", "y", "z"].map(|axis| column(results, &format!("{path}.{axis}"))[sample])
}

fn dot(a: Triple, b: Triple) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: Triple) -> f64 {
    dot(a, a).sqrt()
}

fn cross(a: Triple, b: Triple) -> Triple {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Axes of a marker in ground axes, as columns x, y, z.
type Axes = [Triple; 3];

/// c along axes, in ground axes.
fn in_ground(axes: Axes, c: Triple) -> Triple {
    std::array::from_fn(|i| (0..3).map(|k| axes[k][i] * c[k]).sum())
}

fn along(axes: Axes, v: Triple) -> Triple {
    axes.map(|axis| dot(axis, v))
}

#[track_caller]
fn near(found: Triple, due: Triple, size: f64, what: &str) {
    let off = norm(std::array::from_fn(|i| found[i] - due[i]));
    assert!(off <= 1e-12 * size, "{what}: {found:?} for {due:?}");
}

/// Forces and torques of every class between a tilted, turning carrier and bodies of their own; of classes of
/// the text, too.
const MACHINE: &str = "
use std.joints.*
use std.drives.*
use std.forces.*
use std.journals.{Short, Impedance}
fn sweep(t: Time) -> Angle = 3 rad/s * t + 0.2 rad*sin(10 rad/s * t)
/// A vector of its own arguments, shown along a third body's axes.
force Wind(a: Marker, m: Marker, load: Vector<Force>) {
    apply force load on a
    output drag: Vector<Force> = load in m as kN
    output drag_as_list: Vector<Force> = 2*load in a as N
    output felt = drag.x as N
}
model Machine {
    gravity = [1, -9.81, 2] m/s^2
    marker tilted = at([10, 20, 30] mm, x: [0.8, 0.5, -0.3], z: [0.3, -0.5, 0.8])
    marker wall = [0, 0, 0] mm
    body carrier {
        mass = 3 kg; inertia = [3, 4, 5] g*m^2
        marker seat[i in 1..14] = at([10*i, 5*i, -7*i] mm, x: [1, 0.1*i, 0.2], z: [-0.2, 0.3, 0.1*i])
    }
    body q[i in 1..14] {
        mass = 1 kg; inertia = [1, 2, 2.5] g*m^2; center_of_mass = [3, 7, -5] mm
        marker eye = at([2, -4, 6] mm, z: [0.5, 0.2*i, 1])
        marker off = at([102, -4, 6] mm, z: [0.5, 0.2*i, 1])
        marker pin = at([2, -4, 6] mm, z: [0.5, 0.2*i, 1])
    }
    body third { mass = 1 kg; inertia = [1, 2, 2.5] g*m^2; marker oblique = at([1, 2, 3] mm, z: [1, 1, 1], x: [1, -1, 0.1]) }
    drive whirl = ConstantSpeed(carrier.origin, tilted, speed: 700 rpm, initial: 20 deg)
    drive spin = ConstantSpeed(third.oblique, tilted, speed: -300 rpm)
    joint fixed = Fixed(q[1].eye, carrier.seat[1])
    joint hinge = Revolute(q[2].eye, carrier.seat[2])
    joint ball = Spherical(q[3].eye, carrier.seat[3])
    joint tube = Cylindrical(q[4].eye, carrier.seat[4])
    joint slide = Translational(q[5].eye, carrier.seat[5])
    joint line = PointOnLine(q[6].eye, carrier.seat[6])
    joint plane = PointOnPlane(q[7].eye, carrier.seat[7])
    joint cardan = Universal(q[8].eye, carrier.seat[8])
    joint parallel = ParallelAxes(q[9].eye, carrier.seat[9])
    joint rod = Distance(q[10].off, carrier.seat[10], length: 100 mm)
    joint hinge_of_spin = Revolute(q[11].eye, carrier.seat[11])
    drive speed = PrescribedRotation(q[11].eye, carrier.seat[11], speed: 30 rad/s, initial: 10 deg)
    joint hinge_of_sweep = Revolute(q[12].eye, carrier.seat[12])
    drive angle = PrescribedAngle(q[12].eye, carrier.seat[12], angle_at: sweep)
    joint in_film = Revolute(q[13].eye, carrier.seat[13])
    drive of_film = PrescribedRotation(q[13].eye, carrier.seat[13], speed: 3000 rpm)
    journal short = Short(q[13].pin, carrier.seat[14], diameter: 2.7 m, width: 0.65 m, radial_clearance: 100 mm, viscosity: 90 Pa*s)
    journal impedance = Impedance(q[13].pin, carrier.seat[14], diameter: 2.7 m, width: 1 m, radial_clearance: 100 mm, viscosity: 90 Pa*s)
    force bushing = Bushing(q[7].off, carrier.seat[7], stiffness: [1, 2, 3] N/mm, damping: [1, 1, 1] N*s/m,
        torsional_stiffness: [1, 2, 3] N*m/rad, torsional_damping: [1, 2, 3] N*m*s/rad)
    force wind = Wind(q[3].off, third.oblique, load: [1, 2, 3] N)
    /// Takes what another element puts out as its own load.
    force drawn = Wind(q[6].off, third.origin, load: bushing.force)
OUTPUTS
}
";

/// Outputs that are zero by the kind of their element: its constraints transmit no force, or no torque.
const ZERO: [&str; 8] = [
    "ball.torque",
    "line.torque",
    "plane.torque",
    "rod.torque",
    "parallel.force",
    "speed.force",
    "angle.force",
    "of_film.force",
];

/// Every vector that an element records, with the path of the marker whose axes it uses.
fn vectors() -> Vec<(String, String)> {
    let mut all = Vec::new();
    let seat = |i: usize| format!("carrier.seat[{i}]");
    let two_markers = [
        ("fixed", seat(1)),
        ("hinge", seat(2)),
        ("ball", seat(3)),
        ("tube", seat(4)),
        ("slide", seat(5)),
        ("line", seat(6)),
        ("plane", seat(7)),
        ("cardan", seat(8)),
        ("parallel", seat(9)),
        ("rod", seat(10)),
        ("hinge_of_spin", seat(11)),
        ("speed", seat(11)),
        ("hinge_of_sweep", seat(12)),
        ("angle", seat(12)),
        ("in_film", seat(13)),
        ("of_film", seat(13)),
        ("whirl", "tilted".to_owned()),
        ("spin", "tilted".to_owned()),
        ("bushing", seat(7)),
    ];
    for (element, frame) in two_markers {
        all.push((format!("{element}.force"), frame.clone()));
        all.push((format!("{element}.torque"), frame));
    }
    all.push(("bushing.deflection".to_owned(), seat(7)));
    all.push(("short.force".to_owned(), seat(14)));
    all.push(("impedance.force".to_owned(), seat(14)));
    all.push(("wind.drag".to_owned(), "third.oblique".to_owned()));
    all.push(("wind.drag_as_list".to_owned(), "q[3].off".to_owned()));
    all.push(("drawn.drag".to_owned(), "third.origin".to_owned()));
    all.push(("drawn.drag_as_list".to_owned(), "q[6].off".to_owned()));
    all
}

fn name(vector: &str) -> String {
    vector.replace('.', "_")
}

/// The recorded axes of a marker.
fn axes(results: &Results, marker: &str, sample: usize) -> Axes {
    let name = marker.replace(['.', '['], "_").replace(']', "");
    ["x", "y", "z"].map(|axis| triple(results, &format!("axis_{axis}_{name}"), sample))
}

fn outputs() -> String {
    let mut text = String::new();
    let mut frames: Vec<String> = vectors().into_iter().map(|v| v.1).collect();
    frames.push("q[2].eye".to_owned());
    frames.sort();
    frames.dedup();
    for frame in frames {
        let name = frame.replace(['.', '['], "_").replace(']', "");
        for axis in ["x", "y", "z"] {
            text += &format!("output axis_{axis}_{name} = {frame}.{axis} in ground\n");
        }
    }
    for (vector, frame) in vectors() {
        let name = name(&vector);
        text += &format!(
            "output {name}_in_ground = {vector} in ground
             output {name}_in_third = {vector} in third.oblique
             output {name}_in_body = {vector} in q[2].eye
             output {name}_in_own = {vector} in {frame}
             output {name}_along = [dot({vector}, ground.x), dot({vector}, ground.y), dot(ground.z, {vector})]
             output {name}_local = local({vector}, third.oblique)
             output {name}_cross = cross({vector}, third.oblique.x) in ground
             output {name}_twice = -2*{vector}/1 in ground
             output {name}_size = norm({vector})
             output {name}_x = {vector}.x
             output {name}_chosen = if time > 1 ms then {vector} else -{vector} in ground\n"
        );
    }
    text += "output sum = hinge.force + bushing.force - wind.drag + [1, 2, 3] N in third.oblique
             output moment = hinge.torque + cross(q[2].eye.origin - wall.origin, hinge.force) in wall
             output place = q[2].eye.origin - wall.origin in ground\n";
    text
}

#[test]
fn every_vector_of_an_element_is_one_in_space() {
    let text = MACHINE.replace("OUTPUTS", &outputs())
        + "analysis run = transient(Machine(), duration: 2 ms, sample: 1 ms, start: assembled)";
    let results = results(&text, "run");
    for sample in 0..3 {
        let third = axes(&results, "third.oblique", sample);
        let body = axes(&results, "q[2].eye", sample);
        for (vector, frame) in vectors() {
            let recorded = triple(&results, &vector, sample);
            let own = axes(&results, &frame, sample);
            let space = in_ground(own, recorded);
            let size = norm(recorded);
            assert_eq!(
                size < 1e-9,
                ZERO.contains(&vector.as_str()),
                "{vector} is {size}"
            );
            let size = size.max(1e-9);
            let name = name(&vector);
            let made = |kind: &str| triple(&results, &format!("{name}_{kind}"), sample);
            near(
                made("in_ground"),
                space,
                size,
                &format!("{vector} in ground"),
            );
            near(
                made("in_third"),
                along(third, space),
                size,
                &format!("{vector} in third"),
            );
            near(
                made("in_body"),
                along(body, space),
                size,
                &format!("{vector} in body"),
            );
            assert_eq!(made("in_own"), recorded, "{vector} in its own axes");
            near(
                made("along"),
                space,
                size,
                &format!("{vector} along ground"),
            );
            near(
                made("local"),
                along(third, space),
                size,
                &format!("local of {vector}"),
            );
            near(
                made("cross"),
                cross(space, third[0]),
                size,
                &format!("cross of {vector}"),
            );
            near(
                made("twice"),
                space.map(|x| -2.0 * x),
                2.0 * size,
                &format!("twice {vector}"),
            );
            let chosen = if sample == 2 {
                space
            } else {
                space.map(|x| -x)
            };
            near(made("chosen"), chosen, size, &format!("if with {vector}"));
            let single = |kind: &str| column(&results, &format!("{name}_{kind}"))[sample];
            assert!(
                (single("size") - norm(recorded)).abs() <= 1e-12 * size,
                "norm of {vector}"
            );
            assert_eq!(single("x"), recorded[0], "{vector}.x");
            let frame_of = |path: &str| {
                let column = results.column(&format!("{path}.y")).expect("a column");
                column.frame.clone()
            };
            assert_eq!(frame_of(&vector), frame);
            assert_eq!(frame_of(&format!("{name}_in_ground")), "ground");
            assert_eq!(frame_of(&format!("{name}_in_third")), "third.oblique");
            assert_eq!(frame_of(&format!("{name}_in_own")), frame);
            assert_eq!(frame_of(&format!("{name}_local")), "third.oblique");
            let of_component = results.column(&format!("{name}_x")).expect("a column");
            assert_eq!(of_component.frame, frame, "{vector}.x");
        }
        let space = |vector: &str, frame: &str| {
            in_ground(
                axes(&results, frame, sample),
                triple(&results, vector, sample),
            )
        };
        let hinge = space("hinge.force", "carrier.seat[2]");
        let bushing = space("bushing.force", "carrier.seat[7]");
        let wind = [1.0, 2.0, 3.0];
        let sum: Triple = std::array::from_fn(|i| hinge[i] + bushing[i] - wind[i] + wind[i]);
        let due = along(third, sum);
        near(
            triple(&results, "sum", sample),
            due,
            norm(hinge) + norm(bushing) + 4.0,
            "a sum",
        );
        let torque = space("hinge.torque", "carrier.seat[2]");
        let moved = cross(triple(&results, "place", sample), hinge);
        let due = std::array::from_fn(|i| torque[i] + moved[i]);
        near(
            triple(&results, "moment", sample),
            due,
            norm(torque) + norm(moved),
            "a moment",
        );
        // a value in ground axes is shown in the axes of the output
        near(
            space("wind.drag", "third.oblique"),
            wind,
            4.0,
            "an argument",
        );
        near(
            space("wind.drag_as_list", "q[3].off"),
            wind.map(|x| 2.0 * x),
            8.0,
            "a list",
        );
        near(
            space("drawn.drag", "third.origin"),
            bushing,
            norm(bushing),
            "handed on",
        );
        assert_eq!(
            column(&results, "wind.felt")[sample],
            triple(&results, "wind.drag", sample)[0]
        );
    }
}

/// A bob hangs on the rim of a disc that turns at 1 rev/s about z: its hinge carries m (a - g) with a = -w^2
/// r, in space. The disc's axes have turned by a quarter at 250 ms.
const HANGING: &str = "
use std.joints.Revolute
use std.drives.PrescribedRotation
use std.forces.Bushing
component Bob(m: Marker) {
    body bob { mass = 1 kg; inertia = [1, 1, 1] kg*m^2 }
    joint hang = Revolute(bob.origin, m)
    output in_ground: Vector<Force> = hang.force in ground as N
    output in_m: Vector<Force> = hang.force in m
    output along_x: Force = dot(hang.force, ground.x) as N
    output shown_x = in_m.x
}
component Rig(m: Marker) {
    part inner = Bob(m)
    output from_inside: Vector<Force> = inner.in_m in ground as N
    output of_its_joint = inner.hang.force in ground
    output doubled = inner.in_m + inner.in_ground in ground
    output inner_x = inner.in_m.x
    output inner_ground_x = inner.in_ground.x
}
record Pair { let a: Vector<Force>; let b: Vector<Force> }
fn larger(v: Vector<Force>, w: Vector<Force>) -> Vector<Force> = if norm(v) > norm(w) then v else w
/// Its own outputs name each other; its load is a state.
force Memory(a: Marker, b: Marker) {
    state pull: Force = 2 N
    der(pull) = 0 N/s
    apply force pull*b.x on a against b
    output held: Vector<Force> = pull*b.x in a
    output held_x = held.x
    output twice = 2*held in b
}
model Hanging {
    gravity = [-10, 0, 0] m/s^2
    marker base = [0, 0, 0] mm
    body disc { mass = 1 kg; inertia = [1, 1, 1] kg*m^2; marker arm = [100, 0, 0] mm }
    joint bearing = Revolute(disc.origin, base)
    drive turn = PrescribedRotation(disc.origin, base, speed: 60 rpm)
    force bush = Bushing(disc.origin, disc.arm, stiffness: [1, 1, 1] N/mm, damping: [0, 0, 0] N*s/m,
        torsional_stiffness: [1, 1, 1] N*m/rad, torsional_damping: [0, 0, 0] N*m*s/rad)
    part rig = Rig(disc.arm)
    output bush_in_ground: Vector<Force> = bush.force in ground as N
    output bush_and_bearing: Force = dot(bush.force + rig.inner.hang.force, ground.x) as N
    output from_part = rig.inner.in_m in ground
    output rig_doubled = rig.doubled in disc.origin
    let f = rig.inner.hang.force
    let both = Pair(a: f, b: bush.force)
    let all = [f, bush.force, f + bush.force]
    param pulled: Vector<Force> = [1, 2, 3] N
    force memory = Memory(disc.arm, disc.origin)
    output by_let = f in ground
    output by_let_x = (f).x
    output by_record = both.a in ground
    output by_record_sum = both.a + both.b in ground
    output by_list = all[3] in disc.origin
    output by_function = larger(all[1], all[2]) in ground
    output stated = pulled in disc.origin
    output of_state = memory.held in ground
}
analysis run = transient(Hanging(), duration: 250 ms, sample: 125 ms, start: assembled)";

#[test]
fn a_bob_on_a_turning_disc_pulls_as_its_closed_form() {
    let results = results(HANGING, "run");
    let time = column(&results, "time");
    for (sample, t) in time.iter().enumerate() {
        let (w, r) = (TAU, 0.1);
        let (sine, cosine) = (w * t).sin_cos();
        let force = [10.0 - w * w * r * cosine, -w * w * r * sine, 0.0];
        let disc = [[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]];
        let check = |path: &str, due: Triple| {
            let found = triple(&results, path, sample);
            let off = norm(std::array::from_fn(|i| found[i] - due[i]));
            assert!(off < 1e-5, "{path} at {t}: {found:?} for {due:?}");
        };
        check("rig.inner.in_ground", force);
        check("rig.inner.in_m", along(disc, force));
        check("rig.from_inside", force);
        check("rig.of_its_joint", force);
        check("rig.doubled", force.map(|x| 2.0 * x));
        check("rig_doubled", along(disc, force).map(|x| 2.0 * x));
        check("from_part", force);
        let single = |path: &str, due: f64| {
            let found = column(&results, path)[sample];
            assert!(
                (found - due).abs() < 1e-5,
                "{path} at {t}: {found} for {due}"
            );
        };
        single("rig.inner.along_x", force[0]);
        single("rig.inner.shown_x", along(disc, force)[0]);
        single("rig.inner_x", along(disc, force)[0]);
        single("rig.inner_ground_x", force[0]);
        // 1 N/mm over 100 mm, along the disc's x: towards the rim, for disc.origin is the first marker
        let bush = in_ground(disc, [100.0, 0.0, 0.0]);
        check("bush_in_ground", bush);
        single("bush_and_bearing", bush[0] + force[0]);
        let both = std::array::from_fn(|i| bush[i] + force[i]);
        check("by_let", force);
        single("by_let_x", along(disc, force)[0]);
        check("by_record", force);
        check("by_record_sum", both);
        check("by_list", along(disc, both));
        // 100 N of the bushing against at most 14 N
        check("by_function", bush);
        check("stated", along(disc, [1.0, 2.0, 3.0]));
        check("of_state", in_ground(disc, [2.0, 0.0, 0.0]));
        check("memory.twice", [4.0, 0.0, 0.0]);
        single("memory.held_x", 2.0);
    }
}
