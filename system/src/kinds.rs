//! Enums of kinds: each variant holds another type, and one trait unites these types.

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
