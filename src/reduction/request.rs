//! From what a text says of a flexible body to what the finite-element side is asked.

use eng_flexible::fe::Rules;
use eng_flexible::markers::{MarkerRequest, Place, Selection, Spider};
use eng_flexible::reduce::{Interface, Request, Term};
use eng_flexible::solve::Modes;
use eng_system::flexible as text;

/// The request of a source.
///
/// Freedoms count along a marker's axes there and along the mesh's here: a set that is not the mesh's is widened to all
/// directions that it touches.
pub(super) fn request(source: &text::FlexibleSource) -> Request {
    let all = |marker: &u32| Interface {
        marker: *marker as usize,
        components: text::ALL_FREEDOMS,
    };
    Request {
        rules: rules(&source.element_rules),
        markers: source.markers.iter().map(marker).collect(),
        support: source.support.iter().map(all).collect(),
        terms: source.modes.iter().map(|t| term(t, source)).collect(),
        // damping is no part of a reduction: it is put on afterwards
        damping_ratio: 0.0,
        damping_up_to: f64::INFINITY,
    }
}

fn rules(word: &str) -> Rules {
    match word {
        "calculix" => Rules::calculix(),
        "abaqus" => Rules::abaqus(),
        _ => Rules::default(),
    }
}

pub(super) fn marker(source: &text::MarkerSource) -> MarkerRequest {
    let gathered = |nodes| Place::Gathered {
        nodes,
        tie: if source.rigid {
            Spider::Rigid
        } else {
            Spider::Averaging
        },
        center: source.center,
    };
    let place = match &source.place {
        text::MarkerPlace::Node(id) => Place::Node(*id),
        text::MarkerPlace::Set(name) => gathered(Selection::Set(name.clone())),
        text::MarkerPlace::Property(name) => gathered(Selection::Property(name.clone())),
        text::MarkerPlace::Ring {
            center,
            axis,
            radius,
            width,
            tolerance,
        } => gathered(Selection::Ring {
            center: *center,
            axis: *axis,
            radius: *radius,
            width: *width,
            tolerance: *tolerance,
        }),
        text::MarkerPlace::Patch {
            center,
            normal,
            radius,
            tolerance,
        } => gathered(Selection::Patch {
            center: *center,
            normal: *normal,
            radius: *radius,
            tolerance: *tolerance,
        }),
    };
    MarkerRequest {
        name: source.name.clone(),
        place,
    }
}

fn term(term: &text::ModeTerm, source: &text::FlexibleSource) -> Term {
    let at = |interfaces: &[text::Interface]| -> Vec<Interface> {
        interfaces
            .iter()
            .filter_map(|i| {
                let marker = source.markers.get(i.marker as usize)?;
                Some(Interface {
                    marker: i.marker as usize,
                    components: along_mesh(i.freedoms, &marker.axes),
                })
            })
            .filter(|i| i.components != 0)
            .collect()
    };
    match term {
        text::ModeTerm::Static(interfaces) => Term::Static(at(interfaces)),
        text::ModeTerm::Constraint(interfaces) => Term::Constraint(at(interfaces)),
        text::ModeTerm::Normal { count, fixed } => Term::Normal {
            modes: match count {
                text::ModeCount::Number(n) => Modes::Count(*n as usize),
                text::ModeCount::UpTo(frequency) => {
                    Modes::UpTo(angular(*frequency) * angular(*frequency))
                }
            },
            fixed: at(fixed),
        },
        text::ModeTerm::Given { .. } => Term::Static(Vec::new()),
    }
}

/// Angular frequency of a frequency in Hz.
fn angular(frequency: f64) -> f64 {
    2.0 * std::f64::consts::PI * frequency
}

/// Freedoms along a marker's axes as those of the mesh that they have a part in. `axes` is marker → mesh, row-major.
fn along_mesh(freedoms: text::Freedoms, axes: &[f64; 9]) -> u8 {
    let mut components = 0;
    for (kind, shift) in [(freedoms & 0b111, 0), (freedoms >> 3, 3)] {
        for row in 0..3 {
            let touched = (0..3)
                .any(|column| kind & (1 << column) != 0 && axes[3 * row + column].abs() > 1e-9);
            if touched {
                components |= 1 << (row + shift);
            }
        }
    }
    components
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn freedoms_turn_with_the_marker() {
        let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        assert_eq!(along_mesh(0b01_0011, &identity), 0b01_0011);
        // z along the mesh's x, x along its y
        let turned = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        assert_eq!(along_mesh(0b10_0100, &turned), 0b00_1001);
        let s = std::f64::consts::FRAC_1_SQRT_2;
        let skew = [s, -s, 0.0, s, s, 0.0, 0.0, 0.0, 1.0];
        assert_eq!(along_mesh(0b00_0001, &skew), 0b00_0011);
    }
}
