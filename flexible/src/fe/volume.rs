//! A body's mass from the volumes of its elements: an estimate that is compared with the mass
//! matrix.

use super::check::{Role, role};
use super::mass::RigidMass;
use super::vector::{add, cross, dot, norm, subtract};
use crate::mesh::{ABSENT, Mesh, Station};

/// Volume (m³), area (m²) or length (m).
fn measure(corners: &[[f64; 3]]) -> f64 {
    match corners {
        [a, b, c, d] => {
            let [u, v, w] = [b, c, d].map(|p| subtract(*p, *a));
            dot(cross(u, v), w).abs() / 6.0
        }
        [a, b, c] => 0.5 * norm(cross(subtract(*b, *a), subtract(*c, *a))),
        [a, b] => norm(subtract(*b, *a)),
        _ => 0.0,
    }
}

/// The sums so far.
#[derive(Default)]
struct Sum {
    mass: f64,
    first: [f64; 3],
    /// ∫ r rᵀ dm.
    second: [[f64; 3]; 3],
}

impl Sum {
    /// A simplex of evenly spread mass: with k corners `∫ r rᵀ = m (Σ pᵢ pᵢᵀ + s sᵀ) / (k (k + 1))`, s the
    /// sum of the corners.
    fn add(&mut self, mass: f64, corners: &[[f64; 3]]) {
        let count = corners.len() as f64;
        let mut sum = [0.0; 3];
        for corner in corners {
            for (sum, x) in sum.iter_mut().zip(corner) {
                *sum += x;
            }
        }
        self.mass += mass;
        for i in 0..3 {
            self.first[i] += mass * sum[i] / count;
            for j in 0..3 {
                let own: f64 = corners.iter().map(|p| p[i] * p[j]).sum();
                self.second[i][j] += mass * (own + sum[i] * sum[j]) / (count * (count + 1.0));
            }
        }
    }
}

/// The mean mass per length of a beam. In kg/m.
fn mean_mass(stations: &[Station], density: f64) -> f64 {
    let own = |station: &Station| density * station.section.area + station.section.mass_per_length;
    match stations {
        [single] => own(single),
        _ => {
            let pairs = stations.windows(2);
            pairs
                .map(|pair| 0.5 * (own(&pair[0]) + own(&pair[1])) * (pair[1].place - pair[0].place))
                .sum()
        }
    }
}

/// Mass properties about the origin of the basic frame with straight edges between corners, of a mesh in SI;
/// `None` if no element has mass. Point masses count with their mass and rotary inertia. The mass of a tapered
/// beam is spread evenly along it. References to missing parts of the mesh are skipped.
pub fn estimate(mesh: &Mesh) -> Option<RigidMass> {
    let mut sum = Sum::default();
    for element in &mesh.elements {
        let density = match role(mesh, element) {
            Some(Role::Solid(material)) => material.density,
            Some(Role::Shell(sheet)) => sheet.mass(element.kind.corner_count()),
            Some(Role::Coat(mass)) => mass,
            Some(Role::Beam(material)) => {
                let property = mesh.properties.get(element.property as usize);
                let stations = property.map(|property| mesh.stations(&property.section));
                mean_mass(&stations.unwrap_or_default(), material.density)
            }
            Some(Role::Facet) | None => 0.0,
        };
        let corners: Option<Vec<[f64; 3]>> = mesh
            .nodes_of(element)
            .iter()
            .take(element.kind.corner_count())
            .map(|node| {
                let node = (*node != ABSENT).then(|| mesh.nodes.get(*node as usize))?;
                node.map(|node| node.position)
            })
            .collect();
        let Some(corners) = corners.filter(|corners| corners.len() == element.kind.corner_count())
        else {
            continue;
        };
        let axes = element
            .beam
            .and_then(|beam| mesh.beam_axes.get(beam as usize));
        let mut corners = corners;
        if let Some(axes) = axes {
            for (corner, offset) in corners.iter_mut().zip(axes.offsets) {
                *corner = add(*corner, offset);
            }
        }
        for simplex in element.kind.description().simplices {
            let places: Vec<[f64; 3]> = simplex.iter().map(|i| corners[*i]).collect();
            sum.add(density * measure(&places), &places);
        }
    }
    if sum.mass.is_nan() || sum.mass <= 0.0 {
        return None;
    }
    let mut rotary = [[0.0; 3]; 3];
    for point in &mesh.point_masses {
        if let Some(node) = mesh.nodes.get(point.node as usize) {
            sum.add(point.matrix[0][0], &[node.position]);
            for (row, own) in rotary.iter_mut().zip(&point.matrix[3..]) {
                for (entry, x) in row.iter_mut().zip(&own[3..]) {
                    *entry += x;
                }
            }
        }
    }
    let trace: f64 = (0..3).map(|i| sum.second[i][i]).sum();
    Some(RigidMass {
        mass: sum.mass,
        first_moment: sum.first,
        inertia: std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                rotary[i][j] + if i == j { trace } else { 0.0 } - sum.second[i][j]
            })
        }),
    })
}
