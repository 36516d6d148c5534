//! The role of an element in the results depends on the interface that its class fills, and on no
//! name of a class or a parameter.

use crate::check_support;
use eng_compiler::elaborate::{Elaborated, analyses, elaborate};
use eng_compiler::library::LIBRARY;
use eng_compiler::resolve::resolve;
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::code::BindCode;

fn elaborated(text: &str) -> Result<Elaborated, Vec<String>> {
    let host = check_support::Folder {
        root: "model.eng".to_owned(),
        text: text.to_owned(),
        folder: "/nowhere".into(),
    };
    let (mut sources, mut diagnostics) = (SourceMap::new(), Diagnostics::new());
    let program = resolve("model.eng", &host, LIBRARY, &mut sources, &mut diagnostics);
    let typed = eng_compiler::check::check(program, &sources, &mut diagnostics);
    let plans = analyses(&typed, &mut sources, &host, &mut diagnostics);
    let made = plans.first().and_then(|plan| {
        let (model, constants) = (plan.model, &plan.constants);
        elaborate(
            &typed,
            &mut sources,
            &host,
            model,
            constants,
            &mut diagnostics,
        )
    });
    let errors: Vec<String> = diagnostics
        .iter()
        .filter(|d| d.is_error())
        .map(|d| format!("{} {}", d.code, d.title))
        .collect();
    match made {
        Some(made) if errors.is_empty() => Ok(made),
        _ => Err(errors),
    }
}

const FILM: &str = "
use std.journals.{JournalLaw, Impedance, finite_response, film_kinematics, film_attitude}
KIND OwnFilm(pin: Marker, shell: Marker, diameter: Length, width: Length, CLEARANCE: Length, viscosity: DynamicViscosity) INTERFACE {
    let film = film_kinematics(pin, shell, CLEARANCE)
    let response = finite_response(film_attitude(film.ratio, film.squeeze), width/diameter)
    let coefficient = 2*viscosity*width*(diameter/(2*CLEARANCE))^3
    let push = -coefficient*(response.x*film.squeeze + response.y*perpendicular(film.squeeze))
    let pushed = vector([push.x, push.y, 0 N], shell)
    apply force pushed on pin against shell
    output force: Vector<Force> = pushed in shell as kN
    output eccentricity: Vector2<Length> = film.ratio*CLEARANCE in shell as um
    output eccentricity_ratio: Vector2<1> = film.ratio in shell
    output film_ratio: 1 = norm(film.ratio, floor: 1e-9)
    output minimum_film: Length = CLEARANCE*(1 - norm(film.ratio, floor: 1e-9)) as um
    output friction_torque: Torque = 0 N*m
    output power_loss: Power = -dot(push, film.squeeze) as W
}
model Rotor {
    gravity = [0, -9.81, 0] m/s^2
    marker shell = [0, 0, 0] mm
    body shaft { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker pin = origin }
    journal library = Impedance(shaft.pin, shell, diameter: 50 mm, width: 20 mm, radial_clearance: 30 um, viscosity: 10 mPa*s)
    KIND own = OwnFilm(shaft.pin, shell, diameter: 40 mm, width: 10 mm, CLEARANCE: 20 um, viscosity: 10 mPa*s)
}
analysis a = assemble(Rotor())";

fn film(kind: &str, clearance: &str, interface: &str) -> String {
    FILM.replace("KIND", kind)
        .replace("CLEARANCE", clearance)
        .replace("INTERFACE", interface)
}

#[test]
fn a_film_law_of_the_text_is_a_journal_by_its_interface() {
    for kind in ["journal", "force"] {
        let made = elaborated(&film(kind, "radial_clearance", ": JournalLaw")).expect("no mistake");
        let none = vec![None; made.system.parameters.len()];
        let bound = made.bind.bind(&none, &made.system.tables).expect("it fits");
        let found: Vec<f64> = made
            .system
            .journals
            .iter()
            .map(|j| (bound.slots[j.clearance.0 as usize] * 1e6).round())
            .collect();
        assert_eq!(found, [30.0, 20.0], "{kind}");
        let paths: Vec<&str> = made
            .system
            .journals
            .iter()
            .map(|j| {
                made.system.elements[j.element as usize]
                    .origin
                    .path
                    .as_str()
            })
            .collect();
        assert_eq!(paths, ["library", "own"]);
    }
}

#[test]
fn a_law_that_does_not_fill_the_interface_is_no_journal() {
    // all names of the interface, which is not declared: a force is a force
    let made = elaborated(&film("force", "radial_clearance", "")).expect("no mistake");
    assert_eq!(made.system.journals.len(), 1);
    let refused = |kind: &str, clearance: &str, interface: &str| {
        elaborated(&film(kind, clearance, interface)).expect_err("a mistake")[0].clone()
    };
    assert_eq!(
        refused("journal", "clearance", ""),
        "E0421 the journal `OwnFilm` lacks `radial_clearance: Length` of `JournalLaw`"
    );
    assert_eq!(
        refused("journal", "radial_clearance", ""),
        "E0421 the journal `OwnFilm` does not state that it fills `JournalLaw`"
    );
    // the parameter that it does not repeat is that of the interface, and is expected at the use
    assert_eq!(
        refused("journal", "clearance", ": JournalLaw"),
        "E0402 `OwnFilm` needs `radial_clearance`"
    );
}

#[test]
fn the_measures_of_a_film_follow_from_parameters() {
    let text = film("journal", "radial_clearance", ": JournalLaw");
    let moving = text.replace("clearance: 20 um", "clearance: 20 um*(1 + time/1 s)");
    let refused = elaborated(&moving).expect_err("a mistake");
    assert!(
        refused[0].contains("`own.radial_clearance` depends on the motion"),
        "{refused:?}"
    );
    // tables show no number of a parameter that moves
    let moving = text.replace("diameter: 40 mm", "diameter: 40 mm*(1 + time/1 s)");
    let made = elaborated(&moving).expect("no mistake");
    let [films] = made.system.summaries.as_slice() else {
        panic!("{:?}", made.system.summaries);
    };
    let names: Vec<&str> = films.parameters.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(
        names,
        ["diameter", "width", "radial_clearance", "viscosity"]
    );
    let known = |row: usize| -> Vec<bool> {
        let values = films.rows[row].parameters.iter();
        values.map(Option::is_some).collect()
    };
    assert_eq!(
        (known(0), known(1)),
        (vec![true; 4], vec![false, true, true, true])
    );
}

/// Two interfaces with summaries; one extends the other. `LEAST` is the class's own output.
const SUMMARIES: &str = "
interface Loss {
    param a: Marker
    param b: Marker
    /// Torque on a.
    output moment: Torque
    /// Its magnitude.
    output load: Torque = abs(moment) as N*mm summary largest
    /// Power that becomes heat.
    output heat: Power summary mean
}
interface Warm : Loss {
    output rise: Power = heat/2 as W summary largest
}
force Plain(a: Marker, b: Marker) : Loss {
    apply torque 3 N*m*b.z on a against b
    output moment: Torque = 3 N*m
    output heat: Power = 3 W
    LEAST
}
force Heated() : Warm {
    apply torque 4 N*m*b.z on a against b
    output moment: Torque = 4 N*m
    output heat: Power = 4 W
}
model M {
    marker base = [0, 0, 0] mm
    body one { mass = 1 kg; inertia = [1, 1, 1] kg*m^2 }
    force cold = Plain(one.origin, base)
    force warm[i in 1..2] = Heated(one.origin, base)
}
analysis a = assemble(M())";

#[test]
fn an_interface_with_summaries_has_a_table() {
    let made = elaborated(&SUMMARIES.replace("LEAST", "")).expect("no mistake");
    let [loss] = made.system.summaries.as_slice() else {
        panic!("{:?}", made.system.summaries);
    };
    assert_eq!(
        (loss.interface.as_str(), loss.parameters.len()),
        ("Loss", 0)
    );
    let columns: Vec<(&str, &str, &str)> = (loss.columns.iter())
        .map(|c| (c.output.as_str(), c.statistic.word(), c.about.as_str()))
        .collect();
    assert_eq!(
        columns,
        [
            ("load", "largest", "Its magnitude."),
            ("heat", "mean", "Power that becomes heat."),
            ("rise", "largest", ""),
        ]
    );
    let path = |channel: &Option<u32>| {
        channel.map_or("", |channel| {
            made.system.channels[channel as usize].path.as_str()
        })
    };
    let rows: Vec<Vec<&str>> = (loss.rows.iter())
        .map(|row| row.channels.iter().map(path).collect())
        .collect();
    assert_eq!(
        rows,
        [
            ["cold.load", "cold.heat", ""],
            ["warm[1].load", "warm[1].heat", "warm[1].rise"],
            ["warm[2].load", "warm[2].heat", "warm[2].rise"],
        ]
    );
}

#[test]
fn a_class_may_give_its_own_value_of_an_output() {
    let made = elaborated(&SUMMARIES.replace("LEAST", "output load: Torque = 7 N*m as N*m"))
        .expect("no mistake");
    let of_cold = (made.system.channels.iter()).filter(|c| c.path == "cold.load");
    let units: Vec<&str> = of_cold.map(|c| c.display.symbol.as_str()).collect();
    assert_eq!(units, ["N*m"]);
    for (wrong, title) in [
        (
            "output load: Power = 7 W",
            "E0407 the output `load` of `Plain` is a Power, not an Energy or Torque",
        ),
        (
            "let load = 7 N*m",
            "E0426 `load` of `Plain` is in its interface `Loss` already",
        ),
    ] {
        let refused = elaborated(&SUMMARIES.replace("LEAST", wrong)).expect_err("a mistake");
        assert_eq!(refused[0], title);
    }
}

const GAS: &str = "
use std.forces.{GasPressure, GasLaw}
use std.joints.{Translational, Revolute}
table trace(theta: CrankAngle) -> AbsolutePressure = points([0, 180, 360, 720] deg, [30, 3, 1, 30] bar, periodic: 720 deg)
force OwnGas(piston: Marker, head: Marker, bore: Length, TDC: Angle) INTERFACE {
    let push = (trace(cycle.angle - TDC) - 1 bar)*(pi/4*bore^2)
    apply force -push*head.z on piston against head
    output thrust: Force = push as kN
}
/// Another thing that fires.
force Spark(a: Marker, b: Marker, firing: Angle) {
    apply torque sin(firing)*b.z*1 N*m on a against b
}
model Engine {
    gravity = [0, 0, 0] m/s^2
    marker wall = [0, 0, 0] mm
    marker top = [0, 0, 0] mm
    body shaft { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
    body piston[i in 1..2] { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
    joint bearing = Revolute(shaft.origin, wall)
    joint bore[i in 1..2] = Translational(piston[i].origin, top)
    force gas = GasPressure(piston[1].origin, top, bore: 80 mm, pressure: trace, firing: 90 deg)
    force own = OwnGas(piston[2].origin, top, bore: 80 mm, TDC: 270 deg)
    force spark = Spark(shaft.origin, wall, firing: 33 deg)
    cycle angle = rotation(shaft.origin, wall) { period = 720 deg }
}
analysis a = assemble(Engine())";

#[test]
fn what_fires_is_told_by_its_interface() {
    let firings = |tdc: &str, interface: &str| {
        let text = GAS.replace("TDC", tdc).replace("INTERFACE", interface);
        let made = elaborated(&text).expect("no mistake");
        let none = vec![None; made.system.parameters.len()];
        let bound = made.bind.bind(&none, &made.system.tables).expect("it fits");
        let mut found = Vec::new();
        for firing in &made.system.firings {
            let path = made.system.elements[firing.element as usize]
                .origin
                .path
                .clone();
            let angle = bound.slots[firing.angle.0 as usize].to_degrees();
            found.push((path, angle.round()));
        }
        found
    };
    let gas = || ("gas".to_owned(), 90.0);
    assert_eq!(
        firings("firing", ": GasLaw"),
        [gas(), ("own".to_owned(), 270.0)]
    );
    assert_eq!(firings("dead_centre", ""), [gas()]);
    assert_eq!(firings("firing", ""), [gas()]);
}

/// A law by an interface that extends another one, and the same law as one class.
const STOP: &str = "
interface Contact {
    param a: Marker
    param b: Marker
    param stiffness: Stiffness
    param gap: Length = 2 mm
    fn bound(depth: Length) -> Length
    output load: Force
    output depth: Length
}
interface Pushing : Contact {
    param damping: Damping = 0.02*s_of(stiffness)
    fn s_of(k: Stiffness) -> Damping = k*1 s
    state heat: Energy = 0 J scale 1 J
    let inside = dot(b.origin - a.origin, b.z) - gap
    let speed = der(inside)
    let push = stiffness*bound(inside) + damping*speed
    der(heat) = damping*speed*speed
    apply force push*b.z on a against b
    output load = push as N
    output depth = inside as mm
    output lost = heat as J
    require stiffness > 0 N/m else \"a stiffness of {stiffness as N/mm}\"
}
force Split(reach: Length = 2*gap) : Pushing {
    fn bound(depth: Length) -> Length { let damping = 3 mm; depth*norm([depth/reach, 1]) + 0*damping }
    output share = bound(inside)/reach
}
force Whole(a: Marker, b: Marker, stiffness: Stiffness, gap: Length = 2 mm, damping: Damping = stiffness*0.02 s, reach: Length = 2*gap) {
    state heat: Energy = 0 J scale 1 J
    let inside = dot(b.origin - a.origin, b.z) - gap
    let speed = der(inside)
    let push = stiffness*(inside*norm([inside/reach, 1])) + damping*speed
    der(heat) = damping*speed*speed
    apply force push*b.z on a against b
    output load = push as N
    output depth = inside as mm
    output lost = heat as J
    output share = inside*norm([inside/reach, 1])/reach
}
/// A name of the module of the class, which the text of its interface must not see.
fn speed() -> Velocity = 1 m/s
component Pair(law: Contact, a: Marker, b: Marker) {
    force stop = law(a, b, 3 N/mm)
    output twice = 2*stop.load
}
model Rotor {
    gravity = [0, -9.81, 0] m/s^2
    marker wall = [0, 0, 0] mm
    body one { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
    body two { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
    force split = Split(one.origin, wall, stiffness: 2 N/mm)
    force whole = Whole(two.origin, wall, stiffness: 2 N/mm)
    part pair = Pair(law: Split, a: one.origin, b: wall)
}
analysis a = assemble(Rotor())";

#[test]
fn a_class_of_two_interfaces_is_the_class_of_all_their_text() {
    let made = elaborated(STOP).expect("no mistake");
    let paths = |of: &str| -> Vec<String> {
        let owner = format!("{of}.");
        let channels = made.system.channels.iter();
        channels
            .filter_map(|channel| channel.path.strip_prefix(&owner).map(str::to_owned))
            .collect()
    };
    assert_eq!(paths("split"), ["load", "depth", "lost", "share"]);
    assert_eq!(paths("split"), paths("whole"));
    let parameters = |of: &str| -> Vec<(String, u64)> {
        let none = vec![None; made.system.parameters.len()];
        let bound = made.bind.bind(&none, &made.system.tables).expect("it fits");
        let owner = format!("{of}.");
        let all = made.system.parameters.iter().zip(&bound.parameters);
        let mut found: Vec<(String, u64)> = all
            .filter_map(|(p, value)| {
                let name = p.origin.path.strip_prefix(&owner)?;
                Some((name.to_owned(), value.to_bits()))
            })
            .collect();
        found.sort();
        found
    };
    assert_eq!(parameters("split").len(), 4);
    assert_eq!(parameters("split"), parameters("whole"));
    // the same operations of the same numbers: their residuals are one function
    let residual = |of: &str| {
        let element = made.system.elements.iter().find(|e| e.origin.path == of);
        let class = element.expect("the element").class as usize;
        let functions = &made.classes[class];
        let residual = functions
            .get(eng_system::code::Function::Residual)
            .to_string();
        residual.split_once('\n').expect("its lines").1.to_owned()
    };
    assert_eq!(residual("split"), residual("whole"));
}

#[test]
fn the_lengths_that_classes_resolve_are_the_units_of_position_errors() {
    let stop = "force Stop(a: Marker, b: Marker, fine: Length) {
        resolve fine/2
        let depth = dot(b.origin - a.origin, b.z)
        apply force depth*(1 N/mm)*b.z on a against b
    }\n";
    let text = stop.to_owned()
        + &film("journal", "radial_clearance", ": JournalLaw").replace(
            "}\nanalysis",
            "    force stop = Stop(shaft.pin, shell, fine: 4 um)\n}\nanalysis",
        );
    let made = elaborated(&text).expect("no mistake");
    let none = vec![None; made.system.parameters.len()];
    let bound = made.bind.bind(&none, &made.system.tables).expect("it fits");
    let resolutions = made.system.resolutions.iter();
    let found: Vec<f64> = resolutions
        .map(|r| (bound.slots[r.length.0 as usize] * 1e6).round())
        .collect();
    assert_eq!(found, [30.0, 20.0, 2.0]);
    let made = elaborated(&text.replace("fine: 4 um", "fine: -4 um")).expect("no mistake");
    let refused = made
        .bind
        .bind(&none, &made.system.tables)
        .expect_err("below zero");
    assert!(
        refused
            .to_string()
            .contains("the length after `resolve` must be positive, not -0.002 mm"),
        "{refused}"
    );
}

const OILS: &str = "
interface Oil {
    fn viscosity(t: Temperature, rate: Frequency = 0 Hz) -> DynamicViscosity
    fn thinner(t: Temperature) -> DynamicViscosity = viscosity(t)/2
}
record Constant : Oil {
    let value: DynamicViscosity
    fn viscosity(t: Temperature, rate: Frequency = 0 Hz) -> DynamicViscosity = value
}
record Thinning : Oil {
    let value: DynamicViscosity
    let at: Frequency
    fn viscosity(t: Temperature, rate: Frequency = 0 Hz) -> DynamicViscosity = value/(1 + rate/at)
}
const Light = Constant(value: 8 mPa*s)
const Cross = Thinning(value: 12 mPa*s, at: 1e6 Hz)
force Drag(a: Marker, b: Marker, oil: Oil) {
    let d = oil.viscosity(80 degC, rate: 1e6 Hz)*1 m + oil.thinner(80 degC)*1 m
    apply force -d*(a.velocity - b.velocity) on a against b
    output damping = d as N*s/m
}
model Rotor {
    const oil: Oil = Light
    gravity = [0, 0, 0] m/s^2
    marker wall = [0, 0, 0] mm
    body one { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
    let chosen = [Light, Cross]
    force drag[i in 1..2] = Drag(one.origin, wall, oil: chosen[i])
    force own = Drag(one.origin, wall, oil: oil)
    output sum = drag[1].damping + drag[2].damping + own.damping as N*s/m
}
analysis a = assemble(Rotor(oil: Cross))";

#[test]
fn records_fill_an_interface_of_functions() {
    elaborated(OILS).expect("no mistake");
    let wrong = OILS.replace("oil: chosen[i]", "oil: 3 mm");
    let refused = elaborated(&wrong).expect_err("a mistake");
    assert!(refused[0].contains("`oil` of `Drag`"), "{refused:?}");
}

const BOUND: &str = "
use std.journals.{Impedance, Short, JournalLaw, PiFilm, short_response, Attitude}
const clearance = 25 um
journal Thin = Impedance(viscosity: 8 mPa*s, radial_clearance: clearance)
journal Wide = Thin(width: 30 mm)
journal Grooved(grooves: 1, depth: Length = 1 mm) : PiFilm {
    fn response(film: Attitude) -> Vector2<1> = short_response(film)/(1 + grooves*(depth/width))
    fn resistance() -> Damping = viscosity*diameter*width^3/(2*radial_clearance^3)
    fn film_width() -> Length = width
}
journal Three = Grooved(grooves: 3)
component Bearing(law: JournalLaw, pin: Marker, shell: Marker) {
    journal film = law(pin, shell, 54 mm, 20 mm, 27 um, viscosity: 10 mPa*s)
}
component Ours(pin: Marker, shell: Marker, deep: Length) {
    const law: JournalLaw = Grooved(grooves: 2, depth: deep)
    journal film = law(pin, shell, 54 mm, 20 mm, 27 um, 10 mPa*s)
}
model Rotor {
    const law: JournalLaw = Short
    gravity = [0, 0, 0] m/s^2
    marker shell = [0, 0, 0] mm
    body shaft { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
    journal whole = Impedance(shaft.origin, shell, 54 mm, 30 mm, 25 um, 8 mPa*s)
    journal wide = Wide(shaft.origin, shell, 54 mm)
    part one = Bearing(law: Grooved(grooves: 3), pin: shaft.origin, shell: shell)
    part two = Ours(pin: shaft.origin, shell: shell, deep: 2 mm)
    part three = Bearing(law: law, pin: shaft.origin, shell: shell)
    part four = Bearing(law: if 1 > 2 then Short else Three, pin: shaft.origin, shell: shell)
}
analysis a = assemble(Rotor(law: Three))";

#[test]
fn a_class_with_some_arguments_is_a_class() {
    let made = elaborated(BOUND).expect("no mistake");
    let none = vec![None; made.system.parameters.len()];
    let bound = made.bind.bind(&none, &made.system.tables).expect("it fits");
    let of = |owner: &str| -> Vec<(String, f64)> {
        let all = made.system.parameters.iter().zip(&bound.parameters);
        let mut found: Vec<(String, f64)> = all
            .filter_map(|(p, value)| {
                let name = p.origin.path.strip_prefix(owner)?.strip_prefix('.')?;
                Some((name.to_owned(), *value))
            })
            .collect();
        found.sort_by(|a, b| a.0.cmp(&b.0));
        found
    };
    assert_eq!(of("whole").len(), 4);
    assert_eq!(of("whole"), of("wide"));
    let value = |path: &str, name: &str| {
        let of = of(path);
        let found = of.iter().find(|(known, _)| known == name);
        found.unwrap_or_else(|| panic!("{path}.{name}: {of:?}")).1
    };
    assert_eq!(value("one.film", "grooves"), 3.0);
    assert_eq!(value("two.film", "grooves"), 2.0);
    assert_eq!(value("two.film", "depth"), 2e-3);
    assert_eq!(value("three.film", "grooves"), 3.0);
    assert_eq!(value("four.film", "grooves"), 3.0);
    // elements of one class share its code, however their arguments came to them
    let class = |path: &str| {
        let element = made.system.elements.iter().find(|e| e.origin.path == path);
        element.expect("the element").class
    };
    assert_eq!(class("whole"), class("wide"));
    assert_eq!(class("one.film"), class("two.film"));
    let unnamed = BOUND.replace("Rotor(law: Three)", "Rotor(law: Grooved(grooves: 3))");
    let refused = elaborated(&unnamed).expect_err("no name");
    assert!(
        refused[0].contains("an analysis passes a class to a model by its name"),
        "{refused:?}"
    );
}

const COUNTED: &str = "
use std.forces.LinearSpring
fn mean(values: Length[n]) -> Length = sum(values)/n
fn moment(arms: Length[n], loads: Force[n]) -> Torque = sum(arms[i]*loads[i] for i in 1..n)
component Row(of: Marker[n], wall: Marker, lengths: Length[n], stiffness: Stiffness) {
    force spring[i in 1..n] = LinearSpring(of[i], wall, stiffness: stiffness, free_length: lengths[i])
    output longest = mean(lengths) as mm
}
force Pull(a: Marker, b: Marker, loads: Force[count]) {
    apply force sum(loads)/count*b.z on a against b
    output share = moment([1, 2, 3] mm, [1, 2, 3] N)/(1 N) as mm
}
model Rig {
    gravity = [0, 0, 0] m/s^2
    marker wall = [0, 0, 0] mm
    body block { mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker hook[i in 1..3] = [100*i, 0, 0] mm }
    part row = Row(of: block.hook, wall: wall, lengths: [10, 20, 30] mm, stiffness: 1 N/mm)
    force pull = Pull(block.origin, wall, [1, 2, 6, 7] N)
}
analysis a = assemble(Rig())";

#[test]
fn an_argument_decides_the_length_of_its_array() {
    let made = elaborated(COUNTED).expect("no mistake");
    let springs = made.system.elements.iter();
    let springs = springs.filter(|e| e.origin.path.starts_with("row.spring"));
    assert_eq!(springs.count(), 3);
    let refused = |right: &str, wrong: &str| {
        assert!(COUNTED.contains(right));
        elaborated(&COUNTED.replace(right, wrong)).expect_err("a mistake")[0].clone()
    };
    assert_eq!(
        refused("[10, 20, 30] mm", "[10, 20] mm"),
        "E0510 `lengths` has 2 elements, and `n` is 3"
    );
    assert_eq!(
        refused("[1, 2, 3] mm", "[1, 2, 3, 4] mm"),
        "E0510 `loads` has 3 elements, and `n` is 4"
    );
    // a word like the name of a count is a misspelt one
    assert_eq!(
        refused("Force[count])", "Force[count], counts: Int = 4)"),
        "E0205 there is no `count` here"
    );
}

/// Results of a film that jump from cell to cell, and outputs that read them, also those of other elements.
#[test]
fn channels_that_jump_are_known() {
    let text = "use std.journals.Film
         model Rotor {
            gravity = [0, 0, 0] m/s^2
            marker seat = [0, 0, 0] mm
            body shaft { mass = 5 kg; inertia = [5, 5, 5] g*m^2; start angular_velocity = [0, 0, 300] rad/s }
            journal main = Film(shaft.origin, seat, diameter: 54 mm, width: 24 mm, radial_clearance: 27 um, viscosity: 8 mPa*s)
            output place = 2*main.minimum_film_across as mm
            output again = place + 1 mm as mm
            output least = 2*main.minimum_film as um
         }
         analysis a = assemble(Rotor())";
    let made = elaborated(text).expect("no mistake");
    let jumping = made.system.channels.iter().filter(|c| !c.continuous);
    let jumping: Vec<&str> = jumping.map(|c| c.path.as_str()).collect();
    let own = [
        "minimum_film_angle",
        "minimum_film_across",
        "maximum_pressure_angle",
        "maximum_pressure_across",
        "cavitated",
        "unexplained_flow",
    ];
    let own = own.map(|name| format!("main.{name}"));
    let slopes = ["stiffness", "damping"];
    let slopes = slopes
        .iter()
        .flat_map(|name| (1..=4).map(move |k| format!("main.{name}[{k}]")));
    let mut expected: Vec<String> = own.into_iter().chain(slopes).collect();
    expected.extend(["place", "again"].map(str::to_owned));
    assert_eq!(jumping, expected);
}
