//! Kernels of the fields that a text can name: oil films by `eng-film`.

use eng_film::inputs::{ECCENTRICITY, FORCE, RATE};
use eng_film::{Cavitation, Ends, Feed, Film, FilmSource, Lines, Opening, Profile, Work};
use eng_system::field::{FieldError, FieldKernel, FieldMaker, FieldNumbers, FieldSolver, KERNELS};
use std::sync::Arc;

/// Gap, as a share of the radial clearance, below which a film continues for the iterates of a solver. The laws
/// without a field continue at the same eccentricity ratio.
const FLOOR: f64 = 1e-3;

/// Makes the kernels of this program.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Fields;

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
    let cavitation = match numbers.word("cavitation") {
        "half" => Cavitation::Half,
        _ => Cavitation::Reynolds,
    };
    let edges = ["opening_from", "opening_to", "opening_low", "opening_high"];
    let edges = edges.map(|name| numbers.list(name));
    let openings = (0..numbers.source.openings as usize).map(|at| {
        let edge = |side: usize| edges[side].get(at).copied().unwrap_or(f64::NAN);
        Opening {
            around: [edge(0), edge(1)],
            across: [edge(2), edge(3)],
            feed: Feed::Pressure,
        }
    });
    let source = FilmSource {
        radius: numbers.number("diameter") / 2.0,
        width: numbers.number("width"),
        clearance,
        cavitation,
        ends: Ends::Open,
        openings: openings.collect(),
        profile: profile(numbers),
        pin_profile: Vec::new(),
        shapes: Vec::new(),
        floor: FLOOR * clearance,
        piezo: numbers.number("piezo"),
        around: Lines::Equal(numbers.whole("around") as usize),
        across: Lines::Equal(numbers.whole("across") as usize),
        half_width: false,
    };
    let film = Film::new(source).map_err(|error| FieldError(error.to_string()))?;
    Ok(Arc::new(Bearing(Arc::new(film))))
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

/// A film without memory.
#[derive(Debug)]
struct Bearing(Arc<Film>);

impl FieldKernel for Bearing {
    fn solver(&self) -> Box<dyn FieldSolver> {
        let film = &self.0;
        Box::new(Solver {
            work: film.work(),
            slopes: vec![0.0; film.outputs() * film.inputs()],
            film: Arc::clone(film),
        })
    }
}

#[derive(Clone, Debug)]
struct Solver {
    film: Arc<Film>,
    work: Work,
    slopes: Vec<f64>,
}

impl FieldSolver for Solver {
    fn solve(&mut self, drives: &[f64], answers: &mut [f64]) -> Result<(), FieldError> {
        let Solver { film, work, .. } = self;
        let solved = film.solve(drives, None, &[], work, answers);
        solved.map_err(|error| FieldError(error.to_string()))
    }

    fn tangent(&mut self, slopes: &mut [f64]) {
        self.film.tangent(&mut self.work, slopes);
    }

    fn read(&mut self, readings: &mut [f64], slopes: bool) {
        let summary = self.film.summary(&self.work);
        let (thin, high) = (summary.minimum_gap_at, summary.maximum_pressure_at);
        let numbers = [
            summary.minimum_gap,
            thin.angle,
            thin.across,
            summary.maximum_pressure,
            high.angle,
            high.across,
            summary.outflow,
            summary.supply_flow.iter().sum(),
            summary.shear_power,
            summary.pressure_power,
            summary.cavitated,
        ];
        for (place, number) in readings.iter_mut().zip(numbers) {
            *place = number;
        }
        if !slopes {
            return;
        }
        self.film.tangent(&mut self.work, &mut self.slopes);
        let inputs = self.film.inputs();
        // a force that falls with the displacement is a stiffness
        let slope = |force: usize, input: usize| -self.slopes[(FORCE + force) * inputs + input];
        let matrices = [ECCENTRICITY, RATE].into_iter().flat_map(|input| {
            [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(force, along)| slope(force, input + along))
        });
        for (place, number) in readings[numbers.len()..].iter_mut().zip(matrices) {
            *place = number;
        }
    }

    fn boxed(&self) -> Box<dyn FieldSolver> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eng_film::Inputs;
    use eng_system::field::{Kernel, drives};
    use eng_system::system::FieldSource;

    /// The drives of the table are the inputs of a film, and its answers the outputs, in the same order.
    #[test]
    fn the_table_and_the_film_agree() {
        let kernel = Kernel::named("reynolds").unwrap();
        let source = FieldSource {
            kernel: 0,
            openings: 1,
            settings: Vec::new(),
            wholes: vec![("around", 36), ("across", 7)],
            words: vec![("cavitation", "reynolds")],
        };
        let setting = |name, value: f64| (name, vec![value]);
        let numbers = FieldNumbers {
            source: &source,
            settings: vec![
                setting("diameter", 54e-3),
                setting("width", 24e-3),
                setting("radial_clearance", 27e-6),
                setting("opening_from", 3.0),
                setting("opening_to", 3.4),
                setting("opening_low", -5e-3),
                setting("opening_high", 5e-3),
            ],
        };
        let count: u32 = drives(kernel, 1).map(|(_, count)| count).sum();
        let inputs = Inputs {
            eccentricity: [15e-6, 4e-6],
            rate: [1e-3, -2e-3],
            spin: 400.0,
            supply: &[4e5],
            ..Inputs::still(8e-3)
        };
        let x = inputs.write();
        assert_eq!(x.len(), count as usize);
        let mut solver = Fields.make(&numbers).unwrap().solver();
        let mut answers = vec![0.0; kernel.answer_count() as usize];
        solver.solve(&x, &mut answers).unwrap();
        let mut readings = vec![f64::NAN; kernel.reading_count() as usize];
        solver.read(&mut readings, true);
        assert!(readings.iter().all(|number| number.is_finite()));
        // the thinnest gap lies towards e, and the shaft needs power
        let thinnest = 27e-6 - 15e-6_f64.hypot(4e-6);
        assert!((readings[0] - thinnest).abs() < 1e-12, "{}", readings[0]);
        assert!((readings[1] - 4.0_f64.atan2(15.0)).abs() < 1e-12);
        let power = kernel.result("shear_power").unwrap().1 as usize;
        assert!(readings[power] > 0.0);
        // stiffness and damping are differences of the force
        let step = 1e-9;
        for (first, input) in [("stiffness", 0), ("damping", 2)] {
            let at = kernel.result(first).unwrap().1 as usize;
            let mut at_end = |moved: f64| {
                let mut moved_inputs = x.clone();
                moved_inputs[input] += moved;
                let mut after = answers.clone();
                solver.solve(&moved_inputs, &mut after).unwrap();
                after
            };
            let (up, down) = (at_end(step), at_end(-step));
            for force in 0..2 {
                let slope = -(up[force] - down[force]) / (2.0 * step);
                let found = readings[at + 2 * force];
                assert!(
                    (found - slope).abs() < 1e-4 * slope.abs(),
                    "{found} {slope}"
                );
            }
        }
    }
}
