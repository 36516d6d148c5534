//! Sections of shells with their materials, positions and axes, and the conditions that they must satisfy.

use super::vector::{cross, determinant, norm, subtract};
use crate::mesh::{
    Element, Layer, Layup, Material, Mesh, SheetElasticity, ShellAxis, ShellSection, ShellShape,
};

/// Section, materials and position of a shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sheet<'a> {
    pub section: ShellSection,
    /// The material that stretches.
    pub material: &'a Material,
    /// With [`Layup::Apart`] the material that bends.
    pub bending: Option<&'a Material>,
    /// With [`Layup::Apart`] the material that resists shear across the plate.
    pub shear: Option<&'a Material>,
    /// With [`Layup::Layers`] the layers from the lower surface to the upper.
    pub layers: &'a [Layer],
    /// The materials of the mesh.
    pub materials: &'a [Material],
    pub shape: Option<&'a ShellShape>,
}

impl<'a> Sheet<'a> {
    /// Whether the section has axes: an isotropic one has none.
    pub fn is_directed(&self) -> bool {
        let layers = self.layers.iter();
        let of_layers = layers.filter_map(|layer| self.materials.get(layer.material as usize));
        let mut materials = [Some(self.material), self.bending, self.shear]
            .into_iter()
            .flatten()
            .chain(of_layers);
        materials.any(|material| material.sheet.is_some())
    }

    /// `None` for an index out of range.
    pub fn new(
        mesh: &'a Mesh,
        element: &Element,
        section: ShellSection,
        material: &'a Material,
    ) -> Option<Self> {
        let named = |index: Option<u32>| match index {
            Some(index) => mesh.materials.get(index as usize).map(Some),
            None => Some(None),
        };
        let (bending, shear, layers) = match section.layup {
            Layup::One => (None, None, &[][..]),
            Layup::Apart { bending, shear } => (named(bending)?, named(shear)?, &[][..]),
            Layup::Layers(index) => {
                let layers = mesh.laminates.get(index as usize)?;
                if layers
                    .iter()
                    .any(|layer| named(Some(layer.material)).is_none())
                {
                    return None;
                }
                (None, None, layers.as_slice())
            }
        };
        let shape = match element.shell {
            Some(index) => Some(mesh.shell_shapes.get(index as usize)?),
            None => None,
        };
        Some(Sheet {
            section,
            material,
            bending,
            shear,
            layers,
            materials: &mesh.materials,
            shape,
        })
    }

    /// Mass per area (kg/m²), with the mean of the thicknesses at `corners` nodes.
    pub fn mass(&self, corners: usize) -> f64 {
        let own = self.shape.and_then(|shape| shape.thickness);
        let thickness = own.map_or(self.section.thickness, |own| {
            own.iter().take(corners).sum::<f64>() / corners as f64
        });
        self.density() * thickness + self.section.mass_per_area
    }

    /// Density (kg/m³), the mean of layers.
    fn density(&self) -> f64 {
        let (mut mass, mut thickness) = (0.0, 0.0);
        for layer in self.layers {
            let material = self.materials.get(layer.material as usize);
            mass += material.map_or(0.0, |material| material.density) * layer.thickness;
            thickness += layer.thickness;
        }
        match self.layers {
            [] => self.material.density,
            _ => mass / thickness,
        }
    }
}

/// Both matrices must be symmetric and positive definite.
pub(super) fn sheet_fault(sheet: &SheetElasticity) -> Option<String> {
    let [[a, b, c], [_, d, e], [_, _, f]] = sheet.plane;
    let symmetric = (0..3).all(|i| (0..i).all(|j| sheet.plane[i][j] == sheet.plane[j][i]));
    let stiff = a > 0.0 && a * d - b * b > 0.0 && determinant(&sheet.plane) > 0.0;
    if !(symmetric && stiff && d.is_finite() && f.is_finite() && c.is_finite() && e.is_finite()) {
        return Some(format!(
            "a plane stiffness (Pa) of {a:.4e} {b:.4e} {c:.4e}, {d:.4e} {e:.4e}, {f:.4e}, which is not symmetric and positive definite"
        ));
    }
    let [[a, b], [c, d]] = sheet.across?;
    let stiff = a > 0.0 && b == c && a * d - b * c > 0.0 && a.is_finite() && d.is_finite();
    (!stiff).then(|| {
        format!("a stiffness (Pa) of {a:.4e} {b:.4e}, {d:.4e} for shear across the sheet, which is not symmetric and positive definite")
    })
}

/// Unsound thickness, position or axes of a shell.
pub(super) fn shape_fault(mesh: &Mesh, element: &Element, sheet: &Sheet) -> Option<String> {
    let bad = |layer: &&Layer| !(layer.thickness > 0.0 && layer.thickness.is_finite());
    if let Some(layer) = sheet.layers.iter().find(bad) {
        return Some(format!(
            "a layer of {} m; its thickness must be above zero",
            layer.thickness
        ));
    }
    let shape = sheet.shape?;
    let corners = element.kind.corner_count();
    let own = shape.thickness.iter().flatten().take(corners);
    if let Some(thickness) = own.copied().find(|t| !(*t > 0.0 && t.is_finite())) {
        return Some(format!(
            "a thickness of {thickness} m at a node; it must be above zero"
        ));
    }
    let offsets = &shape.offsets[..corners.min(4)];
    if let Some(offset) = offsets.iter().find(|x| !x.is_finite()) {
        return Some(format!("an offset of {offset} m"));
    }
    if sheet.section.is_membrane() && offsets.iter().any(|x| *x != 0.0) {
        return Some(
            "an offset, but its section has no bending stiffness to take the moment of the offset"
                .into(),
        );
    }
    let ShellAxis::Direction(direction, _) = shape.axis else {
        return None;
    };
    let place = |node: u32| mesh.nodes.get(node as usize).map(|node| node.position);
    let nodes = mesh.nodes_of(element);
    let (&[first, second, third], rest) = nodes.split_first_chunk()?;
    let last = match rest {
        [last, ..] if corners == 4 => *last,
        _ => first,
    };
    let diagonals = [
        subtract(place(third)?, place(first)?),
        subtract(place(last)?, place(second)?),
    ];
    let normal = cross(diagonals[0], diagonals[1]);
    let within = norm(cross(direction, normal));
    // a choice, 0.06°: the projection of a nearer axis on the surface has no certain direction
    let across = within <= 1e-3 * norm(direction) * norm(normal) || within.is_nan();
    (sheet.is_directed() && across)
        .then(|| "a first axis of its material that is normal to its surface".into())
}
