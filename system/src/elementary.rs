//! The elementary functions of one number: interpreter, machine code and reports compute them by this table.

use std::fmt;

/// Passes the table to a macro: the variant, the name in the language, the function.
#[macro_export]
macro_rules! elementary_functions {
    ($into:ident) => {
        $into! {
            Sin "sin" libm::sin;
            Cos "cos" libm::cos;
            Tan "tan" libm::tan;
            Asin "asin" libm::asin;
            Acos "acos" libm::acos;
            Atan "atan" libm::atan;
            Tanh "tanh" libm::tanh;
            Exp "exp" libm::exp;
            Log "log" libm::log;
            // no function of the language: the result of an iteration, whose derivative comes from elsewhere
            Held "held" $crate::elementary::held;
        }
    };
}

macro_rules! define {
    ($($variant:ident $name:literal $function:path;)*) => {
        /// A function of one number.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[allow(missing_docs)]
        pub enum Elementary {
            $($variant,)*
        }

        impl Elementary {
            /// All of them.
            pub const ALL: &[Elementary] = &[$(Elementary::$variant,)*];

            /// Its name in the language.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Elementary::$variant => $name,)*
                }
            }

            /// Its value, with the same bits on every machine; NaN outside its domain. Angles are in rad.
            pub fn value(self, x: f64) -> f64 {
                match self {
                    $(Elementary::$variant => $function(x),)*
                }
            }
        }
    };
}

/// The number itself.
pub fn held(x: f64) -> f64 {
    x
}

elementary_functions!(define);

impl fmt::Display for Elementary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
