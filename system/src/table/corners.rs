//! Corners of a table: points of an argument at which a derivative jumps.

/// Number of points that [`Corners::beside`] gives: the nearest one and both beside it.
pub const BESIDE: usize = 3;

/// The corners of a table along one argument: its ends, and its inner points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corners<'a> {
    /// The first and the last point, where they are corners.
    pub ends: [Option<f64>; 2],
    /// The points, rising, if the inner ones are corners.
    points: &'a [f64],
    period: Option<f64>,
}

impl<'a> Corners<'a> {
    /// `inner` and `ends` are the highest continuous derivatives at the inner points and at both ends. A
    /// point is a corner if this is below `smooth`. With a period the last point is the first one of the next
    /// period, and both are inner points.
    pub fn new(
        points: &'a [f64],
        period: Option<f64>,
        smooth: u8,
        inner: u8,
        ends: [u8; 2],
    ) -> Corners<'a> {
        let end = |point: Option<&f64>, to: u8| {
            point.copied().filter(|_| period.is_none() && to < smooth)
        };
        Corners {
            ends: [end(points.first(), ends[0]), end(points.last(), ends[1])],
            points: if inner < smooth { points } else { &[] },
            period,
        }
    }

    /// The corner that is nearest to an argument among the inner points, and both beside it. Point number k
    /// has the place `k mod 3`, so it keeps its place while the argument moves by one point. `None` where
    /// there is no such point.
    pub fn beside(&self, x: f64) -> [Option<f64>; BESIDE] {
        let mut found = [None; BESIDE];
        // the points of one period; without a period those between both ends
        let (points, first) = match (self.period, self.points) {
            (Some(_), [points @ .., _]) => (points, 0),
            (None, [_, points @ .., _]) => (points, 1),
            _ => return found,
        };
        let count = points.len() as i64;
        if count == 0 || !x.is_finite() {
            return found;
        }
        let point = |k: i64| match self.period {
            Some(period) => {
                let turns = k.div_euclid(count) as f64;
                points
                    .get(k.rem_euclid(count) as usize)
                    .map(|p| p + turns * period)
            }
            None => usize::try_from(k).ok().and_then(|k| points.get(k)).copied(),
        };
        let (turns, within) = match self.period {
            Some(period) => {
                let turns = ((x - points[0]) / period).floor();
                (turns, x - turns * period)
            }
            None => (0.0, x),
        };
        // a count of periods beyond this one has lost its last digits
        const MOST_PERIODS: f64 = 1e12;
        if turns.abs() > MOST_PERIODS {
            return found;
        }
        let above = points.partition_point(|p| *p <= within) as i64 + turns as i64 * count;
        let distance = |k: i64| point(k).map_or(f64::INFINITY, |p| (x - p).abs());
        let nearest = if distance(above) < distance(above - 1) {
            above
        } else {
            above - 1
        };
        for k in nearest - 1..=nearest + 1 {
            found[(k + first).rem_euclid(BESIDE as i64) as usize] = point(k);
        }
        found
    }
}
