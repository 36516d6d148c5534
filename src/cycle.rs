//! Crank angles within a cycle, and the last whole cycle of a run.

/// Rounding (rad) of a crank angle that was counted over many cycles. A choice: such angles are exact to 1e-9,
/// and samples are much farther apart.
pub(crate) const SLACK: f64 = 1e-6;

/// The whole cycles before an angle (rad). An angle just below a whole cycle by rounding begins it.
fn whole_cycles(angle: f64, period: Option<f64>) -> f64 {
    match period {
        Some(period) if period > 0.0 => period * ((angle + SLACK) / period).floor(),
        _ => 0.0,
    }
}

/// The angle (rad) within its cycle; without a cycle the angle itself.
pub fn cycle_angle(angle: f64, period: Option<f64>) -> f64 {
    let within = angle - whole_cycles(angle, period);
    match period {
        // an angle just below the cycle is its beginning
        Some(_) if (-SLACK..0.0).contains(&within) => 0.0,
        _ => within,
    }
}

/// Subtracts whole cycles from the angles (rad), so that the first angle lies in the first cycle.
pub fn shifted(mut angles: Vec<f64>, period: Option<f64>) -> Vec<f64> {
    if let Some(first) = angles.first().copied() {
        let whole = whole_cycles(first, period);
        angles.iter_mut().for_each(|angle| *angle -= whole);
    }
    angles
}

/// Index of the first sample of the last part of a `length`; `None` if the values do not cover it. They may
/// decrease, because a shaft can turn either way. Values that are passed again on the way back also belong to
/// the part.
pub(crate) fn since(values: &[f64], length: f64, slack: f64) -> Option<usize> {
    let last = values.last()?;
    let far = |value: &f64, length: f64| (last - value).abs() > length;
    if !far(values.first()?, length - slack) {
        return None;
    }
    let before = values.iter().rposition(|v| far(v, length + slack));
    Some(before.map_or(0, |before| before + 1))
}

/// Index of the first sample of the last whole cycle, if there is one.
pub fn last_cycle(angle: Option<&[f64]>, period: Option<f64>) -> Option<usize> {
    since(angle?, period.filter(|p| *p > 0.0)?, SLACK)
}
