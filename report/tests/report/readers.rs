//! The files in the readers of others: glTF in the Khronos validator, VTK in meshio and in VTK itself.

use super::demo;
use super::tools::{beside, find, find_or, folder, run, skip};
use eng_report::animation::{AnimationError, VtkEncoding, VtkFrame, VtkPart, pvd, vtu};
use serde_json::Value;
use std::process::Command;

#[test]
fn the_glb_is_put_together_as_the_standard_says() {
    let bytes = demo::animation().to_glb().unwrap();
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(&bytes[..4], b"glTF");
    assert_eq!((word(4), word(8)), (2, bytes.len()));
    let length = word(12);
    let document: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let start = 20 + length + 8;
    assert_eq!(start % 4, 0);
    let floats = |accessor: &Value| -> Vec<f32> {
        let accessor = &document["accessors"][accessor.as_u64().unwrap() as usize];
        let view = &document["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let from = start + view["byteOffset"].as_u64().unwrap() as usize;
        let to = from + view["byteLength"].as_u64().unwrap() as usize;
        bytes[from..to]
            .chunks(4)
            .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
            .collect()
    };
    // weights are amplitudes times the scale, shapes are as given
    let animation = &document["animations"][0];
    let channel = animation["channels"]
        .as_array()
        .unwrap()
        .iter()
        .find(|c| c["target"]["path"] == "weights")
        .unwrap();
    let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
    let weights = floats(&sampler["output"]);
    let body = &demo::animation().flexible[0];
    assert_eq!(weights.len(), 73 * 3);
    for (weight, amplitude) in weights.iter().zip(body.amplitudes.iter().flatten()) {
        assert_eq!(*weight, (amplitude * 500.0) as f32);
    }
    let times = floats(&sampler["input"]);
    assert!(
        (times[72] - 2.0 * 0.015 * 200.0).abs() < 1e-5,
        "slowed down 200 times"
    );
    let target = floats(&document["meshes"][0]["primitives"][0]["targets"][2]["POSITION"]);
    for (found, given) in target
        .iter()
        .zip(body.shapes[2].displacements.iter().flatten())
    {
        assert_eq!(*found, *given as f32);
    }
    // a film: its targets are hills of its pressures, the weights at time 9 are halves of those at 6 and 12
    let film = &demo::animation().films.surfaces[0];
    let mesh = document["meshes"].as_array().unwrap().iter();
    let mesh = mesh.clone().find(|mesh| mesh["name"] == "main[1]").unwrap();
    let hill = floats(&mesh["primitives"][0]["targets"][2]["POSITION"]);
    let highest = hill.chunks(3).map(|d| d[0].hypot(d[1])).fold(0.0, f32::max);
    let pressure = film.pressures[2].iter().copied().fold(0.0, f64::max);
    assert!((f64::from(highest) - 0.03 * pressure / 60.0).abs() < 1e-8);
    let node = document["nodes"].as_array().unwrap().iter();
    let node = node
        .clone()
        .position(|node| node["name"] == "main[1]")
        .unwrap();
    let channels = animation["channels"].as_array().unwrap().iter();
    let of_film = |c: &&Value| c["target"]["path"] == "weights" && c["target"]["node"] == node;
    let channel = channels.clone().find(of_film).unwrap();
    let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
    let shares = floats(&sampler["output"]);
    assert_eq!(shares.len(), 73 * 13);
    let at_nine = &shares[9 * 13..10 * 13];
    assert_eq!(at_nine[..3], [0.0, 0.5, 0.5]);
    assert_eq!(at_nine.iter().sum::<f32>(), 1.0);
}

#[test]
fn data_that_do_not_fit_are_refused() {
    let mut animation = demo::animation();
    animation.flexible[0].amplitudes[5].pop();
    assert!(matches!(
        animation.to_glb(),
        Err(AnimationError::Count {
            found: 2,
            expected: 3,
            ..
        })
    ));
    let mut animation = demo::animation();
    animation.flexible[0].surface.triangles[0][0] = 1_000_000;
    assert!(matches!(
        animation.to_glb(),
        Err(AnimationError::Node { .. })
    ));
    let mut animation = demo::animation();
    animation.rigid[0].poses[1].position[0] = 1e300;
    assert!(matches!(
        animation.to_glb(),
        Err(AnimationError::NotFinite { .. })
    ));
    let mut animation = demo::animation();
    animation.times.clear();
    assert!(animation.to_glb().is_err());
}

#[test]
fn the_khronos_validator_finds_nothing() {
    let Some(node) = find(&["node"]) else {
        return skip("Node.js");
    };
    let file = folder("readers").join("animation.glb");
    std::fs::write(&file, demo::animation().to_glb().unwrap()).unwrap();
    let output = run(Command::new(node).arg(beside("validate.cjs")).arg(&file));
    if output.status.code() == Some(77) {
        return skip("gltf-validator (npm)");
    }
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let issues = &found["issues"];
    assert_eq!(issues["numErrors"], 0, "{found:#}");
    assert_eq!(issues["numWarnings"], 0, "{found:#}");
    assert_eq!(found["info"]["hasMorphTargets"], true);
    assert_eq!(found["info"]["animationCount"], 1);
    eprintln!("glTF: {}", issues["messages"]);
}

#[test]
fn meshio_and_vtk_read_the_series() {
    let Some(python) = find_or("ENG_TEST_PYTHON", &["python3", "python"]) else {
        return skip("Python");
    };
    let folder = folder("readers");
    let animation = demo::animation();
    let body = &animation.flexible[0];
    let mesh = body.vtk();
    let mut parts = Vec::new();
    for (frame, encoding) in [(0, VtkEncoding::Ascii), (20, VtkEncoding::Base64)] {
        let displacements = body.displacements(frame);
        let stress: Vec<[f64; 6]> = body
            .surface
            .nodes
            .iter()
            .map(|p| [p[2] * 1e9, 0.0, 0.0, 3e6, 0.0, 0.0])
            .collect();
        let equivalent: Vec<f64> = stress
            .iter()
            .map(|s| (s[0] * s[0] + 3.0 * s[3] * s[3]).sqrt())
            .collect();
        let text = vtu(
            &mesh,
            &VtkFrame {
                time: animation.times[frame],
                pose: body.poses[frame],
                displacements: &displacements,
                stress: &stress,
                von_mises: &equivalent,
                fields: &body.fields,
            },
            encoding,
        )
        .unwrap();
        let file = format!("crank-{frame}.vtu");
        std::fs::write(folder.join(&file), text).unwrap();
        parts.push(VtkPart {
            time: animation.times[frame],
            part: 0,
            file,
        });
    }
    std::fs::write(folder.join("crank.pvd"), pvd(&parts)).unwrap();
    let output = run(Command::new(python).arg(beside("read_vtk.py")).arg(&folder));
    if output.status.code() == Some(77) {
        return skip("meshio or vtk (Python)");
    }
    assert!(output.status.success());
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    eprintln!("{found:#}");
    for reader in found["readers"].as_array().unwrap() {
        for (frame, read) in [0usize, 20]
            .iter()
            .zip(reader["frames"].as_array().unwrap())
        {
            let place = body.poses[*frame];
            assert_eq!(read["points"], 41 * 20);
            assert_eq!(read["cells"], 40 * 20 * 2);
            let close = |name: &str, expected: f64| {
                let value = read[name].as_f64().unwrap();
                assert!(
                    (value - expected).abs() <= 1e-12 * expected.abs().max(1e-6),
                    "{name}"
                );
            };
            // node 7 turned about z by the frame's angle
            let [w, _, _, z] = place.rotation;
            let (cosine, sine) = (w * w - z * z, 2.0 * w * z);
            let node = body.surface.nodes[7];
            close("x7", cosine * node[0] - sine * node[1]);
            let moved = body.displacements(*frame)[7];
            close("u7", cosine * moved[0] - sine * moved[1]);
            let [normal, shear] = [node[2] * 1e9, 3e6];
            close("s7", normal);
            close("t7", shear);
            close("mises7", (normal * normal + 3.0 * shear * shear).sqrt());
        }
    }
}
