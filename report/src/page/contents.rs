//! The tables of every report, from plain data.

use super::table::{Cell, Column, Table};

/// An input of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// `crank.flywheel.mass`.
    pub path: String,
    /// Value in `unit`, or text.
    pub value: Cell,
    /// `kg`.
    pub unit: String,
    /// Its default value; empty without a default.
    pub default: Cell,
    /// Whether the value is the default.
    pub is_default: bool,
    /// Its meaning or its source.
    pub about: String,
}

/// Inputs with their units. Values that the text does not state are marked as defaults.
pub fn inputs_table(caption: &str, inputs: &[Input]) -> Table {
    Table {
        caption: caption.to_owned(),
        columns: ["Input", "Value", "Unit", "Default", "Set by", "Meaning"]
            .map(Column::new)
            .to_vec(),
        rows: inputs
            .iter()
            .map(|input| {
                vec![
                    Cell::Code(input.path.clone()),
                    input.value.clone(),
                    input.unit.as_str().into(),
                    input.default.clone(),
                    if input.is_default { "default" } else { "model" }.into(),
                    input.about.as_str().into(),
                ]
            })
            .collect(),
    }
}

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

/// The first data of a journal that a bearing engineer needs, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Journal {
    /// `A`, the name of its curves.
    pub letter: String,
    /// `main[1]`.
    pub path: String,
    /// Diameter and width (m).
    pub diameter: f64,
    /// Width (m).
    pub width: f64,
    /// Radial clearance (m).
    pub radial_clearance: f64,
    /// Largest force (N) and its crank angle (°).
    pub largest_force: (f64, f64),
    /// Smallest film thickness (m) and its crank angle (°).
    pub smallest_film: (f64, f64),
    /// Largest eccentricity over radial clearance (1).
    pub eccentricity: f64,
    /// Mean friction power (W).
    pub friction: Option<f64>,
}

/// Journals; the specific load is force/(diameter·width) in MPa, the clearance radial.
pub fn journals_table(caption: &str, journals: &[Journal]) -> Table {
    Table {
        caption: caption.to_owned(),
        columns: vec![
            Column::new("Curve"),
            Column::new("Journal"),
            Column::with_unit("Diameter", "mm"),
            Column::with_unit("Width", "mm"),
            Column::with_unit("Radial clearance", "µm"),
            Column::with_unit("Largest force", "kN"),
            Column::with_unit("at", "°CA"),
            Column::with_unit("Specific load", "MPa"),
            Column::with_unit("Smallest film", "µm"),
            Column::with_unit("at", "°CA"),
            Column::with_unit("Largest ε", "1"),
            Column::with_unit("Friction", "W"),
        ],
        rows: journals
            .iter()
            .map(|journal| {
                let (force, force_angle) = journal.largest_force;
                let (film, film_angle) = journal.smallest_film;
                vec![
                    journal.letter.as_str().into(),
                    Cell::Code(journal.path.clone()),
                    (journal.diameter * 1e3).into(),
                    (journal.width * 1e3).into(),
                    Cell::Number {
                        value: journal.radial_clearance * 1e6,
                        digits: 3,
                    },
                    (force * 1e-3).into(),
                    Cell::Fixed {
                        value: force_angle,
                        decimals: 1,
                    },
                    Cell::Number {
                        value: force / (journal.diameter * journal.width) * 1e-6,
                        digits: 3,
                    },
                    Cell::Number {
                        value: film * 1e6,
                        digits: 3,
                    },
                    Cell::Fixed {
                        value: film_angle,
                        decimals: 1,
                    },
                    Cell::Number {
                        value: journal.eccentricity,
                        digits: 3,
                    },
                    journal.friction.map_or(Cell::Empty, Cell::number),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_audit_that_balances() {
        let audit = EnergyAudit {
            work: vec![("gas".to_owned(), 100.0), ("drive".to_owned(), 5.0)],
            losses: vec![("films".to_owned(), 60.0)],
            stored: 44.0,
        };
        assert_eq!(audit.residual(), 1.0);
        assert_eq!(audit.relative_residual(), 0.01);
        let table = audit.table("Energy");
        assert_eq!(table.rows.len(), 6);
        assert_eq!(
            table.rows[2][2],
            Cell::Fixed {
                value: -60.0,
                decimals: 3
            }
        );
    }

    #[test]
    fn specific_load_is_force_over_projected_area() {
        let table = journals_table(
            "Journals",
            &[Journal {
                letter: "A".to_owned(),
                path: "main[1]".to_owned(),
                diameter: 0.05,
                width: 0.02,
                radial_clearance: 25e-6,
                largest_force: (20e3, 15.0),
                smallest_film: (1.2e-6, 30.0),
                eccentricity: 0.952,
                friction: None,
            }],
        );
        assert!(
            matches!(table.rows[0][7], Cell::Number { value, .. } if (value - 20.0).abs() < 1e-12)
        );
        assert_eq!(table.rows[0][11], Cell::Empty);
    }
}
