//! Reduces the points of a curve without a visible change of the picture.

/// Number of points in one curve from which on they are reduced. A choice: more than three points a pixel of
/// width show nothing.
const MANY: usize = 4000;

/// Runs of points, each of which is drawn as one line. A point that is not finite ends a run. If there are
/// more than 4,000 points, the first, lowest, highest and last point replace all points in one of `columns`
/// equal parts of the range of x. So no peak is lost.
pub fn runs(x: &[f64], y: &[f64], range: (f64, f64), columns: usize) -> Vec<Vec<(f64, f64)>> {
    let reduce = x.len().min(y.len()) > MANY;
    let width = (range.1 - range.0) / columns.max(1) as f64;
    let mut runs = Vec::new();
    let mut run: Vec<(f64, f64)> = Vec::new();
    let mut bucket: Vec<(f64, f64)> = Vec::new();
    let mut current = i64::MIN;
    for point in x.iter().copied().zip(y.iter().copied()) {
        if !(point.0.is_finite() && point.1.is_finite()) {
            flush(&mut bucket, &mut run);
            if !run.is_empty() {
                runs.push(std::mem::take(&mut run));
            }
            continue;
        }
        if !reduce {
            run.push(point);
            continue;
        }
        let column = ((point.0 - range.0) / width).floor() as i64;
        if column != current {
            flush(&mut bucket, &mut run);
            current = column;
        }
        bucket.push(point);
    }
    flush(&mut bucket, &mut run);
    if !run.is_empty() {
        runs.push(run);
    }
    runs
}

fn flush(bucket: &mut Vec<(f64, f64)>, run: &mut Vec<(f64, f64)>) {
    let Some(last) = bucket.len().checked_sub(1) else {
        return;
    };
    let (mut low, mut high) = (0, 0);
    for (index, point) in bucket.iter().enumerate() {
        if point.1 < bucket[low].1 {
            low = index;
        }
        if point.1 > bucket[high].1 {
            high = index;
        }
    }
    let mut kept = [0, low.min(high), low.max(high), last].to_vec();
    kept.dedup();
    run.extend(kept.into_iter().map(|index| bucket[index]));
    bucket.clear();
}

/// Indices of the points that remain if points closer than `distance` to the last kept point are left out.
/// Both ends remain.
pub fn thinned(points: &[(f64, f64)], distance: f64) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    let mut last: Option<(f64, f64)> = None;
    for (index, point) in points.iter().enumerate() {
        let far = last.is_none_or(|last| {
            let (dx, dy) = (point.0 - last.0, point.1 - last.1);
            dx * dx + dy * dy >= distance * distance
        });
        if far || index + 1 == points.len() {
            kept.push(index);
            last = Some(*point);
        }
    }
    kept
}
