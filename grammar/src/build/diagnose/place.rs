//! The places of items, with the words that may begin an item there. A message uses them for a word that
//! begins no item.

use crate::ast::Kind;

/// A place of items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// At the top of a file.
    File,
    /// In the block of a declaration of a kind.
    Definition(Kind),
    /// In the block of a use of a class.
    Use,
    /// In a report.
    Report,
}

impl Place {
    pub fn text(self) -> &'static str {
        match self {
            Place::File => "at the top of a file",
            Place::Definition(Kind::Model) => "in a model",
            Place::Definition(Kind::Component) => "in a component",
            Place::Definition(Kind::Interface) => "in an interface",
            Place::Definition(Kind::Record) => "in a record",
            Place::Definition(Kind::Body) => "in a body",
            Place::Definition(Kind::Flexible) => "in a flexible body",
            Place::Definition(Kind::Joint) => "in a joint",
            Place::Definition(Kind::Force) => "in a force",
            Place::Definition(Kind::Journal) => "in a journal",
            Place::Definition(Kind::Drive) => "in a drive",
            Place::Definition(Kind::Cycle) => "in a cycle",
            Place::Definition(_) | Place::Use => "in the block of a use",
            Place::Report => "in a report",
        }
    }

    /// The words that may begin an item at this place.
    pub fn words(self) -> &'static [&'static str] {
        const MODEL: &[&str] = &[
            "param", "input", "const", "let", "fn", "table", "gravity", "body", "flexible",
            "marker", "joint", "force", "journal", "drive", "part", "cycle", "start", "guess",
            "output", "require", "advise",
        ];
        const COMPONENT: &[&str] = &[
            "param", "input", "const", "let", "fn", "table", "body", "flexible", "marker", "joint",
            "force", "journal", "drive", "part", "cycle", "start", "guess", "output", "require",
            "advise",
        ];
        const CONSTRAINT: &[&str] = &[
            "const",
            "let",
            "fn",
            "table",
            "state",
            "field",
            "der(…)",
            "constrain",
            "branch",
            "apply",
            "output",
            "require",
            "advise",
        ];
        match self {
            Place::File => &[
                "use",
                "dimension",
                "unit",
                "choice",
                "const",
                "param",
                "let",
                "fn",
                "table",
                "record",
                "interface",
                "joint",
                "force",
                "journal",
                "drive",
                "component",
                "model",
                "analysis",
                "report",
            ],
            Place::Definition(Kind::Model) => MODEL,
            Place::Definition(Kind::Component) => COMPONENT,
            Place::Definition(Kind::Interface) => &["param", "const", "output"],
            Place::Definition(Kind::Record) => &["let", "fn"],
            Place::Definition(Kind::Body) => &[
                "mass",
                "inertia",
                "products_of_inertia",
                "center_of_mass",
                "marker",
                "start",
                "guess",
            ],
            Place::Definition(Kind::Flexible) => &[
                "mesh",
                "modes",
                "damping",
                "support",
                "stiffness",
                "mass",
                "recovery",
                "material",
                "element_rules",
                "geometric_stiffness",
                "marker",
                "start",
                "guess",
            ],
            Place::Definition(Kind::Joint | Kind::Drive) => CONSTRAINT,
            Place::Definition(Kind::Force | Kind::Journal) => &[
                "const", "let", "fn", "table", "state", "field", "der(…)", "apply", "output",
                "require", "advise",
            ],
            Place::Definition(Kind::Cycle) => &["period"],
            Place::Definition(_) | Place::Use => &["branch", "require", "advise"],
            Place::Report => &["figure", "value", "let", "require"],
        }
    }
}
