//! The last whole cycle of a run.

/// Subtracts whole cycles from the angles, so that the first angle lies in the first cycle.
pub(crate) fn shifted(mut angles: Vec<f64>, period: Option<f64>) -> Vec<f64> {
    if let (Some(period), Some(first)) = (period.filter(|p| *p > 0.0), angles.first().copied()) {
        // an angle just below a whole cycle by rounding begins it
        let whole = period * ((first + 1e-6) / period).floor();
        angles.iter_mut().for_each(|angle| *angle -= whole);
    }
    angles
}

/// Index of the first sample of the last whole cycle, if there is one. The angle may decrease, because a
/// shaft can turn either way.
pub(crate) fn last_cycle(angle: Option<&[f64]>, period: Option<f64>) -> Option<usize> {
    let (angle, period) = (angle?, period?);
    let (first, last) = (angle.first()?, angle.last()?);
    let turned = (last - first).abs();
    // rounding of an unwrapped angle (rad), as in `shifted`
    if period > 0.0 && turned >= period - 1e-6 {
        // samples that the angle passes again on its way back also belong to the last cycle
        let before = angle
            .iter()
            .rposition(|angle| (last - angle).abs() > period + 1e-6);
        Some(before.map_or(0, |index| index + 1))
    } else {
        None
    }
}
