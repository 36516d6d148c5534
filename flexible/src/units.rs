//! Units of finite-element files.
//!
//! Most files do not state their units.

use crate::mesh::{BeamSection, Mesh, Section, ShellSection, Tie, scalar_index};

pub use eng_system::mesh_files::MeshUnits;

impl Mesh {
    /// Converts everything to SI. Angles are radians in every system.
    pub fn convert(&mut self, units: &MeshUnits) {
        let (length, mass, force) = (units.length, units.mass, units.force());
        if let Some((word, own)) = self.units.take()
            && differ(own, units)
        {
            let [own_length, own_mass, own_time] = own;
            self.doubts.push(format!(
                "the file names the units {word} (of {own_length} m, {own_mass} kg and {own_time} s), and the model {}",
                units.name
            ));
        }
        for node in &mut self.nodes {
            node.position = node.position.map(|x| x * length);
        }
        if let Some(check) = &mut self.weight_check {
            check.mass *= mass;
            check.centre = check.centre.map(|centre| centre.map(|x| x * length));
        }
        for axes in &mut self.beam_axes {
            axes.offsets = axes.offsets.map(|offset| offset.map(|x| x * length));
            axes.centroid = axes.centroid.map(|x| x * length);
        }
        for shape in &mut self.shell_shapes {
            shape.offsets = shape.offsets.map(|x| x * length);
            shape.thickness = shape.thickness.map(|own| own.map(|x| x * length));
        }
        for layer in self.laminates.iter_mut().flatten() {
            layer.thickness *= length;
        }
        for material in &mut self.materials {
            let stress = force / (length * length);
            material.young *= stress;
            if let Some(solid) = &mut material.solid {
                solid.stiffness = solid.stiffness.map(|row| row.map(|x| x * stress));
                solid.axes.origin = solid.axes.origin.map(|x| x * length);
            }
            if let Some(sheet) = &mut material.sheet {
                sheet.plane = sheet.plane.map(|row| row.map(|x| x * stress));
                sheet.across = sheet
                    .across
                    .map(|own| own.map(|row| row.map(|x| x * stress)));
            }
            material.density *= mass / (length * length * length);
        }
        for property in &mut self.properties {
            match &mut property.section {
                Section::Solid => {}
                Section::Shell(ShellSection {
                    thickness,
                    mass_per_area,
                    bending: _,
                    shear: _,
                    layup: _,
                }) => {
                    *thickness *= length;
                    *mass_per_area *= mass / (length * length);
                }
                Section::Beam(section) => convert_section(section, length, mass),
                Section::Tapered(_) => {}
            }
        }
        for station in self.tapers.iter_mut().flatten() {
            convert_section(&mut station.section, length, mass);
        }
        for point in &mut self.point_masses {
            for (i, row) in point.matrix.iter_mut().enumerate() {
                for (j, value) in row.iter_mut().enumerate() {
                    *value *= mass * freedom_scale(i, length) * freedom_scale(j, length);
                }
            }
        }
        // u [m] = length · u [file]; the coefficient of a rotation or of a scalar point, which is a number,
        // is a length
        let springs = self
            .springs
            .iter_mut()
            .map(|spring| (spring, force / length));
        for (spring, unit) in springs.chain(self.inerters.iter_mut().map(|inerter| (inerter, mass)))
        {
            spring.stiffness *= unit;
            for (node, freedom, coefficient) in &mut spring.terms {
                *coefficient *= match scalar_index(*node) {
                    Some(_) => length,
                    None => freedom_scale(usize::from(*freedom), length),
                };
            }
        }
        for tie in &mut self.ties {
            if let Tie::Equation { terms, .. } = tie {
                // u [m] = length · u [file], so the coefficient of a translation has the unit 1/length
                for (node, freedom, coefficient) in terms {
                    if *freedom < 3 && scalar_index(*node).is_none() {
                        *coefficient /= length;
                    }
                }
            }
        }
    }
}

fn convert_section(section: &mut BeamSection, unit: f64, mass: f64) {
    let second = unit * unit * unit * unit;
    section.area *= unit * unit;
    section.moment_z *= second;
    section.moment_y *= second;
    section.product *= second;
    section.torsion *= second;
    section.mass_per_length *= mass / unit;
}

/// Whether a file's own metres, kilograms and seconds are others than those of the model.
pub fn differ([length, mass, time]: [f64; 3], units: &MeshUnits) -> bool {
    let ratios = [length / units.length, mass / units.mass, time / units.time];
    ratios.iter().any(|ratio| (ratio - 1.0).abs() > 1e-3)
}

/// Factor of a freedom: one for a translation, a length for a rotation.
fn freedom_scale(freedom: usize, length: f64) -> f64 {
    if freedom < 3 { 1.0 } else { length }
}
