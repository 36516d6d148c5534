//! The heat balance of a solved film: closed forms, the power of the drive, a film of the balanced viscosity,
//! and finer cells.

use eng::Sources;

/// A shaft that turns at 3000 rpm about a line beside the axis of its bush, so that flow and loss are
/// constant if the viscosity is.
fn bush(law: &str, duration: &str) -> String {
    format!(
        "use std.journals.{{Film, ThermalFilm, axial_groove}}
use std.joints.Revolute
use std.drives.PrescribedRotation
use std.oils.{{ConstantOil, SAE_10W40}}
model Bush {{
    gravity = [0, 0, 0] m/s^2
    param speed: AngularVelocity = 3000 rpm
    marker seat = origin
    marker beside = [14, -6, 0] um
    body shaft {{
        mass = 2 kg
        inertia = [1, 1, 1] g*m^2
        marker mid = origin
        start angular_velocity = [0, 0, 1]*speed
    }}
    joint hold = Revolute(shaft.mid, beside)
    drive turn = PrescribedRotation(shaft.mid, seat, speed: speed)
    journal main = {law}
}}
analysis run = transient(Bush(), duration: {duration}, sample: 2 ms)
"
    )
}

const BEARING: &str = "shaft.mid, seat, diameter: 54 mm, width: 24 mm, radial_clearance: 27 um, \
    openings: [axial_groove(at: 140 deg, length: 14 mm, width: 8 mm, diameter: 54 mm, pressure: 3 bar)]";
const HEAT: &str = "start_temperature: 90 degC, supply_temperature: 80 degC, density: 830 kg/m^3, specific_heat: 2.2 kJ/kg/K, \
    capacity: 2 J/K, into_walls: 10 %, conductance: 3 W/K, wall_temperature: 85 degC";

struct Run(eng::Outcome);

impl Run {
    fn of(text: &str) -> Run {
        let sources = Sources::from_text("m.eng", text);
        let program = match eng::check(&sources, "m.eng").into_program() {
            Ok(program) => program,
            Err(report) => panic!("{report}"),
        };
        let analysis = program.analysis("run").expect("an analysis");
        let outcome = analysis.run(&mut |_| {});
        Run(outcome.unwrap_or_else(|failed| panic!("{}", failed.error)))
    }

    /// The values of a column (SI).
    fn column(&self, path: &str) -> &[f64] {
        &self.0.results.column(path).expect("a column").values
    }

    fn last(&self, path: &str) -> f64 {
        *self.column(path).last().expect("a sample")
    }
}

/// Heat flow of the side flow over its rise of temperature, 2 ρ c Q, and that of all ways together (W/K).
fn conveyed(side_flow: f64) -> [f64; 2] {
    let with_oil = 2.0 * 830.0 * 2200.0 * side_flow;
    [with_oil, with_oil + 3.0]
}

/// Oil of constant viscosity has a constant loss P and side flow Q, so the temperature approaches its limit
/// exponentially, with the time constant of the heat that the film keeps over the heat that leaves it.
#[test]
fn constant_oil_warms_exponentially() {
    let law = format!(
        "ThermalFilm({BEARING}, viscosity: 9 mPa*s, oil: ConstantOil(value: 9 mPa*s), {HEAT}, around: 36, across: 8)"
    );
    let run = Run::of(&bush(&law, "1 s"));
    let (loss, flow) = (run.column("main.power_loss"), run.column("main.side_flow"));
    let varies = |numbers: &[f64]| {
        let [low, high] =
            [f64::min, f64::max].map(|of| numbers.iter().copied().reduce(of).unwrap_or(f64::NAN));
        (high - low) / high
    };
    assert!(varies(loss) < 1e-9 && varies(flow) < 1e-9);
    let [with_oil, all] = conveyed(flow[0]);
    let limit = (0.9 * loss[0] + with_oil * 353.15 + 3.0 * 358.15) / all;
    let tau = 2.0 / all;
    let mut worst = 0.0_f64;
    for (time, temperature) in run
        .column("time")
        .iter()
        .zip(run.column("main.temperature"))
    {
        let due = limit + (363.15 - limit) * (-time / tau).exp();
        worst = worst.max((temperature - due).abs());
    }
    println!(
        "{:.1} W, {limit:.3} K, time constant {tau:.4} s, off by {worst:.1e} K",
        loss[0]
    );
    assert!((limit - 363.15).abs() > 2.0 && tau < 0.3);
    // a state may err by 1e-5 of its size, here 363 K
    assert!(worst < 4e-3, "{worst}");
}

/// In balance the film is that of an oil with the viscosity of its temperature, the heats add up to the power
/// of the drive, and the temperature is that of the balance of DIN 31652-1 with walls.
#[test]
fn a_warm_film_is_in_balance() {
    let cells = "around: 36, across: 8";
    let warm = Run::of(&bush(
        &format!(
            "ThermalFilm({BEARING}, viscosity: SAE_10W40.viscosity(90 degC), oil: SAE_10W40, {HEAT}, {cells})"
        ),
        "3 s",
    ));
    let (loss, flow) = (warm.last("main.power_loss"), warm.last("main.side_flow"));
    let [with_oil, all] = conveyed(flow);
    let temperature = warm.last("main.temperature");
    let balanced = (0.9 * loss + with_oil * 353.15 + 3.0 * 358.15) / all;
    assert!(
        (temperature - balanced).abs() < 1e-6,
        "{temperature} {balanced}"
    );
    let outlet = warm.last("main.outlet_temperature");
    assert!((outlet - 353.15 - 2.0 * (temperature - 353.15)).abs() < 1e-9);
    // Vogel's law of the oil, by its published constants
    let viscosity = 0.074641e-3 * (1094.5 / (temperature - 273.15 + 116.05)).exp();
    let found = warm.last("main.oil_viscosity");
    assert!(
        (found / viscosity - 1.0).abs() < 1e-9,
        "{found} {viscosity}"
    );
    let cold = Run::of(&bush(
        &format!("Film({BEARING}, viscosity: {} Pa*s, {cells})", viscosity),
        "20 ms",
    ));
    for path in [
        "main.power_loss",
        "main.side_flow",
        "main.friction_torque",
        "main.maximum_pressure",
    ] {
        let (warm, cold) = (warm.last(path), cold.last(path));
        assert!((warm / cold - 1.0).abs() < 1e-9, "{path}: {warm} {cold}");
    }
    let heats = ["oil", "walls"].map(|way| warm.last(&format!("main.heat_to_{way}")));
    let stored = warm.last("main.heat_stored");
    assert!((heats[0] + heats[1] + stored - loss).abs() < 1e-9 * loss);
    assert!(stored.abs() < 1e-9 * loss, "{stored}");
    // the supply gives power, too
    let speed = 3000.0 * std::f64::consts::TAU / 60.0;
    let pumped = 3e5 * warm.last("main.supply_flow");
    let given = warm.last("turn.torque.z") * speed + pumped;
    println!(
        "{temperature:.3} K, {given:.2} W given, {loss:.2} W lost, {:.1} W with the oil, {:.1} W into walls",
        heats[0], heats[1]
    );
    assert!((given / loss - 1.0).abs() < 1e-9, "{given} {loss}");
}

/// The temperature of the balance converges: nearly with the second order, but the flow at the corners of the
/// groove with the first.
#[test]
fn finer_cells_change_the_temperature_less() {
    let temperature = |around: u32, across: u32| {
        let law = format!(
            "ThermalFilm({BEARING}, viscosity: SAE_10W40.viscosity(90 degC), oil: SAE_10W40, {HEAT}, around: {around}, across: {across})"
        );
        Run::of(&bush(&law, "2 s")).last("main.temperature")
    };
    let found = [(24, 6), (48, 12), (96, 24)].map(|(around, across)| temperature(around, across));
    let (coarse, fine) = (found[1] - found[0], found[2] - found[1]);
    println!("{found:?}: {coarse:.4} and {fine:.4} K");
    assert!(
        fine.abs() < coarse.abs() / 2.5 && fine.abs() < 0.1,
        "{found:?}"
    );
}
