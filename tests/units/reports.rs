//! Tables and simple parts of the page of results: turning pins, solids, stresses, thinned surfaces.

use crate::support::program_with_bar;
use eng::internals::report::{at, by_place, outlined, peaks, solid, table, thin, turn};
use eng::internals::run::nearest;
use eng::internals::stored;
use eng::motion::{At, BodyMotion, moments};
use eng::report::MarkerAxes;
use eng::results::Column;
use eng::{Dimension, DisplayUnit, Results};
use eng_report::animation::Part;
use eng_report::page::Cell;

/// A body that turns about z by `angle(time)` (rad).
fn turning(times: &[f64], angle: impl Fn(f64) -> f64) -> Results {
    let mut motion = Results::new("a.motion", "M");
    motion.push(Column::time(times.to_vec())).unwrap();
    let mut push = |name: &str, values: Vec<f64>| {
        motion
            .push(Column {
                path: format!("crank.{name}"),
                dimension: Dimension::ONE,
                display: DisplayUnit::si(Dimension::ONE),
                frame: String::new(),
                values,
            })
            .unwrap();
    };
    let all = |f: &dyn Fn(f64) -> f64| times.iter().map(|t| f(*t)).collect::<Vec<f64>>();
    for axis in ["x", "y", "z"] {
        push(&format!("position.{axis}"), all(&|_| 0.0));
    }
    push("orientation.w", all(&|t| libm::cos(angle(t) / 2.0)));
    push("orientation.x", all(&|_| 0.0));
    push("orientation.y", all(&|_| 0.0));
    push("orientation.z", all(&|t| libm::sin(angle(t) / 2.0)));
    motion
}

const HOME: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

fn marker(body: Option<&str>, orientation: [f64; 9]) -> MarkerAxes {
    MarkerAxes {
        marker: "crank.main".to_owned(),
        body: body.map(str::to_owned),
        orientation,
        place: None,
    }
}

#[test]
fn a_pin_turns_as_its_body_does_over_many_turns() {
    // 10 revolutions a second, ten samples a revolution
    let times: Vec<f64> = (0..=30).map(|i| f64::from(i) * 0.01).collect();
    let motion = turning(&times, |t| 20.0 * std::f64::consts::PI * t);
    let asked: Vec<f64> = (0..=300).map(|i| f64::from(i) * 0.001).collect();
    let (pin, shell) = (marker(Some("crank"), HOME), marker(None, HOME));
    let found = turn(&motion, &pin, &shell, &asked).unwrap().unwrap();
    for (time, angle) in asked.iter().zip(&found) {
        assert!((angle - 3600.0 * time).abs() < 1e-9, "{time}: {angle}");
    }
    // a shell whose x is the ground's y: 90° less
    let turned = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let found = turn(&motion, &pin, &marker(None, turned), &asked)
        .unwrap()
        .unwrap();
    assert!((found[0] + 90.0).abs() < 1e-9);
    // times that the motion does not reach, and bodies that it does not know
    assert_eq!(turn(&motion, &pin, &shell, &[0.31]).unwrap(), None);
    assert!(turn(&motion, &marker(Some("rod"), HOME), &shell, &asked).is_err());
}

#[test]
fn a_solid_has_the_bodys_mass_and_inertia() {
    // a disc of 11 kg: radius 0.15, height 0.02
    let (mass, radius, height) = (11.0, 0.15, 0.02);
    let across = mass * (3.0 * radius * radius + height * height) / 12.0;
    let inertia = [across, across, 0.5 * mass * radius * radius];
    match solid(mass, [0.0, 0.0, 0.01], inertia, &[]).as_slice() {
        [
            Part::Cylinder {
                from,
                to,
                radius: r,
            },
        ] => {
            assert!((r - radius).abs() < 1e-12);
            assert!((from[2]).abs() < 1e-12 && (to[2] - 0.02).abs() < 1e-12);
        }
        other => panic!("{other:?}"),
    }
    let [a, b, c] = [0.1, 0.2, 0.3];
    let box_inertia = [b * b + c * c, a * a + c * c, a * a + b * b].map(|s| s / 12.0);
    match solid(1.0, [0.0; 3], box_inertia, &[]).as_slice() {
        [Part::Box { size, .. }] => {
            assert!(
                size.iter()
                    .zip([a, b, c])
                    .all(|(x, y)| (x - y).abs() < 1e-12)
            );
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn large_discs_are_outlines_of_their_size() {
    let disc = |radius| Part::Cylinder {
        from: [0.0, 0.0, -0.01],
        to: [0.0, 0.0, 0.01],
        radius,
    };
    assert_eq!(outlined(disc(0.05), 0.1), [disc(0.05)]);
    let lines = outlined(disc(0.15), 0.1);
    assert_eq!(lines.len(), 6);
    for line in lines {
        let Part::Line { points } = line else {
            panic!("{line:?}");
        };
        for [x, y, z] in points {
            assert!((libm::hypot(x, y) - 0.15).abs() < 1e-12 && z.abs() == 0.01);
        }
    }
    // a bar that lies askew stays a bar
    let askew = Part::Cylinder {
        from: [0.0; 3],
        to: [1.0, 1.0, 0.0],
        radius: 0.2,
    };
    assert_eq!(outlined(askew.clone(), 0.1), [askew]);
}

/// Bending of a beam: sigma = F (L - z) c/I, in the middle of a bar of 20 x 20 x 200 mm, far from both
/// ends.
#[test]
fn a_bent_bar_has_the_stress_of_a_beam() {
    let text = "
        force Push(a: Marker, b: Marker, x: Force) { apply force x*b.x on a }
        model Held {
            marker wall = [0, 0, 0] mm
            flexible bar {
                mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
                support = foot
                modes = static(at: tip)
                damping = 70 %
                marker foot = patch(center: [0, 0, 0] mm, normal: z, radius: 15 mm, tie: rigid)
                marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
            }
            force load = Push(bar.tip, wall, x: 1000 N)
        }
        analysis push = transient(Held(), duration: 30 ms, sample: 10 ms)";
    let program = program_with_bar(text);
    let analysis = program.analysis("push").unwrap();
    let outcome = analysis.run(&mut |_| {}).unwrap();
    let own = BodyMotion::of(&outcome.motion, "bar").unwrap();
    let (times, _) = moments(&outcome.motion);
    let stored = stored(&analysis.model().reductions()[0]);
    let nodes = stored.surface.nodes();
    // the bar has come to rest at the last sample
    let found = peaks(stored, &nodes, &times[3..], &own.amplitudes[3..]).unwrap();
    assert_eq!(found.len(), nodes.len());
    let mut middle = 0;
    for peak in &found {
        let [x, _, z] = stored.mesh.nodes[peak.node as usize].position;
        if (x.abs() - 0.01).abs() < 1e-9 && (z - 0.1).abs() < 1e-9 {
            let beam = 1000.0 * (0.2 - z) * 0.01 / (0.02f64.powi(4) / 12.0);
            assert!(
                (peak.stress / beam - 1.0).abs() < 0.02,
                "{} {beam}",
                peak.stress
            );
            assert_eq!(peak.time, times[3]);
            middle += 1;
        }
    }
    assert!(middle >= 4, "{middle}");
    let shown = table("Bar", stored, &found, &|_| None);
    let largest = found.iter().map(|p| p.stress).fold(0.0, f64::max);
    assert_eq!(shown.rows[0][1], Cell::number(1e-6 * largest));
    // a place that represents several nodes has their largest stress
    let all_to_one = nodes.iter().map(|n| (*n, 0)).collect();
    let values: Vec<(u32, f64)> = found.iter().map(|p| (p.node, p.stress)).collect();
    assert_eq!(by_place(&values, &all_to_one, 2), [largest, 0.0]);
    // of one moment it is that moment's envelope
    assert_eq!(at(stored, &nodes, &own.amplitudes[3]).unwrap(), values);
}

#[test]
fn moments_are_found_in_any_cycle() {
    let times: Vec<f64> = (0..=360).map(|i| 0.5 + f64::from(i) * 1e-4).collect();
    let angles: Vec<f64> = (0..=360).map(|i| f64::from(i) * 2.0).collect();
    let period = Some(720f64.to_radians());
    let angle = |degrees: f64| At::Angle(f64::to_radians(degrees));
    let index = |at: At| nearest(at, &times, &angles, period);
    assert_eq!(index(angle(372.4)), Some(186));
    assert_eq!(index(angle(372.4 + 1440.0)), Some(186));
    assert_eq!(index(angle(-348.0)), Some(186));
    assert_eq!(index(At::Time(0.51)), Some(100));
    assert_eq!(index(At::Time(0.6)), None);
    assert_eq!(nearest(angle(90.0), &times, &[], period), None);
}

/// A grid of `n` × `n` squares in the plane z = 0.
fn sheet(n: u32) -> Vec<[u32; 3]> {
    let at = |i, j| i * (n + 1) + j;
    (0..n)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

#[test]
fn few_nodes_stay_as_they_are_and_many_are_thinned_to_nodes_of_the_mesh() {
    let triangles = sheet(40);
    let place = |node: u32| [f64::from(node / 41), f64::from(node % 41), 0.0];
    let whole = thin(&triangles, &place, 41 * 41);
    assert_eq!((whole.nodes.len(), whole.triangles.len()), (1681, 3200));
    assert_eq!(whole.triangles, triangles);
    let few = thin(&triangles, &place, 200);
    assert_eq!(few.nodes.len(), 200);
    assert!(few.nodes.iter().all(|n| *n < 1681));
    let known = |n: &u32| (*n as usize) < few.nodes.len();
    assert!(few.triangles.as_flattened().iter().all(known));
    assert_eq!(few.stands_for.len(), 1681);
    // a flat sheet is as large as it was
    let area: f64 = few
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|n| place(few.nodes[n as usize]));
            0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]))
        })
        .sum();
    assert!((area - 1600.0).abs() < 1e-9, "{area}");
}
