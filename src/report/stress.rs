//! Von Mises stress of flexible bodies over the times of a motion: its largest value at each node, and the
//! places of its maxima.

use super::ReportError;
use eng_flexible::recover::{Envelope, Recovery};
use eng_flexible::store::StoredBody;
use eng_report::page::{Cell, Column, Table};
use std::collections::BTreeMap;

/// Rows of a table of maxima. A choice.
const MAXIMA: usize = 8;
/// Distance of two maxima, as a share of the body's size. A choice: nearer ones belong to one notch.
const APART: f64 = 0.05;

/// The largest von Mises stress at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Peak {
    /// Index of the node.
    pub node: u32,
    /// Largest von Mises stress (Pa).
    pub stress: f64,
    /// Time at which it was first reached (s).
    pub time: f64,
}

/// Peaks at nodes of solids among `nodes`, in their order. `amplitudes` are those at `times` (s).
pub(super) fn peaks(
    stored: &StoredBody,
    nodes: &[u32],
    times: &[f64],
    amplitudes: &[Vec<f64>],
) -> Result<Vec<Peak>, ReportError> {
    let recovery = Recovery::of_stored(stored)?;
    let modal = recovery.stress_at_nodes(nodes)?;
    let mut envelope = Envelope::new(modal.nodes().len());
    let mut stresses = Vec::new();
    for (time, amplitudes) in times.iter().zip(amplitudes) {
        modal.stress(amplitudes, &mut stresses)?;
        envelope.update(*time, &stresses)?;
    }
    let peaks = modal.nodes().iter().zip(envelope.peaks());
    Ok(peaks
        .map(|(&node, (stress, time))| Peak { node, stress, time })
        .collect())
}

/// Von Mises stresses (Pa) at nodes of solids among `nodes`, for one set of amplitudes.
pub(super) fn at(
    stored: &StoredBody,
    nodes: &[u32],
    amplitudes: &[f64],
) -> Result<Vec<(u32, f64)>, ReportError> {
    let once = [amplitudes.to_vec()];
    let found = peaks(stored, nodes, &[0.0], &once)?;
    Ok(found.into_iter().map(|p| (p.node, p.stress)).collect())
}

/// The largest peaks that lie apart from each other, the largest first. `angle` gives the crank angle (°) of
/// a time.
pub(super) fn table(
    caption: &str,
    stored: &StoredBody,
    peaks: &[Peak],
    angle: &dyn Fn(f64) -> Option<f64>,
) -> Table {
    let place = |node: u32| {
        let node = stored.mesh.nodes.get(node as usize);
        node.map_or((0, [f64::NAN; 3]), |n| (n.id, n.position))
    };
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for node in &stored.mesh.nodes {
        for axis in 0..3 {
            low[axis] = low[axis].min(node.position[axis]);
            high[axis] = high[axis].max(node.position[axis]);
        }
    }
    let between = |a: [f64; 3], b: [f64; 3]| {
        (0..3)
            .map(|i| (a[i] - b[i]) * (a[i] - b[i]))
            .sum::<f64>()
            .sqrt()
    };
    let apart = APART * between(low, high);
    let mut sorted = peaks.to_vec();
    sorted.sort_by(|a, b| b.stress.total_cmp(&a.stress).then(a.node.cmp(&b.node)));
    let mut shown: Vec<Peak> = Vec::new();
    for peak in sorted {
        let (_, at) = place(peak.node);
        if shown.iter().all(|s| between(place(s.node).1, at) >= apart) {
            shown.push(peak);
        }
        if shown.len() == MAXIMA {
            break;
        }
    }
    Table {
        caption: caption.to_owned(),
        columns: vec![
            Column::new("Node"),
            Column::with_unit("von Mises", "MPa"),
            Column::with_unit("at", "°CA"),
            Column::with_unit("at", "ms"),
            Column::with_unit("x", "mm"),
            Column::with_unit("y", "mm"),
            Column::with_unit("z", "mm"),
        ],
        rows: shown
            .iter()
            .map(|peak| {
                let (id, at) = place(peak.node);
                let mut row = vec![
                    Cell::Text(id.to_string()),
                    Cell::number(1e-6 * peak.stress),
                    angle(peak.time).map_or(Cell::Empty, Cell::number),
                    Cell::number(1e3 * peak.time),
                ];
                row.extend(at.map(|x| Cell::Fixed {
                    value: 1e3 * x,
                    decimals: 1,
                }));
                row
            })
            .collect(),
    }
}

/// For each of `count` places that represent nodes, the largest stress of these nodes (Pa); zero without a
/// stress.
pub(super) fn by_place(
    values: &[(u32, f64)],
    stands_for: &BTreeMap<u32, u32>,
    count: usize,
) -> Vec<f64> {
    let mut largest = vec![0.0; count];
    for (node, stress) in values {
        let place = stands_for.get(node);
        if let Some(most) = place.and_then(|at| largest.get_mut(*at as usize))
            && stress > most
        {
            *most = *stress;
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Sources;
    use crate::motion::{At, BodyMotion, moments};

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
        let deck = include_str!("../../tests/mesh/bar.bdf");
        let sources = Sources::from_texts([
            ("bar.eng".to_owned(), text.to_owned()),
            ("bar.bdf".to_owned(), deck.to_owned()),
        ]);
        let program = crate::check(&sources, "bar.eng").into_program().unwrap();
        let analysis = program.analysis("push").unwrap();
        let outcome = analysis.run(&mut |_| {}).unwrap();
        let own = BodyMotion::of(&outcome.motion, "bar").unwrap();
        let (times, _) = moments(&outcome.motion);
        let stored = &analysis.model().reductions()[0].stored;
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
        let index = |at: At| at.nearest(&times, &angles, period);
        assert_eq!(index(angle(372.4)), Some(186));
        assert_eq!(index(angle(372.4 + 1440.0)), Some(186));
        assert_eq!(index(angle(-348.0)), Some(186));
        assert_eq!(index(At::Time(0.51)), Some(100));
        assert_eq!(index(At::Time(0.6)), None);
        assert_eq!(angle(90.0).nearest(&times, &[], period), None);
    }
}
