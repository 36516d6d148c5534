//! The tables of every report, from plain data.

use super::table::{Cell, Column, Table};

/// A mode of a flexible body, or of the system.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Its number, from 1.
    pub number: usize,
    /// `static`, `normal`, `system`.
    pub kind: String,
    /// Natural frequency (Hz); `None` for a static mode without one.
    pub frequency: Option<f64>,
    /// Damping ratio (1).
    pub damping: Option<f64>,
    /// Generalised mass, in the unit of the caption.
    pub mass: Option<f64>,
    /// Its shape: `block bends in the xz plane`.
    pub about: String,
}

/// Modes with their frequencies.
pub fn modes_table(caption: &str, modes: &[Mode]) -> Table {
    let optional = |value: Option<f64>| value.map_or(Cell::Empty, Cell::number);
    Table {
        caption: caption.to_owned(),
        columns: vec![
            Column::new("Mode"),
            Column::new("Kind"),
            Column::with_unit("Natural frequency", "Hz"),
            Column::with_unit("Damping ratio", "%"),
            Column::new("Modal mass"),
            Column::new("Shape"),
        ],
        rows: modes
            .iter()
            .map(|mode| {
                vec![
                    mode.number.to_string().into(),
                    mode.kind.as_str().into(),
                    optional(mode.frequency),
                    optional(mode.damping.map(|d| 100.0 * d)),
                    optional(mode.mass),
                    mode.about.as_str().into(),
                ]
            })
            .collect(),
    }
}

/// The flow of energy in the audited time (J). Positive work raises the machine's energy.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyAudit {
    /// Work done on the machine, by name.
    pub work: Vec<(String, f64)>,
    /// Losses, by name, as positive numbers.
    pub losses: Vec<(String, f64)>,
    /// Energy stored in the machine at the end less that at the start.
    pub stored: f64,
}

impl EnergyAudit {
    /// Work minus losses minus the stored energy (J): 0 for an exact solution.
    pub fn residual(&self) -> f64 {
        let sum = |parts: &[(String, f64)]| parts.iter().map(|(_, v)| v).sum::<f64>();
        sum(&self.work) - sum(&self.losses) - self.stored
    }

    /// The residual over the largest of all parts; 0 if all are 0.
    pub fn relative_residual(&self) -> f64 {
        let largest = self.largest();
        if largest > 0.0 {
            self.residual() / largest
        } else {
            0.0
        }
    }

    fn largest(&self) -> f64 {
        self.work
            .iter()
            .chain(&self.losses)
            .map(|(_, v)| v.abs())
            .fold(self.stored.abs(), f64::max)
    }

    /// The audit with its residual.
    pub fn table(&self, caption: &str) -> Table {
        // six digits of the largest part, the same decimals for all
        let largest = self.largest();
        let decimals = if largest > 0.0 && largest.is_finite() {
            (5.0 - libm::log10(largest).floor()).clamp(0.0, 17.0) as usize
        } else {
            0
        };
        let row = |name: &str, kind: &str, value: f64| {
            vec![name.into(), kind.into(), Cell::Fixed { value, decimals }]
        };
        let mut rows: Vec<Vec<Cell>> = Vec::new();
        rows.extend(self.work.iter().map(|(n, v)| row(n, "work", *v)));
        rows.extend(self.losses.iter().map(|(n, v)| row(n, "loss", -v)));
        rows.push(row("stored", "end less start", -self.stored));
        rows.push(row("residual", "sum of the above", self.residual()));
        rows.push(vec![
            "residual over the largest part".into(),
            "".into(),
            Cell::Number {
                value: self.relative_residual(),
                digits: 2,
            },
        ]);
        Table {
            caption: caption.to_owned(),
            columns: vec![
                Column::new("Part"),
                Column::new("Kind"),
                Column::with_unit("Energy", "J"),
            ],
            rows,
        }
    }
}

/// The origin of the results.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// The command line.
    pub command: String,
    /// Names and versions of the programs.
    pub versions: Vec<(String, String)>,
    /// Files read or written, with their hashes (`sha256:…`).
    pub hashes: Vec<(String, String)>,
    /// Anything else: seeds, tolerances, host.
    pub notes: Vec<(String, String)>,
}

impl Provenance {
    /// Everything in one table.
    pub fn table(&self, caption: &str) -> Table {
        let mut rows = vec![vec!["command".into(), Cell::Code(self.command.clone())]];
        let code = |(name, value): &(String, String)| {
            vec![Cell::Text(name.clone()), Cell::Code(value.clone())]
        };
        rows.extend(self.versions.iter().map(code));
        rows.extend(self.hashes.iter().map(code));
        rows.extend(
            self.notes
                .iter()
                .map(|(name, value)| vec![name.as_str().into(), value.as_str().into()]),
        );
        Table {
            caption: caption.to_owned(),
            columns: vec![Column::new("What"), Column::new("Value")],
            rows,
        }
    }
}
