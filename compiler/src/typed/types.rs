//! Types of values, and the arithmetic of dimensions: dimension variables, angles that a computed value may drop,
//! and points.

use crate::program::{DefinitionId, ValueType};
use eng_grammar::Span;
use eng_system::Dimension;
use std::sync::Arc;

/// Exponents of dimension variables are stored as multiples of 1/60, like those of the bases.
const DENOMINATOR: i32 = 60;

/// A dimension that may contain the variables of generic functions.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Dim {
    /// The known part.
    pub base: Dimension,
    /// Variables with their exponents in 1/60, by number, none zero.
    variables: Vec<(u32, i32)>,
}

impl Dim {
    /// A dimension without variables.
    pub fn known(base: Dimension) -> Dim {
        Dim {
            base,
            variables: Vec::new(),
        }
    }

    /// The variable of a number, with the exponent 1.
    pub fn variable(number: u32) -> Dim {
        Dim {
            base: Dimension::ONE,
            variables: vec![(number, DENOMINATOR)],
        }
    }

    /// Its variables with their exponents in 1/60, by number.
    pub fn variables(&self) -> &[(u32, i32)] {
        &self.variables
    }

    /// Whether it has no variable.
    pub fn is_known(&self) -> bool {
        self.variables.is_empty()
    }

    /// Whether it is the dimension of a plain number, without variables.
    pub fn is_one(&self) -> bool {
        self.base.is_one() && self.variables.is_empty()
    }

    /// The dimension of a product.
    pub fn times(&self, other: &Dim) -> Dim {
        let mut variables = self.variables.clone();
        for (number, exponent) in &other.variables {
            match variables.iter_mut().find(|(n, _)| n == number) {
                Some((_, e)) => *e += exponent,
                None => variables.push((*number, *exponent)),
            }
        }
        variables.retain(|(_, e)| *e != 0);
        variables.sort_unstable();
        Dim {
            base: self.base.times(other.base),
            variables,
        }
    }

    /// The dimension of a quotient.
    pub fn over(&self, other: &Dim) -> Dim {
        match other.power(-1, 1) {
            Some(inverse) => self.times(&inverse),
            None => self.clone(),
        }
    }

    /// The dimension of a power with a rational exponent, or none if an exponent cannot be stored.
    pub fn power(&self, numerator: i32, denominator: i32) -> Option<Dim> {
        let base = self.base.power(numerator, denominator)?;
        let mut variables = Vec::new();
        for (number, exponent) in &self.variables {
            let product = exponent.checked_mul(numerator)?;
            if product % denominator != 0 {
                return None;
            }
            if product != 0 {
                variables.push((*number, product / denominator));
            }
        }
        Some(Dim { base, variables })
    }

    /// The same without the exponent of the angle.
    pub fn without_angle(&self) -> Dim {
        Dim {
            base: self.base.without_angle(),
            variables: self.variables.clone(),
        }
    }

    /// Whether nothing or only an angle is left.
    pub fn is_plain(&self) -> bool {
        self.variables.is_empty() && self.base.without_angle().is_one()
    }

    /// The dimension with the solved variables replaced.
    pub fn with(&self, solved: &Solution) -> Dim {
        let mut result = Dim::known(self.base);
        for (number, exponent) in &self.variables {
            let factor = match solved.get(*number) {
                Some(quantity) => quantity.dim.power(*exponent, DENOMINATOR),
                None => Dim::variable(*number).power(*exponent, DENOMINATOR),
            };
            if let Some(factor) = factor {
                result = result.times(&factor);
            }
        }
        result
    }
}

/// The quantities of a generic function's variables at one call.
#[derive(Clone, Debug, Default)]
pub struct Solution {
    solved: Vec<(u32, Quantity)>,
}

impl Solution {
    pub fn get(&self, number: u32) -> Option<&Quantity> {
        self.solved
            .iter()
            .find(|(n, _)| *n == number)
            .map(|(_, quantity)| quantity)
    }

    pub fn is_empty(&self) -> bool {
        self.solved.is_empty()
    }

    /// This solution with the variables that only `other` has.
    pub fn and(mut self, other: &Solution) -> Solution {
        for (number, quantity) in &other.solved {
            if self.get(*number).is_none() {
                self.solved.push((*number, quantity.clone()));
            }
        }
        self
    }

    /// This solution with the variables of the surrounding function replaced by those of `outer`.
    pub fn within(&self, outer: &Solution) -> Solution {
        let solved = self.solved.iter();
        Solution {
            solved: solved.map(|(n, q)| (*n, q.with(outer))).collect(),
        }
    }

    pub fn set(&mut self, number: u32, quantity: Quantity) {
        match self.solved.iter_mut().find(|(n, _)| *n == number) {
            Some((_, old)) => *old = quantity,
            None => self.solved.push((number, quantity)),
        }
    }
}

/// Whether a quantity is a point (a temperature) or a difference of points.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum Kind {
    /// Either: a literal, a computed value, or a dimension without points.
    #[default]
    Any,
    /// Declared by a dimension that has points, or computed as a difference.
    Difference,
    /// Declared as a point of this dimension.
    Point(Arc<str>),
}

impl Kind {
    /// The kind of the size or the negative. A point becomes a difference, because its zero is lost.
    pub fn of_size(&self) -> Kind {
        match self {
            Kind::Point(_) => Kind::Any,
            kind => kind.clone(),
        }
    }
}

/// A dimension with the kind of its angle and of its zero.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Quantity {
    /// Its dimension.
    pub dim: Dim,
    /// Whether it is computed from other quantities. Then its angle may be dropped.
    pub soft: bool,
    /// Whether it is a point or a difference.
    pub kind: Kind,
}

/// The reason why two quantities do not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Misfit {
    /// Other exponents.
    Dimension,
    /// Only the exponent of the angle differs, and both are declared.
    Angle,
    /// A point and a difference, or points of two kinds.
    Point,
}

impl Quantity {
    /// A declared plain number.
    pub const fn one() -> Quantity {
        Quantity {
            dim: Dim {
                base: Dimension::ONE,
                variables: Vec::new(),
            },
            soft: false,
            kind: Kind::Any,
        }
    }

    /// A declared quantity of a dimension without points.
    pub fn hard(base: Dimension) -> Quantity {
        Quantity {
            dim: Dim::known(base),
            soft: false,
            kind: Kind::Any,
        }
    }

    /// A computed quantity.
    pub fn soft(dim: Dim) -> Quantity {
        Quantity {
            dim,
            soft: true,
            kind: Kind::Any,
        }
    }

    /// Whether it is a plain number, which does not change the other factor's angle.
    pub fn is_plain_number(&self) -> bool {
        self.dim.is_one() && !self.soft
    }

    /// The quantity of a difference of two such values.
    pub fn difference(&self) -> Quantity {
        Quantity {
            kind: match &self.kind {
                Kind::Point(_) => Kind::Difference,
                other => other.clone(),
            },
            ..self.clone()
        }
    }

    fn misfit_of_dimension(&self, other: &Quantity) -> Option<Misfit> {
        if self.dim == other.dim {
            None
        } else if self.dim.without_angle() == other.dim.without_angle() {
            (!self.soft && !other.soft).then_some(Misfit::Angle)
        } else {
            Some(Misfit::Dimension)
        }
    }

    /// Checks that this quantity fits an expected one.
    pub fn fits(&self, expected: &Quantity) -> Result<(), Misfit> {
        if let Some(misfit) = self.misfit_of_dimension(expected) {
            return Err(misfit);
        }
        match (&self.kind, &expected.kind) {
            (Kind::Any, _) | (_, Kind::Any) => Ok(()),
            (a, b) if a == b => Ok(()),
            _ => Err(Misfit::Point),
        }
    }

    /// The common quantity of alternatives (`max(a, b)`, `if`, a list).
    pub fn join(&self, other: &Quantity) -> Result<Quantity, Misfit> {
        self.fits(other)?;
        let kind = match (&self.kind, &other.kind) {
            (Kind::Any, kind) => kind.clone(),
            (kind, _) => kind.clone(),
        };
        let (dim, soft) = self.angle_with(other);
        Ok(Quantity { dim, soft, kind })
    }

    /// The dimension of the quantity whose angle is declared, this one first, and whether both angles are
    /// computed.
    fn angle_with(&self, other: &Quantity) -> (Dim, bool) {
        if self.soft && !other.soft {
            (other.dim.clone(), false)
        } else {
            (self.dim.clone(), self.soft && other.soft)
        }
    }

    /// A sum or difference.
    pub fn plus(&self, other: &Quantity, minus: bool) -> Result<Quantity, Misfit> {
        if let Some(misfit) = self.misfit_of_dimension(other) {
            return Err(misfit);
        }
        let kind = match (&self.kind, &other.kind, minus) {
            (Kind::Point(a), Kind::Point(b), true) if a == b => Kind::Difference,
            (Kind::Point(_), Kind::Point(_), _) => return Err(Misfit::Point),
            (Kind::Point(p), Kind::Difference, _) => Kind::Point(p.clone()),
            // a literal or computed value is read as the fitting kind; subtracted from a point it may be
            // either
            (Kind::Point(p), Kind::Any, false) => Kind::Point(p.clone()),
            (Kind::Point(_), Kind::Any, true) => Kind::Any,
            (Kind::Difference, Kind::Point(p), false) => Kind::Point(p.clone()),
            (Kind::Difference, Kind::Point(_), true) => return Err(Misfit::Point),
            (Kind::Any, Kind::Point(p), false) => Kind::Point(p.clone()),
            (Kind::Any, Kind::Point(_), true) => Kind::Difference,
            (Kind::Difference, Kind::Difference, _) => Kind::Difference,
            // a point cannot be subtracted from a difference, so both are differences
            (Kind::Difference, Kind::Any, true) => Kind::Difference,
            (Kind::Difference, Kind::Any, false)
            | (Kind::Any, Kind::Difference, _)
            | (Kind::Any, Kind::Any, _) => Kind::Any,
        };
        let (dim, soft) = self.angle_with(other);
        Ok(Quantity { dim, soft, kind })
    }

    fn soft_with(&self, other: &Quantity) -> bool {
        let numbers = self.is_plain_number() || other.is_plain_number();
        !numbers || self.soft || other.soft
    }

    /// A product.
    pub fn times(&self, other: &Quantity) -> Quantity {
        // a multiple of a difference is a difference
        let kind = match (&self.kind, &other.kind) {
            (Kind::Difference, _) if other.dim.is_one() => Kind::Difference,
            (_, Kind::Difference) if self.dim.is_one() => Kind::Difference,
            _ => Kind::Any,
        };
        Quantity {
            dim: self.dim.times(&other.dim),
            soft: self.soft_with(other),
            kind,
        }
    }

    /// A quotient.
    pub fn over(&self, other: &Quantity) -> Quantity {
        let kind = match &self.kind {
            Kind::Difference if other.dim.is_one() => Kind::Difference,
            _ => Kind::Any,
        };
        Quantity {
            dim: self.dim.over(&other.dim),
            soft: self.soft_with(other),
            kind,
        }
    }

    /// The quantity with its solved variables replaced. A lone variable `D` also takes the angle and the kind of its
    /// solution.
    pub fn with(&self, solved: &Solution) -> Quantity {
        if self.dim.base.is_one()
            && let [(number, DENOMINATOR)] = self.dim.variables.as_slice()
            && let Some(solution) = solved.get(*number)
        {
            return solution.clone();
        }
        let soft_solution = self
            .dim
            .variables
            .iter()
            .any(|(number, _)| solved.get(*number).is_some_and(|q| q.soft));
        Quantity {
            dim: self.dim.with(solved),
            soft: self.soft || soft_solution,
            kind: self.kind.clone(),
        }
    }
}

/// A body in a definition.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct BodyRef {
    pub definition: DefinitionId,
    pub name: String,
}

/// A parameter of a function.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionParameter {
    pub name: String,
    pub ty: Type,
    pub optional: bool,
    pub span: Span,
}

/// The signature of a function.
#[derive(Clone, Debug, PartialEq)]
pub struct Signature {
    pub name: String,
    pub parameters: Vec<FunctionParameter>,
    pub result: Type,
}

/// The rows of a signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SignalRows {
    /// Each sample of a run.
    Samples,
    /// The one state of an analysis, such as an equilibrium. Where a number is due, it is a number.
    State,
    /// Each mode of this linear analysis.
    Modes(Arc<str>),
    /// Each frequency of this response.
    Frequencies(Arc<str>),
}

impl SignalRows {
    /// The analysis whose rows are no samples.
    pub fn of_analysis(&self) -> Option<&str> {
        match self {
            SignalRows::Modes(analysis) | SignalRows::Frequencies(analysis) => Some(analysis),
            SignalRows::Samples | SignalRows::State => None,
        }
    }

    /// The plural of the rows, for messages.
    pub fn words(&self) -> &'static str {
        match self {
            SignalRows::Modes(_) => "modes",
            SignalRows::Frequencies(_) => "frequencies",
            SignalRows::Samples => "samples",
            SignalRows::State => "one state",
        }
    }
}

/// A class with some of its arguments: `Impedance(viscosity: 10 mPa*s)`.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundClass {
    pub class: DefinitionId,
    /// The parameters that have an argument, by their numbers in the class, with the places of the arguments.
    pub given: Vec<(usize, Span)>,
}

/// The type of a value.
#[derive(Clone, Debug, PartialEq)]
pub enum Type {
    /// The type of an expression with a reported error.
    Error,
    Int,
    Bool,
    Text,
    Scalar(Quantity),
    /// `Signal<D>`: numbers of results, one in each row.
    Signal {
        quantity: Quantity,
        rows: SignalRows,
    },
    /// A vector in space. `framed`: it is an output that states its axes.
    Vector {
        quantity: Quantity,
        framed: bool,
    },
    /// An array, or components if the elements are scalars. `framed`: they are along a marker's axes.
    List {
        element: Box<Type>,
        length: Option<u32>,
        framed: bool,
    },
    /// `1..5`: the range of a binder.
    Range(Box<Type>),
    Marker,
    /// A body; `None` for the parameter type `Body`.
    Body(Option<BodyRef>),
    Function(Arc<Signature>),
    /// A class, record, component or model itself.
    Class(DefinitionId),
    /// A class known only by its interface.
    ClassOf(DefinitionId),
    /// A class with some of its arguments.
    Bound(Arc<BoundClass>),
    /// An instance of a class, or a record.
    Instance(DefinitionId),
    /// An instance of a class known only by its interface.
    InstanceOf(DefinitionId),
    Cycle,
    /// Modes of a flexible body.
    ModeSet,
    /// A word of a choice.
    Choice(DefinitionId),
}

impl Type {
    pub fn one() -> Type {
        Type::Scalar(Quantity::one())
    }

    pub fn list(element: Type, length: Option<u32>) -> Type {
        Type::List {
            element: Box::new(element),
            length,
            framed: false,
        }
    }

    pub fn vector(quantity: Quantity) -> Type {
        Type::Vector {
            quantity,
            framed: false,
        }
    }

    pub fn is_error(&self) -> bool {
        match self {
            Type::Error => true,
            Type::List { element, .. } | Type::Range(element) => element.is_error(),
            _ => false,
        }
    }

    /// A number's quantity; whole numbers are plain numbers too.
    pub fn quantity(&self) -> Option<Quantity> {
        match self {
            Type::Int => Some(Quantity::one()),
            Type::Scalar(quantity) => Some(quantity.clone()),
            _ => None,
        }
    }

    /// The type of a signal in one row. Any other value is the same in all rows.
    pub fn row(&self) -> Type {
        match self {
            Type::Signal { quantity, .. } => Type::Scalar(quantity.clone()),
            other => other.clone(),
        }
    }

    /// The signal that has a number of this type in each row.
    pub fn in_rows(&self, rows: &SignalRows) -> Type {
        match self.quantity() {
            Some(quantity) => Type::Signal {
                quantity,
                rows: rows.clone(),
            },
            None => self.clone(),
        }
    }

    /// The quantity of each number in a number, a truth value (1 or 0), a signal, a vector, a list or a range.
    pub fn each(&self) -> Option<Quantity> {
        match self {
            Type::Bool => Some(Quantity::one()),
            Type::Signal { quantity, .. } | Type::Vector { quantity, .. } => Some(quantity.clone()),
            Type::List { element, .. } | Type::Range(element) => element.each(),
            other => other.quantity(),
        }
    }

    /// The quantity of a list of numbers, and its length.
    pub fn components(&self) -> Option<(Quantity, Option<u32>)> {
        match self {
            Type::List {
                element, length, ..
            } => Some((element.quantity()?, *length)),
            _ => None,
        }
    }

    /// The type with the solved variables replaced.
    pub fn with(&self, solved: &Solution) -> Type {
        match self {
            Type::Scalar(quantity) => Type::Scalar(quantity.with(solved)),
            Type::Vector { quantity, framed } => Type::Vector {
                quantity: quantity.with(solved),
                framed: *framed,
            },
            Type::List {
                element,
                length,
                framed,
            } => Type::List {
                element: Box::new(element.with(solved)),
                length: *length,
                framed: *framed,
            },
            Type::Range(element) => Type::Range(Box::new(element.with(solved))),
            Type::Function(signature) => {
                let mut signature = Signature::clone(signature);
                signature.result = signature.result.with(solved);
                for parameter in &mut signature.parameters {
                    parameter.ty = parameter.ty.with(solved);
                }
                Type::Function(Arc::new(signature))
            }
            other => other.clone(),
        }
    }

    /// The form of the type for later stages.
    pub fn exported(&self) -> ValueType {
        match self {
            Type::Int => ValueType::Int,
            Type::Bool => ValueType::Bool,
            Type::Text => ValueType::Text,
            Type::Marker => ValueType::Marker,
            Type::Choice(id) => ValueType::Choice(*id),
            Type::Scalar(quantity) => ValueType::Scalar(quantity.dim.base),
            Type::Vector { quantity, .. } => ValueType::Vector(quantity.dim.base),
            Type::List {
                element, length, ..
            } => match (element.as_ref(), length) {
                (Type::Scalar(quantity), Some(length)) => {
                    ValueType::Components(*length, quantity.dim.base)
                }
                (element, _) => ValueType::Array(Box::new(element.exported())),
            },
            _ => ValueType::Other,
        }
    }
}
