//! Kernels of the fields that a text can name: oil films by `eng-film`.

use eng_film::{
    Beside, Cavitation, EdgeSlope, Elastic, ElasticRing, ElasticWork, Ends, Feed, Film, FilmSource,
    Lines, Opening, Part, Profile, Quantity, Roughness, Shape, Thinning, inputs,
};
use eng_system::field::{
    Accuracy, FILM_CELLS, FieldError, FieldGrid, FieldKernel, FieldMaker, FieldNumbers,
    FieldSolver, KERNELS, Past,
};
use eng_system::reduced::ReducedSurface;
use eng_system::significant::short;
use std::sync::Arc;

/// Floor of the gap, as a share of the radial clearance. A film with less gap is continued, so that it has a
/// solution at every iterate of a solver. A choice: surfaces touch before, and the laws without a field continue
/// at the same eccentricity ratio.
const FLOOR: f64 = 1e-3;

/// Share of its radius by which the surface of a body may be larger than its film: a thin shell may lie
/// between them. A choice: shells are 2 to 4 mm thick in bores of 50 mm and more.
const SHELL: f64 = 0.15;

/// Share by which it may be smaller: the tolerance of the nodes of a ring.
const SMALLER: f64 = 1e-3;

/// Narrowest land, in clearances h. A film takes the resistance of a land L to be that of Poiseuille's flow, 12 μ L/h³. Its two
/// mouths add 32 μ/(π h²) (H. Hasimoto, J. Phys. Soc. Japan 13 (1958) 633), which is 8.5 % at L = 10 h.
const LAND: f64 = 10.0;

/// Fewest cells that a wave of an elastic surface must have. A choice: with two, a sine and a cosine of it
/// may be zero in the middle of all cells.
const CELLS_A_WAVE: i64 = 3;

/// Makes the kernels of this program.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fields;

impl FieldMaker for Fields {
    fn make(&self, numbers: &FieldNumbers<'_>) -> Result<Arc<dyn FieldKernel>, FieldError> {
        let kernel = KERNELS.get(numbers.source.kernel as usize);
        match kernel.map_or("?", |kernel| kernel.name) {
            "reynolds" => film(numbers),
            other => Err(FieldError(format!("this program has no kernel `{other}`"))),
        }
    }
}

/// The oil film of a bearing with these numbers.
fn film(numbers: &FieldNumbers<'_>) -> Result<Arc<dyn FieldKernel>, FieldError> {
    let clearance = numbers.number("radial_clearance");
    let width = numbers.number("width");
    let surface = numbers.surface;
    if let Some(surface) = surface {
        fits_surface(numbers, surface)?;
    }
    let cavitation = match numbers.word("cavitation") {
        "half" => Cavitation::Half,
        "mass_conserving" => Cavitation::MassConserving,
        _ => Cavitation::Reynolds,
    };
    let edges = ["opening_from", "opening_to", "opening_low", "opening_high"];
    let edges = edges.map(|name| numbers.list(name));
    for content in numbers.list("opening_content") {
        if *content > 1.0 {
            return Err(FieldError(format!(
                "an opening has a content of {content}: it is a share of the gap, 1 at most"
            )));
        }
        if *content < 1.0 && cavitation != Cavitation::MassConserving {
            return Err(FieldError(
                "an opening whose content is below 1 needs the rule `mass_conserving`: the other rules have no content"
                    .into(),
            ));
        }
    }
    let openings = (0..numbers.source.openings as usize).map(|at| {
        let edge = |side: usize| edges[side].get(at).copied().unwrap_or(f64::NAN);
        Opening {
            around: [edge(0), edge(1)],
            across: [edge(2), edge(3)],
            feed: match numbers.list("opening_content").get(at) {
                Some(content) if *content < 1.0 => Feed::Content(*content),
                _ => Feed::Pressure,
            },
            on: match numbers.list("opening_on_pin").get(at) {
                Some(on_pin) if *on_pin != 0.0 => Part::Pin,
                _ => Part::Shell,
            },
        }
    });
    let source = FilmSource {
        radius: numbers.number("diameter") / 2.0,
        width,
        clearance,
        cavitation,
        ends: Ends::Open,
        openings: openings.collect(),
        profile: profile(numbers),
        pin_profile: Vec::new(),
        shapes: match surface {
            Some(surface) => surface.shapes.each().collect(),
            None => waves(numbers.whole("ring_waves")),
        },
        shape_width: surface.map_or(width, |surface| surface.width),
        floor: FLOOR * clearance,
        piezo: numbers.number("piezo"),
        rough: rough(numbers),
        thinning: thinning(numbers),
        edges: EdgeSlope::TwoCells,
        around: Lines::Equal(numbers.whole("around") as usize),
        across: Lines::Equal(numbers.whole("across") as usize),
        half_width: false,
    };
    resolves_shapes(&source.shapes, numbers)?;
    has_lands(&source)?;
    let corners = source.corners();
    let film = Film::new(source).map_err(|error| FieldError(error.to_string()))?;
    nothing_ignored(numbers)?;
    let elastic = match surface {
        Some(surface) => Elastic::carried(
            film,
            surface.compliance.clone(),
            surface.static_compliance.clone(),
        ),
        None => {
            let compliance = ring(&film, numbers)?;
            Elastic::new(film, compliance)
        }
    };
    let elastic = elastic.map_err(|error| FieldError(error.to_string()))?;
    Ok(Arc::new(Bearing {
        film: Arc::new(elastic),
        corners,
    }))
}

/// Refuses lands on which Reynolds' equation does not hold.
fn has_lands(source: &FilmSource) -> Result<(), FieldError> {
    let Some((land, at, beside)) = source.narrowest_land() else {
        return Ok(());
    };
    if land >= LAND * source.clearance {
        return Ok(());
    }
    let (between, remedy) = match beside {
        Beside::End => (
            format!("opening {} and the end", at + 1),
            "let the opening end farther inside, or reach over the end with the pressure of the end",
        ),
        Beside::Opening(other) => (
            format!("openings {} and {}", other + 1, at + 1),
            "move one of them, or join both",
        ),
    };
    Err(FieldError(format!(
        "the land between {between} of a film is {} mm wide, but Reynolds' equation holds for lands of {LAND} clearances or more, \
         here {} mm: {remedy}",
        short(1e3 * land, 4),
        short(1e3 * LAND * source.clearance, 4)
    )))
}

/// Refuses a corner of an opening with another pressure beside it: the flow there has no limit.
fn corners_have_one_pressure(
    source: &FilmSource,
    corners: &[(usize, Beside)],
    drives: &[f64],
) -> Result<(), FieldError> {
    let pressure = |opening: usize| match source.openings[opening].feed {
        Feed::Pressure => drives[inputs::SUPPLY + opening],
        Feed::Content(_) => 0.0,
    };
    for (at, beside) in corners {
        let own = pressure(*at);
        let other = match beside {
            Beside::End => drives[inputs::END_PRESSURE],
            Beside::Opening(other) => pressure(*other),
        };
        // the same pressure in two units differs by rounding
        if (own - other).abs() <= 1e-9 * own.abs().max(other.abs()) {
            continue;
        }
        let [own, other] = [own, other].map(|pressure| short(pressure / 1e5, 4));
        return Err(FieldError(match beside {
            Beside::End => format!(
                "opening {} of a film reaches an open end with {own} bar, and the end has {other} bar: the flow at its corners has \
                 no limit. Let it end inside the bearing, or state `pressure: {other} bar` for it",
                at + 1
            ),
            Beside::Opening(second) => format!(
                "openings {} and {} of a film touch, with {other} bar and {own} bar: the flow at their corner has no limit. Leave a \
                 land between them, or state one pressure for both",
                second + 1,
                at + 1
            ),
        }));
    }
    Ok(())
}

/// Refuses cells that cannot follow the shapes of a surface.
fn resolves_shapes(shapes: &[Shape], numbers: &FieldNumbers<'_>) -> Result<(), FieldError> {
    let most = |of: fn(&Shape) -> u32| i64::from(shapes.iter().map(of).max().unwrap_or(0));
    let least = [
        ("around", CELLS_A_WAVE * most(|shape| shape.around)),
        ("across", most(|shape| shape.across) + 1),
    ];
    for (name, least) in least {
        let cells = numbers.whole(name);
        if !shapes.is_empty() && cells < least {
            return Err(FieldError(format!(
                "{cells} cells {name} cannot follow the shapes of the elastic surface: take {least} or more"
            )));
        }
    }
    Ok(())
}

/// Refuses a film that is no film of the surface: of another radius, or wider.
fn fits_surface(numbers: &FieldNumbers<'_>, surface: &ReducedSurface) -> Result<(), FieldError> {
    let (radius, width) = (numbers.number("diameter") / 2.0, numbers.number("width"));
    if numbers.whole("ring_waves") > 0 {
        return Err(FieldError(
            "the surface of the shell's marker yields, and an elastic ring is stated too: state one of them".into(),
        ));
    }
    let mm = |length: f64| short(1e3 * length, 4);
    let larger = surface.radius / radius - 1.0;
    if !(-SMALLER..=SHELL).contains(&larger) {
        return Err(FieldError(format!(
            "the film has a radius of {} mm, and the surface of its shell one of {} mm: the surface is that of the film, or up to \
             {} % larger, because a thin shell may lie between them",
            mm(radius),
            mm(surface.radius),
            100.0 * SHELL
        )));
    }
    // the same width in two units differs by rounding
    if width > surface.width * (1.0 + 1e-9) {
        return Err(FieldError(format!(
            "the film is {} mm wide, and the surface of its shell {} mm: it would press beside the surface",
            mm(width),
            mm(surface.width)
        )));
    }
    Ok(())
}

/// Refuses numbers of rough surfaces and of thinning oil that have no effect, because the number that begins
/// the effect is missing.
fn nothing_ignored(numbers: &FieldNumbers<'_>) -> Result<(), FieldError> {
    let number = |name: &str| numbers.number(name);
    let rough = ["asperity", "asperity_modulus", "boundary_friction"];
    if number("roughness") == 0.0 && rough.iter().any(|name| number(name) != 0.0) {
        return Err(FieldError(
            "asperities of surfaces without roughness carry nothing: state the `sigma` of the roughness".into(),
        ));
    }
    if (number("asperity") != 0.0) != (number("asperity_modulus") != 0.0) {
        return Err(FieldError(
            "asperities carry `asperity` times `modulus`: state both of them, or none for surfaces that only change the flow".into(),
        ));
    }
    if number("boundary_friction") != 0.0 && number("asperity") == 0.0 {
        return Err(FieldError(
            "the `boundary_friction` of asperities that carry nothing has no effect: state `asperity` and `modulus`".into(),
        ));
    }
    let reach = number("relief_reach");
    if number("relief") != 0.0 && !(reach > 0.0 && reach <= std::f64::consts::PI) {
        return Err(FieldError(format!(
            "the relief of the shell reaches {} deg to both sides: it must be above 0, and 180 deg at most",
            reach.to_degrees()
        )));
    }
    if number("thin_rate") != 0.0 && number("thin_second") == 1.0 {
        return Err(FieldError(
            "oil that keeps all of its viscosity does not thin: state the share `second` that is left at high rates".into(),
        ));
    }
    if number("thin_rate") == 0.0 && ![0.0, 1.0].contains(&number("thin_second")) {
        return Err(FieldError(
            "oil without a shear `rate` does not thin: state the rate at which half of the loss has happened".into(),
        ));
    }
    Ok(())
}

/// The waves of a ring, which do not change across it: the uniform one, and a cosine and a sine for each number of waves from
/// two on.
fn waves(most: i64) -> Vec<Shape> {
    let shape = |around, sine| Shape {
        around,
        sine,
        across: 0,
    };
    let most = u32::try_from(most).unwrap_or(0);
    if most == 0 {
        return Vec::new();
    }
    let pairs = (2..=most).flat_map(|k| [shape(k, false), shape(k, true)]);
    std::iter::once(shape(0, false)).chain(pairs).collect()
}

/// Compliance of the ring around the film.
fn ring(film: &Film, numbers: &FieldNumbers<'_>) -> Result<Vec<f64>, FieldError> {
    let number = |name: &str| numbers.number(name);
    let [thickness, width, modulus] = ["ring_thickness", "ring_width", "ring_modulus"].map(number);
    if film.source().shapes.is_empty() {
        return Ok(Vec::new());
    }
    for (name, value, unit, size) in [
        ("thickness", thickness, "mm", 1e-3),
        ("width", width, "mm", 1e-3),
        ("modulus", modulus, "GPa", 1e9),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(FieldError(format!(
                "the {name} of the elastic ring is {} {unit}: a ring with waves needs a positive one",
                value / size
            )));
        }
    }
    let ring = ElasticRing {
        thickness,
        width,
        modulus,
        poisson: number("ring_poisson"),
    };
    if !(0.0..=0.5).contains(&ring.poisson) {
        return Err(FieldError(format!(
            "Poisson's ratio of the elastic ring is {}: it must be 0 to 0.5",
            ring.poisson
        )));
    }
    Ok(ring.compliance(film))
}

/// The roughness, if the surfaces have one.
fn rough(numbers: &FieldNumbers<'_>) -> Option<Roughness> {
    let deviation = numbers.number("roughness");
    (deviation != 0.0).then(|| Roughness {
        deviation,
        direction: numbers.number("rough_direction"),
        asperity: numbers.number("asperity"),
        modulus: numbers.number("asperity_modulus"),
        friction: numbers.number("boundary_friction"),
    })
}

/// The thinning of the oil. Without a shear rate the viscosity does not depend on it.
fn thinning(numbers: &FieldNumbers<'_>) -> Option<Thinning> {
    let rate = numbers.number("thin_rate");
    (rate != 0.0).then(|| Thinning {
        second: numbers.number("thin_second"),
        rate,
        exponent: numbers.number("thin_exponent"),
    })
}

/// The stated changes of the gap. Those of depth zero are left out.
fn profile(numbers: &FieldNumbers<'_>) -> Vec<Profile> {
    let number = |name: &str| numbers.number(name);
    let all = [
        Profile::Lemon {
            depth: number("lemon"),
            at: number("lemon_at"),
        },
        Profile::Offset {
            distance: number("offset"),
            at: number("offset_at"),
        },
        Profile::Barrel {
            depth: number("barrel"),
        },
        Profile::Taper {
            depth: number("taper"),
        },
        Profile::Relief {
            depth: number("relief"),
            around: number("relief_reach"),
            at: number("relief_at"),
        },
    ];
    let depth = |profile: &Profile| match *profile {
        Profile::Lemon { depth, .. }
        | Profile::Offset {
            distance: depth, ..
        }
        | Profile::Barrel { depth }
        | Profile::Taper { depth }
        | Profile::Relief { depth, .. } => depth,
    };
    all.into_iter().filter(|part| depth(part) != 0.0).collect()
}

/// Numbers of a field's memory after those of its film.
#[derive(Clone, Copy, Debug, Default)]
struct Oil {
    /// Volume of oil (m³).
    volume: f64,
    /// Oil from all openings since the pin came to its present cell (m³), and the time since then (s).
    fed: f64,
    time: f64,
    /// The present cell: turns of the pin in widths of a cell.
    cell: f64,
    /// Mean flow from the openings while the pin passed the last cell (m³/s).
    flow: f64,
}

impl Oil {
    /// Numbers of an oil in the memory of a field.
    const COUNT: usize = 5;

    fn read(numbers: &[f64]) -> Option<Oil> {
        match *numbers {
            [volume, fed, time, cell, flow] => Some(Oil {
                volume,
                fed,
                time,
                cell,
                flow,
            }),
            _ => None,
        }
    }

    fn write(&self, numbers: &mut [f64]) {
        numbers.copy_from_slice(&[self.volume, self.fed, self.time, self.cell, self.flow]);
    }
}

/// A film as a field.
#[derive(Debug)]
struct Bearing {
    film: Arc<Elastic>,
    /// Places at which two pressures would meet.
    corners: Vec<(usize, Beside)>,
}

impl FieldKernel for Bearing {
    fn solver(&self, differentiated: &[bool]) -> Box<dyn FieldSolver> {
        let film = &self.film;
        // the answers of the row are the outputs before the forces of shapes
        let read = |answer: usize| differentiated.get(answer).is_none_or(|read| *read);
        Box::new(Solver {
            work: film.work_for(&std::array::from_fn(read)),
            past: None,
            turn: 0.0,
            supply: Vec::new(),
            film: Arc::clone(film),
            corners: self.corners.clone(),
        })
    }

    fn memory(&self) -> usize {
        match self.film.memory() {
            0 => 0,
            own => own + Oil::COUNT,
        }
    }

    fn shapes(&self) -> usize {
        self.film.carried_shapes()
    }

    fn yields(&self) -> bool {
        let source = self.film.film().source();
        !source.shapes.is_empty() || source.rough.is_some()
    }

    fn grid(&self) -> FieldGrid {
        let film = self.film.film();
        let [around, across] = film.lines().map(<[f64]>::to_vec);
        // those of the pin move over the grid
        let openings = film.source().openings.iter();
        let openings = openings.filter(|opening| opening.on == Part::Shell);
        FieldGrid {
            radius: film.source().radius,
            around,
            across,
            openings: openings.map(|o| [o.around, o.across]).collect(),
        }
    }

    fn refined(&self) -> Result<Arc<dyn FieldKernel>, FieldError> {
        let film = self.film.film();
        let on_pin = |opening: &Opening| opening.on == Part::Pin;
        let reason = match self.memory() > 0 {
            true if film.source().cavitation == Cavitation::MassConserving => {
                "the film keeps its oil from step to step"
            }
            true => "the film keeps the shape of its elastic surface from step to step",
            false if film.source().openings.iter().any(on_pin) => {
                "the openings of the pin lie over other cells at each moment"
            }
            false => "",
        };
        if !reason.is_empty() {
            return Err(FieldError(reason.to_owned()));
        }
        let mut source = film.source().clone();
        let [around, across] = film.cells();
        source.around = Lines::Equal(2 * around);
        source.across = Lines::Equal(2 * across);
        let finer = Film::new(source).and_then(|finer| Elastic::new(finer, Vec::new()));
        let finer = finer.map_err(|error| FieldError(error.to_string()))?;
        Ok(Arc::new(Bearing {
            film: Arc::new(finer),
            corners: self.corners.clone(),
        }))
    }
}

#[derive(Clone, Debug)]
struct Solver {
    film: Arc<Elastic>,
    corners: Vec<(usize, Beside)>,
    work: ElasticWork,
    /// The oil at the past, and the time since then (s); none for a film in balance.
    past: Option<(Oil, f64)>,
    /// Turn of the pin (rad).
    turn: f64,
    /// Memory for the flows of the openings.
    supply: Vec<f64>,
}

impl Solver {
    /// The oil at the end of the step.
    fn oil(&self) -> Oil {
        let (film, work) = (self.film.film(), &self.work.film);
        let (volume, flow) = (film.volume(work), film.supplied(work));
        let turn = self.turn * film.cells()[0] as f64 / std::f64::consts::TAU;
        let begun = Oil {
            volume,
            cell: turn.floor(),
            flow,
            ..Oil::default()
        };
        let Some((before, step)) = self.past else {
            return begun;
        };
        let (fed, time) = (before.fed + flow * step, before.time + step);
        if begun.cell == before.cell {
            return Oil {
                volume,
                fed,
                time,
                ..before
            };
        }
        Oil {
            flow: fed / time,
            ..begun
        }
    }

    /// Flow from all openings (m³/s). An opening of the pin fills the cells of a cavity in bursts, one for each cell that
    /// it reaches. Their samples have a wrong mean, so the flow is the mean of the last cell.
    fn supply_flow(&self, now: f64) -> f64 {
        let openings = &self.film.film().source().openings;
        match self.past {
            Some((oil, _)) if openings.iter().any(|opening| opening.on == Part::Pin) => oil.flow,
            _ => now,
        }
    }

    /// Rate at which the volume of oil changes without any flow (m³/s), by the error of the step.
    fn unexplained_flow(&self) -> f64 {
        let (film, work) = (self.film.film(), &self.work.film);
        self.past.map_or(0.0, |(before, step)| {
            (film.volume(work) - before.volume) / step - film.gathering(work)
        })
    }
}

impl FieldSolver for Solver {
    fn solve(
        &mut self,
        drives: &[f64],
        past: Option<Past<'_>>,
        accuracy: Accuracy,
        answers: &mut [f64],
    ) -> Result<(), FieldError> {
        let own = self.film.memory();
        self.past = past.and_then(|past| Some((Oil::read(&past.memory[own..])?, past.step)));
        let Solver { film, work, .. } = self;
        corners_have_one_pressure(film.film().source(), &self.corners, drives)?;
        self.turn = drives[inputs::TURN];
        let (step, memory) = match past {
            Some(past) => (Some(past.step), &past.memory[..own]),
            None => (None, &[][..]),
        };
        let solved = film.solve(drives, step, memory, accuracy, work, answers);
        solved.map_err(|error| FieldError(error.to_string()))
    }

    fn accept(&self, memory: &mut [f64]) {
        let (own, oil) = memory.split_at_mut(self.film.memory());
        self.film.accept(&self.work, own);
        if !oil.is_empty() {
            self.oil().write(oil);
        }
    }

    fn undecided(&self) -> f64 {
        self.film.film().undecided(&self.work.film)
    }

    fn tangent(&mut self, slopes: &mut [f64]) {
        if self.film.tangent(&mut self.work, slopes).is_err() {
            slopes.fill(f64::NAN);
        }
    }

    fn read(&mut self, readings: &mut [f64], slopes: bool) {
        let supply = std::mem::take(&mut self.supply);
        let summary = self.film.film().summary_in(&self.work.film, supply);
        let (thin, high) = (summary.minimum_gap_at, summary.maximum_pressure_at);
        let numbers = [
            summary.minimum_gap,
            thin.angle,
            thin.across,
            summary.maximum_pressure,
            high.angle,
            high.across,
            summary.inflow,
            self.supply_flow(summary.supply_flow.iter().sum()),
            summary.shear_power,
            summary.pressure_power,
            summary.asperity_share,
            summary.asperity_pressure,
            summary.boundary_power,
            self.film.deflection(&self.work),
            self.film.last_waves(&self.work),
            self.film.last_degrees(&self.work),
            summary.cavitated,
            summary.content,
            self.unexplained_flow(),
        ];
        for (place, number) in readings.iter_mut().zip(numbers) {
            *place = number;
        }
        self.supply = summary.supply_flow;
        if !slopes {
            return;
        }
        let slow = self.film.stiffness_and_damping(&mut self.work);
        let slow = slow.unwrap_or([f64::NAN; 8]);
        for (place, number) in readings[numbers.len()..].iter_mut().zip(slow) {
            *place = number;
        }
    }

    fn found(&self, numbers: &mut Vec<f64>) {
        self.film.film().cavity(&self.work.film, numbers);
    }

    fn begin_at<'n>(&mut self, numbers: &'n [f64]) -> &'n [f64] {
        self.film.film().begin_at(&mut self.work.film, numbers)
    }

    fn kept(&self, numbers: &mut Vec<f64>) {
        self.film.kept(&self.work, numbers);
    }

    fn keep<'n>(&mut self, numbers: &'n [f64]) -> &'n [f64] {
        self.film.keep(&mut self.work, numbers)
    }

    fn cells(&self, quantity: usize, out: &mut [f64]) {
        let which = match FILM_CELLS.get(quantity).map_or("", |known| known.name) {
            "gap" => Quantity::Gap,
            "content" => Quantity::Content,
            "asperity_pressure" => Quantity::Asperities,
            _ => Quantity::Pressure,
        };
        self.film.film().field(which, &self.work.film, out);
    }

    fn boxed(&self) -> Box<dyn FieldSolver> {
        Box::new(self.clone())
    }
}
