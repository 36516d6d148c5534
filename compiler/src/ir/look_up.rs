//! Look-ups of tables.

use eng_system::table::{MOST_ARGUMENTS, Outside, Table};

/// The number of arguments of a look-up, and the order of the derivative in each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Orders {
    count: u8,
    orders: [u8; MOST_ARGUMENTS],
}

impl Orders {
    /// The largest order in one argument: tables are piecewise cubic.
    const HIGHEST_ORDER: u8 = 3;

    /// The value over some arguments; those beyond the largest number of a table do not count.
    pub fn of_value(arguments: usize) -> Orders {
        Orders {
            count: arguments.min(MOST_ARGUMENTS) as u8,
            orders: [0; MOST_ARGUMENTS],
        }
    }

    /// One derivative more with respect to an argument; `None` where it is zero.
    pub fn raised(mut self, argument: usize) -> Option<Orders> {
        let order = self.orders.get_mut(argument)?;
        *order += 1;
        (*order <= Self::HIGHEST_ORDER).then_some(self)
    }

    /// The order in each argument.
    pub fn each(&self) -> &[u8] {
        self.orders.get(..self.arguments()).unwrap_or_default()
    }

    /// Number of arguments.
    pub fn arguments(&self) -> usize {
        usize::from(self.count)
    }
}

/// Orders as one number, in which machine code passes them to the look-up.
#[cfg(feature = "jit")]
impl Orders {
    /// The number of these orders.
    pub(crate) fn packed(self) -> u64 {
        let [a, b, c] = self.orders;
        u64::from(u32::from_le_bytes([self.count, a, b, c]))
    }

    /// The orders of a number of [`Orders::packed`].
    pub(crate) fn unpacked(packed: u64) -> Orders {
        let [count, a, b, c, ..] = packed.to_le_bytes();
        Orders {
            count: count.min(MOST_ARGUMENTS as u8),
            orders: [a, b, c],
        }
    }
}

/// The table of a handle.
fn table_of(tables: &[Table], handle: f64) -> Option<&Table> {
    // the comparison also excludes NaN
    (handle >= 0.0 && handle < tables.len() as f64).then(|| tables.get(handle as usize))?
}

/// The value or a derivative of a table by its handle; NaN if there is none. Arguments beyond those of `orders`
/// do not count. Without an argument it is the period over the first one, or zero where the table has none.
pub(crate) fn look_up(
    tables: &[Table],
    handle: f64,
    arguments: &[f64; MOST_ARGUMENTS],
    orders: Orders,
) -> f64 {
    let Some(table) = table_of(tables, handle) else {
        return f64::NAN;
    };
    match arguments.get(..orders.arguments()) {
        None | Some([]) => table.period(0).unwrap_or(0.0),
        Some(arguments) => table.evaluate(arguments, orders.each()),
    }
}

/// Whether a look-up is outside the points of its table.
pub(crate) fn outside(
    tables: &[Table],
    handle: f64,
    arguments: &[f64; MOST_ARGUMENTS],
    orders: Orders,
) -> Option<Outside> {
    let arguments = arguments
        .get(..orders.arguments())
        .filter(|arguments| !arguments.is_empty())?;
    table_of(tables, handle)?.outside(arguments)
}
