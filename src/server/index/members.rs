//! The definitions inside of a definition: its members, and its parameters.

use super::{DEEPEST, Found, Index, What, is_kind, of_items};
use eng_grammar::ast::{
    BindingKind, Declaration, Expr, ExprKind, Form, Item, ItemKind, Kind, TypeExpr, TypeExprKind,
};

/// The members of a marker, with their meaning.
pub(in crate::server) const OF_MARKERS: [(&str, &str); 8] = [
    ("origin", "position of its origin"),
    ("x", "its first axis"),
    ("y", "its second axis"),
    ("z", "its third axis"),
    ("velocity", "velocity of its origin"),
    ("angular_velocity", "angular velocity"),
    ("acceleration", "acceleration of its origin"),
    ("angular_acceleration", "angular acceleration"),
];

impl Index<'_> {
    /// The class of a name that a module sees: a definition, or the one to which it gives some arguments.
    fn class(&self, number: usize, name: &str) -> Option<(usize, &Declaration)> {
        let mut at = self.look_up(number, name)?;
        for _ in 0..DEEPEST {
            let ItemKind::Declaration(declaration) = &at.item()?.kind else {
                return None;
            };
            match called(declaration) {
                Some(next) => at = self.look_up(at.module, next)?,
                None => return Some((at.module, declaration)),
            }
        }
        None
    }

    /// The definitions of the class that an instance uses; of an analysis, those of its model.
    pub(super) fn of_class<'i>(
        &'i self,
        number: usize,
        declaration: &Declaration,
    ) -> Vec<Found<'i>> {
        let class = called(declaration).and_then(|name| self.class(number, name));
        class.map_or_else(Vec::new, |(module, class)| self.inside(module, class))
    }

    /// The definitions inside of a declaration: its parameters, its block, and those of its interfaces.
    pub(super) fn inside<'i>(
        &'i self,
        number: usize,
        declaration: &'i Declaration,
    ) -> Vec<Found<'i>> {
        let mut found = Vec::new();
        let mut at = (number, declaration);
        for _ in 0..DEEPEST {
            let (number, declaration) = at;
            let interface = match &declaration.form {
                Form::Class {
                    parameters,
                    interface,
                    ..
                } => {
                    let parameters = parameters.iter().map(What::Parameter);
                    found.extend(parameters.map(|what| Found {
                        module: number,
                        what,
                    }));
                    interface.as_ref()
                }
                Form::Plain { interface, .. } => interface.as_ref(),
                Form::Instance { .. } => None,
            };
            if let Some(block) = declaration.block() {
                found.extend(of_items(number, &block.items));
            }
            let next = interface.and_then(|name| self.look_up(number, &name.text));
            match next {
                Some(Found {
                    module,
                    what: What::Item(item, _),
                }) => match &item.kind {
                    ItemKind::Declaration(declaration) => at = (module, declaration),
                    _ => break,
                },
                _ => break,
            }
        }
        found
    }

    /// The definitions after the dot of a definition.
    pub fn members<'i>(&'i self, found: Found<'i>) -> Vec<Found<'i>> {
        let module = found.module;
        let class = |name: &str| {
            let class = self.class(module, name);
            class.map_or_else(Vec::new, |(module, class)| self.inside(module, class))
        };
        let mut members = match found.what {
            What::Parameter(parameter) => type_name(&parameter.ty).map(class).unwrap_or_default(),
            What::Name(_) => Vec::new(),
            What::Item(item, _) => match &item.kind {
                ItemKind::Declaration(declaration) => match called(declaration) {
                    Some(_) => self.of_class(module, declaration),
                    None => self.inside(module, declaration),
                },
                ItemKind::Binding(binding) => {
                    // `const oil = Oil(…)` has no type in its text
                    let of_value = || binding.value.as_ref().and_then(callee);
                    let name = binding.ty.as_ref().and_then(type_name).or_else(of_value);
                    name.map(class).unwrap_or_default()
                }
                ItemKind::Choice(choice) => {
                    let words = choice.words.iter().map(What::Name);
                    words.map(|what| Found { module, what }).collect()
                }
                _ => Vec::new(),
            },
        };
        // the cycle of a model is read by the word `cycle`
        members.retain(|member| !is_kind(*member, &[Kind::Cycle]));
        members
    }

    /// Whether a definition has a reaction, `force` and `torque`: it is a joint or a drive.
    pub fn has_reaction(&self, found: Found<'_>) -> bool {
        is_kind(found, &[Kind::Joint, Kind::Drive])
    }

    /// Whether a definition is a marker, or a name for one.
    pub fn is_marker(&self, found: Found<'_>) -> bool {
        match found.what {
            What::Parameter(parameter) => type_name(&parameter.ty) == Some("Marker"),
            What::Name(_) => false,
            What::Item(item, _) => match &item.kind {
                ItemKind::Declaration(declaration) => declaration.kind == Kind::Marker,
                ItemKind::Binding(binding) => {
                    binding.ty.as_ref().and_then(type_name) == Some("Marker")
                }
                _ => false,
            },
        }
    }

    /// The parameters of a class, a model or a function.
    pub fn parameters<'i>(&'i self, found: Found<'i>) -> Vec<Found<'i>> {
        let mut found = found;
        // a function with some arguments of another one; a circle of them is a mistake
        for _ in 0..DEEPEST {
            let Some(ItemKind::Function(function)) = found.item().map(|item| &item.kind) else {
                break;
            };
            let name = function.value.as_ref().and_then(callee);
            let name = name.filter(|_| function.bound);
            match name.and_then(|name| self.look_up(found.module, name)) {
                Some(other) => found = other,
                None => break,
            }
        }
        let What::Item(item, _) = found.what else {
            return Vec::new();
        };
        match &item.kind {
            ItemKind::Function(function) => {
                let parameters = function.parameters.iter().map(What::Parameter);
                parameters
                    .map(|what| Found {
                        module: found.module,
                        what,
                    })
                    .collect()
            }
            ItemKind::Declaration(declaration) => {
                let bound = called(declaration).and_then(|name| self.class(found.module, name));
                let (module, class) = bound.unwrap_or((found.module, declaration));
                let mut inside = self.inside(module, class);
                inside.retain(|one| match one.what {
                    What::Parameter(_) => true,
                    What::Item(item, _) => is_parameter(item, class.kind),
                    What::Name(_) => false,
                });
                inside
            }
            _ => Vec::new(),
        }
    }
}

/// The class that a value calls: `Revolute(a, b)`; for an analysis, `transient(Engine(), …)`, its model.
fn called(declaration: &Declaration) -> Option<&str> {
    let Form::Instance { value, .. } = &declaration.form else {
        return None;
    };
    let ExprKind::Call { callee, arguments } = &value.kind else {
        return None;
    };
    if declaration.kind == Kind::Analysis {
        return self::callee(&arguments.first()?.value);
    }
    word(callee)
}

/// The name that a call calls.
fn callee(value: &Expr) -> Option<&str> {
    match &value.kind {
        ExprKind::Call { callee, .. } => word(callee),
        _ => None,
    }
}

fn word(value: &Expr) -> Option<&str> {
    match &value.kind {
        ExprKind::Name(name) => Some(name),
        _ => None,
    }
}

/// The name of a type, of its elements for an array.
fn type_name(ty: &TypeExpr) -> Option<&str> {
    match &ty.kind {
        TypeExprKind::Name(name) => Some(&name.text),
        TypeExprKind::Array(inner, _) => type_name(inner),
        _ => None,
    }
}

/// Whether an item in a block of a kind takes its value from an argument.
fn is_parameter(item: &Item, of: Kind) -> bool {
    match &item.kind {
        ItemKind::Binding(binding) => match binding.kind {
            BindingKind::Param | BindingKind::Const | BindingKind::Input => true,
            BindingKind::Let => of == Kind::Record,
            _ => false,
        },
        _ => false,
    }
}
