//! The quasi-static start of a flexible shaft that turns, through the language: its weight bends it as at rest.

use crate::support::{outcome, program_of};
use eng::{Outcome, Program, StartReport, Turning};
use eng_system::field::{
    Accuracy, FieldError, FieldGrid, FieldKernel, FieldMaker, FieldNumbers, FieldSolver, Past,
};
use eng_system::system::Start;
use std::fmt::Write;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::ThreadId;

const YOUNG: f64 = 2.1e11;
const DENSITY: f64 = 7850.0;
const DIAMETER: f64 = 0.02;
const LENGTH: f64 = 0.4;
const PIECES: u32 = 8;

fn area() -> f64 {
    0.25 * std::f64::consts::PI * DIAMETER * DIAMETER
}

/// Second moment of the section about an axis across.
fn second_moment() -> f64 {
    std::f64::consts::PI * DIAMETER.powi(4) / 64.0
}

/// A round shaft along z.
fn deck() -> String {
    let (area, moment) = (area(), second_moment());
    beam(LENGTH, PIECES, area, moment)
}

/// A beam of steel along z with its first node at the origin.
fn beam(length: f64, pieces: u32, area: f64, moment: f64) -> String {
    let mut deck = format!(
        "BEGIN BULK\nMAT1,1,{YOUNG:e},,0.3,{DENSITY}\nPBAR,1,1,{area:.8e},{moment:.8e},{moment:.8e},{:.8e}\n",
        2.0 * moment
    );
    for node in 0..=pieces {
        let z = length * f64::from(node) / f64::from(pieces);
        writeln!(deck, "GRID,{},,0.,0.,{z:.4}", node + 1).expect("a line");
    }
    for piece in 1..=pieces {
        writeln!(deck, "CBAR,{piece},1,{piece},{},1.,0.,0.", piece + 1).expect("a line");
    }
    deck + "ENDDATA\n"
}

fn run(speed: f64) -> Outcome {
    let text = format!(
        "use std.joints.{{Spherical, PointOnLine}}
         use std.drives.PrescribedRotation
         model Shaft {{
             gravity = [0, -9.81, 0] m/s^2
             marker left = [0, 0, 0] m
             marker right = [0, 0, {LENGTH}] m
             flexible shaft {{
                 mesh = nastran(\"shaft.bdf\", units: m_kg_s)
                 modes = static(at: [left, right, middle], freedoms: [x, y]) + normal(4)
                 damping = 0 %
                 geometric_stiffness = true
                 marker left = node(1)
                 marker middle = node(5)
                 marker right = node(9)
             }}
             joint fixed_bearing = Spherical(shaft.left, left)
             joint free_bearing = PointOnLine(shaft.right, right)
             drive turn = PrescribedRotation(shaft.left, left, speed: {speed} rad/s)
             output sag: Length = dot(shaft.middle.origin, ground.y)
             output aside: Length = dot(shaft.middle.origin, ground.x)
         }}
         analysis begins = transient(Shaft(), duration: 10 ms, sample: 0.1 ms, start: quasi_static)"
    );
    let program = program_of(&[("shaft.eng", &text), ("shaft.bdf", &deck())]);
    outcome(&program, "begins")
}

fn column<'r>(outcome: &'r Outcome, path: &str) -> &'r [f64] {
    &outcome.results.column(path).expect("a column").values
}

/// At 0.3 to 1.5 times its first frequency the shaft sags as at rest, at the start and for the first 10 ms.
#[test]
fn a_shaft_in_bearings_sags_as_at_rest() {
    let stiffness = YOUNG * second_moment();
    let weight = DENSITY * area() * 9.81;
    let beam = 5.0 * weight * LENGTH.powi(4) / (384.0 * stiffness);
    let frequency =
        (std::f64::consts::PI / LENGTH).powi(2) * (stiffness / (DENSITY * area())).sqrt();
    let rest = -column(&run(0.0), "sag")[0];
    println!("at rest {rest:e}, of a beam {beam:e}");
    assert!((rest / beam - 1.0).abs() < 0.02, "{rest:e} {beam:e}");
    for ratio in [0.3, 0.5, 0.8, 1.5] {
        let outcome = run(ratio * frequency);
        let Some(StartReport::QuasiStatic(found)) = &outcome.start else {
            panic!("{ratio}: {:?}", outcome.start);
        };
        assert!(
            matches!(found.turning, Some(Turning::Repeating { change, .. }) if change < 1e-6),
            "{ratio}: {found:?}"
        );
        let (sag, aside) = (column(&outcome, "sag"), column(&outcome, "aside"));
        let off = |y: f64, x: f64| (y + rest).hypot(x) / rest;
        let ringing = sag
            .iter()
            .zip(aside)
            .fold(0.0_f64, |w, (y, x)| w.max(off(*y, *x)));
        println!(
            "Ω/ω {ratio}: off by {:.2e}, in 10 ms {ringing:.2e}",
            off(sag[0], aside[0])
        );
        assert!(
            off(sag[0], aside[0]) < 1e-4,
            "{ratio}: {} {}",
            sag[0],
            aside[0]
        );
        assert!(ringing < 1e-2, "{ratio}: {ringing}");
    }
}

/// A disc of 2 kg in the middle of the shaft, its centre of mass beside the axis.
const DISC: f64 = 2.0;
const PIN: f64 = 0.02;
const WIDTH: f64 = 0.005;
const CLEARANCE: f64 = 14e-6;
const VISCOSITY: f64 = 8e-3;
/// First critical speed of shaft and disc in rigid bearings (rad/s).
const CRITICAL: f64 = 680.0;

fn rotor(speed: f64, unbalance: &str, bearings: &str, duration: &str, start: &str) -> Outcome {
    let program = checked_rotor(speed, unbalance, bearings, duration, start);
    program
        .analysis("begins")
        .unwrap_or_else(|error| panic!("{error}"))
        .run(&mut |_| {})
        .unwrap_or_else(|failed| panic!("{}", failed.error))
}

fn checked_rotor(
    speed: f64,
    unbalance: &str,
    bearings: &str,
    duration: &str,
    start: &str,
) -> Program {
    let text = format!(
        "use std.joints.{{PointOnPlane, PointOnLine, Fixed}}
         use std.drives.PrescribedRotation
         use std.journals.{{Short, Film}}
         model Rotor {{
             gravity = [0, -9.81, 0] m/s^2
             marker left = [0, 0, 0] m
             marker right = [0, 0, {LENGTH}] m
             flexible shaft {{
                 mesh = nastran(\"shaft.bdf\", units: m_kg_s)
                 modes = static(at: [left, right, middle], freedoms: [x, y]) + normal(4)
                 damping = 0 %
                 geometric_stiffness = true
                 marker left = node(1)
                 marker middle = node(5)
                 marker right = node(9)
                 start angular_velocity = [0, 0, {speed}] rad/s
             }}
             body disc {{
                 mass = {DISC} kg
                 inertia = [0.8, 0.8, 1.6] g*m^2
                 center_of_mass = [{unbalance}, 0 um, 0 um]
                 marker hub = origin
             }}
             joint fit = Fixed(disc.hub, shaft.middle)
             joint thrust = PointOnPlane(shaft.left, left)
             {bearings}
             drive turn = PrescribedRotation(shaft.left, left, speed: {speed} rad/s)
             output sag: Length = dot(shaft.middle.origin - shaft.left.origin, ground.y)
             output aside: Length = dot(shaft.middle.origin - shaft.left.origin, ground.x)
             output pin_sag: Length = dot(shaft.left.origin, ground.y)
             output pin_aside: Length = dot(shaft.left.origin, ground.x)
         }}
         analysis begins = transient(Rotor(), duration: {duration}, sample: 0.1 ms, start: {start})"
    );
    program_of(&[("rotor.eng", &text), ("shaft.bdf", &deck())])
}

fn films() -> String {
    format!(
        "journal film[j in 1..2] = Short(
             pin: [shaft.left, shaft.right][j], shell: [left, right][j], diameter: {PIN} m, width: {WIDTH} m,
             radial_clearance: {CLEARANCE:e} m, viscosity: {VISCOSITY} Pa*s)"
    )
}

fn followed(outcome: &Outcome) {
    let Some(StartReport::QuasiStatic(found)) = &outcome.start else {
        panic!("{:?}", outcome.start);
    };
    assert!(
        matches!(found.turning, Some(Turning::Followed { change, .. }) if change < 1e-3),
        "{found:?}"
    );
}

/// Eccentricity ratio of Ocvirk's bearing under a load that is fixed in space, from
/// `W = μΩRB³/c² ε/(4 (1 − ε²)²) √(16 ε² + π² (1 − ε²))`, and its attitude `tan φ = π √(1 − ε²)/(4 ε)` (NACA TN
/// 2808).
fn ocvirk(load: f64, speed: f64) -> (f64, f64) {
    use std::f64::consts::PI;
    let unit = VISCOSITY * speed * 0.5 * PIN * WIDTH.powi(3) / CLEARANCE.powi(2);
    let carried = |e: f64| {
        let rest = 1.0 - e * e;
        unit * e / (4.0 * rest * rest) * (16.0 * e * e + PI * PI * rest).sqrt()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if carried(middle) < load {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low, (PI * (1.0 - low * low).sqrt()).atan2(4.0 * low))
}

/// A rotor in two films under its weight: pins on Ocvirk's locus, the shaft bent as at rest, and both stay so
/// for 10 ms.
#[test]
fn a_shaft_in_films_sags_as_at_rest() {
    let rigid = "joint one = PointOnLine(shaft.left, left)
                 joint two = PointOnLine(shaft.right, right)";
    let rest = -column(&rotor(0.0, "0 um", rigid, "0.1 ms", "quasi_static"), "sag")[0];
    let weight = 9.81 * (DISC + DENSITY * area() * LENGTH);
    println!("at rest {rest:e}");
    for ratio in [0.3, 0.5, 0.8, 1.5] {
        let speed = ratio * CRITICAL;
        let outcome = rotor(speed, "0 um", &films(), "10 ms", "quasi_static");
        followed(&outcome);
        let [sag, aside, pin_sag, pin_aside] =
            ["sag", "aside", "pin_sag", "pin_aside"].map(|path| column(&outcome, path));
        let bent = (sag[0] + rest).hypot(aside[0]) / rest;
        let (eccentricity, attitude) = ocvirk(0.5 * weight, speed);
        let due = CLEARANCE * eccentricity;
        let pin = (pin_sag[0] + due * attitude.cos()).hypot(pin_aside[0] - due * attitude.sin())
            / CLEARANCE;
        let ringing = (0..sag.len()).fold(0.0_f64, |w, i| {
            let disc = (sag[i] - sag[0]).hypot(aside[i] - aside[0]);
            let pin = (pin_sag[i] - pin_sag[0]).hypot(pin_aside[i] - pin_aside[0]);
            w.max((disc + pin) / rest)
        });
        println!(
            "Ω/ω {ratio}: bent off by {bent:.2e}, pin by {pin:.2e} of the clearance, in 10 ms {ringing:.2e}"
        );
        assert!(bent < 1e-3, "{ratio}: {bent}");
        assert!(pin < 1e-3, "{ratio}: {pin}");
        assert!(ringing < 2e-3, "{ratio}: {ringing}");
    }
}

/// The same with an unbalance: the motion from the start repeats after a turn, and a long run reaches the same motion.
#[test]
fn an_unbalance_in_films_repeats_from_the_start() {
    let speed = 0.5 * CRITICAL;
    let turn = 2.0 * std::f64::consts::PI / speed;
    let outcome = rotor(speed, "5 um", &films(), "40 ms", "quasi_static");
    followed(&outcome);
    // as assembled it comes to the same after 40 turns
    let long = rotor(
        speed,
        "5 um",
        &films(),
        &format!("{} s", 42.0 * turn),
        "assembled",
    );
    let at = |outcome: &Outcome, path: &str, time: f64| {
        let times = column(outcome, "time");
        let values = column(outcome, path);
        let k = times
            .partition_point(|t| *t <= time)
            .clamp(1, times.len() - 1);
        let part = (time - times[k - 1]) / (times[k] - times[k - 1]);
        values[k - 1] + part * (values[k] - values[k - 1])
    };
    for path in ["sag", "aside", "pin_sag", "pin_aside"] {
        let values = column(&outcome, path);
        let swing = values.iter().fold(f64::NEG_INFINITY, |m, x| m.max(*x))
            - values.iter().fold(f64::INFINITY, |m, x| m.min(*x));
        let (mut again, mut later) = (0.0_f64, 0.0_f64);
        for k in 0..100 {
            let time = turn * f64::from(k) / 100.0;
            let here = at(&outcome, path, time);
            again = again.max((at(&outcome, path, time + turn) - here).abs() / swing);
            later = later.max((at(&long, path, time + 40.0 * turn) - here).abs() / swing);
        }
        println!("{path}: after a turn {again:.2e}, of a long run {later:.2e} of the swing");
        assert!(again < 1e-2, "{path}: {again}");
        assert!(later < 2e-2, "{path}: {later}");
    }
}

/// Numbers of solutions and of tangents of all fields, and the threads that solved some.
#[derive(Debug, Default)]
struct Counts {
    solved: AtomicUsize,
    differentiated: AtomicUsize,
    threads: Mutex<Vec<ThreadId>>,
}

/// What makes, holds or solves fields, and counts.
#[derive(Clone, Debug)]
struct Counted<T> {
    inner: T,
    counts: Arc<Counts>,
}

impl FieldMaker for Counted<Arc<dyn FieldMaker>> {
    fn make(&self, numbers: &FieldNumbers<'_>) -> Result<Arc<dyn FieldKernel>, FieldError> {
        let counts = Arc::clone(&self.counts);
        let inner = self.inner.make(numbers)?;
        Ok(Arc::new(Counted { inner, counts }))
    }
}

impl FieldKernel for Counted<Arc<dyn FieldKernel>> {
    fn solver(&self, differentiated: &[bool]) -> Box<dyn FieldSolver> {
        let counts = Arc::clone(&self.counts);
        let inner = self.inner.solver(differentiated);
        Box::new(Counted { inner, counts })
    }
    fn memory(&self) -> usize {
        self.inner.memory()
    }
    fn shapes(&self) -> usize {
        self.inner.shapes()
    }
    fn yields(&self) -> bool {
        self.inner.yields()
    }
    fn grid(&self) -> FieldGrid {
        self.inner.grid()
    }
    fn refined(&self) -> Result<Arc<dyn FieldKernel>, FieldError> {
        self.inner.refined()
    }
}

impl FieldSolver for Counted<Box<dyn FieldSolver>> {
    fn solve(
        &mut self,
        drives: &[f64],
        past: Option<Past<'_>>,
        accuracy: Accuracy,
        answers: &mut [f64],
    ) -> Result<(), FieldError> {
        self.counts.solved.fetch_add(1, Ordering::Relaxed);
        let own = std::thread::current().id();
        let mut threads = self.counts.threads.lock().expect("no panic");
        if !threads.contains(&own) {
            threads.push(own);
        }
        drop(threads);
        self.inner.solve(drives, past, accuracy, answers)
    }
    fn accept(&self, memory: &mut [f64]) {
        self.inner.accept(memory);
    }
    fn undecided(&self) -> f64 {
        self.inner.undecided()
    }
    fn tangent(&mut self, slopes: &mut [f64]) {
        self.counts.differentiated.fetch_add(1, Ordering::Relaxed);
        self.inner.tangent(slopes);
    }
    fn read(&mut self, readings: &mut [f64], slopes: bool) {
        self.inner.read(readings, slopes);
    }
    fn found(&self, numbers: &mut Vec<f64>) {
        self.inner.found(numbers);
    }
    fn begin_at<'n>(&mut self, numbers: &'n [f64]) -> &'n [f64] {
        self.inner.begin_at(numbers)
    }
    fn cells(&self, quantity: usize, out: &mut [f64]) {
        self.inner.cells(quantity, out);
    }
    fn boxed(&self) -> Box<dyn FieldSolver> {
        Box::new(self.clone())
    }
}

fn films_on_cells() -> String {
    films().replace("Short(", "Film(around: 24, across: 4, ")
}

/// The start of a rotor whose films count, with a number of threads.
fn counted(program: &Program, threads: NonZeroUsize) -> (eng_runtime::Simulation, Arc<Counts>) {
    let analysis = program.analysis("begins").expect("an analysis");
    let builder = analysis.model().clone().threads(threads).simulation();
    let mut simulation = builder
        .start_from(Start::Assembled)
        .start()
        .expect("a start");
    let mut compiled = simulation.runtime().model().compiled.clone();
    let counts = Arc::new(Counts::default());
    compiled.fields = Arc::new(Counted {
        inner: Arc::clone(&compiled.fields),
        counts: Arc::clone(&counts),
    });
    let options = eng_runtime::Options {
        start: Start::QuasiStatic,
        ..eng_runtime::Options::default()
    };
    let begun = eng_runtime::Simulation::new(&compiled, &[], options);
    (begun.expect("a start"), counts)
}

/// Films of 432 cells are solved by as many threads as there are, up to one a film, and the number changes no
/// bit: of the start, of the steps, or of the outputs. Smaller films are not worth it.
#[test]
fn threads_share_films_and_change_no_bit() {
    let speed = 0.5 * CRITICAL;
    let large = films_on_cells().replace("around: 24, across: 4", "around: 48, across: 9");
    let of = |films: &str, threads: usize| {
        let program = checked_rotor(speed, "5 um", films, "1 ms", "quasi_static");
        let threads = NonZeroUsize::new(threads).expect("not zero");
        let (mut simulation, counts) = counted(&program, threads);
        for _ in 0..20 {
            simulation.step().expect("a step");
        }
        let used = counts.threads.lock().expect("no panic").len();
        // stiffness and damping are among the channels
        let mut channels = vec![
            0.0;
            program
                .analysis("begins")
                .expect("it")
                .model()
                .channels()
                .len()
        ];
        simulation
            .evaluate_channels(&mut channels)
            .expect("outputs");
        let bits: Vec<u64> = channels.iter().map(|x| x.to_bits()).collect();
        (used, simulation.checkpoint(), bits)
    };
    let (used, alone, outputs) = of(&large, 1);
    assert_eq!(used, 1);
    for threads in [2, 3] {
        let (used, shared, seen) = of(&large, threads);
        assert!(used > 1 && used <= threads, "{used} of {threads}");
        assert!(shared == alone && seen == outputs, "{threads} threads");
    }
    assert_eq!(of(&films_on_cells(), 2).0, 1);
}

/// The motion of an unbalance in films on cells repeats from the start, too: after a turn, and as after many
/// turns. Its search takes over matrices and cavities from step to step and from period to period, so that it
/// has few solutions.
#[test]
fn a_start_in_films_on_cells_is_short() {
    let (speed, turn) = (0.5 * CRITICAL, 4.0 * std::f64::consts::PI / CRITICAL);
    let run = |time: f64, start: &str| {
        let duration = format!("{time} s");
        rotor(speed, "5 um", &films_on_cells(), &duration, start)
    };
    let outcome = run(2.05 * turn, "quasi_static");
    followed(&outcome);
    for path in ["sag", "aside", "pin_sag", "pin_aside"] {
        let (times, values) = (column(&outcome, "time"), column(&outcome, path));
        let at = |time: f64| {
            let k = times
                .partition_point(|t| *t <= time)
                .clamp(1, times.len() - 1);
            let part = (time - times[k - 1]) / (times[k] - times[k - 1]);
            values[k - 1] + part * (values[k] - values[k - 1])
        };
        let swing = values.iter().fold(f64::NEG_INFINITY, |m, x| m.max(*x))
            - values.iter().fold(f64::INFINITY, |m, x| m.min(*x));
        let again = (0..100).fold(0.0_f64, |worst, k| {
            let time = turn * f64::from(k) / 100.0;
            worst.max((at(time + turn) - at(time)).abs() / swing)
        });
        println!("{path}: after a turn {again:.2e} of the swing");
        assert!(again < 1e-2, "{path}: {again}");
    }
    let program = checked_rotor(speed, "5 um", &films_on_cells(), "1 ms", "quasi_static");
    let (begun, counts) = counted(&program, NonZeroUsize::MIN);
    let StartReport::QuasiStatic(found) = begun.start() else {
        panic!("{:?}", begun.start());
    };
    let Some(Turning::Followed { periods, .. }) = found.turning else {
        panic!("{found:?}");
    };
    let steps = (180 * periods * 2) as f64;
    let [solved, differentiated] =
        [&counts.solved, &counts.differentiated].map(|count| count.load(Ordering::Relaxed) as f64);
    println!(
        "{periods} periods: {:.2} solutions and {:.2} tangents a step and film",
        solved / steps,
        differentiated / steps
    );
    // a new matrix at each step and steps to rounding took 6.3 and 1.1
    assert!(solved < 3.5 * steps && differentiated < 0.5 * steps);
}

/// A disc of 4 kg at the end of a shaft of 0.5 m, which overhangs its second bearing by 0.1 m.
fn overhung(speed: f64, offset: f64, bearings: &str, analysis: &str) -> Outcome {
    let text = format!(
        "use std.joints.{{Fixed, PointOnPlane, PointOnLine}}
         use std.drives.PrescribedRotation
         force Pad(a: Marker, b: Marker, kx: Stiffness, ky: Stiffness, cx: Damping, cy: Damping) {{
             let e = local(a.origin - b.origin, b)
             let v = der(e)
             apply force vector([-kx*e.x - cx*v.x, -ky*e.y - cy*v.y, 0 N], b) on a against b
         }}
         model Rotor {{
             gravity = [0, -9.81, 0] m/s^2
             marker left = [0, 0, 0] m
             marker right = [0, 0, 0.4] m
             flexible shaft {{
                 mesh = nastran(\"shaft.bdf\", units: m_kg_s)
                 modes = static(at: [left, right, tip], freedoms: [x, y]) + static(at: tip, freedoms: [rx, ry]) + normal(12)
                 damping = 0 %
                 geometric_stiffness = true
                 marker left = node(1)
                 marker right = node(9)
                 marker tip = node(11)
                 start angular_velocity = [0, 0, {speed}] rad/s
             }}
             body disc {{
                 mass = 4 kg
                 inertia = [0.02, 0.02, 0.036] kg*m^2
                 center_of_mass = [{offset}, 0, 0] m
                 marker hub = [0, 0, 0] m
             }}
             joint press = Fixed(disc.hub, shaft.tip)
             {bearings}
             joint thrust = PointOnPlane(shaft.left, left)
             drive turn = PrescribedRotation(shaft.left, left, speed: {speed} rad/s) {{ accept fast }}
             output x: Length = dot(shaft.tip.origin, ground.x)
             output y: Length = dot(shaft.tip.origin, ground.y)
         }}
         analysis begins = transient(Rotor(), duration: 0.1 ms, sample: 0.1 ms, start: quasi_static)
         analysis whirls = linear(Rotor(), over: 1 rev, number: 6)"
    );
    let diameter: f64 = 0.03;
    let area = 0.25 * std::f64::consts::PI * diameter.powi(2);
    let moment = std::f64::consts::PI * diameter.powi(4) / 64.0;
    let deck = beam(0.5, 10, area, moment);
    let program = program_of(&[("rotor.eng", &text), ("shaft.bdf", &deck)]);
    outcome(&program, analysis)
}

/// Two bearings with stiffness (N/m) and damping (N s/m) along x and y.
fn pads(kx: f64, ky: f64, cx: f64, cy: f64) -> String {
    ["left", "right"]
        .map(|end| {
            format!(
                "force on_{end} = Pad(shaft.{end}, {end}, kx: {kx} N/m, ky: {ky} N/m, cx: {cx} N*s/m, cy: {cy} N*s/m)\n"
            )
        })
        .concat()
}

/// Stable rotors without a resonance, for which the equations of all angles take hundreds of products: the place of
/// the disc at the start against the response `(K − Ω²M + iΩ(C + G))⁻¹ F` of a model of the same ten beams (Euler's,
/// with rotary inertia) and disc, in space, with its sag (µm).
#[test]
fn rotors_between_their_critical_speeds_begin_in_their_motion() {
    let round = pads(4e6, 4e6, 300.0, 300.0);
    let unequal = pads(4e6, 1.5e6, 300.0, 900.0);
    let rigid = "joint one = PointOnLine(shaft.left, left)
                 joint two = PointOnLine(shaft.right, right)";
    let cases = [
        (
            300.0,
            50e-6,
            round.as_str(),
            [13.930_890, -27.508_525],
            2e-3,
        ),
        (500.0, 50e-6, &round, [77.051_348, -32.738_310], 2e-3),
        (500.0, 50e-6, &unequal, [160.416_355, -73.941_012], 2e-3),
        (-500.0, 50e-6, &unequal, [160.416_355, -49.248_350], 2e-3),
        // the rotary inertia of the shaft's own beams, which models differ in, makes up 0.4 %
        (1800.0, 5e-6, rigid, [-11.496_155, -6.610_208], 1e-2),
        (2200.0, 5e-6, rigid, [-7.650_195, -6.610_208], 1e-2),
    ];
    for (speed, offset, bearings, due, within) in cases {
        let outcome = overhung(speed, offset, bearings, "begins");
        let Some(StartReport::QuasiStatic(found)) = &outcome.start else {
            panic!("{speed}: {:?}", outcome.start);
        };
        assert!(
            matches!(found.turning, Some(Turning::Repeating { change, .. }) if change < 1e-5),
            "{speed}: {found:?}"
        );
        let [x, y] = ["x", "y"].map(|path| 1e6 * column(&outcome, path)[0]);
        let off = (x - due[0]).hypot(y - due[1]) / due[0].hypot(due[1]);
        println!("{speed} rad/s: {x:.4} {y:.4} µm, off by {off:.1e}");
        assert!(off < within, "{speed}: {x} {y}, due {due:?}");
    }
}

/// Modes about the motion that such a start begins, against the eigenvalues of the same model in space; the
/// torsion that nothing damps does not grow.
#[test]
fn an_overhung_rotor_whirls_as_its_beams_do() {
    let bearings = pads(4e6, 1.5e6, 300.0, 900.0);
    let cases = [
        (500.0, [[-36.743, 392.600], [-13.862, 570.696]]),
        (1500.0, [[-17.244, 333.070], [-43.872, 548.738]]),
    ];
    for (speed, due) in cases {
        let outcome = overhung(speed, 50e-6, &bearings, "whirls");
        let modes = outcome.modes.expect("modes");
        for [re, im] in due {
            let off = |mode: &eng::Mode| (mode.value.re - re).hypot(mode.value.im - im) / im;
            let nearest = modes.modes.iter().map(off).fold(f64::INFINITY, f64::min);
            println!("{speed} rad/s: {re} + {im}i off by {nearest:.1e}");
            assert!(nearest < 1e-3, "{speed}: {re} + {im}i: {nearest}");
        }
        assert!(modes.modes.iter().all(|mode| !mode.grows()), "{modes:?}");
    }
}
