//! Units in which people expect a dimension.

use super::{Program, Unit};
use eng_system::Dimension;

/// Units in which a reader expects a dimension, the likeliest first.
pub(crate) const USUAL_UNITS: [&str; 32] = [
    "mm",
    "deg",
    "rpm",
    "kg",
    "N",
    "bar",
    "s",
    "K",
    "m/s",
    "m/s^2",
    "N*m",
    "mm^2",
    "cm^3",
    "kg*m^2",
    "kg/m^3",
    "mPa*s",
    "kW",
    "Hz",
    "N/m",
    "N*s/m",
    "N*m/rad",
    "N*m*s/rad",
    "m",
    "rad",
    "rad/s",
    "Pa",
    "J",
    "W",
    "m^2",
    "m^3",
    "Pa*s",
    "rad/s^2",
];

impl Program {
    /// A unit in which a reader expects this dimension.
    pub fn usual_unit(&self, dimension: Dimension) -> Option<Unit> {
        USUAL_UNITS
            .iter()
            .filter_map(|text| self.unit_of_text(text))
            .find(|unit| unit.dimension == dimension)
            .or_else(|| {
                self.units
                    .values()
                    .find(|unit| unit.dimension == dimension && unit.offset == 0.0)
                    .cloned()
            })
    }

    /// The unit `N*m/rad`, if all its parts are known.
    pub(crate) fn unit_of_text(&self, text: &str) -> Option<Unit> {
        let (mut scale, mut dimension) = (1.0, Dimension::ONE);
        let mut sign = 1;
        let mut rest = text;
        loop {
            let (factor, after) = match rest.find(['*', '/']) {
                Some(end) => rest.split_at(end),
                None => (rest, ""),
            };
            let (name, exponent) = match factor.split_once('^') {
                Some((name, exponent)) => (name, exponent.parse::<i32>().ok()?),
                None => (factor, 1),
            };
            let unit = self.units.get(name)?;
            let exponent = sign * exponent;
            dimension = dimension.times(unit.dimension.power(exponent, 1)?);
            scale *= libm::pow(unit.scale, f64::from(exponent));
            let mut characters = after.chars();
            sign = match characters.next() {
                None => {
                    return Some(Unit {
                        symbol: text.to_owned(),
                        scale,
                        offset: 0.0,
                        dimension,
                        point: None,
                    });
                }
                Some('/') => -1,
                Some(_) => 1,
            };
            rest = characters.as_str();
        }
    }
}
