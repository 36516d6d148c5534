//! Limits on the work of one elaboration. A text beyond them is refused.

use crate::codes;
use eng_grammar::Diagnostic;

/// Most instances of one model. A choice: engines have some hundred, and more are a loop that does not end.
const MOST_INSTANCES: usize = 20_000;
/// Deepest nesting of calls, lets and parts. A choice: texts have some ten, and the stack has room for this
/// depth.
const DEEPEST_USES: u32 = 100;
/// Most calls and named values that are evaluated for one model. Elaboration inserts a function at each call,
/// so thirty functions that each call the next one twice would be inserted a billion times. The number is a
/// choice.
const MOST_USES: usize = 1_000_000;

/// Work so far.
#[derive(Default)]
pub(super) struct Budget {
    depth: u32,
    instances: usize,
    /// Calls and named values evaluated so far.
    uses: usize,
}

impl Budget {
    /// Counts an instance.
    pub fn instance(&mut self) -> Result<(), Box<Diagnostic>> {
        self.instances += 1;
        if self.instances <= MOST_INSTANCES {
            return Ok(());
        }
        let message = Diagnostic::error(
            codes::TOO_MANY_INSTANCES,
            format!("the model has more than {MOST_INSTANCES} instances"),
        );
        Err(Box::new(message.with_help("Eng counts bodies, elements, parts and values of indices. Is a range longer than intended?")))
    }

    /// Counts a use, and enters one level. [`Budget::leave`] leaves it. An error without a message repeats
    /// one that has been reported.
    pub fn enter(&mut self) -> Result<(), Option<Box<Diagnostic>>> {
        if self.depth >= DEEPEST_USES {
            let message = Diagnostic::error(
                codes::ENDLESS,
                format!("more than {DEEPEST_USES} uses are nested in each other"),
            );
            return Err(Some(Box::new(
                message.with_help("does a function or a component use itself?"),
            )));
        }
        self.uses += 1;
        if self.uses > MOST_USES + 1 {
            return Err(None);
        }
        if self.uses > MOST_USES {
            let message = Diagnostic::error(
                codes::TOO_MANY_USES,
                format!(
                    "the compiler would insert functions and values of this model more than {MOST_USES} times"
                ),
            );
            return Err(Some(Box::new(message.with_help("where a function calls another one twice, give its value a name with `let` and use that twice"))));
        }
        self.depth += 1;
        Ok(())
    }

    /// Leaves a level.
    pub fn leave(&mut self) {
        self.depth -= 1;
    }
}
