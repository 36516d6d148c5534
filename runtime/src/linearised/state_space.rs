//! Small motions under inputs: `ξ̇ = A ξ + B u`, `y = C ξ + D u`.
//!
//! ξ = (x, ẋ, z) are the coordinates of [`Equations`]: x of the freedoms (in m√kg, because NᵀMN = 1), their rates, and
//! states of elements. u and y are differences of inputs and channels from their values at the state (SI).
//!
//! A and C are those of [`linearise`](super::linearise): exact blocks of Newton's matrix, and differences of
//! the outputs along each coordinate. An input changes constants of elements, so B and D come from
//! differences of accelerations, rates and outputs over values of the input,
//! `(8 (f(h) − f(−h)) − (f(2h) − f(−2h)))/12h`. `B_ẋ = NᵀM ∂v̇/∂u`, `B_z = ∂ż/∂u`. Nobody states the size of
//! an input over which its effect is straight. So each number comes from the step h whose result changes
//! least when the step becomes ten times smaller, plus the rounding ε|f|/h.

use super::equations::Equations;
use super::outputs::Probe;
use super::{Coefficients, tested};
use crate::error::{Moment, RuntimeError};
use crate::model::Model;
use crate::state::State;
use nalgebra::{DMatrix, DVector};

/// Powers of ten of the steps for an input whose value is zero, from large to small (SI). A choice: from a
/// nanometre to kilonewtons; the best step is chosen.
pub const POWERS: std::ops::RangeInclusive<i32> = -9..=3;
/// Share of the slope by which the slopes to both sides may differ at every step; a larger share is a kink. A
/// choice.
const BENT: f64 = 1e-3;
/// Number of the smallest steps whose scatter shows the rounding. A choice: three decades, in which a kink
/// still counts little.
const SCATTER: usize = 3;
/// Least number of other steps. A choice: with fewer the best step may be missed.
const WIDE: usize = 6;
/// Number of roundings up to which a difference of slopes counts as zero. A choice: the scatter itself is
/// known within such a factor.
const NOISE: f64 = 1e3;

/// The matrices of small motions about a state.
#[derive(Clone, Debug, PartialEq)]
pub struct StateSpace {
    /// The moment of the linearisation.
    pub moment: Moment,
    /// Whether the matrices belong to the motion or to one moment.
    pub coefficients: Coefficients,
    /// Number of coordinates x; ξ has their rates next.
    pub freedoms: usize,
    /// Number of states of elements, at the end of ξ.
    pub states: usize,
    /// A.
    pub a: DMatrix<f64>,
    /// B: a column for each input.
    pub b: DMatrix<f64>,
    /// C: a row for each output.
    pub c: DMatrix<f64>,
    /// D.
    pub d: DMatrix<f64>,
}

impl StateSpace {
    /// `D − C A⁻¹ B`: the change of each output for a small constant change of each input, when the motion has settled.
    /// `None` if A is singular, as that of a body that nothing holds.
    pub fn gains(&self) -> Option<DMatrix<f64>> {
        let moved = self.a.clone().lu().solve(&self.b)?;
        let gains = &self.d - &self.c * moved;
        gains.iter().all(|gain| gain.is_finite()).then_some(gains)
    }
}

/// Accelerations in ground axes, rates of states, and outputs at one value of an input.
struct Answer {
    numbers: DVector<f64>,
}

/// The matrices about a state. `inputs` are indices into the inputs of the system, `channels` into its
/// channels. The model has the present values of its inputs as parameters.
///
/// # Errors
/// Those of [`linearise`](super::linearise); an input whose effect has a kink at its value, an output that has one at
/// the state.
pub(crate) fn state_space(
    model: &Model,
    state: &State,
    moment: Moment,
    (inputs, channels): (&[usize], &[usize]),
    frozen: bool,
) -> Result<StateSpace, RuntimeError> {
    let equations = Equations::of_both_sides(model, state, moment)?;
    let (coefficients, _) = tested(model, state, &equations, moment, frozen)?;
    let a = equations.first_order();
    let (p, size) = (equations.freedoms(), a.nrows());
    let mut c = DMatrix::zeros(channels.len(), size);
    let mut probe = Probe::new(model, state, moment)?;
    let [.., here] = probe.here()?;
    for k in 0..size {
        if let Some(bent) = probe.bent(&equations.direction(k), channels, &here)? {
            let channel = model.compiled.system.channels.get(bent);
            return Err(RuntimeError::KinkedOutput {
                path: channel.map_or(String::new(), |channel| channel.path.clone()),
                moment,
            });
        }
        let slopes = probe.along(&equations.direction(k))?;
        for (row, channel) in channels.iter().enumerate() {
            c[(row, k)] = slopes.get(*channel).copied().unwrap_or(0.0);
        }
    }
    let mut b = DMatrix::zeros(size, inputs.len());
    let mut d = DMatrix::zeros(channels.len(), inputs.len());
    for (column, input) in inputs.iter().enumerate() {
        let slopes = by_input(model, state, moment, &equations, *input)?;
        let n = model.velocities;
        let accelerations = slopes.rows(0, n).into_owned();
        let coordinates = equations.basis.tr_mul(&(&equations.mass * accelerations));
        b.view_mut((p, column), (p, 1)).copy_from(&coordinates);
        let rates = slopes.rows(n, size - 2 * p);
        b.view_mut((2 * p, column), (size - 2 * p, 1))
            .copy_from(&rates);
        let first = n + size - 2 * p;
        for (row, channel) in channels.iter().enumerate() {
            d[(row, column)] = slopes.get(first + channel).copied().unwrap_or(0.0);
        }
    }
    Ok(StateSpace {
        moment,
        coefficients,
        freedoms: p,
        states: size - 2 * p,
        a,
        b,
        c,
        d,
    })
}

/// Derivatives of an [`Answer`] by an input.
fn by_input(
    model: &Model,
    state: &State,
    moment: Moment,
    equations: &Equations,
    input: usize,
) -> Result<DVector<f64>, RuntimeError> {
    let system = &model.compiled.system;
    let found = system.inputs.get(input);
    let parameter = found.and_then(|input| {
        let index = input.parameter as usize;
        Some((
            index,
            system.parameters.get(index)?,
            *model.parameters.get(index)?,
        ))
    });
    let Some((index, parameter, value)) = parameter else {
        return Err(RuntimeError::Options {
            message: format!("there is no input {input}"),
        });
    };
    if found.is_some_and(|input| input.differentiated) {
        return Err(RuntimeError::Input {
            origin: Box::new(parameter.origin.clone()),
            message: "the model reads its rate by `der`, and B and D have no place for a rate: make the rate an input of its own"
                .to_owned(),
        });
    }
    let at = |x: f64| -> Result<Answer, RuntimeError> {
        let mut overrides = model.overrides.clone();
        overrides.resize(system.parameters.len(), None);
        overrides[index] = Some(x);
        let mut moved = Model::bind(&model.compiled, &overrides)?;
        // inputs decide no geometry, and the ground markers have their places
        moved.markers.clone_from(&model.markers);
        let mut probe = Probe::new(&moved, state, moment)?;
        let [acceleration, rates, outputs] = probe.here()?;
        let acceleration = equations.in_ground_axes(DVector::from_vec(acceleration));
        let numbers = acceleration.iter().copied().chain(rates).chain(outputs);
        Ok(Answer {
            numbers: DVector::from_vec(numbers.collect()),
        })
    };
    let here = at(value)?.numbers;
    let (low, high) = parameter.limits;
    let unit = if value == 0.0 { 1.0 } else { value.abs() };
    let mut steps: Vec<Differences> = Vec::new();
    for power in POWERS.rev() {
        let h = unit * libm::pow(10.0, f64::from(power));
        if value - 2.0 * h <= low || value + 2.0 * h >= high {
            continue;
        }
        // far from its value the input may break a condition of the text
        let values: Result<Vec<_>, _> = [h, -h, 2.0 * h, -2.0 * h]
            .into_iter()
            .map(|step| at(value + step))
            .collect();
        let Ok(values) = values else { continue };
        let [plus, minus, far, near] = &values[..] else {
            continue;
        };
        let [plus, minus] = [plus, minus].map(|answer| &answer.numbers);
        let [far, near] = [far, near].map(|answer| &answer.numbers);
        let slopes = ((plus - minus) * 8.0 - (far - near)) / (12.0 * h);
        let sides = (plus + minus - &here * 2.0) / h;
        if slopes.iter().chain(sides.iter()).any(|x| !x.is_finite()) {
            continue;
        }
        let size = here.abs().sup(&plus.abs());
        steps.push(Differences {
            h,
            slopes,
            sides,
            size,
        });
    }
    let found = slopes(&steps, here.len());
    let refused = |message: &str| {
        Err(RuntimeError::Input {
            origin: Box::new(parameter.origin.clone()),
            message: message.to_owned(),
        })
    };
    if found.iter().any(|slope| slope.error.is_infinite()) {
        return refused("its limits and conditions leave no room for a small change");
    }
    if found.iter().any(|slope| slope.bent) {
        return refused(
            "its effect has a kink at its value, so no matrix describes small changes: linearise at another value",
        );
    }
    Ok(DVector::from_iterator(
        found.len(),
        found.into_iter().map(|slope| slope.value),
    ))
}

/// Differences of all numbers over one step h of an input.
pub struct Differences {
    /// h, in the unit of the input.
    pub h: f64,
    /// Slopes by central differences.
    pub slopes: DVector<f64>,
    /// Differences of the slopes to both sides.
    pub sides: DVector<f64>,
    /// Sizes of the numbers.
    pub size: DVector<f64>,
}

/// The rounding of each number, as the scatter of `f(h) + f(−h) − 2 f(0)` over the smallest steps shows it. An
/// acceleration that is the small difference of large loads has far more than one rounding of itself. A kink adds its
/// bend times h, which is negligible at these steps beside the other steps.
fn noise(steps: &[Differences], count: usize) -> Vec<f64> {
    let smallest = steps
        .iter()
        .rev()
        .take(SCATTER.min(steps.len().saturating_sub(WIDE)));
    let mut noise = vec![0.0_f64; count];
    for step in smallest {
        for (noise, side) in noise.iter_mut().zip(step.sides.iter()) {
            *noise = noise.max(side.abs() * step.h);
        }
    }
    noise
}

/// The slopes of all numbers from their differences over steps, the largest step first.
pub fn slopes(steps: &[Differences], count: usize) -> Vec<Slope> {
    let noise = noise(steps, count);
    let mut found = vec![Slope::default(); count];
    for pair in steps.windows(2) {
        let [larger, smaller] = pair else { continue };
        for (i, found) in found.iter_mut().enumerate() {
            let rounding = (f64::EPSILON * smaller.size[i]).max(noise[i]) / smaller.h;
            found.refine(
                [larger.slopes[i], smaller.slopes[i]],
                [larger.sides[i].abs(), smaller.sides[i].abs()],
                rounding,
            );
        }
    }
    found
}

/// The slope of one number, from the step with the least error.
#[derive(Clone, Copy, Debug)]
pub struct Slope {
    /// The slope.
    pub value: f64,
    error: f64,
    /// Whether the slopes to both sides differ, however small the step is.
    pub bent: bool,
}

impl Default for Slope {
    fn default() -> Slope {
        Slope {
            value: 0.0,
            error: f64::INFINITY,
            bent: false,
        }
    }
}

impl Slope {
    /// Compares the slopes at a step and at one ten times smaller, and the differences of the slopes to both sides.
    fn refine(&mut self, [larger, smaller]: [f64; 2], sides: [f64; 2], rounding: f64) {
        let error = (smaller - larger).abs() + rounding;
        if error < self.error {
            (self.value, self.error) = (larger, error);
        }
        let [then, now] = sides;
        let differs = now > BENT * smaller.abs().max(now);
        if now > NOISE * rounding {
            self.bent = differs && now > 0.5 * then && now < 2.0 * then;
        } else if now.max(rounding) <= BENT * smaller.abs() {
            // by chance alone, rounding may look straight
            self.bent = false;
        }
    }
}
