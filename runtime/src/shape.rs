//! The shapes of a flexible body at a marker, to second order in the amplitudes a.
//!
//! Displacement and rotation of the marker in body axes, components c = x, y, z (m) and about x, y, z (rad),
//! are
//!
//! ```text
//! u_c(a) = Φ_c a − ½ a·N_c a      u̇ = Φ(a) ȧ      ü = Φ(a) ä − ȧ·N_c ȧ      Φ(a)_c = Φ_c − (N_c a)ᵀ
//! ```
//!
//! with the geometric stiffness `N_c` of a unit load at c ([`eng_system::reduced::MarkerStiffness`],
//! symmetric). In second order a displacement causes another one whose work against a load f is
//! `−½ a·N(f) a`. The work of a unit load is the displacement of its own marker. So a bent beam pulls its
//! ends together. The virtual work `F_c δu_c` of forces and constraints at the marker then has `F_c N_c a` on
//! the side of the elastic force. So joints stiffen or soften the body like other loads, constraints hold the
//! true position of the marker, and energy is kept between partners. Without such blocks all terms are
//! linear.

use crate::rotation::V3;
use eng_system::dense::{add_product, add_scaled, dot};
use eng_system::reduced::{Block, MarkerStiffness, ReducedMarker};

/// Numbers of displacement and rotation.
const SIX: usize = 6;

/// The motion of a marker with the modes of its body.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkerShape {
    /// Φ: displacement (m per unit of amplitude), then rotation (rad per unit); 6 × modes, row-major.
    rows: Vec<f64>,
    /// Components with their N_c.
    second: Vec<(usize, Block)>,
}

impl MarkerShape {
    /// The shape of a reduced marker. It drops zero blocks, and blocks with another number of modes than its
    /// rows.
    pub fn new<'a>(
        marker: &ReducedMarker,
        loads: impl Iterator<Item = &'a MarkerStiffness>,
    ) -> MarkerShape {
        let rows = [&marker.translation[..], &marker.rotation[..]].concat();
        let n = rows.len() / SIX;
        let second = loads
            .map(|load| (usize::from(load.component), load.stiffness.clone()))
            .filter(|(c, block)| {
                *c < SIX && block.len() == n * n && block.iter().any(|x| *x != 0.0)
            })
            .collect();
        MarkerShape { rows, second }
    }

    /// Modes.
    pub fn modes(&self) -> usize {
        self.rows.len() / SIX
    }

    /// Φ, 6 × modes.
    pub fn rows(&self) -> &[f64] {
        &self.rows
    }

    /// Whether it has second-order terms.
    pub fn is_curved(&self) -> bool {
        !self.second.is_empty()
    }

    /// Φ x.
    fn along(&self, x: &[f64]) -> [f64; SIX] {
        let n = self.modes();
        std::array::from_fn(|c| dot(&self.rows[c * n..(c + 1) * n], x))
    }

    /// `out_c += factor x·N_c y`.
    fn add_second(&self, factor: f64, x: &[f64], y: &[f64], out: &mut [f64; SIX]) {
        for (c, block) in &self.second {
            let rows = x.iter().zip(block.chunks_exact(y.len().max(1)));
            out[*c] += factor * rows.map(|(x, row)| x * dot(row, y)).sum::<f64>();
        }
    }

    /// u and θ at amplitudes (m, rad; body axes).
    pub fn displacement(&self, amplitudes: &[f64]) -> (V3, V3) {
        let mut out = self.along(amplitudes);
        self.add_second(-0.5, amplitudes, amplitudes, &mut out);
        halves(&out)
    }

    /// `Φ(a) x`: the rates of u and θ for x = ȧ. In m/s and rad/s, in the body's axes.
    pub fn rate(&self, amplitudes: &[f64], x: &[f64]) -> (V3, V3) {
        let mut out = self.along(x);
        self.add_second(-1.0, amplitudes, x, &mut out);
        halves(&out)
    }

    /// `−ȧ·N_c ȧ`: the second rates of u and θ for ä = 0. In m/s² and rad/s², in the body's axes.
    pub fn swing(&self, rates: &[f64]) -> (V3, V3) {
        let mut out = [0.0; SIX];
        self.add_second(-1.0, rates, rates, &mut out);
        halves(&out)
    }

    /// Length of [`MarkerShape::fill_rows`].
    pub fn length(&self) -> usize {
        self.rows.len() * if self.is_curved() { 2 } else { 1 }
    }

    /// Writes Φ(a) and, with second-order terms, Φ(ȧ) − Φ, the derivative of u̇ with respect to a: 6 × modes
    /// each.
    pub fn fill_rows(&self, amplitudes: &[f64], rates: &[f64], out: &mut [f64]) {
        let n = self.modes();
        let (first, second) = out.split_at_mut(self.rows.len());
        first.copy_from_slice(&self.rows);
        second.fill(0.0);
        for (c, block) in &self.second {
            add_product(&mut first[c * n..(c + 1) * n], -1.0, block, amplitudes);
            add_product(&mut second[c * n..(c + 1) * n], -1.0, block, rates);
        }
    }

    /// `−Σ_c load_c N_c`, the derivative of `Φ(a)ᵀ load` by a for a frozen load (N, N m; body axes), added to
    /// modes × modes within rows of `width` numbers, from `column` on.
    pub fn add_pull(&self, load: &[f64; SIX], width: usize, column: usize, out: &mut [f64]) {
        let n = self.modes().max(1);
        for (c, block) in &self.second {
            for (line, row) in out.chunks_exact_mut(width).zip(block.chunks_exact(n)) {
                add_scaled(&mut line[column..], -load[*c], row);
            }
        }
    }
}

fn halves(six: &[f64; SIX]) -> (V3, V3) {
    let [a, b, c, d, e, f] = *six;
    (V3::new(a, b, c), V3::new(d, e, f))
}
