//! Reduced bodies as files for other codes.
//!
//! Numbers are in SI and in the axes of the body. The theory page states the coordinates and the equations.

use super::Reduction;
use crate::results::file_stem;
use eng_flexible::FlexibleError;
use eng_flexible::recover::Recovery;
use eng_flexible::small_motion::{Dense, RIGID, SmallMotion};
use eng_flexible::write::{
    NumberedBody, abaqus_deck, abaqus_matrix, array, bulk_data, modal_data, op4,
};
use serde_json::json;

/// The largest number of a point in Nastran, which has eight columns for it.
const LARGEST_POINT: usize = 99_999_999;

/// The form of the files of a reduced body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyFormat {
    /// Arrays of NumPy: matrices, constants of the floating frame, shapes at all nodes.
    Numpy,
    /// Matrices in OP4 as text.
    Op4,
    /// Bulk data of Nastran with DMIG.
    Dmig,
    /// Matrices and a deck of Abaqus.
    Abaqus,
    /// The data of MBDyn's modal joint.
    Mbdyn,
}

impl BodyFormat {
    /// Whether bodies have numbered points in it.
    pub fn has_points(self) -> bool {
        matches!(self, BodyFormat::Dmig | BodyFormat::Abaqus)
    }
}

/// A file of a reduced body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyFile {
    /// Its name, without a folder.
    pub name: String,
    /// Its contents.
    pub contents: Vec<u8>,
}

/// The reason why a body has no files.
#[derive(Debug, thiserror::Error)]
pub enum HandOverError {
    /// Shapes and mesh of the stored body do not fit together.
    #[error(transparent)]
    Shapes(#[from] FlexibleError),
    /// A number of a point is zero or has more than eight digits.
    #[error(
        "the points of {body} have the numbers {first} to {last}; Nastran and Abaqus take 1 to {LARGEST_POINT}"
    )]
    Points {
        /// Path of the body.
        body: String,
        /// The first number.
        first: usize,
        /// The last one.
        last: usize,
    },
}

impl Reduction {
    /// The files of the body in a format. Points of Nastran and Abaqus begin with the number `first`.
    ///
    /// # Errors
    /// Numbers of points that Nastran cannot read; a stored body whose parts do not fit together.
    pub fn files(&self, format: BodyFormat, first: usize) -> Result<Vec<BodyFile>, HandOverError> {
        let stem = file_stem(&self.path);
        let motion = SmallMotion::new(&self.body);
        let markers = self.body.markers.iter();
        let markers = markers.map(|marker| (marker.name.clone(), marker.position));
        let markers = markers.collect::<Vec<_>>();
        let last = first.saturating_add(self.points(format)).saturating_sub(1);
        if format.has_points() && (first == 0 || last > LARGEST_POINT) {
            let body = self.path.clone();
            return Err(HandOverError::Points { body, first, last });
        }
        let mut files = vec![self.description(&stem, &motion)];
        let text = |name: String, contents: String| BodyFile {
            name,
            contents: contents.into_bytes(),
        };
        match format {
            BodyFormat::Numpy => files.extend(self.arrays(&stem, &motion)?),
            BodyFormat::Op4 => {
                let matrices = [
                    ("KENG", &motion.stiffness, true),
                    ("MENG", &motion.mass, true),
                    ("BENG", &motion.damping, true),
                    ("LENG", &motion.motion, false),
                ];
                files.push(text(format!("{stem}.op4"), op4(&matrices)));
            }
            BodyFormat::Dmig => {
                let body = NumberedBody {
                    name: &self.path,
                    markers: &markers,
                    motion: &motion,
                    first,
                };
                files.push(text(format!("{stem}.bdf"), bulk_data(&body)));
            }
            BodyFormat::Mbdyn => {
                let data = modal_data(&self.path, &markers, &self.body.invariants, &motion);
                files.push(text(format!("{stem}.fem"), data));
            }
            BodyFormat::Abaqus => {
                let name = legal_name(&stem);
                let body = NumberedBody {
                    name: &name,
                    markers: &markers,
                    motion: &motion,
                    first,
                };
                let names =
                    ["stiffness", "mass", "damping"].map(|kind| format!("{stem}.{kind}.mtx"));
                let [stiffness, mass, damping] = &names;
                files.push(text(
                    format!("{stem}.inp"),
                    abaqus_deck(&body, [stiffness, mass, damping]),
                ));
                let matrices = [&motion.stiffness, &motion.mass, &motion.damping];
                for (name, matrix) in names.into_iter().zip(matrices) {
                    files.push(text(name, abaqus_matrix(&body, matrix)));
                }
            }
        }
        Ok(files)
    }

    /// Number of the points of the body in a format.
    pub fn points(&self, format: BodyFormat) -> usize {
        let coordinates = RIGID + self.body.invariants.modes;
        let carriers = match format {
            BodyFormat::Numpy | BodyFormat::Op4 | BodyFormat::Mbdyn => return 0,
            BodyFormat::Dmig => coordinates,
            // a node carries six
            BodyFormat::Abaqus => coordinates.div_ceil(6),
        };
        self.body.markers.len() + carriers
    }

    /// Parts of the body that linear matrices leave out.
    pub fn left_out(&self) -> Vec<&'static str> {
        let geometric = self.body.invariants.geometric.is_some();
        let surfaces = !self.body.surfaces.is_empty();
        let parts = [
            (geometric, "geometric stiffness"),
            (surfaces, "elastic surfaces of its markers"),
        ];
        let left_out = parts.into_iter().filter(|(is, _)| *is);
        left_out.map(|(_, part)| part).collect()
    }

    /// Names of coordinates and markers, for people and programs.
    fn description(&self, stem: &str, motion: &SmallMotion) -> BodyFile {
        let frame = ["x", "y", "z", "rotation x", "rotation y", "rotation z"];
        let modes = 1..=motion.mass.rows().saturating_sub(RIGID);
        let coordinates = frame.into_iter().map(str::to_owned);
        let coordinates = coordinates.chain(modes.map(|mode| format!("mode {mode}")));
        let markers = self.body.markers.iter();
        let markers =
            markers.map(|marker| json!({"name": marker.name, "position": marker.position}));
        let description = json!({
            "body": self.path,
            "written_by": format!("eng {}", env!("CARGO_PKG_VERSION")),
            "units": "SI: m, kg, s, N, rad",
            "axes": "of the body",
            "coordinates": coordinates.collect::<Vec<_>>(),
            "frequencies": self.body.frequencies,
            "mass": self.body.invariants.mass,
            "first_moment": self.body.invariants.first_moment,
            "inertia_about_origin": self.body.invariants.inertia,
            "markers": markers.collect::<Vec<_>>(),
            "left_out": self.left_out(),
        });
        BodyFile {
            name: format!("{stem}.json"),
            contents: format!("{description:#}\n").into_bytes(),
        }
    }

    /// Matrices, constants of the floating frame, and shapes at all nodes.
    fn arrays(&self, stem: &str, motion: &SmallMotion) -> Result<Vec<BodyFile>, FlexibleError> {
        let constants = &self.body.invariants;
        let n = constants.modes;
        let count = self.stored.mesh.nodes.len();
        // indices of nodes have 32 bits in a mesh
        let every = (0..count as u32).collect::<Vec<_>>();
        let shapes = Recovery::of_stored(&self.stored)?.nodes(&every)?;
        let nodes = self.stored.mesh.nodes.iter();
        let places = nodes.clone().flat_map(|node| node.position);
        // numbers of nodes are exact below 2^53
        let numbers = nodes.map(|node| node.id as f64);
        let square = |matrix: &Dense| {
            (
                vec![matrix.rows(), matrix.columns()],
                matrix.values().to_vec(),
            )
        };
        let all = [
            ("mass", square(&motion.mass)),
            ("stiffness", square(&motion.stiffness)),
            ("damping", square(&motion.damping)),
            (
                "motion",
                (
                    vec![self.body.markers.len(), 6, motion.motion.columns()],
                    motion.motion.values().to_vec(),
                ),
            ),
            (
                "rotation_by_shape",
                (vec![3, 3, n], constants.rotation_by_shape.concat()),
            ),
            ("coriolis", (vec![3, n, n], constants.coriolis.concat())),
            (
                "centrifugal",
                (vec![6, n, n], constants.centrifugal.concat()),
            ),
            ("nodes", (vec![count, 3], places.collect())),
            ("node_numbers", (vec![count], numbers.collect())),
            ("shapes", (vec![count, 6, n], shapes.rows().to_vec())),
        ];
        let file = |(name, (shape, values)): (&str, (Vec<usize>, Vec<f64>))| BodyFile {
            name: format!("{stem}.{name}.npy"),
            contents: array(&shape, &values),
        };
        Ok(all.into_iter().map(file).collect())
    }
}

/// A name that Abaqus takes without quotes: it has letters, digits and underscores, and begins with a letter.
fn legal_name(stem: &str) -> String {
    let legal = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name = stem.chars().map(legal).collect::<String>();
    match name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        true => name,
        false => format!("B{name}"),
    }
}
