//! Orthotropic and anisotropic solids: closed forms, frequencies of CalculiX, and the cards and keywords that state them.

use crate::fe_meshes::{self, *};
use crate::nastran_deck::{self, Memory, close, unread};
use eng_flexible::fe::stress::{Components, stress};
use eng_flexible::fe::{Rules, assemble};
use eng_flexible::mesh::{
    Carries, Code, Coordinates, Element, ElementKind, LocalAxes, Mesh, SolidElasticity,
    VARIANT_LETTERS, Variant,
};
use eng_flexible::read::abaqus::read_inp;
use eng_flexible::reduce::{Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::units::MeshUnits;
use eng_flexible::{FileProblem, Files, FlexibleError};
use eng_system::mesh_files::Stated;
use serde_json::Value;
use std::io::Read;
use std::path::Path;

/// E₁, E₂, E₃; ν₁₂, ν₁₃, ν₂₃; G₁₂, G₁₃, G₂₃ (Pa) of a sheet of carbon and epoxy.
const YOUNGS: [f64; 3] = [140e9, 10e9, 6e9];
const RATIOS: [f64; 3] = [0.3, 0.28, 0.4];
const SHEARS: [f64; 3] = [5e9, 4.5e9, 3.5e9];

/// Axes of no symmetry: a turn by 0.7 about z, then by 0.4 about x.
fn turned() -> [[f64; 3]; 3] {
    let (s, c) = 0.7f64.sin_cos();
    let (t, d) = 0.4f64.sin_cos();
    [[c, -s, 0.0], [d * s, d * c, -t], [t * s, t * c, d]]
}

fn carbon(axes: LocalAxes) -> SolidElasticity {
    SolidElasticity {
        stiffness: SolidElasticity::orthotropic(YOUNGS, RATIOS, SHEARS).unwrap(),
        axes,
    }
}

/// The indices of a tensor of each component: xx, yy, zz, xy, yz, zx.
const TENSOR: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// A stiffness in other axes, by the sum over the tensor of four indices: `C'_pqrs = R_ip R_jq R_kr R_ls C_ijkl`.
fn seen_from(axes: &[[f64; 3]; 3], stiffness: &[[f64; 6]; 6]) -> [[f64; 6]; 6] {
    let place = |i: usize, j: usize| {
        let found = TENSOR.iter().position(|t| *t == (i, j) || *t == (j, i));
        found.unwrap()
    };
    let mut out = [[0.0; 6]; 6];
    for (row, (p, q)) in out.iter_mut().zip(TENSOR) {
        for (entry, (r, s)) in row.iter_mut().zip(TENSOR) {
            for i in 0..3 {
                for j in 0..3 {
                    for k in 0..3 {
                        for l in 0..3 {
                            let turn = axes[i][p] * axes[j][q] * axes[k][r] * axes[l][s];
                            *entry += turn * stiffness[place(i, j)][place(k, l)];
                        }
                    }
                }
            }
        }
    }
    out
}

/// The inverse by Gauss–Jordan elimination.
fn inverse(matrix: &[[f64; 6]; 6]) -> [[f64; 6]; 6] {
    let mut work = [[0.0; 12]; 6];
    for (i, row) in work.iter_mut().enumerate() {
        row[..6].copy_from_slice(&matrix[i]);
        row[6 + i] = 1.0;
    }
    for k in 0..6 {
        let pivot = work[k].map(|x| x / work[k][k]);
        for (i, row) in work.iter_mut().enumerate() {
            let factor = row[k];
            if i == k {
                *row = pivot;
            } else {
                row.iter_mut()
                    .zip(pivot)
                    .for_each(|(x, p)| *x -= factor * p);
            }
        }
    }
    let mut out = [[0.0; 6]; 6];
    for (row, own) in out.iter_mut().zip(work) {
        row.copy_from_slice(&own[6..]);
    }
    out
}

/// The displacement of a unit strain of one component; shear is half in each of both directions.
fn unit_strain(component: usize) -> impl Fn([f64; 3]) -> [f64; 3] {
    let (i, j) = TENSOR[component];
    move |x| {
        let mut u = [0.0; 3];
        u[i] += 0.5 * x[j];
        u[j] += 0.5 * x[i];
        u
    }
}

/// The forms of solids: kind, code and variant.
fn forms() -> Vec<(ElementKind, Code, Variant)> {
    let letters =
        |letter: char| Variant::Letters(VARIANT_LETTERS.find(letter).map_or(0, |bit| 1 << bit));
    let plain = SOLIDS.map(|kind| (kind, Code::None, Variant::Plain));
    let mut forms = plain.to_vec();
    forms.extend([
        (ElementKind::Hexahedron20, Code::CalculiX, letters('R')),
        (ElementKind::Wedge6, Code::CalculiX, Variant::Plain),
        (ElementKind::Hexahedron8, Code::Abaqus, Variant::Plain),
        (ElementKind::Hexahedron8, Code::Nastran, Variant::Plain),
        (ElementKind::Hexahedron8, Code::CalculiX, Variant::Plain),
    ]);
    forms
}

fn of_form(kind: ElementKind, code: Code, variant: Variant) -> Mesh {
    let mut mesh = distorted(kind, false);
    mesh.code = code;
    for element in &mut mesh.elements {
        element.variant = variant;
    }
    mesh
}

/// Six unit strains of a unit cube, whose inner nodes are moved, give its stiffness by their work on each other. In the
/// axes of the material, its inverse has the engineering constants. The stresses at integration points and nodes are the
/// columns of this stiffness.
#[test]
fn a_cube_has_the_constants_of_its_material() {
    for (kind, code, variant) in forms() {
        let what = format!("{kind:?} {code:?} {variant:?}");
        let mut mesh = of_form(kind, code, variant);
        mesh.materials[0].solid = Some(carbon(LocalAxes::fixed(turned())));
        let rules = Rules::default();
        let structure = assemble(&mesh, &rules).unwrap();
        let states = [0, 1, 2, 3, 4, 5].map(|k| field(&mesh, &structure, unit_strain(k)));
        let forces = states
            .each_ref()
            .map(|state| times(&structure.stiffness, state));
        let found = states
            .each_ref()
            .map(|state| forces.each_ref().map(|force| dot(state, force)));
        let exact = seen_from(&transposed(&turned()), &carbon(LocalAxes::BASIC).stiffness);
        for (row, expected) in found.iter().zip(exact) {
            for (x, y) in row.iter().zip(expected) {
                assert!((x - y).abs() < 1e-12 * 140e9, "{what}: {found:?} {exact:?}");
            }
        }
        let compliance = inverse(&seen_from(&turned(), &found));
        let ratio = |i: usize, j: usize| -compliance[i][j] / compliance[i][i];
        let constants = [
            (1.0 / compliance[0][0], YOUNGS[0]),
            (1.0 / compliance[1][1], YOUNGS[1]),
            (1.0 / compliance[2][2], YOUNGS[2]),
            (ratio(0, 1), RATIOS[0]),
            (ratio(0, 2), RATIOS[1]),
            (ratio(1, 2), RATIOS[2]),
            (1.0 / compliance[3][3], SHEARS[0]),
            (1.0 / compliance[5][5], SHEARS[1]),
            (1.0 / compliance[4][4], SHEARS[2]),
        ];
        for (x, y) in constants {
            assert!(agrees(x, y, 1e-10), "{what}: {x} {y}");
        }
        // no force on the nodes inside, and the stress of each state
        for ((state, force), column) in states.iter().zip(&forces).zip(exact) {
            for (index, node) in mesh.nodes.iter().enumerate() {
                if !on_cube(node.position) {
                    for freedom in structure.freedoms.of(index as u32) {
                        assert!(force[freedom].abs() < 1e-12 * largest(force), "{what}");
                    }
                }
            }
            for value in nodal_stress(&mesh, &structure.freedoms, &rules, state)
                .iter()
                .flatten()
            {
                for (x, y) in value.iter().zip(column) {
                    assert!(
                        (x - y).abs() < 1e-11 * 140e9,
                        "{what}: {value:?} {column:?}"
                    );
                }
            }
        }
    }
}

fn transposed(matrix: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i: usize| [0, 1, 2].map(|j: usize| matrix[j][i]))
}

/// A pull along the first axis of the material shortens the others by ν₁₂ and ν₁₃, and a shear between the first two
/// follows G₁₂.
#[test]
fn pulled_and_sheared_along_its_axes() {
    let solid = carbon(LocalAxes::fixed(turned()));
    let columns = transposed(&turned());
    let [a, b, c] = columns;
    let outer = |x: [f64; 3], y: [f64; 3]| TENSOR.map(|(i, j)| 0.5 * (x[i] * y[j] + x[j] * y[i]));
    let engineering = |e: Components| [e[0], e[1], e[2], 2.0 * e[3], 2.0 * e[4], 2.0 * e[5]];
    let of = |parts: [Components; 3], factors: [f64; 3]| {
        let mut sum = [0.0; 6];
        for (part, factor) in parts.into_iter().zip(factors) {
            sum.iter_mut().zip(part).for_each(|(x, y)| *x += factor * y);
        }
        sum
    };
    let strain = engineering(of(
        [outer(a, a), outer(b, b), outer(c, c)],
        [1e-3, -0.3e-3, -0.28e-3],
    ));
    let found = solid.stress([3.0, 2.0, 1.0], &strain);
    let pull = outer(a, a).map(|x| 140e6 * x);
    for (x, y) in found.iter().zip(pull) {
        assert!((x - y).abs() < 1e-12 * 140e6, "{found:?} {pull:?}");
    }
    let [young, poisson] = solid.first_constants();
    assert!(agrees(young, 140e9, 1e-12) && agrees(poisson, 0.3, 1e-12));
    let found = solid.stress([0.0; 3], &engineering(outer(a, b)).map(|x| 1e-3 * x));
    // γ₁₂ = 1e-3
    let shear = outer(a, b).map(|x| 2.0 * 5e6 * x);
    for (x, y) in found.iter().zip(shear) {
        assert!((x - y).abs() < 1e-12 * 140e6, "{found:?} {shear:?}");
    }
}

/// An anisotropic material with the constants of an isotropic one has its matrices.
#[test]
fn equal_constants_make_an_isotropic_solid() {
    for (kind, code, variant) in forms() {
        let mesh = of_form(kind, code, variant);
        let mut other = mesh.clone();
        let shear = YOUNG / (2.0 * (1.0 + POISSON));
        let stiffness = SolidElasticity::orthotropic([YOUNG; 3], [POISSON; 3], [shear; 3]).unwrap();
        other.materials[0].solid = Some(SolidElasticity {
            stiffness,
            axes: LocalAxes::fixed(turned()),
        });
        let [one, two] =
            [&mesh, &other].map(|mesh| assemble(mesh, &Rules::default()).unwrap().stiffness);
        let vector: Vec<f64> = (0..one.size()).map(|i| (i as f64).sin()).collect();
        let (one, two) = (times(&one, &vector), times(&two, &vector));
        for (x, y) in one.iter().zip(&two) {
            assert!((x - y).abs() < 1e-12 * largest(&one), "{kind:?} {code:?}");
        }
    }
}

/// A quarter of a thick tube, wound around its axis, under the plane field `u_r = A r^k + B r^(−k)` with `k² = D_θθ/D_rr`,
/// which needs no load inside (S. G. Lekhnitskii, Anisotropic Plates, §28). Its energy is half the work of the radial
/// stress at both radii. With interpolated displacements it differs by 1.1e-6 at 8 × 8 elements.
#[test]
fn a_wound_tube_has_the_energy_of_the_closed_form() {
    let mut mesh = grid(ElementKind::Hexahedron20, [8, 8, 1], true, |x| {
        let (r, angle) = (1.0 + x[0] / 8.0, std::f64::consts::FRAC_PI_2 * x[1] / 8.0);
        [r * angle.cos(), r * angle.sin(), 0.3 * x[2]]
    });
    let stiffness =
        SolidElasticity::orthotropic([20e9, 140e9, 9e9], [0.04, 0.25, 0.3], [5e9, 4e9, 6e9])
            .unwrap();
    let around = |rotation, origin| LocalAxes {
        coordinates: Coordinates::Cylindrical,
        origin,
        ..LocalAxes::fixed(rotation)
    };
    let [along, about, across] = [stiffness[0][0], stiffness[1][1], stiffness[0][1]];
    let (k, a, b) = ((about / along).sqrt(), 1e-3, 2e-3);
    let displacement = |r: f64| a * r.powf(k) + b * r.powf(-k);
    let radial = |r: f64| {
        let slope = k * (a * r.powf(k - 1.0) - b * r.powf(-k - 1.0));
        along * slope + across * displacement(r) / r
    };
    let work = |r: f64| r * radial(r) * displacement(r);
    let exact = 0.5 * std::f64::consts::FRAC_PI_2 * 0.3 * (work(2.0) - work(1.0));
    let energy = |mesh: &Mesh| {
        let structure = assemble(mesh, &Rules::default()).unwrap();
        let full = field(mesh, &structure, |x| {
            let r = x[0].hypot(x[1]);
            [x[0], x[1], 0.0].map(|x| displacement(r) * x / r)
        });
        let found = 0.5 * dot(&full, &times(&structure.stiffness, &full));
        let of_points = energy_of_solids(mesh, &structure.freedoms, &Rules::default(), &full);
        assert!(agrees(of_points, found, 1e-12), "{of_points} {found}");
        found
    };
    // x of the coordinates does not matter, nor does the height of their origin
    for (rotation, origin) in [
        (LocalAxes::BASIC.rotation, [0.0; 3]),
        (
            [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
            [0.0, 0.0, 7.0],
        ),
    ] {
        mesh.materials[0].solid = Some(SolidElasticity {
            stiffness,
            axes: around(rotation, origin),
        });
        let found = energy(&mesh);
        assert!(agrees(found, exact, 1.3e-6), "{found} {exact}");
    }
    // the same axes everywhere are another tube
    mesh.materials[0].solid = Some(SolidElasticity {
        stiffness,
        axes: LocalAxes::BASIC,
    });
    assert!(!agrees(energy(&mesh), exact, 0.1));
}

/// Decks of the folder, and a text.
struct Decks<'a>(&'a str);

impl Files for Decks<'_> {
    fn open(&self, name: &str) -> std::io::Result<Box<dyn Read>> {
        if name == "own.inp" {
            return Ok(Box::new(std::io::Cursor::new(self.0.as_bytes().to_vec())));
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/orthotropic");
        Ok(Box::new(std::fs::File::open(folder.join(name))?))
    }
}

/// Ten frequencies of each deck, of which CalculiX prints seven digits.
#[test]
fn frequencies_are_those_of_calculix() {
    let mut text = String::new();
    let mut file = Decks("").open("reference.json").unwrap();
    file.read_to_string(&mut text).unwrap();
    let reference: Value = serde_json::from_str(&text).unwrap();
    let decks = reference.as_object().unwrap();
    assert_eq!(decks.len(), 10);
    for (name, printed) in decks {
        let mesh = read_inp(&Decks(""), &format!("{name}.inp"), Code::CalculiX).unwrap();
        let structure = |card: &&(&str, u64, Carries)| card.2 != Carries::Nothing;
        assert_eq!(unread(&mesh).iter().find(structure), None, "{name}");
        let request = Request {
            rules: Rules::calculix(),
            support_of_deck: true,
            terms: vec![Term::Normal {
                modes: Modes::Count(10),
                fixed: Vec::new(),
            }],
            ..Request::default()
        };
        let found = reduce(mesh, &request).unwrap().body.frequencies;
        let printed: Vec<f64> = printed
            .as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
            .collect();
        assert_eq!((found.len(), printed.len()), (10, 10), "{name}");
        for (own, other) in found.iter().zip(&printed) {
            assert!((own / other - 1.0).abs() < 1e-6, "{name}: {own} {other}");
        }
    }
}

/// A cube of C3D8, and its material and section.
const CUBE: &str = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n\
                    *ELEMENT, TYPE=C3D8, ELSET=CUBE\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*MATERIAL, NAME=M\n*DENSITY\n1.6e-9\n";
const ENGINEERING: &str = "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n140000., 10000., 6000., .3, .28, .4, 5000., 4500.\n3500.\n";

fn cube(lines: &str, code: Code) -> Result<Mesh, FlexibleError> {
    read_inp(&Decks(&format!("{CUBE}{lines}")), "own.inp", code)
}

fn problem_of_cube(lines: &str, code: Code) -> FileProblem {
    match cube(lines, code) {
        Err(FlexibleError::File(problem)) => problem,
        Err(error) => panic!("no problem of a file: {error}"),
        Ok(mesh) => panic!("read without a problem: {mesh:?}"),
    }
}

/// The elasticity of the first material in SI.
fn of_first(mut mesh: Mesh) -> SolidElasticity {
    mesh.convert(&MeshUnits::named("mm_tonne_s").unwrap());
    mesh.materials[0].solid.expect("an anisotropic solid")
}

#[test]
fn axes_of_an_orientation() {
    let section = "*SOLID SECTION, ELSET=CUBE, MATERIAL=M, ORIENTATION=O\n";
    let of = |orientation: &str, code| {
        let lines = format!("{ENGINEERING}*ORIENTATION, NAME=O{orientation}{section}");
        let mesh = cube(&lines, code).unwrap();
        let structure = |card: &&(&str, u64, Carries)| card.2 != Carries::Nothing;
        assert_eq!(unread(&mesh).iter().find(structure), None, "{lines}");
        of_first(mesh)
    };
    // a along y, b in the plane of y and z: the axes y, z, x
    let found = of("\n0., 2., 0., 0., 1., 3.\n", Code::Abaqus);
    let expected = carbon(LocalAxes::BASIC).stiffness;
    for (x, y) in found
        .stiffness
        .as_flattened()
        .iter()
        .zip(expected.as_flattened())
    {
        close(*x, *y, 1.5e12);
    }
    assert_eq!(
        found.axes.at([5.0; 3]),
        [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    );
    // a quarter turn about the third axis, x: the axes z, −y, x
    let found = of("\n0., 2., 0., 0., 1., 3.\n3, 90.\n", Code::CalculiX);
    assert_eq!(
        found.axes.at([5.0; 3]),
        [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]
    );
    // Abaqus takes a third point as the origin of the others
    let found = of("\n3., 5., 3., 3., 4., 6., 3., 3., 3.\n", Code::Abaqus);
    assert_eq!(
        found.axes.at([5.0; 3]),
        [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    );
    // an axis along z through x = 100 mm: radial, tangential, axial
    let round = ", SYSTEM=CYLINDRICAL\n100., 0., 0., 100., 0., 1.\n";
    let found = of(round, Code::CalculiX);
    let axes = found.axes.at([0.1, 0.2, 0.7]);
    for (row, expected) in axes
        .iter()
        .zip([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    {
        nastran_deck::close3(*row, expected, 1.0);
    }
    // and turned about the radial axis in Abaqus
    let found = of(&format!("{round}1, 90.\n"), Code::Abaqus);
    let axes = found.axes.at([0.1, 0.2, 0.7]);
    for (row, expected) in axes
        .iter()
        .zip([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    {
        nastran_deck::close3(*row, expected, 1.0);
    }
}

/// The axes of elements by a distribution: those of the first line for the elements without a line, of the last line of an
/// element for the others.
#[test]
fn axes_of_a_distribution() {
    let second = "*ELEMENT, TYPE=C3D8, ELSET=CUBE\n2, 1, 2, 3, 4, 5, 6, 7, 8\n3, 1, 2, 3, 4, 5, 6, 7, 8\n*ELSET, ELSET=LAST\n2, 3\n";
    let of = |lines: &str, code| {
        let lines = format!(
            "{ENGINEERING}{second}{lines}*SOLID SECTION, ELSET=CUBE, MATERIAL=M, ORIENTATION=O\n"
        );
        let mesh = cube(&lines, code).unwrap();
        let structure = |card: &&(&str, u64, Carries)| card.2 != Carries::Nothing;
        assert_eq!(unread(&mesh).iter().find(structure), None, "{lines}");
        let property = |element: &Element| &mesh.properties[element.property as usize];
        assert!(
            mesh.elements
                .iter()
                .all(|element| property(element).name == "CUBE")
        );
        let material = |element: &Element| property(element).material.unwrap() as usize;
        let axes = |element: &Element| mesh.materials[material(element)].solid.unwrap().axes;
        mesh.elements
            .iter()
            .map(|element| axes(element).at([0.5; 3]))
            .collect::<Vec<_>>()
    };
    let along_y = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let along_z = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
    let same = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let lines =
        ", 0., 2., 0., 0., 1., 3.\nLAST, 0., 0., 1., 1., 0., 5.\n3, 1., 0., 0., 0., 1., 0.\n";
    let calculix = format!("*DISTRIBUTION, NAME=D\n{lines}*ORIENTATION, NAME=O\nD\n");
    assert_eq!(of(&calculix, Code::CalculiX), [along_y, along_z, same]);
    let table = "*DISTRIBUTION TABLE, NAME=T\nCOORD3D, COORD3D\n";
    let abaqus = format!(
        "{table}*DISTRIBUTION, NAME=D, LOCATION=ELEMENT, TABLE=T\n{lines}*ORIENTATION, NAME=O, DEFINITION=COORDINATES\nD\n"
    );
    assert_eq!(of(&abaqus, Code::Abaqus), [along_y, along_z, same]);
    // a quarter turn about the third axis
    let turned = format!("{abaqus}3, 90.\n");
    assert_eq!(
        of(&turned, Code::Abaqus)[2],
        [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    );
}

#[test]
fn wrong_distributions() {
    let of = "*SOLID SECTION, ELSET=CUBE, MATERIAL=M, ORIENTATION=O\n";
    let orientation = "*ORIENTATION, NAME=O\nD\n";
    let lines = ", 1., 0., 0., 0., 1., 0.\n";
    for (deck, message) in [
        (
            orientation.to_string(),
            "*ORIENTATION: the distribution D is missing",
        ),
        (
            format!("*DISTRIBUTION, NAME=D\n1, 1., 0., 0., 0., 1., 0.\n{orientation}"),
            "*DISTRIBUTION: its first line is not that of the elements without a line of their own",
        ),
        (
            format!("*DISTRIBUTION, NAME=D\n{lines}{lines}{orientation}"),
            "a line of *DISTRIBUTION names no element",
        ),
        (
            format!("*DISTRIBUTION, NAME=D\n{lines}7, 1., 0., 0., 0., 1., 0.\n{orientation}"),
            "element 7 is missing",
        ),
        (
            format!("*DISTRIBUTION, NAME=D\n{lines}1, 1., 0., 0., 2., 0., 0.\n{orientation}"),
            "the points of the orientation O give no axes",
        ),
        (
            format!("*DISTRIBUTION, NAME=D\n, 1., 0., X, 0., 1., 0.\n{orientation}"),
            "point a is \"X\", not a number",
        ),
        (
            format!("*DISTRIBUTION, NAME=D, TABLE=T\n{lines}{orientation}"),
            "*DISTRIBUTION: the distribution table T is missing",
        ),
    ] {
        let found = problem_of_cube(&format!("{ENGINEERING}{deck}{of}"), Code::Abaqus);
        assert!(found.problem.contains(message), "{deck}: {found}");
    }
    let distribution = format!("*DISTRIBUTION, NAME=D, TABLE=T\n{lines}");
    for (deck, code) in [
        (
            format!("*DISTRIBUTION TABLE, NAME=T\nANGLE\n{distribution}{orientation}"),
            Code::Abaqus,
        ),
        (
            format!("*DISTRIBUTION, NAME=D, LOCATION=NODE\n{lines}{orientation}"),
            Code::Abaqus,
        ),
        (
            format!("{distribution}*ORIENTATION, NAME=O, SYSTEM=CYLINDRICAL\nD\n"),
            Code::Abaqus,
        ),
        // CalculiX turns the axes of each line by another angle
        (
            format!("{distribution}{orientation}3, 20.\n"),
            Code::CalculiX,
        ),
    ] {
        let mesh = cube(&format!("{ENGINEERING}{deck}{of}"), code).unwrap();
        let listed = unread(&mesh);
        let name = "*ORIENTATION by a distribution";
        assert!(
            listed.contains(&(name, 1, Carries::Structure)),
            "{deck}: {listed:?}"
        );
    }
}

/// The axes of a part turn with its instance.
#[test]
fn axes_turn_with_the_instance() {
    let part = CUBE.split("*MATERIAL").next().unwrap();
    let deck = |orientation: &str| {
        format!(
            "*PART, NAME=P\n{part}*ORIENTATION, NAME=O\n1., 0., 0., 0., 1., 0.\n*SOLID SECTION, ELSET=CUBE, MATERIAL=M{orientation}\n*END PART\n\
             *ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n0., 0., 0.\n0., 0., 0., 0., 0., 1., 90.\n*END INSTANCE\n*END ASSEMBLY\n\
             *MATERIAL, NAME=M\n*DENSITY\n1.6e-9\n{ENGINEERING}"
        )
    };
    let read = |text: &str| read_inp(&Memory::new(&[("own.inp", text)]), "own.inp", Code::Abaqus);
    let mesh = read(&deck(", ORIENTATION=O")).unwrap();
    assert_eq!(
        of_first(mesh).axes.at([0.0; 3]),
        [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    );
    let mesh = read(&deck("")).unwrap();
    let listed = unread(&mesh);
    let name = "anisotropic solids without ORIENTATION in a turned *INSTANCE";
    assert!(
        listed.contains(&(name, 1, Carries::Structure)),
        "{listed:?}"
    );
}

#[test]
fn wrong_constants_and_orientations() {
    let section = "*SOLID SECTION, ELSET=CUBE, MATERIAL=M\n";
    let of = "*SOLID SECTION, ELSET=CUBE, MATERIAL=M, ORIENTATION=O\n";
    for (lines, message) in [
        (
            format!(
                "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1., 9., 1., .9, 0., 0., 1., 1.\n1.\n{section}"
            ),
            "no elastic solid has these constants",
        ),
        (
            format!(
                "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1., 1., 1., 0., 0., 0., 1., 1.\n{section}"
            ),
            "G23 is missing: the line after this one is not there",
        ),
        (
            format!("*ELASTIC, TYPE=ORTHO\n1., 2., 1., 0., 0., 1., 1., 1.\n1.\n{section}"),
            "the material M has a stiffness that is not positive definite: a strain of 22 together with 11 costs no energy",
        ),
        (
            format!(
                "*ELASTIC, TYPE=ANISO\n1., 0., 1., 0., 0., 1., 0., 0.\n0., 1., 0., 0., 0., 0., 1.\n{section}"
            ),
            "the stiffness of 11 and 23 is missing (entry 8 of this line)",
        ),
        (format!("{ENGINEERING}{of}"), "the orientation O is missing"),
        (
            format!("{ENGINEERING}*ORIENTATION, NAME=O\n1., 0., 0., 2., 0., 0.\n{of}"),
            "the points of the orientation O give no axes",
        ),
        (
            format!("{ENGINEERING}*ORIENTATION, NAME=O\n1., 0., 0., 0., 1., 0.\n4, 20.\n{of}"),
            "*ORIENTATION turns its axes about \"4\", which is no axis",
        ),
        (
            format!(
                "{ENGINEERING}*ELEMENT, TYPE=T3D2, ELSET=ROD\n9, 1, 2\n*SOLID SECTION, ELSET=ROD, MATERIAL=M\n1.\n"
            ),
            "a section uses the material M, which has no isotropic *ELASTIC",
        ),
        (
            format!(
                "{ENGINEERING}*ELEMENT, TYPE=S4, ELSET=SHELL\n9, 1, 2, 3, 4\n*SHELL SECTION, ELSET=SHELL, MATERIAL=M\n1.\n"
            ),
            "a section uses the material M, which has no isotropic *ELASTIC",
        ),
    ] {
        let found = problem_of_cube(&lines, Code::CalculiX);
        assert!(found.problem.contains(message), "{lines}: {found}");
    }
    for (orientation, code, name) in [
        (
            ", SYSTEM=CYLINDRICAL\n0., 0., 0., 0., 0., 1.\n1, 20.\n",
            Code::CalculiX,
            "*ORIENTATION of more than two points",
        ),
        (
            "\n1., 0., 0., 0., 1., 0., 5., 5., 5.\n",
            Code::CalculiX,
            "*ORIENTATION of more than two points",
        ),
        (
            ", SYSTEM=Z RECTANGULAR\n1., 0., 0., 0., 1., 0.\n",
            Code::Abaqus,
            "*ORIENTATION of more than two points",
        ),
    ] {
        let lines = format!("{ENGINEERING}*ORIENTATION, NAME=O{orientation}{of}");
        let mesh = cube(&lines, code).unwrap();
        let listed = unread(&mesh);
        assert!(
            listed.contains(&(name, 1, Carries::Structure)),
            "{lines}: {listed:?}"
        );
    }
}

/// A tetrahedron of a material in a coordinate system, whose x axis is y of the basic one.
fn tetrahedron(cards: &str) -> String {
    format!(
        "CORD2R,7,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\nCORD2C,8,,5.,0.,0.,5.,0.,1.\n,6.,0.,0.\n\
         GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\nCTETRA,1,3,1,2,3,4\n{cards}"
    )
}

/// `MAT11` has the constants of `MAT9` with the same stiffness; both have the axes of CORDM.
#[test]
fn cards_of_anisotropic_solids() {
    let eleven = "MAT11,5,140000.,10000.,6000.,.3,.28,.4,5000.\n,4500.,3500.,1.6-9\n";
    let expected = SolidElasticity::orthotropic(
        [140000.0, 10000.0, 6000.0],
        RATIOS,
        [5000.0, 4500.0, 3500.0],
    )
    .unwrap();
    let mesh = nastran_deck::mesh(&tetrahedron(&format!("PSOLID,3,5,7\n{eleven}")));
    let material = &mesh.materials[0];
    let solid = material.solid.expect("an anisotropic solid");
    assert_eq!(solid.stiffness, expected);
    assert_eq!(
        solid.axes.at([9.0; 3]),
        [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    );
    close(material.young, 140000.0, 140000.0);
    close(material.poisson, 0.3, 10.0);
    close(material.density, 1.6e-9, 1.6e-9);
    assert_eq!((mesh.doubts.len(), mesh.unread.len()), (0, 0));
    // MAT9: the upper triangle by rows
    let mut fields = vec!["MAT9".to_string(), "5".into()];
    for (i, row) in expected.iter().enumerate() {
        fields.extend(
            row[i..]
                .iter()
                .map(|x| format!("{x:.16e}").replace('e', "E")),
        );
    }
    fields.push("1.6-9".into());
    let lines: Vec<String> = std::iter::once(fields[..9].join(","))
        .chain(
            fields[9..]
                .chunks(8)
                .map(|line| format!(",{}", line.join(","))),
        )
        .collect();
    let nine = nastran_deck::mesh(&tetrahedron(&format!(
        "PSOLID,3,5,8\n{}\n",
        lines.join("\n")
    )));
    let solid = nine.materials[0].solid.expect("an anisotropic solid");
    for (x, y) in solid
        .stiffness
        .as_flattened()
        .iter()
        .zip(expected.as_flattened())
    {
        close(*x, *y, 140000.0);
    }
    // the cylinder's axis is at x = 5
    let axes = solid.axes.at([5.0, 2.0, 1.0]);
    assert_eq!(axes, [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    let [doubt] = &nine.doubts[..] else {
        panic!("{:?}", nine.doubts);
    };
    assert!(
        doubt.contains("in the curvilinear system 8: Eng takes the axes at each point"),
        "{doubt}"
    );
    // a blank CORDM is told, 0 is not
    let blank = nastran_deck::mesh(&tetrahedron(&format!("PSOLID,3,5\n{eleven}")));
    assert!(
        blank.doubts[0].contains("PSOLID 3 has an anisotropic material and no CORDM"),
        "{:?}",
        blank.doubts
    );
    let zero = nastran_deck::mesh(&tetrahedron(&format!("PSOLID,3,5,0\n{eleven}")));
    assert_eq!(zero.doubts.len(), 0);
    assert_eq!(zero.materials[0].solid.unwrap().axes, LocalAxes::BASIC);
    // one material for each system
    let two = nastran_deck::mesh(&tetrahedron(&format!(
        "CTETRA,2,4,1,2,3,4\nCTETRA,3,6,1,2,3,4\nPSOLID,3,5,0\nPSOLID,4,5,7\nPSOLID,6,5,7\n{eleven}"
    )));
    let used: Vec<Option<u32>> = two.properties.iter().map(|own| own.material).collect();
    assert_eq!(used, [Some(0), Some(1), Some(1)]);
    // isotropic solids have no axes
    let steel = nastran_deck::mesh(&tetrahedron("PSOLID,3,5,-1\nMAT1,5,2.1+5,,.3,7.8-9\n"));
    assert_eq!(steel.doubts.len(), 0);
}

#[test]
fn wrong_cards_of_anisotropic_solids() {
    let eleven = "MAT11,5,140000.,10000.,6000.,.3,.28,.4,5000.\n,4500.,3500.,1.6-9\n";
    for (cards, message) in [
        (
            format!("PSOLID,3,5,-1\n{eleven}"),
            "PSOLID 3 has the axes of its anisotropic material along those of each element (CORDM of -1 or -2)",
        ),
        (
            format!("PSOLID,3,5,0\nPSOLID,4,5,-2\nCTETRA,2,4,1,2,3,4\n{eleven}"),
            "PSOLID 4 has the axes of its anisotropic material along those of each element",
        ),
        (
            format!("PSOLID,3,5,12\n{eleven}"),
            "PSOLID 3 uses coordinate system 12, which is missing",
        ),
        (
            format!("PSOLID,3,5,1.5\n{eleven}"),
            "its CORDM is no coordinate system",
        ),
        (
            "PSOLID,3,5\nMAT11,5,1.,9.,1.,.9,0.,0.,1.\n,1.,1.\n".to_string(),
            "no elastic solid has these constants",
        ),
        (
            "PSOLID,3,5\nMAT9,5,1.,,,,,,1.\n,,,,,1.\n,1.,,,-1.\n".to_string(),
            "MAT9 5, used by PSOLID 3, has a stiffness that is not positive definite: a strain of 23 together with 11, 22, 33, 12 costs no energy",
        ),
        (
            format!("PSOLID,3,5,0\nCTRIA3,9,4,1,2,3\nPSHELL,4,5,.1,5\n{eleven}"),
            "MAT11 5, used by PSHELL 4, is only for solids",
        ),
    ] {
        let found = nastran_deck::problem(&tetrahedron(&cards));
        assert!(found.problem.contains(message), "{cards}: {found}");
    }
}

/// What a program makes is checked before the matrices.
#[test]
fn unsound_materials_are_refused() {
    let mut mesh = bar(ElementKind::Hexahedron8, [1, 1, 1], [1.0; 3]);
    let mut solid = carbon(LocalAxes::BASIC);
    solid.stiffness[1][1] = -1.0;
    mesh.materials[0].solid = Some(solid);
    let message = fe_meshes::problem(assemble(&mesh, &Rules::default()));
    assert!(
        message.contains("a strain of 22 together with 11 costs no energy"),
        "{message}"
    );
    solid = carbon(LocalAxes::fixed([
        [2.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ]));
    mesh.materials[0].solid = Some(solid);
    let message = fe_meshes::problem(assemble(&mesh, &Rules::default()));
    assert!(message.contains("axes that are no rotation"), "{message}");
    // the stress of a material without such elasticity is isotropic
    let steel = &fe_meshes::empty().materials[0];
    let shear = stress(steel, [0.0; 3], &[0.0, 0.0, 0.0, 1e-3, 0.0, 0.0]);
    assert!(agrees(shear[3], 1e-3 * YOUNG / 2.6, 1e-14));
}
