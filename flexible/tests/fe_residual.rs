//! The residual bending flexibility of Nastran's quadrilaterals, against closed forms.

use crate::fe_meshes::*;
use crate::shell_meshes::*;
use eng_flexible::Mesh;
use eng_flexible::fe::stress::surface_stresses;
use eng_flexible::fe::{Rules, assemble};
use eng_flexible::mesh::{Code, ShellSection};

const THICKNESS: f64 = 0.01;

/// A strip of one element across.
fn strip(code: Code, cells: u32, length: f64, width: f64, poisson: f64) -> Mesh {
    let n = f64::from(cells);
    let mut mesh = sheet(
        QUAD,
        [cells, 1],
        ShellSection::plate(THICKNESS),
        |[i, j]| [i * length / n, j * width, 0.0],
    );
    mesh.materials[0].poisson = poisson;
    mesh.code = code;
    mesh
}

/// The deflection of a strip's tip under a force of 1 N across it. The clamp holds these freedoms.
fn deflection(mesh: &Mesh, length: f64, clamp: u8) -> f64 {
    let clamped = held(&nodes_where(mesh, |x| x[0] < 1e-9), clamp);
    let tip = nodes_where(mesh, |x| x[0] > length - 1e-9);
    let forces: Vec<_> = tip.iter().map(|node| (*node, 2, 0.5)).collect();
    let (structure, found) = pushed(mesh, &clamped, &forces);
    let own = tip.iter();
    own.map(|node| 0.5 * found[structure.freedoms.freedom(*node, 2).unwrap()])
        .sum()
}

/// One element bends like the whole beam, F L³/(3 E I) + F L/(5/6 G A); with linear rotations it has three quarters of
/// the bending.
#[test]
fn one_element_is_a_beam() {
    for (length, width) in [(1.0, 0.05), (0.3, 0.3), (0.02, 0.5)] {
        let inertia = width * THICKNESS.powi(3) / 12.0;
        let shear = 1.2 * length / (0.5 * YOUNG * width * THICKNESS);
        let bent = length.powi(3) / (3.0 * YOUNG * inertia);
        for (code, share) in [
            (Code::Nastran, 1.0),
            (Code::None, 0.75),
            (Code::Abaqus, 0.75),
        ] {
            let mesh = strip(code, 1, length, width, 0.0);
            let found = deflection(&mesh, length, 0b111111);
            let exact = share * bent + shear;
            assert!(agrees(found, exact, 1e-9), "{code:?}: {}", found / exact);
        }
    }
}

/// A narrow strip contracts across and bends with E I, not with the plate's D, if its clamp lets it contract.
#[test]
fn a_narrow_strip_bends_with_the_stiffness_of_a_beam() {
    let (length, width) = (1.0, 0.005);
    let mesh = strip(Code::Nastran, 1, length, width, 0.3);
    let found = deflection(&mesh, length, 0b110111);
    let inertia = width * THICKNESS.powi(3) / 12.0;
    let shear = 2.6 * 1.2 * length / (YOUNG * width * THICKNESS);
    let exact = length.powi(3) / (3.0 * YOUNG * inertia) + shear;
    assert!(agrees(found, exact, 1e-4), "{}", found / exact);
}

/// A strip of two elements between a clamp and an edge that turns: F = 3 E I w/L³ there, for any division.
#[test]
fn a_strip_between_edges_has_the_stiffness_of_a_beam() {
    let (length, width) = (0.4, 0.1);
    let inertia = width * THICKNESS.powi(3) / 12.0;
    for cells in [1, 2, 3, 7] {
        let mesh = strip(Code::Nastran, cells, length, width, 0.0);
        let shear = 1.2 * length / (0.5 * YOUNG * width * THICKNESS);
        let exact = length.powi(3) / (3.0 * YOUNG * inertia) + shear;
        let found = deflection(&mesh, length, 0b111111);
        assert!(agrees(found, exact, 1e-9), "{cells}: {}", found / exact);
    }
}

/// The moment of one element is linear: σ = 6 F (L − x)/(b t²) at both ends.
#[test]
fn the_stress_of_one_element_is_linear() {
    let (length, width) = (0.4, 0.1);
    let mesh = strip(Code::Nastran, 1, length, width, 0.0);
    let clamped = held(&nodes_where(&mesh, |x| x[0] < 1e-9), 0b111111);
    let tip = nodes_where(&mesh, |x| x[0] > length - 1e-9);
    let forces: Vec<_> = tip.iter().map(|node| (*node, 2, 0.5)).collect();
    let (structure, found) = pushed(&mesh, &clamped, &forces);
    let wanted = vec![true; mesh.nodes.len()];
    let rules = Rules::default();
    let stresses = surface_stresses(&mesh, &structure.freedoms, &rules, &found, &wanted).unwrap();
    let most = 6.0 * length / (width * THICKNESS * THICKNESS);
    for (node, surfaces) in stresses {
        let share = 1.0 - mesh.nodes[node as usize].position[0] / length;
        for (surface, sign) in surfaces.iter().zip([1.0, -1.0]) {
            let error = surface[0] - sign * share * most;
            assert!(error.abs() < 1e-8 * most, "{node}: {surface:?}");
        }
    }
}

/// `element_rules` decide, whatever code wrote the mesh.
#[test]
fn the_rules_decide() {
    let stiffness = |code: Code, rules: Rules| {
        let mesh = strip(code, 1, 0.4, 0.1, 0.3);
        assemble(&mesh, &rules).unwrap().stiffness
    };
    let soft = stiffness(Code::Nastran, Rules::default());
    let stiff = stiffness(Code::None, Rules::default());
    assert!(soft != stiff);
    assert!(soft == stiffness(Code::Abaqus, Rules::nastran()));
    for rules in [Rules::exact(), Rules::abaqus(), Rules::calculix()] {
        assert!(stiff == stiffness(Code::Nastran, rules), "{rules:?}");
    }
}
