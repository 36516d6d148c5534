//! Freedoms of markers as rows over the free freedoms of a structure.

use super::{Interface, Request};
use crate::error::{FlexibleError, Part};
use crate::fe::{FreedomMap, Reduction};
use crate::mesh::Support;
use crate::modes::Load;

/// Names of a marker's freedoms.
const COMPONENTS: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];

/// Markers on their nodes.
pub(super) struct MarkerFreedoms<'a> {
    pub request: &'a Request,
    /// Node of each marker.
    pub places: &'a [u32],
    pub freedoms: &'a FreedomMap,
}

/// A freedom of a marker.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MarkerFreedom {
    /// `main[2].y`.
    pub label: String,
    pub marker: usize,
    /// Along or about an axis of the marker.
    pub component: u8,
    /// Its parts in the full freedoms, which are along the mesh's axes: freedom, component, factor.
    pub parts: Vec<(usize, u8, f64)>,
}

/// Factors below this are rounding of the axes. Cosines have the rounding 1e-16; a kept factor of rounding
/// would tie a freedom that is free.
const ALONG: f64 = 1e-12;

/// The direction cosines of a marker's axis in the mesh, without rounding if it is an axis of the mesh.
pub(super) fn cosines(axes: &[f64; 9], axis: u8) -> [f64; 3] {
    [0, 1, 2].map(|row| {
        let x = axes
            .get(3 * row + usize::from(axis))
            .copied()
            .unwrap_or(0.0);
        if x.abs() < ALONG {
            0.0
        } else if 1.0 - x.abs() < ALONG {
            x.signum()
        } else {
            x
        }
    })
}

impl MarkerFreedom {
    /// Its row over the free freedoms: freedom and factor, each freedom once.
    fn entries(&self, reduction: &Reduction) -> Vec<(u32, f64)> {
        let mut entries: Vec<(u32, f64)> = Vec::new();
        for (freedom, _, factor) in &self.parts {
            let (rows, factors) = reduction.row(*freedom);
            for (row, x) in rows.iter().zip(factors) {
                match entries.iter_mut().find(|(known, _)| known == row) {
                    Some((_, sum)) => *sum += factor * x,
                    None => entries.push((*row, factor * x)),
                }
            }
        }
        entries
    }
}

impl MarkerFreedoms<'_> {
    /// The freedoms of an interface.
    pub fn freedoms(&self, interface: &Interface) -> Result<Vec<MarkerFreedom>, FlexibleError> {
        let (Some(marker), Some(node)) = (
            self.request.markers.get(interface.marker),
            self.places.get(interface.marker),
        ) else {
            return Err(FlexibleError::Structure {
                problem: format!("there is no marker {}", interface.marker),
                advice: String::new(),
            });
        };
        let wrong = |problem: String, advice: &str| {
            let advice = advice.into();
            FlexibleError::Structure { problem, advice }.of(Part::Marker(interface.marker))
        };
        let mut found = Vec::new();
        for component in (0..6u8).filter(|c| interface.components & (1 << c) != 0) {
            let label = format!("{}.{}", marker.name, COMPONENTS[usize::from(component)]);
            let first = component / 3 * 3;
            let mut parts = Vec::new();
            for (own, factor) in (first..).zip(cosines(&marker.axes, component % 3)) {
                if factor == 0.0 {
                    continue;
                }
                match self.freedoms.freedom(*node, own) {
                    Some(freedom) => parts.push((freedom, own, factor)),
                    None if self.freedoms.of(*node).is_empty() => {
                        return Err(wrong(
                            format!("{label}: no element or matrix row moves this node"),
                            "take a node of the structure",
                        ));
                    }
                    None => {
                        return Err(wrong(
                            format!("{label}: the node of a solid does not turn"),
                            "gather nodes by a ring or a set, tied by a spider: its centre turns",
                        ));
                    }
                }
            }
            found.push(MarkerFreedom {
                label,
                marker: interface.marker,
                component,
                parts,
            });
        }
        Ok(found)
    }

    /// The components of its node that a support holds, along the mesh's axes.
    pub fn support(&self, support: &Interface) -> Result<Support, FlexibleError> {
        let mut components = 0;
        for freedom in self.freedoms(support)? {
            let whole = 0b111 << (freedom.component / 3 * 3);
            match freedom.parts.as_slice() {
                [(_, own, _)] => components |= 1 << own,
                // all three directions together are the same in any axes
                _ if support.components & whole == whole => components |= whole,
                _ => {
                    return Err(FlexibleError::Structure {
                        problem: format!(
                            "{}: a support holds a direction that is no axis of the mesh",
                            freedom.label
                        ),
                        advice:
                            "hold all three directions, or turn the marker to the axes of the mesh"
                                .into(),
                    }
                    .of(Part::Marker(support.marker)));
                }
            }
        }
        Ok(Support {
            node: self.places.get(support.marker).copied().unwrap_or_default(),
            components,
        })
    }

    /// The freedoms of interfaces with their rows; labels begin with `kind`.
    pub fn loads(
        &self,
        kind: &str,
        at: &[Interface],
        reduction: &Reduction,
    ) -> Result<(Vec<MarkerFreedom>, Vec<Load>), FlexibleError> {
        let mut freedoms = Vec::new();
        for interface in at {
            freedoms.extend(self.freedoms(interface)?);
        }
        let loads = freedoms
            .iter()
            .map(|freedom| Load {
                label: format!("{kind}{}", freedom.label),
                entries: freedom.entries(reduction),
            })
            .collect();
        Ok((freedoms, loads))
    }

    /// The freedoms of all markers that can move: marker, component, full freedom.
    pub fn movable(&self, reduction: &Reduction) -> Vec<(usize, u8, usize)> {
        let mut movable = Vec::new();
        for (marker, node) in self.places.iter().enumerate() {
            for component in 0..6 {
                let freedom = self.freedoms.freedom(*node, component);
                if let Some(freedom) = freedom.filter(|f| !reduction.row(*f).0.is_empty()) {
                    movable.push((marker, component, freedom));
                }
            }
        }
        movable
    }
}

/// An error about a row, as an error about the row's marker.
pub(super) fn at_marker(error: FlexibleError, freedoms: &[MarkerFreedom]) -> FlexibleError {
    match error {
        FlexibleError::Row { row, .. } => match freedoms.get(row) {
            Some(freedom) => error.of(Part::Marker(freedom.marker)),
            None => error,
        },
        other => other,
    }
}
