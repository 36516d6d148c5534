//! Files for ParaView.

use eng_report::animation::{
    AnimationError, CellKind, Pose, VtkBody, VtkEncoding, VtkFrame, VtkPart, pvd, vtu,
};

fn one() -> VtkBody {
    VtkBody {
        name: "tet".to_owned(),
        nodes: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        cells: vec![(CellKind::Tetrahedron4, vec![0, 1, 2, 3])],
    }
}

#[test]
fn a_moved_body_with_its_arrays() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let frame = VtkFrame {
        time: 0.25,
        pose: Pose {
            position: [10.0, 0.0, 0.0],
            // a quarter turn about z
            rotation: [half, 0.0, 0.0, half],
        },
        displacements: &[[1.0, 0.0, 0.0]; 4],
        stress: &[[2.0, 0.0, 0.0, 0.0, 0.0, 0.0]; 4],
        von_mises: &[2.0; 4],
        fields: &[],
    };
    let text = vtu(&one(), &frame, VtkEncoding::Ascii).unwrap();
    let numbers = |name: &str| -> Vec<f64> {
        let start = text.find(&format!("Name=\"{name}\"")).unwrap();
        let body = text[start..].split('>').nth(1).unwrap();
        let body = body.split('<').next().unwrap();
        body.split_whitespace()
            .map(|n| n.parse().unwrap())
            .collect()
    };
    assert_eq!(numbers("TimeValue"), [0.25]);
    // (1, 0, 0) turns to (0, 1, 0)
    let second = &numbers("Points")[3..6];
    assert!((second[0] - 10.0).abs() < 1e-15 && (second[1] - 1.0).abs() < 1e-15);
    let moved = &numbers("displacement")[..3];
    assert!(moved[0].abs() < 1e-15 && (moved[1] - 1.0).abs() < 1e-15);
    assert_eq!(numbers("von_mises"), [2.0; 4]);
    assert_eq!(numbers("types"), [10.0]);
}

#[test]
fn faults_are_named() {
    let mut body = one();
    body.cells[0].1[2] = 9;
    let frame = VtkFrame {
        time: 0.0,
        pose: Pose::HOME,
        displacements: &[],
        stress: &[],
        von_mises: &[],
        fields: &[],
    };
    assert_eq!(
        vtu(&body, &frame, VtkEncoding::Base64),
        Err(AnimationError::Node {
            body: "tet".to_owned(),
            node: 9,
            nodes: 4
        })
    );
}

#[test]
fn a_series_lists_its_files() {
    let part = VtkPart {
        time: 0.5,
        part: 1,
        file: "a&b.vtu".to_owned(),
    };
    assert!(pvd(&[part]).contains("timestep=\"0.5\" group=\"\" part=\"1\" file=\"a&amp;b.vtu\""));
}
