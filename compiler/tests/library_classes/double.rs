//! Numbers of 106 bits as sums of two (T. J. Dekker, Numer. Math. 18 (1971) 224; Hida, Li & Bailey, ARITH-15
//! (2001) 155).
//!
//! Differences of functions in these numbers keep enough digits: with an increment of 1e-9 a derivative has some
//! twenty. Elementary functions are good to about 1e-30 for arguments below 1e3.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `high + low`, |low| at most half a unit in the last place of high.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Double {
    pub high: f64,
    pub low: f64,
}

fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

fn renormalised(a: f64, b: f64) -> Double {
    let high = a + b;
    Double {
        high,
        low: b - (high - a),
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Double {
        Double { high, low: 0.0 }
    }
}

impl Add for Double {
    type Output = Double;
    fn add(self, other: Double) -> Double {
        let (sum, error) = two_sum(self.high, other.high);
        let (low, last) = two_sum(self.low, other.low);
        let first = renormalised(sum, error + low);
        renormalised(first.high, first.low + last)
    }
}

impl Neg for Double {
    type Output = Double;
    fn neg(self) -> Double {
        Double {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for Double {
    type Output = Double;
    fn sub(self, other: Double) -> Double {
        self + -other
    }
}

impl Mul for Double {
    type Output = Double;
    fn mul(self, other: Double) -> Double {
        let product = self.high * other.high;
        let error = self.high.mul_add(other.high, -product);
        renormalised(
            product,
            error + (self.high * other.low + self.low * other.high),
        )
    }
}

impl Div for Double {
    type Output = Double;
    fn div(self, other: Double) -> Double {
        let first = self.high / other.high;
        let rest = self - other * first.into();
        let second = rest.high / other.high;
        let rest = rest - other * second.into();
        renormalised(first, second) + (rest.high / other.high).into()
    }
}

const HALF_PI: Double = Double {
    high: std::f64::consts::FRAC_PI_2,
    low: 6.123_233_995_736_766e-17,
};
const LN_2: Double = Double {
    high: std::f64::consts::LN_2,
    low: 2.319_046_813_846_299_6e-17,
};

impl Double {
    pub const ZERO: Double = Double {
        high: 0.0,
        low: 0.0,
    };
    pub const ONE: Double = Double {
        high: 1.0,
        low: 0.0,
    };

    pub fn abs(self) -> Double {
        if self.high < 0.0 { -self } else { self }
    }

    pub fn less(self, other: Double) -> bool {
        (self - other).high < 0.0
    }

    pub fn sqrt(self) -> Double {
        if self.high == 0.0 {
            return Double::ZERO;
        }
        let root = Double::from(self.high.sqrt());
        root + (self - root * root) / (root + root)
    }

    pub fn exp(self) -> Double {
        let powers = (self.high / LN_2.high).round();
        // exp(r) − 1 of r/512 by its series, then nine squarings of the exponential
        let r = (self - LN_2 * powers.into()) / 512.0.into();
        let mut sum = Double::ZERO;
        for k in (1..=12).rev() {
            sum = (sum + Double::ONE) * r / f64::from(k).into();
        }
        for _ in 0..9 {
            sum = sum + sum + sum * sum;
        }
        (sum + Double::ONE) * 2f64.powi(powers as i32).into()
    }

    pub fn log(self) -> Double {
        let mut x = Double::from(self.high.ln());
        for _ in 0..2 {
            x = x + self * (-x).exp() - Double::ONE;
        }
        x
    }

    pub fn sin_cos(self) -> (Double, Double) {
        let quarters = (self.high / HALF_PI.high).round();
        let r = self - HALF_PI * quarters.into();
        let square = r * r;
        let (mut sine, mut cosine) = (Double::ZERO, Double::ZERO);
        for k in (1..=16).rev() {
            let k = f64::from(2 * k);
            sine = (Double::ONE + sine) * -square / (k * (k + 1.0)).into();
            cosine = (Double::ONE + cosine) * -square / (k * (k - 1.0)).into();
        }
        let (sine, cosine) = (r * (sine + Double::ONE), cosine + Double::ONE);
        match (quarters as i64).rem_euclid(4) {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }

    /// self is y.
    pub fn atan2(self, x: Double) -> Double {
        let angle = Double::from(self.high.atan2(x.high));
        let (sine, cosine) = angle.sin_cos();
        // the remaining error is below 1e-16, and its cube is negligible
        angle + (self * cosine - x * sine) / (self * self + x * x).sqrt()
    }

    pub fn asin(self) -> Double {
        self.atan2(((Double::ONE - self) * (Double::ONE + self)).sqrt())
    }

    pub fn acos(self) -> Double {
        ((Double::ONE - self) * (Double::ONE + self))
            .sqrt()
            .atan2(self)
    }

    pub fn tanh(self) -> Double {
        // beyond, the distance from one is below 1e-34, and the exponential may have no number
        if self.high.abs() > 40.0 {
            return Double::from(self.high.signum());
        }
        let e = (self + self).exp();
        (e - Double::ONE) / (e + Double::ONE)
    }

    pub fn power(self, exponent: Double) -> Double {
        if exponent.low == 0.0 && exponent.high.fract() == 0.0 && exponent.high.abs() <= 64.0 {
            let mut product = Double::ONE;
            for _ in 0..exponent.high.abs() as u32 {
                product = product * self;
            }
            return if exponent.high < 0.0 {
                Double::ONE / product
            } else {
                product
            };
        }
        (self.log() * exponent).exp()
    }
}

/// Decimal digits of known values, and identities, to 1e-29.
#[test]
fn elementary_functions_have_thirty_digits() {
    let close = |a: Double, b: Double| {
        let error = (a - b).high.abs();
        assert!(error < 1e-29 * (1.0 + b.high.abs()), "{a:?} {b:?}");
    };
    let of = |high: f64, low: f64| Double { high, low };
    // e, √2, ln 10 and π as sums of two
    close(
        Double::ONE.exp(),
        of(std::f64::consts::E, 1.445_646_891_729_250_2e-16),
    );
    close(
        Double::from(2.0).sqrt(),
        of(std::f64::consts::SQRT_2, -9.667_293_313_452_913e-17),
    );
    close(
        Double::from(10.0).log(),
        of(std::f64::consts::LN_10, -2.170_756_223_382_249_4e-16),
    );
    close(
        Double::ZERO.atan2(-Double::ONE),
        of(std::f64::consts::PI, 1.224_646_799_147_353_2e-16),
    );
    for k in 1..40 {
        let x = Double::from(0.37 * f64::from(k)) / 3.0.into();
        let (s, c) = x.sin_cos();
        close(s * s + c * c, Double::ONE);
        let y = x - Double::from(2.5);
        let (s, c) = y.sin_cos();
        if y.high.abs() < 3.1 {
            close(s.atan2(c), y);
        }
        close(y.exp().log(), y);
        close(x.power(0.3125.into()) * x.power(0.6875.into()), x);
        close(x.power(3.0.into()), x * x * x);
        let t = y.tanh();
        close(t.asin() + t.acos(), HALF_PI);
        close(t.asin().sin_cos().0, t);
        close(x / y * y, x);
    }
    // sin(1/2 + 2π·7) = sin(1/2): the reduction of the argument
    let turns = HALF_PI * 28.0.into();
    close(
        (turns + 0.5.into()).sin_cos().0,
        Double::from(0.5).sin_cos().0,
    );
}
