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
pub struct Peak {
    /// Index of the node.
    pub node: u32,
    /// Largest von Mises stress (Pa).
    pub stress: f64,
    /// Time at which it was first reached (s).
    pub time: f64,
}

/// Peaks at nodes of solids among `nodes`, in their order. `amplitudes` are those at `times` (s).
pub fn peaks(
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
pub fn at(
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
pub fn table(
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
pub fn by_place(values: &[(u32, f64)], stands_for: &BTreeMap<u32, u32>, count: usize) -> Vec<f64> {
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
