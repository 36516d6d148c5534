//! Elastic surfaces: the radial deflection of a round bore relative to its marker, in shapes, and its compliance.
//!
//! With the shapes ψ_j of the surface, the shape functions N of its faces and the direction n away from the axis, the
//! amplitudes of a nodal displacement u are its least-squares fit `b = G⁻¹ ∫ ψ n·N u dA` with the Gram matrix
//! `G_ij = ∫ ψ_i ψ_j dA`. The nodal loads `L = (G⁻¹ ∫ ψ n·N dA)ᵀ` of unit generalised forces are dual to
//! them: `b = Lᵀ u`, and `Lᵀ` of a pressure's nodal loads is its generalised force `∫ p ψ dA` where the
//! pressure lies in the shapes' span. The marker takes the resultant of each load back through its tie, so
//! loads are in balance, amplitudes are relative to the marker's rigid motion, and the marker's wrench and
//! these forces together are the pressure on the bore.
//!
//! Lengths are metres, forces newtons; vectors are over the free freedoms.

use super::interface::{MarkerFreedoms, cosines};
use super::{Request, gathered};
use crate::element::{ABSENT, ElementKind, MOST_NODES, Shape, quadrature};
use crate::error::{FlexibleError, Part};
use crate::fe::Reduction;
use crate::fe::solid::tangents;
use crate::fe::vector::{cross, dot, norm, subtract};
use crate::markers::{MarkerPlace, Selection, Spider};
use crate::mesh::Mesh;
use crate::modes::statics::attachment_modes_by;
use crate::modes::{Load, ModeSet, Structure};
use crate::solve::Shifted;
use crate::solve::dense::{positive_inverse, symmetric_eigen};
use crate::surface::outer_faces;
use eng_system::reduced::ReducedSurface;
use eng_system::surface::{SurfaceShape, SurfaceShapes};
use std::collections::{BTreeMap, BTreeSet};

/// A marker whose surface yields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceRequest {
    /// Index of the marker.
    pub marker: usize,
    /// The shapes of its surface.
    pub shapes: SurfaceShapes,
}

/// Share of the round surface that the faces of the mesh must cover. A choice: holes and grooves of a bearing
/// take less than a fifth; a bore with less was not the marker's.
const COVERED: f64 = 0.8;
/// Share below which a warning states the missing part. A choice: an oil hole takes less than 3 %, a groove
/// more.
const WHOLE: f64 = 0.97;
/// Least part of a face's normal along the radius: other faces are ends of the bore. A choice, 60°: faces of
/// the bore have nearly one, those of its ends nearly zero, and chamfers are between.
const RADIAL: f64 = 0.5;
/// Fewest nodes that a wave around must have. With two, its sine or its cosine may be zero at all nodes.
/// Four, a choice, resolve both.
const NODES_A_WAVE: f64 = 4.0;
/// Least eigenvalue of the scaled Gram matrix, so that nodes distinguish the shapes. A choice: beyond it
/// amplitudes would be a thousand times as sensitive to the nodes.
const APART: f64 = 1e-3;
/// Negative eigenvalue of a compliance, as a share of the largest one, that is more than rounding. A choice:
/// compliances come from solutions with some ten digits. A larger negative number would let the film drive
/// the surface.
const NEGATIVE: f64 = 1e-6;
/// Gauss points of a face in each direction. Four are exact to degree 7: for quadratic faces times waves that
/// [`NODES_A_WAVE`] allows. A choice.
const POINTS: usize = 4;

/// Nodes with their forces in the axes of the mesh (N).
type NodalLoad = Vec<(u32, [f64; 3])>;

/// The geometry of a surface: axis, zero angle and size.
#[derive(Clone, Copy, Debug)]
struct Bore {
    middle: [f64; 3],
    /// Unit vectors of θ = 0, θ = 90° and the axis.
    axes: [[f64; 3]; 3],
    radius: f64,
    width: f64,
}

/// A surface on the mesh, before the computation of modes.
pub(super) struct Prepared {
    request: SurfaceRequest,
    /// Name of the marker.
    name: String,
    bore: Bore,
    /// The share of the round surface that faces cover.
    covered: f64,
    /// For each shape the nodal loads of a unit generalised force (node, force in the mesh's axes).
    loads: Vec<NodalLoad>,
}

fn refuse(marker: usize, problem: String, advice: &str) -> FlexibleError {
    FlexibleError::structure(problem, advice).of(Part::Marker(marker))
}

impl Bore {
    fn new(request: &Request, surface: SurfaceRequest) -> Result<Bore, FlexibleError> {
        let marker = request.markers.get(surface.marker);
        let Some(marker) = marker else {
            return Err(refuse(
                surface.marker,
                format!("there is no marker {}", surface.marker),
                "",
            ));
        };
        let refused = |problem: &str, advice: &str| {
            refuse(
                surface.marker,
                format!("{}: {problem}", marker.name),
                advice,
            )
        };
        let MarkerPlace::Gathered {
            nodes:
                Selection::Ring {
                    center,
                    axis,
                    radius,
                    width,
                    ..
                },
            tie,
            ..
        } = &marker.place
        else {
            return Err(refused(
                "an elastic surface needs a ring of nodes",
                "gather the nodes by `ring(center:, axis:, radius:, width:)`",
            ));
        };
        if *tie == Spider::Rigid {
            return Err(refused(
                "a rigid tie holds the surface round: it cannot yield",
                "take `tie: averaging`, or leave the surface out",
            ));
        }
        let axes = [0, 1, 2].map(|axis| cosines(&marker.axes, axis));
        let along = dot(axes[2], *axis).abs() / norm(*axis);
        // an angle of 1.4e-3 rad: axes stated by nodes are as exact, and the waves do not change
        if along.is_nan() || along < 1.0 - 1e-6 {
            return Err(refused(
                "the z axis of the marker is not the axis of its ring: the angles of the shapes count about z",
                "turn the marker by `z:` to the axis of the ring",
            ));
        }
        Ok(Bore {
            middle: *center,
            axes,
            radius: *radius,
            width: *width,
        })
    }

    /// Angle, ζ and the direction away from the axis of a place. The angle in rad about the marker's z from
    /// its x, ζ = 2 z/B, and a unit vector in the mesh's axes.
    fn seen(&self, place: [f64; 3]) -> (f64, f64, [f64; 3]) {
        let from = subtract(place, self.middle);
        let [x, y, z] = self.axes.map(|axis| dot(axis, from));
        let distance = libm::hypot(x, y);
        let [ex, ey, _] = self.axes;
        let away = [0, 1, 2].map(|k| (x * ex[k] + y * ey[k]) / distance);
        (libm::atan2(y, x), 2.0 * z / self.width, away)
    }
}

/// The loads of all surfaces of a request.
///
/// # Errors
/// Markers that are no ring with an averaging tie about their z axis; surfaces that the faces of the mesh do
/// not cover, or whose nodes are too few for the shapes.
pub(super) fn prepare(
    mesh: &Mesh,
    request: &Request,
    places: &[u32],
) -> Result<Vec<Prepared>, FlexibleError> {
    if request.surfaces.is_empty() {
        return Ok(Vec::new());
    }
    let faces = outer_faces(mesh);
    let prepared = request.surfaces.iter().map(|surface| {
        let bore = Bore::new(request, *surface)?;
        let name = &request.markers[surface.marker].name;
        let nodes: BTreeSet<u32> = gathered(mesh, places.get(surface.marker)).collect();
        let each: Vec<SurfaceShape> = surface.shapes.each().collect();
        let mut sums = Sums::new(each.len());
        for face in &faces {
            sums.add_face(mesh, *face, &nodes, &bore, &each);
        }
        let covered = sums.area / (std::f64::consts::TAU * bore.radius * bore.width);
        if covered.is_nan() || covered < COVERED {
            return Err(refuse(
                surface.marker,
                format!(
                    "{name}: faces of the mesh cover {:.0} % of the ring's surface, so the pressure of a film has no wall on the rest",
                    100.0 * covered
                ),
                "check centre, radius and width of the ring, or widen its tolerance",
            ));
        }
        if sums.convex > 0.5 * sums.area {
            return Err(refuse(
                surface.marker,
                format!(
                    "{name}: the surface is the outside of a shaft: the body is inside of it, and a film presses on a bore outwards"
                ),
                "state the ring of a bore, or leave out the `surface`: the surface of a pin is rigid",
            ));
        }
        enough_nodes(mesh, &nodes, &bore, &sums, *surface, name)?;
        Ok(Prepared {
            request: *surface,
            name: name.clone(),
            bore,
            covered,
            loads: sums.loads(*surface, name)?,
        })
    });
    prepared.collect()
}

/// Refuses shapes that the nodes cannot follow: a wave around needs [`NODES_A_WAVE`] nodes, and a degree n
/// across needs n equal steps. The nodes of one face count, because in a mesh without rows the nodes of many
/// faces lie close to each other in angle or height.
fn enough_nodes(
    mesh: &Mesh,
    nodes: &BTreeSet<u32>,
    bore: &Bore,
    sums: &Sums,
    surface: SurfaceRequest,
    name: &str,
) -> Result<(), FlexibleError> {
    let mut angles: Vec<f64> = nodes
        .iter()
        .filter_map(|node| mesh.nodes.get(*node as usize))
        .map(|node| bore.seen(node.position).0)
        .collect();
    angles.sort_by(f64::total_cmp);
    let turn = std::f64::consts::TAU;
    let last = angles.last().copied().unwrap_or(0.0);
    let around = angles.first().map_or(turn, |first| first + turn - last);
    let widest = angles
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .fold(around.max(sums.steps[0]), f64::max);
    // rounding of positions does not count
    let most = turn / (NODES_A_WAVE * widest) * (1.0 + 1e-6);
    if f64::from(surface.shapes.around) > most {
        return Err(refuse(
            surface.marker,
            format!(
                "{name}: the mesh has a gap of {:.1}° between the nodes around the ring: that is too coarse for {} waves",
                widest.to_degrees(),
                surface.shapes.around
            ),
            &format!(
                "state at most `waves_around: {}`, or refine the mesh",
                most as u32
            ),
        ));
    }
    // the number of equal steps of this length across the width, which is 2 in ζ
    // rounding of positions does not count
    let most = 2.0 / sums.steps[1] * (1.0 + 1e-6);
    if f64::from(surface.shapes.across) > most {
        return Err(refuse(
            surface.marker,
            format!(
                "{name}: the mesh has nodes {:.2} mm apart across the ring: that is too coarse for degree {}",
                0.5e3 * sums.steps[1] * bore.width,
                surface.shapes.across
            ),
            &format!(
                "state at most `degree_across: {}`, or refine the mesh",
                most as u32
            ),
        ));
    }
    Ok(())
}

/// Integrals over the faces of a surface.
struct Sums {
    count: usize,
    /// m².
    area: f64,
    /// The part of the area whose solid elements are nearer to the axis than their faces (m²).
    convex: f64,
    /// Widest steps between neighbouring nodes of a face: in angle (rad) and in ζ.
    steps: [f64; 2],
    /// ∫ ψ_i ψ_j dA, row by row.
    gram: Vec<f64>,
    /// ∫ ψ_j n N dA of each node, shape after shape.
    nodal: BTreeMap<u32, Vec<[f64; 3]>>,
}

impl Sums {
    fn new(count: usize) -> Sums {
        Sums {
            count,
            area: 0.0,
            convex: 0.0,
            steps: [0.0; 2],
            gram: vec![0.0; count * count],
            nodal: BTreeMap::new(),
        }
    }

    /// Adds a face, if all of its nodes are on the surface.
    fn add_face(
        &mut self,
        mesh: &Mesh,
        (element, face): (u32, usize),
        on_surface: &BTreeSet<u32>,
        bore: &Bore,
        shapes: &[SurfaceShape],
    ) {
        let Some((kind, nodes)) = face_nodes(mesh, element, face) else {
            return;
        };
        let known = |node: &u32| *node == ABSENT || on_surface.contains(node);
        if !nodes.iter().all(known) {
            return;
        }
        let mut places = [[0.0; 3]; MOST_NODES];
        for (place, node) in places.iter_mut().zip(&nodes) {
            if let Some(node) = mesh.nodes.get(*node as usize) {
                *place = node.position;
            }
        }
        let corners = kind.corner_count();
        // The mean of a face's corners lies on a chord, inside of the arc of the bore, perhaps by more than a
        // thin wall is thick. The mean of the element's corners lies inside of its arc alike, so these two
        // are compared.
        let own = mean(&places[..corners.min(nodes.len())]);
        let (_, _, out) = bore.seen(own);
        let convex =
            solid_middle(mesh, element).is_some_and(|of| dot(subtract(of, own), out) < 0.0);
        let points = match corners {
            3 => quadrature::triangle(POINTS),
            _ => quadrature::quadrilateral(POINTS),
        };
        let seen = points.into_iter().map(|point| {
            let mut functions = Shape::at(kind, point.at);
            for (local, node) in nodes.iter().enumerate() {
                if *node == ABSENT {
                    functions.remove_midside(kind, local);
                }
            }
            let mut place = [0.0; 3];
            for (value, node) in functions.values.iter().zip(&places).take(nodes.len()) {
                for (x, y) in place.iter_mut().zip(node) {
                    *x += value * y;
                }
            }
            let [r, s, _] = tangents(&functions, &places, nodes.len());
            let normal = cross(r, s);
            let (angle, zeta, away) = bore.seen(place);
            let size = norm(normal);
            let radial = dot(normal, away).abs() >= RADIAL * size;
            radial.then_some((functions, point.weight * size, angle, zeta, away))
        });
        // a face counts as a whole or not at all
        let Some(seen) = seen.collect::<Option<Vec<_>>>() else {
            return;
        };
        for (functions, area, angle, zeta, away) in seen {
            self.area += area;
            if convex {
                self.convex += area;
            }
            let values: Vec<f64> = shapes
                .iter()
                .map(|shape| shape.value(angle, zeta))
                .collect();
            for (i, x) in values.iter().enumerate() {
                for (j, y) in values.iter().enumerate() {
                    self.gram[i * self.count + j] += x * y * area;
                }
            }
            for (node, share) in nodes.iter().zip(functions.values) {
                if *node == ABSENT {
                    continue;
                }
                let count = self.count;
                let own = (self.nodal.entry(*node)).or_insert_with(|| vec![[0.0; 3]; count]);
                for (sum, value) in own.iter_mut().zip(&values) {
                    for (x, direction) in sum.iter_mut().zip(away) {
                        *x += value * share * direction * area;
                    }
                }
            }
        }
        for (local, place) in places.iter().enumerate().take(corners) {
            let middle = nodes
                .get(corners + local)
                .is_some_and(|node| *node != ABSENT);
            self.add_side(bore, [*place, places[(local + 1) % corners]], middle);
        }
    }

    /// The step between the nodes of a side of a face, with or without a node in its middle.
    fn add_side(&mut self, bore: &Bore, ends: [[f64; 3]; 2], middle: bool) {
        let [(angle, zeta, _), (other, up, _)] = ends.map(|end| bore.seen(end));
        let (turn, parts) = (std::f64::consts::TAU, if middle { 2.0 } else { 1.0 });
        let turned = (angle - other).abs();
        for (step, size) in [turned.min(turn - turned), (zeta - up).abs()]
            .into_iter()
            .enumerate()
        {
            self.steps[step] = self.steps[step].max(size / parts);
        }
    }

    /// The nodal loads of unit generalised forces.
    fn loads(&self, surface: SurfaceRequest, name: &str) -> Result<Vec<NodalLoad>, FlexibleError> {
        let count = self.count;
        let inverse = positive_inverse(count, &self.gram, APART)?.map_err(|_| {
            refuse(
                surface.marker,
                format!("{name}: the faces of the ring are too few to distinguish its shapes"),
                "state fewer waves around or a lower degree across, or refine the mesh",
            )
        })?;
        let load = |shape: usize| -> NodalLoad {
            let of_node = |(node, sums): (&u32, &Vec<[f64; 3]>)| {
                let mut force = [0.0; 3];
                for (factor, sum) in inverse[shape * count..(shape + 1) * count].iter().zip(sums) {
                    for (x, y) in force.iter_mut().zip(sum) {
                        *x += factor * y;
                    }
                }
                (*node, force)
            };
            self.nodal.iter().map(of_node).collect()
        };
        Ok((0..count).map(load).collect())
    }
}

/// The mean place of the corners of a solid element; none for a shell.
fn solid_middle(mesh: &Mesh, element: u32) -> Option<[f64; 3]> {
    let element = mesh.elements.get(element as usize)?;
    if element.kind.description().faces.len() < 4 {
        return None;
    }
    let corners = mesh.nodes_of(element).iter();
    let places: Vec<[f64; 3]> = corners
        .take(element.kind.corner_count())
        .filter_map(|node| Some(mesh.nodes.get(*node as usize)?.position))
        .collect();
    Some(mean(&places))
}

/// The mean of places.
fn mean(places: &[[f64; 3]]) -> [f64; 3] {
    let sum = |axis: usize| places.iter().map(|place| place[axis]).sum::<f64>();
    [0, 1, 2].map(|axis| sum(axis) / places.len() as f64)
}

/// The element of a face, and its nodes: corners, then mid-side nodes, [`ABSENT`] where there is none.
fn face_nodes(mesh: &Mesh, element: u32, face: usize) -> Option<(ElementKind, Vec<u32>)> {
    let element = mesh.elements.get(element as usize)?;
    let corners = element.kind.description().faces.get(face)?;
    let ring = crate::element::around(element.kind, mesh.nodes_of(element), corners);
    let middles: Vec<u32> = ring
        .iter()
        .map(|(_, middle)| middle.unwrap_or(ABSENT))
        .collect();
    let mut nodes: Vec<u32> = ring.iter().map(|(corner, _)| *corner).collect();
    let curved = middles.iter().any(|node| *node != ABSENT);
    let kind = ElementKind::of_face(nodes.len(), curved)?;
    if curved {
        nodes.extend(middles);
    }
    Some((kind, nodes))
}

/// A surface with the answers to its loads.
pub(super) struct Answered {
    prepared: Prepared,
    rows: Vec<Load>,
    /// Amplitude of each shape at rest under each load, row by row (m/N), by all modes of the mesh.
    compliance: Vec<f64>,
}

/// The mesh with its freedoms, for the loads of surfaces.
pub(super) struct Places<'a> {
    pub mesh: &'a Mesh,
    pub markers: &'a MarkerFreedoms<'a>,
    pub reduction: &'a Reduction,
}

impl Prepared {
    /// The loads with the marker's reaction as rows over the free freedoms.
    fn rows(&self, places: &Places<'_>) -> Vec<Load> {
        let Places {
            mesh,
            markers,
            reduction,
        } = *places;
        let node = markers.places.get(self.request.marker).copied();
        let node = node.unwrap_or_default();
        let middle = mesh
            .nodes
            .get(node as usize)
            .map_or([0.0; 3], |node| node.position);
        let rows = self.loads.iter().enumerate().map(|(shape, forces)| {
            let mut sum: BTreeMap<u32, f64> = BTreeMap::new();
            let mut resultant = [0.0; 6];
            let mut add = |node: u32, component: u8, force: f64| {
                let Some(freedom) = markers.freedoms.freedom(node, component) else {
                    return;
                };
                let (rows, factors) = reduction.row(freedom);
                for (row, factor) in rows.iter().zip(factors) {
                    *sum.entry(*row).or_insert(0.0) += factor * force;
                }
            };
            for (node, force) in forces {
                let place = mesh
                    .nodes
                    .get(*node as usize)
                    .map_or(middle, |node| node.position);
                let moment = cross(subtract(place, middle), *force);
                for (x, y) in resultant.iter_mut().zip(force.iter().chain(&moment)) {
                    *x += y;
                }
                for (component, force) in (0..).zip(force) {
                    add(*node, component, *force);
                }
            }
            for (component, force) in (0..).zip(resultant) {
                add(node, component, -force);
            }
            Load {
                label: format!("surface {shape}"),
                entries: sum.into_iter().filter(|(_, x)| *x != 0.0).collect(),
            }
        });
        rows.collect()
    }

    /// Solves the loads. `near` is a factor that serves all surfaces.
    pub(super) fn answered(
        self,
        structure: &Structure,
        places: &Places<'_>,
        near: &mut Option<Shifted>,
    ) -> Result<Answered, FlexibleError> {
        let rows = self.rows(places);
        let answers = attachment_modes_by(near, structure, &rows)?;
        let size = structure.size().max(1);
        let compliance = rows
            .iter()
            .flat_map(|row| {
                answers
                    .chunks_exact(size)
                    .map(|answer| row.displacement(answer))
            })
            .collect();
        Ok(Answered {
            prepared: self,
            rows,
            compliance,
        })
    }

    /// The surface before the computation of modes: without compliance, on `modes` modes that do not move it.
    pub(super) fn stiff(&self, modes: usize) -> ReducedSurface {
        let count = self.loads.len();
        ReducedSurface {
            marker: self.request.marker,
            shapes: self.request.shapes,
            radius: self.bore.radius,
            width: self.bore.width,
            content: vec![0.0; count * modes],
            compliance: vec![0.0; count * count],
            static_compliance: vec![0.0; count * count],
        }
    }
}

/// The surfaces beside a set of modes, and warnings about faces that they lack.
pub(super) fn beside(
    answered: &[Answered],
    structure: &Structure,
    set: &ModeSet,
    warnings: &mut Vec<String>,
) -> Result<Vec<ReducedSurface>, FlexibleError> {
    let surfaces = answered.iter();
    surfaces
        .map(|surface| surface.beside(structure, set, warnings))
        .collect()
}

impl Answered {
    /// The surface beside a set of modes, and a warning about faces that it lacks.
    ///
    /// A mode k of the set, with unit modal mass and the eigenvalue λ_k ((rad/s)²), moves the surface by the
    /// amplitudes `c_k = Lᵀ φ_k` (m/√kg; [`ReducedSurface::content`]). So the modes alone have the compliance
    /// `Σ c_k c_kᵀ/λ_k` (m/N). The compliance beside them is the static one less this sum.
    fn beside(
        &self,
        structure: &Structure,
        set: &ModeSet,
        warnings: &mut Vec<String>,
    ) -> Result<ReducedSurface, FlexibleError> {
        let (count, size) = (self.rows.len(), structure.size().max(1));
        let mut surface = self.prepared.stiff(set.len());
        for (row, line) in self
            .rows
            .iter()
            .zip(surface.content.chunks_exact_mut(set.len().max(1)))
        {
            for (x, mode) in line.iter_mut().zip(set.vectors.chunks_exact(size)) {
                *x = row.displacement(mode);
            }
        }
        let content = |shape: usize| &surface.content[shape * set.len()..(shape + 1) * set.len()];
        let mut rest = vec![0.0; count * count];
        let whole = &mut surface.static_compliance;
        for i in 0..count {
            for j in 0..count {
                let both = self.compliance[i * count + j] + self.compliance[j * count + i];
                let spanned = content(i).iter().zip(content(j)).zip(&set.eigenvalues);
                let spanned: f64 = spanned.map(|((x, y), lambda)| x * y / lambda).sum();
                whole[i * count + j] = 0.5 * both;
                rest[i * count + j] = 0.5 * both - spanned;
            }
        }
        surface.compliance = self.positive(rest)?;
        if self.prepared.covered < WHOLE {
            warnings.push(format!(
                "{}: faces of the mesh cover {:.0} % of the elastic surface, and the pressure of a film on the rest moves \
                 no wall: check centre, radius and width of the ring, or widen its tolerance",
                self.prepared.name,
                100.0 * self.prepared.covered
            ));
        }
        Ok(surface)
    }

    /// The compliance without the negative eigenvalues that rounding leaves.
    fn positive(&self, rest: Vec<f64>) -> Result<Vec<f64>, FlexibleError> {
        let count = self.rows.len();
        let largest = (0..count)
            .map(|i| self.compliance[i * (count + 1)])
            .fold(0.0, f64::max);
        let (values, vectors) = symmetric_eigen(count, rest)?;
        let least = values.iter().copied().fold(0.0, f64::min);
        if least.is_nan() || least < -NEGATIVE * largest {
            return Err(FlexibleError::Numerical {
                problem: format!(
                    "the compliance of an elastic surface has the eigenvalue {least:.1e} m/N: its modes yield more than its mesh"
                ),
                advice: "check the matrices of the body".into(),
            }
            .of(Part::Marker(self.prepared.request.marker)));
        }
        let mut sum = vec![0.0; count * count];
        for (value, vector) in values.iter().zip(vectors.chunks_exact(count.max(1))) {
            if *value <= 0.0 {
                continue;
            }
            for (row, x) in sum.chunks_exact_mut(count).zip(vector) {
                for (place, y) in row.iter_mut().zip(vector) {
                    *place += value * x * y;
                }
            }
        }
        Ok(sum)
    }
}
