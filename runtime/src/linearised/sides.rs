//! Equations about a state at a kink: the derivatives of both sides.
//!
//! A stop that just touches, a tooth in the middle of no backlash or a load by `if d > 0 mm` at `d = 0` has a kink
//! at the state. The exact derivative there is that of one branch, which rounding or the order of the text
//! chooses. It may even belong to no side: `max(x, 0) - max(-x, 0)` is x, but at zero both branches count, and
//! the derivative would be 2. So the sides are compared.
//!
//! **At a kink.** Each kink function g of an element ([`eng_system::system::Kink`]) changes by c along the
//! coordinates of ξ, each moved by the position tolerance (velocities by the tolerance in a second, states by the
//! same share of their scales). The state is at the kink if `|g| ≤ 0.02 |c|`, the limit within which a transient
//! ends a step at a kink. A function that no allowed motion changes (c = 0) is no kink. Neither is one of time alone.
//!
//! **Sides.** The kink functions of one element cut the motions about the state into cones. The least move δ with
//! `c_i·δ = ±|c_i|` leads into each. There the element's derivatives are computed, and the equations are formed
//! with them at the state itself. The state has linear equations if the blocks of all cones agree within a
//! thousandth of the element's own share of them. The blocks are those of the allowed motions, so a difference that
//! only loads a bearing does not count. They are compared again at an eighth of the distance. A difference that
//! shrinks with it comes from curvature (a Hertzian contact) and vanishes at the state. Forces and rates of states
//! must not jump from cone to cone either.
//!
//! Two elements may bend against each other: stops that hold a body from both sides and just touch it. If an element
//! alone is bent, it is compared again together with those whose kinks lie at the same moves. Then the limit is a
//! thousandth of the bend of the element alone.
//!
//! If the sides agree and the derivative at the state is another one, the mean of all cones takes its place. Cones
//! lie opposite each other, so the error of this mean is quadratic in the tolerance.

use super::equations::Equations;
use super::outputs::Direction;
use crate::dynamics::Dynamics;
use crate::elements::{Replaced, call};
use crate::error::{BothSides, Moment, RuntimeError};
use crate::model::Model;
use crate::state::State;
use eng_system::code::{Function, Pair};
use eng_system::dense::largest_scaled;
use eng_system::layout::InputLayout;
use eng_system::system::{Kink, Origin};
use nalgebra::{DMatrix, DVector};

/// Distance of a kink function from zero within which the state is at the kink, as a share of its change
/// along the position tolerance; see [`crate::kinks`]. It is the limit there: twice a hundredth of the
/// tolerance.
const AT: f64 = 0.02;
/// Distances of the compared derivatives from the state, in position tolerances. Choices: a step of a run
/// resolves nothing nearer than the tolerance, and an eighth is far enough from it to see a root.
const FAR: f64 = 1.0;
const NEAR: f64 = 0.125;
/// Share of the element's own blocks up to which two sides agree. A choice: eigenvalues then differ by less
/// than they are printed with.
const SAME: f64 = 1e-3;
/// Share of the difference at the farther distance above which it does not vanish at the state. A difference
/// by a root falls to 0.35 of it, one by a jump remains. The limit is a choice between these.
const PERSISTS: f64 = 0.5;
/// Share of the sums of absolute terms below which a difference is rounding. A choice some decades above the
/// rounding unit.
const ROUNDING: f64 = 1e-11;
/// The most kink functions of an element whose cones are all compared. Of more, the sides of each are
/// compared. A choice: five have 32 cones, each of which takes derivatives of the element.
const MOST: usize = 5;
/// Longest move into a cone, in position tolerances. A narrower cone is left out. A choice: kinks of such a
/// cone are nearly parallel, and the farther cones are no part of a small motion.
const LONGEST: f64 = 30.0;

/// Sine of the angle between the changes of two kink functions below which their kinks lie at the same moves.
/// A choice above the rounding of derivatives.
const PARALLEL: f64 = 1e-4;

/// A kink function of an element, or its distance from a point of a table.
#[derive(Clone)]
struct Site {
    element: usize,
    /// Batch, pair and lane of the element.
    place: [usize; 3],
    kink: usize,
    /// The point of a table; zero without one.
    point: f64,
    /// Its value at the state.
    value: f64,
    /// Its changes along the coordinates.
    changes: DVector<f64>,
}

impl Site {
    fn is_here(&self) -> bool {
        self.value.abs() <= AT * self.changes.norm()
    }

    /// Whether both kinks lie at the same moves.
    fn is_parallel(&self, other: &Site) -> bool {
        let cosine =
            self.changes.dot(&other.changes) / (self.changes.norm() * other.changes.norm());
        1.0 - cosine * cosine <= PARALLEL * PARALLEL
    }
}

/// The search about one state.
struct Search<'a> {
    model: &'a Model,
    state: &'a State,
    moment: Moment,
    dynamics: Dynamics,
    /// The move of one position tolerance along each coordinate.
    units: Vec<Direction>,
    out: Vec<Pair>,
    inputs: Vec<Pair>,
}

/// The blocks of the equations with the derivatives of one cone, and the forces and rates there.
struct Side {
    /// The signs of the element's kink functions.
    signs: Vec<bool>,
    /// Far, near.
    equations: [Equations; 2],
    loads: [DVector<f64>; 2],
    derivatives: Replaced,
}

/// The result of a comparison of all sides of some elements.
enum Compared {
    /// All agree. The derivatives replace those at the state; none if these agree too.
    Even(Replaced),
    /// Two differ in the blocks by these sizes.
    Bent(RuntimeError, [f64; BLOCKS]),
}

/// Number of blocks.
const BLOCKS: usize = 6;

fn blocks(equations: &Equations) -> [&DMatrix<f64>; BLOCKS] {
    let e = equations;
    [
        &e.stiffness,
        &e.damping,
        &e.by_states,
        &e.rates_by_place,
        &e.rates_by_velocity,
        &e.rates_by_states,
    ]
}

fn difference(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    let pairs = a.iter().zip(b.iter());
    pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()))
}

impl Equations {
    /// About a state on the constraints, with its accelerations and multipliers, and with the derivatives of both
    /// sides where an element is at a kink.
    ///
    /// # Errors
    /// Those of [`Equations::new`]; an element at a kink whose sides differ.
    pub fn of_both_sides(
        model: &Model,
        state: &State,
        moment: Moment,
    ) -> Result<Equations, RuntimeError> {
        let equations = Equations::new(model, state, moment)?;
        if model
            .elements
            .iter()
            .all(|e| !e.dynamic || model.compiled.system.classes[e.class].kinks.is_empty())
        {
            return Ok(equations);
        }
        let mut search = Search::new(model, state, moment, &equations);
        let sites = search.sites()?;
        let groups: Vec<&[Site]> = sites.chunk_by(|a, b| a.element == b.element).collect();
        let mut replaced = Replaced::new();
        for own in &groups {
            if own.iter().any(|site| replaced.contains_key(&site.element)) {
                continue;
            }
            match search.compared(&equations, own, None)? {
                Compared::Even(found) => replaced.extend(found),
                Compared::Bent(error, size) => {
                    let is_beside = |group: &&&[Site]| {
                        let mut pairs = group.iter().flat_map(|a| own.iter().map(move |b| (a, b)));
                        pairs.any(|(a, b)| a.is_parallel(b))
                    };
                    let all: Vec<Site> = groups
                        .iter()
                        .filter(is_beside)
                        .flat_map(|group| group.to_vec())
                        .collect();
                    if all.len() == own.len() {
                        return Err(error);
                    }
                    match search.compared(&equations, &all, Some(size))? {
                        Compared::Even(found) => replaced.extend(found),
                        Compared::Bent(..) => return Err(error),
                    }
                }
            }
        }
        match replaced.is_empty() {
            true => Ok(equations),
            false => Equations::with(model, state, moment, replaced),
        }
    }
}

impl<'a> Search<'a> {
    fn new(
        model: &'a Model,
        state: &'a State,
        moment: Moment,
        equations: &Equations,
    ) -> Search<'a> {
        let scales = model.velocity_scales();
        let states: Vec<f64> = (model.state_scales.iter().zip(&state.states))
            .map(|(scale, z)| scale.max(z.abs()))
            .collect();
        let share = model.tolerance / model.length;
        let unit = |k: usize| {
            let mut along = equations.direction(k);
            let size = [
                largest_scaled(&along.place, &scales),
                largest_scaled(&along.velocity, &scales),
                largest_scaled(&along.states, &states),
            ];
            let size = size.into_iter().find(|size| *size > 0.0).unwrap_or(1.0);
            along.scale(share / size);
            along
        };
        Search {
            model,
            state,
            moment,
            dynamics: Dynamics::new(model),
            units: (0..equations.first_order_size()).map(unit).collect(),
            out: Vec::new(),
            inputs: Vec::new(),
        }
    }

    /// The numbers of the kink functions of a pair's class at the placed state.
    fn functions(&mut self, batch: usize, pair: usize) -> Result<&[Pair], RuntimeError> {
        let batch = &self.dynamics.batches()[batch];
        let class = &self.model.compiled.system.classes[batch.class];
        self.inputs.clear();
        self.inputs.extend_from_slice(batch.inputs(pair));
        if class.facts.kinks_read_accelerations {
            // rates alone read them, and they do not matter here
            let length = class.layout.outputs_len() as usize;
            self.inputs.resize(length, [0.0; 2]);
        }
        self.out.resize(class.kink_outputs(), [0.0; 2]);
        call(
            self.model,
            batch.class,
            Function::Kinks,
            &self.inputs,
            &mut self.out,
        )?;
        Ok(&self.out)
    }

    fn place(&mut self, state: &State) {
        self.dynamics
            .set_state(self.model, state, &state.multipliers);
    }

    /// All kink functions of the motion, with their values at the state.
    fn all(&mut self) -> Result<Vec<Site>, RuntimeError> {
        let model = self.model;
        self.place(self.state);
        let mut sites = Vec::new();
        for batch in 0..self.dynamics.batches().len() {
            let of = &self.dynamics.batches()[batch];
            let class = &model.compiled.system.classes[of.class];
            let members: Vec<[usize; 2]> = of.pairs.clone();
            let count = class.kinks.len();
            if count == 0 {
                continue;
            }
            for (pair, members) in members.into_iter().enumerate() {
                let lanes = if members[0] == members[1] { 1 } else { 2 };
                let out = self.functions(batch, pair)?;
                for (lane, element) in members.into_iter().enumerate().take(lanes) {
                    for (kink, row) in class.kinks.iter().enumerate() {
                        if row.course.is_of_time() {
                            continue;
                        }
                        let [value, handle] = [out[kink][lane], out[2 * count + kink][lane]];
                        sites.extend(points(model, row, handle, value).into_iter().map(|point| {
                            Site {
                                element,
                                place: [batch, pair, lane],
                                kink,
                                point,
                                value: value - point,
                                changes: DVector::zeros(0),
                            }
                        }));
                    }
                }
            }
        }
        Ok(sites)
    }

    /// Values of functions at the placed state.
    fn values(&mut self, sites: &[Site]) -> Result<Vec<f64>, RuntimeError> {
        let mut values = Vec::with_capacity(sites.len());
        for sites in sites.chunk_by(|a, b| a.place[..2] == b.place[..2]) {
            let [batch, pair, _] = sites[0].place;
            let out = self.functions(batch, pair)?;
            values.extend(
                sites
                    .iter()
                    .map(|site| out[site.kink][site.place[2]] - site.point),
            );
        }
        Ok(values)
    }

    /// The kink functions at whose kinks the state is, element after element.
    fn sites(&mut self) -> Result<Vec<Site>, RuntimeError> {
        let mut sites = self.all()?;
        // a length far from zero needs no slope: a move by the tolerance changes it by about this tolerance
        let (model, many) = (self.model, self.units.len() as f64);
        sites.retain(|site| {
            let kink = &model.class(site.element).kinks[site.kink];
            match crate::kinks::is_length(kink) {
                true => site.value.abs() <= many * model.tolerance,
                false => true,
            }
        });
        let mut changes = vec![DVector::zeros(self.units.len()); sites.len()];
        if !sites.is_empty() {
            for k in 0..self.units.len() {
                let moved = [1.0, -1.0].map(|step| self.units[k].moved(model, self.state, step));
                self.place(&moved[0]);
                let ahead = self.values(&sites)?;
                self.place(&moved[1]);
                let behind = self.values(&sites)?;
                for ((change, ahead), behind) in changes.iter_mut().zip(ahead).zip(behind) {
                    change[k] = 0.5 * (ahead - behind);
                }
            }
        }
        for (site, changes) in sites.iter_mut().zip(changes) {
            site.changes = changes;
        }
        sites.retain(|site| site.changes.norm() > 0.0 && site.is_here());
        sites.sort_by_key(|site| site.element);
        Ok(sites)
    }

    /// Compares all sides of the elements of some sites. `bend` are the sizes of the differences of one of them alone,
    /// which limit the differences of all.
    fn compared(
        &mut self,
        own: &Equations,
        sites: &[Site],
        bend: Option<[f64; BLOCKS]>,
    ) -> Result<Compared, RuntimeError> {
        let sides = self.sides(sites)?;
        let Some((first, rest)) = sides.split_first().filter(|(_, rest)| !rest.is_empty()) else {
            return Ok(Compared::Even(Replaced::new()));
        };
        let zeros = |numbers: &Vec<f64>| vec![0.0; numbers.len()];
        let none = first
            .derivatives
            .iter()
            .map(|(element, numbers)| (*element, zeros(numbers)));
        let without = Equations::with(self.model, self.state, self.moment, none.collect())?;
        for other in rest {
            let pair = [&first.equations, &other.equations];
            let bends = differs(pair, &without, bend);
            if bends || jumps(first, other, own) {
                let near = pair.map(|equations| blocks(&equations[1]));
                let size = std::array::from_fn(|at| difference(near[0][at], near[1][at]));
                // a jump is no bend that another element could balance
                let size = if bends { size } else { [0.0; BLOCKS] };
                return Ok(Compared::Bent(
                    self.refusal(sites, first, other, bends),
                    size,
                ));
            }
        }
        let here = [own.clone(), own.clone()];
        if !differs([&first.equations, &here], &without, bend) {
            return Ok(Compared::Even(Replaced::new()));
        }
        let mut mean: Replaced = first.derivatives.clone();
        for (element, mean) in &mut mean {
            mean.fill(0.0);
            for numbers in sides
                .iter()
                .filter_map(|side| side.derivatives.get(element))
            {
                for (mean, number) in mean.iter_mut().zip(numbers) {
                    *mean += number / sides.len() as f64;
                }
            }
        }
        Ok(Compared::Even(mean))
    }

    /// The cones of some elements about the state.
    fn sides(&mut self, sites: &[Site]) -> Result<Vec<Side>, RuntimeError> {
        let slopes = DMatrix::from_fn(sites.len(), self.units.len(), |i, k| {
            sites[i].changes[k] / sites[i].changes.norm()
        });
        let inverse = slopes.clone().pseudo_inverse(PARALLEL);
        let into = inverse.iter().flat_map(|inverse| {
            let signs = wanted_signs(sites.len()).into_iter();
            signs.map(move |wanted| inverse * DVector::from_vec(wanted))
        });
        let across = slopes.row_iter().flat_map(|slope| {
            let slope = slope.transpose();
            [slope.clone(), -slope]
        });
        let mut elements: Vec<usize> = sites.iter().map(|site| site.element).collect();
        elements.dedup();
        let mut sides: Vec<Side> = Vec::new();
        for moves in into.chain(across) {
            if !(moves.norm() > 0.0 && moves.norm() <= LONGEST) {
                continue;
            }
            let along = self.along(&moves);
            let moved = [FAR, NEAR].map(|step| along.moved(self.model, self.state, step));
            self.place(&moved[1]);
            let values = self.values(sites)?;
            let is_clear = |(value, site): (&f64, &Site)| value.abs() > AT * site.changes.norm();
            let signs: Vec<bool> = values.iter().map(|value| *value > 0.0).collect();
            let known = sides.iter().any(|side| side.signs == signs);
            if known || !values.iter().zip(sites).all(is_clear) {
                continue;
            }
            let far = self.side(&moved[0], &elements)?;
            let near = self.side(&moved[1], &elements)?;
            sides.push(Side {
                signs,
                equations: [far.0, near.0],
                loads: [far.1, near.1],
                derivatives: near.2,
            });
        }
        Ok(sides)
    }

    fn along(&self, moves: &DVector<f64>) -> Direction {
        let mut sum = Direction {
            place: vec![0.0; self.model.velocities],
            velocity: vec![0.0; self.model.velocities],
            states: vec![0.0; self.model.states],
        };
        for (unit, share) in self.units.iter().zip(moves.iter()) {
            sum.add(unit, *share);
        }
        sum
    }

    /// The equations at the state with the derivatives of some elements at a moved one; forces along the moves of the
    /// bodies (rotations in body axes) with rates of states there; the derivatives.
    fn side(
        &mut self,
        moved: &State,
        elements: &[usize],
    ) -> Result<(Equations, DVector<f64>, Replaced), RuntimeError> {
        let model = self.model;
        self.place(moved);
        self.dynamics.evaluate(model)?;
        let mut forces = vec![0.0; model.velocities];
        self.dynamics.add_forces(model, 1.0, &mut forces);
        forces.extend_from_slice(self.dynamics.rates());
        let mut derivatives = Replaced::new();
        for element in elements {
            let own = self.dynamics.derivatives_of(model, *element)?;
            derivatives.insert(*element, own);
        }
        let replaced = derivatives.clone();
        let equations = Equations::with(model, self.state, self.moment, replaced)?;
        Ok((equations, DVector::from_vec(forces), derivatives))
    }

    fn refusal(&self, sites: &[Site], first: &Side, other: &Side, bends: bool) -> RuntimeError {
        let signs = first.signs.iter().zip(&other.signs);
        let site = sites.iter().zip(signs).find(|(_, (a, b))| a != b);
        let site = site.map_or(&sites[0], |(site, _)| site);
        let kink = &self.model.class(site.element).kinks[site.kink];
        let origin = &self.model.compiled.system.elements[site.element].origin;
        let derivatives = [first, other].map(|side| {
            let own = side.derivatives.get(&site.element);
            own.map_or(&[][..], Vec::as_slice)
        });
        RuntimeError::Kinked {
            origin: Box::new(Origin {
                defined_at: kink.defined_at.or(origin.defined_at),
                ..origin.clone()
            }),
            text: kink.text.clone(),
            sides: bends
                .then(|| sides_of(self.model, site.element, derivatives))
                .flatten(),
            moment: self.moment,
        }
    }
}

/// The points of a kink function: of a table's argument those where the table has a corner, else zero.
fn points(model: &Model, kink: &Kink, handle: f64, value: f64) -> Vec<f64> {
    let Some(table) = kink.table else {
        return vec![0.0];
    };
    let tables = &model.compiled.system.tables;
    let Some(of) = tables.get(handle as usize).filter(|_| handle >= 0.0) else {
        return Vec::new();
    };
    let corners = of.kinks(usize::from(table.argument), table.smooth);
    let points = corners.ends.into_iter().chain(corners.beside(value));
    points.flatten().collect()
}

/// Wanted signs of as many functions: all of them, or with many functions both sides of each.
fn wanted_signs(count: usize) -> Vec<Vec<f64>> {
    let sign = |positive: bool| if positive { 1.0 } else { -1.0 };
    if count <= MOST {
        let all = 0..1_u32 << count;
        return all
            .map(|bits| (0..count).map(|i| sign(bits >> i & 1 == 1)).collect())
            .collect();
    }
    let alone =
        |k: usize| [true, false].map(|with| (0..count).map(|i| sign(with == (i <= k))).collect());
    (0..count).flat_map(alone).collect()
}

/// Whether equations differ at both distances by more than rounding, and do not come nearer to each other.
/// `without` are those without the elements, whose own share limits the difference unless a `bend` does.
fn differs([a, b]: [&[Equations; 2]; 2], without: &Equations, bend: Option<[f64; BLOCKS]>) -> bool {
    let zero = blocks(without);
    let [terms_of_stiffness, terms_of_damping] =
        [&without.stiffness_terms, &without.damping_terms].map(|terms| terms.amax());
    let [far, near] = [0, 1].map(|at| (blocks(&a[at]), blocks(&b[at])));
    (0..BLOCKS).any(|block| {
        let own = || {
            let share = |side: &DMatrix<f64>| difference(side, zero[block]);
            share(near.0[block]).max(share(near.1[block]))
        };
        let share = bend.map_or_else(own, |bend| bend[block]);
        let terms = match block {
            0 => terms_of_stiffness,
            1 => terms_of_damping,
            _ => zero[block].amax(),
        };
        let now = difference(near.0[block], near.1[block]);
        let before = difference(far.0[block], far.1[block]);
        now > (SAME * share).max(ROUNDING * terms) && now > PERSISTS * before
    })
}

/// Whether forces along the allowed moves, or rates of states, jump from side to side.
fn jumps(first: &Side, other: &Side, equations: &Equations) -> bool {
    let n = equations.basis.nrows();
    let projected = |loads: &DVector<f64>| {
        let moves = equations.in_ground_axes(loads.rows(0, n).into_owned());
        (
            equations.basis.tr_mul(&moves),
            equations.basis.abs().tr_mul(&moves.abs()).amax(),
        )
    };
    let change = |at: usize| {
        let [(a, size_a), (b, size_b)] = [first, other].map(|side| projected(&side.loads[at]));
        ((a - b).amax(), size_a.max(size_b))
    };
    let ((before, _), (now, size)) = (change(0), change(1));
    if now > ROUNDING * size && now > PERSISTS * before {
        return true;
    }
    (n..first.loads[0].len()).any(|i| {
        let change = |at: usize| (first.loads[at][i] - other.loads[at][i]).abs();
        let size = first.loads[1][i].abs().max(other.loads[1][i].abs());
        change(1) > ROUNDING * size && change(1) > PERSISTS * change(0)
    })
}

/// The derivative of an element's loads that differs most between two sides, forces and torques per move and turn,
/// or per their rates; torques and turns are compared by the model's length.
fn sides_of(model: &Model, element: usize, [a, b]: [&[f64]; 2]) -> Option<BothSides> {
    let layout: InputLayout = model.class(element).layout;
    let (length, rows) = (layout.residual_len() as usize, layout.rows as usize);
    let wrenches = 6 * layout.markers as usize;
    let factor = |turns: bool| if turns { 1.0 / model.length } else { 1.0 };
    let mut most: Option<(f64, BothSides)> = None;
    for d in 0..2 * wrenches {
        for i in 0..wrenches {
            let at = d * length + rows + i;
            let (Some(a), Some(b)) = (a.get(at), b.get(at)) else {
                continue;
            };
            let [torque, turn] = [i % 6 >= 3, d % 6 >= 3];
            let size = (a - b).abs() * factor(torque) * factor(turn);
            if size > most.as_ref().map_or(0.0, |(size, _)| *size) {
                // the sign depends on the marker; that of the steeper side counts as positive
                let sign = if a.abs() > b.abs() {
                    a.signum()
                } else {
                    b.signum()
                };
                let slopes = [a * sign, b * sign];
                let damping = d >= wrenches;
                most = Some((
                    size,
                    BothSides {
                        slopes,
                        torque,
                        turn,
                        damping,
                    },
                ));
            }
        }
    }
    most.map(|(_, sides)| sides)
}
