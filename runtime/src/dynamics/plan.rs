//! The places of the blocks in a step's matrix.

use crate::linear::{BlockTable, Pattern, PatternBuilder, Runs};
use crate::model::Model;
use crate::surface::SurfaceModel;
use std::collections::BTreeMap;
use std::ops::Range;

/// The places of the blocks in the step's matrix. The unknowns are the increments of velocities, the states
/// and the multipliers.
#[derive(Clone, Debug)]
pub struct MatrixPlan {
    /// The pattern.
    pub pattern: Pattern,
    /// Its runs.
    pub runs: Runs,
    pub(super) table: BlockTable,
    pub(super) bodies: Vec<usize>,
    /// Blocks of each element; empty for an element that is not dynamic.
    pub(super) elements: Vec<ElementPlan>,
    /// Blocks of each elastic surface.
    pub(super) surfaces: Vec<SurfacePlan>,
    /// Pairs of bodies. The blocks of their markers are summed before the modes expand them.
    pub(super) couplings: Vec<Coupling>,
    /// Total length of these sums.
    pub(super) sums: usize,
    pub(super) diagonal: Vec<usize>,
}

/// The destination of an element's block between two markers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// The matrix, because both markers see six numbers of their bodies.
    Matrix(usize),
    /// The sum that begins at this index.
    Sum(usize),
}

/// Blocks between the markers of two bodies, at least one of them flexible.
#[derive(Clone, Debug)]
pub(super) struct Coupling {
    pub block: usize,
    pub rows: usize,
    pub columns: usize,
    /// A marker of each body, and the beginning of their sum.
    pub markers: Vec<(usize, usize, usize)>,
}

/// Blocks of an elastic surface.
#[derive(Clone, Debug, Default)]
pub(super) struct SurfacePlan {
    /// Modes of its body by these modes.
    pub modal: usize,
    /// Modes by the body of each marker of the element, where it is on a body.
    pub by_body: Vec<Option<usize>>,
    /// Body of each marker by the modes.
    pub of_body: Vec<Option<usize>>,
    /// States of the element by the modes; modes by these states.
    pub states: Option<[usize; 2]>,
}

#[derive(Clone, Debug, Default)]
pub(super) struct ElementPlan {
    /// markers × markers, where both are on bodies.
    pub force: Vec<Option<Place>>,
    /// rows by body of marker; body of marker by rows.
    pub constraint: Vec<Option<(usize, usize)>>,
    /// states by body of marker; body of marker by states.
    pub state: Vec<Option<(usize, usize)>>,
    /// states by states.
    pub own: Option<usize>,
}

/// The places of a model's unknowns in the matrix: increments of velocities, states, multipliers.
#[derive(Clone, Copy)]
struct Unknowns<'a> {
    model: &'a Model,
}

impl Unknowns<'_> {
    fn size(self) -> usize {
        self.model.velocities + self.model.states + self.model.rows
    }

    fn of_body(self, body: usize) -> Range<usize> {
        let body = &self.model.bodies[body];
        body.velocity..body.velocity + body.width()
    }

    /// The unknowns of a marker's body; `None` on the ground.
    fn of_marker(self, marker: usize) -> Option<Range<usize>> {
        self.model.markers[marker]
            .body
            .map(|body| self.of_body(body))
    }

    /// Multipliers and states of an element.
    fn of_element(self, index: usize) -> (Range<usize>, Range<usize>) {
        let model = self.model;
        let element = &model.elements[index];
        let layout = model.class(index).layout;
        let states = model.velocities + element.state;
        let rows = model.velocities + model.states + element.row;
        (
            rows..rows + layout.rows as usize,
            states..states + layout.states as usize,
        )
    }

    /// Whether an element couples the bodies of its markers. Constraint rows alone do so too, through the
    /// second derivatives of Φ.
    fn couples(self, index: usize) -> bool {
        let class = self.model.class(index);
        class.facts.applies_load || !class.rows.is_empty()
    }

    fn pattern(self) -> Pattern {
        let model = self.model;
        let mut builder = PatternBuilder::new(self.size());
        for body in 0..model.bodies.len() {
            builder.reserve(self.of_body(body), self.of_body(body));
        }
        for (index, element) in model.elements.iter().enumerate().filter(|(_, e)| e.dynamic) {
            let (rows, states) = self.of_element(index);
            builder.reserve(states.clone(), states.clone());
            for i in element.markers.iter().filter_map(|m| self.of_marker(*m)) {
                builder.reserve(rows.clone(), i.clone());
                builder.reserve(i.clone(), rows.clone());
                builder.reserve(states.clone(), i.clone());
                builder.reserve(i.clone(), states.clone());
                if self.couples(index) {
                    for j in element.markers.iter().filter_map(|m| self.of_marker(*m)) {
                        builder.reserve(i.clone(), j);
                    }
                }
            }
        }
        builder.finish()
    }
}

/// A plan under construction.
struct Planner<'a> {
    unknowns: Unknowns<'a>,
    pattern: Pattern,
    table: BlockTable,
    /// Beginnings of the sums, by bodies and by markers.
    summed: BTreeMap<(usize, usize), BTreeMap<(usize, usize), usize>>,
    sums: usize,
}

impl Planner<'_> {
    fn element(&mut self, index: usize) -> ElementPlan {
        let unknowns = self.unknowns;
        let element = &unknowns.model.elements[index];
        let mut plan = ElementPlan::default();
        if !element.dynamic {
            return plan;
        }
        let (rows, states) = unknowns.of_element(index);
        for m in &element.markers {
            for n in &element.markers {
                let place = unknowns.couples(index).then(|| self.between(*m, *n));
                plan.force.push(place.flatten());
            }
            plan.constraint.push(self.both(*m, &rows));
            plan.state.push(self.both(*m, &states));
        }
        if !states.is_empty() {
            plan.own = Some(self.table.find(&self.pattern, states.start, states));
        }
        plan
    }

    /// The block between two markers, if both are on bodies.
    fn between(&mut self, first: usize, second: usize) -> Option<Place> {
        let model = self.unknowns.model;
        let [left, right] = [first, second].map(|m| &model.markers[m]);
        let (i, j) = (left.body?, right.body?);
        let (height, width) = (left.reach(), right.reach());
        if height.max(width) == 6 {
            let (i, j) = (model.bodies[i].velocity, model.bodies[j].velocity);
            return Some(Place::Matrix(self.table.find(&self.pattern, i, j..j + 6)));
        }
        let sum = *self
            .summed
            .entry((i, j))
            .or_default()
            .entry((first, second))
            .or_insert(self.sums);
        if sum == self.sums {
            self.sums += height * width;
        }
        Some(Place::Sum(sum))
    }

    /// The blocks of some rows by the body of a marker, and of that body by these rows as columns.
    fn both(&mut self, marker: usize, other: &Range<usize>) -> Option<(usize, usize)> {
        let body = self.unknowns.of_marker(marker)?;
        (!other.is_empty()).then(|| {
            (
                self.table.find(&self.pattern, other.start, body.clone()),
                self.table.find(&self.pattern, body.start, other.clone()),
            )
        })
    }

    fn surface(&mut self, surface: &SurfaceModel) -> SurfacePlan {
        let unknowns = self.unknowns;
        let modes = surface.velocity..surface.velocity + surface.modes;
        let mut plan = SurfacePlan {
            modal: (self.table).find(&self.pattern, modes.start, modes.clone()),
            ..SurfacePlan::default()
        };
        for marker in &unknowns.model.elements[surface.element].markers {
            let body = unknowns.of_marker(*marker);
            let of_body = body
                .clone()
                .map(|body| (self.table).find(&self.pattern, body.start, modes.clone()));
            plan.of_body.push(of_body);
            let by_body = body.map(|body| self.table.find(&self.pattern, modes.start, body));
            plan.by_body.push(by_body);
        }
        let (_, states) = unknowns.of_element(surface.element);
        if !states.is_empty() {
            plan.states = Some([
                self.table.find(&self.pattern, states.start, modes.clone()),
                self.table.find(&self.pattern, modes.start, states),
            ]);
        }
        plan
    }

    fn couplings(&mut self) -> Vec<Coupling> {
        let unknowns = self.unknowns;
        std::mem::take(&mut self.summed)
            .into_iter()
            .map(|((rows, columns), markers)| {
                let first = unknowns.model.bodies[rows].velocity;
                let range = unknowns.of_body(columns);
                Coupling {
                    block: self.table.find(&self.pattern, first, range),
                    rows,
                    columns,
                    markers: markers.into_iter().map(|((m, n), at)| (m, n, at)).collect(),
                }
            })
            .collect()
    }
}

impl MatrixPlan {
    /// Plans the matrix of a step.
    pub fn new(model: &Model) -> MatrixPlan {
        let unknowns = Unknowns { model };
        let mut planner = Planner {
            unknowns,
            pattern: unknowns.pattern(),
            table: BlockTable::default(),
            summed: BTreeMap::new(),
            sums: 0,
        };
        let bodies = (0..model.bodies.len())
            .map(|body| {
                let range = unknowns.of_body(body);
                planner.table.find(&planner.pattern, range.start, range)
            })
            .collect();
        let elements = (0..model.elements.len())
            .map(|index| planner.element(index))
            .collect();
        let surfaces = model.surfaces.iter();
        let surfaces = surfaces.map(|surface| planner.surface(surface)).collect();
        let couplings = planner.couplings();
        let diagonal = (0..unknowns.size())
            .map(|i| planner.pattern.place(i, i))
            .collect();
        MatrixPlan {
            runs: Runs::new(&planner.pattern),
            pattern: planner.pattern,
            table: planner.table,
            bodies,
            elements,
            surfaces,
            couplings,
            sums: planner.sums,
            diagonal,
        }
    }
}
