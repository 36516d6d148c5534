//! Units of finite-element files, which never say theirs.

use crate::mesh::{BeamSection, Mesh, Section, Tie};

/// A consistent set of units of a file: what one of its units is in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshUnits {
    /// Metres of the unit of length.
    pub length: f64,
    /// Kilograms of the unit of mass.
    pub mass: f64,
    /// Seconds of the unit of time.
    pub time: f64,
}

impl MeshUnits {
    /// Names that a model can state, with what they stand for.
    pub const NAMED: &[(&str, MeshUnits)] = &[
        (
            "si",
            MeshUnits {
                length: 1.0,
                mass: 1.0,
                time: 1.0,
            },
        ),
        (
            "m_kg_s",
            MeshUnits {
                length: 1.0,
                mass: 1.0,
                time: 1.0,
            },
        ),
        (
            "mm_tonne_s",
            MeshUnits {
                length: 1e-3,
                mass: 1e3,
                time: 1.0,
            },
        ),
        (
            "mm_kg_s",
            MeshUnits {
                length: 1e-3,
                mass: 1.0,
                time: 1.0,
            },
        ),
        (
            "mm_kg_ms",
            MeshUnits {
                length: 1e-3,
                mass: 1.0,
                time: 1e-3,
            },
        ),
        (
            "cm_kg_s",
            MeshUnits {
                length: 1e-2,
                mass: 1.0,
                time: 1.0,
            },
        ),
        // pound-force, inch, second: the mass unit is lbf s²/in
        (
            "inch_lbf_s",
            MeshUnits {
                length: 0.0254,
                mass: 175.126_835_246_476_37,
                time: 1.0,
            },
        ),
    ];

    /// The units of this name.
    pub fn named(name: &str) -> Option<MeshUnits> {
        Self::NAMED
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, units)| *units)
    }

    /// Newtons of the unit of force.
    pub fn force(&self) -> f64 {
        self.mass * self.length / (self.time * self.time)
    }
}

impl Mesh {
    /// Converts everything to SI. Angles are radians in every system.
    pub fn convert(&mut self, units: &MeshUnits) {
        let (length, mass, force) = (units.length, units.mass, units.force());
        for node in &mut self.nodes {
            node.position = node.position.map(|x| x * length);
        }
        for axes in &mut self.beam_axes {
            axes.offsets = axes.offsets.map(|offset| offset.map(|x| x * length));
        }
        for material in &mut self.materials {
            material.young *= force / (length * length);
            material.density *= mass / (length * length * length);
        }
        for property in &mut self.properties {
            match &mut property.section {
                Section::Solid => {}
                Section::Shell {
                    thickness,
                    mass_per_area,
                } => {
                    *thickness *= length;
                    *mass_per_area *= mass / (length * length);
                }
                Section::Beam(BeamSection {
                    area,
                    moment_z,
                    moment_y,
                    product,
                    torsion,
                    shear: _,
                    mass_per_length,
                }) => {
                    let second = length * length * length * length;
                    *area *= length * length;
                    *moment_z *= second;
                    *moment_y *= second;
                    *product *= second;
                    *torsion *= second;
                    *mass_per_length *= mass / length;
                }
            }
        }
        for point in &mut self.point_masses {
            for (i, row) in point.matrix.iter_mut().enumerate() {
                for (j, value) in row.iter_mut().enumerate() {
                    *value *= mass * freedom_scale(i, length) * freedom_scale(j, length);
                }
            }
        }
        for spring in &mut self.springs {
            // the force that goes with freedom i of the first end, a unit of freedom j of the second
            let second = spring.second.map_or(spring.first.1, |(_, freedom)| freedom);
            let scale = freedom_scale(usize::from(spring.first.1), length)
                * freedom_scale(usize::from(second), length);
            spring.stiffness *= force / length * scale;
        }
        for tie in &mut self.ties {
            if let Tie::Equation { terms, .. } = tie {
                // u [m] = length · u [file]: a translation's coefficient is one a length
                for (_, freedom, coefficient) in terms {
                    if *freedom < 3 {
                        *coefficient /= length;
                    }
                }
            }
        }
    }
}

/// One for a translation, a length for a rotation.
fn freedom_scale(freedom: usize, length: f64) -> f64 {
    if freedom < 3 { 1.0 } else { length }
}
