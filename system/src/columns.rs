//! Columns of the results that no channel gives.

/// Time.
pub const TIME: &str = "time";
/// The unwrapped cycle angle, of a model with a cycle.
pub const CYCLE_ANGLE: &str = "cycle.angle";
/// The cycle angle's rate.
pub const CYCLE_SPEED: &str = "cycle.speed";
/// The energy audit (J).
pub const ENERGY: [&str; 7] = [
    "energy.kinetic",
    "energy.gravity",
    "energy.strain",
    "energy.damping",
    "energy.work_of_loads",
    "energy.work_of_drives",
    "energy.imbalance",
];

/// All of them for a model with or without a cycle.
pub fn of_every_run(cycle: bool) -> impl Iterator<Item = &'static str> {
    let counted = [CYCLE_ANGLE, CYCLE_SPEED]
        .into_iter()
        .filter(move |_| cycle);
    std::iter::once(TIME).chain(counted).chain(ENERGY)
}
