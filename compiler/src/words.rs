//! The words of flexible bodies and tables, with their arguments.
//!
//! The checker and elaboration read the same tables.

use eng_system::mesh_files::{ElementRules, MeshUnits, ShapeFormat, Stated};
use eng_system::table::End;

/// The words for the start of a body.
pub(crate) const START_VALUES: [&str; 4] = ["position", "rotation", "velocity", "angular_velocity"];

/// The continuations of a table beyond an end of an argument.
pub(crate) const ENDS_OF_TABLES: [(&str, End); 5] = [
    ("none", End::Open),
    ("hold", End::Hold),
    ("linear", End::Linear),
    ("even", End::Even),
    ("odd", End::Odd),
];

/// The continuation that a word names.
pub(crate) fn end_of_table(word: &str) -> Option<End> {
    let known = ENDS_OF_TABLES.iter().find(|(known, _)| *known == word);
    known.map(|(_, end)| *end)
}

/// The kind of an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Takes {
    /// A text: file, set, matrix.
    Text,
    /// Texts in a list.
    Texts,
    /// A whole number.
    Count,
    /// One of some words.
    Word(&'static [&'static str]),
    /// A length.
    Length,
    /// Three lengths.
    Place,
    /// Three plain numbers, or `x`, `y`, `z`.
    Axis,
    /// Three plain numbers.
    Direction,
    /// A frequency, in cycles per time.
    Frequency,
    /// A plain number.
    Ratio,
    /// Markers of the body, by name.
    Markers,
    /// Freedoms of a marker, by name.
    Freedoms,
    /// The inverse of a time.
    PerTime,
    /// A time.
    Time,
    /// A call of a word of [`Place::Surface`].
    Surface,
    /// A call of a word of [`Place::Mesh`].
    Mesh,
    /// Records of plane sections in a list.
    Sections,
}

/// An argument of a word.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Argument {
    pub name: &'static str,
    pub takes: Takes,
    pub required: bool,
    /// Taken by name only.
    pub named: bool,
}

/// The place of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    Mesh,
    Matrix,
    Recovery,
    Marker,
    Modes,
    Damping,
    Surface,
    Support,
}

impl Place {
    /// The place in words, for messages.
    pub fn text(self) -> &'static str {
        match self {
            Place::Mesh => "the `mesh` of a flexible body",
            Place::Matrix => "the `stiffness` or `mass` of a flexible body",
            Place::Recovery => "the `recovery` of a flexible body",
            Place::Marker => "the place of a marker of a flexible body",
            Place::Modes => "a mode set",
            Place::Damping => "the `damping` of a flexible body",
            Place::Surface => "the `surface` of a marker",
            Place::Support => "the `support` of a flexible body",
        }
    }
}

/// A word with its arguments.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word {
    pub word: &'static str,
    pub place: Place,
    pub arguments: &'static [Argument],
    /// An example of its use.
    pub example: &'static str,
}

const fn positional(name: &'static str, takes: Takes) -> Argument {
    Argument {
        name,
        takes,
        required: true,
        named: false,
    }
}

const fn named(name: &'static str, takes: Takes) -> Argument {
    Argument {
        name,
        takes,
        required: true,
        named: true,
    }
}

const fn optional(name: &'static str, takes: Takes) -> Argument {
    Argument {
        name,
        takes,
        required: false,
        named: true,
    }
}

/// The words of a list with their meanings.
const fn words_of<const N: usize, T: Copy>(named: &[(&'static str, T)]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = named[i].0;
        i += 1;
    }
    words
}

/// Systems of units of finite-element files.
pub(crate) const UNITS: &[&str] = &words_of::<{ MeshUnits::NAMED.len() }, _>(MeshUnits::NAMED);
/// Rules for the integration of elements.
pub(crate) const ELEMENT_RULES: &[&str] =
    &words_of::<{ ElementRules::NAMED.len() }, _>(ElementRules::NAMED);
/// Formats of mode shapes.
const SHAPES: &[&str] = &words_of::<{ ShapeFormat::NAMED.len() }, _>(ShapeFormat::NAMED);
/// The supports of a mesh's file, among those of a body.
pub(crate) const DECK: &str = "deck";
/// Kinds of ties between nodes and a marker.
const TIES: &[&str] = &["averaging", "rigid"];

/// Axes of a stack.
pub(crate) const AXES: &[&str] = &["x", "y", "z"];

const FILE: Argument = positional("file", Takes::Text);
const MESH: &[Argument] = &[
    FILE,
    named("units", Takes::Word(UNITS)),
    optional("ignore", Takes::Texts),
];
/// A mesh whose file may state its units.
const MESH_WITH_UNITS: &[Argument] = &[
    FILE,
    optional("units", Takes::Word(UNITS)),
    optional("ignore", Takes::Texts),
];
/// A mesh of gmsh or Salome, whose surfaces may be shells.
const MESH_WITH_SHELLS: &[Argument] = &[
    FILE,
    named("units", Takes::Word(UNITS)),
    optional("ignore", Takes::Texts),
    optional("shells", Takes::Texts),
    optional("thickness", Takes::Length),
];
const LIST: Argument = optional("freedoms", Takes::Text);
const PER_NODE: Argument = optional("per_node", Takes::Count);
const NAMED_MATRIX: &[Argument] = &[FILE, named("matrix", Takes::Text), LIST, PER_NODE];
const PLAIN_MATRIX: &[Argument] = &[FILE, LIST, PER_NODE];
const NODES: Argument = named("nodes", Takes::Mesh);
const TOLERANCE: Argument = optional("tolerance", Takes::Ratio);
const NAMED_RECOVERY: &[Argument] = &[
    FILE,
    named("matrix", Takes::Text),
    NODES,
    LIST,
    PER_NODE,
    TOLERANCE,
];
const PLAIN_RECOVERY: &[Argument] = &[FILE, NODES, LIST, PER_NODE, TOLERANCE];
const X: Argument = optional("x", Takes::Direction);
const Z: Argument = optional("z", Takes::Direction);
const TIE: Argument = optional("tie", Takes::Word(TIES));
const AT: Argument = named("at", Takes::Markers);
const FREEDOMS: Argument = optional("freedoms", Takes::Freedoms);
const NUMBER: Argument = Argument {
    name: "number",
    takes: Takes::Count,
    required: false,
    named: false,
};
const UP_TO: Argument = optional("up_to", Takes::Frequency);

/// All words.
pub(crate) const WORDS: &[Word] = &[
    Word {
        word: "nastran",
        place: Place::Mesh,
        arguments: MESH,
        example: "nastran(\"crank.bdf\", units: mm_tonne_s)",
    },
    Word {
        word: "abaqus",
        place: Place::Mesh,
        arguments: MESH,
        example: "abaqus(\"block.inp\", units: mm_tonne_s)",
    },
    Word {
        word: "calculix",
        place: Place::Mesh,
        arguments: MESH,
        example: "calculix(\"block.inp\", units: mm_tonne_s)",
    },
    Word {
        word: "gmsh",
        place: Place::Mesh,
        arguments: MESH_WITH_SHELLS,
        example: "gmsh(\"rod.msh\", units: mm_tonne_s)",
    },
    Word {
        word: "ansys",
        place: Place::Mesh,
        arguments: MESH,
        example: "ansys(\"block.cdb\", units: mm_tonne_s)",
    },
    Word {
        word: "universal",
        place: Place::Mesh,
        arguments: MESH_WITH_UNITS,
        example: "universal(\"block.unv\", units: mm_tonne_s)",
    },
    Word {
        word: "med",
        place: Place::Mesh,
        arguments: MESH_WITH_SHELLS,
        example: "med(\"block.med\", units: mm_tonne_s)",
    },
    Word {
        word: "csv",
        place: Place::Mesh,
        arguments: MESH,
        example: "csv(\"nodes.csv\", units: mm_tonne_s)",
    },
    Word {
        word: "stack",
        place: Place::Mesh,
        arguments: &[
            named("axis", Takes::Word(AXES)),
            named("size", Takes::Length),
            named("sections", Takes::Sections),
            optional("begin", Takes::Length),
        ],
        example: "stack(axis: z, size: 10 mm, sections: [disc(20 mm, length: 80 mm)])",
    },
    Word {
        word: "op4",
        place: Place::Matrix,
        arguments: NAMED_MATRIX,
        example: "op4(\"block.op4\", matrix: \"KGG\", per_node: 6)",
    },
    Word {
        word: "op2",
        place: Place::Matrix,
        arguments: NAMED_MATRIX,
        example: "op2(\"block.op2\", matrix: \"KGG\")",
    },
    Word {
        word: "dmig",
        place: Place::Matrix,
        arguments: NAMED_MATRIX,
        example: "dmig(\"block.pch\", matrix: \"KAAX\")",
    },
    Word {
        word: "abaqus",
        place: Place::Matrix,
        arguments: PLAIN_MATRIX,
        example: "abaqus(\"block_STIF1.mtx\")",
    },
    Word {
        word: "calculix",
        place: Place::Matrix,
        arguments: PLAIN_MATRIX,
        example: "calculix(\"block.sti\", freedoms: \"block.dof\")",
    },
    Word {
        word: "csv",
        place: Place::Matrix,
        arguments: PLAIN_MATRIX,
        example: "csv(\"stiffness.csv\", per_node: 6)",
    },
    Word {
        word: "op4",
        place: Place::Recovery,
        arguments: NAMED_RECOVERY,
        example: "op4(\"block.op4\", matrix: \"MUG1\", nodes: nastran(\"block.bdf\", units: mm_tonne_s))",
    },
    Word {
        word: "op2",
        place: Place::Recovery,
        arguments: NAMED_RECOVERY,
        example: "op2(\"block.op2\", matrix: \"MUG1\", nodes: nastran(\"block.bdf\", units: mm_tonne_s))",
    },
    Word {
        word: "dmig",
        place: Place::Recovery,
        arguments: NAMED_RECOVERY,
        example: "dmig(\"block.pch\", matrix: \"MUG1\", nodes: nastran(\"block.bdf\", units: mm_tonne_s))",
    },
    Word {
        word: "csv",
        place: Place::Recovery,
        arguments: PLAIN_RECOVERY,
        example: "csv(\"recovery.csv\", per_node: 3, nodes: csv(\"inner.csv\", units: mm_tonne_s))",
    },
    Word {
        word: "node",
        place: Place::Marker,
        arguments: &[positional("id", Takes::Count), X, Z],
        example: "node(9201)",
    },
    Word {
        word: "set",
        place: Place::Marker,
        arguments: &[
            positional("name", Takes::Text),
            optional("center", Takes::Place),
            TIE,
            X,
            Z,
        ],
        example: "set(\"MAIN1\")",
    },
    Word {
        word: "property",
        place: Place::Marker,
        arguments: &[
            positional("name", Takes::Text),
            optional("center", Takes::Place),
            TIE,
            X,
            Z,
        ],
        example: "property(\"12\")",
    },
    Word {
        word: "ring",
        place: Place::Marker,
        arguments: &[
            named("center", Takes::Place),
            named("axis", Takes::Axis),
            named("radius", Takes::Length),
            named("width", Takes::Length),
            optional("tolerance", Takes::Length),
            optional("surface", Takes::Surface),
            TIE,
            X,
            Z,
        ],
        example: "ring(center: [0, 0, 92] mm, axis: z, radius: 27 mm, width: 22 mm)",
    },
    Word {
        word: "patch",
        place: Place::Marker,
        arguments: &[
            named("center", Takes::Place),
            named("normal", Takes::Axis),
            named("radius", Takes::Length),
            optional("tolerance", Takes::Length),
            TIE,
            X,
            Z,
        ],
        example: "patch(center: [0, 0, 410] mm, normal: z, radius: 35 mm)",
    },
    Word {
        word: "plane",
        place: Place::Marker,
        arguments: &[
            named("point", Takes::Place),
            named("normal", Takes::Axis),
            optional("center", Takes::Place),
            optional("tolerance", Takes::Length),
            TIE,
            X,
            Z,
        ],
        example: "plane(point: [0, 0, 410] mm, normal: z)",
    },
    Word {
        word: "static",
        place: Place::Modes,
        arguments: &[AT, FREEDOMS],
        example: "static(at: [main, pin])",
    },
    Word {
        word: "constraint",
        place: Place::Modes,
        arguments: &[AT, FREEDOMS],
        example: "constraint(at: [main, pin])",
    },
    Word {
        word: "normal",
        place: Place::Modes,
        arguments: &[NUMBER, UP_TO, optional("fixed", Takes::Markers), FREEDOMS],
        example: "normal(10)",
    },
    Word {
        word: "craig_bampton",
        place: Place::Modes,
        arguments: &[AT, NUMBER, UP_TO, FREEDOMS],
        example: "craig_bampton(at: main, number: 10)",
    },
    Word {
        word: "shapes",
        place: Place::Modes,
        arguments: &[FILE, named("format", Takes::Word(SHAPES))],
        example: "shapes(\"crank.op2\", format: op2)",
    },
    Word {
        word: "held",
        place: Place::Support,
        arguments: &[AT, named("freedoms", Takes::Freedoms)],
        example: "held(at: foot, freedoms: [y, z])",
    },
    Word {
        word: "modal",
        place: Place::Damping,
        arguments: &[
            positional("ratio", Takes::Ratio),
            named("up_to", Takes::Frequency),
        ],
        example: "modal(2 %, up_to: 3000 Hz)",
    },
    Word {
        word: "rayleigh",
        place: Place::Damping,
        arguments: &[
            named("mass", Takes::PerTime),
            named("stiffness", Takes::Time),
        ],
        example: "rayleigh(mass: 12 s^-1, stiffness: 2e-6 s)",
    },
    Word {
        word: "fourier",
        place: Place::Surface,
        arguments: &[
            named("waves_around", Takes::Count),
            named("degree_across", Takes::Count),
        ],
        example: "fourier(waves_around: 8, degree_across: 2)",
    },
];

/// The word with a name in a place.
pub(crate) fn word(place: Place, name: &str) -> Option<&'static Word> {
    WORDS.iter().find(|w| w.place == place && w.word == name)
}

/// All words of a place.
pub(crate) fn words(place: Place) -> impl Iterator<Item = &'static Word> {
    WORDS.iter().filter(move |w| w.place == place)
}

/// The word with a name, in any place.
pub(crate) fn belongs(name: &str) -> Option<&'static Word> {
    WORDS.iter().find(|w| w.word == name)
}

/// The argument with a name, given by name or by its position among the unnamed ones.
pub(crate) fn argument<'e>(
    word: &Word,
    arguments: &'e [eng_grammar::ast::Argument],
    name: &str,
) -> Option<&'e eng_grammar::ast::Expr> {
    let place = word
        .arguments
        .iter()
        .filter(|a| !a.named)
        .position(|a| a.name == name);
    let by_name = arguments
        .iter()
        .find(|a| a.name.as_ref().is_some_and(|n| n.text == name));
    let by_position = || arguments.iter().filter(|a| a.name.is_none()).nth(place?);
    by_name.or_else(by_position).map(|a| &a.value)
}

/// The raw contents of a quoted text, with its place.
pub(crate) fn inside_quotes(
    sources: &eng_grammar::SourceMap,
    span: eng_grammar::Span,
) -> eng_grammar::ast::Name {
    let raw = sources.text(span);
    let inner = raw
        .strip_prefix('"')
        .and_then(|t| t.strip_suffix('"'))
        .unwrap_or(raw);
    let start = span.start as usize + usize::from(raw.len() > inner.len());
    eng_grammar::ast::Name {
        text: inner.to_owned(),
        span: eng_grammar::Span::new(span.source, start, start + inner.len()),
    }
}
