//! Dual numbers that nest, for hand-made element classes.

use std::fmt::Debug;
use std::ops::{Add, Mul, Neg, Sub};

pub trait Scalar:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    fn constant(x: f64) -> Self;
    fn value(self) -> f64;
    fn recip(self) -> Self;
    fn sqrt(self) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn atan2(self, x: Self) -> Self;
}

impl Scalar for f64 {
    fn constant(x: f64) -> f64 {
        x
    }
    fn value(self) -> f64 {
        self
    }
    fn recip(self) -> f64 {
        1.0 / self
    }
    fn sqrt(self) -> f64 {
        libm::sqrt(self)
    }
    fn sin(self) -> f64 {
        libm::sin(self)
    }
    fn cos(self) -> f64 {
        libm::cos(self)
    }
    fn atan2(self, x: f64) -> f64 {
        libm::atan2(self, x)
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Dual<S> {
    pub re: S,
    pub du: S,
}

impl<S: Scalar> Add for Dual<S> {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Dual {
            re: self.re + o.re,
            du: self.du + o.du,
        }
    }
}
impl<S: Scalar> Sub for Dual<S> {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Dual {
            re: self.re - o.re,
            du: self.du - o.du,
        }
    }
}
impl<S: Scalar> Mul for Dual<S> {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Dual {
            re: self.re * o.re,
            du: self.du * o.re + self.re * o.du,
        }
    }
}
impl<S: Scalar> Neg for Dual<S> {
    type Output = Self;
    fn neg(self) -> Self {
        Dual {
            re: -self.re,
            du: -self.du,
        }
    }
}

impl<S: Scalar> Scalar for Dual<S> {
    fn constant(x: f64) -> Self {
        Dual {
            re: S::constant(x),
            du: S::constant(0.0),
        }
    }
    fn value(self) -> f64 {
        self.re.value()
    }
    fn recip(self) -> Self {
        let r = self.re.recip();
        Dual {
            re: r,
            du: -(self.du * r * r),
        }
    }
    fn sqrt(self) -> Self {
        let r = self.re.sqrt();
        Dual {
            re: r,
            du: self.du * (r + r).recip(),
        }
    }
    fn sin(self) -> Self {
        Dual {
            re: self.re.sin(),
            du: self.du * self.re.cos(),
        }
    }
    fn cos(self) -> Self {
        Dual {
            re: self.re.cos(),
            du: -(self.du * self.re.sin()),
        }
    }
    fn atan2(self, x: Self) -> Self {
        let n = (self.re * self.re + x.re * x.re).recip();
        Dual {
            re: self.re.atan2(x.re),
            du: (self.du * x.re - self.re * x.du) * n,
        }
    }
}
