//! Matrices and mode shapes of another code for a mesh: the freedom of each row, and the units.

use crate::error::{FlexibleError, Part};
use crate::fe::NodalMatrix;
use crate::mesh::{DeckMatrices, DeckMatrix, Mesh};
use crate::read::Files;
use crate::read::matrix::{
    ForeignFreedoms, ForeignMatrix, ForeignModes, MatrixFormat, MatrixKind, of_pairs,
    read_calculix_freedoms, read_matrix,
};
use crate::solve::factor::diagonal;
use crate::sparse::SymmetricMatrix;
use crate::units::MeshUnits;
use eng_system::dense::largest;
use eng_system::significant::short;

/// Part of the largest diagonal entry below which a negative one counts as rounding. A choice: a file with
/// thirteen digits has less.
const ROUNDING: f64 = 1e-12;

/// The freedom of each row of foreign matrices.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum RowOrder {
    /// Given by the files of the matrices.
    #[default]
    OfFile,
    /// All nodes of the mesh by ascending number, with 3 (translations) or 6 freedoms each.
    Ascending(u8),
    /// Given by a list.
    Listed(ForeignFreedoms),
}

/// The freedom of each row: number of a node and component 0…5, or number of a scalar point and `None`.
type Rows = Vec<(u64, Option<u8>)>;

/// Stiffness and mass of another code, in place of those of the mesh's elements.
#[derive(Clone, Debug, PartialEq)]
pub struct ForeignMatrices {
    /// K in the form of its file.
    pub stiffness: ForeignMatrix,
    /// M in the form of its file.
    pub mass: ForeignMatrix,
    /// The freedoms of the rows of both.
    pub order: RowOrder,
    /// Units of the files. The mesh is in SI.
    pub units: MeshUnits,
}

/// A matrix of another code that recovers nodes from the freedoms of stiffness and mass: `u = T q`.
///
/// q are the freedoms of the rows of the stiffness, in their order. Translations are in the unit of length, rotations in
/// radians, amplitudes of scalar points are pure numbers. Freedoms of nodes are along the axes of their analysis frames.
#[derive(Clone, Debug, PartialEq)]
pub struct RecoveryMatrix {
    /// T in the form of its file.
    pub matrix: ForeignMatrix,
    /// The freedoms of its rows.
    pub order: RowOrder,
    /// The nodes of its rows (SI), with cells for pictures.
    pub nodes: Mesh,
    /// Units of T.
    pub units: MeshUnits,
    /// The largest share of a rigid motion that the nodes may miss.
    pub tolerance: f64,
}

/// Mode shapes of another code.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenModes {
    /// Modes in the form of their file.
    pub modes: ForeignModes,
    /// Units of the file. Translations are in its unit of length, rotations in radians.
    pub units: MeshUnits,
}

/// The source of a matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MatrixFile<'a> {
    /// The file.
    pub file: &'a str,
    /// Its stated format.
    pub format: MatrixFormat,
    /// The matrix's name in the file. Empty means the only matrix there.
    pub name: &'a str,
    /// CalculiX's `.dof`, which lists the freedoms of its rows.
    pub freedoms: Option<&'a str>,
}

impl MatrixFile<'_> {
    /// Reads the matrix. Its freedoms come from its own list, else from `others`.
    fn read(
        &self,
        files: &dyn Files,
        kind: MatrixKind,
        others: Option<&str>,
    ) -> Result<ForeignMatrix, FlexibleError> {
        let name = match self.format {
            // the file of a substructure has both
            MatrixFormat::Abaqus => kind.of_substructure(),
            _ => self.name,
        };
        let matrix = read_matrix(files, self.file, self.format, name)?;
        match self.freedoms.or(others) {
            Some(list) => matrix.with_freedoms(read_calculix_freedoms(files, list)?),
            None => Ok(matrix),
        }
    }
}

impl ForeignMatrices {
    /// Reads stiffness and mass. A list of freedoms of one applies to both. `per_node` is the number of
    /// freedoms of each node if rows are all nodes by ascending number. With `None` the files give the
    /// freedoms.
    ///
    /// # Errors
    /// Those of the readers; a list of freedoms of another length.
    pub fn read(
        files: &dyn Files,
        stiffness: MatrixFile,
        mass: MatrixFile,
        per_node: Option<u8>,
        units: MeshUnits,
    ) -> Result<Self, FlexibleError> {
        let (of_stiffness, of_mass) = (stiffness.freedoms, mass.freedoms);
        let stiffness = stiffness
            .read(files, MatrixKind::Stiffness, of_mass)
            .map_err(|error| error.of(Part::Stiffness))?;
        let mass = mass
            .read(files, MatrixKind::Mass, of_stiffness)
            .map_err(|error| error.of(Part::Mass))?;
        Ok(ForeignMatrices {
            stiffness,
            mass,
            order: per_node.map_or(RowOrder::OfFile, RowOrder::Ascending),
            units,
        })
    }

    /// The matrices of a deck itself.
    ///
    /// # Errors
    /// More than 4 billion freedoms.
    pub fn of_deck(own: &DeckMatrices, units: MeshUnits) -> Result<Self, FlexibleError> {
        let of = |matrix: &DeckMatrix| of_pairs(&matrix.file, &matrix.name, &matrix.pairs);
        Ok(ForeignMatrices {
            stiffness: of(&own.stiffness)?,
            mass: of(&own.mass)?,
            order: RowOrder::OfFile,
            units,
        })
    }

    /// K and M in SI with the freedom of each row.
    ///
    /// # Errors
    /// Those of [`ForeignMatrix::to_symmetric`]; sizes that don't fit the stated order; rows without a
    /// freedom.
    pub fn nodal(&self, mesh: &Mesh) -> Result<(NodalMatrix, NodalMatrix), FlexibleError> {
        let stiffness = self
            .one(mesh, &self.stiffness, MatrixKind::Stiffness)
            .map_err(|error| error.of(Part::Stiffness))?;
        let mass = self
            .one(mesh, &self.mass, MatrixKind::Mass)
            .map_err(|error| error.of(Part::Mass))?;
        Ok((stiffness, mass))
    }

    fn one(
        &self,
        mesh: &Mesh,
        matrix: &ForeignMatrix,
        kind: MatrixKind,
    ) -> Result<NodalMatrix, FlexibleError> {
        let rows = rows(mesh, &mesh.boundary, &self.order, matrix)?;
        let mut values = matrix.to_symmetric(kind)?;
        if kind == MatrixKind::Stiffness {
            resists(&title(matrix), &values, &rows)?;
        }
        let unit = match kind {
            MatrixKind::Stiffness => self.units.force() / self.units.length,
            MatrixKind::Mass => self.units.mass,
        };
        scale(&mut values, &rows, unit, self.units.length);
        Ok(NodalMatrix {
            title: title(matrix),
            matrix: values,
            rows,
        })
    }
}

/// Node and component 0…5 of each row, or scalar point and `None`. A matrix that does not state them has the rows that
/// the mesh's file states (`stated`).
fn rows(
    mesh: &Mesh,
    stated: &[(u64, u8)],
    order: &RowOrder,
    matrix: &ForeignMatrix,
) -> Result<Rows, FlexibleError> {
    let fits = matrix.freedoms.is_none() && stated.len() == matrix.rows && !stated.is_empty();
    let of_mesh = fits.then(|| ForeignFreedoms {
        rows: stated.to_vec(),
    });
    let listed = match order {
        RowOrder::OfFile => matrix.freedoms.as_ref().or(of_mesh.as_ref()),
        RowOrder::Listed(listed) => Some(listed),
        RowOrder::Ascending(per_node) => return ascending(mesh, matrix, *per_node),
    };
    let Some(listed) = listed else {
        return Err(FlexibleError::Matrix {
            problem: format!(
                "{} does not state the freedoms of its {} rows",
                title(matrix),
                matrix.rows
            ),
            advice: format!(
                "give the list of freedoms, `freedoms: \"….dof\"`; or state `per_node: 3` or `per_node: 6` if the rows are these freedoms of all nodes in ascending order. The mesh has {} nodes",
                mesh.nodes.len()
            ),
        });
    };
    if listed.rows.len() != matrix.rows {
        return Err(FlexibleError::Matrix {
            problem: format!(
                "{} has {} rows, but the list has {} freedoms",
                title(matrix),
                matrix.rows,
                listed.rows.len()
            ),
            advice: "give the matrix and the list of freedoms of the same run".into(),
        });
    }
    listed
        .rows
        .iter()
        .enumerate()
        .map(|(row, (node, freedom))| match freedom.checked_sub(1) {
            Some(component) if component < 6 => Ok((*node, Some(component))),
            Some(_) => Err(FlexibleError::Matrix {
                problem: format!(
                    "{} names freedom {freedom} of node {node} at row {}",
                    title(matrix),
                    row + 1
                ),
                advice: "name freedoms from 1 to 6, or 0 for a scalar point".into(),
            }),
            None => Ok((*node, None)),
        })
        .collect()
}

impl RecoveryMatrix {
    /// Reads T. `per_node` is the number of freedoms of each node if the rows are all `nodes` by ascending number. With
    /// `None` a list, the file itself or the file of a mesh gives the freedoms.
    ///
    /// # Errors
    /// Those of the readers; a list of freedoms of another length.
    pub fn read(
        files: &dyn Files,
        file: MatrixFile,
        per_node: Option<u8>,
        (nodes, units): (Mesh, MeshUnits),
        tolerance: f64,
    ) -> Result<Self, FlexibleError> {
        let of = |error: FlexibleError| error.of(Part::Recovery);
        let mut matrix = read_matrix(files, file.file, file.format, file.name).map_err(of)?;
        if let Some(list) = file.freedoms {
            let list = read_calculix_freedoms(files, list).map_err(FlexibleError::from);
            matrix = list
                .and_then(|list| matrix.with_freedoms(list))
                .map_err(of)?;
        }
        Ok(RecoveryMatrix {
            matrix,
            order: per_node.map_or(RowOrder::OfFile, RowOrder::Ascending),
            nodes,
            units,
            tolerance,
        })
    }

    /// Its name in messages.
    pub(crate) fn title(&self) -> String {
        title(&self.matrix)
    }

    /// Node and component 0…5 of each row, or scalar point and `None`. A matrix that does not state them has the rows
    /// that the file of its nodes or that of the interface states.
    ///
    /// # Errors
    /// Rows that nothing states, or as many as the list does not have.
    pub(crate) fn rows(&self, interface: &Mesh) -> Result<Vec<(u64, Option<u8>)>, FlexibleError> {
        let stated = match self.nodes.recovered.is_empty() {
            true => &interface.recovered,
            false => &self.nodes.recovered,
        };
        rows(&self.nodes, stated, &self.order, &self.matrix)
    }
}

/// Refuses a stiffness with a negative diagonal, which no positive semi-definite matrix has.
fn resists(
    title: &str,
    stiffness: &SymmetricMatrix,
    rows: &[(u64, Option<u8>)],
) -> Result<(), FlexibleError> {
    let diagonal = diagonal(stiffness);
    let largest = largest(&diagonal);
    let negative = |x: f64| x < -ROUNDING * largest;
    let count = diagonal.iter().filter(|x| negative(**x)).count();
    let Some((value, (node, component))) = diagonal.iter().zip(rows).find(|(x, _)| negative(**x))
    else {
        return Ok(());
    };
    let positive = diagonal.iter().any(|x| *x > ROUNDING * largest);
    Err(FlexibleError::Matrix {
        problem: format!(
            "{title} is a stiffness with {} on its diagonal at {}, and {count} of its {} diagonal entries are negative: \
             it is not positive semidefinite",
            short(*value, 5),
            match component {
                Some(component) => format!("freedom {} of node {node}", component + 1),
                None => format!("scalar point {node}"),
            },
            diagonal.len()
        ),
        advice: if positive {
            "write the structural stiffness alone; look for negative springs, or a load beyond buckling"
        } else {
            "write −K: its whole diagonal is negative, so its sign is reversed"
        }
        .into(),
    })
}

fn title(matrix: &ForeignMatrix) -> String {
    if matrix.name.is_empty() {
        matrix.file.clone()
    } else {
        format!("{}: {}", matrix.file, matrix.name)
    }
}

/// All nodes of the mesh by ascending number.
fn ascending(mesh: &Mesh, matrix: &ForeignMatrix, per_node: u8) -> Result<Rows, FlexibleError> {
    let fits = |freedoms: usize| mesh.nodes.len().checked_mul(freedoms) == Some(matrix.rows);
    if !matches!(per_node, 3 | 6) || !fits(usize::from(per_node)) {
        let other = [3, 6].into_iter().find(|count| fits(*count));
        return Err(FlexibleError::Matrix {
            problem: format!(
                "{} has {} rows, which are not {per_node} freedoms of each of the mesh's {} nodes",
                title(matrix),
                matrix.rows,
                mesh.nodes.len()
            ),
            advice: match other {
                Some(count) => format!("state `per_node: {count}`"),
                None => "give the mesh of the run that wrote it, or a matrix that lists its freedoms; rows of supported freedoms may be missing".into(),
            },
        });
    }
    let mut ids: Vec<u64> = mesh.nodes.iter().map(|node| node.id).collect();
    ids.sort_unstable();
    Ok(ids
        .into_iter()
        .flat_map(|id| (0..per_node).map(move |component| (id, Some(component))))
        .collect())
}

/// To SI: `unit` between translations, a length more for each rotation and scalar point. The value of a
/// scalar point is a pure number: its scale is free, and energies decide the unit of its rows.
fn scale(matrix: &mut SymmetricMatrix, rows: &[(u64, Option<u8>)], unit: f64, length: f64) {
    let factor = |row: usize| match rows.get(row) {
        Some((_, Some(0..3))) | None => 1.0,
        Some(_) => length,
    };
    let scales: Vec<f64> = (0..matrix.size())
        .flat_map(|column| {
            let (rows, _) = matrix.column(column);
            rows.iter()
                .map(move |row| unit * factor(column) * factor(*row as usize))
                .collect::<Vec<_>>()
        })
        .collect();
    for (value, scale) in matrix.values_mut().iter_mut().zip(scales) {
        if scale != 1.0 {
            *value *= scale;
        }
    }
}
