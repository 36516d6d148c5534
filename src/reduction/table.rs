//! What a reduction found, as text.

use super::Reduction;
use std::fmt::{self, Write};

impl Reduction {
    /// Path of the body in its model.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Its mass (kg).
    pub fn mass(&self) -> f64 {
        self.body.invariants.mass
    }

    /// Undamped frequency of each mode of the set (Hz).
    pub fn frequencies(&self) -> &[f64] {
        &self.body.frequencies
    }

    /// Mass, centre, inertia, modes: lines for a person.
    pub fn text(&self) -> String {
        let mut text = String::new();
        // writing to a text cannot fail
        let _ = self.write(&mut text);
        text
    }

    fn write(&self, out: &mut impl Write) -> fmt::Result {
        let constants = &self.body.invariants;
        let report = &self.reduced.report;
        writeln!(
            out,
            "{}: {} nodes, {} elements, {} freedoms → {} modes",
            self.path, report.nodes, report.elements, report.freedoms, constants.modes
        )?;
        let mass = constants.mass;
        let center = constants.first_moment.map(|x| 1e3 * x / mass);
        writeln!(
            out,
            "  mass {mass:.6} kg, centre ({:.4}, {:.4}, {:.4}) mm in the mesh's axes",
            center[0], center[1], center[2]
        )?;
        // about the centre of mass: J_C = J_O − m (c·c 1 − c cᵀ)
        let c = constants.first_moment.map(|x| x / mass);
        let square: f64 = c.iter().map(|x| x * x).sum();
        let about = |i: usize, j: usize| {
            let shift = if i == j {
                square - c[i] * c[j]
            } else {
                -c[i] * c[j]
            };
            constants.inertia[i][j] - mass * shift
        };
        writeln!(
            out,
            "  inertia about it xx {:.6}, yy {:.6}, zz {:.6}, xy {:.6}, yz {:.6}, zx {:.6} kg m²",
            about(0, 0),
            about(1, 1),
            about(2, 2),
            about(0, 1),
            about(1, 2),
            about(2, 0)
        )?;
        writeln!(out, "  spanned by: {}", report.sources.join(", "))?;
        for dropped in &report.dropped {
            writeln!(
                out,
                "  left out: {} ({:.1e} of its strain is new)",
                dropped.label, dropped.remains
            )?;
        }
        for marker in &self.body.markers {
            let p = marker.position.map(|x| 1e3 * x);
            writeln!(
                out,
                "  marker {} at ({:.4}, {:.4}, {:.4}) mm",
                marker.name, p[0], p[1], p[2]
            )?;
        }
        writeln!(out, "  mode  frequency Hz  damping ratio")?;
        let n = constants.modes;
        for (i, frequency) in self.body.frequencies.iter().enumerate() {
            let omega = 2.0 * std::f64::consts::PI * frequency;
            let mass = constants.modal_mass[i * n + i];
            let damping = constants.damping[i * n + i];
            let ratio = if omega > 0.0 && mass > 0.0 {
                damping / (2.0 * omega * mass)
            } else {
                0.0
            };
            writeln!(out, "  {:>4}  {frequency:>12.4}  {ratio:>13.4}", i + 1)?;
        }
        Ok(())
    }
}
