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
pub(crate) fn cycle_angle(angle: f64, period: Option<f64>) -> f64 {
    let within = angle - whole_cycles(angle, period);
    match period {
        // an angle just below the cycle is its beginning
        Some(_) if (-SLACK..0.0).contains(&within) => 0.0,
        _ => within,
    }
}

/// Subtracts whole cycles from the angles (rad), so that the first angle lies in the first cycle.
pub(crate) fn shifted(mut angles: Vec<f64>, period: Option<f64>) -> Vec<f64> {
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
pub(crate) fn last_cycle(angle: Option<&[f64]>, period: Option<f64>) -> Option<usize> {
    since(angle?, period.filter(|p| *p > 0.0)?, SLACK)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_does_not_move_an_angle_into_the_cycle_before() {
        let period = Some(4.0);
        for (angle, due) in [(9.0, 1.0), (-1.0, 3.0), (8.0 - 1e-9, 0.0), (3.9, 3.9)] {
            assert!((cycle_angle(angle, period) - due).abs() < 1e-12, "{angle}");
        }
        assert_eq!(cycle_angle(-1e-9, None), -1e-9);
        assert_eq!(shifted(vec![8.0 - 1e-9, 9.0], period)[1], 1.0);
        assert_eq!(shifted(vec![-3.0, -4.0], period), [1.0, 0.0]);
    }

    #[test]
    fn a_last_cycle_has_either_sense() {
        let forwards: Vec<f64> = (0..=10).map(f64::from).collect();
        let backwards: Vec<f64> = forwards.iter().map(|angle| -angle).collect();
        for angle in [&forwards, &backwards] {
            assert_eq!(last_cycle(Some(angle), Some(4.0)), Some(6));
            assert_eq!(last_cycle(Some(angle), Some(10.0)), Some(0));
            assert_eq!(last_cycle(Some(angle), Some(11.0)), None);
        }
    }
}
