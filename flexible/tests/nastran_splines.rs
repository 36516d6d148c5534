//! `RSPLINE`: points that follow an elastic tube, against closed forms and against a chain of `CBAR`.

use std::f64::consts::PI;
use std::fmt::Write as _;

use crate::fe_meshes::solve;
use crate::nastran_deck::*;
use eng_flexible::Place;
use eng_flexible::fe::{Reduction, Rules, assemble};
use eng_flexible::mesh::{Mesh, Support, Tie};

/// The coefficient of a freedom in the equation of another one: node and freedom 0…5 of each. Nodes by index.
fn share(mesh: &Mesh, of: (u32, u8), in_: (u32, u8)) -> f64 {
    let terms = mesh.ties.iter().find_map(|tie| match tie {
        Tie::Equation { terms, .. } if (terms[0].0, terms[0].1) == of => Some(terms),
        _ => None,
    });
    let terms = terms.unwrap_or_else(|| panic!("{of:?} depends on nothing"));
    assert_eq!(terms[0].2, 1.0);
    let own = terms
        .iter()
        .filter(|(node, freedom, _)| (*node, *freedom) == in_);
    -own.map(|(_, _, value)| value).sum::<f64>()
}

fn near(found: f64, exact: f64) {
    assert!((found - exact).abs() < 1e-12, "{found} instead of {exact}");
}

/// Between fixed ends a beam without load has Hermite's cubics, a linear stretch and a linear twist.
#[test]
fn a_straight_spline_is_hermites() {
    let (length, at) = (4.0, 1.0);
    // the point between has axes of its own: x = y, y = -x of the basic system
    let mesh = mesh(
        "CORD2R,2,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.
GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.,2
GRID,3,,2.5,0.,0.
GRID,4,,4.,0.,0.
RSPLINE,9,.2,1,2,123456,3,12,4
",
    );
    assert_eq!(unread(&mesh), []);
    assert_eq!(mesh.ties.len(), 8, "six freedoms of 2 and two of 3");
    let s: f64 = at / length;
    let value = [
        1.0 - 3.0 * s * s + 2.0 * s * s * s,
        length * (s - 2.0 * s * s + s * s * s),
        3.0 * s * s - 2.0 * s * s * s,
        length * (s * s * s - s * s),
    ];
    let slope = [
        (6.0 * s * s - 6.0 * s) / length,
        1.0 - 4.0 * s + 3.0 * s * s,
        (6.0 * s - 6.0 * s * s) / length,
        3.0 * s * s - 2.0 * s,
    ];
    // along y of the basic system, the first axis of the point; the slope is the rotation about z
    let y = [(0, 1), (0, 5), (3, 1), (3, 5)];
    for ((freedom, value), slope) in y.iter().zip(value).zip(slope) {
        near(share(&mesh, (1, 0), *freedom), value);
        near(share(&mesh, (1, 5), *freedom), slope);
    }
    // along z, with the rotation about -y
    let z = [(0, 2, 1.0), (0, 4, -1.0), (3, 2, 1.0), (3, 4, -1.0)];
    for ((&(node, freedom, sign), value), slope) in z.iter().zip(value).zip(slope) {
        near(share(&mesh, (1, 2), (node, freedom)), sign * value);
        // the first axis of the point is y: its rotation is minus the slope
        near(share(&mesh, (1, 3), (node, freedom)), -sign * slope);
    }
    // stretch against -x, the second axis of the point; twist alike
    for freedom in [0, 3] {
        near(share(&mesh, (1, 1 + freedom), (0, freedom)), -(1.0 - s));
        near(share(&mesh, (1, 1 + freedom), (3, freedom)), -s);
    }
    // a freedom that the card does not name is free
    assert!(mesh.ties.iter().all(|tie| match tie {
        Tie::Equation { terms, .. } => terms[0].0 == 1 || terms[0].1 < 2,
        _ => false,
    }));
}

/// A tube of two legs of length 1 at a right angle. Out of its plane the corner moves by half of the end, and turns by
/// 3/5 of it. In its plane the stretch of the legs counts, by D/L.
#[test]
fn a_bent_spline_has_the_corner_of_a_frame() {
    for ratio in [0.1, 0.8] {
        let mesh = mesh(&format!(
            "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nRSPLINE,9,{ratio},1,2,123456,3\n"
        ));
        near(share(&mesh, (1, 2), (2, 2)), 0.5);
        near(share(&mesh, (1, 3), (2, 2)), 0.6);
        near(share(&mesh, (1, 4), (2, 2)), -0.6);
        // the end moves by 1 along x without turning: forces X, Y and moment M on it, for E I = 1
        let stretch = (2.0_f64 * ratio).powi(2) / 8.0;
        let (y, m) = {
            let y = 0.125 / (5.0 / 24.0 + stretch);
            (y, 0.75 - 0.25 * y)
        };
        let corner = [stretch, y / 3.0 + (m - 1.0) / 2.0, y / 2.0 + m - 1.0];
        let end = corner[0] - corner[2] + 1.0 / 3.0 - m / 2.0;
        for (freedom, moved) in [0, 1, 5].into_iter().zip(corner) {
            near(share(&mesh, (1, freedom), (2, 0)), moved / end);
        }
    }
}

/// Nine points of a quarter of a circle; those between have a cylindrical system of their own.
fn arc() -> String {
    let mut deck = String::from("CORD2C,5,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n");
    for i in 0..9 {
        let angle = PI / 16.0 * f64::from(i);
        let system = if i % 2 == 1 { "5" } else { "" };
        let (x, y, z) = (
            2.0 * angle.cos(),
            2.0 * angle.sin(),
            0.05 * f64::from(i * i),
        );
        writeln!(
            deck,
            "GRID*,{},,{x:.15},{y:.15},*\n*,{z:.15},{system}",
            i + 1
        )
        .unwrap();
    }
    deck
}

/// A chain of CBAR with the section of the tube, held at one end and loaded at the other, has just the motion of the
/// spline through its ends.
#[test]
fn a_curved_spline_is_a_chain_of_bars() {
    let points = mesh(&arc());
    let total: f64 = (points.nodes.windows(2))
        .map(|pair| {
            let [a, b] = [pair[0].position, pair[1].position];
            (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
        })
        .sum();
    let diameter = 0.15 * total;
    // E = 1, NU = 0, I = 1: G J = E I for J = 2, E A = 8 E I/D²
    let area = 8.0 / (diameter * diameter);
    let mut bars = format!("{}MAT1,1,1.,,0.,1.\n", arc());
    writeln!(bars, "PBAR*,1,1,{area:.15e},1.,*\n*,1.,2.").unwrap();
    for i in 1..9 {
        writeln!(bars, "CBAR,{i},1,{i},{},.3,.2,1.", i + 1).unwrap();
    }
    let bars = mesh(&bars);
    let mut given = arc();
    given += "RSPLINE,9,.15,1,2,123456,3,123456,4\n+,123456,5,123,6,456,7,123,8\n+,1,9\n";
    let given = mesh(&given);
    assert_eq!(given.ties.len(), 3 * 6 + 3 + 3 + 3 + 1);

    let structure = assemble(&bars, &Rules::default()).unwrap();
    let held = [Support {
        node: 0,
        components: 63,
    }];
    let reduction = Reduction::new(&bars, &structure, &held).unwrap();
    let freedom = |node: u32, component: u8| structure.freedoms.freedom(node, component).unwrap();
    for load in 0..6 {
        let mut force = vec![0.0; structure.freedoms.size()];
        force[freedom(8, load)] = 1.0;
        let moved = solve(&structure, &reduction, &force);
        let most = moved
            .iter()
            .fold(0.0_f64, |most, value| most.max(value.abs()));
        for tie in &given.ties {
            let Tie::Equation { terms, .. } = tie else {
                panic!("{tie:?}")
            };
            // terms are in the axes of their nodes, the solution is in basic axes
            let seen = |node: u32, component: u8| -> f64 {
                let first = 3 * (component / 3);
                let frame = given.nodes[node as usize].frame;
                frame.map_or_else(
                    || moved[freedom(node, component)],
                    |frame| {
                        let axis = usize::from(component % 3);
                        let rotation = given.frames[frame as usize].rotation;
                        (0..3_u8)
                            .map(|i| {
                                rotation[usize::from(i)][axis] * moved[freedom(node, first + i)]
                            })
                            .sum()
                    },
                )
            };
            let rest: f64 = (terms.iter())
                .map(|(node, component, factor)| factor * seen(*node, *component))
                .sum();
            assert!(
                rest.abs() < 1e-10 * most,
                "load {load}: {rest} of {most}, {tie:?}"
            );
        }
    }
}

/// An independent point divides the curve: both parts have the diameter of the whole.
#[test]
fn an_independent_point_divides_a_spline() {
    let whole = mesh(
        "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,2.,1.,0.\nGRID,5,,2.,2.,0.\n\
         RSPLINE,9,.1,1,2,123456,3,,4,+\n+,123456,5\n",
    );
    let half =
        mesh("GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nRSPLINE,9,.2,1,2,123456,3\n");
    assert_eq!(whole.ties.len(), 12);
    for freedom in 0..6 {
        for other in 0..6 {
            let expected = share(&half, (1, freedom), (2, other));
            near(share(&whole, (1, freedom), (2, other)), expected);
            near(share(&whole, (3, freedom), (4, other)), expected);
            assert_eq!(share(&whole, (1, freedom), (4, other)), 0.0);
        }
    }
}

#[test]
fn wrong_splines_have_messages() {
    let grids = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,0.,0.\nGRID,4,,2.,0.,0.\n";
    for (card, message) in [
        ("RSPLINE,9,0.,1,2,123,4", "the ratio D/L is 0"),
        ("RSPLINE,9,-.1,1,2,123,4", "the ratio D/L is -0.1"),
        (
            "RSPLINE,9,,1,2,123,4,123",
            "its last grid point 4 depends on the spline",
        ),
        (
            "RSPLINE,9,,1,2,,4",
            "no grid point between its ends has dependent freedoms",
        ),
        (
            "RSPLINE,9,,1",
            "no grid point between its ends has dependent freedoms",
        ),
        (
            "RSPLINE,9,,1,2,127,4",
            "field C2 is \"127\", not freedoms 1 to 6",
        ),
        ("RSPLINE,9,,1,,123,4", "field G2"),
        (
            "RSPLINE,9,,1,2,123,7",
            "RSPLINE 9 uses grid point 7, which is missing",
        ),
        (
            "RSPLINE,9,,1,2,123,3,12,4",
            "grid points 2 and 3 of RSPLINE 9 are at one place",
        ),
        (
            "RSPLINE,9,1.-7,1,2,123,4",
            "the tube of RSPLINE 9 is too thin",
        ),
        (
            "RSPLINE,9,,1,2,123,4\nRBE2,9,1,123,4",
            "rigid element 9 is defined twice",
        ),
    ] {
        let found = problem(&format!("{grids}{card}\n"));
        assert!(matches!(found.place, Place::Line(5 | 6)), "{found}");
        assert!(found.problem.contains(message), "{found}");
        assert!(!found.advice.is_empty());
    }
}
