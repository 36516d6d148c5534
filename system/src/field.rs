//! Fields: numbers that an element gets from a separate solver, such as the oil film of a bearing on cells.
//!
//! The text states how the *drives* of a field follow from the motion (`field film: … = reynolds(rate: …)`). A
//! [`FieldKernel`] turns them into *answers*, which loads may use, and into *readings*, which only outputs and
//! conditions may use. Answers have exact derivatives by the drives. Drives, answers and readings are flat
//! slices of SI numbers in the order of the kernel's row in [`KERNELS`].

use crate::dimension::Dimension;
use crate::reduced::ReducedSurface;
use crate::system::FieldSource;
use std::fmt;
use std::sync::Arc;

/// The role of an argument of a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takes {
    /// One number that depends on the motion.
    Drive,
    /// Two numbers that depend on the motion.
    DrivePair,
    /// One number that depends on the motion for each opening.
    Drives,
    /// A number that depends on parameters alone.
    Setting,
    /// One number that depends on parameters alone for each opening.
    Settings,
    /// A whole number in a range; a change compiles again.
    Whole(Range),
    /// A word of a choice among these; a change compiles again.
    Word(&'static [&'static str]),
    /// A marker, whose surface yields to the field if the marker states one.
    Surface,
}

/// A range of whole numbers, with the reason and the remedy for a number on either side of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// The least number.
    pub least: i64,
    /// The largest number.
    pub most: i64,
    /// Reason and remedy for a smaller number.
    pub smaller: &'static str,
    /// The same for a larger number.
    pub larger: &'static str,
}

/// An argument of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct KernelArgument {
    /// Its name.
    pub name: &'static str,
    /// Its dimension; one for words and whole numbers.
    pub dimension: Dimension,
    /// Its role.
    pub takes: Takes,
    /// Whether it is optional. Without it a number is zero, a list is empty, and a word is the first one.
    pub optional: bool,
}

/// One answer or reading of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct KernelResult {
    /// Its name.
    pub name: &'static str,
    /// Its dimension.
    pub dimension: Dimension,
    /// Number of numbers: a list has more than one.
    pub count: u32,
    /// The usual size of its numbers when the first answer is 1 (SI). Static modes of flexible bodies follow
    /// from it.
    pub size: f64,
    /// Whether it is a continuous function of motion and memory. A place that jumps from cell to cell, a number
    /// that changes where a cell ruptures or fills, and an error of the steps are not. They need not repeat in a
    /// motion that repeats, because its steps end at other moments in each cycle.
    pub continuous: bool,
}

/// A quantity in the cells of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct CellQuantity {
    /// Its name in the text.
    pub name: &'static str,
    /// Its dimension.
    pub dimension: Dimension,
    /// The unit in which it is shown, and its size (SI).
    pub unit: (&'static str, f64),
}

/// A kernel that a text can name.
#[derive(Debug)]
pub struct Kernel {
    /// Its name in the text.
    pub name: &'static str,
    /// The problem that it solves.
    pub help: &'static str,
    /// Its arguments.
    pub arguments: &'static [KernelArgument],
    /// Results that loads may use.
    pub answers: &'static [KernelResult],
    /// Results that outputs and conditions alone may use.
    pub readings: &'static [KernelResult],
    /// Quantities in its cells.
    pub cells: &'static [CellQuantity],
}

impl Kernel {
    /// The kernel of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Kernel> {
        KERNELS.iter().find(|kernel| kernel.name == name)
    }

    /// An answer or reading: its row, its first place among the answers or readings, and whether it is an
    /// answer.
    #[must_use]
    pub fn result(&self, name: &str) -> Option<(&'static KernelResult, u32, bool)> {
        for (rows, answer) in [(self.answers, true), (self.readings, false)] {
            let mut first = 0;
            for row in rows {
                if row.name == name {
                    return Some((row, first, answer));
                }
                first += row.count;
            }
        }
        None
    }

    /// Number of answers.
    #[must_use]
    pub fn answer_count(&self) -> u32 {
        self.answers.iter().map(|row| row.count).sum()
    }

    /// Number of readings.
    #[must_use]
    pub fn reading_count(&self) -> u32 {
        self.readings.iter().map(|row| row.count).sum()
    }
}

/// The dimension with these powers of length, mass, time and angle.
const fn of(length: i16, mass: i16, time: i16, angle: i16) -> Dimension {
    Dimension::of_mechanics(length, mass, time, angle)
}

const ONE: Dimension = Dimension::ONE;
const LENGTH: Dimension = Dimension::LENGTH;
const ANGLE: Dimension = Dimension::ANGLE;
const VELOCITY: Dimension = of(1, 0, -1, 0);
const PRESSURE: Dimension = of(-1, 1, -2, 0);
const TORQUE: Dimension = of(2, 1, -2, 0);
const POWER: Dimension = of(2, 1, -3, 0);
const FLOW: Dimension = of(3, 0, -1, 0);

const fn argument(
    name: &'static str,
    dimension: Dimension,
    takes: Takes,
    optional: bool,
) -> KernelArgument {
    KernelArgument {
        name,
        dimension,
        takes,
        optional,
    }
}

const fn result(name: &'static str, dimension: Dimension, count: u32, size: f64) -> KernelResult {
    KernelResult {
        name,
        dimension,
        count,
        size,
        continuous: true,
    }
}

/// A result that is not [`KernelResult::continuous`].
const fn jumping(name: &'static str, dimension: Dimension, count: u32, size: f64) -> KernelResult {
    KernelResult {
        continuous: false,
        ..result(name, dimension, count, size)
    }
}

const fn in_cells(
    name: &'static str,
    dimension: Dimension,
    unit: (&'static str, f64),
) -> CellQuantity {
    CellQuantity {
        name,
        dimension,
        unit,
    }
}

/// Limits of the waves of an elastic ring. The most is a choice: shapes make columns of dense matrices.
const RING_WAVES: Range = Range {
    least: 0,
    most: 60,
    smaller: "0 waves are a rigid ring; bending begins with 2 waves: take 8 at first",
    larger: "a ring is the stiffer the more waves a load has around it: take 8 at first",
};
/// Limits of the cells of a film around. The least is the coarsest grid of a first guess; the most is a choice.
const AROUND: Range = Range {
    least: 12,
    most: 2000,
    smaller: "with 12 cells around the load at an eccentricity ratio of 0.9 is 24 % too large already: take 36 or more",
    larger: "more cells cost time and memory without a use: with 288 x 52 cells the load is some 0.1 % too large. Take 288 or fewer",
};
/// Limits of the cells of a film across. The most is a choice.
const ACROSS: Range = Range {
    least: 1,
    most: 500,
    smaller: "the pressure falls to both ends, and few cells make the load too large: take 6 or more, and twice as many with a groove around",
    larger: "the time of a solution grows with the third power of the cells across: with 288 x 52 cells the load is some 0.1 % too large. Take 52 or fewer",
};

/// All kernels.
pub const KERNELS: &[Kernel] = &[Kernel {
    name: "reynolds",
    help: "the oil film of a journal bearing by Reynolds' equation on cells",
    arguments: &[
        argument("eccentricity", LENGTH, Takes::DrivePair, false),
        argument("rate", VELOCITY, Takes::DrivePair, false),
        argument("tilt", ONE, Takes::DrivePair, true),
        argument("tilt_rate", of(0, 0, -1, 0), Takes::DrivePair, true),
        argument("spin", of(0, 0, -1, 1), Takes::Drive, false),
        argument("turn", ANGLE, Takes::Drive, true),
        argument("viscosity", of(-1, 1, -1, 0), Takes::Drive, false),
        argument("end_pressure", PRESSURE, Takes::Drive, true),
        argument("supply", PRESSURE, Takes::Drives, true),
        argument("diameter", LENGTH, Takes::Setting, false),
        argument("width", LENGTH, Takes::Setting, false),
        argument("radial_clearance", LENGTH, Takes::Setting, false),
        argument("piezo", of(1, -1, 2, 0), Takes::Setting, true),
        argument("opening_from", ANGLE, Takes::Settings, true),
        argument("opening_to", ANGLE, Takes::Settings, true),
        argument("opening_low", LENGTH, Takes::Settings, true),
        argument("opening_high", LENGTH, Takes::Settings, true),
        argument("opening_content", ONE, Takes::Settings, true),
        argument("opening_on_pin", ONE, Takes::Settings, true),
        argument("lemon", LENGTH, Takes::Setting, true),
        argument("lemon_at", ANGLE, Takes::Setting, true),
        argument("offset", LENGTH, Takes::Setting, true),
        argument("offset_at", ANGLE, Takes::Setting, true),
        argument("barrel", LENGTH, Takes::Setting, true),
        argument("taper", LENGTH, Takes::Setting, true),
        argument("relief", LENGTH, Takes::Setting, true),
        argument("relief_reach", ANGLE, Takes::Setting, true),
        argument("relief_at", ANGLE, Takes::Setting, true),
        argument("roughness", LENGTH, Takes::Setting, true),
        argument("rough_direction", ONE, Takes::Setting, true),
        argument("asperity", ONE, Takes::Setting, true),
        argument("asperity_modulus", PRESSURE, Takes::Setting, true),
        argument("boundary_friction", ONE, Takes::Setting, true),
        argument("thin_second", ONE, Takes::Setting, true),
        argument("thin_rate", of(0, 0, -1, 0), Takes::Setting, true),
        argument("thin_exponent", ONE, Takes::Setting, true),
        argument("ring_waves", ONE, Takes::Whole(RING_WAVES), true),
        argument("ring_thickness", LENGTH, Takes::Setting, true),
        argument("ring_width", LENGTH, Takes::Setting, true),
        argument("ring_modulus", PRESSURE, Takes::Setting, true),
        argument("ring_poisson", ONE, Takes::Setting, true),
        argument("surface", ONE, Takes::Surface, true),
        argument("around", ONE, Takes::Whole(AROUND), false),
        argument("across", ONE, Takes::Whole(ACROSS), false),
        argument(
            "cavitation",
            ONE,
            Takes::Word(&["reynolds", "half", "mass_conserving"]),
            true,
        ),
    ],
    answers: &[
        result("force", Dimension::FORCE, 2, 1.0),
        result("moment", TORQUE, 2, 1e-2),
        result("torque", TORQUE, 1, 5e-4),
        result("loss", POWER, 1, 5e-2),
        result("side_flow", FLOW, 1, 1e-9),
    ],
    readings: &[
        result("minimum_film", LENGTH, 1, 1e-6),
        jumping("minimum_film_angle", ANGLE, 1, 1.0),
        jumping("minimum_film_across", LENGTH, 1, 1e-3),
        result("maximum_pressure", PRESSURE, 1, 1e6),
        jumping("maximum_pressure_angle", ANGLE, 1, 1.0),
        jumping("maximum_pressure_across", LENGTH, 1, 1e-3),
        result("inflow", FLOW, 1, 1e-6),
        result("supply_flow", FLOW, 1, 1e-6),
        result("shear_power", POWER, 1, 1.0),
        result("pressure_power", POWER, 1, 1.0),
        result("asperity_share", ONE, 1, 1.0),
        result("asperity_pressure", PRESSURE, 1, 1e6),
        result("boundary_power", POWER, 1, 1.0),
        result("deflection", LENGTH, 1, 1e-6),
        result("last_wave_share", ONE, 1, 1.0),
        result("last_degree_share", ONE, 1, 1.0),
        jumping("cavitated", ONE, 1, 1.0),
        result("content", ONE, 1, 1.0),
        jumping("unexplained_flow", FLOW, 1, 1e-6),
        jumping("stiffness", of(0, 1, -2, 0), 4, 1.0),
        jumping("damping", of(0, 1, -1, 0), 4, 1.0),
    ],
    cells: &FILM_CELLS,
}];

/// The quantities in the cells of a film. `figure … = film(…)` shows them.
pub const FILM_CELLS: [CellQuantity; 4] = [
    in_cells("pressure", PRESSURE, ("MPa", 1e6)),
    in_cells("gap", LENGTH, ("um", 1e-6)),
    in_cells("content", ONE, ("1", 1.0)),
    in_cells("asperity_pressure", PRESSURE, ("MPa", 1e6)),
];

/// The drives of a field in the order of its kernel: for each argument that depends on the motion its name and
/// its count of numbers for this number of openings.
pub fn drives(
    kernel: &Kernel,
    openings: u32,
) -> impl Iterator<Item = (&'static KernelArgument, u32)> + use<> {
    let arguments = kernel.arguments;
    arguments
        .iter()
        .filter_map(move |argument| match argument.takes {
            Takes::Drive => Some((argument, 1)),
            Takes::DrivePair => Some((argument, 2)),
            Takes::Drives => Some((argument, openings)),
            _ => None,
        })
}

/// A field with numbers in place of slots.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldNumbers<'a> {
    /// Its source.
    pub source: &'a FieldSource,
    /// Numbers of the settings (SI), by the name of the argument.
    pub settings: Vec<(&'static str, Vec<f64>)>,
    /// The elastic surface that the field presses on.
    pub surface: Option<&'a ReducedSurface>,
}

impl FieldNumbers<'_> {
    /// The numbers of a setting; none if the kernel has no such argument.
    #[must_use]
    pub fn list(&self, name: &str) -> &[f64] {
        let found = self.settings.iter().find(|(known, _)| *known == name);
        found.map_or(&[], |(_, values)| values)
    }

    /// The first number of a setting, or zero.
    #[must_use]
    pub fn number(&self, name: &str) -> f64 {
        self.list(name).first().copied().unwrap_or(0.0)
    }

    /// A whole number, or zero.
    #[must_use]
    pub fn whole(&self, name: &str) -> i64 {
        let found = self.source.wholes.iter().find(|(known, _)| *known == name);
        found.map_or(0, |(_, value)| *value)
    }

    /// A word, or the empty text.
    #[must_use]
    pub fn word(&self, name: &str) -> &'static str {
        let found = self.source.words.iter().find(|(known, _)| *known == name);
        found.map_or("", |(_, word)| word)
    }
}

/// A field that cannot be made or solved, in words.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldError(pub String);

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for FieldError {}

/// Makes kernels.
pub trait FieldMaker: Send + Sync + fmt::Debug {
    /// The kernel of a field with these numbers.
    ///
    /// # Errors
    /// If a number is out of its range, or the numbers do not fit each other.
    fn make(&self, numbers: &FieldNumbers<'_>) -> Result<Arc<dyn FieldKernel>, FieldError>;
}

/// No kernel: for models without fields.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFields;

impl FieldMaker for NoFields {
    fn make(&self, numbers: &FieldNumbers<'_>) -> Result<Arc<dyn FieldKernel>, FieldError> {
        let name = KERNELS
            .get(numbers.source.kernel as usize)
            .map_or("?", |kernel| kernel.name);
        Err(FieldError(format!("this program has no kernel `{name}`")))
    }
}

/// The cells of a field: a grid around and across a bearing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldGrid {
    /// Radius of the shell (m).
    pub radius: f64,
    /// Lines around (rad), from the shell's x about its z; the last is a turn after the first.
    pub around: Vec<f64>,
    /// Lines across (m), from mid width along the shell's z.
    pub across: Vec<f64>,
    /// Edges of each opening that rests on the grid: around (rad), across (m).
    pub openings: Vec<[[f64; 2]; 2]>,
}

impl FieldGrid {
    /// Number of cells. A cell has the number `column*rows + row`, with columns around and rows across.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.around.len().saturating_sub(1) * self.across.len().saturating_sub(1)
    }

    /// Middles of the cells around (rad) and across (m).
    #[must_use]
    pub fn middles(&self) -> [Vec<f64>; 2] {
        let between = |lines: &[f64]| -> Vec<f64> {
            let pairs = lines.windows(2);
            pairs.map(|pair| (pair[0] + pair[1]) / 2.0).collect()
        };
        [between(&self.around), between(&self.across)]
    }
}

/// The equations of one field. It holds no state.
pub trait FieldKernel: Send + Sync + fmt::Debug {
    /// A solver with memory of its own. `differentiated` states for each answer of the kernel's row whether
    /// its derivatives are read ([`ClassFacts::differentiated`](crate::system::ClassFacts::differentiated)).
    /// Those of answers beyond the end of the list are read.
    fn solver(&self, differentiated: &[bool]) -> Box<dyn FieldSolver>;
    /// Count of numbers that the field keeps from one moment to the next, such as the oil in the cells of a
    /// film.
    fn memory(&self) -> usize;
    /// Count of shapes of an elastic surface that a body moves. Their amplitudes, then their rates, are
    /// drives after those of the kernel's row, and their forces are answers after the others.
    fn shapes(&self) -> usize;
    /// Whether the pin may leave the circle of its clearance, because a surface yields or asperities carry.
    fn yields(&self) -> bool;
    /// Its cells.
    fn grid(&self) -> FieldGrid;
    /// The same field on twice as many cells in both directions.
    ///
    /// # Errors
    /// The reason, as a sentence, for which its solution at a moment does not show the error of the cells.
    fn refined(&self) -> Result<Arc<dyn FieldKernel>, FieldError>;
}

/// The memory of a field at an earlier moment.
#[derive(Clone, Copy, Debug)]
pub struct Past<'a> {
    /// Time since then (s), positive.
    pub step: f64,
    /// The numbers that the field keeps.
    pub memory: &'a [f64],
}

/// How exactly a field is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accuracy {
    /// As exact as possible: differences of the answers show no error.
    Full,
    /// For an iterate of Newton's method. The answers may have an error. It is far below the effect of the change of the drives
    /// since the last solution, so it vanishes as the iterates converge.
    Iterate,
}

/// A field at a moment. The solution depends on the drives and the past alone; a solver keeps only the start of
/// its next search. (With [`Accuracy::Iterate`] the error depends on this start.)
pub trait FieldSolver: Send + Sync + fmt::Debug {
    /// Solves the field at drives and writes the answers. Without a past the memory is in balance: it does not
    /// change.
    ///
    /// # Errors
    /// If the field has no solution there.
    fn solve(
        &mut self,
        drives: &[f64],
        past: Option<Past<'_>>,
        accuracy: Accuracy,
        answers: &mut [f64],
    ) -> Result<(), FieldError>;
    /// Writes the memory at the last solution.
    fn accept(&self, memory: &mut [f64]);
    /// Share of the field at the last solution where its derivatives differ on both sides, such as a film
    /// without pressure, whose cavity is undecided.
    fn undecided(&self) -> f64;
    /// Derivatives of the answers by the drives at the last solution, answer by answer; not finite where there
    /// are none. Those of answers whose derivatives nothing reads may be zero.
    fn tangent(&mut self, slopes: &mut [f64]);
    /// Readings of the last solution. Without `slopes` those that need derivatives of the answers may keep older
    /// numbers.
    fn read(&mut self, readings: &mut [f64], slopes: bool);
    /// Appends numbers of the last solution from which the search for a solution nearby begins well, such as
    /// the cavity of a film.
    fn found(&self, _numbers: &mut Vec<f64>) {}
    /// Begins the next search at numbers of [`FieldSolver::found`], and returns the numbers after its own.
    fn begin_at<'n>(&mut self, numbers: &'n [f64]) -> &'n [f64] {
        numbers
    }
    /// Appends all numbers on which the next searches depend. A solver that takes them continues with the bits of this
    /// one.
    fn kept(&self, numbers: &mut Vec<f64>) {
        self.found(numbers);
    }
    /// Takes numbers of [`FieldSolver::kept`], and returns the numbers after its own.
    fn keep<'n>(&mut self, numbers: &'n [f64]) -> &'n [f64] {
        self.begin_at(numbers)
    }
    /// A quantity of [`Kernel::cells`] in the cells of the last solution (SI).
    fn cells(&self, quantity: usize, out: &mut [f64]);
    /// A copy.
    fn boxed(&self) -> Box<dyn FieldSolver>;
}

impl Clone for Box<dyn FieldSolver> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}
