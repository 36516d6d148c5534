//! What a reduction found, as text.

use super::Reduction;
use eng_flexible::reduce::BodyMass;
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
        let report = &self.stored.report;
        writeln!(
            out,
            "{}: {} nodes, {} elements, {} freedoms → {} modes, {}",
            self.path,
            report.nodes,
            report.elements,
            report.freedoms,
            constants.modes,
            if report.supported {
                "held at its supports"
            } else {
                "free, in mean axes"
            }
        )?;
        for warning in &report.warnings {
            writeln!(out, "  note: {warning}")?;
        }
        let body = &report.body;
        writeln!(out, "  {}", properties(body))?;
        if let Some(estimate) = &report.estimate {
            writeln!(
                out,
                "  from volumes between corners: {}",
                properties(estimate)
            )?;
        }
        for dropped in &report.dropped {
            writeln!(
                out,
                "  left out: {} ({:.1e} of its strain is new)",
                dropped.label, dropped.remains
            )?;
        }
        writeln!(out, "  marker        at x, y, z (mm, axes of the mesh)")?;
        for marker in &self.body.markers {
            let p = marker.position.map(|x| 1e3 * x);
            writeln!(
                out,
                "  {:<12} {:>10.4} {:>10.4} {:>10.4}",
                marker.name, p[0], p[1], p[2]
            )?;
        }
        if report.served.iter().any(|s| s.flexibility.is_some()) {
            writeln!(
                out,
                "  static mode                flexibility there (µm/kN, mrad/kN m)"
            )?;
        }
        for served in &report.served {
            if let Some(flexibility) = served.flexibility {
                let shown = flexibility * if served.component < 3 { 1e9 } else { 1e6 };
                let kept = if served.kept {
                    ""
                } else {
                    "  (spanned by others)"
                };
                writeln!(out, "  {:<26} {shown:>12.5}{kept}", served.mode)?;
            }
        }
        writeln!(
            out,
            "  mode  frequency Hz  damping   effective mass x, y, z (kg)   made of"
        )?;
        let n = constants.modes;
        for (i, mode) in report.modes.iter().enumerate().take(n) {
            let omega = 2.0 * std::f64::consts::PI * mode.frequency;
            let mass = constants.modal_mass[i * n + i];
            let damping = constants.damping[i * n + i];
            let ratio = if omega > 0.0 && mass > 0.0 {
                damping / (2.0 * omega * mass)
            } else {
                0.0
            };
            let effective = mode.effective_mass;
            writeln!(
                out,
                "  {:>4}  {:>12.4}  {:>5.1} %  {:>9.4} {:>9.4} {:>9.4}   {}",
                i + 1,
                mode.frequency,
                1e2 * ratio,
                // rounding of what vanishes is not shown with a sign
                effective[0].abs(),
                effective[1].abs(),
                effective[2].abs(),
                mode.description
            )?;
        }
        Ok(())
    }
}

/// Mass, centre and inertia in a line.
fn properties(body: &BodyMass) -> String {
    let c = body.centre.map(|x| 1e3 * x);
    let j = body.inertia;
    format!(
        "mass {:.6} kg, centre ({:.4}, {:.4}, {:.4}) mm, inertia about it xx {:.6}, yy {:.6}, zz {:.6}, xy {:.6}, yz {:.6}, zx {:.6} kg m²",
        body.mass, c[0], c[1], c[2], j[0][0], j[1][1], j[2][2], j[0][1], j[1][2], j[2][0]
    )
}
