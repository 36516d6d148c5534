//! Dimensions, display units and quantities.

use crate::significant::short;
use serde::{Deserialize, Serialize};

/// Exponents are stored as multiples of 1/60, so that square and cube roots stay exact.
const DENOMINATOR: i32 = 60;

/// Number of base dimensions: length, mass, time, current, temperature, amount, luminous intensity, angle.
pub const BASES: usize = 8;

/// SI symbols of the bases, in storage order.
pub const BASE_SYMBOLS: [&str; BASES] = ["m", "kg", "s", "A", "K", "mol", "cd", "rad"];

/// A physical dimension: rational exponents of the bases. Angle is a base here. The checker decides where it
/// may be dropped.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize,
)]
pub struct Dimension {
    exponents: [i16; BASES],
}

impl Dimension {
    /// Dimensionless.
    pub const ONE: Dimension = Dimension {
        exponents: [0; BASES],
    };
    /// Length.
    pub const LENGTH: Dimension = Self::base(0);
    /// Mass.
    pub const MASS: Dimension = Self::base(1);
    /// Time.
    pub const TIME: Dimension = Self::base(2);
    /// Angle.
    pub const ANGLE: Dimension = Self::base(7);

    /// Acceleration.
    pub const ACCELERATION: Dimension = {
        let mut exponents = Self::LENGTH.exponents;
        exponents[2] = -2 * DENOMINATOR as i16;
        Dimension { exponents }
    };
    /// Force.
    pub const FORCE: Dimension = {
        let mut exponents = Self::ACCELERATION.exponents;
        exponents[1] = DENOMINATOR as i16;
        Dimension { exponents }
    };

    /// The product of whole powers of length, mass, time and angle.
    pub const fn of_mechanics(length: i16, mass: i16, time: i16, angle: i16) -> Dimension {
        let mut exponents = [0; BASES];
        exponents[0] = length * DENOMINATOR as i16;
        exponents[1] = mass * DENOMINATOR as i16;
        exponents[2] = time * DENOMINATOR as i16;
        exponents[BASES - 1] = angle * DENOMINATOR as i16;
        Dimension { exponents }
    }

    /// The base at a storage index below [`BASES`]; dimensionless for an index beyond.
    pub const fn base(index: usize) -> Dimension {
        let mut exponents = [0; BASES];
        if index < BASES {
            exponents[index] = DENOMINATOR as i16;
        }
        Dimension { exponents }
    }

    /// Exponent of a base as a reduced ratio (numerator, positive denominator).
    pub fn exponent(&self, base: usize) -> (i32, i32) {
        let e = i32::from(self.exponents.get(base).copied().unwrap_or(0));
        if e == 0 {
            return (0, 1);
        }
        let g = gcd(e.abs(), DENOMINATOR);
        (e / g, DENOMINATOR / g)
    }

    /// Product of two dimensions.
    pub fn times(self, other: Dimension) -> Dimension {
        let mut exponents = self.exponents;
        for (e, o) in exponents.iter_mut().zip(other.exponents) {
            *e = e.saturating_add(o);
        }
        Dimension { exponents }
    }

    /// Quotient of two dimensions.
    pub fn over(self, other: Dimension) -> Dimension {
        self.times(other.power(-1, 1).unwrap_or(Dimension::ONE))
    }

    /// Power with a rational exponent; `None` if the result is not a multiple of 1/60 or leaves the range.
    pub fn power(self, numerator: i32, denominator: i32) -> Option<Dimension> {
        if denominator == 0 {
            return None;
        }
        let mut exponents = [0; BASES];
        for (r, e) in exponents.iter_mut().zip(self.exponents) {
            let product = i64::from(e) * i64::from(numerator);
            if product % i64::from(denominator) != 0 {
                return None;
            }
            *r = i16::try_from(product / i64::from(denominator)).ok()?;
        }
        Some(Dimension { exponents })
    }

    /// The dimension without angle.
    pub fn without_angle(self) -> Dimension {
        let mut exponents = self.exponents;
        exponents[BASES - 1] = 0;
        Dimension { exponents }
    }

    /// Whether all exponents are zero.
    pub fn is_one(self) -> bool {
        self == Dimension::ONE
    }
}

impl std::fmt::Display for Dimension {
    /// SI base symbols: `kg*m/s^2`; `1` when dimensionless.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let order = [1, 0, 2, 3, 4, 5, 6, 7];
        let part = |f: &mut std::fmt::Formatter<'_>, b: usize, n: i32, d: i32| {
            write!(f, "{}", BASE_SYMBOLS[b])?;
            match (n, d) {
                (1, 1) => Ok(()),
                (n, 1) => write!(f, "^{n}"),
                (n, d) => write!(f, "^({n}/{d})"),
            }
        };
        let mut first = true;
        for b in order {
            let (n, d) = self.exponent(b);
            if n > 0 {
                if !first {
                    write!(f, "*")?;
                }
                part(f, b, n, d)?;
                first = false;
            }
        }
        if first {
            write!(f, "1")?;
        }
        for b in order {
            let (n, d) = self.exponent(b);
            if n < 0 {
                write!(f, "/")?;
                part(f, b, -n, d)?;
            }
        }
        Ok(())
    }
}

fn gcd(a: i32, b: i32) -> i32 {
    if b == 0 { a.max(1) } else { gcd(b, a % b) }
}

/// The display of a value: `shown = (si - offset)/scale`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DisplayUnit {
    /// As written: `kN`, `deg`, `degC`.
    pub symbol: String,
    /// SI value of one unit.
    pub scale: f64,
    /// SI value of the unit's zero.
    pub offset: f64,
}

impl DisplayUnit {
    /// The SI base units of a dimension, with the usual names for force, pressure, energy, power.
    pub fn si(dimension: Dimension) -> DisplayUnit {
        DisplayUnit {
            symbol: dimension.to_string(),
            scale: 1.0,
            offset: 0.0,
        }
    }

    /// The unit of a change of a quantity in this unit per change of one in another unit. Changes have no shifted
    /// zero.
    pub fn over(&self, other: &DisplayUnit) -> DisplayUnit {
        let symbol = match (self.symbol.as_str(), other.symbol.as_str()) {
            (own, other) if own == other => "1".to_owned(),
            (own, "1") => own.to_owned(),
            (own, other) if other.contains(['*', '/']) => format!("{own}/({other})"),
            (own, other) => format!("{own}/{other}"),
        };
        DisplayUnit {
            symbol,
            scale: self.scale / other.scale,
            offset: 0.0,
        }
    }

    /// The shown number of an SI value.
    pub fn from_si(&self, si: f64) -> f64 {
        (si - self.offset) / self.scale
    }

    /// The SI value of a shown number.
    pub fn to_si(&self, shown: f64) -> f64 {
        shown * self.scale + self.offset
    }

    /// A value as text with its unit and all its digits.
    pub fn exact_text(&self, si: f64) -> String {
        let value = self.from_si(si);
        // a zero has no sign
        let value = if value == 0.0 { 0.0 } else { value };
        match self.symbol.as_str() {
            "1" => value.to_string(),
            symbol => format!("{value} {symbol}"),
        }
    }

    /// An SI value in a message: four significant digits and the unit. A pure number has no unit.
    pub fn text(&self, si: f64) -> String {
        let value = self.from_si(si);
        let mut text = short(value, 4);
        if self.symbol != "1" {
            text.push(' ');
            text.push_str(&self.symbol);
        }
        text
    }
}
