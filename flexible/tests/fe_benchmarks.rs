//! Published benchmarks of solids.

use crate::fe_meshes::*;
use eng_flexible::element::Shape;
use eng_flexible::element::quadrature;
use eng_flexible::fe::stress::von_mises;
use eng_flexible::fe::{Reduction, Rules, assemble};
use eng_flexible::mesh::{ElementKind, Mesh, Support};
use eng_flexible::solve::{EigenOptions, Modes, lowest_modes};

/// Consistent nodal forces of a pressure on the faces of 20-node hexahedra at ζ = 1 that lie in a plane z =
/// const, downwards.
fn pressure(
    mesh: &Mesh,
    top: f64,
    pressure: f64,
    size: usize,
    first: impl Fn(u32) -> usize,
) -> Vec<f64> {
    let mut force = vec![0.0; size];
    for element in &mesh.elements {
        let nodes = mesh.nodes_of(element);
        let face = [4, 5, 6, 7, 12, 13, 14, 15].map(|i: usize| nodes[i]);
        let place = |node: u32| mesh.nodes[node as usize].position;
        if face.iter().any(|node| (place(*node)[2] - top).abs() > 1e-9) {
            continue;
        }
        for point in quadrature::quadrilateral(3) {
            let shape = Shape::at(ElementKind::Quadrilateral8, point.at);
            let mut tangent = [[0.0; 2]; 2];
            for (local, node) in face.iter().enumerate() {
                let p = place(*node);
                for (axis, row) in tangent.iter_mut().enumerate() {
                    row[0] += shape.slopes[local][axis] * p[0];
                    row[1] += shape.slopes[local][axis] * p[1];
                }
            }
            let area = tangent[0][0] * tangent[1][1] - tangent[0][1] * tangent[1][0];
            assert!(area > 0.0);
            for (local, node) in face.iter().enumerate() {
                force[first(*node) + 2] -= pressure * point.weight * area * shape.values[local];
            }
        }
    }
    force
}

/// NAFEMS LE10 (The Standard NAFEMS Benchmarks, 1990): thick elliptic plate under pressure; target
/// σ_yy = −5.38 MPa at the inner ellipse's end on the loaded face.
#[test]
fn nafems_le10_thick_plate() {
    let thickness = 0.6;
    let mesh_of = |across: i32, around: i32, layers: i32| {
        grid(
            ElementKind::Hexahedron20,
            [across, around, layers],
            true,
            move |t| {
                let share = t[0] / f64::from(across);
                let angle = 0.5 * std::f64::consts::PI * t[1] / f64::from(around);
                let (s, c) = angle.sin_cos();
                let x = (2.0 + 1.25 * share) * c;
                let y = (1.0 + 1.75 * share) * s;
                [x, y, thickness * t[2] / f64::from(layers)]
            },
        )
    };
    let mut found = Vec::new();
    for (across, around, layers) in [(4, 6, 2), (8, 12, 4)] {
        let mut mesh = mesh_of(across, around, layers);
        mesh.materials[0].density = 1.0;
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        let outer =
            |x: [f64; 3]| ((x[0] / 3.25).powi(2) + (x[1] / 2.75).powi(2) - 1.0).abs() < 1e-9;
        let mut supports = held(&nodes_where(&mesh, |x| x[1].abs() < 1e-9), 0b010);
        supports.extend(held(&nodes_where(&mesh, |x| x[0].abs() < 1e-9), 0b001));
        supports.extend(held(&nodes_where(&mesh, outer), 0b011));
        let line = |x: [f64; 3]| outer(x) && (x[2] - 0.5 * thickness).abs() < 1e-9;
        supports.extend(held(&nodes_where(&mesh, line), 0b100));
        let reduction = Reduction::new(&mesh, &structure, &supports).unwrap();
        let force = pressure(&mesh, thickness, 1e6, structure.freedoms.size(), |node| {
            structure.freedoms.of(node).start
        });
        // the plate's area: quarter of the ellipses' difference
        let total: f64 = force.iter().sum();
        let area = 0.25 * std::f64::consts::PI * (3.25 * 2.75 - 2.0);
        assert!(agrees(total, -1e6 * area, 1e-3), "{total}");
        let full = solve(&structure, &reduction, &force);
        let stress = nodal_stress(&mesh, &structure.freedoms, &Rules::default(), &full);
        let corner = nodes_where(&mesh, |x| {
            (x[0] - 2.0).abs() < 1e-9 && x[1].abs() < 1e-9 && (x[2] - thickness).abs() < 1e-9
        })[0];
        found.push(stress[corner as usize].unwrap()[1]);
    }
    assert!(agrees(found[0], -5.38e6, 0.05), "{found:?}");
    assert!(agrees(found[1], -5.38e6, 0.02), "{found:?}");
}

/// Pure bending, whose exact displacements are quadratic: u = κ (x z, −ν y z, −(x² + ν (z² − y²))/2), σ_xx = E κ z
/// (S. Timoshenko, J. N. Goodier, Theory of Elasticity, §102). Quadratic solids with straight edges represent it
/// exactly. Linear ones, integrated in full, have more energy: they lock.
#[test]
fn quadratic_solids_bend_exactly() {
    let (length, width, height) = (1.0, 0.1, 0.2);
    let curvature = 1e-3;
    let bent = |x: [f64; 3]| {
        let z = x[2] - 0.5 * height;
        let y = x[1] - 0.5 * width;
        [
            curvature * x[0] * z,
            -POISSON * curvature * y * z,
            -0.5 * curvature * (x[0] * x[0] + POISSON * (z * z - y * y)),
        ]
    };
    let moment = width * height * height * height / 12.0;
    let exact = 0.5 * YOUNG * moment * curvature * curvature * length;
    for kind in SOLIDS {
        let mesh = bar(kind, [3, 2, 2], [length, width, height]);
        let structure = assemble(&mesh, &Rules::exact()).unwrap();
        let full = field(&mesh, &structure, bent);
        let force = times(&structure.stiffness, &full);
        let energy = 0.5 * dot(&full, &force);
        if kind.node_count() == kind.corner_count() {
            assert!(energy > 1.01 * exact, "{kind:?}: {energy} {exact}");
            continue;
        }
        assert!(agrees(energy, exact, 1e-11), "{kind:?}: {energy} {exact}");
        let mut end = 0.0;
        for (index, node) in mesh.nodes.iter().enumerate() {
            let first = structure.freedoms.of(index as u32).start;
            if node.position[0] > length - 1e-9 {
                end += force[first] * (node.position[2] - 0.5 * height);
            } else if node.position[0] > 1e-9 && kind != ElementKind::Wedge15 {
                // three points in the triangle are too few for the cubics of this balance
                for f in &force[first..first + 3] {
                    assert!(f.abs() < 1e-11 * largest(&force), "{kind:?}: {f}");
                }
            }
        }
        let torque = YOUNG * moment * curvature;
        if kind != ElementKind::Wedge15 {
            assert!(agrees(end, torque, 1e-11), "{kind:?}: {end} {torque}");
        }
    }
}

/// A bar pulled evenly at both ends, statically determinate: stress P/A everywhere.
#[test]
fn a_pulled_bar_has_its_stress_everywhere() {
    for kind in [
        ElementKind::Tetrahedron10,
        ElementKind::Hexahedron20,
        ElementKind::Wedge15,
    ] {
        let mesh = bar(kind, [3, 2, 2], [0.3, 0.1, 0.1]);
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        let strain = 1e-4;
        let full = field(&mesh, &structure, |x| {
            [
                strain * x[0],
                -POISSON * strain * x[1],
                -POISSON * strain * x[2],
            ]
        });
        let stress = nodal_stress(&mesh, &structure.freedoms, &Rules::default(), &full);
        for value in stress.iter().flatten() {
            assert!(agrees(von_mises(value), YOUNG * strain, 1e-11));
            assert!(agrees(value[0], YOUNG * strain, 1e-11));
        }
    }
}

/// NAFEMS FV52 (Selected Benchmarks for Natural Frequency Analysis): a thick square plate, 10 m by 1 m, of solids.
///
/// The targets are those of a plate on hard supports, whose edges do not move across the plate and do not twist along
/// themselves: 45.897, 109.44, 109.44, 167.89 Hz. Solids that are held across at their lower edges alone, as in the
/// drawing of the benchmark, may twist there: 44.8 Hz on 4 × 4 × 1 elements, 43.4 Hz on 12 × 12 × 3. Three motions in
/// their plane are free. This does not change the modes in the plane, 193.59 Hz.
#[test]
fn nafems_fv52_thick_plate() {
    let (side, thickness) = (10.0, 1.0);
    let mut mesh = grid(ElementKind::Hexahedron20, [12, 12, 3], true, |t| {
        [
            side * t[0] / 12.0,
            side * t[1] / 12.0,
            thickness * (t[2] / 3.0 - 0.5),
        ]
    });
    let steel = &mut mesh.materials[0];
    (steel.young, steel.poisson, steel.density) = (200e9, 0.3, 8000.0);
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let [across_x, across_y] =
        [0, 1].map(|i| move |x: [f64; 3]| x[i].abs() < 1e-9 || (x[i] - side).abs() < 1e-9);
    let edges_at = |height: f64| {
        nodes_where(&mesh, |x| {
            (x[2] - height).abs() < 1e-9 && (across_x(x) || across_y(x))
        })
    };
    let found = |supports: &[Support]| {
        let reduction = Reduction::new(&mesh, &structure, supports).unwrap();
        let stiffness = reduction.reduce_stiffness(&structure.stiffness).unwrap();
        let mass = reduction.reduce_mass(&structure.mass).unwrap();
        let options = EigenOptions::default();
        let modes = lowest_modes(&stiffness, &mass, Modes::Count(10), &options).unwrap();
        frequencies(&modes.eigenvalues)
    };

    let mut hard = held(&edges_at(0.0), 0b100);
    hard.extend(held(&nodes_where(&mesh, across_x), 0b010));
    hard.extend(held(&nodes_where(&mesh, across_y), 0b001));
    let plate = found(&hard);
    for (found, due) in plate[..3]
        .iter()
        .chain(&plate[5..6])
        .zip([45.897, 109.44, 109.44, 167.89])
    {
        assert!(agrees(*found, due, 5e-3), "{found} Hz instead of {due} Hz");
    }

    let lower = found(&held(&edges_at(-0.5 * thickness), 0b100));
    assert!(lower[..3].iter().all(|f| *f < 0.01), "{lower:?}");
    assert!(agrees(lower[3], 43.4, 5e-3), "{lower:?}");
    assert!(lower.iter().any(|f| agrees(*f, 193.59, 1e-3)), "{lower:?}");
}
