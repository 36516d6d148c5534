//! Formats, units and rules of finite-element files, each with the word by which a text states it.

/// A value that a text states by a word.
pub trait Stated: Copy + 'static {
    /// The words with their values.
    const NAMED: &'static [(&'static str, Self)];

    /// The value of a word.
    fn named(word: &str) -> Option<Self> {
        let found = Self::NAMED.iter().find(|(known, _)| *known == word);
        found.map(|(_, meaning)| *meaning)
    }
}

/// A format of finite-element meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshFormat {
    /// Nastran bulk data.
    Nastran,
    /// Input of Abaqus.
    Abaqus,
    /// Input of CalculiX.
    CalculiX,
    /// A mesh of gmsh.
    Gmsh,
    /// An archive of ANSYS (`.cdb`).
    Ansys,
    /// A universal file of I-deas (`.unv`, `.uff`).
    Universal,
    /// A MED file of Salome and code_aster.
    Med,
    /// A table of nodes as text.
    Csv,
}

impl Stated for MeshFormat {
    const NAMED: &'static [(&'static str, Self)] = &[
        ("nastran", MeshFormat::Nastran),
        ("abaqus", MeshFormat::Abaqus),
        ("calculix", MeshFormat::CalculiX),
        ("gmsh", MeshFormat::Gmsh),
        ("ansys", MeshFormat::Ansys),
        ("universal", MeshFormat::Universal),
        ("med", MeshFormat::Med),
        ("csv", MeshFormat::Csv),
    ];
}

/// A format of matrices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MatrixFormat {
    /// Nastran's OP4.
    Op4,
    /// Nastran's OP2.
    Op2,
    /// Cards `DMIG` of Nastran, punched or in a deck.
    Dmig,
    /// `.mtx` of Abaqus.
    Abaqus,
    /// `.sti` and `.mas` of CalculiX.
    CalculiX,
    /// A dense matrix as text, a line for each row.
    Csv,
}

impl Stated for MatrixFormat {
    const NAMED: &'static [(&'static str, Self)] = &[
        ("op4", MatrixFormat::Op4),
        ("op2", MatrixFormat::Op2),
        ("dmig", MatrixFormat::Dmig),
        ("abaqus", MatrixFormat::Abaqus),
        ("calculix", MatrixFormat::CalculiX),
        ("csv", MatrixFormat::Csv),
    ];
}

/// A format of mode shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ShapeFormat {
    /// Nastran's OP2.
    Op2,
    /// Nastran's punch file.
    Punch,
    /// CalculiX's `.frd`.
    Frd,
    /// A universal file of I-deas.
    Universal,
}

impl Stated for ShapeFormat {
    const NAMED: &'static [(&'static str, Self)] = &[
        ("op2", ShapeFormat::Op2),
        ("punch", ShapeFormat::Punch),
        ("frd", ShapeFormat::Frd),
        ("universal", ShapeFormat::Universal),
    ];
}

/// The code whose rules integrate the elements of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ElementRules {
    /// All in full, with exact mass.
    Exact,
    /// CalculiX'.
    CalculiX,
    /// Abaqus'.
    Abaqus,
    /// Nastran's.
    Nastran,
}

impl Stated for ElementRules {
    const NAMED: &'static [(&'static str, Self)] = &[
        ("exact", ElementRules::Exact),
        ("calculix", ElementRules::CalculiX),
        ("abaqus", ElementRules::Abaqus),
        ("nastran", ElementRules::Nastran),
    ];
}

/// A consistent set of units of a file, with the value of each unit in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshUnits {
    /// The word by which a text states them.
    pub name: &'static str,
    /// Metres of the unit of length.
    pub length: f64,
    /// Kilograms of the unit of mass.
    pub mass: f64,
    /// Seconds of the unit of time.
    pub time: f64,
}

const fn units(name: &'static str, length: f64, mass: f64, time: f64) -> (&'static str, MeshUnits) {
    let units = MeshUnits {
        name,
        length,
        mass,
        time,
    };
    (name, units)
}

impl Stated for MeshUnits {
    const NAMED: &'static [(&'static str, Self)] = &[
        (MeshUnits::SI.name, MeshUnits::SI),
        units("m_kg_s", 1.0, 1.0, 1.0),
        units("mm_tonne_s", 1e-3, 1e3, 1.0),
        units("mm_kg_s", 1e-3, 1.0, 1.0),
        units("mm_kg_ms", 1e-3, 1.0, 1e-3),
        units("cm_kg_s", 1e-2, 1.0, 1.0),
        // pound-force, inch, second: the mass unit is lbf s²/in
        units("inch_lbf_s", 0.0254, 175.126_835_246_476_37, 1.0),
    ];
}

impl MeshUnits {
    /// Metres, kilograms, seconds.
    pub const SI: MeshUnits = units("si", 1.0, 1.0, 1.0).1;

    /// Newtons of the unit of force.
    pub fn force(&self) -> f64 {
        self.mass * self.length / (self.time * self.time)
    }
}
