//! Stored bodies: the numbers that are written are read. Damaged files are errors.

use crate::fe_meshes;
use std::sync::OnceLock;

use eng_flexible::fe::Rules;
use eng_flexible::markers::{MarkerPlace, MarkerRequest, Selection, Spider};
use eng_flexible::mesh::{ElementKind, Set};
use eng_flexible::reduce::{Interface, Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::store::{FORMAT_VERSION, Key, StoreError, StoredBody, content_hash};
use proptest::prelude::*;
use sha2::{Digest, Sha256};

use crate::fe_meshes::bar;

/// A request as text: only equal requests have equal texts.
fn text_of(request: &Request) -> String {
    format!("{request:?}")
}

fn request(spider: Spider) -> Request {
    let marker = |name: &str, tie| MarkerRequest {
        axes: eng_flexible::markers::MESH_AXES,
        name: name.into(),
        place: MarkerPlace::Gathered {
            nodes: Selection::Set(name.into()),
            tie,
            center: None,
        },
    };
    Request {
        rules: Rules::default(),
        markers: vec![marker("root", Spider::Rigid), marker("tip", spider)],
        support: vec![Interface {
            marker: 0,
            components: 0b11_1111,
        }],
        terms: vec![
            Term::Static(vec![Interface {
                marker: 1,
                components: 0b11_1111,
            }]),
            Term::Normal {
                modes: Modes::Count(2),
                fixed: vec![],
            },
        ],
        damping_ratio: 0.02,
        damping_up_to: 3000.0,
        geometric_stiffness: false,
        ..Request::default()
    }
}

fn stored() -> StoredBody {
    let mut mesh = bar(ElementKind::Hexahedron8, [3, 1, 1], [0.3, 0.05, 0.04]);
    for (name, x) in [("root", 0.0), ("tip", 0.3)] {
        let nodes = fe_meshes::nodes_where(&mesh, |p| (p[0] - x).abs() < 1e-9);
        let set = Set::new(nodes, vec![]);
        mesh.sets.insert(name.into(), set);
    }
    let request = request(Spider::Averaging);
    let files = [content_hash(b"a mesh")];
    let key = Key::new(&files, &text_of(&request));
    let reduced = reduce(mesh, &request).unwrap();
    let provenance = vec![("mesh bar.inp".into(), "units m_kg_s".into())];
    StoredBody::new(reduced, request.rules, key, provenance)
}

fn bytes() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| stored().to_bytes().unwrap())
}

/// Bytes with the hash that they should have.
fn signed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 32;
    let hash = Sha256::digest(&bytes[..end]);
    bytes[end..].copy_from_slice(&hash);
    bytes
}

#[test]
fn what_is_written_is_read() {
    let before = stored();
    let after = StoredBody::from_bytes(bytes()).unwrap();
    assert_eq!(before.key, after.key);
    assert_eq!(before.provenance, after.provenance);
    assert_eq!(before.body, after.body);
    assert_eq!(before.rules, after.rules);
    assert_eq!(before.mesh, after.mesh);
    assert_eq!(before.surface, after.surface);
    assert_eq!(before.freedoms, after.freedoms);
    assert_eq!(before.shapes, after.shapes);
    assert_eq!(before.report.sources, after.report.sources);
    assert_eq!(after.report.freedoms, before.report.freedoms);
    assert_eq!(after.to_bytes().unwrap(), bytes());
    assert!(
        after
            .provenance
            .contains(&("mass rule".into(), "Exact".into()))
    );
    assert!(
        after
            .provenance
            .contains(&("format".into(), FORMAT_VERSION.to_string()))
    );
    assert_eq!(after.body.invariants.modes, 8);
}

#[test]
fn another_input_has_another_key() {
    let text = text_of(&request(Spider::Averaging));
    let files = [content_hash(b"one"), content_hash(b"two")];
    let key = Key::new(&files, &text);
    assert_eq!(key, Key::new(&files, &text));
    assert_eq!(key.text().len(), 64);
    let mut changed = request(Spider::Averaging);
    changed.damping_ratio = 0.02_f64.next_up();
    let others = [
        Key::new(&files, &text_of(&request(Spider::Rigid))),
        Key::new(&files, &text_of(&changed)),
        Key::new(&[files[1], files[0]], &text),
        Key::new(&files[..1], &text),
        Key::new(&[content_hash(b"one"), content_hash(b"twO")], &text),
    ];
    for other in others {
        assert_ne!(key, other);
    }
}

#[test]
fn wrong_files_are_told() {
    let good = bytes();
    assert_eq!(
        StoredBody::from_bytes(b"GRID,1,,0.0").unwrap_err(),
        StoreError::NotABody
    );
    assert_eq!(
        StoredBody::from_bytes(&[]).unwrap_err(),
        StoreError::NotABody
    );
    let mut other = good.to_vec();
    other[8] = 99;
    let error = StoredBody::from_bytes(&signed(other)).unwrap_err();
    assert_eq!(error, StoreError::Version { found: 99 });
    assert_eq!(
        error.to_string(),
        format!("the reduced body is of format 99, and this program reads format {FORMAT_VERSION}")
    );
    let mut longer = good.to_vec();
    longer.push(0);
    let expected = good.len() as u64;
    assert_eq!(
        StoredBody::from_bytes(&longer).unwrap_err(),
        StoreError::Length {
            expected,
            found: expected + 1
        }
    );
    let mut altered = good.to_vec();
    altered[good.len() / 2] ^= 1;
    let error = StoredBody::from_bytes(&altered).unwrap_err();
    assert_eq!(error, StoreError::Altered);
    assert!(!error.advice().is_empty());
}

#[test]
fn every_cut_is_told() {
    let good = bytes();
    for length in (0..200).chain((200..good.len()).step_by(997)) {
        let error = StoredBody::from_bytes(&good[..length]).unwrap_err();
        let cut = matches!(error, StoreError::Length { .. });
        assert!(
            cut || length < 8 && error == StoreError::NotABody,
            "{length}: {error}"
        );
    }
}

/// A body whose parts contradict each other becomes no file, because nobody could read it.
#[test]
fn a_body_that_contradicts_itself_is_not_written() {
    let mut wrong = stored();
    wrong.shapes.pop();
    let error = wrong.to_bytes().unwrap_err();
    assert!(matches!(error, StoreError::Contents { .. }), "{error}");
}

/// A count that is larger than the data must not allocate memory for its number.
#[test]
fn claimed_lengths_are_checked_before_room_is_taken() {
    let good = bytes();
    // the first list: the provenance, after head and key
    // as the format writes 2^64 - 1, 2^63 - 1 and 2^42 - 1: seven bits a byte, the last one below 128
    for claim in [
        &[255, 255, 255, 255, 255, 255, 255, 255, 255, 1][..],
        &[255, 255, 255, 255, 255, 255, 255, 255, 127],
        &[255, 255, 255, 255, 255, 127],
    ] {
        let mut wrong = good.to_vec();
        wrong.splice(52..53, claim.iter().copied());
        let length = wrong.len() as u64;
        wrong[12..20].copy_from_slice(&length.to_le_bytes());
        let error = StoredBody::from_bytes(&signed(wrong)).unwrap_err();
        assert!(matches!(error, StoreError::Contents { .. }), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_flipped_bit_is_told(place in any::<prop::sample::Index>(), bit in 0..8u8) {
        let mut wrong = bytes().to_vec();
        let at = place.index(wrong.len());
        wrong[at] ^= 1 << bit;
        prop_assert!(StoredBody::from_bytes(&wrong).is_err());
    }

    /// Altered contents with the right hash give an error or a usable body, never a panic.
    #[test]
    fn altered_contents_with_the_right_hash_do_no_harm(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut wrong = bytes().to_vec();
        for (place, value) in changes {
            let at = 20 + place.index(wrong.len() - 52);
            wrong[at] = value;
        }
        if let Some(cut) = cut {
            wrong.truncate(52 + cut.index(wrong.len() - 52));
            let length = wrong.len() as u64;
            wrong[12..20].copy_from_slice(&length.to_le_bytes());
        }
        if let Ok(body) = StoredBody::from_bytes(&signed(wrong)) {
            let recovery = eng_flexible::recover::Recovery::of_stored(&body).unwrap();
            let a = vec![0.1; recovery.modes()];
            let nodes: Vec<u32> = (0..body.mesh.nodes.len() as u32).collect();
            // a mesh that was altered may be refused, in words
            let _ = recovery.stress_at_nodes(&nodes);
            prop_assert!(recovery.displacements(&a).is_ok());
        }
    }
}
