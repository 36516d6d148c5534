//! Enums of kinds: each variant holds another type, and one trait unites these types. Stated arguments of a kind.

/// Makes an enum dereference to the trait of its variants, so that the questions of the trait are methods of the
/// enum.
macro_rules! dereferences {
    ($name:ident to $kind:ident: $($variant:ident)*) => {
        impl std::ops::Deref for $name {
            type Target = dyn $kind;

            fn deref(&self) -> &Self::Target {
                match self {
                    $($name::$variant(kind) => kind,)*
                }
            }
        }

        impl std::ops::DerefMut for $name {
            fn deref_mut(&mut self) -> &mut Self::Target {
                match self {
                    $($name::$variant(kind) => kind,)*
                }
            }
        }
    };
}

pub(crate) use dereferences;

/// The stated arguments of a kind. Each has the type of its row.
#[derive(Clone, Debug)]
pub struct Given<V>(Vec<(&'static str, V)>);

impl<V> Default for Given<V> {
    fn default() -> Given<V> {
        Given(Vec::new())
    }
}

impl<V> Given<V> {
    /// States an argument.
    pub fn state(&mut self, name: &'static str, value: V) {
        self.0.push((name, value));
    }

    /// The value of an argument, if the text states it.
    pub fn find(&self, wanted: &str) -> Option<&V> {
        let stated = self.0.iter().find(|(name, _)| *name == wanted);
        stated.map(|(_, value)| value)
    }
}
