//! The animation of the page of results: bodies that bend, films on their shells.

use crate::support::{program, program_with_bar};
use eng::internals::report::{at_nodes, cylinder, films, round, scene};
use eng::internals::stored;
use eng::motion::{BodyMotion, moments};
use eng::report::{Entry, MarkerAxes, Matter};
use eng_flexible::recover::{Amplitudes, FrameMotion, Recovery};
use eng_report::animation::Surface;
use eng_system::field::FieldGrid;

/// A shell of 20 mm radius, 8 mm wide, of four cells around and two across, on a marker turned by 90° about x
/// and 100 mm from the body's origin.
fn surface() -> (FieldGrid, Surface, Vec<[f64; 3]>) {
    let quarter = std::f64::consts::FRAC_PI_2;
    let grid = FieldGrid {
        radius: 0.02,
        around: (0..=4).map(|i| quarter * (f64::from(i) - 0.5)).collect(),
        across: vec![-4e-3, 0.0, 4e-3],
        openings: Vec::new(),
    };
    let shell = MarkerAxes {
        marker: "block.bore".to_owned(),
        body: None,
        // x stays, y → z, z → −y
        orientation: [1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0],
        place: Some([0.1, 0.0, 0.0]),
    };
    let (surface, outward) = cylinder(&grid, &shell, [0.1, 0.0, 0.0]);
    (grid, surface, outward)
}

#[test]
fn nodes_lie_on_the_shell_and_outward_leads_away_from_its_axis() {
    let (_, surface, outward) = surface();
    let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-15);
    // four nodes across: both edges and two middles; z across is −y of the body
    assert_eq!((surface.nodes.len(), surface.triangles.len()), (16, 24));
    assert!(
        near(surface.nodes[0], [0.12, 4e-3, 0.0]),
        "{:?}",
        surface.nodes[0]
    );
    assert!(near(surface.nodes[1], [0.12, 2e-3, 0.0]));
    assert!(near(surface.nodes[7], [0.1, -4e-3, 0.02]));
    assert!(near(outward[0], [1.0, 0.0, 0.0]) && near(outward[7], [0.0, 0.0, 1.0]));
    // the triangles have the area of the prism inscribed to the cylinder, counterclockwise from outside
    let area: f64 = (surface.triangles.iter())
        .map(|t| {
            let [a, b, c] = t.map(|n| eng_runtime::rotation::V3::from(surface.nodes[n as usize]));
            let normal = (b - a).cross(&(c - a)) / 2.0;
            let out = eng_runtime::rotation::V3::from(outward[t[0] as usize]);
            normal.norm() * normal.dot(&out).signum()
        })
        .sum();
    assert!(
        (area - 4.0 * 0.02 * 2f64.sqrt() * 8e-3).abs() < 1e-12,
        "{area}"
    );
}

#[test]
fn edges_continue_the_last_two_cells() {
    let (grid, surface, outward) = surface();
    let values = at_nodes(&grid, &[3.0, 1.0, 2.0, 2.0, 0.0, 8.0, 0.1, 0.4], 0.0);
    assert_eq!(values.len(), surface.nodes.len());
    assert_eq!(outward.len(), values.len());
    assert_eq!(values[..4], [4.0, 3.0, 1.0, 0.0]);
    assert_eq!(values[4..8], [2.0; 4]);
    // not below zero, and beyond the highest cell above it
    assert_eq!(values[8..12], [0.0, 0.0, 8.0, 12.0]);
}

/// A shell that turns about a pin at rest, on a marker beside the body's origin.
const TURNING: &str = "
    use std.journals.{Film, axial_groove}
    use std.joints.{Fixed, Revolute}
    use std.drives.PrescribedRotation
    model Turning {
        gravity = [0, 0, 0] m/s^2
        marker axis = at([5, 8, 7] mm, z: [0, 1, 0], x: [0, 0, 1])
        body pin {
            mass = 1 kg
            inertia = [1, 1, 1] g*m^2
            marker foot = origin
            marker neck = at([0.012, -0.005, 3] mm, z: [4e-4, -2e-4, 1])
        }
        body shell {
            mass = 1 kg
            inertia = [1, 1, 1] g*m^2
            marker bore = at([20, -30, 40] mm, z: [0, 1, 0], x: [0, 0, 1])
        }
        joint weld = Fixed(pin.foot, axis)
        joint hold = Revolute(shell.bore, axis)
        drive turn = PrescribedRotation(shell.bore, axis, speed: 300 rad/s)
        journal film = Film(pin.neck, shell.bore, diameter: 54 mm, width: 24 mm, radial_clearance: 27 um,
            viscosity: 8 mPa*s, around: 72, across: 13)
    }
    analysis run = transient(Turning(), duration: 5 ms, sample: 0.5 ms)";

/// The pressures of the hills, summed over the surface along the outward directions, are the force of the
/// results: an independent route through places, axes, moments and units.
#[test]
fn hills_carry_the_force_of_the_journal() {
    let program = program(TURNING);
    let analysis = program.analysis("run").unwrap();
    let outcome = analysis.run(&mut |_| {}).unwrap();
    let described = program.describe(&[&outcome.results]).unwrap().remove(0);
    let motion = outcome.motion.clone();
    let entry = Entry::new(outcome.results, Some(motion.clone()), described, Vec::new());
    let (times, _) = moments(&motion);
    let drawn = films(&entry, &motion, 100_000, (&times, &[])).unwrap();
    assert_eq!((drawn.films.surfaces.len(), drawn.shells.len()), (1, 1));
    assert_eq!(
        (drawn.films.unit.as_str(), drawn.shells[0].as_str()),
        ("MPa", "shell")
    );
    assert_eq!(drawn.films.height, 0.5 * 0.027);
    let film = &drawn.films.surfaces[0];
    assert!(film.moments.len() > 5 && film.poses.len() == times.len());
    // trapezia across, equal parts around
    let (columns, rows) = (72, 15);
    let height = |row: usize| film.surface.nodes[row][1];
    let width = |row: usize| {
        let after = height((row + 1).min(rows - 1));
        (after - height(row.max(1) - 1)) / 2.0
    };
    let arc = std::f64::consts::TAU * 0.027 / columns as f64;
    let force = |axis: &str| {
        entry
            .outcome
            .results
            .column(&format!("film.force.{axis}"))
            .unwrap()
    };
    for (moment, pressures) in film.moments.iter().zip(&film.pressures) {
        let mut sum = [0.0; 3];
        for (node, (pressure, outward)) in pressures.iter().zip(&film.outward).enumerate() {
            let area = width(node % rows) * arc;
            for (sum, n) in sum.iter_mut().zip(outward) {
                *sum += 1e6 * pressure * area * n;
            }
        }
        // the shell's x is z of its body, its y is x; the pin feels the reverse
        let found = [-sum[2], -sum[0]];
        let time = times[*moment];
        let recorded = entry.outcome.results.column("time").unwrap();
        let sample = recorded
            .values
            .iter()
            .position(|t| (t - time).abs() < 1e-12)
            .unwrap();
        let due = ["x", "y"].map(|axis| force(axis).values[sample]);
        let size = libm::hypot(due[0], due[1]);
        let off = libm::hypot(found[0] - due[0], found[1] - due[1]);
        assert!(
            size > 100.0 && off < 0.01 * size,
            "{time}: {found:?} {due:?}"
        );
    }
    assert!(
        drawn
            .notes
            .iter()
            .any(|note| note.contains("is 13.5 mm high")),
        "{:?}",
        drawn.notes
    );
}

#[test]
fn scales_are_round_numbers() {
    assert_eq!(
        [999.0, 200.0, 7.0, 0.3].map(round),
        [500.0, 200.0, 5.0, 0.2]
    );
    assert_eq!(round(f64::NAN), 1.0);
}

/// A bar that is thrown and bent: no axis and no mode stands still.
const THROWN: &str = "
    force Push(a: Marker, b: Marker, x: Force) { apply force x*b.x on a }
    model Thrown {
        gravity = [0, -9.81, 0] m/s^2
        marker wall = [0, 0, 0] mm
        flexible bar {
            mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
            modes = static(at: [foot, tip], freedoms: [x, y]) + normal(3)
            damping = 5 %
            marker foot = patch(center: [0, 0, 0] mm, normal: z, radius: 15 mm)
            marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
            start angular_velocity = [40, 90, 30] rad/s
        }
        force load = Push(bar.tip, wall, x: 1000 N)
    }
    analysis throw = transient(Thrown(), duration: 4 ms, sample: 0.5 ms, start: assembled)";

/// The numbers of an accessor of a binary glTF file.
fn numbers(glb: &[u8], document: &serde_json::Value, accessor: &serde_json::Value) -> Vec<f64> {
    let json = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let accessor = &document["accessors"][accessor.as_u64().unwrap() as usize];
    let view = &document["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let from = 28 + json + view["byteOffset"].as_u64().unwrap() as usize;
    let length = view["byteLength"].as_u64().unwrap() as usize;
    glb[from..from + length]
        .chunks_exact(4)
        .map(|bytes| f64::from(f32::from_le_bytes(bytes.try_into().unwrap())))
        .collect()
}

/// At each time a node of the glTF file, moved by targets and weights and placed by its node's track, is
/// where recovery finds it, its displacement multiplied by the scale: x = r + A (s + scale Φ a).
#[test]
fn the_gltf_file_shows_the_motion_that_recovery_finds() {
    let program = program_with_bar(THROWN);
    let analysis = program.analysis("throw").unwrap();
    let outcome = analysis.run(&mut |_| {}).unwrap();
    let described = program.describe(&[&outcome.results]).unwrap().remove(0);
    let Matter::Flexible(reduction) = described.bodies[0].matter.clone() else {
        panic!("the bar is flexible");
    };
    let motion = outcome.motion.clone();
    let entry = Entry::new(outcome.results, Some(motion.clone()), described, Vec::new());
    let made = scene(&entry, &motion, 5_000_000, &[]).unwrap();
    let glb = made.animation.to_glb().unwrap();
    let json = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let document: serde_json::Value = serde_json::from_slice(&glb[20..20 + json]).unwrap();

    // the contents of the file
    let mesh = &document["meshes"][0];
    let primitive = &mesh["primitives"][0];
    let base = numbers(&glb, &document, &primitive["attributes"]["POSITION"]);
    let targets: Vec<Vec<f64>> = primitive["targets"]
        .as_array()
        .unwrap()
        .iter()
        .map(|target| numbers(&glb, &document, &target["POSITION"]))
        .collect();
    let modes: Vec<usize> = mesh["extras"]["targetNames"]
        .as_array()
        .unwrap()
        .iter()
        .map(|name| {
            let name = name.as_str().unwrap().strip_prefix("mode ").unwrap();
            name.split(',').next().unwrap().parse::<usize>().unwrap() - 1
        })
        .collect();
    let track = |path: &str| {
        let channels = document["animations"][0]["channels"].as_array().unwrap();
        let channel = channels
            .iter()
            .find(|c| c["target"]["path"] == path && c["target"]["node"] == 0)
            .unwrap();
        let sampler = channel["sampler"].as_u64().unwrap() as usize;
        let sampler = &document["animations"][0]["samplers"][sampler];
        numbers(&glb, &document, &sampler["output"])
    };
    let (weights, places, turns) = (track("weights"), track("translation"), track("rotation"));
    let scale = document["scenes"][0]["extras"]["deformation_scale"]
        .as_f64()
        .unwrap();
    assert!(scale >= 2.0 && modes.len() >= 5, "{scale} {modes:?}");

    // the results of recovery
    let own = BodyMotion::of(&motion, "bar").unwrap();
    let stored = stored(&reduction);
    let nodes: Vec<u32> = base
        .chunks_exact(3)
        .map(|place| {
            let same = |n: &eng_flexible::mesh::Node| {
                n.position
                    .iter()
                    .zip(place)
                    .all(|(a, b)| f64::from(*a as f32) == *b)
            };
            stored.mesh.nodes.iter().position(same).unwrap() as u32
        })
        .collect();
    let recovery = Recovery::of_stored(stored).unwrap();
    let shapes = recovery.nodes(&nodes).unwrap();
    let still = vec![0.0; recovery.modes()];
    assert_eq!(own.amplitudes.len(), 9);
    let mut largest = 0.0f64;
    for (time, amplitudes) in own.amplitudes.iter().enumerate() {
        let kept: Vec<f64> = amplitudes
            .iter()
            .enumerate()
            .map(|(mode, a)| if modes.contains(&mode) { *a } else { 0.0 })
            .collect();
        let rotation = eng_runtime::rotation::matrix(&own.orientations[time]);
        let frame = FrameMotion {
            position: own.positions[time],
            rotation: [0, 1, 2].map(|i| [0, 1, 2].map(|j| rotation[(i, j)])),
            ..FrameMotion::REST
        };
        let amplitudes = Amplitudes {
            value: &kept,
            rate: &still,
            second: &still,
        };
        let found = shapes.motion(&frame, &amplitudes).unwrap();
        // the quaternion of the file: x, y, z, w
        let q = &turns[4 * time..4 * time + 4];
        let axis = [q[0], q[1], q[2]];
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ]
        };
        for (node, found) in found.iter().enumerate() {
            let local = [0, 1, 2].map(|i| {
                let at = 3 * node + i;
                let weight = |mode: usize| weights[time * targets.len() + mode];
                let moved = (0..targets.len()).map(|mode| weight(mode) * targets[mode][at]);
                base[at] + moved.sum::<f64>()
            });
            // p + 2 w (v × p) + 2 v × (v × p)
            let once = cross(axis, local);
            let twice = cross(axis, once);
            for i in 0..3 {
                let shown = places[3 * time + i] + local[i] + 2.0 * (q[3] * once[i] + twice[i]);
                let moved = found.displacement.inertial[i];
                let due = found.position[i] + (scale - 1.0) * moved;
                largest = largest.max(scale * moved.abs());
                assert!((shown - due).abs() < 2e-7, "{time} {node}: {shown} {due}");
            }
        }
    }
    // displacements that the tolerance would hide show nothing
    assert!(largest > 1e-3, "{largest}");
}
