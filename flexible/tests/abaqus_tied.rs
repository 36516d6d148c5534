//! `*TIE` of surfaces that do not match.

use crate::fe_meshes::{agrees, held, nodes_where, solve, times};
use crate::nastran_deck::{Memory, unread};
use eng_flexible::fe::mass::rigid_motions;
use eng_flexible::fe::{Reduction, Rules, assemble};
use eng_flexible::mesh::{Carries, Code, Tie};
use eng_flexible::read::abaqus::read_inp;
use eng_flexible::reduce::{Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::{FlexibleError, Mesh};
use std::fmt::Write;

/// The nodes and C3D8 of a block, numbered from `first`.
fn block(deck: &mut String, name: &str, first: usize, cells: [usize; 3], ends: [[f64; 3]; 2]) {
    let counts = cells.map(|n| n + 1);
    let node = |i: usize, j: usize, k: usize| first + i + counts[0] * (j + counts[1] * k);
    deck.push_str("*NODE\n");
    for k in 0..counts[2] {
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let place: Vec<f64> = [i, j, k]
                    .iter()
                    .zip(cells)
                    .zip(ends[0].iter().zip(ends[1]))
                    .map(|((i, n), (low, high))| low + *i as f64 / n as f64 * (high - low))
                    .collect();
                let [x, y, z] = [place[0], place[1], place[2]];
                writeln!(deck, "{}, {x}, {y}, {z}", node(i, j, k)).unwrap();
            }
        }
    }
    writeln!(deck, "*ELEMENT, TYPE=C3D8, ELSET={name}").unwrap();
    let mut id = first;
    for k in 0..cells[2] {
        for j in 0..cells[1] {
            for i in 0..cells[0] {
                let ring = |k: usize| {
                    [
                        node(i, j, k),
                        node(i + 1, j, k),
                        node(i + 1, j + 1, k),
                        node(i, j + 1, k),
                    ]
                };
                let nodes = [ring(k), ring(k + 1)].concat();
                let text: Vec<String> = nodes.iter().map(usize::to_string).collect();
                writeln!(deck, "{id}, {}", text.join(", ")).unwrap();
                id += 1;
            }
        }
    }
    writeln!(deck, "*SOLID SECTION, ELSET={name}, MATERIAL=STEEL").unwrap();
}

/// A column of two blocks, the lower one 2 × 2 × 3 and the upper one n × n × 3, with a gap between them, and the
/// lines of their tie.
fn column(n: usize, gap: f64, tie: &str) -> String {
    let mut deck = String::new();
    block(
        &mut deck,
        "LOW",
        1,
        [2, 2, 3],
        [[0.0; 3], [20.0, 20.0, 30.0]],
    );
    let ends = [[0.0, 0.0, 30.0 + gap], [20.0, 20.0, 60.0]];
    block(&mut deck, "HIGH", 101, [n, n, 3], ends);
    deck.push_str("*SURFACE, NAME=LEADS\n");
    for id in 9..13 {
        writeln!(deck, "{id}, S2").unwrap();
    }
    deck.push_str("*SURFACE, NAME=FOLLOWS\n");
    for id in 101..101 + n * n {
        writeln!(deck, "{id}, S1").unwrap();
    }
    deck + tie + "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*DENSITY\n7.85e-9\n"
}

fn read(deck: &str) -> Result<Mesh, FlexibleError> {
    let files = [("deck.inp", deck)];
    read_inp(&Memory::new(&files), "deck.inp", Code::CalculiX)
}

const TIE: &str = "*TIE, NAME=GLUE, POSITION TOLERANCE=0.1\nFOLLOWS, LEADS\n";

/// The frequencies of CalculiX 2.20, which moves the nodes over the gap of 0.02 mm and takes the same functions.
#[test]
fn a_tied_column_has_the_frequencies_of_calculix() {
    let calculix = [
        24774.80, 24774.89, 26634.15, 43241.65, 54087.07, 54087.16, 54876.25, 85311.61,
    ];
    let mesh = read(&column(3, 0.02, TIE)).unwrap();
    assert_eq!(unread(&mesh), []);
    assert_eq!(mesh.doubts.len(), 1);
    let expected = "the tie of the surface FOLLOWS bridges a gap of up to 2.000e-2";
    assert!(mesh.doubts[0].contains(expected), "{:?}", mesh.doubts);
    let request = Request {
        rules: Rules::calculix(),
        terms: vec![Term::Normal {
            modes: Modes::Count(8),
            fixed: Vec::new(),
        }],
        ..Request::default()
    };
    let found = reduce(mesh, &request).unwrap().body.frequencies;
    println!("{found:?}");
    assert_eq!(found.len(), 8);
    for (found, exact) in found.iter().zip(calculix) {
        assert!(agrees(*found, exact, 1e-5), "{found} {exact}");
    }
}

/// A pulled column stretches by F L/(E A) if the faces of one mesh divide those of the other. If not, the motion
/// between the tied nodes differs on both sides, as in every tie of nodes to faces.
#[test]
fn a_tied_column_is_pulled_as_one() {
    for (n, tolerance) in [(4, 1e-9), (3, 5e-3)] {
        let mut mesh = read(&column(n, 0.0, TIE)).unwrap();
        assert!(mesh.doubts.is_empty(), "{:?}", mesh.doubts);
        mesh.materials[0].poisson = 0.0;
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        let foot = held(&nodes_where(&mesh, |x| x[2] < 1e-9), 0b111);
        let reduction = Reduction::new(&mesh, &structure, &foot).unwrap();
        let top = nodes_where(&mesh, |x| x[2] > 60.0 - 1e-9);
        let mut force = vec![0.0; structure.freedoms.size()];
        for node in &top {
            let place = mesh.nodes[*node as usize].position;
            let sides = place[..2]
                .iter()
                .filter(|x| **x < 1e-9 || **x > 20.0 - 1e-9);
            let share = 0.5f64.powi(sides.count() as i32) / (n * n) as f64;
            force[structure.freedoms.freedom(*node, 2).unwrap()] = 1e4 * share;
        }
        let found = solve(&structure, &reduction, &force);
        let exact = 1e4 * 60.0 / (210000.0 * 400.0);
        for node in top {
            let moved = found[structure.freedoms.freedom(node, 2).unwrap()];
            assert!(agrees(moved, exact, tolerance), "{n}: {moved} {exact}");
        }
    }
}

/// Without `ADJUST` the gap stays, and the nodes turn with the faces.
#[test]
fn a_tie_over_a_gap_lets_rigid_motions_free() {
    for (gap, adjust) in [(0.5, "NO"), (0.5, "YES")] {
        let tie =
            format!("*TIE, NAME=GLUE, ADJUST={adjust}, POSITION TOLERANCE=1.\nFOLLOWS, LEADS\n");
        let mesh = read(&column(3, gap, &tie)).unwrap();
        let lowest = nodes_where(&mesh, |x| (x[2] - 30.0 - gap).abs() < 1e-9).len();
        assert_eq!(lowest, if adjust == "NO" { 16 } else { 0 });
        let structure = assemble(&mesh, &Rules::default()).unwrap();
        let size = structure.freedoms.size();
        for motion in rigid_motions(&mesh, &structure.freedoms).chunks(size) {
            for tie in &mesh.ties {
                let Tie::Equation { terms, .. } = tie else {
                    panic!("{tie:?}");
                };
                let sum: f64 = terms
                    .iter()
                    .map(|(node, freedom, factor)| {
                        factor * motion[structure.freedoms.freedom(*node, *freedom).unwrap()]
                    })
                    .sum();
                assert!(sum.abs() < 1e-11 * 60.0, "{sum}: {terms:?}");
            }
            let most = structure
                .stiffness
                .column(0)
                .1
                .iter()
                .fold(0.0f64, |m, x| m.max(x.abs()));
            let rest = times(&structure.stiffness, motion);
            assert!(rest.iter().all(|x| x.abs() < 1e-9 * 60.0 * most));
        }
    }
}

#[test]
fn ties_that_tie_nothing_are_refused() {
    let told = |gap: f64, tie: &str| match read(&column(3, gap, tie)) {
        Err(FlexibleError::File(problem)) => problem.problem,
        other => panic!("{other:?}"),
    };
    let found = told(5.0, "*TIE\nFOLLOWS, LEADS\n");
    assert!(
        found.contains("no node of FOLLOWS is near enough to LEADS"),
        "{found}"
    );
    let found = told(0.0, "*TIE\nFOLLOWS, NOWHERE\n");
    assert!(found.contains("the surface NOWHERE is missing"), "{found}");
    let nodes = "*SURFACE, TYPE=NODE, NAME=POINTS\n1, 1.\n*TIE\nFOLLOWS, POINTS\n";
    let found = told(0.0, nodes);
    assert!(
        found.contains("its second surface POINTS has no faces"),
        "{found}"
    );
    let found = told(0.0, "*TIE, POSITION TOLERANCE=wide\nFOLLOWS, LEADS\n");
    assert!(found.contains("POSITION TOLERANCE is \"wide\""), "{found}");
}

/// A node a million widths from two faces, which are as far from each other: the box of cells around all has 10¹⁸ of
/// them.
#[test]
fn a_far_node_is_tied_without_a_walk_over_all_cells() {
    let mut deck = String::new();
    let cube = |corner: [f64; 3]| [corner, corner.map(|x| x + 1.0)];
    let far = 1e6;
    block(&mut deck, "A", 1, [1; 3], cube([0.0, -far, -far]));
    block(&mut deck, "B", 101, [1; 3], cube([0.0, far, far]));
    block(&mut deck, "C", 201, [1; 3], cube([far, 0.0, 0.0]));
    deck.push_str("*SURFACE, NAME=LEADS\n1, S2\n101, S1\n*SURFACE, NAME=FOLLOWS\n201, S1\n");
    deck.push_str("*TIE, POSITION TOLERANCE=1e30\nFOLLOWS, LEADS\n");
    deck.push_str("*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*DENSITY\n7.85e-9\n");
    let mesh = read(&deck).unwrap();
    // √3 times 1e6
    let expected = "bridges a gap of up to 1.732e6";
    assert!(mesh.doubts[0].contains(expected), "{:?}", mesh.doubts);
}

/// A column held at three nodes, whose blocks a contact pair glues.
fn glued(n: usize, pair: &str) -> Result<Mesh, FlexibleError> {
    read(&column(
        n,
        0.0,
        &format!("*BOUNDARY\n1, 1, 3\n3, 2, 3\n7, 3, 3\n{pair}"),
    ))
}

const GLUE: &str = "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1.e7\n*FRICTION\n0.1, 1.e7
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE, ADJUST=0.01\nFOLLOWS, LEADS\n";

/// CalculiX 2.20 glues by springs of 10⁷ N/mm³ at points of the faces (`*STATIC`, then `*STEP, PERTURBATION`
/// and `*FREQUENCY`). Where the meshes match, this is the tie of nodes; where they do not, springs and ties
/// let other motions of the faces free.
#[test]
fn glued_contact_pairs_are_ties() {
    let abaqus = GLUE
        .replace("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1.e7\n", "")
        .replace("TYPE=SURFACE TO SURFACE", "TIED");
    let matching = [
        2163.366, 3257.414, 8786.845, 11069.81, 12610.14, 15738.91, 29038.98, 33513.43,
    ];
    let different = [
        2163.857, 3259.076, 8779.256, 11074.09, 12604.16, 15756.58, 28969.72, 33535.85,
    ];
    for (pair, n, calculix, tolerance) in [
        (GLUE, 2, matching, 4e-4),
        (abaqus.as_str(), 2, matching, 4e-4),
        (GLUE, 3, different, 7e-3),
    ] {
        let mesh = glued(n, pair).unwrap();
        assert_eq!(unread(&mesh), [("*FRICTION", 1, Carries::Nothing)]);
        assert_eq!(mesh.doubts, Vec::<String>::new());
        let request = Request {
            rules: Rules::calculix(),
            support_of_deck: true,
            terms: vec![Term::Normal {
                modes: Modes::Count(8),
                fixed: Vec::new(),
            }],
            ..Request::default()
        };
        let found = reduce(mesh, &request).unwrap().body.frequencies;
        println!("{n}: {found:?}");
        for (found, exact) in found.iter().zip(calculix) {
            assert!(agrees(*found, exact, tolerance), "{found} {exact}");
        }
    }
}

#[test]
fn contact_pairs_that_glue_nothing() {
    let open = GLUE.replace("PRESSURE-OVERCLOSURE=TIED", "PRESSURE-OVERCLOSURE=LINEAR");
    let mesh = glued(2, &open).unwrap();
    let lost = [
        ("*CONTACT PAIR", 1, Carries::Structure),
        ("*FRICTION", 1, Carries::Nothing),
    ];
    assert_eq!(unread(&mesh), lost);
    assert_eq!(mesh.ties, []);
    let told = |pair: &str| match glued(2, pair) {
        Err(FlexibleError::File(problem)) => problem.problem,
        other => panic!("{other:?}"),
    };
    let found = told(&GLUE.replace("ADJUST=0.01", "ADJUST=NEAR"));
    assert!(
        found.contains("ADJUST is \"NEAR\", not a number"),
        "{found}"
    );
    let found = told(&GLUE.replace("FOLLOWS, LEADS", "FOLLOWS"));
    assert!(found.contains("a line names one surface"), "{found}");
}
