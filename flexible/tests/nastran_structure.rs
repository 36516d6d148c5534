//! Masses, springs, ties, supports, interface and sets of the Nastran reader, by hand.

use crate::fe_meshes::{agrees, solve};
use crate::nastran_deck::*;
use eng_flexible::Place;
use eng_flexible::fe::{Reduction, Rules, assemble};
use eng_flexible::mesh::{Carries, Mesh, SCALAR, Spring, Support, Tie};

/// Six grid points; 6 has an analysis frame with x = y, y = −x.
const GRIDS: &str = "CORD2R,2,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.
GRID,1,,1.,0.,0.
GRID,2,,2.,0.,0.
GRID,3,,3.,0.,0.
GRID,4,,4.,0.,0.
GRID,5,,5.,0.,0.
GRID,6,,6.,1.,2.,2
";

fn support(node: u32, components: u8) -> Support {
    Support { node, components }
}

#[test]
fn a_mass_beside_its_node() {
    let mesh = mesh(&format!(
        "{GRIDS}CONM2,1,1,,2.,.1,.2,.3,\n,1.,.5,2.,.25,.125,3.\n"
    ));
    let matrix = mesh.point_masses[0].matrix;
    let (m, [x, y, z]) = (2.0, [0.1, 0.2, 0.3]);
    // products of inertia have a minus; Steiner's part about the node
    let expected = [
        [m, 0.0, 0.0, 0.0, m * z, -m * y],
        [0.0, m, 0.0, -m * z, 0.0, m * x],
        [0.0, 0.0, m, m * y, -m * x, 0.0],
        [
            0.0,
            -m * z,
            m * y,
            1.0 + m * (y * y + z * z),
            -0.5 - m * x * y,
            -0.25 - m * x * z,
        ],
        [
            m * z,
            0.0,
            -m * x,
            -0.5 - m * x * y,
            2.0 + m * (x * x + z * z),
            -0.125 - m * y * z,
        ],
        [
            -m * y,
            m * x,
            0.0,
            -0.25 - m * x * z,
            -0.125 - m * y * z,
            3.0 + m * (x * x + y * y),
        ],
    ];
    for (row, expected) in matrix.iter().zip(expected) {
        for (found, expected) in row.iter().zip(expected) {
            close(*found, expected, 5.0);
        }
    }
    assert_eq!((mesh.point_masses[0].id, mesh.point_masses[0].node), (1, 0));
}

#[test]
fn a_mass_in_other_frames_and_units() {
    let mesh = mesh(&format!(
        "{GRIDS}PARAM,WTMASS,.5
CONM2,1,6,-1,2.,7.,1.,2.
CONM2,2,1,2,2.,1.,,\n,1.,.5,2.,,,3.
CONM1,3,1,2,1.,,2.,,,3.\n,4.,,,5.,,,6.
CMASS2,4,8.,6,1
"
    ));
    // a place in the basic frame: 1 along x from the node
    let absolute = mesh.point_masses[0].matrix;
    assert_eq!(
        (absolute[0][0], absolute[1][5], absolute[2][4]),
        (1.0, 1.0, -1.0)
    );
    assert_eq!(absolute[5][5], 1.0);
    // x of the system is y: I11 about y, I22 about x, the product changes its sign
    let turned = mesh.point_masses[1].matrix;
    close(turned[3][3], 0.5 * (2.0 + 2.0), 5.0);
    close(turned[4][4], 0.5, 5.0);
    close(turned[5][5], 0.5 * (3.0 + 2.0), 5.0);
    close(turned[3][4], 0.25, 5.0);
    close(turned[0][5], -1.0, 5.0);
    // M11 2, M22 1 after turning; the lower triangle by rows: M33 is field 9 with M31, M32 before it
    let whole = mesh.point_masses[2].matrix;
    close(whole[0][0], 1.0, 5.0);
    close(whole[1][1], 0.5, 5.0);
    // the mass at freedom 1 of the analysis frame moves along y
    let freedom = mesh.point_masses[3].matrix;
    close(freedom[1][1], 4.0, 5.0);
    close(freedom[0][0], 0.0, 5.0);
}

#[test]
fn the_triangle_of_a_full_mass_matrix() {
    let values = (1..=21).map(|i| format!("{i}.")).collect::<Vec<_>>();
    let (first, rest) = values.split_at(5);
    let (second, third) = rest.split_at(8);
    let mesh = mesh(&format!(
        "{GRIDS}CONM1,1,1,,{}\n,{}\n,{}\n",
        first.join(","),
        second.join(","),
        third.join(",")
    ));
    let matrix = mesh.point_masses[0].matrix;
    let lower = (0..6_usize).flat_map(|i| (0..=i).map(move |j| (i, j)));
    for (number, (i, j)) in (1..=21).zip(lower) {
        let value = f64::from(number);
        assert_eq!((matrix[i][j], matrix[j][i]), (value, value));
    }
}

#[test]
fn springs_to_nodes_and_ground() {
    let mesh = mesh(&format!(
        "{GRIDS}SPOINT,100
CELAS2,1,1000.,1,1,2,1
CELAS2,2,2000.,3,6
CELAS2,3,3000.,,,4,2
PELAS,7,4000.,,,8,5000.
CELAS1,4,7,1,2,2,2
CELAS1,5,8,6,3
CELAS2,6,1.,1,1,100
CELAS4,7,2.,100,300
CELAS3,8,8,,300
PMASS,4,7.
CMASS3,9,4,300
CMASS2,10,3.,1,1,2,1
"
    ));
    let spring = Spring::between;
    assert_eq!(
        mesh.springs,
        [
            spring(1, 1000.0, (0, 0), Some((1, 0))),
            spring(2, 2000.0, (2, 5), None),
            spring(3, 3000.0, (3, 1), None),
            spring(4, 4000.0, (0, 1), Some((1, 1))),
            spring(5, 5000.0, (5, 2), None),
            spring(6, 1.0, (0, 0), Some((SCALAR, 0))),
            spring(7, 2.0, (SCALAR, 0), Some((SCALAR | 1, 0))),
            spring(8, 5000.0, (SCALAR | 1, 0), None),
        ]
    );
    assert_eq!(mesh.scalar_points, [100, 300]);
    assert_eq!(
        mesh.inerters,
        [
            spring(9, 7.0, (SCALAR | 1, 0), None),
            spring(10, 3.0, (0, 0), Some((1, 0))),
        ]
    );
    assert_eq!(unread(&mesh), []);
}

/// K2 at a quarter of the way from grid point 1 to 2 is in 2's turned frame, too; K1 and K4 need no axes.
#[test]
fn bushings_act_at_one_place() {
    let mesh = mesh(&format!(
        "{GRIDS}PBUSH,7,K,10.,20.,,,,60.\n,,B,1.,2.\n,,GE,.01
PBUSH,8,K,5.,,,7.
CBUSH,1,7,1,2,,,,0\n,.25
CBUSH,2,8,2,3
CBUSH,3,8,6,,,,,2
CBUSH,4,7,1,6,0.,0.,1.
"
    ));
    assert_eq!(unread(&mesh), []);
    let of = |id: u64| {
        let own = mesh.springs.iter().filter(move |spring| spring.id == id);
        own.map(|spring| (spring.stiffness, spring.terms.clone(), spring.grounded))
            .collect::<Vec<_>>()
    };
    let first = of(1);
    assert_eq!(
        first[..2],
        [
            (10.0, vec![(0, 0, -1.0), (1, 0, 1.0)], false),
            (
                20.0,
                vec![(0, 1, -1.0), (0, 5, -0.25), (1, 1, 1.0), (1, 5, -0.75)],
                false
            ),
        ]
    );
    assert_eq!(first.len(), 3);
    assert_eq!(
        of(2),
        [
            (5.0, vec![(1, 0, -1.0), (2, 0, 1.0)], false),
            (7.0, vec![(1, 3, -1.0), (2, 3, 1.0)], false),
        ]
    );
    // grid point 6 and the bushing have the same axes
    let [along, about] = &of(3)[..] else {
        panic!("{:?}", of(3));
    };
    assert_eq!((along.0, about.0, along.2), (5.0, 7.0, true));
    assert_eq!(
        (&along.1[..], &about.1[..]),
        (&[(5, 0, -1.0)][..], &[(5, 3, -1.0)][..])
    );
    // no rigid motion stretches a bushing that is not grounded
    for (_, terms, grounded) in [of(1), of(2), of(4)].concat() {
        assert!(!grounded);
        for motion in 0..6 {
            let mut extension = 0.0;
            for (node, freedom, factor) in &terms {
                let node = &mesh.nodes[*node as usize];
                let unit = |k: usize| [0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 });
                let (u, turn) = match motion {
                    0..3 => (unit(motion), [0.0; 3]),
                    _ => {
                        let ([a, b, c], [x, y, z]) = (unit(motion - 3), node.position);
                        ([b * z - c * y, c * x - a * z, a * y - b * x], [a, b, c])
                    }
                };
                let vector = if *freedom < 3 { u } else { turn };
                let axis = usize::from(freedom % 3);
                let along: f64 = match node.frame {
                    Some(frame) => {
                        let rotation = mesh.frames[frame as usize].rotation;
                        (0..3).map(|i| rotation[i][axis] * vector[i]).sum()
                    }
                    None => vector[axis],
                };
                extension += factor * along;
            }
            assert!(extension.abs() < 1e-14, "{motion}: {terms:?} {extension}");
        }
    }
}

/// A force F at the arm r beyond a bushing moves its end by F/K₂ + F r²/K₆.
#[test]
fn a_bushing_yields_and_turns() {
    let mesh = mesh(
        "GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
CONM2,5,2,,1.,,,,,+
+,1.,,1.,,,1.
PBUSH,7,K,1.+5,2.+4,3.+4,50.,60.,70.
CBUSH,1,7,1,2,,,,0
,.25
",
    );
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let reduction = Reduction::new(&mesh, &structure, &[support(0, 63)]).unwrap();
    let mut force = vec![0.0; structure.freedoms.size()];
    let at = |component: u8| structure.freedoms.freedom(1, component).unwrap();
    force[at(1)] = 3.0;
    let found = solve(&structure, &reduction, &force);
    let exact = 3.0 / 2e4 + 3.0 * 0.75 * 0.75 / 70.0;
    assert!(agrees(found[at(1)], exact, 1e-12), "{}", found[at(1)]);
    assert!(agrees(found[at(5)], 3.0 * 0.75 / 70.0, 1e-12));
}

/// A bushing beside the line of its ends, placed in a turned system: a force F along y turns its end by F r/K₆ with
/// the arm r along x from the bushing, and moves it by F/K₂ + F r²/K₆ along y and F r s/K₆ along x.
#[test]
fn a_bushing_beside_its_ends_has_arms() {
    let mesh = mesh(
        "GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
CORD2R,4,,0.,0.,0.,0.,0.,1.,+
+,0.,1.,0.
CONM2,5,2,,1.,,,,,+
+,1.,,1.,,,1.
PBUSH,7,K,1.+5,2.+4,3.+4,50.,60.,70.
CBUSH,1,7,1,2,,,,0
,.9,4,.5,-.25
",
    );
    assert_eq!(unread(&mesh), []);
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let reduction = Reduction::new(&mesh, &structure, &[support(0, 63)]).unwrap();
    let mut force = vec![0.0; structure.freedoms.size()];
    let at = |component: u8| structure.freedoms.freedom(1, component).unwrap();
    force[at(1)] = 3.0;
    let found = solve(&structure, &reduction, &force);
    // at x = 0.25, y = 0.5 of the basic system
    let turn = 3.0 * 0.75 / 70.0;
    for (component, exact) in [(5, turn), (1, 3.0 / 2e4 + turn * 0.75), (0, turn * 0.5)] {
        let moved = found[at(component)];
        assert!(agrees(moved, exact, 1e-12), "{component}: {moved} {exact}");
    }
}

/// A bushing along the line of its ends: the spring's extension is the difference of the ends' displacements along it.
/// One on the ground acts along the x axis of its system.
#[test]
fn a_bushing_along_one_axis_is_a_spring_along_its_line() {
    let mesh = mesh(
        "CORD2R,2,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.
GRID,1,,1.,1.,0.
GRID,2,,4.,5.,0.
PBUSH1D,7,250.,3.
,SPRING,TABLE,9
CBUSH1D,1,7,1,2
CBUSH1D,2,7,2,,2
CBUSH1D,7,,2,1
",
    );
    assert_eq!(unread(&mesh), []);
    let moved = |node: u32, freedom: u8| -> f64 {
        // (0.1, 0.2, 0.4) at node 1 and (0.3, 0.7, 0.9) at node 2, without turns
        let places = [
            [0.1, 0.2, 0.4, 0.0, 0.0, 0.0],
            [0.3, 0.7, 0.9, 0.0, 0.0, 0.0],
        ];
        places[node as usize][usize::from(freedom)]
    };
    let along = (0.3 - 0.1) * 0.6 + (0.7 - 0.2) * 0.8;
    // the system's x axis is y of the basic one
    for (spring, (extension, grounded)) in
        mesh.springs
            .iter()
            .zip([(along, false), (0.7, true), (along, false)])
    {
        assert!(agrees(spring.stiffness, 250.0, 1e-14));
        let terms = spring.terms.iter();
        let found: f64 = terms
            .map(|(node, freedom, factor)| factor * moved(*node, *freedom))
            .sum();
        assert!(agrees(found.abs(), extension, 1e-12), "{found} {extension}");
        assert_eq!(spring.grounded, grounded);
    }
    assert_eq!(mesh.springs.len(), 3);
}

#[test]
fn bushings_without_axes_or_stiffness_are_refused() {
    let told = |cards: &str| problem(&format!("{GRIDS}{cards}")).problem;
    let cases = [
        (
            "PBUSH,7,K,1.,2.\nCBUSH,1,7,1,2\n",
            "bushing 1 has K2, K3, K5 or K6, and no axes",
        ),
        (
            "PBUSH,7,K,1.\nCBUSH,1,7,1\n",
            "bushing 1 has both ends at one place, or one end, and no axes",
        ),
        (
            "PBUSH,7,K,1.\nCBUSH,1,7,1,2,1.,0.,0.\n",
            "bushing 1: its orientation vector lies along it",
        ),
        (
            "CBUSH,1,7,1,2\n",
            "bushing 1 uses property 7, which is missing",
        ),
        (
            "PBUSH,7,K,1.\nPBUSH,7,K,2.\n",
            "property 7 of bushings is defined twice",
        ),
        ("PBUSH,7,X,1.\n", "a line of PBUSH begins with \"X\""),
        (
            "PBUSH,7,K,1.\nCBUSH,1,7\n",
            "bushing 1 has no end at a grid point",
        ),
        (
            "PBUSH,7,K,1.\nCBUSH,1,7,1,2\n,,4,1.\n",
            "bushing 1 uses coordinate system 4, which is missing",
        ),
        ("PBUSH,7,K,1.\nCBUSH,1,7,1,2\n,,0,x\n", "S1"),
        (
            "PBUSH,7,K,1.\nCBUSH1D,1,7,1,2\n",
            "bushing 1 uses property 7, which is missing",
        ),
        (
            "PBUSH1D,7,1.\nCBUSH1D,1,7,1\n",
            "bushing 1 has both ends at one place, or one end, and no axes",
        ),
        (
            "PBUSH1D,7,1.\nCBUSH1D,1,7,1,2,2\n",
            "the x axis of system 2 of bushing 1 is not along the line between its ends",
        ),
    ];
    for (cards, expected) in cases {
        let found = told(cards);
        assert!(found.contains(expected), "{found}");
    }
    let lost = mesh(&format!("{GRIDS}PBUSH,7,K,1.\n,,M,2.\nCBUSH,1,7,1,2\n"));
    assert_eq!(unread(&lost), [("mass of PBUSH", 1, Carries::Structure)]);
    let lost = mesh(&format!("{GRIDS}PBUSH1D,7,1.,,2.\nCBUSH1D,1,7,1,2\n"));
    assert_eq!(unread(&lost), [("mass of PBUSH1D", 1, Carries::Structure)]);
}

#[test]
fn rigid_spiders() {
    let mesh = mesh(&format!(
        "{GRIDS}RBE2,1,1,123,2,3,4,5
RBE2,2,1,123456,6,1.2-5
RBE2,3,1,12,2,THRU,5
RBAR,4,1,2,123456
RBAR,5,1,2,,123456,123
RBAR1,6,1,2,12
RBE1,7,1,123456\n,UM,2,123,3,456
RBE2,8,1,123,2,3,4,5,+\n+,6,.1
"
    ));
    let rigid = |id, independent, dependent: &[(u32, u8)]| Tie::Rigid {
        id,
        independent,
        dependent: dependent.to_vec(),
    };
    assert_eq!(
        mesh.ties,
        [
            rigid(1, 0, &[(1, 7), (2, 7), (3, 7), (4, 7)]),
            rigid(2, 0, &[(5, 63)]),
            rigid(3, 0, &[(1, 3), (2, 3), (3, 3), (4, 3)]),
            rigid(4, 0, &[(1, 63)]),
            rigid(5, 1, &[(0, 7)]),
            rigid(6, 0, &[(1, 3)]),
            rigid(7, 0, &[(1, 7), (2, 56)]),
            rigid(8, 0, &[(1, 7), (2, 7), (3, 7), (4, 7), (5, 7)]),
        ]
    );
}

#[test]
fn rigid_elements_with_shared_freedoms() {
    // 1 at (1, 0, 0), 6 at (6, 1, 2) with x = y, y = −x: 1 gives the translations, 6 the rotations about its axes
    let mesh = mesh(&format!(
        "{GRIDS}RBAR,1,1,6,123,456\nRBE1,2,1,123,6,456\n,UM,6,12\n"
    ));
    // θ = (−θ₅, θ₄, θ₆) in basic axes, d = (5, 1, 2): u = θ × d
    let expected = |freedom: u8| match freedom {
        // along basic y: θz dx − θx dz
        0 => vec![(5, 0, 1.0), (0, 1, -1.0), (5, 4, -2.0), (5, 5, -5.0)],
        // along −x: −(θy dz − θz dy)
        1 => vec![(5, 1, 1.0), (0, 0, 1.0), (5, 3, 2.0), (5, 5, -1.0)],
        // along z: θx dy − θy dx
        _ => vec![(5, 2, 1.0), (0, 2, -1.0), (5, 3, 5.0), (5, 4, 1.0)],
    };
    let mut found = mesh.ties.iter().map(|tie| match tie {
        Tie::Equation { id, terms } => {
            let mut sorted = terms.clone();
            sorted[1..].sort_by_key(|(node, freedom, _)| (*node, *freedom));
            (*id, sorted)
        }
        other => panic!("{other:?}"),
    });
    let mut equation = |id: u64, terms: Vec<(u32, u8, f64)>| {
        let (found_id, found) = found.next().expect("an equation");
        assert_eq!((found_id, found.len()), (id, terms.len()), "{found:?}");
        for ((node, freedom, value), expected) in found.into_iter().zip(terms) {
            assert_eq!((node, freedom), (expected.0, expected.1));
            close(value, expected.2, 10.0);
        }
    };
    // the dependent rotations of 1 come first: about x, y, z
    equation(1, vec![(0, 3, 1.0), (5, 4, 1.0)]);
    equation(1, vec![(0, 4, 1.0), (5, 3, -1.0)]);
    equation(1, vec![(0, 5, 1.0), (5, 5, -1.0)]);
    for freedom in 0..3 {
        equation(1, expected(freedom));
    }
    equation(2, expected(0));
    equation(2, expected(1));
    assert_eq!(mesh.ties.len(), 8);
}

/// The sum of a tie's terms under a small rigid motion: translation u, rotation θ about the origin.
fn rest(mesh: &Mesh, tie: &Tie, u: [f64; 3], theta: [f64; 3]) -> f64 {
    let Tie::Equation { terms, .. } = tie else {
        panic!("{tie:?}")
    };
    let part = |&(node, freedom, coefficient): &(u32, u8, f64)| {
        let node = &mesh.nodes[node as usize];
        let [x, y, z] = node.position;
        let moved = [
            u[0] + theta[1] * z - theta[2] * y,
            u[1] + theta[2] * x - theta[0] * z,
            u[2] + theta[0] * y - theta[1] * x,
        ];
        let seen = if freedom < 3 { moved } else { theta };
        let axis = usize::from(freedom % 3);
        let own = match node.frame {
            Some(frame) => (0..3)
                .map(|i| mesh.frames[frame as usize].rotation[i][axis] * seen[i])
                .sum(),
            None => seen[axis],
        };
        coefficient * own
    };
    terms.iter().map(part).sum()
}

#[test]
fn rigid_plates_and_rods() {
    let found = mesh(&format!(
        "{GRIDS}GRID,7,,1.,3.,.5
RTRPLT1,1,1,6,7,,3
RTRPLT,2,1,6,7,123456,,,,+
+,123,12
RTRPLT,3,1,6,7,123,13,3
RROD,4,1,6,1
RROD,5,1,6,,2
"
    ));
    let rigid = |id, dependent: &[(u32, u8)]| Tie::Rigid {
        id,
        independent: 0,
        dependent: dependent.to_vec(),
    };
    assert_eq!(found.ties[0], rigid(1, &[(5, 63), (6, 4)]));
    assert_eq!(found.ties[1], rigid(2, &[(5, 7), (6, 3)]));
    // twelve freedoms follow from the six of the third plate
    assert_eq!(found.ties.len(), 2 + 12 + 2);
    for tie in &found.ties[2..] {
        let rest = rest(&found, tie, [0.3, -0.7, 0.2], [0.11, 0.05, -0.13]);
        assert!(rest.abs() < 1e-14, "{rest}: {tie:?}");
    }
    // from 1 to 6 along (5, 1, 2); the axes of 6 are y and −x of the basic system
    let length = 30_f64.sqrt();
    let [a, b, c] = [5.0, 1.0, 2.0].map(|x| x / length);
    for (tie, expected) in found.ties[14..].iter().zip([
        [
            (0, 0, -a),
            (0, 1, -b),
            (0, 2, -c),
            (5, 0, b),
            (5, 1, -a),
            (5, 2, c),
        ],
        [
            (5, 1, -a),
            (0, 0, -a),
            (0, 1, -b),
            (0, 2, -c),
            (5, 0, b),
            (5, 2, c),
        ],
    ]) {
        let Tie::Equation { terms, .. } = tie else {
            panic!("{tie:?}")
        };
        assert_eq!(terms.len(), 6);
        for (term, expected) in terms.iter().zip(expected) {
            assert_eq!((term.0, term.1), (expected.0, expected.1), "{terms:?}");
            close(term.2, expected.2, 1.0);
        }
    }
    // a change of the distance is no motion of the rod
    let stretched = Tie::Equation {
        id: 4,
        terms: vec![(0, 0, -a), (0, 1, -b), (0, 2, -c)],
    };
    assert!(rest(&found, &stretched, [1.0, 0.0, 0.0], [0.0; 3]).abs() > 0.9);
}

#[test]
fn averaging_spiders() {
    let mesh = mesh(&format!(
        "{GRIDS}RBE3,1,,6,123456,1.0,123,1,2\n,3,2.5,12,4,5
RBE3,2,,6,123,1,123,1,THRU\n,3,UM,1,123,ALPHA,1.-5
RBE3           3               5  123456      1.     123       1       2
"
    ));
    assert_eq!(
        mesh.ties,
        [
            Tie::Averaging {
                id: 1,
                reference: 5,
                reference_components: 63,
                independent: vec![
                    (0, 1.0, 7),
                    (1, 1.0, 7),
                    (2, 1.0, 7),
                    (3, 2.5, 3),
                    (4, 2.5, 3)
                ],
            },
            Tie::Averaging {
                id: 2,
                reference: 5,
                reference_components: 7,
                independent: vec![(0, 1.0, 7), (1, 1.0, 7), (2, 1.0, 7)],
            },
            Tie::Averaging {
                id: 3,
                reference: 4,
                reference_components: 63,
                independent: vec![(0, 1.0, 7), (1, 1.0, 7)],
            },
        ]
    );
}

#[test]
fn equations() {
    let deck = format!(
        "{GRIDS}MPC,1,1,1,1.,2,1,-1.
MPC,2,1,2,1.,2,2,-.5,\n,,3,2,-.5,4,3,.25
MPCADD,9,2
SPOINT,77
MPC,2,3,3,1.,77,0,1.
"
    );
    let all = mesh(&deck);
    let first = Tie::Equation {
        id: 1,
        terms: vec![(0, 0, 1.0), (1, 0, -1.0)],
    };
    let second = Tie::Equation {
        id: 2,
        terms: vec![(0, 1, 1.0), (1, 1, -0.5), (2, 1, -0.5), (3, 2, 0.25)],
    };
    let scalar = Tie::Equation {
        id: 2,
        terms: vec![(2, 2, 1.0), (SCALAR, 0, 1.0)],
    };
    assert_eq!(all.ties, [first, second.clone(), scalar.clone()]);
    assert_eq!(unread(&all), []);
    let selected = mesh(&format!("CEND\nMPC = 9\nBEGIN BULK\n{deck}"));
    assert_eq!(selected.ties, [second, scalar]);
}

#[test]
fn ties_that_cannot_be() {
    for (card, message) in [
        (
            "RBE2,1,9,123,2",
            "RBE2 1 uses grid point 9, which is missing",
        ),
        (
            "RBE2,1,1,123,99",
            "RBE2 1 uses grid point 99, which is missing",
        ),
        ("RBE2,1,1,123", "ends before its field GM1"),
        ("RBE2,1,1,128,2", "field CM is \"128\", not freedoms 1 to 6"),
        ("RBE2,1,1,123,5,THRU,2", "THRU 2 has no lower number"),
        ("RBE3,1,,6,123", "ends before its field WT1"),
        ("RBE3,1,,6,123,1.,123", "no grid points follow a weight"),
        ("RBE3,1,,6,123,-1.,123,1,2", "the weight -1 is negative"),
        (
            "RBAR,1,1,2,123,123",
            "the independent freedoms of RBAR 1 do not hold all rigid motions",
        ),
        ("RBAR,1,1,2,123,45", "5 independent freedoms instead of six"),
        (
            "RTRPLT,1,1,2,6,123,123",
            "the independent freedoms of RTRPLT 1 do not hold all rigid motions",
        ),
        ("RTRPLT1,1,1,2", "ends before its field GC"),
        ("RBAR1,1,1", "ends before its field GB"),
        ("RROD,1,1,2", "it does not name one dependent translation"),
        ("RROD,1,1,2,4", "it does not name one dependent translation"),
        (
            "RROD,1,1,2,1,1",
            "it does not name one dependent translation",
        ),
        (
            "RROD,1,1,2,2",
            "the dependent translation of RROD 1 is perpendicular to the rod",
        ),
        ("RROD,1,1,1,1", "its ends are at one place"),
        ("RBE1,1,1,123,2,456", "\"UM\" is missing"),
        ("MPC,1,1,1,0.,2,1,1.", "the first coefficient is zero"),
        ("MPC,1,1,,1.,2,1,1.", "states no freedom of grid point 1"),
        (
            "RBE2,1,1,123,2\nRBE3,1,,6,123,1.,123,1,2",
            "rigid element 1 is defined twice",
        ),
        ("CELAS2,1,1.", "the spring has no end at a grid point"),
        ("CELAS2,1,1.,1,,2,1", "states no freedom of grid point 1"),
        (
            "CELAS1,1,5,1,1",
            "spring 1 uses property 5, which is missing",
        ),
        (
            "CONM2,1,9,,1.",
            "mass 1 uses grid point 9, which is missing",
        ),
        (
            "CONM2,1,1,9,1.",
            "mass 1 uses coordinate system 9, which is missing",
        ),
        ("CONM2,1,1,,1.\nCONM2,1,2,,1.", "mass 1 is defined twice"),
    ] {
        let found = problem(&format!("{GRIDS}{card}\n"));
        assert!(matches!(found.place, Place::Line(9 | 10)), "{found}");
        assert!(found.problem.contains(message), "{found}");
        assert!(!found.advice.is_empty());
    }
}

#[test]
fn supports_of_all_sets_or_the_selected_one() {
    let deck = format!(
        "{GRIDS}GRID,7,,7.,0.,0.,,56
SPC,1,1,12,,2,3
SPC,1,2,6,.01
SPC1,2,123,3,4
SPC1,3,4,1,THRU,4
SPC,3,2202,0,0.
SPCADD,8,2,3
"
    );
    let all = mesh(&deck);
    assert_eq!(
        all.supports,
        [
            support(0, 0b1011),
            support(1, 0b10_1100),
            support(2, 0b1111),
            support(3, 0b1111),
            support(6, 0b11_0000),
        ]
    );
    assert!(unread(&all).is_empty());
    let moved: Vec<_> = all
        .support_cards
        .iter()
        .filter(|cards| cards.moved.is_some())
        .map(|cards| (&*cards.name, cards.count))
        .collect();
    assert_eq!(moved, [("SPC", 3)]);
    let control = |line: &str| format!("SOL 103\nCEND\n{line}\nBEGIN BULK\n{deck}");
    let one = mesh(&control("SPC = 1"));
    assert_eq!(
        one.supports,
        [
            support(0, 0b0011),
            support(1, 0b10_0100),
            support(6, 0b11_0000)
        ]
    );
    let sum = mesh(&control("SUBCASE 1\n  SPC=8"));
    assert_eq!(
        sum.supports,
        [
            support(0, 0b1000),
            support(1, 0b1000),
            support(2, 0b1111),
            support(3, 0b1111),
            support(6, 0b11_0000)
        ]
    );
    assert!(unread(&sum).contains(&("SPC of sets not selected", 2, Carries::Nothing)));
    let none = mesh(&control("TITLE = free"));
    assert_eq!(none.supports, all.supports);
    // the subcase of the modes counts, and no other
    let modes = mesh(&control(
        "SUBCASE 1\n SPC=1\nSUBCASE 2\n METHOD = 4\n SPC=8",
    ));
    assert_eq!(modes.supports, sum.supports);
    assert_eq!(modes.doubts, [""; 0]);
    let free = mesh(&control("SUBCASE 1\n SPC=1\nSUBCASE 2\n METHOD = 4"));
    assert_eq!(free.supports, [support(6, 0b11_0000)]);
    // entries above the subcases are those of all
    let above = mesh(&control("SPC=1\nMETHOD=4\nSUBCASE 1\nSUBCASE 2\n LOAD=3"));
    assert_eq!(above.supports, one.supports);
    assert_eq!(above.doubts, [""; 0]);
    let both = mesh(&control("METHOD=4\nSUBCASE 1\n SPC=1\nSUBCASE 2\n SPC=8"));
    assert_eq!(both.supports, one.supports);
    assert_eq!(
        both.doubts,
        [
            "deck.bdf:7: the supports differ: subcase 1 selects SPC = 1 (line 5), subcase 2 selects SPC = 8 (line 7); the first ones are read. Keep METHOD in the subcase of the wanted modes alone, or leave out the other subcases"
        ]
    );
}

/// An equation changes the stiffness, so two subcases of modes must agree in them.
#[test]
fn equations_are_those_of_the_subcase_of_the_modes() {
    let deck = |control: &str| {
        format!(
            "SOL 103\nCEND\n{control}\nBEGIN BULK\n{GRIDS}MPC,5,1,1,1.,2,1,-1.\nMPC,6,1,2,1.,2,2,-1.\n"
        )
    };
    let component = |mesh: &Mesh| {
        let first = mesh.ties.iter().map(|tie| match tie {
            Tie::Equation { terms, .. } => terms[0].1,
            _ => 9,
        });
        first.collect::<Vec<_>>()
    };
    let found = mesh(&deck("SUBCASE 1\n MPC=6\nSUBCASE 2\n METHOD=1\n MPC=5"));
    assert_eq!(component(&found), [0]);
    let found = mesh(&deck("SUBCASE 1\n MPC=6\nSUBCASE 2\n METHOD=1"));
    assert_eq!(component(&found), [0u8; 0]);
    let found = problem(&deck("METHOD=1\nSUBCASE 1\n MPC=6\nSUBCASE 2\n MPC=5"));
    assert_eq!(
        found.problem,
        "the equations differ: subcase 1 selects MPC = 6 (line 5), subcase 2 selects MPC = 5 (line 7)"
    );
}

#[test]
fn interface_freedoms() {
    let mesh = mesh(&format!(
        "{GRIDS}SPOINT,1001,THRU,1010
ASET,1,123,2,456
ASET1,123456,3,5
BSET1,1,4,THRU,6
ASET1,,1001,THRU,1010
QSET1,,1001,THRU,1010
"
    ));
    assert_eq!(
        mesh.interface,
        [
            support(0, 7),
            support(1, 56),
            support(2, 63),
            support(3, 1),
            support(4, 63),
            support(5, 1),
        ]
    );
    assert_eq!(mesh.boundary.len(), 3 + 3 + 6 + 1 + 6 + 1 + 10);
    assert_eq!(mesh.boundary[..4], [(1, 1), (1, 2), (1, 3), (2, 4)]);
    assert_eq!(mesh.boundary[29], (1010, 0));
    assert_eq!(mesh.supports, []);
    let found = problem(&format!("{GRIDS}ASET1,123,1,99\n"));
    assert!(
        found
            .problem
            .contains("ASET1 card uses grid point 99, which is missing"),
        "{found}"
    );
    let found = problem(&format!("{GRIDS}ASET1,,1\n"));
    assert!(
        found
            .problem
            .contains("states no freedoms for its grid points"),
        "{found}"
    );
}

#[test]
fn sets() {
    let mesh = mesh(&format!(
        "{GRIDS}PSOLID,1,1
PSOLID,2,1
MAT1,1,1.,,.3
CTETRA,101,1,1,2,3,6
CTETRA,102,2,2,3,4,6
CTETRA,103,2,3,4,5,6
SET1,1,5,1,3
SET1,2,2,THRU,99
SET1,3,102,103
SET3,4,ELEM,101,THRU,103,EXCEPT,102
SET3,5,PROP,2
SET3,6,GRID,1,THRU,6,BY,2
SET1,7,1,98
"
    ));
    assert_eq!(set_ids(&mesh, "set:1"), [1, 3, 5]);
    assert_eq!(set_ids(&mesh, "set:2"), [2, 3, 4, 5, 6]);
    assert_eq!(set(&mesh, "set:3").elements(), [1, 2]);
    assert_eq!(set_ids(&mesh, "set:3"), [2, 3, 4, 5, 6]);
    assert_eq!(set(&mesh, "set:4").elements(), [0, 2]);
    assert_eq!(set(&mesh, "set:5").elements(), [1, 2]);
    assert_eq!(set_ids(&mesh, "set:6"), [1, 3, 5]);
    assert_eq!(set_ids(&mesh, "set:7"), [1]);
    assert_eq!(set_ids(&mesh, "pid:1"), [1, 2, 3, 6]);
    assert_eq!(set(&mesh, "pid:2"), set(&mesh, "set:5"));
    assert_eq!(
        unread(&mesh),
        [("SET members that are missing", 1, Carries::Nothing)]
    );
}

/// Cards of other programs and of optimisation, and a static condensation that is not made.
#[test]
fn cards_that_change_nothing_and_one_that_does() {
    let cards = "DEBUG,185,1\nDEQATN,1,F(A,B)=MAX(A,B,1.,2.,3.,4.,5.,6.,7.,8.,9.)\n";
    let read = mesh(&format!("{GRIDS}{cards}"));
    assert_eq!(
        unread(&read),
        [
            ("DEBUG", 1, Carries::Nothing),
            ("DEQATN", 1, Carries::Nothing)
        ]
    );
    let deck = |method: &str, card: &str| {
        mesh(&format!(
            "SOL 103\nCEND\n{method}\nBEGIN BULK\n{GRIDS}{card}\n"
        ))
        .doubts
    };
    for (card, name) in [("ASET1,123,1", "ASET1"), ("OMIT1,456,1", "OMIT1")] {
        assert_eq!(
            deck("METHOD = 1", card),
            [format!(
                "deck.bdf:13: {name} asks for modes of the kept freedoms alone (Guyan's condensation), and the modes here are those of all; their frequencies are lower"
            )]
        );
        assert_eq!(deck("TITLE = interface", card), [""; 0]);
    }
}

/// The nodes of CBEAM are at the shear centre, which is the centroid of some shapes only.
#[test]
fn sections_with_a_shear_centre_of_their_own() {
    for (card, centred) in [
        ("T,,,,,\n,6.,4.,1.,1.", false),
        ("CHAN,,,,,\n,6.,4.,1.,1.", false),
        ("L,,,,,\n,6.,4.,1.,1.", false),
        ("I,,,,,\n,6.,4.,4.,1.,1.,1.", true),
        ("I,,,,,\n,6.,4.,3.,1.,1.,1.", false),
        ("BOX1,,,,,\n,6.,4.,1.,1.,1.,.5", false),
        ("BOX,,,,,\n,6.,4.,1.,.5", true),
        ("Z,,,,,\n,2.,1.,4.,6.", true),
    ] {
        let found = mesh(&format!("{GRIDS}PBEAML,3,8,,{card}\n"));
        let lost = [(
            "PBEAML with its shear centre beside its centroid",
            1,
            Carries::Structure,
        )];
        assert_eq!(
            unread(&found),
            if centred { &lost[..0] } else { &lost[..] },
            "{card}"
        );
    }
}

/// Forces at the shear centre, and the neutral axis beside it (`N1`, `N2` of `PBEAM`): N at (y, z) with the moments
/// of its distance, shear and torque without twist and bending.
#[test]
fn a_neutral_axis_beside_the_shear_centre() {
    let mesh = mesh(
        "GRID,1,,0.,0.,0.
GRID,2,,2.,0.,0.
MAT1,8,2.1+11,,.3,7850.
CBEAM,1,6,1,2,0.,1.,0.
PBEAM,6,8,.01,2.-5,3.-5,,4.-5
,,,,,,,,
,0.,0.
,,,,,.02,-.03
",
    );
    assert_eq!(unread(&mesh), []);
    let (length, y, z) = (2.0, 0.02, -0.03);
    let (young, area, i_z, i_y, torsion) = (2.1e11, 0.01, 2e-5, 3e-5, 4e-5);
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let reduction = Reduction::new(&mesh, &structure, &[support(0, 63)]).unwrap();
    let squared = length * length;
    let stretch = length / (young * area) + (y * y / i_z + z * z / i_y) * length / young;
    let turn = length / (2.1e11 / 2.6 * torsion);
    for (component, expected) in [
        (
            0,
            [
                stretch,
                y * squared / (2.0 * young * i_z),
                z * squared / (2.0 * young * i_y),
                0.0,
                -z * length / (young * i_y),
                y * length / (young * i_z),
            ],
        ),
        (
            1,
            [
                y * squared / (2.0 * young * i_z),
                squared * length / (3.0 * young * i_z),
                0.0,
                0.0,
                0.0,
                squared / (2.0 * young * i_z),
            ],
        ),
        (3, [0.0, 0.0, 0.0, turn, 0.0, 0.0]),
    ] {
        let mut force = vec![0.0; structure.freedoms.size()];
        force[structure.freedoms.freedom(1, component).unwrap()] = 1.0;
        let found = solve(&structure, &reduction, &force);
        for (own, expected) in (0..6).zip(expected) {
            let own = found[structure.freedoms.freedom(1, own).unwrap()];
            assert!(
                (own - expected).abs() < 1e-9 * turn,
                "{component}: {own} {expected}"
            );
        }
    }
    // the mass is at the neutral axis, by both rules
    let mass = 7850.0 * area * length;
    for rules in [Rules::default(), Rules::nastran()] {
        let found = assemble(&mesh, &rules).unwrap().mass.rigid(&mesh);
        for (own, expected) in found.centre().iter().zip([0.5 * length, y, z]) {
            assert!((own - expected).abs() < 1e-12, "{own} {expected}");
        }
        let inertia = 7850.0 * length * (i_y + i_z) + mass * (y * y + z * z);
        assert!(
            agrees(found.inertia[0][0], inertia, 1e-12),
            "{}",
            found.inertia[0][0]
        );
    }
}

/// A channel of ten CBEAM with its nodes beside both the shear centre and the centroid: MSC Nastran's displacements of its
/// end (`models/msc/cantilever_2014.1` of pyNastran, BSD licence, in single precision). Its CW has no effect without SA
/// and SB: the twist is that of a free torsion.
#[test]
fn a_channel_moves_as_in_msc_nastran() {
    let mut deck = String::from(
        "PBEAM*   1               1              1.84375         27.7245\n\
         *       .488696          0.             .00960286\n        \
         5.5     2.43802 -5.5    2.43802 -5.5    .438021 5.5     .438021\n        \
         .728814 .254237                                 10.9761 10.9761\n        \
         \x20                                0.     .754758  0.     .754758\n\
         MAT1,1,2.+6,,.3,7.8-4\n",
    );
    for i in 1..=11 {
        deck += &format!("GRID,{i},,{}.,0.,0.\n", i - 1);
    }
    for i in 1..=10 {
        deck += &format!(
            "CBEAM,{i},1,{i},{},0.,0.,1.,,+\n+,,,0.,.438,0.,0.,.438,0.\n",
            i + 1
        );
    }
    let mesh = mesh(&deck);
    assert_eq!(unread(&mesh), []);
    let structure = assemble(&mesh, &Rules::default()).unwrap();
    let reduction = Reduction::new(&mesh, &structure, &[support(0, 63)]).unwrap();
    let mut force = vec![0.0; structure.freedoms.size()];
    let at = |component: u8| structure.freedoms.freedom(10, component).unwrap();
    force[at(2)] = -1000.0;
    let found = solve(&structure, &reduction, &force);
    for (component, msc) in [(2, -2.7539733e-1), (3, 5.9294838e-1), (4, 9.0172951e-4)] {
        let moved = found[at(component)];
        assert!(agrees(moved, msc, 2e-7), "{component}: {moved} {msc}");
    }
}

/// Fields of `PBEAM` that change nothing, and those that would.
#[test]
fn places_of_added_mass_matter_only_with_it() {
    let lost = |nsm: &str, second: &str, last: &str| {
        let mesh = mesh(&format!(
            "{GRIDS}MAT1,8,2.1+11,,.3\nPBEAM,6,8,.01,2.-5,3.-5,,4.-5,{nsm}\n,,,,,,,,\n{second},,,{last}\n,.1,.2\n"
        ));
        unread(&mesh).len()
    };
    // S1 and S2 of a uniform beam, CW without scalar points, M1 and M2 without mass
    assert_eq!(lost("", "", ".1,.2,,,.3,.4"), 0);
    assert_eq!(lost("2.", "", ""), 1, "M1 and M2 of a mass");
    assert_eq!(lost("", "", ",,.5"), 1, "NSI");
    let taper = ",YES,1.,.02,4.-5,6.-5,,8.-5\n,,,,,,,,\n";
    assert_eq!(lost("", taper, ".1"), 1, "S1 of a taper");
    // the mass of a card NSM has no place
    let added = |place: &str| -> Vec<String> {
        let mesh = mesh(&format!(
            "CEND\nNSM = 3\nBEGIN BULK\n{GRIDS}MAT1,8,2.1+11,,.3\nPBEAM,6,8,.01,2.-5,3.-5,,4.-5\n,,,,,,,,\n,\n,{place}\n\
             CBEAM,1,6,1,2,0.,1.,0.\nNSM,3,PBEAM,6,2.\n"
        ));
        unread(&mesh)
            .iter()
            .map(|(name, ..)| name.to_string())
            .collect()
    };
    assert_eq!(added(".1"), ["added mass of a CBEAM with N1, N2, M1 or M2"]);
    assert!(added("").is_empty());
}

/// A material of E alone has G = 0 and NU = 0: lines stretch and bend without a stiffness in torsion.
#[test]
fn a_material_without_shear() {
    let with = |material: &str| {
        mesh(&format!(
            "{GRIDS}MAT1,8,2.1+11{material}\nCROD,1,5,1,2\nPROD,5,8,.01,.02\nCBAR,2,6,2,3,0.,1.,0.\n\
             PBAR,6,8,.01,2.-5,3.-5,4.-5\nCONROD,3,3,4,8,.01\nCTUBE,4,7,4,5\nPTUBE,7,8,.1\n"
        ))
    };
    let (bare, whole) = (with(",,,7850."), with(",,.3,7850."));
    assert_eq!(unread(&bare), []);
    let sections = |mesh: &Mesh| -> Vec<eng_flexible::mesh::Section> {
        mesh.properties
            .iter()
            .map(|property| property.section)
            .collect()
    };
    let torsion = |section| match section {
        eng_flexible::mesh::Section::Beam(beam) => beam.torsion,
        other => panic!("{other:?}"),
    };
    for (bare, whole) in sections(&bare).into_iter().zip(sections(&whole)) {
        assert_eq!(torsion(bare), 0.0);
        let eng_flexible::mesh::Section::Beam(whole) = whole else {
            panic!("{whole:?}")
        };
        let expected = eng_flexible::mesh::BeamSection {
            torsion: 0.0,
            ..whole
        };
        assert_eq!(bare, eng_flexible::mesh::Section::Beam(expected));
    }
    assert!(
        sections(&whole)
            .into_iter()
            .any(|section| torsion(section) > 0.0)
    );
    let material = &bare.materials[0];
    assert_eq!((material.young, material.density), (2.1e11, 7850.0));
    // solids, shells and beams with shear need G
    let lost = [(
        "MAT1 without G and NU of solids, shells or beams with shear",
        1,
        Carries::Structure,
    )];
    for cards in [
        "CTRIA3,1,7,1,2,6\nPSHELL,7,8,.1,8",
        "GRID,7,,1.,1.,1.\nCTETRA,1,7,1,2,6,7\nPSOLID,7,8",
        "CBAR,1,7,1,2,0.,1.,0.\nPBAR,7,8,.01,2.-5,3.-5,4.-5\n,,,,,,,,\n,.8,.8",
        "CBEAM,1,7,1,2,0.,1.,0.\nPBEAM,7,8,.01,2.-5,3.-5,,4.-5",
        "CBEAM,1,7,1,2,0.,1.,0.\nPBEAM,7,8,.01,2.-5,3.-5,,4.-5\n,,,,,,,,\n,YES,1.,.02,4.-5,6.-5,,8.-5",
    ] {
        let found = mesh(&format!("{GRIDS}MAT1,8,2.1+11\n{cards}\n"));
        assert_eq!(unread(&found), lost, "{cards}");
    }
    let panel = problem(&format!(
        "{GRIDS}GRID,7,,1.,1.,0.\nGRID,8,,2.,1.,0.\nMAT1,8,2.1+11\nCSHEAR,1,7,1,2,8,7\nPSHEAR,7,8,.1\n"
    ));
    assert!(
        panel
            .problem
            .contains("material 8 has no positive shear modulus"),
        "{panel}"
    );
}

/// The mass looked for three freedoms of a scalar point that a spring couples with a grid point, and the reduction stopped
/// in a panic if it was the last one.
#[test]
fn a_spring_may_end_at_the_only_scalar_point() {
    let deck = "GRID,1,,0.,0.,0.,,123456
GRID,2,,2.,0.,0.
CBAR,1,1,1,2,0.,1.,0.
PBAR,1,1,1.-3,2.-6,3.-6,4.-6
MAT1,1,2.+11,,.3
CONM2,5,2,,3.
SPOINT,100
CELAS2,10,4.+4,2,3,100
CMASS2,11,2.,100
";
    let mesh = mesh(deck);
    let full = assemble(&mesh, &Rules::default()).unwrap();
    let mass = full.mass.assembled().unwrap();
    assert_eq!(mass.size(), 13);
    let entry = |column: usize, row: u32| {
        let (rows, values) = mass.column(column);
        let place = rows.iter().position(|own| *own == row);
        place.map_or(0.0, |place| values[place])
    };
    assert_eq!([entry(12, 12), entry(6, 6), entry(8, 12)], [2.0, 3.0, 0.0]);
    assert_eq!(full.mass.rigid(&mesh).mass, 3.0);
}
