//! Types in words.

use super::Checker;
use super::types::{Dim, Kind as PointKind, Quantity, Signature, Type};
use crate::program::{DefinitionId, USUAL_UNITS};
use crate::resolve::suggest::LONGEST_COMPARED;
pub(super) use crate::typed::kind_words::{kind_word, with_article};

use eng_system::Dimension;

/// Preferred names for exponents that several dimensions share.
const PREFERRED: [&str; 18] = [
    "Length",
    "Mass",
    "Time",
    "Angle",
    "Force",
    "Pressure",
    "Velocity",
    "AngularVelocity",
    "Acceleration",
    "Power",
    "Area",
    "Volume",
    "Density",
    "DynamicViscosity",
    "Frequency",
    "Stiffness",
    "TemperatureDifference",
    "AngularAcceleration",
];

/// The likely meaning of an unknown unit. Among equally near units it is one of the same length, and a usual one.
/// Fewer letters may differ than in [`nearest`](crate::resolve::suggest::nearest), because units are short. Case
/// counts, because `mW` and `MW` are two units.
pub(super) fn nearest_unit<'a>(
    name: &str,
    known: impl Iterator<Item = &'a String>,
) -> Option<String> {
    let length = name.chars().take(LONGEST_COMPARED + 1).count();
    if length > LONGEST_COMPARED {
        return None;
    }
    let allowed = if length < 2 { 0 } else { (length / 3).max(1) };
    known
        .map(|unit| {
            let usual = USUAL_UNITS.iter().position(|u| u == unit);
            (
                strsim::damerau_levenshtein(name, unit),
                unit.chars().count().abs_diff(length),
                usual.unwrap_or(USUAL_UNITS.len()),
                unit,
            )
        })
        .filter(|(distance, ..)| *distance <= allowed)
        .min()
        .map(|(.., unit)| unit.clone())
}

/// Whether a dimension is a base dimension. A surplus is named only in this simple case.
fn is_base(dimension: Dimension) -> bool {
    (0..eng_system::dimension::BASES).any(|base| dimension == Dimension::base(base))
}

impl Checker<'_> {
    /// The names of all dimensions with the same exponents, without points.
    fn names_of(&self, dimension: Dimension) -> Vec<&str> {
        let all: Vec<&str> = self
            .program
            .dimensions
            .iter()
            .filter(|(_, named)| named.dimension == dimension && named.point_of.is_none())
            .map(|(name, _)| name.as_str())
            .collect();
        match all.iter().find(|name| PREFERRED.contains(name)) {
            Some(name) => vec![name],
            None => all.into_iter().take(3).collect(),
        }
    }

    /// `Length`, `Energy or Torque`, `kg/s^4`, `D^2*Length`.
    pub(super) fn dimension_name(&self, dim: &Dim) -> String {
        if dim.is_known() {
            if dim.base.is_one() {
                return "number".to_owned();
            }
            let names = self.names_of(dim.base);
            return if names.is_empty() {
                dim.base.to_string()
            } else {
                names.join(" or ")
            };
        }
        let mut text = String::new();
        for (number, exponent) in dim.variables() {
            if !text.is_empty() {
                text.push('*');
            }
            let name = self.variables.get(*number as usize);
            text.push_str(name.map_or("?", String::as_str));
            match (*exponent, exponent % 60) {
                (60, _) => {}
                (whole, 0) => text.push_str(&format!("^{}", whole / 60)),
                (part, _) => text.push_str(&format!("^({part}/60)")),
            }
        }
        if !dim.base.is_one() {
            text.push('*');
            text.push_str(&self.dimension_name(&Dim::known(dim.base)));
        }
        text
    }

    /// The name with the SI base units: `Pressure (kg/m/s^2)`.
    pub(super) fn quantity_in_full(&self, quantity: &Quantity) -> String {
        let name = self.quantity_name(quantity);
        if !quantity.dim.is_known() {
            return name;
        }
        let si = quantity.dim.base.to_string();
        if quantity.dim.is_one() || name == si {
            name
        } else {
            format!("{name} ({si})")
        }
    }

    pub(super) fn quantity_name(&self, quantity: &Quantity) -> String {
        match &quantity.kind {
            PointKind::Point(name) => name.to_string(),
            _ => self.dimension_name(&quantity.dim),
        }
    }

    /// The base dimension by which a exceeds b.
    pub(super) fn surplus(&self, a: &Quantity, b: &Quantity) -> Option<String> {
        let ratio = a.dim.over(&b.dim);
        (ratio.is_known() && is_base(ratio.base)).then(|| self.dimension_name(&ratio))
    }

    /// The unit in the declaration itself, or a usual one.
    pub(super) fn unit_for(&self, own: Option<&str>, wanted: &Quantity) -> Option<String> {
        if !wanted.dim.is_known() {
            return None;
        }
        own.filter(|unit| {
            let size = self.program.unit_of_text(unit);
            size.is_some_and(|unit| unit.dimension == wanted.dim.base)
        })
        .map(str::to_owned)
        .or_else(|| self.usual_unit(wanted))
    }

    pub(super) fn class_name(&self, id: DefinitionId) -> String {
        self.declaration(id)
            .map_or_else(|| "class".to_owned(), |d| d.name.text.clone())
    }

    /// A noun with its article: `a Length`, `a vector of Force`, `the class Revolute`.
    pub(super) fn describe(&self, ty: &Type) -> String {
        match ty {
            Type::Error => "something in error".to_owned(),
            Type::Int => "a whole number".to_owned(),
            Type::Bool => "true or false".to_owned(),
            Type::Text => "a text".to_owned(),
            Type::Choice(id) => {
                let choice = self.choice(*id).map_or("", |choice| &choice.name.text);
                format!("a word of the choice `{choice}`")
            }
            Type::ModeSet => "a mode set".to_owned(),
            Type::Scalar(quantity) if quantity.dim.is_one() => "a plain number".to_owned(),
            Type::Scalar(quantity) => with_article(&self.quantity_name(quantity)),
            Type::Signal { quantity, .. } => {
                format!("a signal of {}", self.quantity_name(quantity))
            }
            Type::Vector { quantity, .. } if quantity.dim.is_one() => {
                "a vector of numbers".to_owned()
            }
            Type::Vector { quantity, .. } => {
                format!("a vector of {}", self.quantity_name(quantity))
            }
            Type::List {
                element,
                length,
                framed,
            } => {
                let axes = if *framed {
                    " along a marker's axes"
                } else {
                    ""
                };
                let of = self.describe_several(element);
                match length {
                    Some(length) => format!("a list of {length} {of}{axes}"),
                    None => format!("a list of {of}{axes}"),
                }
            }
            Type::Range(_) => "a range".to_owned(),
            Type::Marker => "a marker".to_owned(),
            Type::Body(_) => "a body".to_owned(),
            Type::Function(signature) if signature.name.is_empty() => {
                format!(
                    "a function of {} that gives {}",
                    self.parameters_of(signature),
                    self.describe(&signature.result)
                )
            }
            Type::Function(signature) => format!("the function `{}`", signature.name),
            Type::Bound(bound) => {
                format!(
                    "the class `{}` with arguments",
                    self.class_name(bound.class)
                )
            }
            Type::Class(id) => match self.declaration(*id) {
                Some(declaration) => format!(
                    "the {} `{}`",
                    kind_word(declaration.kind),
                    declaration.name.text
                ),
                None => "a class".to_owned(),
            },
            Type::ClassOf(id) => format!("a class of the interface `{}`", self.class_name(*id)),
            Type::Instance(id) | Type::InstanceOf(id) => {
                with_article(&format!("`{}`", self.class_name(*id)))
            }
            Type::Cycle => "the cycle".to_owned(),
        }
    }

    /// Elements of a list: `numbers`, `Force`, `classes of the interface …`. Names of dimensions and records
    /// have no plural.
    fn describe_several(&self, element: &Type) -> String {
        let each = |one: &str, many: &str| {
            let noun = self.describe(element);
            match noun.strip_prefix(one) {
                Some(rest) => format!("{many}{rest}"),
                None => noun,
            }
        };
        match element {
            Type::Scalar(quantity) if !quantity.dim.is_one() => self.quantity_name(quantity),
            Type::Scalar(_) => "numbers".to_owned(),
            Type::Int => "whole numbers".to_owned(),
            Type::Bool => "truth values".to_owned(),
            Type::Text => "texts".to_owned(),
            Type::Marker => "markers".to_owned(),
            Type::Body(_) => "bodies".to_owned(),
            Type::ModeSet => "mode sets".to_owned(),
            Type::Class(_) | Type::Bound(_) => "classes".to_owned(),
            Type::Function(signature) if signature.name.is_empty() => {
                format!(
                    "functions of {} that give {}",
                    self.parameters_of(signature),
                    self.describe(&signature.result)
                )
            }
            Type::Function(_) => "functions".to_owned(),
            Type::ClassOf(_) => each("a class", "classes"),
            Type::Choice(_) => each("a word", "words"),
            Type::Signal { .. } => each("a signal", "signals"),
            Type::Vector { .. } => each("a vector", "vectors"),
            Type::List { .. } => each("a list", "lists"),
            Type::Range(_) => "ranges".to_owned(),
            Type::Instance(id) | Type::InstanceOf(id) => format!("`{}`", self.class_name(*id)),
            Type::Cycle | Type::Error => self.describe(element),
        }
    }

    /// The parameters of a function without a name: `a Length and a Time`.
    fn parameters_of(&self, signature: &Signature) -> String {
        let parameters = signature.parameters.iter();
        let parameters: Vec<String> = parameters.map(|p| self.describe(&p.ty)).collect();
        parameters.join(" and ")
    }

    /// The usual unit of a dimension.
    pub(super) fn usual_unit(&self, quantity: &Quantity) -> Option<String> {
        let dimension = quantity.dim.base;
        if let PointKind::Point(name) = &quantity.kind
            && let Some(unit) = self
                .program
                .units
                .values()
                .find(|unit| unit.point.as_deref() == Some(name))
        {
            return Some(unit.symbol.clone());
        }
        self.program.usual_unit(dimension).map(|unit| unit.symbol)
    }
}
