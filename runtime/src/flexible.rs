//! The floating frame of a flexible body, and the inertia of its modes.
//!
//! With the constants of [`Invariants`], `a` the amplitudes and `S(a) = Σ m s + P a`, the kinetic energy in
//! body axes is
//!
//! ```text
//! T = ½ m v·v + v·(ω × S + P ȧ) + ½ ω·J(a) ω + ω·B(a) ȧ + ½ ȧ·m_ff ȧ
//! J(a)_ik = J_ik + (D_k a)_i + (D_i a)_k + a·H_ik a        B(a)_k = C_k + (G_k a)ᵀ
//! ```
//!
//! (P, C: momentum and angular momentum of the modal rates; D_k, G_k, H_ik: [`Invariants`]). The equations
//! are those of Boltzmann and Hamel for (v, ω, ȧ), so momentum and energy are kept for any mass matrix. v
//! drops out. With `β = Aᵀ(r̈ − g)` they are
//!
//! ```text
//! force  (ground axes)  A (m β + ω̇×S + P ä + ω×(ω×S) + 2 ω×P ȧ)
//! torque (body axes)    S×β + J ω̇ + B ä + J̇ ω + (ȧ·G_k ȧ)_k + ω×(J ω + B ȧ)
//! modal                 Pᵀβ + Bᵀω̇ + m_ff ä + Σ ω_k (G_k − G_kᵀ) ȧ − ½ Σ ω_i ω_k ∂J_ik/∂a + k a + c ȧ
//! ```
//!
//! (A. A. Shabana, Dynamics of Multibody Systems, 2013, chapter 5; J. Gerstmayr, A. Zwölfer 2021.)
//!
//! Geometric stiffness is optional ([`Geometric`]). Its blocks N of spin, T of turn and L of acceleration are
//! the second-order parts of J, B and S. They come from the second-order displacement of the mass with a:
//!
//! ```text
//! J_ii −= a·N_ii a    J_ik −= ½ a·N_ik a    B_k += (T_k a)ᵀ    S_i += ½ a·L_i a
//! ```
//!
//! The equations above then have `Σ ω_iω_k N_ik a + Σ ω̇_k T_k a + Σ β_i L_i a` in the modal rows, and the
//! corresponding terms in the rows of force and torque. So the mass matrix is symmetric, and momentum and
//! energy are kept. The centrifugal softening comes from H alone. Loads at markers change the stiffness by
//! the second-order displacement of the markers: see [`crate::shape`].

use crate::frame::{BodyFrame, Weights};
use crate::rotation::{M3, V3, add_block, skew};
use eng_system::dense::{add_product, add_scaled, add_transposed, dot};
use eng_system::reduced::{Block, Geometric, Invariants};
use std::sync::Arc;

/// Pairs of axes of the six distinct `H_ik`.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// A flexible body.
#[derive(Clone, Debug, PartialEq)]
pub struct Flexible {
    /// Its constants, with geometric stiffness of spin and turn in the centrifugal and Coriolis blocks.
    pub constants: Arc<Invariants>,
    /// Second-order parts of the first moment, if there are any.
    bending: Option<[Block; 3]>,
    first_moment: V3,
    inertia: M3,
    /// `G_k − G_kᵀ`.
    gyroscopic: [Vec<f64>; 3],
}

/// Scratch for the inertia of a deformed body, kept from step to step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Work {
    shape: Shape,
    modal: Vec<f64>,
    zeros: Vec<f64>,
    along_alpha: Vec<f64>,
    along_omega: Vec<f64>,
    by_rates: Vec<f64>,
    turned: Vec<f64>,
    moment_by_rate: Vec<f64>,
    coriolis: Vec<f64>,
}

/// The constants of a deformed body for its inertia.
#[derive(Clone, Debug, Default, PartialEq)]
struct Shape {
    /// S(a).
    moment: V3,
    /// J(a).
    inertia: M3,
    /// B(a), 3 × n.
    coupling: Vec<f64>,
    /// ∂J_ik/∂a for [`PAIRS`], n each.
    by_shape: [Vec<f64>; 6],
    /// ∂S/∂a, 3 × n: P, plus L a with geometric stiffness.
    translation: Vec<f64>,
    /// Ṡ.
    momentum: V3,
    /// S̈ at ä = 0.
    swing: V3,
}

impl Shape {
    /// Rate of the momentum that the body has beyond that of its frame's origin, in body axes (N):
    /// `ω̇ × S + ∂S/∂a ä + S̈ + ω × (ω × S) + 2 ω × Ṡ`, with the angular acceleration `alpha` and the second rates
    /// ä of the amplitudes.
    fn bending_force(&self, omega: &V3, alpha: &V3, second: &[f64]) -> V3 {
        alpha.cross(&self.moment)
            + rows(&self.translation, second.len(), second)
            + self.swing
            + omega.cross(&omega.cross(&self.moment))
            + omega.cross(&self.momentum) * 2.0
    }
}

/// Sets a length and zeros, without a new allocation if the capacity suffices.
fn clear(vector: &mut Vec<f64>, length: usize) {
    vector.clear();
    vector.resize(length, 0.0);
}

fn rows(block: &[f64], n: usize, x: &[f64]) -> V3 {
    let row = |i: usize| dot(&block[i * n..(i + 1) * n], x);
    V3::new(row(0), row(1), row(2))
}

/// `out += factor · rᵀ M`, M 3 × n.
fn add_rows(out: &mut [f64], factor: &V3, block: &[f64]) {
    let n = out.len();
    for k in 0..3 {
        add_scaled(out, factor[k], &block[k * n..(k + 1) * n]);
    }
}

/// `out_k += L_k x`, 3 × n.
fn add_blocks(out: &mut [f64], blocks: &[Block; 3], x: &[f64]) {
    for (row, block) in out.chunks_exact_mut(x.len().max(1)).zip(blocks) {
        add_product(row, 1.0, block, x);
    }
}

/// Constants that include the blocks of spin and turn, and the blocks of acceleration unless they vanish, as
/// in a free body.
fn with_geometric(
    constants: &Invariants,
    geometric: &Geometric,
) -> (Arc<Invariants>, Option<[Block; 3]>) {
    let mut own = constants.clone();
    for (p, (block, spin)) in own.centrifugal.iter_mut().zip(&geometric.spin).enumerate() {
        // an off-diagonal pair occurs twice in Σ_ik
        let factor = if p < 3 { 1.0 } else { 0.5 };
        for (x, n) in block.iter_mut().zip(spin) {
            *x -= factor * n;
        }
    }
    for (block, turn) in own.coriolis.iter_mut().zip(&geometric.turn) {
        for (x, t) in block.iter_mut().zip(turn) {
            *x += t;
        }
    }
    let vanish = geometric.acceleration.iter().flatten().all(|x| *x == 0.0);
    let bending = (!vanish).then(|| geometric.acceleration.clone());
    (Arc::new(own), bending)
}

impl Flexible {
    /// A flexible body from its constants.
    pub fn new(constants: Arc<Invariants>) -> Flexible {
        let first_moment = V3::from(constants.first_moment);
        let inertia = M3::from_fn(|i, j| constants.inertia[i][j]);
        let (constants, bending) = match &constants.geometric {
            Some(geometric) => with_geometric(&constants, geometric),
            None => (constants, None),
        };
        let n = constants.modes;
        let gyroscopic = std::array::from_fn(|k| {
            let g = &constants.coriolis[k];
            (0..n * n)
                .map(|at| g[at] - g[at % n * n + at / n])
                .collect()
        });
        Flexible {
            constants,
            bending,
            first_moment,
            inertia,
            gyroscopic,
        }
    }

    /// Number of modes.
    pub fn modes(&self) -> usize {
        self.constants.modes
    }

    /// Centre of mass of the undeformed body (m).
    pub fn center(&self) -> V3 {
        self.first_moment / self.constants.mass
    }

    /// Inertia of the undeformed body about its frame's origin (kg m²).
    pub fn undeformed_inertia(&self) -> &M3 {
        &self.inertia
    }

    fn shape(&self, a: &[f64], rates: &[f64], shape: &mut Shape) {
        let c = &*self.constants;
        let n = c.modes;
        shape.coupling.clear();
        shape.coupling.extend_from_slice(&c.rotation);
        for (k, block) in c.coriolis.iter().enumerate() {
            add_product(&mut shape.coupling[k * n..(k + 1) * n], 1.0, block, a);
        }
        shape.inertia = self.inertia;
        for (p, (i, k)) in PAIRS.into_iter().enumerate() {
            let row = &mut shape.by_shape[p];
            clear(row, n);
            add_product(row, 2.0, &c.centrifugal[p], a);
            let quadratic = 0.5 * dot(row, a);
            add_scaled(row, 1.0, &c.rotation_by_shape[k][i * n..(i + 1) * n]);
            add_scaled(row, 1.0, &c.rotation_by_shape[i][k * n..(k + 1) * n]);
            let value = dot(row, a) - quadratic;
            shape.inertia[(i, k)] += value;
            if i != k {
                shape.inertia[(k, i)] += value;
            }
        }
        shape.translation.clear();
        shape.translation.extend_from_slice(&c.translation);
        shape.moment = self.first_moment + rows(&c.translation, n, a);
        shape.swing = V3::zeros();
        if let Some(blocks) = &self.bending {
            add_blocks(&mut shape.translation, blocks, a);
            let half = rows(&shape.translation, n, a) - rows(&c.translation, n, a);
            shape.moment += half * 0.5;
            shape.swing = self.bent_by(blocks, rates, rates);
        }
        shape.momentum = rows(&shape.translation, n, rates);
    }

    /// `x·L_k y` for k = x, y, z.
    fn bent_by(&self, blocks: &[Block; 3], x: &[f64], y: &[f64]) -> V3 {
        let n = self.modes();
        V3::from_fn(|k, _| {
            (0..n)
                .map(|i| x[i] * dot(&blocks[k][i * n..(i + 1) * n], y))
                .sum()
        })
    }

    /// `∂(J x)/∂a`, 3 × n: the rows `Σ_k x_k ∂J_ik/∂a`.
    fn inertia_by_shape(&self, shape: &Shape, x: &V3, out: &mut Vec<f64>) {
        let n = self.modes();
        clear(out, 3 * n);
        for (p, (i, k)) in PAIRS.into_iter().enumerate() {
            let mut add = |row: usize, factor: f64| {
                add_scaled(&mut out[row * n..(row + 1) * n], factor, &shape.by_shape[p]);
            };
            add(i, x[k]);
            if i != k {
                add(k, x[i]);
            }
        }
    }

    /// `J̇` at the rates.
    fn inertia_rate(shape: &Shape, rates: &[f64]) -> M3 {
        let mut out = M3::zeros();
        for (p, (i, k)) in PAIRS.into_iter().enumerate() {
            let value = dot(&shape.by_shape[p], rates);
            out[(i, k)] = value;
            out[(k, i)] = value;
        }
        out
    }

    /// Adds inertia, gravity, stiffness and damping: see the head of this module. `v` are (ṙ, ω, ȧ), `rate`
    /// their rates.
    pub fn add_inertia(
        &self,
        frame: &BodyFrame,
        v: &[f64],
        rate: &[f64],
        gravity: &V3,
        work: &mut Work,
        out: &mut [f64],
    ) {
        let (c, a) = (&*self.constants, frame.amplitudes);
        let n = c.modes;
        let (omega, alpha) = (
            V3::new(v[3], v[4], v[5]),
            V3::new(rate[3], rate[4], rate[5]),
        );
        let (rates, second) = (&v[6..6 + n], &rate[6..6 + n]);
        let Work { shape, modal, .. } = work;
        self.shape(a, rates, shape);
        let acceleration = V3::new(rate[0], rate[1], rate[2]) - gravity;
        let beta = frame.rotation.transpose() * acceleration;
        let bent = shape.bending_force(&omega, &alpha, second);
        let force = acceleration * c.mass + frame.rotation * bent;
        let internal = shape.inertia * omega + rows(&shape.coupling, n, rates);
        let mut torque = shape.moment.cross(&beta)
            + shape.inertia * alpha
            + rows(&shape.coupling, n, second)
            + Self::inertia_rate(shape, rates) * omega
            + omega.cross(&internal);
        for k in 0..3 {
            clear(modal, n);
            add_product(modal, 1.0, &c.coriolis[k], rates);
            torque[k] += dot(modal, rates);
            add_scaled(&mut out[6..6 + n], omega[k], modal);
            clear(modal, n);
            add_transposed(modal, &c.coriolis[k], rates);
            add_scaled(&mut out[6..6 + n], -omega[k], modal);
        }
        for i in 0..3 {
            out[i] += force[i];
            out[3 + i] += torque[i];
        }
        let modal = &mut out[6..6 + n];
        add_rows(modal, &beta, &shape.translation);
        add_rows(modal, &alpha, &shape.coupling);
        add_product(modal, 1.0, &c.modal_mass, second);
        for (p, (i, k)) in PAIRS.into_iter().enumerate() {
            let factor = if i == k { 0.5 } else { 1.0 } * omega[i] * omega[k];
            add_scaled(modal, -factor, &shape.by_shape[p]);
        }
        add_product(modal, 1.0, &c.stiffness, a);
        add_product(modal, 1.0, &c.damping, rates);
    }

    /// Adds the mass matrix, row-major width × width.
    pub fn add_mass(&self, frame: &BodyFrame, factor: f64, work: &mut Work, out: &mut [f64]) {
        let c = &*self.constants;
        let n = c.modes;
        let width = 6 + n;
        let Work { shape, zeros, .. } = work;
        clear(zeros, n);
        self.shape(frame.amplitudes, zeros, shape);
        let cross = frame.rotation * skew(&shape.moment) * factor;
        for i in 0..3 {
            out[i * width + i] += factor * c.mass;
            for j in 0..3 {
                out[i * width + 3 + j] -= cross[(i, j)];
                out[(3 + j) * width + i] -= cross[(i, j)];
                out[(3 + i) * width + 3 + j] += factor * shape.inertia[(i, j)];
            }
            for j in 0..n {
                let momentum: f64 = (0..3)
                    .map(|k| frame.rotation[(i, k)] * shape.translation[k * n + j])
                    .sum();
                out[i * width + 6 + j] += factor * momentum;
                out[(6 + j) * width + i] += factor * momentum;
                let angular = factor * shape.coupling[i * n + j];
                out[(3 + i) * width + 6 + j] += angular;
                out[(6 + j) * width + 3 + i] += angular;
            }
        }
        for i in 0..n {
            let line = &mut out[(6 + i) * width + 6..(7 + i) * width];
            add_scaled(line, factor, &c.modal_mass[i * n..(i + 1) * n]);
        }
    }

    /// Adds the derivative of [`Flexible::add_inertia`] along the step's unknown; see
    /// [`crate::body::BodyModel::add_inertia_matrix`].
    #[allow(clippy::too_many_arguments)]
    pub fn add_inertia_matrix(
        &self,
        frame: &BodyFrame,
        v: &[f64],
        rate: &[f64],
        gravity: &V3,
        weights: Weights,
        turn: &M3,
        work: &mut Work,
        out: &mut [f64],
    ) {
        let (c, a) = (&*self.constants, frame.amplitudes);
        let n = c.modes;
        let width = 6 + n;
        let (omega, alpha) = (
            V3::new(v[3], v[4], v[5]),
            V3::new(rate[3], rate[4], rate[5]),
        );
        let (rates, second) = (&v[6..6 + n], &rate[6..6 + n]);
        self.add_mass(frame, weights.acceleration, work, out);
        self.shape(a, rates, &mut work.shape);
        self.torque_by_shape(&omega, &alpha, rates, second, work);
        let Work {
            shape,
            along_alpha: by_shape,
            along_omega,
            by_rates,
            turned,
            moment_by_rate,
            coriolis,
            ..
        } = work;
        let acceleration = V3::new(rate[0], rate[1], rate[2]) - gravity;
        let rotation = &frame.rotation;
        let beta = rotation.transpose() * acceleration;
        let speed = weights.velocity;
        let w = skew(&omega);
        let bent = shape.bending_force(&omega, &alpha, second);
        let force_by_omega = (skew(&omega.cross(&shape.moment))
            + w * skew(&shape.moment)
            + skew(&shape.momentum) * 2.0)
            * (-speed);
        add_block(
            out,
            width,
            0,
            3,
            &(rotation * (force_by_omega - skew(&bent) * turn)),
        );
        let internal = shape.inertia * omega + rows(&shape.coupling, n, rates);
        let inertia_rate = Self::inertia_rate(shape, rates);
        let torque_by_omega = (inertia_rate + w * shape.inertia - skew(&internal)) * speed;
        add_block(
            out,
            width,
            3,
            3,
            &(torque_by_omega + skew(&shape.moment) * skew(&beta) * turn),
        );

        // force by a and ȧ: A (ω̇~ + ω~ω~ + 2 ω~ d/dt) P
        let by_rate = w * (2.0 * speed) + skew(&alpha) + w * w;
        let by_rate = rotation * by_rate;
        for i in 0..3 {
            for k in 0..3 {
                let line = &mut out[i * width + 6..(i + 1) * width];
                add_scaled(
                    line,
                    by_rate[(i, k)],
                    &shape.translation[k * n..(k + 1) * n],
                );
            }
        }
        if let Some(blocks) = &self.bending {
            self.add_bending(
                blocks,
                frame,
                (&w, &beta),
                (rates, second),
                speed,
                moment_by_rate,
                out,
            );
        }
        // torque by a and ȧ
        let beta_cross = skew(&beta);
        for i in 0..3 {
            let line = &mut out[(3 + i) * width + 6..(4 + i) * width];
            add_scaled(line, 1.0, &by_shape[i * n..(i + 1) * n]);
            add_scaled(line, speed, &by_rates[i * n..(i + 1) * n]);
            for k in 0..3 {
                let range = k * n..(k + 1) * n;
                add_scaled(line, w[(i, k)], &turned[range.clone()]);
                add_scaled(line, speed * w[(i, k)], &shape.coupling[range.clone()]);
                add_scaled(line, -beta_cross[(i, k)], &shape.translation[range]);
            }
        }
        // modal by the frame's turn and ω
        let by_turn = beta_cross * turn;
        for (row, line) in out[6 * width..].chunks_exact_mut(width).enumerate() {
            for i in 0..3 {
                let mut x = speed * (coriolis[i * n + row] - along_omega[i * n + row]);
                for k in 0..3 {
                    x += shape.translation[k * n + row] * by_turn[(k, i)];
                }
                line[3 + i] += x;
            }
        }
        self.add_modal_by_shape(&omega, &alpha, speed, out);
    }

    /// Adds the derivative of the modal rows with respect to a and ȧ.
    fn add_modal_by_shape(&self, omega: &V3, alpha: &V3, speed: f64, out: &mut [f64]) {
        let c = &*self.constants;
        let n = c.modes;
        let width = 6 + n;
        for row in 0..n {
            let range = row * n..(row + 1) * n;
            let line = &mut out[(6 + row) * width + 6..(7 + row) * width];
            add_scaled(line, 1.0, &c.stiffness[range.clone()]);
            add_scaled(line, speed, &c.damping[range.clone()]);
            for k in 0..3 {
                add_scaled(line, alpha[k], &c.coriolis[k][range.clone()]);
                add_scaled(line, speed * omega[k], &self.gyroscopic[k][range.clone()]);
            }
            for (p, (i, k)) in PAIRS.into_iter().enumerate() {
                let factor = if i == k { 1.0 } else { 2.0 } * omega[i] * omega[k];
                add_scaled(line, -factor, &c.centrifugal[p][range.clone()]);
            }
        }
    }

    /// Derivatives of the torque along the shape that do not depend on β, 3 × n each. `along_alpha` is with
    /// respect to a, and `by_rates` with respect to ȧ. `turned` is that of `Jω + Bȧ` with respect to a,
    /// `along_omega` that of `J(a) ω`, and `coriolis` is `(G_k − G_kᵀ) ȧ`.
    fn torque_by_shape(
        &self,
        omega: &V3,
        alpha: &V3,
        rates: &[f64],
        second: &[f64],
        work: &mut Work,
    ) {
        let c = &*self.constants;
        let n = c.modes;
        let Work {
            shape,
            modal: product,
            along_alpha: by_shape,
            along_omega,
            by_rates,
            turned,
            coriolis,
            ..
        } = work;
        self.inertia_by_shape(shape, alpha, by_shape);
        self.inertia_by_shape(shape, omega, along_omega);
        // ∂(J̇ω)/∂ȧ, and ∂(Jω + Bȧ)/∂a
        by_rates.clear();
        by_rates.extend_from_slice(along_omega);
        turned.clear();
        turned.extend_from_slice(along_omega);
        clear(coriolis, 3 * n);
        for k in 0..3 {
            let g = &c.coriolis[k];
            let range = k * n..(k + 1) * n;
            clear(product, n);
            add_transposed(product, g, rates);
            add_scaled(&mut by_rates[range.clone()], 1.0, product);
            add_scaled(&mut turned[range.clone()], 1.0, product);
            add_transposed(&mut by_shape[range.clone()], g, second);
            // (G_k − G_kᵀ) ȧ
            add_scaled(&mut coriolis[range.clone()], -1.0, product);
            clear(product, n);
            add_product(product, 1.0, g, rates);
            add_scaled(&mut by_rates[range.clone()], 1.0, product);
            add_scaled(&mut coriolis[range], 1.0, product);
        }
        // ∂(J̇ω)/∂a: rows Σ_k ω_k 2 H_ik ȧ
        for (p, (i, k)) in PAIRS.into_iter().enumerate() {
            clear(product, n);
            add_product(product, 2.0, &c.centrifugal[p], rates);
            for (j, x) in product.iter().enumerate() {
                by_shape[i * n + j] += omega[k] * x;
                if i != k {
                    by_shape[k * n + j] += omega[i] * x;
                }
            }
        }
    }

    /// Adds the derivatives of the second-order parts of the first moment: to the force `A (2 ω~ L ȧ + L ä)`
    /// with respect to a and `2 A L ȧ` with respect to ȧ (from S̈), and to the modal rows `Σ β_k L_k` with
    /// respect to a. `turning` is (ω~, β), and `rates` is (ȧ, ä).
    #[allow(clippy::too_many_arguments)]
    fn add_bending(
        &self,
        blocks: &[Block; 3],
        frame: &BodyFrame,
        turning: (&M3, &V3),
        rates: (&[f64], &[f64]),
        speed: f64,
        room: &mut Vec<f64>,
        out: &mut [f64],
    ) {
        let n = self.modes();
        let width = 6 + n;
        let (w, beta) = turning;
        let by_rate = frame.rotation * (w * 2.0 + M3::identity() * (2.0 * speed));
        for (matrix, x) in [(&by_rate, rates.0), (&frame.rotation, rates.1)] {
            clear(room, 3 * n);
            add_blocks(room, blocks, x);
            for i in 0..3 {
                for j in 0..n {
                    let sum: f64 = (0..3).map(|k| matrix[(i, k)] * room[k * n + j]).sum();
                    out[i * width + 6 + j] += sum;
                }
            }
        }
        for row in 0..n {
            let line = &mut out[(6 + row) * width + 6..(7 + row) * width];
            for (j, y) in line.iter_mut().enumerate() {
                *y += (0..3)
                    .map(|k| beta[k] * blocks[k][row * n + j])
                    .sum::<f64>();
            }
        }
    }

    /// Kinetic energy, potential of gravity (zero at the inertial origin), strain energy (J), power lost in
    /// damping (W).
    pub fn energy(&self, frame: &BodyFrame, v: &[f64], gravity: &V3, work: &mut Work) -> [f64; 4] {
        let (c, a) = (&*self.constants, frame.amplitudes);
        let n = c.modes;
        let omega = V3::new(v[3], v[4], v[5]);
        let rates = &v[6..6 + n];
        let Work {
            shape,
            modal: product,
            ..
        } = work;
        self.shape(a, rates, shape);
        let velocity = V3::new(v[0], v[1], v[2]);
        let momentum = frame.rotation * (omega.cross(&shape.moment) + shape.momentum);
        clear(product, n);
        add_product(product, 0.5, &c.modal_mass, rates);
        let kinetic = 0.5 * c.mass * velocity.norm_squared()
            + velocity.dot(&momentum)
            + omega.dot(&(shape.inertia * omega * 0.5 + rows(&shape.coupling, n, rates)))
            + dot(product, rates);
        let gravity = -gravity.dot(&(frame.position * c.mass + frame.rotation * shape.moment));
        product.fill(0.0);
        add_product(product, 0.5, &c.stiffness, a);
        let strain = dot(product, a);
        product.fill(0.0);
        add_product(product, 1.0, &c.damping, rates);
        [kinetic, gravity, strain, dot(product, rates)]
    }
}
