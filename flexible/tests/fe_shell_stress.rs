//! Stress of shells on their surfaces, against closed forms.

use crate::fe_meshes::*;
use crate::shell_meshes::*;
use eng_flexible::Mesh;
use eng_flexible::fe::stress::{Components, surface_stresses, von_mises};
use eng_flexible::fe::{Assembled, Rules, assemble};
use eng_flexible::mesh::{Layup, ShellSection, ShellShape};
use eng_flexible::recover::Recovery;
use eng_flexible::reduce::{Reduced, Report};
use eng_flexible::store::{Key, StoredBody};
use eng_system::reduced::{Invariants, ReducedBody};

/// The stresses of a vector on the surfaces of each node, from the lower to the upper.
fn stresses(mesh: &Mesh, structure: &Assembled, full: &[f64]) -> Vec<Vec<Components>> {
    let wanted = vec![true; mesh.nodes.len()];
    let found =
        surface_stresses(mesh, &structure.freedoms, &Rules::default(), full, &wanted).unwrap();
    let whole = |surface: Vec<f64>| -> Components { surface.try_into().unwrap() };
    found
        .into_values()
        .map(|surfaces| surfaces.into_iter().map(whole).collect())
        .collect()
}

/// Stress 11, 22, 12 in the sheet's axes as one in space.
fn in_space([first, second, shear]: [f64; 3]) -> Components {
    let axes = turn();
    let entry = |i: usize, j: usize| {
        let [a, b] = [0, 1].map(|k: usize| [axes[i][k], axes[j][k]]);
        first * a[0] * a[1] + second * b[0] * b[1] + shear * (a[0] * b[1] + b[0] * a[1])
    };
    [
        entry(0, 0),
        entry(1, 1),
        entry(2, 2),
        entry(0, 1),
        entry(1, 2),
        entry(2, 0),
    ]
}

#[test]
fn constant_strains_and_curvatures_have_their_stress_on_both_surfaces() {
    let (thickness, beside) = (0.01, 0.02);
    let plane = YOUNG / (1.0 - POISSON * POISSON);
    let of = |[x, y, xy]: [f64; 3]| {
        [
            plane * (x + POISSON * y),
            plane * (y + POISSON * x),
            0.5 * YOUNG / (1.0 + POISSON) * xy,
        ]
    };
    for kind in KINDS {
        for offset in [0.0, beside] {
            let mut mesh = patch(kind, ShellSection::plate(thickness));
            let offsets = [offset; 4];
            shaped(
                &mut mesh,
                ShellShape {
                    offsets,
                    ..ShellShape::default()
                },
            );
            let structure = assemble(&mesh, &Rules::default()).unwrap();
            let full = motion(&mesh, &structure, |[x, y]| {
                (
                    [
                        1e-3 * (x + 0.5 * y),
                        1e-3 * (0.2 * x - 0.7 * y),
                        0.05 * (x * x + x * y + y * y),
                    ],
                    [0.1 * (0.5 * x + y), -0.1 * (x + 0.5 * y), -0.15e-3],
                )
            });
            for (height, face) in [(-0.5, 0), (0.5, 1)] {
                let z = offset + height * thickness;
                let exact = in_space(of([1e-3 - 0.1 * z, -0.7e-3 - 0.1 * z, 0.7e-3 - 0.1 * z]));
                let scale = largest(&exact);
                for node in stresses(&mesh, &structure, &full) {
                    assert_eq!(node.len(), 2);
                    for (x, y) in node[face].iter().zip(exact) {
                        assert!(
                            (x - y).abs() < 1e-9 * scale,
                            "{kind:?}: {:?} {exact:?}",
                            node[face]
                        );
                    }
                }
            }
        }
    }
}

/// σ = ± 6 F (L − x)/(b t²) of a cantilever.
#[test]
fn a_cantilever_has_the_stress_of_a_beam() {
    let (length, width, thickness) = (1.0, 0.05, 0.01);
    for kind in KINDS {
        let mut mesh = sheet(kind, [20, 2], ShellSection::plate(thickness), |[i, j]| {
            [i * length / 20.0, j * width / 2.0, 0.0]
        });
        mesh.materials[0].poisson = 0.0;
        let clamped = held(&nodes_where(&mesh, |x| x[0] < 1e-9), 0b111111);
        let forces = along_edge(&mesh, |x| x[0] > length - 1e-9, 2, 8.0);
        let (structure, found) = pushed(&mesh, &clamped, &forces);
        let all = stresses(&mesh, &structure, &found);
        for x in [0.25, 0.5, 0.75] {
            let node = at(&mesh, [x * length, 0.5 * width, 0.0]);
            let exact = 6.0 * 8.0 * (1.0 - x) * length / (width * thickness * thickness);
            // the lower surface is pulled by an upward force
            for (sign, face) in [(1.0, 0), (-1.0, 1)] {
                let own = all[node as usize][face];
                assert!(
                    agrees(own[0], sign * exact, 5e-3),
                    "{kind:?} {x}: {own:?} {exact}"
                );
                assert!(
                    agrees(von_mises(&own), exact, 5e-3),
                    "{kind:?} {x}: {own:?} {exact}"
                );
            }
        }
    }
}

/// Two plates at a right angle, of which one is stretched along its free edge: the other has no stress at the
/// nodes that they share. With turned normals the upper surface stays where it is.
#[test]
fn sides_of_a_fold_keep_their_stress_and_turned_normals_do_not_mix_surfaces() {
    for kind in KINDS {
        let mut mesh = sheet(kind, [2, 2], ShellSection::plate(0.01), |[i, j]| {
            match i > 1.0 {
                true => [1.0, j, i - 1.0],
                false => [i, j, 0.0],
            }
        });
        mesh.materials[0].poisson = 0.0;
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        let freedoms = &structure.freedoms;
        // the flat plate is stretched along x, the other moves with it
        let mut full = vec![0.0; freedoms.size()];
        for (index, node) in mesh.nodes.iter().enumerate() {
            full[freedoms.of(index as u32).start] = 1e-3 * node.position[0];
        }
        let all = stresses(&mesh, &structure, &full);
        let node = &all[at(&mesh, [1.0, 1.0, 0.0]) as usize];
        assert_eq!(node.len(), 4, "{kind:?}");
        let exact = [YOUNG * 1e-3, 0.0];
        let mut found: Vec<f64> = node.iter().map(von_mises).collect();
        found.sort_by(f64::total_cmp);
        for (found, exact) in found.iter().zip([exact[1], exact[1], exact[0], exact[0]]) {
            assert!((found - exact).abs() < 1e-9 * YOUNG, "{kind:?}: {node:?}");
        }
    }
    // neighbours of opposite normals: bending keeps its signs
    let mut mesh = sheet(QUAD, [2, 1], ShellSection::plate(0.01), |[i, j]| {
        [i, j, 0.0]
    });
    mesh.connectivity[4..].reverse();
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let freedoms = &structure.freedoms;
    let mut full = vec![0.0; freedoms.size()];
    for (index, node) in mesh.nodes.iter().enumerate() {
        let first = freedoms.of(index as u32).start;
        full[first + 2] = 0.5 * node.position[0] * node.position[0];
        full[first + 4] = -node.position[0];
    }
    let exact = YOUNG / (1.0 - POISSON * POISSON) * 0.005;
    let shared = &stresses(&mesh, &structure, &full)[at(&mesh, [1.0, 0.0, 0.0]) as usize];
    assert_eq!(shared.len(), 2);
    assert!(
        agrees(shared[0][0], exact, 1e-9) && agrees(shared[1][0], -exact, 1e-9),
        "{shared:?}"
    );
}

/// The stress of amplitudes is that of the surface with the largest von Mises stress; a membrane has one.
#[test]
fn the_worse_surface_is_shown() {
    let thickness = 0.01;
    let membrane = ShellSection {
        layup: Layup::Apart {
            bending: None,
            shear: None,
        },
        ..ShellSection::plate(thickness)
    };
    for (section, surfaces) in [(ShellSection::plate(thickness), 2), (membrane, 1)] {
        let mut mesh = sheet(QUAD, [2, 2], section, |[i, j]| [i, j, 0.0]);
        mesh.materials[0].poisson = 0.0;
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        let size = structure.freedoms.size();
        let mut shapes = vec![0.0; 2 * size];
        for (index, node) in mesh.nodes.iter().enumerate() {
            let own = structure.freedoms.of(index as u32);
            let x = node.position[0];
            shapes[own.start] = 1e-4 * x;
            shapes[size + own.start + 2] = 0.05 * x * x;
            if own.len() == 6 {
                shapes[size + own.start + 4] = -0.1 * x;
            }
        }
        let reduced = Reduced {
            body: ReducedBody {
                invariants: Invariants::zero(2),
                frequencies: vec![0.0; 2],
                markers: vec![],
                surfaces: vec![],
            },
            shapes,
            freedoms: structure.freedoms,
            report: Report::default(),
            mesh,
        };
        let stored = StoredBody::new(reduced, Rules::default(), Key([0; 32]), Vec::new());
        let nodes: Vec<u32> = (0..9).collect();
        let recovery = Recovery::of_stored(&stored).unwrap();
        let modal = recovery.stress_at_nodes(&nodes).unwrap();
        assert_eq!(modal.nodes(), nodes);
        let mut found = Vec::new();
        for (a, b) in [(1.0, 2.0), (1.0, -2.0), (-3.0, 1.0)] {
            modal.stress(&[a, b], &mut found).unwrap();
            // the lower surface has z = −t/2 and the curvature −0.1 b
            let [low, high] = [-0.5, 0.5].map(|z| YOUNG * (1e-4 * a - 0.1 * b * z * thickness));
            let exact = match surfaces {
                1 => YOUNG * 1e-4 * a,
                _ if low.abs() > high.abs() => low,
                _ => high,
            };
            assert_eq!(found.len(), 9);
            for own in &found {
                assert!(agrees(own[0], exact, 1e-9), "{a} {b}: {own:?} {exact}");
            }
        }
    }
}
