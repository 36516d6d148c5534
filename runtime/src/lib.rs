//! Eng's runtime: state on the manifold, kinematic chain, assembly, integration, outputs.
//!
//! It works on a [`eng_system::code::Compiled`] model. It has no syntax, looks up no names, opens no files
//! and prints nothing. It returns numbers, and errors with the path and the place of their subject. It holds
//! no global state, and the same input gives the same bits for any number of threads.

#![forbid(unsafe_code)]
#![deny(clippy::disallowed_methods)]
// no input may end the library in a panic
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreachable,
    clippy::todo
)]
// A loop over one index of several arrays reads like its formula.
#![allow(clippy::needless_range_loop)]

mod acceleration;
mod assembled;
pub mod assembly;
pub mod body;
pub mod chain;
mod checkpoint;
mod control;
mod decay;
pub mod dynamics;
mod elements;
mod equilibrium;
pub mod error;
mod field;
pub mod flexible;
mod frame;
pub mod inputs;
pub mod integrator;
pub mod joint;
mod kinematic;
mod kinks;
pub mod linear;
pub mod linearised;
pub mod loose;
mod memory;
pub mod model;
mod outputs;
mod periodic;
pub mod rotation;
pub mod shape;
mod simulation;
mod singular;
pub mod start;
pub mod state;
mod surface;
mod thread_pool;
mod topology;
mod transient;

pub use assembled::Assembled;
pub use decay::{CycleReport, Mode};
pub use equilibrium::{run_assemble, run_static};
pub use error::{
    Leaving, LeavingBody, Moment, NamedRow, NotBack, RedundantGroup, RuntimeError, Timed,
    TimedElement, TurningBody, Undefined, Varies,
};
pub use integrator::{Damped, Statistics};
pub use kinematic::{Determined, Shared, kinematic_columns, run_kinematic};
pub use kinks::Overlooked;
pub use linearised::{FrequencyResponse, LinearModes, run_linear, run_response};
pub use periodic::{PeriodicSummary, Remedy, run_periodic};
pub use simulation::{
    Energy, FAILS, Jump, Jumping, Options, Reading, SampleGradient, Simulation, Slow, StepLimit,
    StepReport, Stopped, Warning,
};
pub use start::{StartReport, Turning, Unstable};
pub use topology::TopologyReport;
pub use transient::{Advance, Observer, RunSummary, Sample, Verdict, countable, run_transient};

/// Parts that the tests of `tests/` check alone. No other crate may use them.
#[doc(hidden)]
pub mod internals {
    use crate::field::{Demand, LaneField, Own, Task, Wanted};
    use crate::inputs::{Point, Segment};
    use eng_system::field::FieldSolver;
    use eng_system::input::Interpolation;

    pub use crate::control::FixedGrid;
    pub use crate::integrator::dense::second_rate;
    pub use crate::periodic::motion::{Motion, Moved};
    pub use crate::periodic::wide::distance_of_two;
    pub use crate::periodic::{Progress, foreseen};
    pub use crate::simulation::sampling::crossing as crossing_time;
    pub use crate::singular::{WRONG, decompose, is_of, jacobi};
    pub use crate::start::balance::turning::derivative::{PeriodicDerivative, Repeats, refined};
    pub use crate::start::balance::turning::krylov::{Solution, gmres};
    pub use crate::start::picking::{Picked, free_of, split, unit_rows};
    pub use crate::thread_pool::ThreadPool;
    pub use crate::topology::{dependencies, dependent_rows};

    /// Coefficients of Radau IIA.
    pub mod radau {
        pub use crate::integrator::radau::coefficients::{
            A, BASIS, BASIS_INVERSE, COMPLEX, INVERSE, NODES, REAL,
        };
    }

    /// Whirl of journals.
    pub mod whirl {
        pub use crate::periodic::whirl::{Orbits, Whirl, find};
    }

    /// Differences of successive cycles.
    pub mod repetition {
        pub use crate::periodic::repetition::{Comparison, Growth, Verdict, thinned, within};
    }

    /// Kinks of elements.
    pub mod kinks {
        pub use crate::kinks::Crossing;
        pub use crate::kinks::crossing::{crossing, same_side, tip};
        pub use crate::kinks::neighbours::Neighbours;
    }

    /// Small motions about a motion that repeats.
    pub mod floquet {
        pub use crate::linearised::floquet::harmonics::{exponential, transform};
        pub use crate::linearised::floquet::march::{Stage, Tableau, radau, step};
        pub use crate::linearised::floquet::multipliers::{Multiplier, Multipliers, multipliers};
    }

    /// Small motions about a state.
    pub mod small_motions {
        pub use crate::linearised::eigen::{Eigenpair, Spectrum, spectrum};
        pub use crate::linearised::state_space::{Differences, POWERS, Slope, slopes};

        use crate::linearised::StateSpace;
        use crate::linearised::response::Transfer;
        use nalgebra::Complex;

        /// The outputs for one input of unit size at an angular frequency (rad/s).
        pub fn response_at(
            matrices: &StateSpace,
            input: usize,
            omega: f64,
        ) -> Option<Vec<Complex<f64>>> {
            Transfer::new(matrices, input).at(omega)
        }
    }

    /// Where a quantity is largest over a turn (rad), and its value there.
    pub fn largest(angles: &[f64], values: &[f64]) -> (f64, f64) {
        crate::start::turn_extremes::largest(angles, values)
    }

    /// The value of an input at a time (s) between two points, each with its time (s).
    pub fn input_between(
        [(from, left), (to, right)]: [(f64, Point); 2],
        interpolation: Interpolation,
        time: f64,
    ) -> Point {
        let segment = Segment {
            from,
            left,
            to,
            right: Some(right),
        };
        segment.at(interpolation, time)
    }

    /// The answers of copies of a solver with one answer to these drives, with the index of each drive. An answer is
    /// missing if there is no solution. They come in any order; one whose solution panics does not.
    pub fn answers(
        pool: &ThreadPool,
        solver: &dyn FieldSolver,
        drives: &[f64],
    ) -> Vec<(usize, Option<f64>)> {
        let task = |(at, drive): (usize, &f64)| Task {
            at,
            fields: vec![LaneField {
                solver: solver.boxed(),
                drives: vec![*drive],
                answers: vec![0.0],
                own: Own {
                    drives: 1,
                    answers: 1,
                },
                surface: None,
                readings: Vec::new(),
                is_read: false,
                slopes: vec![0.0],
                has_slopes: false,
                memory: 0,
                before: Vec::new(),
                since: None,
                waits: true,
            }],
            wanted: Wanted::Solution(Demand::Answers),
            done: Ok(()),
        };
        let mut tasks: Vec<Task> = drives.iter().enumerate().map(task).collect();
        pool.work(&mut tasks);
        let answer = |task: &Task| task.fields.first()?.answers.first().copied();
        tasks
            .iter()
            .map(|task| (task.at, answer(task).filter(|_| task.done.is_ok())))
            .collect()
    }
}
