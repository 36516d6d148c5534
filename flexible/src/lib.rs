//! Flexible bodies: finite-element files become a mesh, a mesh becomes matrices, and matrices become a few
//! modes with constant invariants. A time step needs only these invariants; it never uses a node.
//!
//! ```text
//! files ──read──▶ Mesh ──fe──▶ stiffness, mass ──solve──▶ static and normal modes ──modes──▶ invariants
//! ```
//!
//! Invariants of this crate:
//! - The crate uses no syntax trees, no elements of a multibody model and no terminal. It reads files through
//!   [`Files`].
//! - A [`Mesh`] is in the units of its file until [`Mesh::convert`]; everything after `read` is SI.
//! - No part of a file with mass, stiffness or a constraint is dropped silently. It is read, refused, or
//!   listed in [`Mesh::unread`].
//! - The same input gives the same bits, whatever the number of threads.
#![forbid(unsafe_code)]
#![deny(clippy::disallowed_methods)]
// no input may end the library in a panic
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreachable,
    clippy::todo
)]

mod axes;
mod elasticity;
pub mod element;
mod error;
pub mod fe;
pub mod foreign;
mod geometric;
pub mod invariants;
pub mod markers;
pub mod mesh;
pub mod modes;
pub mod read;
pub mod recover;
pub mod reduce;
pub mod rotary;
pub mod small_motion;
pub mod solve;
pub mod sparse;
pub mod stack;
pub mod store;
mod surface;
pub mod units;
pub mod write;

pub use error::{FileProblem, FlexibleError, Part, Place};
pub use mesh::Mesh;
pub use read::{Files, MeshFormat, read_mesh};

/// Parts that the tests of `tests/` check alone. No other crate may use them.
#[doc(hidden)]
pub mod internals {
    use crate::FlexibleError;
    use crate::sparse::SymmetricMatrix;
    use crate::stack::StackError;
    use crate::stack::outline::outline;
    use eng_system::stack::Section;

    pub use crate::fe::residual::eliminate;

    /// The table of elements.
    pub mod elements {
        use crate::element::ElementKind;

        /// The corners of each edge.
        pub fn edges(kind: ElementKind) -> &'static [[usize; 2]] {
            kind.description().edges
        }

        /// The corners of each face.
        pub fn faces(kind: ElementKind) -> &'static [&'static [usize]] {
            kind.description().faces
        }

        /// Position of each node in a file of Nastran, of gmsh, of I-deas and of MED.
        pub fn orders(kind: ElementKind) -> [Option<&'static [usize]>; 4] {
            let names = kind.description().names;
            [
                names.nastran_order,
                names.gmsh_order,
                names.universal_order,
                names.med_order,
            ]
        }

        /// Cards of Nastran.
        pub fn nastran_cards(kind: ElementKind) -> &'static [&'static str] {
            kind.description().names.nastran
        }

        /// The kinds of a card of Nastran, without and with mid-side nodes.
        pub fn of_nastran(card: &str) -> Option<(ElementKind, ElementKind)> {
            ElementKind::of_nastran(card)
        }

        /// The kind of a type of gmsh.
        pub fn of_gmsh(number: i32) -> Option<ElementKind> {
            ElementKind::of_gmsh(number)
        }

        /// Each name in the files of other codes than Nastran, with the kind that it finds.
        pub fn found_by_names(kind: ElementKind) -> Vec<(String, Option<ElementKind>)> {
            let names = kind.description().names;
            let types = names.abaqus.iter();
            let mut found: Vec<(String, Option<ElementKind>)> = types
                .map(|name| ((*name).to_owned(), ElementKind::of_abaqus(name)))
                .collect();
            let facets = names.abaqus_facets.iter();
            found.extend(facets.map(|end| ((*end).to_owned(), ElementKind::of_abaqus_facet(end))));
            let number = names.gmsh.into_iter();
            found.extend(number.map(|number| (number.to_string(), of_gmsh(number))));
            let descriptor = names.universal.into_iter();
            found.extend(descriptor.map(|descriptor| {
                let kind = ElementKind::of_universal(descriptor);
                (descriptor.to_string(), kind)
            }));
            let name = names.med.into_iter();
            found.extend(name.map(|name| (name.to_owned(), ElementKind::of_med(name))));
            found
        }
    }

    /// Readers.
    pub mod read {
        pub use crate::read::abaqus::shapes::{Shape as AbaqusShape, SpringKind};
        pub use crate::read::content::Content;
        pub use crate::read::nastran::lines::include_operand;
        pub use crate::read::nastran::sections::{first_word, heats_materials, is_card};
        pub use crate::read::nastran::shapes::section;
        pub use crate::read::number::{components, integer, is_real, real};
        pub use crate::read::source::{candidates, normal};

        use crate::element::{ElementKind, around};
        use crate::read::abaqus::surfaces::shares;

        /// The share of an element's face in its area (length²) for each node of the face.
        pub fn face_shares(
            kind: ElementKind,
            nodes: &[u32],
            corners: &[usize],
            place: impl Fn(u32) -> [f64; 3],
        ) -> Vec<(u32, f64)> {
            shares(&around(kind, nodes, corners), place)
        }
    }

    /// Writers.
    pub mod write {
        pub use crate::write::number::{field, fortran};
        pub use crate::write::numpy::array;
    }

    /// The area of a section (m²).
    ///
    /// # Errors
    /// If the outline encloses none.
    pub fn outline_area(section: &Section) -> Result<f64, StackError> {
        Ok(outline(section, 1)?.area)
    }

    /// Angle by which the direction from a point turns along the outline of a section (rad).
    ///
    /// # Errors
    /// If the outline encloses no area.
    pub fn outline_turn(section: &Section, point: [f64; 2]) -> Result<f64, StackError> {
        let pieces = outline(section, 1)?.pieces;
        Ok(pieces.iter().map(|piece| piece.turns(point)).sum())
    }

    /// Replaces loads by the displacements of a structure. Freedoms in `held` stay at zero.
    ///
    /// # Errors
    /// If a load meets no resistance.
    pub fn static_solution(
        stiffness: &SymmetricMatrix,
        held: &[bool],
        loads: &mut [f64],
    ) -> Result<(), FlexibleError> {
        crate::modes::statics::solve(stiffness, held, loads)
    }
}
