//! Freedoms of markers as rows over the free freedoms of a structure.

use super::{Interface, Request};
use crate::error::FlexibleError;
use crate::fe::{FreedomMap, Reduction};
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
    pub component: u8,
    /// The full freedom.
    pub freedom: usize,
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
        let mut found = Vec::new();
        for component in (0..6u8).filter(|c| interface.components & (1 << c) != 0) {
            let label = format!("{}.{}", marker.name, COMPONENTS[usize::from(component)]);
            match self.freedoms.freedom(*node, component) {
                Some(freedom) => found.push(MarkerFreedom {
                    label,
                    marker: interface.marker,
                    component,
                    freedom,
                }),
                None if self.freedoms.of(*node).is_empty() => {
                    return Err(FlexibleError::Structure {
                        problem: format!("{label}: no element or matrix row moves this node"),
                        advice: "take a node of the structure".into(),
                    });
                }
                None => {
                    return Err(FlexibleError::Structure {
                        problem: format!("{label}: the node of a solid does not turn"),
                        advice:
                            "gather nodes by a ring or a set, tied by a spider: its centre turns"
                                .into(),
                    });
                }
            }
        }
        Ok(found)
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
            .map(|freedom| {
                let (rows, factors) = reduction.row(freedom.freedom);
                Load {
                    label: format!("{kind}{}", freedom.label),
                    entries: rows.iter().copied().zip(factors.iter().copied()).collect(),
                }
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
