//! First positions of bodies, and the range of motion that their geometry allows, against closed forms.

use crate::support::program;
use eng::{Sources, Start};
use std::path::Path;

/// A crank on two films, a rod on films at both ends, a piston in its bore; nothing is stated but the crank's angle.
fn engine(crank: &str, analyses: &str) -> String {
    format!(
        "use std.joints.{{Revolute, PointOnPlane, Translational}}
         use std.journals.Impedance
         model Engine {{
            gravity = [-9.81, 0, 0] m/s^2
            marker shell[j in 1..2] = [0, 0, 100*(j - 1.5)] mm
            marker bore = at([0, 0, 0] mm, z: [cos(30 deg), sin(30 deg), 0])
            body crank {{
                mass = 4 kg; inertia = [20, 20, 4] g*m^2
                marker main[j in 1..2] = [0, 0, 100*(j - 1.5)] mm
                marker pin = [43, 0, 0] mm
                {crank}
            }}
            // between films it may turn about its shank
            body rod {{ accept loose; mass = 0.6 kg; inertia = [0.1, 3, 3] g*m^2; marker big = [-41, 0, 0] mm; marker small = [102, 0, 0] mm }}
            body piston {{ mass = 0.4 kg; inertia = [1, 1, 1] g*m^2; marker pin = origin; marker crown = at(origin, z: [1, 0, 0]) }}
            journal main[j in 1..2] = Impedance(pin: crank.main[j], shell: shell[j],
                diameter: 54 mm, width: 20 mm, radial_clearance: 27 um, viscosity: 9 mPa*s)
            joint thrust = PointOnPlane(crank.main[1], shell[1])
            journal big_end = Impedance(pin: crank.pin, shell: rod.big,
                diameter: 48 mm, width: 20 mm, radial_clearance: 25 um, viscosity: 9 mPa*s)
            joint side = PointOnPlane(rod.big, crank.pin)
            journal wrist = Impedance(pin: piston.pin, shell: rod.small,
                diameter: 22 mm, width: 20 mm, radial_clearance: 10 um, viscosity: 9 mPa*s)
            joint liner = Translational(piston.crown, bore) {{ branch travel > 0 mm }}
            start rotation(crank.main[1], shell[1]) = 75 deg
            cycle angle = rotation(crank.main[1], shell[1]) {{ period = 360 deg }}
            output reach = dot(piston.pin.origin, bore.z) as mm
            output along = dot(bore.y, ground.z)
            output across = dot(bore.x, ground.x)
         }}
         {analyses}"
    )
}

const TURNING: &str = "start angular_velocity = [0, 0, 200] rad/s";

#[test]
fn pins_begin_in_the_middle_of_their_shells() {
    let model = program(&engine(TURNING, ""))
        .model("Engine")
        .expect("a model");
    let mut simulation = model
        .simulation()
        .start_from(Start::Assembled)
        .start()
        .unwrap_or_else(|e| panic!("{e}"));
    let eccentricities = simulation.runtime().eccentricities();
    assert_eq!(eccentricities.len(), 4);
    for [x, y] in eccentricities {
        assert!(x.hypot(y) < 1e-9, "{x} {y}");
    }
    // slider-crank: throw 43, rod 143 mm, the crank 45° from the bore
    let (throw, rod) = (43.0, 143.0);
    let angle = 45f64.to_radians();
    let reach = throw * angle.cos() + (rod * rod - (throw * angle.sin()).powi(2)).sqrt();
    let channel = model.channel("reach").expect("an output");
    let found = 1e3 * simulation.value(channel).expect("a value");
    assert!((found - reach).abs() < 1e-6, "{found} {reach}");
}

#[test]
fn a_guess_comes_before_the_wish() {
    let guess = format!("{TURNING}; guess position = [12, 0, 0] um");
    let model = program(&engine(&guess, ""))
        .model("Engine")
        .expect("a model");
    let mut simulation = model
        .simulation()
        .start_from(Start::Assembled)
        .start()
        .unwrap_or_else(|e| panic!("{e}"));
    let eccentricities = simulation.runtime().eccentricities();
    for [x, y] in &eccentricities[..2] {
        assert!((x - 12e-6).abs() < 1e-10 && y.abs() < 1e-10, "{x} {y}");
    }
    for [x, y] in &eccentricities[2..] {
        assert!(x.hypot(*y) < 1e-9, "{x} {y}");
    }
}

/// With z alone: y nearest to the body's z, x = y × z.
#[test]
fn the_axes_of_a_bore_turn_with_its_bank() {
    let model = program(&engine(TURNING, ""))
        .model("Engine")
        .expect("a model");
    let mut simulation = model
        .simulation()
        .start_from(Start::Assembled)
        .start()
        .unwrap_or_else(|e| panic!("{e}"));
    let mut value = |name: &str| {
        let channel = model.channel(name).expect("an output");
        simulation.value(channel).expect("a value")
    };
    assert!((value("along") - 1.0).abs() < 1e-12);
    assert!((value("across") + 0.5).abs() < 1e-12);
}

/// Conditions count in the state in which a run begins: a stated position outside of the clearance is refused. A guess
/// there is only the first value, so the films put the pins into the middle.
#[test]
fn a_guess_outside_of_the_clearance_is_left() {
    let analyses = "analysis run = transient(Engine(), duration: 6 deg, sample: 1 deg)
         analysis assembled = transient(Engine(), duration: 6 deg, sample: 1 deg, start: assembled)";
    let of = |place: &str| {
        let body = format!("{TURNING}; {place} position = [40, 0, 0] um");
        program(&engine(&body, analyses))
    };
    let stated = of("start").assemble().expect("assembled");
    let codes: Vec<&str> = stated.diagnostics.iter().map(|d| d.code).collect();
    assert_eq!(codes, ["E0711"], "the start that the text asks for");
    let program = of("guess");
    let found = program.assemble().expect("assembled");
    let errors = found.diagnostics.iter().filter(|d| d.is_error());
    let codes: Vec<&str> = errors.map(|d| d.code).collect();
    assert!(codes.is_empty(), "{codes:?}");
    let model = program.model("Engine").expect("a model");
    let begun = model.simulation().start_from(Start::Assembled).start();
    let mut begun = begun.unwrap_or_else(|e| panic!("{e}"));
    for [x, y] in begun.runtime().eccentricities() {
        assert!(x.hypot(y) < 1e-9, "{x} {y}");
    }
    for name in ["run", "assembled"] {
        let analysis = program.analysis(name).expect("an analysis");
        eng::run::run(&analysis, false, &mut |_| {}).expect("a run");
    }
}

/// A guess of the rod far from its film, at every angle of the crank: the rod goes where a joint would put it.
#[test]
fn a_rough_guess_closes_a_loop_of_films() {
    for angle in (0..360).step_by(15) {
        let text = engine(TURNING, "")
            .replace(
                "accept loose;",
                "accept loose; guess position = [40, 30, 0] mm;",
            )
            .replace("= 75 deg", &format!("= {angle} deg"));
        let model = program(&text).model("Engine").expect("a model");
        let begun = model.simulation().start_from(Start::Assembled).start();
        let mut begun = begun.unwrap_or_else(|e| panic!("{angle}: {e}"));
        for [x, y] in begun.runtime().eccentricities() {
            assert!(x.hypot(y) < 1e-9, "{angle}: {x} {y}");
        }
    }
}

/// A rod shorter than the throw locks at sin θ = rod/throw; a rod that is long enough turns fully.
#[test]
fn a_dry_turn_finds_where_a_crank_locks() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics/run");
    let text = std::fs::read_to_string(folder.join("locked.eng")).expect("a fixture");
    let turned = |text: &str| {
        let analysis = program(text).analysis("run").expect("an analysis");
        analysis.dry_turn().unwrap_or_else(|e| panic!("{e}"))
    };
    let told = turned(&text).expect("it locks");
    let (_, angle) = told.title.split_once('(').expect("an angle");
    let (angle, _) = angle.split_once(" °CA").expect("an angle");
    let angle: f64 = angle.parse().expect("a number");
    let lock = (40.0f64 / 43.0).asin().to_degrees();
    assert!(angle <= lock && lock - angle < 0.5, "{angle} {lock}");
    let long = text.replace("rod_length: Length = 40 mm", "rod_length: Length = 140 mm");
    assert_eq!(turned(&long), None);
}

/// The angles of two wheels count their own turns: a shaft at twice the speed does not lock where it has made
/// half a turn.
#[test]
fn a_dry_turn_follows_a_gear() {
    let text = "use std.joints.Revolute
         use std.drives.PrescribedRotation
         joint Gear(a: Marker, a_ref: Marker, b: Marker, b_ref: Marker, ratio: 1) {
            constrain rotation(a, a_ref) == ratio*rotation(b, b_ref)
         }
         model Geared {
            gravity = [0, 0, 0] m/s^2
            marker wall = [0, 0, 0] mm
            marker beside = [100, 0, 0] mm
            body crank { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
            body shaft { mass = 1 kg; inertia = [1, 1, 1] g*m^2; start position = [100, 0, 0] mm }
            joint main = Revolute(crank.origin, wall)
            joint side = Revolute(shaft.origin, beside)
            joint gear = Gear(shaft.origin, beside, crank.origin, wall, ratio: -2)
            drive turn = PrescribedRotation(crank.origin, wall, speed: 3000 rpm)
            cycle angle = rotation(crank.origin, wall) { period = 720 deg }
         }
         analysis run = transient(Geared(), duration: 2 rev, sample: 1 deg)";
    let analysis = program(text).analysis("run").expect("an analysis");
    assert_eq!(analysis.dry_turn().unwrap_or_else(|e| panic!("{e}")), None);
}

/// A crank at rest is refused only where nothing will turn it: the torque of this one begins at zero.
#[test]
fn a_duration_in_turns_may_begin_at_rest() {
    let text = |torque: &str| {
        format!(
            "use std.joints.Revolute
             use std.forces.Motor
             fn ramp(t: Time) -> Torque = {torque}
             model Wheel {{
                gravity = [0, 0, 0] m/s^2
                marker wall = [0, 0, 0] m
                body wheel {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin }}
                joint pin = Revolute(wheel.hub, wall)
                force motor = Motor(wheel.hub, wall, torque_at: ramp)
                cycle angle = rotation(wheel.hub, wall) {{ period = 360 deg }}
             }}
             analysis run = transient(Wheel(), duration: 10 deg, sample: 1 deg)"
        )
    };
    let run = |torque: &str| {
        let analysis = program(&text(torque)).analysis("run").expect("an analysis");
        analysis
            .run(&mut |_| {})
            .map_err(|failed| failed.error.to_string())
    };
    // φ = (dM/dt) t³/(6 J) = 10° at t³ = 6 · 1e-3 · (π/18)/1e-3
    let outcome = run("1e-3 N*m/s * t").expect("it turns");
    let time = outcome.summary.expect("a run").time;
    let closed = (6.0 * 10f64.to_radians()).cbrt();
    assert!((time - closed).abs() < 1e-4 * closed, "{time} {closed}");
    let refused = run("0 N*m/s * t").expect_err("nothing turns it");
    assert!(refused.contains("the cycle does not turn"), "{refused}");
}

/// A pendulum of 400 mm held at 30°: its pivot, and its bob at 400 mm (sin 30°, −cos 30°).
#[test]
fn a_check_lists_the_assembled_positions() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mistakes/bases/swing.eng");
    let text = std::fs::read_to_string(file).expect("a file");
    let found = program(&text).positions().expect("positions");
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].analyses, ["swing"]);
    let place = |marker: &str| {
        let placed = found[0].markers.iter().find(|m| m.marker == marker);
        placed
            .map(|m| (m.body.clone(), m.position))
            .expect("a marker")
    };
    let angle = 30f64.to_radians();
    for (marker, body, wanted) in [
        ("pivot", "ground", [0.0; 3]),
        ("bob.top", "bob", [0.0; 3]),
        (
            "bob.origin",
            "bob",
            [0.4 * angle.sin(), -0.4 * angle.cos(), 0.0],
        ),
    ] {
        let (of, position) = place(marker);
        assert_eq!(of, body);
        for i in 0..3 {
            assert!(
                (position[i] - wanted[i]).abs() < 1e-12,
                "{marker}: {position:?}"
            );
        }
    }
}

/// A rotor whose bearings leave the tilt of its axis free, or hold it by films or springs, on shells along `axis`.
/// Only the drive states its position: the x axis of the shells is at the angle `shell`, and the rotor at `initial`
/// from there.
fn rotor(bearings: &str, axis: [&str; 3], body: &str) -> String {
    let [z, x, y] = axis;
    format!(
        "use std.joints.{{PointOnPlane, Spherical}}
         use std.drives.PrescribedRotation
         use std.forces.Bushing
         use std.journals.Impedance
         force Pad(a: Marker, b: Marker, k: Stiffness) {{
            let e = local(a.origin - b.origin, b)
            apply force vector([-k*e.x, -k*e.y, 0 N], b) on a against b
         }}
         model Rotor {{
            param shell: Angle = 0 deg
            param initial: Angle = 0 deg
            gravity = [0, 0, 0] m/s^2
            marker first = at(-(150 mm)*{z}, z: {z}, x: cos(shell)*{x} + sin(shell)*{y})
            marker second = at((250 mm)*{z}, z: {z}, x: cos(shell)*{x} + sin(shell)*{y})
            body rotor {{ accept loose; mass = 20 kg; inertia = [0.5, 0.5, 0.3] kg*m^2
                marker a = [0, 0, -150] mm; marker b = [0, 0, 250] mm
                start angular_velocity = (3000 rpm)*{z}
                {body} }}
            {bearings}
            drive turn = PrescribedRotation(rotor.a, first, speed: 3000 rpm, initial: initial)
            output along = dot(rotor.origin.z, second.z)
            output end = dot(rotor.b.origin, second.z) as mm
            output turned = rotation(rotor.a, first) as deg
         }}"
    )
}

const BEARINGS: [(&str, &str); 4] = [
    (
        "pads",
        "joint thrust = PointOnPlane(rotor.a, first)
         force one = Pad(rotor.a, first, k: 1e7 N/m)
         force two = Pad(rotor.b, second, k: 1e7 N/m)",
    ),
    (
        "a ball joint",
        "joint ball = Spherical(rotor.a, first)
         force two = Pad(rotor.b, second, k: 1e7 N/m)",
    ),
    (
        "bushings",
        "joint thrust = PointOnPlane(rotor.a, first)
         force one = Bushing(rotor.a, first, stiffness: [1e6, 1e6, 1e6] N/m, damping: [1, 1, 1] kN*s/m,
            torsional_stiffness: [0, 0, 0] N*m/rad, torsional_damping: [0, 0, 0] N*m*s/rad)
         force two = Bushing(rotor.b, second, stiffness: [1e6, 1e6, 1e6] N/m, damping: [1, 1, 1] kN*s/m,
            torsional_stiffness: [0, 0, 0] N*m/rad, torsional_damping: [0, 0, 0] N*m*s/rad)",
    ),
    (
        "films",
        "joint thrust = PointOnPlane(rotor.a, first)
         journal one = Impedance(rotor.a, first, diameter: 60 mm, width: 25 mm, radial_clearance: 25 um, viscosity: 10 mPa*s)
         journal two = Impedance(rotor.b, second, diameter: 60 mm, width: 25 mm, radial_clearance: 25 um, viscosity: 10 mPa*s)",
    ),
];

/// `along` and `end` of a rotor that is turned by `initial` in shells turned by `shell` (°).
fn begins(model: &eng::Model, shell: f64, initial: f64) -> [f64; 3] {
    let mut simulation = model.simulation().start_from(Start::Assembled);
    for (name, angle) in [("shell", shell), ("initial", initial)] {
        let parameter = model.parameter(name).expect("a parameter");
        simulation = simulation
            .set(parameter, eng::Quantity::degrees(angle))
            .expect("an angle");
    }
    let mut simulation = simulation
        .start()
        .unwrap_or_else(|e| panic!("{shell}° {initial}°: {e}"));
    ["along", "end", "turned"].map(|name| {
        let channel = model.channel(name).expect("an output");
        simulation.value(channel).expect("a value")
    })
}

/// A rotor that lies across or upside down also solves the equation of a drive; the assembly must find the turn about
/// its axis. The stated velocities agree with those of the drive at every angle, although two of their rows are
/// equal.
#[test]
fn a_drive_turns_a_rotor_about_its_axis_from_every_angle() {
    let along_z = ["[0, 0, 1]", "[1, 0, 0]", "[0, 1, 0]"];
    let along_x = ["[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"];
    let guess = "guess rotation = [0, 0, 60] deg";
    for (name, bearings) in BEARINGS {
        for (axis, body) in [(along_z, ""), (along_x, ""), (along_z, guess)] {
            let model = program(&rotor(bearings, axis, body))
                .model("Rotor")
                .expect("a model");
            for step in 0..24 {
                let angle = 15.0 * f64::from(step);
                for [shell, initial] in [[0.0, angle], [angle, 0.0], [angle, 100.0]] {
                    let [along, end, turned] = begins(&model, shell, initial);
                    let place = format!("{name} {axis:?} {body}, {shell}° {initial}°");
                    assert!((along - 1.0).abs() < 1e-9, "{place}: {along}");
                    assert!((end - 0.25).abs() < 1e-9, "{place}: {end}");
                    let off = turned - initial.to_radians();
                    assert!(
                        off.sin().abs() < 1e-9 && off.cos() > 0.0,
                        "{place}: {turned}"
                    );
                }
            }
        }
    }
}

/// The output of `eng check` for a text.
fn told(text: &str) -> String {
    let checked = eng::check(&Sources::from_text("model.eng", text), "model.eng");
    let program = checked.program().expect("a sound text");
    let assembled = program.assemble().expect("a sound text");
    let diagnostics = assembled.diagnostics;
    let report = checked.report();
    let texts = report.texts();
    eng::render::human(&diagnostics, texts, eng::render::Colors::None)
}

/// A space four-bar linkage: a rod between a ball and a cardan joint.
fn linkage(rod: &str, place: &str) -> String {
    format!(
        "use std.joints.{{Revolute, Spherical, Universal}}
         use std.drives.ConstantSpeed
         model Linkage {{
            gravity = [0, 0, -9.81] m/s^2
            marker o1 = at([0, 0, 0] mm, z: [0.2, 0.1, 1], x: [1, 0, 0])
            marker o2 = at({place} mm, z: [0, 1, 1], x: [1, 0, 0])
            body crank {{ mass = 1.2 kg; inertia = [2, 3, 4] g*m^2; marker p = [60, 0, 0] mm }}
            body rod {{ mass = 0.8 kg; inertia = [0.3, 4, 4] g*m^2; marker a = origin
                marker b = at([{rod}] mm, z: [1, 0, 0], x: [0, 0, 1])
                guess position = [60, 0, 0] mm }}
            body rocker {{ mass = 1.5 kg; inertia = [3, 2, 3] g*m^2; marker h = at(origin, z: [0, 1, 1], x: [1, 0, 0])
                marker c = at([0, 120, -30] mm, z: [1, 0, 0], x: [0, 0, -1]) }}
            drive turn = ConstantSpeed(crank.origin, o1, speed: 1500 rpm)
            joint ball = Spherical(rod.a, crank.p)
            joint cardan = Universal(rod.b, rocker.c)
            joint hinge = Revolute(rocker.h, o2)
         }}
         analysis run = transient(Linkage(), duration: 1 ms, sample: 1 ms)"
    )
}

/// A rod that may tilt is as long as its joints are apart in space, and the message about an open loop names the
/// guesses.
#[test]
fn an_open_loop_names_its_lengths_and_guesses() {
    let open = told(&linkage("280, 0, 0", "[3000, 20, 40]"));
    assert!(
        open.contains("E0703") && open.contains("rod 280 mm"),
        "{open}"
    );
    assert!(
        open.contains("a guess of rod: the search begins here"),
        "{open}"
    );
}

/// A loop of hinges with one length that all others together do not reach: the remedy says which, and by how much. With lengths that
/// reach, the message does not say it.
#[test]
fn a_loop_that_no_position_closes_names_the_lengths_that_do_not_meet() {
    let text = |coupler: &str, more: &str| {
        format!(
            "use std.joints.{{PointOnLine, Revolute}}
             model FourBar {{
                gravity = [0, -9.81, 0] m/s^2
                marker left = [0, 0, 0] mm
                marker right = [300, 0, 0] mm
                body crank {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker main = origin; marker pin = [40, 0, 0] mm }}
                body coupler {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker near = origin; marker far = [{coupler}, 0, 0] mm }}
                body rocker {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin; marker pin = [0, 90, 0] mm }}
                joint main = Revolute(crank.main, left)
                joint big = Revolute(coupler.near, crank.pin)
                joint small = {more}(coupler.far, rocker.pin)
                joint pivot = Revolute(rocker.eye, right)
             }}
             analysis run = transient(FourBar(), duration: 1 ms, sample: 1 ms)"
        )
    };
    let open = told(&text("120", "PointOnLine"));
    assert!(open.contains("E0703"), "{open}");
    assert!(!open.contains("no position closes"), "{open}");
    let open = told(&text("120", "Revolute"));
    let remedy = "no position closes this loop: the joints of the ground are 300 mm apart, and coupler, rocker and crank together reach 250 mm. Change lengths by 50 mm or more";
    assert!(open.contains("E0703") && open.contains(remedy), "{open}");
    let open = told(&text("900", "Revolute"));
    assert!(
        open.contains("the joints of coupler are 900 mm apart"),
        "{open}"
    );
}

/// A body between two stops on plungers that both retreat: the stops that decide its motion at the start open, and the machine still
/// turns. Its check told a lock of the crank.
#[test]
fn stops_that_open_lock_no_machine() {
    let side = |name: &str, sign: &str| {
        format!(
            "body crank{name} {{ mass = 2 kg; inertia = [2, 2, 2] g*m^2; marker main = origin; marker pin = [{sign}20, 0, 0] mm }}
             body rod{name} {{ mass = 0.4 kg; inertia = [0.1, 1, 1] g*m^2; center_of_mass = [{sign}40, 0, 0] mm; marker big = origin
                marker small = [{sign}120, 0, 0] mm }}
             body plunger{name} {{ mass = 0.5 kg; inertia = [1, 1, 1] g*m^2; marker pin = origin
                marker crown = at(origin, z: [{sign}1, 0, 0]); marker face = at([{sign}50.1, 0, 0] mm, z: [{sign}1, 0, 0]) }}
             marker axis{name} = [-({sign}200), 0, 0] mm
             marker bore{name} = at([-({sign}200), 0, 0] mm, z: [{sign}1, 0, 0])
             joint main{name} = Revolute(crank{name}.main, axis{name})
             drive turn{name} = PrescribedRotation(crank{name}.main, axis{name}, speed: 1500 rpm)
             joint big_end{name} = Revolute(rod{name}.big, crank{name}.pin)
             joint wrist{name} = PointOnLine(rod{name}.small, plunger{name}.pin)
             joint liner{name} = Translational(plunger{name}.crown, bore{name}) {{ branch travel > 0 mm }}
             force stop{name} = EndStop(loose.of{name}, plunger{name}.face, stiffness: 100 N/mm, damping: 100 N*s/m)"
        )
    };
    let text = format!(
        "use std.joints.{{Revolute, PointOnLine, Translational}}
         use std.drives.PrescribedRotation
         use std.contacts.EndStop
         model Pair {{
            gravity = [0, 0, 0] m/s^2
            marker middle = at([0, 0, 0] mm, z: [1, 0, 0])
            body loose {{ mass = 0.2 kg; inertia = [1, 1, 1] g*m^2; marker way = at(origin, z: [1, 0, 0])
                marker of_a = [-10, 0, 0] mm; marker of_b = [10, 0, 0] mm; guess position = [0, 0, 0] mm }}
            joint guide = Translational(loose.way, middle)
            {}
            {}
            cycle angle = rotation(crank_a.main, axis_a) {{ period = 360 deg }}
         }}
         analysis run = transient(Pair(), duration: 1 ms, sample: 1 ms)",
        side("_a", ""),
        side("_b", "-")
    );
    let said = told(&text);
    assert!(!said.contains("W0761"), "{said}");
}

/// Lengths whose squares are no numbers are refused before anything is computed with them.
#[test]
fn a_number_without_a_square_is_refused() {
    let far = told(&linkage("1e308, 0, 0", "[300, 20, 40]"));
    assert!(
        far.contains("E0721") && far.contains("1e305 in SI units"),
        "{far}"
    );
    assert!(!far.contains("inf"), "{far}");
}

/// A drive and a start state different angles of two bodies that are bolted together. The message names both, and no
/// joint between them; it named the bolts or the turn of the drive, whose equations hold half a turn away, too.
#[test]
fn a_start_that_contradicts_a_drive_is_named_with_it() {
    let text = |start: &str| {
        format!(
            "use std.joints.{{Fixed, Revolute}}
             use std.drives.PrescribedRotation
             model Shaft {{
                gravity = [0, 0, 0] m/s^2
                marker stand = [0, 0, 0] mm
                body crank {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker main = origin; marker flange = [0, 0, 100] mm }}
                body wheel {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin }}
                joint main = Revolute(crank.main, stand)
                joint bolts = Fixed(wheel.hub, crank.flange)
                drive turn = PrescribedRotation(wheel.hub, stand, speed: 1000 rpm)
                {start}
             }}
             analysis run = transient(Shaft(), duration: 1 ms, sample: 1 ms)"
        )
    };
    for angle in ["30", "90", "180", "200"] {
        let said = told(&text(&format!("start main.angle = {angle} deg")));
        assert!(said.contains("E0703"), "{angle}: {said}");
        let named = "start of main.angle and turn contradict each other";
        let other = "turn and start of main.angle contradict each other";
        assert!(said.contains(named) || said.contains(other), "{said}");
        assert!(!said.contains("bolts:"), "{angle}: {said}");
        assert!(
            said.contains("state it as `initial:` of the drive"),
            "{said}"
        );
    }
    let twice = told(&text(
        "start rotation(wheel.hub, stand) = 0 deg; start rotation(crank.flange, stand) = 40 deg",
    ));
    assert!(twice.contains("contradict each other"), "{twice}");
    assert_eq!(
        told(&text("start main.angle = 0 deg")),
        "",
        "the drive begins there"
    );
}
