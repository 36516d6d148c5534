//! Cells of a film and the links between them.
//!
//! A cell has its number `column*across + row`. A link is a face through which oil flows from its side `a` to
//! its side `b`; a side is a cell or a place with fixed pressure. Fixed places have the numbers after the
//! cells: the openings in their order, then the ends.

use crate::edge::Edge;
use crate::error::{Place, SourceError};
use crate::ring::{EAST, HIGH, LOW, WEST};
use crate::source::{EdgeSlope, Ends, Feed, FilmSource, Lines, Opening, Part, mean_of_wave};

/// A face between two cells, or between a cell and a fixed place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    /// Side before the face: west, or towards negative z.
    pub a: usize,
    /// Side behind it.
    pub b: usize,
    /// Length of the face over the distance of its sides; that of an [`Edge`] is its w.
    pub weight: f64,
    /// Place of the cell b in the row of the cell a; that of a in the row of b follows it.
    pub toward: usize,
    /// ½RΔz at faces that cross the motion, 0 at the others, m²; times ω and the gap it is the flow that the
    /// surfaces carry, m³/s.
    pub carry: f64,
}

impl Link {
    /// Sign with which a flow from a to b counts in the flow out of the ends: 0 inside, and where it enters.
    pub fn outward(&self, ends: usize, flow: f64) -> f64 {
        match (self.a == ends, self.b == ends) {
            (_, true) if flow > 0.0 => 1.0,
            (true, _) if flow < 0.0 => -1.0,
            _ => 0.0,
        }
    }
}

/// Place of a link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    /// Angle, rad.
    pub angle: f64,
    /// Distance from mid width, m.
    pub z: f64,
    /// cos θ and sin θ.
    pub normal: [f64; 2],
    /// Clearance and profile of the shell, m.
    pub base: f64,
}

/// A cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    /// m².
    pub area: f64,
    /// Angle of its middle, rad.
    pub angle: f64,
    /// Its width around, rad.
    pub sector: f64,
    /// Distance of its middle from mid width, m.
    pub z: f64,
    /// cos θ and sin θ in its middle.
    pub normal: [f64; 2],
    /// Means of cos θ and sin θ over the cell. So a turning eccentricity squeezes a cell exactly as much as
    /// it carries oil into it.
    pub mean_normal: [f64; 2],
    /// Clearance and profile of the shell, m.
    pub base: f64,
    /// The opening of the shell that covers it.
    pub held: Option<usize>,
}

/// A link from a cell to an opening of the pin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Feeding {
    pub cell: usize,
    pub opening: usize,
    /// Weight of the link, before the share of the cell: twice the sum of both aspect ratios of the cell. See
    /// the module `turning`.
    pub weight: f64,
}

/// Cells and links of one size.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub around: usize,
    pub across: usize,
    /// Lines around, rad: `around + 1`, the last a turn after the first.
    pub angles: Vec<f64>,
    /// Lines across, m: `across + 1`.
    pub heights: Vec<f64>,
    pub cells: Vec<Cell>,
    /// Links, column by column. Their places are apart: a search needs the links alone, many times.
    pub links: Vec<Link>,
    pub sites: Vec<Site>,
    /// The first links: those from cells to openings of the pin that may lie over them.
    pub feedings: Vec<Feeding>,
    /// Links to fixed places with two cells before them.
    pub edges: Vec<Edge>,
    /// Distances of both sides of each link from its face: rad or m. Of a fixed place it is 0.
    pub reaches: Vec<[f64; 2]>,
}

impl Grid {
    /// The grid of a film with so many cells, or with the lines that the source states.
    pub(crate) fn new(
        source: &FilmSource,
        around: &Lines,
        across: &Lines,
    ) -> Result<Self, SourceError> {
        let angles = lines_around(source, around)?;
        let heights = lines_across(source, across)?;
        let (columns, rows) = (angles.len() - 1, heights.len() - 1);
        let half = source.width / 2.0;
        let mut cells = Vec::with_capacity(columns * rows);
        for column in 0..columns {
            let angle = (angles[column] + angles[column + 1]) / 2.0;
            let sector = angles[column + 1] - angles[column];
            let (sin, cos) = libm::sincos(angle);
            let mean = mean_of_wave(sector / 2.0);
            for row in 0..rows {
                let z = (heights[row] + heights[row + 1]) / 2.0;
                cells.push(Cell {
                    area: source.radius * sector * (heights[row + 1] - heights[row]),
                    angle,
                    sector,
                    z,
                    normal: [cos, sin],
                    mean_normal: [cos * mean, sin * mean],
                    base: source.clearance + source.shell_profile(angle, z / half),
                    held: held(source, angle, z),
                });
            }
        }
        let mut grid = Grid {
            around: columns,
            across: rows,
            angles,
            heights,
            cells,
            links: Vec::new(),
            sites: Vec::new(),
            feedings: Vec::new(),
            edges: Vec::new(),
            reaches: Vec::new(),
        };
        grid.link(source);
        if source.edges == EdgeSlope::TwoCells {
            grid.find_edges(source);
        }
        Ok(grid)
    }

    /// Place of the ends among the fixed places and cells.
    pub(crate) fn ends(&self, source: &FilmSource) -> usize {
        self.cells.len() + source.openings.len()
    }

    /// Place of a cell's middle.
    pub(crate) fn place(&self, cell: usize) -> Place {
        place(self.cells[cell].angle, self.cells[cell].z)
    }

    /// Makes all links.
    fn link(&mut self, source: &FilmSource) {
        let (columns, rows, count) = (self.around, self.across, self.cells.len());
        let half = source.width / 2.0;
        let side = |cell: usize, held: Option<usize>| held.map_or(cell, |opening| count + opening);
        self.feedings = feedings(source, self);
        let (mut links, mut sites, mut reaches) = (Vec::new(), Vec::new(), Vec::new());
        // the places of these rows that they write are written again by the links of the cells among each other
        for feeding in &self.feedings {
            let cell = &self.cells[feeding.cell];
            links.push(Link {
                a: feeding.cell,
                b: count + feeding.opening,
                weight: feeding.weight,
                toward: HIGH,
                carry: 0.0,
            });
            sites.push(Site {
                angle: cell.angle,
                z: cell.z,
                normal: cell.normal,
                base: cell.base,
            });
            reaches.push([0.0; 2]);
        }
        let mut face = |a, b, weight, carry, angle: f64, z: f64, reach: [f64; 2]| {
            reaches.push(reach);
            let (sin, cos) = libm::sincos(angle);
            links.push(Link {
                a,
                b,
                weight,
                toward: if carry == 0.0 { HIGH } else { EAST },
                carry,
            });
            sites.push(Site {
                angle,
                z,
                normal: [cos, sin],
                base: source.clearance + source.shell_profile(angle, z / half),
            });
        };
        for column in 0..columns {
            let angle = self.angles[column + 1];
            for row in 0..rows {
                let (west, east) = (column * rows + row, (column + 1) % columns * rows + row);
                let (before, behind) = (&self.cells[west], &self.cells[east]);
                let high = self.heights[row + 1] - self.heights[row];
                let [from, to] = [before.held, behind.held];
                let reach = |cell: &Cell| {
                    if cell.held.is_some() {
                        0.0
                    } else {
                        cell.sector / 2.0
                    }
                };
                let carry = source.radius * high / 2.0;
                let weight = |distance: f64| high / (source.radius * distance);
                let line = source
                    .openings
                    .iter()
                    .position(|o| is_line(o, angle, before.z));
                if from.is_some() && to.is_some() {
                    continue;
                }
                let (z, a, b) = (before.z, side(west, from), side(east, to));
                match line.filter(|_| from.is_none() && to.is_none()) {
                    Some(line) => {
                        let [west, east] = [reach(before), reach(behind)];
                        face(a, count + line, weight(west), carry, angle, z, [west, 0.0]);
                        face(count + line, b, weight(east), carry, angle, z, [0.0, east]);
                    }
                    None => {
                        let sides = [reach(before), reach(behind)];
                        face(a, b, weight(sides[0] + sides[1]), carry, angle, z, sides);
                    }
                }
            }
            for line in 0..=rows {
                let below = line.checked_sub(1).map(|row| column * rows + row);
                let above = (line < rows).then_some(column * rows + line);
                let reach = |cell: Option<usize>| match cell {
                    Some(cell) if self.cells[cell].held.is_none() => {
                        (self.heights[cell % rows + 1] - self.heights[cell % rows]) / 2.0
                    }
                    _ => 0.0,
                };
                let sides = [reach(below), reach(above)];
                let distance = sides[0] + sides[1];
                let inner = below.is_some() && above.is_some();
                let middle = source.half_width && line == 0;
                if distance == 0.0 || (!inner && (source.ends == Ends::Sealed || middle)) {
                    continue;
                }
                let end = self.ends(source);
                let number = |cell: Option<usize>| {
                    cell.map_or(end, |cell| side(cell, self.cells[cell].held))
                };
                let middle_cell = &self.cells[column * rows];
                let weight = source.radius * middle_cell.sector / distance;
                face(
                    number(below),
                    number(above),
                    weight,
                    0.0,
                    middle_cell.angle,
                    self.heights[line],
                    sides,
                );
            }
        }
        (self.links, self.sites, self.reaches) = (links, sites, reaches);
    }

    /// Finds the edges among the links, and gives them their weights.
    fn find_edges(&mut self, source: &FilmSource) {
        for at in self.feedings.len()..self.links.len() {
            if let Some((edge, factor)) = self.edge(at, &self.links[at], source) {
                self.links[at].weight *= factor;
                self.edges.extend(edge);
            }
        }
    }

    /// The edge of a link with one cell, and its factor of the weight. Neither is there where the next cell is missing or
    /// lies in an opening. The mirrored cell beyond mid width has the pressure of the cell itself, and needs no edge.
    fn edge(&self, at: usize, link: &Link, source: &FilmSource) -> Option<(Option<Edge>, f64)> {
        let (columns, rows, count) = (self.around, self.across, self.cells.len());
        let (own, behind) = match [link.a < count, link.b < count] {
            [true, false] => (link.a, false),
            [false, true] => (link.b, true),
            _ => return None,
        };
        let (column, row) = (own / rows, own % rows);
        let across = link.toward == HIGH;
        let (inner, toward) = match (across, behind) {
            (true, false) if row == 0 && source.half_width => return Some((None, Edge::MIRRORED)),
            (true, false) => (column * rows + row.checked_sub(1)?, LOW),
            (true, true) if row + 1 == rows => return None,
            (true, true) => (own + 1, HIGH),
            (false, false) => ((column + columns - 1) % columns * rows + row, WEST),
            (false, true) => ((column + 1) % columns * rows + row, EAST),
        };
        if self.cells[inner].held.is_some() {
            return None;
        }
        let widths = [own, inner].map(|cell| match across {
            true => self.heights[cell % rows + 1] - self.heights[cell % rows],
            false => self.cells[cell].sector,
        });
        let opening = source.openings.get(link.a.max(link.b) - count);
        let limited = opening.is_none_or(|opening| opening.feed != Feed::Pressure);
        let (edge, factor) = Edge::new(at, [link.a, link.b], own, inner, toward, widths, limited);
        Some((Some(edge), factor))
    }

    /// The cell in which a place lies.
    pub(crate) fn cell_at(&self, angle: f64, z: f64) -> usize {
        let turn = std::f64::consts::TAU;
        let from_first = (angle - self.angles[0]).rem_euclid(turn) + self.angles[0];
        let column = self
            .angles
            .partition_point(|line| *line <= from_first)
            .clamp(1, self.around)
            - 1;
        let row = self
            .heights
            .partition_point(|line| *line <= z)
            .clamp(1, self.across)
            - 1;
        column * self.across + row
    }
}

/// The cells that openings of the pin may cover, column by column.
fn feedings(source: &FilmSource, grid: &Grid) -> Vec<Feeding> {
    let on_pin = |opening: &usize| source.openings[*opening].on == Part::Pin;
    let openings: Vec<usize> = (0..source.openings.len()).filter(on_pin).collect();
    let mut found = Vec::new();
    if openings.is_empty() {
        return found;
    }
    for (at, cell) in grid.cells.iter().enumerate() {
        for opening in &openings {
            let [low, high] = source.openings[*opening].across;
            if cell.held.is_some() || cell.z <= low || cell.z >= high {
                continue;
            }
            let row = at % grid.across;
            let around = source.radius * cell.sector;
            let across = grid.heights[row + 1] - grid.heights[row];
            found.push(Feeding {
                cell: at,
                opening: *opening,
                weight: 2.0 * (around / across + across / around),
            });
        }
    }
    found
}

/// A place with its angle in one turn.
pub(crate) fn place(angle: f64, across: f64) -> Place {
    Place {
        angle: angle.rem_euclid(std::f64::consts::TAU),
        across,
    }
}

/// Angles closer than this are one line of the grid, rad. Angles in degrees, and sums of them, differ by
/// 1e-15 of a turn. The conductance of a cell as narrow as this would be millions of times that of its
/// neighbours, and would take the digits of the matrix.
const SAME_ANGLE: f64 = 1e-9;

/// The opening that holds the pressure in the middle of a cell at every turn of the pin: one of the shell, else a ring
/// groove of the pin.
fn held(source: &FilmSource, angle: f64, z: f64) -> Option<usize> {
    let on = |part: Part| {
        let mut openings = source.openings.iter();
        openings.position(|opening| opening.on == part && covers(opening, angle, z))
    };
    on(Part::Shell).or_else(|| on(Part::Pin))
}

/// Whether an opening covers the middle of a cell at every turn of the pin.
fn covers(opening: &Opening, angle: f64, z: f64) -> bool {
    let [from, to] = opening.around;
    let [low, high] = opening.across;
    (opening.on == Part::Shell || opening.all_around())
        && to > from
        && low < z
        && z < high
        && (angle - from).rem_euclid(std::f64::consts::TAU) < to - from
}

/// Whether an opening is a line at this angle.
fn is_line(opening: &Opening, angle: f64, z: f64) -> bool {
    let [from, to] = opening.around;
    let [low, high] = opening.across;
    let turn = std::f64::consts::TAU;
    let beside = (angle - from + turn / 2.0).rem_euclid(turn) - turn / 2.0;
    opening.on == Part::Shell && to == from && low < z && z < high && beside.abs() < SAME_ANGLE
}

/// Cells for each stretch between edges, so that the largest cell becomes as small as it can. A stretch of length zero
/// keeps one. Stretches that are the same from both ends get the same cells: else a symmetric bearing would tilt.
fn share(stretches: &[f64], cells: usize) -> Vec<usize> {
    let mut shares = vec![1; stretches.len()];
    // equal stretches differ by rounding, and so do the sizes below: as for [`SAME_ANGLE`]
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (a + b);
    let (count, middle) = (stretches.len(), stretches.len() / 2);
    let mirrored = (0..middle).all(|at| near(stretches[at], stretches[count - 1 - at]));
    let mut left = cells.saturating_sub(count);
    while left > 0 {
        let size = |at: usize| stretches[at] / shares[at] as f64;
        let Some(largest) = (0..count).reduce(|best, at| {
            // of stretches that are equal but for rounding the first counts
            if size(at) > size(best) * (1.0 + 1e-9) {
                at
            } else {
                best
            }
        }) else {
            break;
        };
        let other = count - 1 - largest;
        if mirrored && other != largest && left > 1 {
            shares[other] += 1;
            left -= 1;
        } else if mirrored && other != largest && count % 2 == 1 {
            // one cell for two stretches: the middle takes it
            shares[middle] += 1;
            break;
        }
        shares[largest] += 1;
        left -= 1;
    }
    shares
}

/// Lines of equal cells between edges; the first and the last edge are lines too. One cell serves a stretch whose middle is
/// open all around: it has no film.
fn between(edges: &[f64], cells: usize, open: impl Fn(f64) -> bool) -> Vec<f64> {
    let length = |pair: &[f64]| match open((pair[0] + pair[1]) / 2.0) {
        true => 0.0,
        false => pair[1] - pair[0],
    };
    let stretches: Vec<f64> = edges.windows(2).map(length).collect();
    let mut lines = Vec::with_capacity(cells + 1);
    for (stretch, share) in edges.windows(2).zip(share(&stretches, cells)) {
        for line in 0..share {
            lines.push(stretch[0] + (stretch[1] - stretch[0]) * line as f64 / share as f64);
        }
    }
    lines.extend(edges.last());
    lines
}

/// Stated lines that rise from one number to another and meet all edges.
fn stated(
    direction: &'static str,
    lines: &[f64],
    from: f64,
    to: f64,
    edges: &[f64],
    least: usize,
) -> Result<Vec<f64>, SourceError> {
    // stated lines meet edges but for rounding: as for [`SAME_ANGLE`]
    let near = 1e-9 * (to - from);
    let at = |line: &f64, end: f64| (line - end).abs() <= near;
    let meets = |edge: &f64| lines.iter().any(|line| at(line, *edge));
    if lines.len() <= least {
        return Err(SourceError::TooFewLines {
            direction,
            lines: lines.len(),
            needed: least + 1,
        });
    }
    let refuse = |at: f64, range: &'static str| {
        Err(SourceError::Line {
            direction,
            at,
            range,
        })
    };
    if let Some(pair) = lines
        .windows(2)
        .find(|pair| pair[1].is_nan() || pair[1] <= pair[0])
    {
        return refuse(pair[1], "above the one before it");
    }
    for (line, end) in [(lines.first(), from), (lines.last(), to)] {
        if let Some(line) = line.filter(|line| !at(line, end)) {
            return refuse(
                *line,
                "at the end of the film, because it is the first or the last line",
            );
        }
    }
    if let Some(edge) = edges.iter().find(|edge| !meets(edge)) {
        return Err(SourceError::NoLineAtEdge {
            direction,
            edge: *edge,
        });
    }
    Ok(lines.to_vec())
}

/// Least number of cells around: with two, both neighbours of a cell would be one. Four is the next even
/// number.
const LEAST_AROUND: usize = 4;

/// Lines around (rad), rising over one turn from the first edge of an opening, or stated ones.
fn lines_around(source: &FilmSource, lines: &Lines) -> Result<Vec<f64>, SourceError> {
    let turn = std::f64::consts::TAU;
    let mut edges: Vec<f64> = source
        .openings
        .iter()
        .filter(|opening| opening.on == Part::Shell)
        .filter(|opening| opening.around[1] - opening.around[0] < turn - SAME_ANGLE)
        .flat_map(|opening| opening.around)
        .map(|edge| edge.rem_euclid(turn))
        .map(|edge| if turn - edge < SAME_ANGLE { 0.0 } else { edge })
        .collect();
    edges.sort_by(f64::total_cmp);
    edges.dedup_by(|next, edge| *next - *edge < SAME_ANGLE);
    match lines {
        Lines::At(lines) => stated("around", lines, 0.0, turn, &edges, LEAST_AROUND),
        Lines::Equal(cells) => {
            let needed = edges.len().max(LEAST_AROUND);
            if *cells < needed {
                return Err(SourceError::TooFewCells {
                    direction: "around",
                    cells: *cells,
                    needed,
                });
            }
            let first = edges.first().copied().unwrap_or(0.0);
            if edges.is_empty() {
                edges.push(first);
            }
            edges.push(first + turn);
            Ok(between(&edges, *cells, |_| false))
        }
    }
}

/// Lines across (m from mid width), rising from one end, or from mid width for half a bearing, to the other
/// end.
fn lines_across(source: &FilmSource, lines: &Lines) -> Result<Vec<f64>, SourceError> {
    let high = source.width / 2.0;
    let low = if source.half_width { 0.0 } else { -high };
    // closer edges are one line: as for [`SAME_ANGLE`]
    let near = 1e-9 * source.width;
    let mut edges: Vec<f64> = source
        .openings
        .iter()
        .flat_map(|opening| opening.across)
        .collect();
    edges.retain(|edge| *edge > low + near && *edge < high - near);
    edges.extend([low, high]);
    edges.sort_by(f64::total_cmp);
    edges.dedup_by(|next, edge| *next - *edge < near);
    match lines {
        Lines::At(lines) => stated("across", lines, low, high, &edges, 1),
        Lines::Equal(cells) => {
            let needed = edges.len() - 1;
            if *cells < needed {
                return Err(SourceError::TooFewCells {
                    direction: "across",
                    cells: *cells,
                    needed,
                });
            }
            let ring = |z: f64, o: &Opening| o.all_around() && covers(o, o.around[0], z);
            Ok(between(&edges, *cells, |z| {
                source.openings.iter().any(|opening| ring(z, opening))
            }))
        }
    }
}
