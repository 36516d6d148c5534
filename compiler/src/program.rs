//! A resolved program: modules, names, units.
//!
//! `resolve` makes it; the checker and elaboration read it.
//!
//! It contains syntax trees and tables to find items in them. It must not contain values of expressions or
//! instances.

mod usual;

pub(crate) use usual::USUAL_UNITS;

use eng_grammar::ast;
use eng_grammar::{SourceId, Span};
use eng_system::{Dimension, DisplayUnit};
use std::collections::{BTreeMap, BTreeSet};

/// Module and interface of the weld between the ground and a flexible body with supports. The joint of this module that fills it
/// has no other parameters.
pub(crate) const WELD: (&str, &str) = ("std.joints", "Weld");
/// Module and interface of film laws. A class that fills it is a journal for the start, the tolerance, tables
/// and figures.
pub(crate) const JOURNAL_LAW: (&str, &str) = ("std.journals", "JournalLaw");
/// Module and interface of the gas in a cylinder. A class that fills it gives the firing angle of the
/// cylinder.
pub(crate) const GAS_LAW: (&str, &str) = ("std.forces", "GasLaw");

/// Whether a module belongs to the library.
pub(crate) fn is_library(path: &str) -> bool {
    path == "std" || path.starts_with("std.")
}

/// An item of a module at its top level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct DefinitionId {
    /// Index into [`Program::modules`].
    pub module: u32,
    /// Index into the file's items.
    pub item: u32,
}

/// One file with the names in its scope.
#[derive(Clone, Debug)]
pub struct Module {
    /// `std.joints`, `inline4`.
    pub path: String,
    /// Its text.
    pub source: SourceId,
    /// Its tree.
    pub file: ast::File,
    /// Own top-level names, names taken by `use`, and the prelude's.
    pub scope: BTreeMap<String, DefinitionId>,
}

/// A unit with its size.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// As written.
    pub symbol: String,
    /// SI value of one.
    pub scale: f64,
    /// SI value of its zero; not 0 for affine units.
    pub offset: f64,
    /// Its dimension.
    pub dimension: Dimension,
    /// The named point dimension it is restricted to (`Temperature` for degC, `GaugePressure` for barg), if
    /// any.
    pub point: Option<String>,
}

impl From<Unit> for DisplayUnit {
    fn from(unit: Unit) -> DisplayUnit {
        DisplayUnit {
            symbol: unit.symbol,
            scale: unit.scale,
            offset: unit.offset,
        }
    }
}

/// A named dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedDimension {
    /// Exponents.
    pub dimension: Dimension,
    /// For `dimension P = point D`: D's name.
    pub point_of: Option<String>,
}

/// A program.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// All modules that are used; the root is the last.
    pub modules: Vec<Module>,
    /// Units by symbol.
    pub units: BTreeMap<String, Unit>,
    /// Dimensions by name.
    pub dimensions: BTreeMap<String, NamedDimension>,
    /// Names of the library that this program could use. For messages.
    pub offered: BTreeMap<String, Offered>,
}

/// A name of the library.
#[derive(Clone, Debug)]
pub struct Offered {
    /// The module that has it.
    pub module: String,
    /// The word it is defined with: `joint`.
    pub word: String,
}

impl Program {
    /// Whether a text belongs to the library.
    pub(crate) fn is_library(&self, source: SourceId) -> bool {
        let module = self.modules.iter().find(|module| module.source == source);
        module.is_some_and(|module| is_library(&module.path))
    }

    /// The item behind an id of this program.
    pub fn item(&self, id: DefinitionId) -> Option<&ast::Item> {
        self.modules
            .get(id.module as usize)?
            .file
            .items
            .get(id.item as usize)
    }

    /// A word of a choice, by its place among the words.
    pub fn word(&self, choice: DefinitionId, place: u32) -> Option<&str> {
        match &self.item(choice)?.kind {
            ast::ItemKind::Choice(choice) => {
                let word = choice.words.get(place as usize)?;
                Some(&word.text)
            }
            _ => None,
        }
    }

    /// The definition of a name at the top level of a module.
    pub fn lookup(&self, module: u32, name: &str) -> Option<DefinitionId> {
        self.modules.get(module as usize)?.scope.get(name).copied()
    }

    /// The class that holds a flexible body with supports on the ground, if a text has one.
    pub(crate) fn weld(&self) -> Option<DefinitionId> {
        let interface = self.of_library(WELD)?;
        let items = &self.modules.get(interface.module as usize)?.file.items;
        let mut definitions =
            (0..items.len() as u32).map(|item| DefinitionId { item, ..interface });
        definitions.find(|id| {
            let joint = (self.declaration(*id)).is_some_and(|d| d.kind == ast::Kind::Joint);
            joint && self.fills(*id, interface)
        })
    }

    /// The interface of film laws; `None` if no module uses it.
    pub(crate) fn journal_law(&self) -> Option<DefinitionId> {
        self.of_library(JOURNAL_LAW)
    }

    /// The interface of the gas in a cylinder; `None` if no module uses it.
    pub(crate) fn gas_law(&self) -> Option<DefinitionId> {
        self.of_library(GAS_LAW)
    }

    fn of_library(&self, (path, name): (&str, &str)) -> Option<DefinitionId> {
        let module = self.modules.iter().position(|m| m.path == path)?;
        self.lookup(module as u32, name)
    }

    /// The definition behind an id.
    pub fn declaration(&self, id: DefinitionId) -> Option<&ast::Declaration> {
        match &self.item(id)?.kind {
            ast::ItemKind::Declaration(declaration) => Some(declaration),
            _ => None,
        }
    }

    /// The interface that a class, a record or an interface names after its colon: `: JournalLaw`.
    pub(crate) fn interface_of(&self, id: DefinitionId) -> Option<DefinitionId> {
        let name = interface_name(self.declaration(id)?)?;
        let interface = self.lookup(id.module, &name.text)?;
        (self.declaration(interface)?.kind == ast::Kind::Interface).then_some(interface)
    }

    /// The definitions whose text makes up a definition: its interfaces, the most general first, then
    /// itself.
    pub(crate) fn lineage(&self, id: DefinitionId) -> Vec<DefinitionId> {
        let mut found = vec![id];
        let mut most_specific = id;
        // an interface extends one that extends none, so a class has two interfaces at most
        for _ in 0..2 {
            let Some(interface) = self.interface_of(most_specific) else {
                break;
            };
            // interfaces that extend each other in a circle are reported by the checker
            if found.contains(&interface) {
                break;
            }
            found.insert(0, interface);
            most_specific = interface;
        }
        found
    }

    /// Whether a definition is an interface, or fills or extends it.
    pub(crate) fn fills(&self, id: DefinitionId, interface: DefinitionId) -> bool {
        self.lineage(id).contains(&interface)
    }

    /// Names of all lints that a text may accept: of the language, and of the `advise`s of all modules.
    pub fn lints(&self) -> BTreeSet<&str> {
        let mut names: BTreeSet<&str> = eng_system::lint::BUILT_IN.into_iter().collect();
        for module in &self.modules {
            lints_of(&module.file.items, &mut names);
        }
        names
    }

    /// The root module's index.
    pub fn root(&self) -> u32 {
        self.modules.len().saturating_sub(1) as u32
    }

    /// Size and dimension of a unit expression. `Err` has the place and name of an unknown unit.
    pub fn unit(&self, expr: &ast::UnitExpr) -> Result<Unit, (Span, String)> {
        let mut scale = 1.0;
        let mut dimension = Dimension::ONE;
        for factor in &expr.factors {
            let unit = self
                .units
                .get(&factor.name.text)
                .ok_or_else(|| (factor.name.span, factor.name.text.clone()))?;
            if expr.factors.len() == 1 && factor.numerator == 1 && factor.denominator == 1 {
                return Ok(unit.clone());
            }
            let exponent = f64::from(factor.numerator) / f64::from(factor.denominator);
            scale *= if exponent == 1.0 {
                unit.scale
            } else if exponent == -1.0 {
                1.0 / unit.scale
            } else {
                libm::pow(unit.scale, exponent)
            };
            dimension = dimension.times(
                unit.dimension
                    .power(factor.numerator, factor.denominator)
                    .unwrap_or(Dimension::ONE),
            );
        }
        Ok(Unit {
            symbol: unit_text(expr),
            scale,
            offset: 0.0,
            dimension,
            point: None,
        })
    }
}

/// The name after the colon of a class, a record or an interface.
pub(crate) fn interface_name(declaration: &ast::Declaration) -> Option<&ast::Name> {
    match &declaration.form {
        ast::Form::Class { interface, .. } | ast::Form::Plain { interface, .. } => {
            interface.as_ref()
        }
        ast::Form::Instance { .. } => None,
    }
}

fn lints_of<'p>(items: &'p [ast::Item], names: &mut BTreeSet<&'p str>) {
    for item in items {
        match &item.kind {
            ast::ItemKind::Statement(ast::Statement::Require {
                name: Some(name), ..
            }) => {
                names.insert(&name.text);
            }
            ast::ItemKind::Function(function) => names.extend(
                function
                    .requirements
                    .iter()
                    .filter_map(|r| r.name.as_ref())
                    .map(|name| name.text.as_str()),
            ),
            ast::ItemKind::Declaration(declaration) => {
                if let ast::Form::Class { block, .. } | ast::Form::Plain { block, .. } =
                    &declaration.form
                {
                    lints_of(&block.items, names);
                }
            }
            _ => {}
        }
    }
}

/// A unit expression as text: `kg*m/s^2`.
pub(crate) fn unit_text(expr: &ast::UnitExpr) -> String {
    let mut text = String::new();
    for factor in &expr.factors {
        let (n, d) = (factor.numerator, factor.denominator);
        if n < 0 {
            text.push_str(if text.is_empty() { "1/" } else { "/" });
        } else if !text.is_empty() {
            text.push('*');
        }
        text.push_str(&factor.name.text);
        match (n.abs(), d) {
            (1, 1) => {}
            (n, 1) => text.push_str(&format!("^{n}")),
            (n, d) => text.push_str(&format!("^({n}/{d})")),
        }
    }
    text
}

/// The checker's finding about a named value.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum ValueType {
    Scalar(Dimension),
    /// A vector in space.
    Vector(Dimension),
    /// A list of 2 or 3 components (or any other length).
    Components(u32, Dimension),
    Int,
    Bool,
    Text,
    /// A word of a choice.
    Choice(DefinitionId),
    Marker,
    Array(Box<ValueType>),
    /// Functions, records, classes.
    Other,
}
