//! `static` analyses: equilibria against closed forms and against the motion that has settled; models without
//! one are refused.

use crate::support::{outcome as run, program, program_of, slender_beam};
use eng::{Failed, Outcome, Sources, StartReport};
use eng_runtime::start::Equilibrium;
use std::fmt::Write;

/// The last value of a channel (SI).
fn value(outcome: &Outcome, path: &str) -> f64 {
    let column = outcome.results.column(path);
    let column = column.unwrap_or_else(|| panic!("no channel {path}"));
    *column.values.last().expect("a row")
}

fn found(outcome: &Outcome) -> &Equilibrium {
    match &outcome.start {
        Some(StartReport::Equilibrium(found)) => found,
        other => panic!("{other:?}"),
    }
}

/// The code and the title of the message with which an analysis is refused.
fn refused(text: &str, analysis: &str) -> (&'static str, String) {
    let program = program(text);
    let analysis = program.analysis(analysis).expect("an analysis");
    let Err(Failed { error, .. }) = analysis.run(&mut |_| {}) else {
        panic!("an equilibrium was found");
    };
    let report = error.report().unwrap_or_else(|| panic!("{error}"));
    let message = report.diagnostics().iter().next().expect("a message");
    (message.code, message.title.clone())
}

#[track_caller]
fn near(found: f64, wanted: f64, share: f64) {
    assert!(
        (found - wanted).abs() <= share * wanted.abs(),
        "{found:e}, not {wanted:e}"
    );
}

const GRAVITY: f64 = 9.81;

/// A mass on a spring: x = L + m g/k, and the spring pulls with m g. The points of a sweep are independent.
#[test]
fn a_mass_hangs_on_its_spring() {
    let program = program(
        "use std.forces.LinearSpring
         use std.joints.Translational
         model Hanging {
             param m: Mass = 2 kg in (0.1 kg, 100 kg)
             gravity = [0, -9.81, 0] m/s^2
             marker top = at([0, 0, 0] mm, z: [0, 1, 0])
             body bob { mass = m; inertia = [2, 2, 2] g*m^2; marker eye = at(origin, z: [0, 1, 0]); start position = [0, -100, 0] mm }
             joint guide = Translational(bob.eye, top)
             force spring = LinearSpring(bob.eye, top, stiffness: 4 N/mm, damping: 80 N*s/m, free_length: 100 mm)
             output height = dot(bob.origin.origin, ground.y) as mm
         }
         analysis rest = static(Hanging())
         analysis sweep[x in 1 kg .. 3 kg by 1 kg] = static(Hanging(m: x))
         analysis settle = transient(Hanging(), duration: 3 s, sample: 0.1 s)",
    );
    for (name, mass) in [("rest", 2.0), ("sweep[1]", 1.0), ("sweep[3]", 3.0)] {
        let outcome = run(&program, name);
        assert_eq!(outcome.results.samples(), 1);
        near(
            value(&outcome, "height"),
            -0.1 - mass * GRAVITY / 4000.0,
            1e-9,
        );
        near(value(&outcome, "spring.tension"), mass * GRAVITY, 1e-9);
        assert_eq!(found(&outcome).freedoms, 1);
        assert_eq!(value(&outcome, "energy.kinetic"), 0.0);
    }
    let settled = run(&program, "settle");
    near(
        value(&run(&program, "rest"), "height"),
        value(&settled, "height"),
        1e-8,
    );
}

const SWING: &str = "use std.joints.Revolute
    model Swing {
        param begin: Angle = 30 deg
        gravity = [0, -9.81, 0] m/s^2
        marker pivot = [0, 0, 0] mm
        body bob { mass = 1.2 kg; inertia = [2, 2, 2] g*m^2; marker top = [0, 0.4, 0] m }
        joint pin = Revolute(bob.top, pivot)
        start pin.angle = begin
        output height = dot(bob.origin.origin, ground.y) as mm
    }
    analysis hang[a in [0, 30, 90, 175, 500] deg] = static(Swing(begin: a))
    analysis upright = static(Swing(begin: 180 deg))";

/// The search begins at the position that `start` states. A pendulum hangs down from every beginning, also from a
/// position without stiffness, and keeps its turns. One that begins upside down stays, with a warning.
#[test]
fn a_pendulum_hangs_wherever_it_begins() {
    let program = program(SWING);
    for (point, turns) in [(1, 0.0), (2, 0.0), (3, 0.0), (4, 0.0), (5, 1.0)] {
        let outcome = run(&program, &format!("hang[{point}]"));
        near(value(&outcome, "height"), -0.4, 1e-12);
        let angle = value(&outcome, "pin.angle") - turns * std::f64::consts::TAU;
        assert!(angle.abs() < 1e-9, "{angle}");
        near(value(&outcome, "pin.force.y"), 1.2 * GRAVITY, 1e-10);
        assert!(found(&outcome).unstable.is_none() && found(&outcome).held.is_empty());
    }
    let outcome = run(&program, "upright");
    near(value(&outcome, "height"), 0.4, 1e-12);
    assert!(found(&outcome).unstable.is_some());
}

// A slender beam: 1 m, 20 elements.
const YOUNG: f64 = 210e9;
const DENSITY: f64 = 7850.0;
const SIDE: f64 = 0.01;

/// A cantilever bends by q L⁴/(8EI) under its own weight and by F L³/(3EI) under a force at its tip; the wall
/// carries both.
#[test]
fn a_cantilever_bends_under_its_weight() {
    let text = "use std.joints.Fixed
        force Push(a: Marker, b: Marker, load: Force) { apply force -load*b.y on a }
        model Held {
            param load: Force = 0 N
            param weight: Acceleration = 9.81 m/s^2
            gravity = [0, -1, 0]*weight
            marker wall = [0, 0, 0] mm
            flexible beam {
                mesh = nastran(\"m.bdf\", units: m_kg_s)
                modes = static(at: [root, tip]) + normal(8, fixed: root)
                damping = 40 %
                marker root = node(1)
                marker tip = node(21)
            }
            joint clamp = Fixed(beam.root, wall)
            force push = Push(beam.tip, wall, load: load)
            output across: Length = dot(beam.tip.origin - wall.origin, wall.y)
        }
        analysis own = static(Held())
        analysis pushed = static(Held(load: 2 N, weight: 0 m/s^2))
        analysis settle = transient(Held(), duration: 12 s, sample: 1 s, start: assembled)";
    let deck = slender_beam(SIDE, YOUNG, DENSITY);
    let program = program_of(&[("m.eng", text), ("m.bdf", &deck)]);
    let bending = YOUNG * SIDE.powi(4) / 12.0;
    let weight = DENSITY * SIDE * SIDE * GRAVITY;
    let own = run(&program, "own");
    near(value(&own, "across"), -weight / (8.0 * bending), 2e-3);
    near(value(&own, "clamp.force.y"), weight, 1e-9);
    near(value(&own, "clamp.torque.z"), 0.5 * weight, 2e-3);
    let settled = value(&run(&program, "settle"), "across");
    near(value(&own, "across"), settled, 1e-7);
    near(
        value(&run(&program, "pushed"), "across"),
        -2.0 / (3.0 * bending),
        1e-3,
    );
}

/// A slider-crank under a constant force P on its piston; crank radius r, rod l.
fn slider_crank(hold: &str, analyses: &str) -> String {
    format!(
        "use std.joints.{{Revolute, PointOnLine, Translational}}
         use std.drives.{{ConstantSpeed, PrescribedRotation}}
         force Push(a: Marker, b: Marker) {{ apply force -900 N*b.z on a against b }}
         model Single {{
             param wanted: Angle = 60 deg
             gravity = [0, 0, 0] m/s^2
             marker axis = [0, 0, 0] mm
             marker bore = at([0, 0, 0] mm, z: [0, 1, 0])
             body crank {{ mass = 8 kg; inertia = [20, 20, 35] g*m^2; marker main = origin; marker pin = [0, 35, 0] mm }}
             body rod {{
                 mass = 0.4 kg; inertia = [1.1, 0.08, 1.1] g*m^2; center_of_mass = [0, 35, 0] mm
                 marker big = origin; marker small = [0, 110, 0] mm
             }}
             body piston {{ mass = 0.35 kg; inertia = [0.2, 0.25, 0.2] g*m^2; marker pin = origin; marker crown = at([0, 25, 0] mm, z: [0, 1, 0]) }}
             joint big_end = Revolute(rod.big, crank.pin)
             joint wrist = PointOnLine(rod.small, piston.pin)
             joint liner = Translational(piston.crown, bore) {{ branch travel > 0 mm }}
             force push = Push(piston.crown, bore)
             {hold}
             cycle angle = rotation(crank.main, axis) {{ period = 720 deg }}
         }}
         {analyses}"
    )
}

/// −P dy/dθ with y = r cos θ + √(l² − r² sin² θ): the torque of the piston's force on the crank.
fn torque(angle: f64) -> f64 {
    let (r, l, push) = (0.035, 0.11, 900.0);
    let (sin, cos) = angle.sin_cos();
    push * (r * sin + r * r * sin * cos / (l * l - r * r * sin * sin).sqrt())
}

/// The torque that holds the crank at an angle, by the virtual work of the piston's force: held by a drive at rest,
/// by one that turns and is at the angle at its time, and by `at` alone, before the angle of the start and after it.
#[test]
fn a_crank_is_held_against_its_piston() {
    let analyses = "analysis here[a in [0, 20, 60, 190, 350] deg] = static(Single(wanted: a))";
    let standing =
        "drive hold = PrescribedRotation(crank.main, axis, speed: 0 rpm, initial: wanted)
         joint main = Revolute(crank.main, axis)";
    let standing = program(&slider_crank(standing, analyses));
    let at = "analysis here[a in [0, 20, 60, 190, 350] deg] = static(Single(), at: a)";
    let turning = "drive hold = ConstantSpeed(crank.main, axis, speed: 2000 rpm, initial: 35 deg)";
    let turning = program(&slider_crank(turning, at));
    let free = "joint main = Revolute(crank.main, axis)
         start main.angle = 35 deg";
    let free = program(&slider_crank(free, at));
    for (point, angle) in [(1, 0.0_f64), (2, 20.0), (3, 60.0), (4, 190.0), (5, 350.0)] {
        let (name, angle) = (format!("here[{point}]"), angle.to_radians());
        let wanted = torque(angle);
        let slack = 1e-8 * 900.0 * 0.035;
        for program in [&standing, &turning] {
            let outcome = run(program, &name);
            let held = value(&outcome, "hold.torque.z");
            assert!((held + wanted).abs() < slack, "{name}: {held} {wanted}");
            let reached = value(&outcome, "cycle.angle");
            assert!((reached - angle).sin().abs() < 1e-9, "{reached}");
            assert!(found(&outcome).held.is_empty());
            assert_eq!(value(&outcome, "cycle.speed"), 0.0);
        }
        let outcome = run(&free, &name);
        let held = found(&outcome).held.first().map_or(0.0, |held| held.effort);
        assert!(
            (held.abs() - wanted.abs()).abs() < slack.max(1e-5),
            "{name}: {held} {wanted}"
        );
        let reached = value(&outcome, "cycle.angle");
        assert!((reached - angle).sin().abs() < 1e-9, "{reached} {angle}");
    }
    // nothing holds it: the piston goes to its lowest
    let free = slider_crank(
        "joint main = Revolute(crank.main, axis)\nstart main.angle = 35 deg",
        "analysis here = static(Single())",
    );
    let outcome = run(&program(&free), "here");
    near(value(&outcome, "cycle.angle"), std::f64::consts::PI, 1e-9);
    near(value(&outcome, "liner.travel"), 0.11 - 0.035 + 0.025, 1e-9);
}

/// An angle that a drive does not reach is refused.
#[test]
fn an_angle_that_a_drive_forbids_is_refused() {
    let hold = "drive hold = PrescribedRotation(crank.main, axis, speed: 0 rpm, initial: 35 deg)
         joint main = Revolute(crank.main, axis)";
    let text = slider_crank(hold, "analysis here = static(Single(), at: 60 deg)");
    let (code, title) = refused(&text, "here");
    assert_eq!(code, "E0701");
    assert!(title.contains("hold it at 35.000°"), "{title}");
}

/// A drive that turns is at the angle of its time; a time before the start is refused.
#[test]
fn a_time_moves_drives() {
    let hold = "drive hold = ConstantSpeed(crank.main, axis, speed: 2000 rpm, initial: 35 deg)";
    let text = slider_crank(hold, "analysis here = static(Single(), at: 20 ms)");
    let outcome = run(&program(&text), "here");
    let angle = (35.0 + 2000.0 * 6.0 * 0.02_f64).to_radians();
    near(value(&outcome, "cycle.angle"), angle, 1e-9);
    assert!((value(&outcome, "hold.torque.z") + torque(angle)).abs() < 1e-6);
    let early = text.replace("at: 20 ms", "at: -20 ms");
    let checked = eng::check(&Sources::from_text("m.eng", early), "m.eng");
    let codes: Vec<&str> = checked
        .report()
        .diagnostics()
        .iter()
        .map(|d| d.code)
        .filter(|code| code.starts_with('E'))
        .collect();
    assert_eq!(codes, ["E0517"], "{}", checked.report());
}

/// A mass falls on a stiff contact from above it: the search follows gravity until it is carried.
#[test]
fn a_mass_comes_to_its_contact() {
    let program = program(
        "use std.joints.Translational
         force Stop(a: Marker, b: Marker) {
             let depth = dot(b.origin - a.origin, b.z)
             let push = if depth > 0 mm then depth*5e5 N/m else 0 N
             apply force push*b.z on a against b
             output load = push as N
         }
         model Falls {
             gravity = [0, 0, -9.81] m/s^2
             marker floor = [0, 0, 0] mm
             body stone { mass = 3 kg; inertia = [2, 2, 2] g*m^2; start position = [0, 0, 40] mm }
             joint guide = Translational(stone.origin, floor)
             force stop = Stop(stone.origin, floor)
             output height = dot(stone.origin.origin, ground.z) as mm
         }
         analysis rest = static(Falls())",
    );
    let outcome = run(&program, "rest");
    near(value(&outcome, "height"), -3.0 * GRAVITY / 5e5, 1e-9);
    near(value(&outcome, "stop.load"), 3.0 * GRAVITY, 1e-9);
}

/// A rotor of a mass of 6 kg in two films.
const ROTOR: &str = "use std.journals.Impedance
    use std.joints.{PointOnPlane}
    use std.drives.PrescribedRotation
    model Rotor {
        gravity = [0, -9.81, 0] m/s^2
        marker shell[j in 1..2] = [0 mm, 0 mm, (j - 1.5)*200 mm]
        body shaft {
            mass = 6 kg
            inertia = [60, 60, 5] g*m^2
            marker pin[j in 1..2] = [0 mm, 0 mm, (j - 1.5)*200 mm]
            start angular_velocity = [0, 0, 1]*(3000 rpm)
        }
        joint thrust = PointOnPlane(shaft.origin, ground)
        journal main[j in 1..2] = Impedance(shaft.pin[j], shell[j], diameter: 40 mm, width: 20 mm, radial_clearance: 25 um, viscosity: 10 mPa*s)
    }
    analysis rest = static(Rotor())
    analysis turning = static(Rotor(), turning: true)
    analysis begins = transient(Rotor(), duration: 1 ms, sample: 1 ms, start: quasi_static)";

/// Films carry no load at rest, so a shaft at rest is refused with the reason. With the stated speed the shaft is where
/// a quasi-static start begins, and both films carry its weight.
#[test]
fn films_carry_a_shaft_that_turns() {
    let (code, title) = refused(ROTOR, "rest");
    assert_eq!(code, "E0744");
    assert!(title.contains("no equilibrium at rest: shaft"), "{title}");
    let program = program(ROTOR);
    let (turning, begins) = (run(&program, "turning"), run(&program, "begins"));
    assert_eq!(found(&turning).journals.len(), 2);
    for path in ["main[1].eccentricity.x", "main[1].eccentricity.y"] {
        let first = begins.results.column(path).expect("a channel").values[0];
        near(value(&turning, path), first, 1e-12);
    }
    near(
        value(&turning, "main[1].force.y").abs(),
        3.0 * GRAVITY,
        1e-6,
    );
}

/// A shaft of 2 kN on one film, held along its axis in one point alone, so its tilt is free. The centre of mass may lie beside
/// the film, and the groove may starve it.
const LONE: &str = "
    use std.journals.{Film, Impedance, JournalLaw, Reynolds, Opening, axial_groove}
    use std.joints.{PointOnPlane, Planar}
    use std.drives.PrescribedRotation
    journal Small = Film(around: 36, across: 8)
    journal Fed = Small(openings: [axial_groove(at: 90 deg, length: 14 mm, width: 8 mm, diameter: 40 mm, pressure: 3 bar)])
    journal Starved = Small(cavitation: mass_conserving,
        openings: [axial_groove(at: 90 deg, length: 12 mm, width: 8 mm, diameter: 40 mm, pressure: 0 bar, content: 0.3)])
    model Lone {
        param beside: Length = 0 mm
        const law: JournalLaw = Fed
        gravity = [0, -9.81, 0] m/s^2
        accept inertia, loose
        body shaft {
            mass = 200 kg
            inertia = [1, 1, 1]*(0.8 kg*m^2)
            center_of_mass = [0, 0, 1]*beside
            marker mid = origin
            start angular_velocity = [0, 0, 300] rad/s
        }
        joint thrust = PointOnPlane(shaft.mid, ground)
        drive turn = PrescribedRotation(shaft.mid, ground, speed: 300 rad/s)
        journal film = law(shaft.mid, ground, diameter: 40 mm, width: 20 mm, radial_clearance: 20 um, viscosity: 10 mPa*s)
    }";

/// A shaft on one film with a free tilt is found in balance, and a motion that begins there stays there: fed by a groove, with
/// the mass beside the film, starved, and under laws that do not see the tilt. Before, the searches began at the centre alone,
/// where the cavity of a film is undecided.
#[test]
fn one_film_balances_a_shaft_with_a_free_tilt() {
    let text = format!(
        "{LONE}
        {}",
        [
            ("fed", "law: Fed"),
            ("beside", "law: Small, beside: 1 mm"),
            ("starved", "law: Starved"),
            ("table", "law: Reynolds"),
            ("impedance", "law: Impedance"),
        ]
        .iter()
        .fold(String::new(), |mut all, (name, law)| {
            let _ = writeln!(
                all,
                "analysis {name} = static(Lone({law}), turning: true)
                 analysis {name}_moves = transient(Lone({law}), duration: 2 ms, sample: 1 ms, start: quasi_static)"
            );
            all
        })
    );
    let program = program(&text);
    for name in ["fed", "beside", "starved", "table", "impedance"] {
        let (rests, moves) = (run(&program, name), run(&program, &format!("{name}_moves")));
        assert_eq!(found(&rests).journals.len(), 1, "{name}");
        near(value(&rests, "film.radial_load"), 200.0 * GRAVITY, 1e-6);
        for path in ["film.eccentricity.x", "film.eccentricity.y"] {
            let (rest, moved) = (value(&rests, path), value(&moves, path));
            assert!((rest - moved).abs() < 2e-9, "{name} {path}: {rest} {moved}");
        }
    }
    // the mass is held by the moment of the pressure, in the sense that lowers the end below it
    let beside = run(&program, "beside");
    near(
        value(&beside, "film.moment.x").abs(),
        200.0 * GRAVITY * 1e-3,
        1e-3,
    );
}

/// A search that begins with a closed gap, and finds nothing, says so.
#[test]
fn a_search_that_begins_with_a_closed_gap_says_so() {
    let text = "use std.journals.Film
        use std.joints.Planar
        use std.drives.PrescribedRotation
        model Gap {
            gravity = [0, -9.81, 0] m/s^2
            accept inertia
            marker beside = [100, 0, 0] um
            body shaft { mass = 200 kg; inertia = [1, 1, 1]*(0.8 kg*m^2); marker mid = origin; start angular_velocity = [0, 0, 300] rad/s }
            joint thrust = Planar(shaft.mid, ground)
            drive turn = PrescribedRotation(shaft.mid, ground, speed: 300 rad/s)
            journal film = Film(shaft.mid, beside, diameter: 40 mm, width: 20 mm, radial_clearance: 20 um, viscosity: 10 mPa*s)
        }
        analysis gap = static(Gap(), turning: true)";
    let (code, title) = refused(text, "gap");
    assert_eq!(code, "E0744");
    assert!(title.contains("begins with a gap below zero"), "{title}");
}

/// A model without an equilibrium is refused. The message names the body or element that moves on.
#[test]
fn what_runs_away_is_refused() {
    let falls = "model Falls { gravity = [0, 0, -9.81] m/s^2
        body stone { mass = 1 kg; inertia = [1, 1, 1] g*m^2 } }
        analysis rest = static(Falls())";
    let (code, title) = refused(falls, "rest");
    assert_eq!(code, "E0744");
    assert!(
        title.contains("stone") && title.contains("moves freely"),
        "{title}"
    );
    let motor = "use std.joints.Revolute
        force Torque(a: Marker, b: Marker) { apply torque 2 N*m*b.z on a against b }
        model Turns { gravity = [0, 0, 0] m/s^2
        body wheel { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
        marker axis = [0, 0, 0] mm
        joint pin = Revolute(wheel.origin, axis)
        force motor = Torque(wheel.origin, axis) }
        analysis rest = static(Turns())";
    let (code, title) = refused(motor, "rest");
    assert_eq!(code, "E0744");
    assert!(
        title.contains("wheel") && title.contains("turns freely"),
        "{title}"
    );
    let fills = "use std.joints.Fixed
        force Tank(a: Marker, b: Marker) { state p: Pressure = 1 bar
        der(p) = 2 bar/s
        apply force p*1 cm^2*b.z on a against b }
        model Fills { gravity = [0, 0, 0] m/s^2
        body lid { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
        marker seat = [0, 0, 0] mm
        joint hold = Fixed(lid.origin, seat)
        force tank = Tank(lid.origin, seat) }
        analysis rest = static(Fills())";
    let (code, title) = refused(fills, "rest");
    assert_eq!(code, "E0744");
    assert!(
        title.contains("tank") && title.contains("state `p`"),
        "{title}"
    );
}

/// A weight on a mount that creeps: the static stiffness alone holds it. Behind it a chamber empties through a leak, and its
/// pressure follows the place of the body by a cubic.
#[test]
fn states_of_elements_come_to_rest() {
    let program = program(
        "use std.joints.Translational
         force Rubber(a: Marker, b: Marker) {
             state creep: Length = 0 mm scale 0.1 mm
             let x = dot(a.origin - b.origin, b.z)
             der(creep) = (x - creep)/(8 ms)
             apply force (-100 N/mm*x - 300 N/mm*(x - creep))*b.z on a against b }
         force Bellows(a: Marker, b: Marker) {
             state p: Pressure = 3 bar
             let x = dot(a.origin - b.origin, b.z)/(10 mm)
             der(p) = (2 bar + 0.5 bar*x + 0.2 bar*x^3 - p)/(20 ms)
             apply force -p*1 cm^2*b.z on a against b }
         model Mounted { gravity = [0, 0, -9.81] m/s^2
         body unit { mass = 40 kg; inertia = [1, 1, 1] kg*m^2 }
         marker foot = [0, 0, 0] mm
         joint guide = Translational(unit.origin, foot)
         force mount = Rubber(unit.origin, foot)
         force bellows = Bellows(unit.origin, foot)
         start guide.travel = 5 mm }
         analysis rest = static(Mounted())",
    );
    let outcome = run(&program, "rest");
    let place = value(&outcome, "guide.travel");
    let pressure = |x: f64| 2e5 + 0.5e5 * (x / 0.01) + 0.2e5 * (x / 0.01).powi(3);
    let residual = |x: f64| 40.0 * 9.81 + 100e3 * x + 1e-4 * pressure(x);
    let (mut low, mut high) = (-0.02, 0.02);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if residual(middle) > 0.0 {
            high = middle
        } else {
            low = middle
        }
    }
    near(place, low, 1e-9);
}

/// A freedom without stiffness and load stays where it is, and the report counts it.
#[test]
fn an_idle_freedom_stays() {
    let program = program(
        "use std.joints.Revolute
         model Idle { gravity = [0, 0, -9.81] m/s^2
         body wheel { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
         marker axis = [0, 0, 0] mm
         joint pin = Revolute(wheel.origin, axis)
         start pin.angle = 25 deg }
         analysis rest = static(Idle())",
    );
    let outcome = run(&program, "rest");
    assert_eq!((found(&outcome).freedoms, found(&outcome).idle), (0, 1));
    near(value(&outcome, "pin.angle"), 25f64.to_radians(), 1e-12);
    near(value(&outcome, "pin.force.z"), GRAVITY, 1e-10);
    let told = outcome.start.as_ref().expect("a report").to_string();
    assert!(
        told.contains("1 freedom without stiffness or load"),
        "{told}"
    );
}

/// The command prints the values of an equilibrium, writes them, and shows them on the page; a sweep has one column
/// for each output.
#[test]
fn the_command_shows_a_state_as_a_table() {
    let name = format!("eng-equilibrium-{}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    let model = folder.join("swing.eng");
    std::fs::write(&model, SWING).expect("a file");
    let out = folder.join("out");
    let eng = |arguments: &[&str]| {
        let made = std::process::Command::new(env!("CARGO_BIN_EXE_eng"))
            .args(arguments)
            .arg(&model)
            .output()
            .expect("eng runs");
        let text = String::from_utf8_lossy(&made.stdout).into_owned();
        assert!(
            made.status.success(),
            "{text}{}",
            String::from_utf8_lossy(&made.stderr)
        );
        text
    };
    let folder_of_results = out.to_string_lossy().into_owned();
    let told = eng(&["run", "--csv", "--out", &folder_of_results]);
    assert!(told.contains("equilibrium: 1 freedom in balance"), "{told}");
    let line = |wanted: &str| {
        told.lines()
            .any(|l| l.split_whitespace().eq(wanted.split(' ')))
    };
    assert!(line("height 400 mm"), "{told}");
    assert!(line("0 -400") && line("90 -400"), "{told}");
    let rows = std::fs::read_to_string(out.join("upright.csv")).expect("a table");
    assert_eq!(rows.lines().count(), 3, "{rows}");
    let points = std::fs::read_to_string(out.join("hang.csv")).expect("a table");
    assert_eq!(points.lines().next(), Some("a,height"), "{points}");
    // one point is no history
    let pictures = std::fs::read_dir(&out).expect("a folder").flatten();
    let pictures = pictures.filter(|file| file.path().extension().is_some_and(|e| e == "svg"));
    assert_eq!(pictures.count(), 0);
    let page = out.join("page.html").to_string_lossy().into_owned();
    eng(&["report", "--results", &folder_of_results, "--out", &page]);
    let page = std::fs::read_to_string(page).expect("a page");
    assert!(page.contains("State of upright"));
    std::fs::remove_dir_all(folder).expect("an empty place");
}

/// A condition on the motion that fails at the start has its warning in every analysis that shows the start.
#[test]
fn an_assembled_position_has_its_warnings() {
    let program = program(
        "force Near(a: Marker, b: Marker) {
             let d = norm(a.origin - b.origin, floor: 1 um)
             apply force -(1 N/mm)*(a.origin - b.origin) on a against b
             advise near: d < 100 mm else \"{d as mm} apart\"
         }
         model Pair {
             gravity = [0, 0, 0] m/s^2
             marker wall = [0, 0, 0] mm
             body bob { mass = 1 kg; inertia = [1, 1, 1] g*m^2; start position = [0, 0, 200] mm }
             force pull = Near(bob.origin, wall)
         }
         analysis place = assemble(Pair())
         analysis move = transient(Pair(), duration: 1 ms, sample: 1 ms)",
    );
    for name in ["place", "move"] {
        let warnings = run(&program, name).warnings;
        let names: Vec<&str> = warnings.iter().map(|w| w.name.as_str()).collect();
        assert_eq!(names, ["near"], "{name}");
    }
}
