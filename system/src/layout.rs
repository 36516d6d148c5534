//! The places of the inputs and outputs of the functions of an element class.

/// Numbers of a marker: x (3, inertial), R (9, row-major, marker → inertial), ẋ (3, inertial), ω (3, in the
/// MARKER's axes).
pub const MARKER_WIDTH: u32 = 18;
/// The first number of R among those of a marker. The numbers of x come before it.
pub const ROTATION: u32 = 3;
/// First of a marker's numbers that is of ẋ.
pub const VELOCITY: u32 = 12;
/// First of a marker's numbers that is of ω.
pub const ANGULAR_VELOCITY: u32 = 15;

/// Order of a class's inputs: time, markers, states, multipliers, rotation references, answers and readings of
/// fields ([`crate::field`]), constants; and for the
/// outputs function alone: accelerations (for each marker 3 of ẍ, inertial, and 3 of ω̇, marker axes), state
/// rates, signals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct InputLayout {
    /// Markers of the class.
    pub markers: u32,
    /// Own unknowns.
    pub states: u32,
    /// Constraint rows.
    pub rows: u32,
    /// Unwrapped rotations: each has a reference, its value at the last accepted state.
    pub rotations: u32,
    /// Drives of fields: see [`crate::field`].
    pub drives: u32,
    /// Results of fields that loads may use.
    pub answers: u32,
    /// Results of fields that outputs and conditions alone may use.
    pub readings: u32,
    /// Numbers from the bind graph; table handles among them.
    pub constants: u32,
    /// Channels read by outputs.
    pub signals: u32,
}

impl InputLayout {
    /// Index of the time.
    pub const TIME: u32 = 0;

    /// First index of a marker's [`MARKER_WIDTH`] numbers.
    pub fn marker(&self, marker: u32) -> u32 {
        1 + MARKER_WIDTH * marker
    }
    /// Index of a state.
    pub fn state(&self, state: u32) -> u32 {
        self.marker(self.markers) + state
    }
    /// Index of a multiplier.
    pub fn multiplier(&self, row: u32) -> u32 {
        self.state(self.states) + row
    }
    /// Index of a rotation's reference (rad).
    pub fn rotation(&self, rotation: u32) -> u32 {
        self.multiplier(self.rows) + rotation
    }
    /// Index of an answer of a field.
    pub fn answer(&self, answer: u32) -> u32 {
        self.rotation(self.rotations) + answer
    }
    /// Index of a reading of a field.
    pub fn reading(&self, reading: u32) -> u32 {
        self.answer(self.answers) + reading
    }
    /// Index of a constant.
    pub fn constant(&self, constant: u32) -> u32 {
        self.reading(self.readings) + constant
    }
    /// Number of inputs of every function except outputs.
    pub fn len(&self) -> u32 {
        self.constant(self.constants)
    }
    /// Whether there is no input; never, since time is one.
    pub fn is_empty(&self) -> bool {
        false
    }
    /// First index of a marker's six accelerations (outputs function only).
    pub fn acceleration(&self, marker: u32) -> u32 {
        self.len() + 6 * marker
    }
    /// Index of a state's rate (outputs function only).
    pub fn state_rate(&self, state: u32) -> u32 {
        self.acceleration(self.markers) + state
    }
    /// Index of a signal (outputs function only).
    pub fn signal(&self, signal: u32) -> u32 {
        self.state_rate(self.states) + signal
    }
    /// Number of inputs of the outputs function.
    pub fn outputs_len(&self) -> u32 {
        self.signal(self.signals)
    }

    /// Number of directions of a tangent: for each marker 6 of the pose (δx inertial, δπ in marker axes) and
    /// 6 of the twist; states; answers of fields.
    pub fn directions(&self) -> u32 {
        12 * self.markers + self.states + self.answers
    }
    /// First pose direction of a marker.
    pub fn pose_direction(&self, marker: u32) -> u32 {
        6 * marker
    }
    /// First twist direction of a marker.
    pub fn twist_direction(&self, marker: u32) -> u32 {
        6 * self.markers + 6 * marker
    }
    /// Direction of a state.
    pub fn state_direction(&self, state: u32) -> u32 {
        12 * self.markers + state
    }
    /// Direction of an answer of a field.
    pub fn answer_direction(&self, answer: u32) -> u32 {
        12 * self.markers + self.states + answer
    }
    /// First of the drives among the outputs of `residual` and `tangent`.
    pub fn drive(&self, drive: u32) -> u32 {
        self.rows + 6 * self.markers + self.states + drive
    }
    /// Outputs of `residual` and `tangent`: rows, then 6 wrench components a marker, then state rates, then
    /// drives of fields.
    pub fn residual_len(&self) -> u32 {
        self.drive(self.drives)
    }
}
