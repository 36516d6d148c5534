//! Places of inputs and outputs in the flat slices of a film.

/// Inputs of a film at a moment, SI, in the shell's frame. `write` puts them at their places.
#[derive(Clone, Debug, PartialEq)]
pub struct Inputs<'a> {
    /// e: the place where the pin's axis pierces mid width, m.
    pub eccentricity: [f64; 2],
    /// ė, m/s, as seen in the shell's frame.
    pub rate: [f64; 2],
    /// t: slopes of the pin's axis.
    pub tilt: [f64; 2],
    /// ṫ, 1/s.
    pub tilt_rate: [f64; 2],
    /// ω: spin of the pin against the shell, rad/s.
    pub spin: f64,
    /// φ: turn of the pin against the shell, rad. Profiles and openings of the pin use it.
    pub turn: f64,
    /// μ at the cavitation pressure, Pa s.
    pub viscosity: f64,
    /// Pressure at the ends over the cavitation pressure, Pa.
    pub end_pressure: f64,
    /// Pressure of each opening over the cavitation pressure, Pa; of a starved one it has no effect.
    pub supply: &'a [f64],
    /// Amplitude of each shape, m.
    pub deflection: &'a [f64],
    /// Rate of each amplitude, m/s.
    pub deflection_rate: &'a [f64],
}

impl Inputs<'_> {
    /// An aligned pin at rest in the centre, between ends at the cavitation pressure.
    #[must_use]
    pub fn still(viscosity: f64) -> Self {
        Inputs {
            eccentricity: [0.0; 2],
            rate: [0.0; 2],
            tilt: [0.0; 2],
            tilt_rate: [0.0; 2],
            spin: 0.0,
            turn: 0.0,
            viscosity,
            end_pressure: 0.0,
            supply: &[],
            deflection: &[],
            deflection_rate: &[],
        }
    }

    /// The flat inputs.
    #[must_use]
    pub fn write(&self) -> Vec<f64> {
        let mut x = Vec::with_capacity(SUPPLY + self.supply.len() + 2 * self.deflection.len());
        x.extend(
            self.eccentricity
                .iter()
                .chain(&self.rate)
                .chain(&self.tilt)
                .chain(&self.tilt_rate),
        );
        x.extend([self.spin, self.turn, self.viscosity, self.end_pressure]);
        x.extend(
            self.supply
                .iter()
                .chain(self.deflection)
                .chain(self.deflection_rate),
        );
        x
    }
}

/// First of two places of e.
pub const ECCENTRICITY: usize = 0;
/// First of two places of ė.
pub const RATE: usize = 2;
/// First of two places of t.
pub const TILT: usize = 4;
/// First of two places of ṫ.
pub const TILT_RATE: usize = 6;
/// Place of ω.
pub const SPIN: usize = 8;
/// Place of φ.
pub const TURN: usize = 9;
/// Place of μ.
pub const VISCOSITY: usize = 10;
/// Place of the pressure at the ends.
pub const END_PRESSURE: usize = 11;
/// First place of the openings' pressures. The amplitudes of the shapes follow, then their rates.
pub const SUPPLY: usize = 12;

/// First of two outputs of the force on the pin, N.
pub const FORCE: usize = 0;
/// First of two outputs of the moment on the pin about its axis in mid width, N m, along the shell's x and y.
pub const MOMENT: usize = 2;
/// Output of the torque that brakes a pin of positive spin, N m.
pub const TORQUE: usize = 4;
/// Output of the power that becomes heat, by shear, pressure flow and friction of asperities, W.
pub const LOSS: usize = 5;
/// Output of the flow out of both ends where it leaves, m³/s.
pub const SIDE_FLOW: usize = 6;
/// First output of the generalised forces `∫ p ψ dA` of the shapes, N.
pub const SHAPE_FORCE: usize = 7;
