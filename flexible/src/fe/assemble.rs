//! Stiffness and mass of a mesh.
//!
//! The layout of the matrices comes first. Then all threads compute blocks of elements, and all threads add
//! them, each into its own columns and in the order of the elements. So a sum has the same order, and the
//! same bits, for any number of threads. Memory is that of the matrices and a few megabytes.

use super::beam::{self, BeamMass};
use super::check::{self, Role, role};
use super::connection;
use super::elastic::PlacedMaterial;
use super::form::{self, Form};
use super::freedoms::{FreedomMap, direction, is_isotropic};
use super::mass::Mass;
use super::pattern::{Layout, Pattern};
use super::rules::{MassRule, Rules, Table};
use super::shell::{self, Plate, Shell, ShellMatrices};
use super::solid::{self, PAIR, Present, pair};
use super::surface;
use crate::error::FlexibleError;
use crate::mesh::{
    BeamAxes, Element, ElementKind, Material, Mesh, Spring, Station, Variant, scalar_index,
};
use crate::sparse::SymmetricMatrix;

/// Number of elements computed at a time. A choice: enough for all threads, and their matrices fit in the
/// cache.
const BLOCK: usize = 1024;

/// Stiffness and mass of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembled {
    /// The places of each node's freedoms.
    pub freedoms: FreedomMap,
    /// Stiffness over full freedoms, basic axes (N/m, N, N m).
    pub stiffness: SymmetricMatrix,
    /// Mass over full freedoms.
    pub mass: Mass,
    /// Indices of shells that carry mass but no stiffness here.
    pub without_stiffness: Vec<u32>,
    /// Indices of nodes that nothing uses; they have no freedoms.
    pub unused_nodes: Vec<u32>,
}

/// Assembles a mesh in SI on as many threads as the machine has.
///
/// # Errors
/// Those of [`assemble_on`]. They use the ids of the file.
pub fn assemble(mesh: &Mesh, rules: &Rules) -> Result<Assembled, FlexibleError> {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    assemble_on(mesh, rules, threads)
}

/// Assembles a mesh in SI on a number of threads. The result does not depend on this number.
///
/// # Errors
/// Places that are not numbers, indices out of range, missing or senseless sections and materials, inverted
/// or flat elements (Jacobian at or below zero at an integration point of the stiffness), beams without
/// length or orientation, nodes with mass but without stiffness, parts that nothing connects, no mass at all.
pub fn assemble_on(mesh: &Mesh, rules: &Rules, threads: usize) -> Result<Assembled, FlexibleError> {
    check::check(mesh)?;
    form::check(mesh, rules.stiffness)?;
    let rules = &rules.for_mesh(mesh);
    let freedoms = FreedomMap::new(mesh, rules.stiffness)?;
    connection::check(mesh, &freedoms)?;
    let parts = Parts::new(mesh);
    let pattern = parts.pattern(mesh, &freedoms);
    let mut system = Assembly {
        layout: pattern.freedom_layout(&freedoms),
        stiffness: Vec::new(),
        mass: Vec::new(),
        pattern,
        freedoms: &freedoms,
        mesh,
    };
    system.stiffness = vec![0.0; system.layout.row.len()];
    system.mass = vec![0.0; system.pattern.diagonal(freedoms.all_nodes() as u32)];
    system.add_areas(&parts.areas, rules, threads.clamp(1, 64))?;
    let mut general = Vec::new();
    system.add_shells(&parts.shells, rules, &mut general)?;
    system.add_beams(&parts.beams, rules, &mut general)?;
    system.add_springs();
    system.add_inerters(&mut general);
    system.add_point_masses(&mut general);
    let node_layout = system.pattern.node_layout();
    let Assembly {
        layout,
        stiffness,
        mass,
        ..
    } = system;
    let solid = node_layout.with(mass)?;
    let general = if general.is_empty() {
        None
    } else {
        Some(SymmetricMatrix::from_triplets(freedoms.size(), &general)?)
    };
    let stiffness = layout.with(stiffness)?;
    let unused_nodes = (0..mesh.nodes.len() as u32)
        .filter(|node| freedoms.of(*node).is_empty())
        .collect();
    let mass = Mass::new(freedoms.clone(), solid, general)?;
    let total = mass.rigid(mesh).mass;
    if total.is_nan() || total <= 0.0 {
        return Err(FlexibleError::structure(
            "the structure has no mass".into(),
            "give its materials a density, in the file or by `material =` of the body",
        ));
    }
    Ok(Assembled {
        freedoms,
        stiffness,
        mass,
        without_stiffness: parts.coats,
        unused_nodes,
    })
}

/// Indices of the mesh's elements, by their kind of assembly.
#[derive(Default)]
struct Parts {
    /// Solids, and surfaces with mass alone.
    areas: Vec<u32>,
    shells: Vec<u32>,
    beams: Vec<u32>,
    /// The surfaces with mass alone.
    coats: Vec<u32>,
}

impl Parts {
    fn new(mesh: &Mesh) -> Self {
        let mut parts = Parts::default();
        for (index, element) in mesh.elements.iter().enumerate() {
            let index = index as u32;
            match role(mesh, element) {
                Some(Role::Solid(_)) => parts.areas.push(index),
                Some(Role::Coat(_)) => {
                    parts.areas.push(index);
                    parts.coats.push(index);
                }
                Some(Role::Shell(..)) => parts.shells.push(index),
                Some(Role::Beam(_)) => parts.beams.push(index),
                Some(Role::Facet) | None => {}
            }
        }
        parts
    }

    fn pattern(&self, mesh: &Mesh, freedoms: &FreedomMap) -> Pattern {
        let (mut start, mut nodes) = (vec![0], Vec::new());
        for &index in self.areas.iter().chain(&self.shells).chain(&self.beams) {
            let element = &mesh.elements[index as usize];
            nodes.extend_from_slice(present(mesh, freedoms, element).nodes());
            start.push(nodes.len());
        }
        for spring in &mesh.springs {
            let terms = spring.terms.iter();
            let mut own: Vec<u32> = terms
                .map(|(node, ..)| freedoms.place(*node) as u32)
                .collect();
            own.sort_unstable();
            own.dedup();
            nodes.extend(own);
            start.push(nodes.len());
        }
        Pattern::new(freedoms, &start, &nodes)
    }
}

/// The matrices during the assembly.
struct Assembly<'a> {
    mesh: &'a Mesh,
    freedoms: &'a FreedomMap,
    pattern: Pattern,
    layout: Layout,
    stiffness: Vec<f64>,
    mass: Vec<f64>,
}

/// Computed matrices of an element.
struct Computed {
    present: Present,
    /// Start of its pairs in the block's numbers.
    start: usize,
    stiff: bool,
}

impl Assembly<'_> {
    /// Adds solids and surfaces with mass alone.
    fn add_areas(
        &mut self,
        elements: &[u32],
        rules: &Rules,
        threads: usize,
    ) -> Result<(), FlexibleError> {
        let tables = Tables::new(self.mesh, elements, rules)?;
        let columns = self.split(threads);
        let mut faults = Vec::new();
        let mut numbers = Vec::new();
        for block in elements.chunks(BLOCK) {
            let mut computed = Vec::with_capacity(block.len());
            let mut total = 0;
            for &index in block {
                let element = &self.mesh.elements[index as usize];
                let present = present(self.mesh, self.freedoms, element);
                let pairs = pair(0, present.count);
                computed.push(Computed {
                    present,
                    start: total,
                    stiff: element.kind.is_solid(),
                });
                total += PAIR * pairs;
            }
            numbers.clear();
            numbers.resize(total, 0.0);
            self.compute(
                block,
                &computed,
                &tables,
                &mut numbers,
                threads,
                &mut faults,
            );
            if faults.is_empty() {
                self.scatter(&computed, &numbers, &columns);
            }
        }
        if faults.is_empty() {
            Ok(())
        } else {
            Err(solid::inverted(&faults))
        }
    }

    /// Computes the elements of a block. Each thread computes a run of them.
    fn compute(
        &self,
        block: &[u32],
        computed: &[Computed],
        tables: &Tables,
        numbers: &mut [f64],
        threads: usize,
        faults: &mut Vec<(u64, f64)>,
    ) {
        let share = block.len().div_ceil(threads).max(1);
        let mesh = self.mesh;
        // a system without threads has one
        if threads < 2 {
            faults.extend(compute_run(mesh, block, computed, tables, numbers));
            return;
        }
        std::thread::scope(|scope| {
            let mut rest = numbers;
            let mut running = Vec::with_capacity(threads);
            for (indices, computed) in block.chunks(share).zip(computed.chunks(share)) {
                let size: usize = computed
                    .iter()
                    .map(|element| PAIR * pair(0, element.present.count))
                    .sum();
                let (own, others) = rest.split_at_mut(size);
                rest = others;
                running
                    .push(scope.spawn(move || compute_run(mesh, indices, computed, tables, own)));
            }
            for thread in running {
                match thread.join() {
                    Ok(found) => faults.extend(found),
                    Err(panic) => std::panic::resume_unwind(panic),
                }
            }
        });
    }

    /// Bounds of nodes, one range for each thread. All ranges have about the same number of entries of the
    /// matrix.
    fn split(&self, threads: usize) -> Vec<u32> {
        let nodes = self.freedoms.all_nodes();
        let entries = self.layout.row.len();
        let mut bounds = vec![0];
        for thread in 1..threads {
            let target = entries / threads * thread;
            let column = self
                .layout
                .column_start
                .partition_point(|start| *start < target);
            let node = self
                .freedoms
                .owner(column)
                .map_or(nodes as u32, |(node, _)| node);
            bounds.push(node);
        }
        bounds.push(nodes as u32);
        bounds
    }

    /// Adds computed elements, each thread into its own columns.
    fn scatter(&mut self, computed: &[Computed], numbers: &[f64], bounds: &[u32]) {
        let (pattern, layout, freedoms) = (&self.pattern, &self.layout, self.freedoms);
        let mut stiffness = self.stiffness.as_mut_slice();
        let mut mass = self.mass.as_mut_slice();
        std::thread::scope(|scope| {
            for range in bounds.windows(2) {
                let first = |node: u32| layout.column_start[freedoms.of(node).start];
                let end = |node: u32| {
                    if node as usize == freedoms.all_nodes() {
                        layout.row.len()
                    } else {
                        first(node)
                    }
                };
                let (stiffness_base, mass_base) = (end(range[0]), pattern.diagonal(range[0]));
                let (own, others) =
                    std::mem::take(&mut stiffness).split_at_mut(end(range[1]) - stiffness_base);
                stiffness = others;
                let (own_mass, others) =
                    std::mem::take(&mut mass).split_at_mut(pattern.diagonal(range[1]) - mass_base);
                mass = others;
                let mut columns = Columns {
                    pattern,
                    layout,
                    freedoms,
                    stiffness: own,
                    stiffness_base,
                    mass: own_mass,
                    mass_base,
                };
                let nodes = range[0]..range[1];
                if nodes.is_empty() {
                    continue;
                }
                let mut add = move || {
                    for element in computed {
                        columns.add(element, numbers, &nodes);
                    }
                };
                match bounds.len() {
                    2 => add(),
                    _ => drop(scope.spawn(add)),
                }
            }
        });
    }

    /// Adds shells. Their mass is the same in all directions, except for the rotary inertia.
    fn add_shells(
        &mut self,
        shells: &[u32],
        rules: &Rules,
        mass: &mut Vec<(u32, u32, f64)>,
    ) -> Result<(), FlexibleError> {
        let mut faults = Vec::new();
        let rotations = form::rotations(self.mesh, rules.stiffness);
        for &index in shells {
            let element = &self.mesh.elements[index as usize];
            let Some(Role::Shell(sheet)) = role(self.mesh, element) else {
                continue;
            };
            let present = present(self.mesh, self.freedoms, element);
            let places = present.places(self.mesh);
            let plate = Plate::new(&sheet);
            let drilling = element.variant == Variant::Drilling;
            let shell = Shell::new(element.kind, &present, &places, drilling, rotations, &plate);
            match shell.matrices(rules.mass) {
                Ok(matrices) => self.add_shell(present.nodes(), &matrices, mass),
                Err(area) => faults.push((element.id, area)),
            }
        }
        match faults.is_empty() {
            true => Ok(()),
            false => Err(shell::folded(&faults)),
        }
    }

    fn add_shell(
        &mut self,
        nodes: &[u32],
        matrices: &ShellMatrices,
        mass: &mut Vec<(u32, u32, f64)>,
    ) {
        for (b, &second) in nodes.iter().enumerate() {
            for (a, &first) in nodes.iter().enumerate() {
                let (rows, columns) = (self.freedoms.of(first), self.freedoms.of(second));
                if first < second {
                    continue;
                }
                // one triangle is stored, so both halves of a pair of corners at one node are on its diagonal
                let place = match first == second {
                    true => Some(self.pattern.diagonal(first)),
                    false => self.pattern.pair(second, first).map(|pair| pair.entry),
                };
                if let Some(place) = place {
                    self.mass[place] += matrices.mass[a][b];
                }
                for (i, row) in rows.clone().enumerate() {
                    for (j, column) in columns.clone().enumerate() {
                        if row < column {
                            continue;
                        }
                        let value = matrices.stiffness[6 * a + i][6 * b + j];
                        self.add_stiffness(row, column, value);
                        let inertia = match (i.checked_sub(3), j.checked_sub(3)) {
                            (Some(i), Some(j)) => Some(matrices.rotary[a][b][i][j]),
                            (None, Some(j)) => matrices.coupling.as_ref().map(|c| c[a][b][i][j]),
                            (Some(i), None) => matrices.coupling.as_ref().map(|c| c[b][a][j][i]),
                            (None, None) => None,
                        };
                        if let Some(inertia) = inertia {
                            mass.push((row as u32, column as u32, inertia));
                        }
                    }
                }
            }
        }
    }

    fn add_beams(
        &mut self,
        beams: &[u32],
        rules: &Rules,
        mass: &mut Vec<(u32, u32, f64)>,
    ) -> Result<(), FlexibleError> {
        for &index in beams {
            let element = self.mesh.elements[index as usize];
            let own = match rules.mass {
                MassRule::Nastran => BeamMass::Lumped {
                    turns: element.variant == Variant::Beam,
                },
                MassRule::Coupled if element.variant != Variant::Beam => BeamMass::Coupled,
                _ => BeamMass::Consistent,
            };
            let matrices = of_beam(
                self.mesh,
                &element,
                |positions, axes, stations, material| {
                    let own = match own {
                        // Nastran's rule for the lumped mass of a tapered beam is not public
                        BeamMass::Lumped { .. } if stations.len() > 1 => BeamMass::Consistent,
                        own => own,
                    };
                    beam::matrices(positions, axes, stations, material, own)
                },
            )?;
            let nodes = self.mesh.nodes_of(&element);
            let freedoms: Vec<usize> = nodes
                .iter()
                .flat_map(|&node| self.freedoms.of(node))
                .collect();
            for (i, &row) in freedoms.iter().enumerate() {
                for (j, &column) in freedoms.iter().enumerate() {
                    // only one triangle is stored; a beam from a node to itself adds both halves of a pair to
                    // it
                    if row < column {
                        continue;
                    }
                    self.add_stiffness(row, column, matrices.stiffness[i][j]);
                    if matrices.mass[i][j] != 0.0 {
                        mass.push((row as u32, column as u32, matrices.mass[i][j]));
                    }
                }
            }
        }
        Ok(())
    }

    fn add_stiffness(&mut self, row: usize, column: usize, value: f64) {
        if let Some(entry) = self.layout.entry(row, column) {
            self.stiffness[entry] += value;
        }
    }

    /// Adds springs: the force k Σ c d·q along the directions d of the components in basic axes.
    fn add_springs(&mut self) {
        for spring in &self.mesh.springs {
            let terms = self.extension(spring);
            for (i, &(row, x)) in terms.iter().enumerate() {
                for &(column, y) in &terms[..=i] {
                    self.add_stiffness(row, column, spring.stiffness * x * y);
                }
            }
        }
    }

    /// Adds masses m of differences of freedoms: m times the square of the rate of the extension is twice the
    /// kinetic energy.
    fn add_inerters(&self, mass: &mut Vec<(u32, u32, f64)>) {
        for inerter in &self.mesh.inerters {
            let terms = self.extension(inerter);
            for (i, &(row, x)) in terms.iter().enumerate() {
                for &(column, y) in &terms[..=i] {
                    let value = inerter.stiffness * x * y;
                    if value != 0.0 {
                        mass.push((row as u32, column as u32, value));
                    }
                }
            }
        }
    }

    /// The extension of a spring as a sum over freedoms in basic axes, in m for translations and rad for
    /// rotations.
    fn extension(&self, spring: &Spring) -> Vec<(usize, f64)> {
        let mut terms: Vec<(usize, f64)> = Vec::with_capacity(12);
        let mut add =
            |freedom: usize, x: f64| match terms.iter_mut().find(|(known, _)| *known == freedom) {
                Some((_, sum)) => *sum += x,
                None => terms.push((freedom, x)),
            };
        for &(node, component, sign) in &spring.terms {
            let first = self.freedoms.of(node).start + 3 * usize::from(component / 3);
            if scalar_index(node).is_some() {
                add(first, sign);
                continue;
            }
            for (axis, x) in direction(self.mesh, node, component)
                .into_iter()
                .enumerate()
            {
                add(first + axis, sign * x);
            }
        }
        terms
    }

    fn add_point_masses(&mut self, general: &mut Vec<(u32, u32, f64)>) {
        for point in &self.mesh.point_masses {
            if is_isotropic(point) {
                self.mass[self.pattern.diagonal(point.node)] += point.matrix[0][0];
                continue;
            }
            let first = self.freedoms.of(point.node).start as u32;
            for i in 0..6u32 {
                for j in 0..=i {
                    let (i, j) = (i as usize, j as usize);
                    let value = 0.5 * (point.matrix[i][j] + point.matrix[j][i]);
                    if value != 0.0 {
                        general.push((first + i as u32, first + j as u32, value));
                    }
                }
            }
        }
    }
}

/// A result for a beam of a checked mesh: [`beam::matrices`], [`beam::tension`].
pub(crate) fn of_beam<T>(
    mesh: &Mesh,
    element: &Element,
    what: impl Fn([[f64; 3]; 2], &BeamAxes, &[Station], &Material) -> Result<T, String>,
) -> Result<T, FlexibleError> {
    let fault = |what: String| {
        FlexibleError::structure(
            format!("beam {}: {what}", element.id),
            "check its nodes, offsets, orientation and releases",
        )
    };
    let property = &mesh.properties[element.property as usize];
    let (Some(Role::Beam(material)), Some(axes), &[first, second]) = (
        role(mesh, element),
        element
            .beam
            .and_then(|index| mesh.beam_axes.get(index as usize)),
        mesh.nodes_of(element),
    ) else {
        return Err(fault("it lacks nodes, axes or a material".into()));
    };
    if first == second {
        return Err(fault("it begins and ends at the same node".into()));
    }
    let positions = [first, second].map(|node| mesh.nodes[node as usize].position);
    what(positions, axes, &mesh.stations(&property.section), material).map_err(fault)
}

/// The nodes of an element, with the inner ones of its form.
pub(super) fn present(mesh: &Mesh, freedoms: &FreedomMap, element: &Element) -> Present {
    let inner = freedoms.inner_of(element.first);
    Present::new(element.kind, mesh.nodes_of(element)).with_inner(inner)
}

/// Shape functions at the integration points of the elements of a mesh.
struct Tables {
    tables: Vec<((ElementKind, Variant), Table)>,
}

impl Tables {
    fn new(mesh: &Mesh, elements: &[u32], rules: &Rules) -> Result<Self, FlexibleError> {
        let mut tables: Vec<((ElementKind, Variant), Table)> = Vec::new();
        for &index in elements {
            let element = &mesh.elements[index as usize];
            let key = (element.kind, element.variant);
            if tables.iter().any(|(known, _)| *known == key) {
                continue;
            }
            let form = if element.kind.is_solid() {
                form::form(mesh, element, rules.stiffness)?
            } else {
                Form::Full
            };
            let mass = form::mass_rule(mesh, element, rules);
            tables.push((key, Table::new(element.kind, form, mass)));
        }
        Ok(Tables { tables })
    }

    fn of(&self, element: &Element) -> Option<&Table> {
        let key = (element.kind, element.variant);
        self.tables
            .iter()
            .find(|(known, _)| *known == key)
            .map(|(_, table)| table)
    }
}

/// Computes a run of elements. Returns the ids and Jacobians of the inverted ones.
fn compute_run(
    mesh: &Mesh,
    indices: &[u32],
    computed: &[Computed],
    tables: &Tables,
    numbers: &mut [f64],
) -> Vec<(u64, f64)> {
    let mut faults = Vec::new();
    let mut rest = numbers;
    for (&index, computed) in indices.iter().zip(computed) {
        let element = &mesh.elements[index as usize];
        let present = &computed.present;
        let (blocks, others) =
            std::mem::take(&mut rest).split_at_mut(PAIR * pair(0, present.count));
        rest = others;
        let Some(table) = tables.of(element) else {
            continue;
        };
        let places = present.places(mesh);
        let result = match role(mesh, element) {
            Some(Role::Solid(material)) => {
                let placed = PlacedMaterial {
                    material,
                    origin: present.origin(mesh),
                };
                solid::add_matrices(table, present, &places, placed, blocks)
            }
            Some(Role::Coat(mass)) => surface::add_matrices(table, present, &places, mass, blocks),
            _ => Ok(()),
        };
        if let Err(jacobian) = result {
            faults.push((element.id, jacobian));
        }
    }
    faults
}

/// The columns of some nodes.
struct Columns<'a> {
    pattern: &'a Pattern,
    layout: &'a Layout,
    freedoms: &'a FreedomMap,
    stiffness: &'a mut [f64],
    /// Index of the first entry in the whole matrix.
    stiffness_base: usize,
    mass: &'a mut [f64],
    mass_base: usize,
}

impl Columns<'_> {
    /// Adds the entries of an element in the columns of these nodes.
    fn add(&mut self, element: &Computed, numbers: &[f64], nodes: &std::ops::Range<u32>) {
        let own = element.present.nodes();
        for (b, &second) in own.iter().enumerate() {
            for (a, &first) in own[..=b].iter().enumerate() {
                let low = first.min(second);
                if !nodes.contains(&low) {
                    continue;
                }
                let block = &numbers[element.start + PAIR * pair(a, b)..][..PAIR];
                if first == second {
                    self.add_diagonal(first, block, a == b, element.stiff);
                } else {
                    self.add_pair(first, second, block, element.stiff);
                }
            }
        }
    }

    fn add_diagonal(&mut self, node: u32, block: &[f64], same: bool, stiff: bool) {
        // if two corners share a node, both halves of their pair are in the node's own block
        let factor = if same { 1.0 } else { 2.0 };
        self.mass[self.pattern.diagonal(node) - self.mass_base] += factor * block[9];
        if !stiff {
            return;
        }
        let freedom = self.freedoms.of(node).start;
        for column in 0..3 {
            let start = self.layout.column_start[freedom + column] - self.stiffness_base;
            for row in column..3 {
                let mirrored = if same { 0.0 } else { block[3 * column + row] };
                self.stiffness[start + row - column] += block[3 * row + column] + mirrored;
            }
        }
    }

    fn add_pair(&mut self, first: u32, second: u32, block: &[f64], stiff: bool) {
        let low = first.min(second);
        let Some(pair) = self.pattern.pair(low, first.max(second)) else {
            return;
        };
        self.mass[pair.entry - self.mass_base] += block[9];
        if !stiff {
            return;
        }
        let freedoms = self.freedoms.of(low);
        for column in 0..3 {
            let start = self.layout.column_start[freedoms.start + column] - self.stiffness_base
                + freedoms.len()
                - column
                + pair.before;
            let entries = &mut self.stiffness[start..start + 3];
            for (row, entry) in entries.iter_mut().enumerate() {
                // the block's rows are the first node's
                *entry += if first < second {
                    block[3 * column + row]
                } else {
                    block[3 * row + column]
                };
            }
        }
    }
}
