//! Kinks of one element beside each other: both faces of a thin sheet, a stop and the next one.
//!
//! Two functions belong together if they have one element, one dimension, and no limit of their own. If their rates are equal,
//! except for the sign, their kinks have a constant distance. A load may act between them alone.

/// Share of the distance of two kinks of an element that limits both, and its least share of the limit. A
/// jump of a load between two kinks, such as on a thin sheet, acts over this distance alone, so a fiftieth of
/// it is an error of 2 % at most. The least share keeps a distance of rounding from making steps endless. Two
/// functions nearer to each other are one. Both are choices.
pub(super) const APART: (f64, f64) = (0.02, 1e-4);
/// Difference of the rates of two functions whose kinks have a constant distance, as a share of their rates.
/// A choice above rounding: rates of one motion on two faces are equal to all digits.
const PARALLEL: f64 = 1e-6;

/// The kinks beside each kink.
#[derive(Clone, Debug, Default)]
pub struct Neighbours {
    /// The other functions of the same element and dimension, for lengths and angles that the text states no limit for.
    beside: Vec<Vec<usize>>,
    /// Distance of each kink from the nearest of them, if it does not change; otherwise infinite.
    apart: Vec<f64>,
}

impl Neighbours {
    /// Neighbours by the kinds of functions; `None` for a function that counts alone.
    pub fn new<K: PartialEq>(kinds: &[Option<K>]) -> Neighbours {
        let beside = kinds.iter().enumerate().map(|(item, kind)| {
            let others = kinds.iter().enumerate().filter(|(other, other_kind)| {
                *other != item && kind.is_some() && kind == *other_kind
            });
            others.map(|(other, _)| other).collect()
        });
        Neighbours {
            beside: beside.collect(),
            apart: vec![f64::INFINITY; kinds.len()],
        }
    }

    /// Measures the distances, from values and rates of the functions. `tolerance` gives the tolerance that limits each.
    pub fn measure(&mut self, now: &[[f64; 2]], tolerance: impl Fn(usize) -> f64) {
        for (item, others) in self.beside.iter().enumerate() {
            let [value, rate] = now[item];
            let distances = others.iter().filter_map(|other| {
                let [beside, its_rate] = now[*other];
                let sign = if rate * its_rate < 0.0 { -1.0 } else { 1.0 };
                let parallel = (rate - sign * its_rate).abs() <= PARALLEL * rate.abs();
                let distance = (value - sign * beside).abs();
                let is_other = distance > APART.1 * tolerance(item);
                (parallel && rate != 0.0 && is_other).then_some(distance)
            });
            self.apart[item] = distances.fold(f64::INFINITY, f64::min);
        }
    }

    /// The constant distance of a kink from the nearest one beside it; infinite without one.
    pub fn apart(&self, item: usize) -> f64 {
        self.apart[item]
    }
}
