//! A film: its grids, its solution at given inputs, its memory.

use crate::edge::Edge;
use crate::error::{FilmError, SourceError};
use crate::grid::{Grid, Link};
use crate::inputs::{END_PRESSURE, SHAPE_FORCE, SUPPLY, TILT, TILT_RATE, VISCOSITY};
use crate::ring::RingMatrix;
use crate::source::{Cavitation, Feed, FilmSource, Lines, Opening, Part, mean_over};
use crate::surfaces::{OfGap, Surfaces};
use crate::waves::Waves;

/// Least numbers of cells of a coarse grid, which serves only for a first guess of the cavity's edge. A
/// choice: with fewer and longer cells than 30° a guess would be no nearer to the edge than none.
const COARSEST: [usize; 2] = [12, 3];

/// Most outputs whose adjoints are solved together: the seven of a film without shapes, and a free place.
pub(crate) const TOGETHER: usize = 8;

/// A film on its cells. It holds no state: the same film may be solved at many places at once, each with its
/// own [`Work`].
#[derive(Clone, Debug)]
pub struct Film {
    pub(crate) source: FilmSource,
    /// The finest grid first. Each next one has about half of the cells in each direction.
    pub(crate) levels: Vec<Level>,
    pub(crate) surfaces: Surfaces,
    pub(crate) ends: EndPlaces,
}

/// Places on both ends at the lines around and between them, where a tilted pin may be closest.
#[derive(Clone, Debug)]
pub(crate) struct EndPlaces {
    /// Angle (rad) and z (m).
    pub places: Vec<(f64, f64)>,
    pub shapes: Waves,
}

/// A grid and its relation to the next coarser one.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    pub grid: Grid,
    /// For each cell the cell of the next coarser grid that contains its middle.
    below: Vec<usize>,
    /// The shapes at the links and in the middles of the cells, and their means over the sectors of the cells.
    pub shapes: [Waves; 3],
}

/// Memory for solutions of one film. After a solution it holds the values that [`Film::tangent`], [`Film::accept`] and
/// [`Film::summary`] read.
#[derive(Clone, Debug)]
pub struct Work {
    pub(crate) levels: Vec<LevelWork>,
    pub(crate) inputs: Vec<f64>,
    pub(crate) step: Option<f64>,
    /// Content of the cells at the beginning of the step.
    pub(crate) before: Vec<f64>,
    /// Adjoint values of several outputs at cells and fixed places, and memory for two columns of them.
    pub(crate) adjoint: Vec<f64>,
    /// Derivatives of several outputs, input by input.
    pub(crate) slopes: Vec<f64>,
    /// Whether the finest level holds the full cells of an earlier solution.
    warm: bool,
    /// Rounds of the last solution on the finest grid.
    pub(crate) rounds: usize,
}

/// Unknowns and known numbers of a cell or a fixed place, in the equations of its neighbours.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Side {
    /// 1 if q is the unknown, else 0.
    pub pressed: f64,
    /// 1 if ϑ is the unknown, else 0.
    pub carrying: f64,
    /// q of a fixed place, else 0.
    pub q: f64,
    /// ϑ where it is no unknown, else 0.
    pub content: f64,
}

/// The numbers of a solution on one grid.
#[derive(Clone, Debug)]
pub(crate) struct LevelWork {
    /// Gaps h at links and in cells.
    pub gaps: [Vec<f64>; 2],
    /// Gap that carries oil.
    pub link_gap: Vec<f64>,
    /// Change of the gap at a link with the pin's turn, m/rad.
    pub link_turn: Vec<f64>,
    /// Weight times `h³/12μ`, and the slopes of its logarithm by h and ω.
    pub conductance: Vec<f64>,
    pub conductance_slope: Vec<[f64; 2]>,
    /// Factor of the weight by openings of the pin, and its slope by the turn (1/rad).
    pub turning: Vec<[f64; 2]>,
    /// Share of a cell that openings of the pin cover, and its slope by the turn.
    pub covered: Vec<[f64; 2]>,
    /// Gap that carries oil.
    pub cell_gap: Vec<f64>,
    /// Slopes of both carrying gaps by h.
    pub carried_slope: [Vec<f64>; 2],
    /// `1/h` in the shear stress.
    pub shear: Vec<OfGap>,
    /// Slopes of the rate of the carrying gap by that of h, and by h.
    pub rate_slope: Vec<[f64; 2]>,
    /// Pressure of the asperities and its slope by h.
    pub touching: Vec<[f64; 2]>,
    /// Change of the gap in the middle of a cell with the pin's turn, m/rad.
    pub cell_turn: Vec<f64>,
    pub cell_rate: Vec<f64>,
    /// Mean slope of the pin's profile by θ over a cell, and its change with the pin's turn.
    pub pin_slope: Vec<[f64; 2]>,
    /// Cells without cavity.
    pub full: Vec<bool>,
    /// Edges whose second cell is at its limit.
    pub limited: Vec<bool>,
    /// Drops of q by the edges at the links, beside those between the sides: of q, and of the q that the rule `half` cuts.
    pub bent: Vec<[f64; 2]>,
    /// q of cells and fixed places: the pressure, transformed by Barus' law.
    pub q: Vec<f64>,
    /// Content of cells and fixed places.
    pub content: Vec<f64>,
    /// Pressure of cells and fixed places, zero where the rule cuts it off, and its slope by q.
    pub pressure: Vec<[f64; 2]>,
    pub matrix: RingMatrix,
    /// Right-hand sides of the cells, replaced by their solution. Numbers of fixed places are not read.
    pub unknown: Vec<f64>,
    /// Cells and fixed places in the equations of the present set.
    pub sides: Vec<Side>,
    /// Outflow of a cell of the cavity for the rule without content, and the size of the terms of this sum.
    pub slack: Vec<[f64; 2]>,
}

impl LevelWork {
    /// Flow by pressure from a to b through a face (m³/s). The rule `half` cuts the pressure of a cell, and its q too.
    pub(crate) fn pressed(&self, at: usize, link: &Link) -> f64 {
        self.conductance[at] * (self.cut(link.a) - self.cut(link.b) + self.bent[at][1])
    }

    /// q of a side, zero where the rule `half` cuts it. In Pa.
    fn cut(&self, side: usize) -> f64 {
        match self.pressure[side][1] {
            0.0 => 0.0,
            _ => self.q[side],
        }
    }

    /// Writes the drops of the edges at the present solution.
    pub(crate) fn set_bent(&mut self, edges: &[Edge]) {
        for (edge, limited) in edges.iter().zip(&self.limited) {
            self.bent[edge.link] = [
                edge.drop(*limited, |side| self.q[side]),
                edge.drop(*limited, |side| self.cut(side)),
            ];
        }
    }

    /// Flow that the surfaces carry from a to b through a face (m³/s), at a spin.
    pub(crate) fn carried(&self, at: usize, link: &Link, spin: f64) -> f64 {
        let carried = spin * link.carry * self.link_gap[at];
        let upwind = if carried >= 0.0 { link.a } else { link.b };
        carried * self.content[upwind]
    }

    /// Slope of the logarithm of a conductance by the turn. That of an opening over no part of a cell is not needed: it
    /// begins with slope zero.
    pub(crate) fn opens_by_turn(&self, at: usize) -> f64 {
        match self.turning[at] {
            [0.0, _] => 0.0,
            [factor, slope] => slope / factor,
        }
    }

    fn new(level: &Level, fixed: usize) -> Self {
        let (cells, links) = (level.grid.cells.len(), level.grid.links.len());
        LevelWork {
            gaps: [vec![0.0; links], vec![0.0; cells]],
            link_gap: vec![0.0; links],
            link_turn: vec![0.0; links],
            conductance: vec![0.0; links],
            conductance_slope: vec![[0.0; 2]; links],
            turning: vec![[1.0, 0.0]; links],
            covered: vec![[0.0; 2]; cells],
            cell_gap: vec![0.0; cells],
            carried_slope: [vec![1.0; links], vec![1.0; cells]],
            shear: vec![OfGap::default(); cells],
            rate_slope: vec![[1.0, 0.0]; cells],
            touching: vec![[0.0; 2]; cells],
            cell_turn: vec![0.0; cells],
            cell_rate: vec![0.0; cells],
            pin_slope: vec![[0.0; 2]; cells],
            full: vec![true; cells],
            limited: vec![false; level.grid.edges.len()],
            bent: vec![[0.0; 2]; links],
            q: vec![0.0; cells + fixed],
            content: vec![1.0; cells + fixed],
            pressure: vec![[0.0; 2]; cells + fixed],
            matrix: RingMatrix::new(level.grid.around, level.grid.across, fixed),
            unknown: vec![0.0; cells + fixed],
            sides: vec![Side::default(); cells + fixed],
            slack: vec![[0.0; 2]; cells],
        }
    }
}

impl EndPlaces {
    fn new(source: &FilmSource, grid: &Grid) -> Self {
        let half = source.width / 2.0;
        let between = grid.cells.iter().step_by(grid.across);
        let angles = (grid.angles.iter().copied()).chain(between.map(|cell| cell.angle));
        let places: Vec<(f64, f64)> = angles
            .flat_map(|angle| [(angle, -half), (angle, half)])
            .collect();
        let on_surface = places
            .iter()
            .map(|(angle, z)| (*angle, 2.0 * z / source.shape_width));
        EndPlaces {
            shapes: Waves::new(&source.shapes, on_surface, |_, _| 1.0),
            places,
        }
    }
}

impl Film {
    /// Makes a film of its data.
    ///
    /// # Errors
    /// If a number is out of its range, or the openings fit neither the bearing nor the cells.
    pub fn new(source: FilmSource) -> Result<Self, SourceError> {
        source.check()?;
        let finest = Grid::new(&source, &source.around, &source.across)?;
        let mut open: Vec<bool> = finest
            .cells
            .iter()
            .map(|cell| cell.held.is_some())
            .collect();
        for feeding in &finest.feedings {
            open[feeding.cell] |= source.openings[feeding.opening].all_around();
        }
        if open.iter().all(|open| *open) {
            return Err(SourceError::AllOpen {
                width: source.width,
            });
        }
        let mut grids = vec![finest];
        while let Some(last) = grids.last() {
            let (around, across) = (last.around / 2, last.across.div_ceil(2));
            if around < COARSEST[0] || (last.across > 1 && across < COARSEST[1]) {
                break;
            }
            match Grid::new(&source, &Lines::Equal(around), &Lines::Equal(across)) {
                Ok(grid) => grids.push(grid),
                // the openings need more cells than a still coarser grid has
                Err(_) => break,
            }
        }
        let mut levels = Vec::with_capacity(grids.len());
        for (at, grid) in grids.iter().enumerate() {
            let below = match grids.get(at + 1) {
                Some(coarse) => grid
                    .cells
                    .iter()
                    .map(|cell| coarse.cell_at(cell.angle, cell.z))
                    .collect(),
                None => Vec::new(),
            };
            let reach = source.shape_width / 2.0;
            let cells = || grid.cells.iter().map(|cell| (cell.angle, cell.z / reach));
            let links = grid.sites.iter().map(|site| (site.angle, site.z / reach));
            let mean = |waves: u32, cell: usize| mean_over(waves, grid.cells[cell].sector);
            let shapes = [
                Waves::new(&source.shapes, links, |_, _| 1.0),
                Waves::new(&source.shapes, cells(), |_, _| 1.0),
                Waves::new(&source.shapes, cells(), mean),
            ];
            levels.push(Level {
                grid: grid.clone(),
                below,
                shapes,
            });
        }
        let surfaces = Surfaces::new(
            source.rough.as_ref(),
            source.thinning,
            source.floor,
            source.radius,
        );
        let ends = EndPlaces::new(&source, &levels[0].grid);
        Ok(Film {
            source,
            levels,
            surfaces,
            ends,
        })
    }

    /// The data of the film.
    #[must_use]
    pub fn source(&self) -> &FilmSource {
        &self.source
    }

    /// Number of inputs: see [`crate::inputs`].
    #[must_use]
    pub fn inputs(&self) -> usize {
        SUPPLY + self.source.openings.len() + 2 * self.source.shapes.len()
    }

    /// Number of outputs: see [`crate::inputs`].
    #[must_use]
    pub fn outputs(&self) -> usize {
        SHAPE_FORCE + self.source.shapes.len()
    }

    /// Numbers of the film's memory: with the rule [`Cavitation::MassConserving`] the content of each cell,
    /// else none.
    #[must_use]
    pub fn memory(&self) -> usize {
        match self.source.cavitation {
            Cavitation::MassConserving => self.levels[0].grid.cells.len(),
            Cavitation::Reynolds | Cavitation::Half => 0,
        }
    }

    /// Numbers of cells around and across; for a half bearing those of its half. Cells are numbered across first.
    #[must_use]
    pub fn cells(&self) -> [usize; 2] {
        [self.levels[0].grid.around, self.levels[0].grid.across]
    }

    /// Lines of the grid around (rad) and across (m), with both ends.
    #[must_use]
    pub fn lines(&self) -> [&[f64]; 2] {
        [&self.levels[0].grid.angles, &self.levels[0].grid.heights]
    }

    /// Memory for solutions.
    #[must_use]
    pub fn work(&self) -> Work {
        let (grid, fixed) = (&self.levels[0].grid, self.source.openings.len() + 1);
        Work {
            levels: self
                .levels
                .iter()
                .map(|level| LevelWork::new(level, fixed))
                .collect(),
            inputs: vec![0.0; self.inputs()],
            step: None,
            before: vec![1.0; self.memory()],
            adjoint: vec![0.0; TOGETHER * (grid.cells.len() + fixed + 2 * grid.across)],
            slopes: vec![0.0; TOGETHER * self.inputs()],
            warm: false,
            rounds: 0,
        }
    }

    /// Solves the film at inputs and writes its outputs.
    ///
    /// Without `step` the film is steady in the shell's frame: nothing but the gap changes. With `step` (s) and the
    /// rule [`Cavitation::MassConserving`], the content has changed over this step from the content in `memory`.
    /// With the other rules the pressure does not depend on the past, and `step` has no effect. The gap's rate is
    /// always that of the inputs.
    ///
    /// `work` holds the cavity of its last solution, where the search for the next one begins. The solution is
    /// unique, so this beginning changes it by rounding alone.
    ///
    /// # Errors
    /// If an input is out of range, the surfaces touch, the film has no oil, or the step is too long for its content.
    ///
    /// # Panics
    /// If a slice has another length than the film states.
    pub fn solve(
        &self,
        inputs: &[f64],
        step: Option<f64>,
        memory: &[f64],
        work: &mut Work,
        outputs: &mut [f64],
    ) -> Result<(), FilmError> {
        assert_eq!(inputs.len(), self.inputs(), "inputs of the film");
        assert_eq!(outputs.len(), self.outputs(), "outputs of the film");
        let conserving = self.source.cavitation == Cavitation::MassConserving;
        work.inputs.copy_from_slice(inputs);
        work.step = step.filter(|_| conserving);
        if work.step.is_some() {
            work.before.copy_from_slice(memory);
        }
        let solved = self.check_inputs(work).and_then(|()| self.find(work));
        // the cavity of a failed search is no good beginning of the next one
        work.warm = solved.is_ok();
        solved?;
        self.integrate(work, outputs);
        match outputs.iter().all(|output| output.is_finite()) {
            true => Ok(()),
            false => {
                work.warm = false;
                Err(FilmError::Overflow)
            }
        }
    }

    /// Forgets the cavity of the last solution: the next search begins on the coarsest grid, after any earlier
    /// solution.
    pub fn forget(&self, work: &mut Work) {
        work.warm = false;
    }

    /// Appends the set of equations of the last solution: for each cell 1 if it is full, else 0; then for each
    /// edge 1 if its second cell is at its limit, else 0.
    pub fn cavity(&self, work: &Work, numbers: &mut Vec<f64>) {
        let state = &work.levels[0];
        let set = state.full.iter().chain(&state.limited);
        numbers.extend(set.map(|set| f64::from(u8::from(*set))));
    }

    /// Lets the next search begin at a cavity ([`Film::cavity`]), and returns the numbers after it. Where
    /// there are too few, the search begins as it would without them.
    pub fn begin_at<'n>(&self, work: &mut Work, numbers: &'n [f64]) -> &'n [f64] {
        let state = &mut work.levels[0];
        let count = state.full.len() + state.limited.len();
        let Some((own, others)) = numbers.split_at_checked(count) else {
            return &[];
        };
        let set = state.full.iter_mut().chain(&mut state.limited);
        for (set, number) in set.zip(own) {
            *set = *number != 0.0;
        }
        work.warm = true;
        others
    }

    /// Solves the steady film at inputs and writes its content to the memory.
    ///
    /// # Errors
    /// As [`Film::solve`].
    pub fn start(
        &self,
        inputs: &[f64],
        work: &mut Work,
        memory: &mut [f64],
    ) -> Result<(), FilmError> {
        let mut outputs = vec![0.0; self.outputs()];
        self.solve(inputs, None, &[], work, &mut outputs)?;
        self.accept(work, memory);
        Ok(())
    }

    /// Writes the content of the last solution to the memory.
    pub fn accept(&self, work: &Work, memory: &mut [f64]) {
        let count = memory.len();
        memory.copy_from_slice(&work.levels[0].content[..count]);
    }

    /// Volume of oil in the film, `∫ ϑ h dA`, m³.
    #[must_use]
    pub fn volume(&self, work: &Work) -> f64 {
        let state = &work.levels[0];
        let volumes = self.levels[0].grid.cells.iter().enumerate();
        let sum: f64 = volumes
            .map(|(at, cell)| cell.area * state.content[at] * state.cell_gap[at])
            .sum();
        self.halves() * sum
    }

    /// Flow that the solution gathers in the film, `∫ (ϑ̇ h + ϑ ḣ) dA`, m³/s. It equals the flow into the film by
    /// openings and ends. Over a step the volume changes by this flow times the step, except for an error of second
    /// order, because ϑ̇ and ḣ are those of the step's end.
    #[must_use]
    pub fn gathering(&self, work: &Work) -> f64 {
        let state = &work.levels[0];
        let mut sum = 0.0;
        for (at, cell) in self.levels[0].grid.cells.iter().enumerate() {
            let filling = match (work.step, cell.held) {
                (Some(step), None) => {
                    (state.content[at] - work.before[at]) / step * state.cell_gap[at]
                }
                _ => 0.0,
            };
            sum += cell.area * (filling + state.content[at] * state.cell_rate[at]);
        }
        self.halves() * sum
    }

    fn check_inputs(&self, work: &Work) -> Result<(), FilmError> {
        let x = &work.inputs;
        if let Some(input) = x.iter().position(|value| !value.is_finite()) {
            return Err(FilmError::NotFinite {
                input,
                value: x[input],
            });
        }
        if x[VISCOSITY] <= 0.0 {
            return Err(FilmError::Range {
                name: "viscosity",
                value: x[VISCOSITY],
                range: "a positive number",
            });
        }
        if let Some(step) = work.step.filter(|step| !(*step > 0.0 && step.is_finite())) {
            return Err(FilmError::Range {
                name: "step",
                value: step,
                range: "a positive number",
            });
        }
        let openings = self.source.openings.len();
        for pressure in &x[END_PRESSURE..SUPPLY + openings] {
            if *pressure < 0.0 {
                let range = "at least the cavitation pressure";
                return Err(FilmError::Range {
                    name: "pressure of an opening or end",
                    value: *pressure,
                    range,
                });
            }
        }
        if self.source.half_width && x[TILT..TILT_RATE + 2] != [0.0; 4] {
            return Err(FilmError::TiltOfHalf);
        }
        // an opening of the shell at the pressure of the cavity is full of oil as well; one of the pin has
        // nothing to push it
        let holds = |(opening, pressure): (&Opening, &f64)| match (opening.feed, opening.on) {
            (Feed::Pressure, Part::Shell) => true,
            (Feed::Pressure, Part::Pin) => *pressure > 0.0,
            (Feed::Content(content), _) => content > 0.0,
        };
        let flooded = self.source.ends == crate::source::Ends::Open && x[END_PRESSURE] > 0.0;
        let oil = flooded || (self.source.openings.iter().zip(&x[SUPPLY..])).any(holds);
        if self.source.cavitation == Cavitation::MassConserving && work.step.is_none() && !oil {
            return Err(FilmError::NoOil);
        }
        Ok(())
    }

    /// Finds the cavity and the pressure.
    fn find(&self, work: &mut Work) -> Result<(), FilmError> {
        let rule = self.source.cavitation;
        self.set_gap(&self.levels[0], &mut work.levels[0], &work.inputs);
        self.check_gap(&work.levels[0])?;
        if !work.warm {
            // content of an earlier step exists on the finest grid alone: coarser grids guess the cavity of the
            // rule without memory
            let guess = if work.step.is_some() {
                Cavitation::Reynolds
            } else {
                rule
            };
            for at in (1..self.levels.len()).rev() {
                self.guess(at, &mut work.levels);
                let (level, state) = (&self.levels[at], &mut work.levels[at]);
                self.set_gap(level, state, &work.inputs);
                self.set_fixed(level, state, &work.inputs);
                // the finest grid alone must succeed: a coarse one gives a guess even if its search does not end
                let _ = self.search(level, state, guess, &work.inputs, None);
            }
            self.guess(0, &mut work.levels);
        }
        self.set_fixed(&self.levels[0], &mut work.levels[0], &work.inputs);
        let past = work.step.map(|step| (step, work.before.as_slice()));
        work.rounds = self.search(
            &self.levels[0],
            &mut work.levels[0],
            rule,
            &work.inputs,
            past,
        )?;
        self.set_pressure(work)
    }

    /// Takes the cavity of the next coarser grid, or none on the coarsest.
    fn guess(&self, at: usize, levels: &mut [LevelWork]) {
        let (fine, coarse) = levels.split_at_mut(at + 1);
        let full = &mut fine[at].full;
        match coarse.first() {
            Some(coarse) => {
                for (cell, below) in full.iter_mut().zip(&self.levels[at].below) {
                    *cell = coarse.full[*below];
                }
            }
            None => full.fill(true),
        }
        fine[at].limited.fill(false);
    }
}
