//! Whole parts: mass, frequencies and flexibility against matrices of CalculiX 2.20 and independent sparse
//! solutions of them.

use crate::fe_meshes::*;
use eng_flexible::fe::mass::rigid_motions;
use eng_flexible::fe::{Reduction, Rules, assemble};
use eng_flexible::mesh::{Mesh, Tie};
use eng_flexible::solve::{EigenOptions, Modes, lowest_modes};

/// Elastic frequencies [Hz] of a free bar from CalculiX' matrices, solved independently.
const BAR20: [f64; 8] = [
    1272.7792952494524,
    1836.349111204831,
    3318.807078178551,
    3389.3607945457293,
    4542.985335340911,
    6071.1235523316955,
    6395.578446254368,
    6783.231165532091,
];
const BAR8: [f64; 8] = [
    1295.499900029436,
    1852.2126739616397,
    3387.171586890116,
    3433.8996674104083,
    4594.403477398875,
    6218.42795278267,
    6397.894492906331,
    6879.697860657841,
];
/// The same clamped at x = 0.
///
/// The matrices were written with 14 digits: the rigid eigenvalues of that solution differ from zero by up to
/// 0.016 rad²/s². These have the same error, 7e-9 of the lowest.
const BAR20_CLAMPED: [f64; 4] = [
    207.07548902125362,
    307.12411783033116,
    1242.191086861009,
    1710.2224772184754,
];
const BAR8_CLAMPED: [f64; 4] = [
    210.4807879383519,
    309.4734336012867,
    1264.3416082413821,
    1731.5877859014956,
];

fn clamp(mesh: &Mesh) -> Vec<eng_flexible::mesh::Support> {
    held(&nodes_where(mesh, |x| x[0].abs() < 1e-9), 0b111)
}

#[test]
fn bars_have_calculix_masses_frequencies_and_flexibility() {
    // mean displacement [m] of the face x = 0.4 a kN spread over its nodes, along each axis
    let bars = [
        (
            "bar20.bdf.gz",
            BAR20,
            BAR20_CLAMPED,
            [
                8.38370213074375e-07,
                0.00032184221176887856,
                0.00014481798632184122,
            ],
        ),
        (
            "bar8.bdf.gz",
            BAR8,
            BAR8_CLAMPED,
            [
                8.136123690645117e-07,
                0.0003114195571504995,
                0.00014260419090939268,
            ],
        ),
    ];
    for (name, free, clamped, flexibility) in bars {
        let mesh = read(name);
        let structure = assemble(&mesh, &Rules::calculix()).unwrap();
        // reference: mass properties of CalculiX' matrix, which are those of the box
        let rigid = structure.mass.rigid(&mesh);
        assert!(agrees(rigid.mass, 7.536, 1e-10));
        for (x, y) in rigid.centre().iter().zip([0.2, 0.02, 0.03]) {
            assert!(agrees(*x, y, 1e-10));
        }
        let inertia = [
            [0.0130624, -0.030144, -0.045216],
            [-0.030144, 0.4109632, -0.0045216],
            [-0.045216, -0.0045216, 0.4059392],
        ];
        for (x, y) in rigid.inertia.iter().flatten().zip(inertia.iter().flatten()) {
            assert!(agrees(*x, *y, 1e-10), "{name}: {x} {y}");
        }
        let mass = structure.mass.assembled().unwrap();
        let options = EigenOptions::default();
        let modes = lowest_modes(&structure.stiffness, &mass, Modes::Count(14), &options).unwrap();
        for (x, y) in frequencies(&modes.eigenvalues)[6..].iter().zip(free) {
            assert!(agrees(*x, y, 1e-9), "{name}: {x} {y}");
        }
        let reduction = Reduction::new(&mesh, &structure, &clamp(&mesh)).unwrap();
        let stiffness = reduction.reduce_stiffness(&structure.stiffness).unwrap();
        let mass = reduction.reduce_mass(&structure.mass).unwrap();
        let modes = lowest_modes(&stiffness, &mass, Modes::Count(4), &options).unwrap();
        for (x, y) in frequencies(&modes.eigenvalues).iter().zip(clamped) {
            assert!(agrees(*x, y, 1e-8), "{name}: {x} {y}");
        }
        let end = nodes_where(&mesh, |x| (x[0] - 0.4).abs() < 1e-9);
        for (axis, expected) in flexibility.into_iter().enumerate() {
            let mut force = vec![0.0; structure.freedoms.size()];
            for node in &end {
                force[structure.freedoms.of(*node).start + axis] = 1000.0 / end.len() as f64;
            }
            let full = solve(&structure, &reduction, &force);
            let mean: f64 = end
                .iter()
                .map(|node| full[structure.freedoms.of(*node).start + axis])
                .sum::<f64>()
                / end.len() as f64;
            assert!(
                agrees(mean, expected, 1e-8),
                "{name} {axis}: {mean} {expected}"
            );
            // the same through an averaging tie to the face's centre
            let mut tied = mesh.clone();
            let centre = add_node(&mut tied, [0.4, 0.02, 0.03]);
            tied.ties.push(Tie::Averaging {
                id: 1,
                reference: centre,
                reference_components: 0b111111,
                independent: end.iter().map(|node| (*node, 1.0, 0b111)).collect(),
            });
            let structure = assemble(&tied, &Rules::calculix()).unwrap();
            let reduction = Reduction::new(&tied, &structure, &clamp(&mesh)).unwrap();
            let mut force = vec![0.0; structure.freedoms.size()];
            let own = structure.freedoms.of(centre).start + axis;
            force[own] = 1000.0;
            let full = solve(&structure, &reduction, &force);
            assert!(agrees(full[own], expected, 1e-8), "{name} {axis}");
        }
    }
}

/// Free elastic frequencies [Hz] of the crankshaft with exactly integrated mass, from an independent solution.
const CRANK: [f64; 6] = [
    321.3684519304615,
    429.68512158177805,
    737.9418143965844,
    763.5826873122895,
    827.4526098263053,
    1089.1783194176728,
];
#[test]
fn the_crankshaft_has_its_mass_and_frequencies() {
    let mesh = read("crank_m.bdf.gz");
    let cases = [
        (
            Rules::default(),
            22.737672632062246,
            0.20603170673260782,
            [0.044552863738294465, 1.349806751589145, 1.3354736167147563],
        ),
        (
            Rules::calculix(),
            22.73767263206819,
            0.20603170680800692,
            [0.04455258180856059, 1.349806589887194, 1.3354734544454487],
        ),
    ];
    for (rules, mass, centre, inertia) in cases {
        let structure = assemble(&mesh, &rules).unwrap();
        assert!(structure.unused_nodes.is_empty());
        let rigid = structure.mass.rigid(&mesh);
        // CalculiX writes 14 digits, and its matrix' sums lose two of them
        assert!(agrees(rigid.mass, mass, 1e-11), "{}", rigid.mass);
        assert!(
            agrees(rigid.centre()[0], centre, 1e-10),
            "{:?}",
            rigid.centre()
        );
        for (axis, expected) in inertia.into_iter().enumerate() {
            let found = rigid.inertia[axis][axis];
            assert!(agrees(found, expected, 1e-10), "{found} {expected}");
        }
    }
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let mass = structure.mass.assembled().unwrap();
    let options = EigenOptions::default();
    let modes = lowest_modes(&structure.stiffness, &mass, Modes::Count(12), &options).unwrap();
    for (x, y) in frequencies(&modes.eigenvalues)[6..].iter().zip(CRANK) {
        assert!(agrees(*x, y, 1e-8), "{x} {y}");
    }
}

/// The crankshaft with spiders.
fn spiders(name: &str) -> Mesh {
    read(&format!(
        "deck:INCLUDE 'crank_m.bdf.gz'\nINCLUDE '{name}'\n"
    ))
}

#[test]
fn spiders_of_the_crankshaft_follow_rigid_motions() {
    for name in ["crank_m_rbe2.bdf.gz", "crank_m_rbe3.bdf.gz"] {
        let mesh = spiders(name);
        assert_eq!(mesh.ties.len(), 11);
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        let reduction = Reduction::new(&mesh, &structure, &[]).unwrap();
        assert_eq!(reduction.full_size(), 3 * 31_277 + 6 * 11);
        let full = rigid_motions(&mesh, &structure.freedoms);
        let size = structure.freedoms.size();
        let free: Vec<f64> = (0..6)
            .flat_map(|motion| {
                let full = &full[motion * size..];
                reduction
                    .free()
                    .iter()
                    .map(move |freedom| full[*freedom as usize])
            })
            .collect();
        let back = reduction.expand(6, &free);
        for (x, y) in back.iter().zip(&full) {
            assert!((x - y).abs() < 1e-12, "{name}: {x} {y}");
        }
        // and cost no energy
        let stiffness = reduction.reduce_stiffness(&structure.stiffness).unwrap();
        let force = times(&stiffness, &free);
        assert!(
            largest(&force) < 1e-11 * largest(stiffness.values()),
            "{name}"
        );
        let mass = reduction.reduce_mass(&structure.mass).unwrap();
        let momentum = times(&mass, &free[..reduction.size()]);
        let total = dot(&free[..reduction.size()], &momentum);
        assert!(agrees(total, 22.737672632062246, 1e-11), "{name}");
    }
}
