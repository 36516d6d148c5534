//! The results of a reduction as text.

use super::Reduction;
use crate::counted::counted;
use eng_flexible::fe::quality::{LONG, SHARP};
use eng_flexible::fe::{Inventory, Worst};
use eng_flexible::mesh::WeightCheck;
use eng_flexible::reduce::{BodyMass, RecoveredNodes};
use eng_system::significant::{fixed, short, significant};
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
            "{}: {}, {}, {} → {}, {}",
            self.path,
            counted(report.nodes, "node", "nodes"),
            counted(report.elements, "element", "elements"),
            counted(report.freedoms, "freedom", "freedoms"),
            counted(constants.modes, "mode", "modes"),
            if report.supported {
                "held at its supports"
            } else {
                "free, in mean axes"
            }
        )?;
        for warning in &report.warnings {
            writeln!(out, "  note: {warning}")?;
        }
        if let Some(note) = self.own_mass {
            writeln!(out, "  note: {note}")?;
        }
        let size = self.size();
        writeln!(out, "  {}", properties(&report.body, size))?;
        if let Some(estimate) = &report.estimate {
            writeln!(
                out,
                "  from volumes between corners: {}",
                properties(estimate, size)
            )?;
        }
        if let Some(check) = &report.weight_check {
            writeln!(out, "  {}", weight_check(check, &report.body, size))?;
        }
        if let Some(recovered) = &report.recovered {
            writeln!(out, "  {}", recovered_nodes(recovered))?;
        }
        self.write_inventory(out, size)?;
        for dropped in &report.dropped {
            writeln!(
                out,
                "  left out: {} ({} of its strain is new)",
                dropped.label,
                short(dropped.remains, 2)
            )?;
        }
        self.write_markers(out, size)?;
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
                let shown = significant(shown, 6);
                writeln!(out, "  {:<26} {shown:>12}{kept}", served.mode)?;
            }
        }
        if constants.modes > 0 {
            self.write_modes(out)?;
        }
        Ok(())
    }

    /// The contents of the mesh, the worst shapes of its elements, and the forces of rigid motions of a free body, which should
    /// be zero.
    fn write_inventory(&self, out: &mut impl Write, size: f64) -> fmt::Result {
        let report = &self.stored.report;
        let Inventory {
            elements,
            lines,
            springs,
            masses,
            ties,
            poor,
            longest,
            sharpest,
        } = &report.inventory;
        let own = elements
            .iter()
            .map(|(name, count)| format!("{count} × {name}"));
        let others = [
            (*lines, "beam or rod", "beams and rods"),
            (*springs, "spring", "springs"),
            (*masses, "point mass", "point masses"),
            (*ties, "tie", "ties"),
        ];
        let others = others.into_iter().filter(|(count, ..)| *count > 0);
        let others = others.map(|(count, one, many)| counted(count, one, many));
        let parts: Vec<String> = own.chain(others).collect();
        if !parts.is_empty() {
            writeln!(out, "  read: {}", parts.join(", "))?;
        }
        if let (Some(longest), Some(sharpest)) = (longest, sharpest) {
            let unit = Unit::for_size(LENGTHS, size);
            let at = |worst: &Worst| {
                let [x, y, z] = worst.place.map(|x| significant(x / unit.size, 4));
                format!(
                    "element {} at ({x}, {y}, {z}) {}",
                    worst.element, unit.symbol
                )
            };
            writeln!(
                out,
                "  shapes: longest side {} × the shortest ({}), sharpest corner {} of the ideal ({}), {} beyond {LONG} or below {SHARP}",
                short(longest.value, 3),
                at(longest),
                short(sharpest.value, 3),
                at(sharpest),
                counted(*poor, "element", "elements")
            )?;
        }
        if !report.supported {
            writeln!(
                out,
                "  the forces of rigid motions cancel within {} of their parts",
                short(report.rigid_residual, 2)
            )?;
        }
        Ok(())
    }

    /// The approximate size of the body (m): the farthest of its centre and markers from the
    /// frame's origin, and its radius of gyration.
    fn size(&self) -> f64 {
        let body = &self.stored.report.body;
        let spread = (0..3).map(|i| body.inertia[i][i]).fold(0.0, f64::max);
        let places = self.body.markers.iter().map(|marker| marker.position);
        places.chain([body.centre]).flatten().map(f64::abs).fold(
            libm::sqrt(spread / body.mass.max(f64::MIN_POSITIVE)),
            f64::max,
        )
    }

    fn write_markers(&self, out: &mut impl Write, size: f64) -> fmt::Result {
        let unit = Unit::for_size(LENGTHS, size);
        writeln!(
            out,
            "  marker        at x, y, z ({}, axes of the mesh)",
            unit.symbol
        )?;
        // seven digits of the largest
        let decimals = 6 - libm::floor(libm::log10(size.max(f64::MIN_POSITIVE) / unit.size)) as i32;
        let decimals = usize::try_from(decimals.clamp(0, 9)).unwrap_or(0);
        for marker in &self.body.markers {
            let [x, y, z] = marker.position.map(|x| fixed(x / unit.size, decimals));
            writeln!(out, "  {:<12} {x:>12} {y:>12} {z:>12}", marker.name)?;
        }
        Ok(())
    }

    fn write_modes(&self, out: &mut impl Write) -> fmt::Result {
        let constants = &self.body.invariants;
        let unit = Unit::for_size(MASSES, constants.mass);
        writeln!(
            out,
            "  mode  frequency Hz  damping   effective mass x, y, z ({})   made of",
            unit.symbol
        )?;
        let n = constants.modes;
        for (i, mode) in self.stored.report.modes.iter().enumerate().take(n) {
            let omega = 2.0 * std::f64::consts::PI * mode.frequency;
            let mass = constants.modal_mass[i * n + i];
            let damping = constants.damping[i * n + i];
            let ratio = if omega > 0.0 && mass > 0.0 {
                damping / (2.0 * omega * mass)
            } else {
                0.0
            };
            let [x, y, z, ..] = mode.effective_mass.map(|mass| {
                let shown = without_rounding(mass, constants.mass);
                significant(shown / unit.size, 5)
            });
            writeln!(
                out,
                "  {:>4}  {:>12}  {:>5.1} %  {x:>9} {y:>9} {z:>9}   {}",
                i + 1,
                significant(mode.frequency, 7),
                1e2 * ratio,
                mode.description
            )?;
        }
        Ok(())
    }
}

/// A unit to show a quantity in.
#[derive(Clone, Copy)]
pub struct Unit {
    /// Its symbol.
    pub symbol: &'static str,
    /// In SI.
    size: f64,
}

/// Units of a quantity, large ones first, each with the least value that is shown in it.
type Units = [(f64, &'static str, f64)];

/// Units of lengths.
pub const LENGTHS: &Units = &[(20.0, "m", 1.0), (1e-4, "mm", 1e-3), (0.0, "µm", 1e-6)];
/// Units of masses.
pub const MASSES: &Units = &[
    (1e5, "t", 1e3),
    (0.1, "kg", 1.0),
    (1e-4, "g", 1e-3),
    (0.0, "mg", 1e-6),
];
const INERTIAS: &Units = &[
    (0.1, "kg m²", 1.0),
    (1e-7, "kg mm²", 1e-6),
    (0.0, "g mm²", 1e-9),
];

impl Unit {
    /// The unit in which a value of this size (SI) is easy to read.
    pub fn for_size(units: &'static Units, size: f64) -> Unit {
        let fits = units.iter().find(|(least, ..)| size >= *least);
        // NaN has the smallest
        let (_, symbol, size) = fits.or(units.last()).copied().unwrap_or((0.0, "", 1.0));
        Unit { symbol, size }
    }
}

/// Zero for a value that is only rounding beside `whole`.
fn without_rounding(value: f64, whole: f64) -> f64 {
    if value.abs() < 1e-9 * whole.abs() {
        0.0
    } else {
        value
    }
}

/// Mass, centre and inertia in a line. `size` (m) is about the body's.
pub fn properties(body: &BodyMass, size: f64) -> String {
    let mass = Unit::for_size(MASSES, body.mass);
    let length = Unit::for_size(LENGTHS, size);
    let [x, y, z] = body
        .centre
        .map(|c| significant(without_rounding(c, size) / length.size, 6));
    let j = body.inertia;
    let largest = (0..3).map(|i| j[i][i].abs()).fold(0.0, f64::max);
    let inertia = Unit::for_size(INERTIAS, largest);
    let shown = |entry: f64| significant(without_rounding(entry, largest) / inertia.size, 6);
    format!(
        "mass {} {}, centre ({x}, {y}, {z}) {}, inertia about it xx {}, yy {}, zz {}, xy {}, yz {}, zx {} {}",
        significant(body.mass / mass.size, 7),
        mass.symbol,
        length.symbol,
        shown(j[0][0]),
        shown(j[1][1]),
        shown(j[2][2]),
        shown(j[0][1]),
        shown(j[1][2]),
        shown(j[2][0]),
        inertia.symbol
    )
}

/// The number of nodes that a matrix recovers, and how much of a rigid motion of the interface they miss.
fn recovered_nodes(recovered: &RecoveredNodes) -> String {
    let nodes = counted(recovered.nodes, "node", "nodes");
    let title = &recovered.title;
    match recovered.deviation {
        Some(deviation) => format!(
            "{nodes} by {title}; they follow rigid motions of the interface within {}",
            short(deviation, 2)
        ),
        None => format!("{nodes} by {title}"),
    }
}

/// The mass and centre that the file of the mesh states, and their differences from those of the body. `size` (m) is about the body's.
pub fn weight_check(check: &WeightCheck, body: &BodyMass, size: f64) -> String {
    let mass = Unit::for_size(MASSES, check.mass);
    let length = Unit::for_size(LENGTHS, size);
    let (file, line) = &check.place;
    let mut text = format!(
        "weight check in {file}:{line}: mass {} {} (Eng: {:+.4} %)",
        significant(check.mass / mass.size, 7),
        mass.symbol,
        100.0 * (body.mass / check.mass - 1.0)
    );
    if let Some(centre) = check.centre {
        let [x, y, z] = centre.map(|c| significant(without_rounding(c, size) / length.size, 6));
        let square: f64 = centre
            .iter()
            .zip(body.centre)
            .map(|(a, b)| (a - b) * (a - b))
            .sum();
        // writing to a text cannot fail
        let _ = write!(
            text,
            ", centre ({x}, {y}, {z}) {} (Eng: {} {} away)",
            length.symbol,
            short(libm::sqrt(square) / length.size, 2),
            length.symbol
        );
    }
    text
}
