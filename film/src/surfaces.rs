//! Rough surfaces and oil that thins in shear: the flow through a gap and the shear in it, as functions of the gap.

use crate::error::SourceError;

/// Directions of roughness (Peklenik's γ: length over width of the asperities, along the motion) with the constants C
/// and r of the flow factor and the least h/σ of its fit (Patir & Cheng, J. Lubr. Technol. 100 (1978) 12, table 1).
const DIRECTIONS: [(f64, f64, f64, f64); 7] = [
    (1.0 / 9.0, 1.48, 0.42, 1.0),
    (1.0 / 6.0, 1.38, 0.42, 1.0),
    (1.0 / 3.0, 1.18, 0.42, 0.75),
    (1.0, 0.90, 0.56, 0.5),
    (3.0, 0.225, 1.5, 0.5),
    (6.0, 0.520, 1.5, 0.5),
    (9.0, 0.870, 1.5, 0.5),
];

/// Two rough surfaces of equal roughness: the flow factor of shear is zero, because one surface carries as much oil
/// in its valleys as the other one holds back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// σ, root mean square of both surfaces together, m.
    pub deviation: f64,
    /// Peklenik's γ of the direction of motion: 1/9, 1/6, 1/3, 1, 3, 6 or 9.
    pub direction: f64,
    /// `K = 16√2π/15 (σβη)² √(σ/β)` of asperities with density η and radius β (Greenwood & Tripp, Proc. IMechE 185
    /// (1971) 625).
    pub asperity: f64,
    /// E′ of both materials, `1/E′ = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂`, Pa.
    pub modulus: f64,
    /// Coefficient of friction where asperities touch.
    pub friction: f64,
}

/// Oil that thins in shear, after Cross (J. Colloid Sci. 20 (1965) 417): `μ (s + (1 − s)/(1 + (γ̇/rate)^m))` with the
/// shear rate `γ̇ = |ω| R/h` of the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thinning {
    /// s: share of the viscosity that is left at high rates, 0…1.
    pub second: f64,
    /// Shear rate at which half of the loss has happened, 1/s.
    pub rate: f64,
    /// m.
    pub exponent: f64,
}

impl Roughness {
    pub(crate) fn check(&self) -> Result<(), SourceError> {
        for (name, value, zero) in [
            ("roughness", self.deviation, false),
            ("asperity number", self.asperity, true),
            ("modulus of the asperities", self.modulus, true),
            ("friction of the asperities", self.friction, true),
        ] {
            let least = if zero { value >= 0.0 } else { value > 0.0 };
            if !(least && value.is_finite()) {
                let range = match zero {
                    true => "zero or a positive number",
                    false => "a positive number",
                };
                return Err(SourceError::Range { name, value, range });
            }
        }
        match self.row(false) {
            Some(_) => Ok(()),
            None => Err(SourceError::Range {
                name: "direction of roughness",
                value: self.direction,
                range: "one of 1/9, 1/6, 1/3, 1, 3, 6 and 9",
            }),
        }
    }

    /// The row of the direction along the motion, or across it.
    fn row(&self, across: bool) -> Option<(f64, f64, f64, f64)> {
        let wanted = if across {
            1.0 / self.direction
        } else {
            self.direction
        };
        // a stated 1/3 may have six digits, and neighbours in the table differ by a third at least
        (DIRECTIONS.into_iter()).find(|(direction, ..)| (direction / wanted - 1.0).abs() < 1e-6)
    }
}

impl Thinning {
    pub(crate) fn check(&self) -> Result<(), SourceError> {
        if !(0.0..=1.0).contains(&self.second) {
            return Err(SourceError::Range {
                name: "share of viscosity at high shear",
                value: self.second,
                range: "in 0 to 1",
            });
        }
        for (name, value) in [
            ("shear rate", self.rate),
            ("exponent of thinning", self.exponent),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                let range = "a positive number";
                return Err(SourceError::Range { name, value, range });
            }
        }
        Ok(())
    }

    /// Share of the viscosity in a gap (m) at a speed `|ω| R` (m/s), and its slope by the logarithm of the shear rate.
    fn share(&self, gap: f64, speed: f64) -> (f64, f64) {
        if speed == 0.0 {
            return (1.0, 0.0);
        }
        let power = libm::pow(speed / (gap * self.rate), self.exponent);
        let lost = (1.0 - self.second) / (1.0 + power);
        (
            self.second + lost,
            -lost * self.exponent * power / (1.0 + power),
        )
    }
}

/// A function of the gap h and of ω at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OfGap {
    pub value: f64,
    pub by_gap: f64,
    pub by_spin: f64,
}

/// The surfaces and the oil, as functions of the gap.
#[derive(Clone, Debug)]
pub struct Surfaces {
    rough: Option<Rough>,
    thinning: Option<Thinning>,
    floor: f64,
    radius: f64,
}

/// Constants of rough surfaces.
#[derive(Clone, Debug)]
struct Rough {
    deviation: f64,
    /// C, r and the least h/σ of the flow factors along and across the motion; r is negative where the factor is `1 + C
    /// (h/σ)^r`.
    factors: [[f64; 3]; 2],
    /// K E′, Pa.
    hardness: f64,
    contact: Contact,
}

impl Surfaces {
    /// The surfaces and the oil of a bearing of a radius (m). Without `rough` the surfaces are smooth, and without `thinning`
    /// the viscosity is constant. Below `floor` (m, 0 for none) the equations have a continued gap.
    pub fn new(
        rough: Option<&Roughness>,
        thinning: Option<Thinning>,
        floor: f64,
        radius: f64,
    ) -> Surfaces {
        let rough = rough.map(|rough| Rough {
            deviation: rough.deviation,
            factors: [false, true].map(|across| {
                let (direction, c, r, least) = rough.row(across).unwrap_or((1.0, 0.0, 1.0, 1.0));
                if direction > 1.0 {
                    [c, -r, least]
                } else {
                    [-c, r, least]
                }
            }),
            hardness: rough.asperity * rough.modulus,
            contact: Contact::tabulated(),
        });
        Surfaces {
            rough,
            thinning,
            floor,
            radius,
        }
    }

    /// Whether asperities touch anywhere.
    pub(crate) fn is_rough(&self) -> bool {
        self.rough.is_some()
    }

    /// The gap that carries oil, its slope by h and the second one.
    ///
    /// Rough surfaces: the mean distance of surfaces that do not penetrate, `h Φ(h/σ) + σ φ(h/σ)` with the normal
    /// distribution Φ and its density φ (Patir & Cheng 1978), positive for every h. Smooth ones: h, continued below
    /// the floor. Only iterates are below the floor. There the second slope is left out, and the squeeze has the
    /// slope 1.
    pub fn carried(&self, gap: f64) -> [f64; 3] {
        let Some(rough) = &self.rough else {
            let (gap, slope) = continued(gap, self.floor);
            return [gap, slope, 0.0];
        };
        let u = gap / rough.deviation;
        let density = libm::exp(-0.5 * u * u) / libm::sqrt(std::f64::consts::TAU);
        let below = 0.5 * libm::erfc(-u * std::f64::consts::FRAC_1_SQRT_2);
        // Far below, the difference of both parts loses its digits: Mills' ratio to second order keeps the sign. The
        // limit is a choice: there the difference has lost two digits. The next term of the ratio, 15/u⁴, is 1 %, but
        // only iterates see this jump, because the mean is below 1e-9 of σ.
        let mean = if u < -6.0 {
            density / (u * u) * (1.0 - 3.0 / (u * u))
        } else {
            u * below + density
        };
        [rough.deviation * mean, below, density / rough.deviation]
    }

    /// Slope of the rate of the carried gap by that of h, and by h itself at the rate 1. The first is
    /// dimensionless, the second in 1/m.
    pub fn squeezed(&self, carried: [f64; 3]) -> [f64; 2] {
        match self.rough {
            Some(_) => [carried[1], carried[2]],
            None => [1.0, 0.0],
        }
    }

    /// `φ h³` over the share of viscosity that shear leaves, along or across the motion, as its value and the slopes of
    /// its logarithm. Below the least h/σ of the flow factor the factor is constant, and h continues as `f²/(2f − h)`.
    pub fn conducted(&self, gap: f64, carried: [f64; 3], spin: f64, across: bool) -> OfGap {
        let (value, by_gap) = match &self.rough {
            None => {
                let h = carried[0];
                (h * h * h, 3.0 * carried[1] / h)
            }
            Some(rough) => {
                let [c, r, least] = rough.factors[usize::from(across)];
                let limit = least * rough.deviation;
                let (h, slope) = continued(gap, limit);
                let u = gap.max(limit) / rough.deviation;
                let (part, part_slope) = if r > 0.0 {
                    let part = c * libm::exp(-r * u);
                    (part, -r * part)
                } else {
                    let part = c * libm::pow(u, r);
                    (part, r * part / u)
                };
                let factor = 1.0 + part;
                let by_factor = if gap > limit {
                    part_slope / rough.deviation / factor
                } else {
                    0.0
                };
                (factor * h * h * h, 3.0 * slope / h + by_factor)
            }
        };
        let thin = self.thinned(carried, spin);
        OfGap {
            value: value / thin.value,
            by_gap: by_gap - thin.by_gap / thin.value,
            by_spin: -thin.by_spin / thin.value,
        }
    }

    /// The share of viscosity over the carried gap, 1/m, with its slopes.
    pub fn sheared(&self, carried: [f64; 3], spin: f64) -> OfGap {
        let thin = self.thinned(carried, spin);
        let over = 1.0 / carried[0];
        OfGap {
            value: thin.value * over,
            by_gap: (thin.by_gap - thin.value * over * carried[1]) * over,
            by_spin: thin.by_spin * over,
        }
    }

    /// The share of viscosity that shear leaves. Dimensionless, with its slopes by h (1/m) and by ω (s).
    fn thinned(&self, [gap, slope, _]: [f64; 3], spin: f64) -> OfGap {
        let Some(thinning) = &self.thinning else {
            return OfGap {
                value: 1.0,
                ..OfGap::default()
            };
        };
        let (value, by_rate) = thinning.share(gap, spin.abs() * self.radius);
        OfGap {
            value,
            by_gap: -by_rate * slope / gap,
            by_spin: if spin == 0.0 { 0.0 } else { by_rate / spin },
        }
    }

    /// Pressure of the asperities, `K E′ F_{5/2}(h/σ)`, Pa, and its slope by h.
    pub fn touching(&self, gap: f64) -> [f64; 2] {
        let Some(rough) = &self.rough else {
            return [0.0; 2];
        };
        let [value, slope] = rough.contact.at(gap / rough.deviation);
        [
            rough.hardness * value,
            rough.hardness * slope / rough.deviation,
        ]
    }
}

/// The gap in an equation and its slope by the true gap h: `f²/(2f − h)` below the floor f, where it has the
/// value and slope of h and stays positive for every h. So the iterates of a solver have a film at every
/// position of the pin. Both gaps in m, the slope dimensionless.
fn continued(gap: f64, floor: f64) -> (f64, f64) {
    if gap >= floor || floor == 0.0 {
        return (gap, 1.0);
    }
    let share = floor / (2.0 * floor - gap);
    (floor * share, share * share)
}

/// `F_{5/2}(u) = (2π)^{−1/2} ∫_u^∞ (s − u)^{5/2} e^{−s²/2} ds` (Greenwood & Tripp 1971), by quintics through
/// exact values, slopes and second slopes of its logarithm. The popular fit `4.4086e-5 (4 − u)^6.804` is 9 to
/// 11 % too low at u = 0 and 2, and zero above 4.
#[derive(Clone, Debug)]
pub struct Contact {
    nodes: Vec<[f64; 3]>,
}

/// First and last u of the nodes, and their distance. Before the first, no real surfaces are: it is for
/// iterates. Beyond the last, asperities carry 1e-17 of K E′. The distance is a choice that keeps ten digits
/// between the nodes, as a test compares.
const FIRST: f64 = -12.0;
const LAST: f64 = 8.0;
const DISTANCE: f64 = 0.125;

impl Contact {
    /// The nodes at equal distances.
    pub fn tabulated() -> Contact {
        let count = ((LAST - FIRST) / DISTANCE) as usize;
        let node = |at: usize| {
            let u = FIRST + DISTANCE * at as f64;
            let [f1, f3, f5] = [1, 3, 5].map(|twice| moment(twice, u));
            let slope = -2.5 * f3 / f5;
            [libm::log(f5), slope, 3.75 * f1 / f5 - slope * slope]
        };
        Contact {
            nodes: (0..=count).map(node).collect(),
        }
    }

    /// Value and slope.
    pub fn at(&self, u: f64) -> [f64; 2] {
        if u >= LAST {
            return [0.0; 2];
        }
        if u < FIRST {
            // only iterates are here: the parabola with the slopes at the first node
            let [log, slope, bend] = self.nodes[0];
            let (value, x) = (libm::exp(log), u - FIRST);
            let second = value * (bend + slope * slope);
            return [
                value * (1.0 + slope * x) + 0.5 * second * x * x,
                value * slope + second * x,
            ];
        }
        let at = (((u - FIRST) / DISTANCE) as usize).min(self.nodes.len() - 2);
        let x = (u - FIRST) / DISTANCE - at as f64;
        let scaled = |[log, slope, bend]: [f64; 3]| {
            [log, slope * DISTANCE, bend * DISTANCE * DISTANCE / 2.0]
        };
        let ([a, b, c], [d, e, f]) = (scaled(self.nodes[at]), scaled(self.nodes[at + 1]));
        // a quintic by its first three coefficients and those that meet the second end
        let (rise, turn, bend) = (d - a - b - c, e - b - 2.0 * c, 2.0 * (f - c));
        let c3 = 10.0 * rise - 4.0 * turn + 0.5 * bend;
        let c4 = -15.0 * rise + 7.0 * turn - bend;
        let c5 = 6.0 * rise - 3.0 * turn + 0.5 * bend;
        let log = a + x * (b + x * (c + x * (c3 + x * (c4 + x * c5))));
        let slope = b + x * (2.0 * c + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)));
        let value = libm::exp(log);
        [value, value * slope / DISTANCE]
    }
}

/// `F_{n/2}(u)` for odd n. With `s = u + t²` the integrand `2 t^(n+1) e^{−(u + t²)²/2}` is even and smooth, so the
/// trapezoidal rule converges faster than any power of its step.
pub fn moment(n: i32, u: f64) -> f64 {
    // a choice: the error of the rule is an exponential of minus one over the step, far below rounding. The
    // loop ends at t = 10, beyond the break for every u of a node
    const STEP: f64 = 0.01;
    let mut sum = 0.0;
    for k in 1..1000 {
        let t = STEP * f64::from(k);
        let s = u + t * t;
        // here the exponential is below e^(−40) of its largest value
        if s > 0.0 && s * s > 80.0 + u * u {
            break;
        }
        sum += libm::pow(t, f64::from(n + 1)) * libm::exp(-0.5 * s * s);
    }
    2.0 * STEP * sum / libm::sqrt(std::f64::consts::TAU)
}
