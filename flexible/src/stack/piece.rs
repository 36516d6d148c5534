//! Lines and circular arcs in the plane of the sections: points, distances, intersections.

use std::f64::consts::{PI, TAU};

/// A point of the plane.
pub(super) type Point = [f64; 2];

pub(super) fn sum(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

pub(super) fn difference(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn times(factor: f64, a: Point) -> Point {
    [factor * a[0], factor * a[1]]
}

/// The component of a × b along the axis.
pub(super) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn length(a: Point) -> f64 {
    libm::hypot(a[0], a[1])
}

/// The distance of two points.
pub(super) fn apart(a: Point, b: Point) -> f64 {
    length(difference(a, b))
}

pub(super) fn middle(a: Point, b: Point) -> Point {
    times(0.5, sum(a, b))
}

/// The circle of an arc.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arc {
    pub center: Point,
    pub radius: f64,
    /// Angle of the first point.
    start: f64,
    /// Signed angle from the first point to the last.
    sweep: f64,
}

/// A straight line or an arc between two points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub from: Point,
    pub to: Point,
    pub arc: Option<Arc>,
}

impl Piece {
    /// The line from a point to another that turns by an angle (rad), positive from the first axis to the second.
    ///
    /// For the chord c and the bend θ the radius is c/(2 sin(|θ|/2)). The centre lies to the left of the middle of the
    /// chord by c/(2 tan(θ/2)), which is negative, to the right, for θ < 0.
    pub fn new(from: Point, to: Point, bend: f64) -> Self {
        let chord = difference(to, from);
        let (sine, cosine) = libm::sincos(0.5 * bend);
        // the arc of a smaller bend is the chord within rounding
        if sine.abs() < 1e-9 {
            return Piece {
                from,
                to,
                arc: None,
            };
        }
        let left = [-chord[1], chord[0]];
        let center = sum(middle(from, to), times(0.5 * cosine / sine, left));
        let out = difference(from, center);
        Piece {
            from,
            to,
            arc: Some(Arc {
                center,
                radius: 0.5 * length(chord) / sine.abs(),
                start: libm::atan2(out[1], out[0]),
                sweep: bend,
            }),
        }
    }

    /// Its length.
    pub fn length(&self) -> f64 {
        match self.arc {
            Some(arc) => arc.radius * arc.sweep.abs(),
            None => apart(self.from, self.to),
        }
    }

    /// The point at a share of its length.
    pub fn at(&self, share: f64) -> Point {
        if share <= 0.0 {
            return self.from;
        }
        if share >= 1.0 {
            return self.to;
        }
        match self.arc {
            Some(arc) => {
                let (sine, cosine) = libm::sincos(arc.start + share * arc.sweep);
                sum(arc.center, times(arc.radius, [cosine, sine]))
            }
            None => sum(self.from, times(share, difference(self.to, self.from))),
        }
    }

    /// The share of its length at its point nearest to a point.
    pub fn share(&self, point: Point) -> f64 {
        match self.arc {
            Some(arc) => {
                let out = difference(point, arc.center);
                let turned = (libm::atan2(out[1], out[0]) - arc.start) * arc.sweep.signum();
                let turned = turned - TAU * libm::floor(turned / TAU);
                let sweep = arc.sweep.abs();
                if turned <= sweep {
                    turned / sweep
                } else if turned - sweep < TAU - turned {
                    1.0
                } else {
                    0.0
                }
            }
            None => {
                let along = difference(self.to, self.from);
                (dot(difference(point, self.from), along) / dot(along, along)).clamp(0.0, 1.0)
            }
        }
    }

    /// The distance of a point.
    pub fn distance(&self, point: Point) -> f64 {
        apart(point, self.at(self.share(point)))
    }

    /// The part between two shares of its length, whose ends are known.
    pub fn part(&self, first: (f64, Point), last: (f64, Point)) -> Self {
        Piece {
            from: first.1,
            to: last.1,
            arc: self.arc.map(|arc| Arc {
                start: arc.start + first.0 * arc.sweep,
                sweep: (last.0 - first.0) * arc.sweep,
                ..arc
            }),
        }
    }

    /// Twice the area between its arc and the lines from the origin to its ends, positive in the positive sense.
    pub fn twice_area(&self) -> f64 {
        let chord = cross(self.from, self.to);
        match self.arc {
            Some(arc) => chord + arc.radius * arc.radius * (arc.sweep - libm::sin(arc.sweep)),
            None => chord,
        }
    }

    /// Angle by which the direction from a point turns along it (rad).
    ///
    /// The turn of the chord, and a whole turn more if the point is between the arc and its chord.
    pub fn turns(&self, point: Point) -> f64 {
        let (a, b) = (difference(self.from, point), difference(self.to, point));
        let chord = libm::atan2(cross(a, b), dot(a, b));
        let Some(arc) = self.arc else {
            return chord;
        };
        // on the chord its own turn has no sign
        if chord.abs() > PI * (1.0 - 1e-12) {
            return PI * arc.sweep.signum();
        }
        let inside = apart(point, arc.center) < arc.radius;
        // the arc lies to the right of its chord if it turns in the positive sense
        let right = cross(difference(self.to, self.from), difference(point, self.from)) < 0.0;
        if inside && right == (arc.sweep > 0.0) {
            chord + TAU * arc.sweep.signum()
        } else {
            chord
        }
    }

    /// Lower and upper corner of a box around it.
    pub fn bounds(&self) -> [Point; 2] {
        let mut low = [self.from[0].min(self.to[0]), self.from[1].min(self.to[1])];
        let mut high = [self.from[0].max(self.to[0]), self.from[1].max(self.to[1])];
        if let Some(arc) = self.arc {
            // the quarters of the circle that the arc passes
            let ends = [arc.start, arc.start + arc.sweep];
            let (least, most) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            let mut quarter = libm::ceil(least / (0.5 * PI));
            while quarter * 0.5 * PI <= most {
                let (sine, cosine) = libm::sincos(quarter * 0.5 * PI);
                let point = sum(arc.center, times(arc.radius, [cosine, sine]));
                for axis in 0..2 {
                    low[axis] = low[axis].min(point[axis]);
                    high[axis] = high[axis].max(point[axis]);
                }
                quarter += 1.0;
            }
        }
        [low, high]
    }

    /// Common points of two pieces, within a tolerance. Pieces on one line or circle have no such points here: their
    /// ends divide each other.
    pub fn common(&self, other: &Piece, tolerance: f64) -> Vec<Point> {
        let candidates = match (self.arc, other.arc) {
            (None, None) => line_line(self, other),
            (None, Some(arc)) => line_circle(self, &arc, tolerance),
            (Some(arc), None) => line_circle(other, &arc, tolerance),
            (Some(a), Some(b)) => circle_circle(&a, &b, tolerance),
        };
        let on_both = |point: &Point| {
            self.distance(*point) <= tolerance && other.distance(*point) <= tolerance
        };
        candidates.into_iter().filter(on_both).collect()
    }
}

/// The common point of two straight lines, continued beyond their ends.
fn line_line(a: &Piece, b: &Piece) -> Vec<Point> {
    let (along, beside) = (difference(a.to, a.from), difference(b.to, b.from));
    let determinant = cross(along, beside);
    // parallel within rounding
    if determinant.abs() <= 1e-12 * length(along) * length(beside) {
        return Vec::new();
    }
    let share = cross(difference(b.from, a.from), beside) / determinant;
    vec![sum(a.from, times(share, along))]
}

/// Common points of a straight line, continued, and a circle. A line that passes outside within the tolerance touches.
fn line_circle(line: &Piece, arc: &Arc, tolerance: f64) -> Vec<Point> {
    let along = difference(line.to, line.from);
    let along = times(1.0 / length(along), along);
    let foot = sum(
        line.from,
        times(dot(difference(arc.center, line.from), along), along),
    );
    let beside = apart(foot, arc.center);
    let reach = (arc.radius - beside) * (arc.radius + beside);
    if beside > arc.radius + tolerance {
        return Vec::new();
    }
    if beside >= arc.radius - tolerance {
        return vec![foot];
    }
    let half = reach.sqrt();
    vec![
        sum(foot, times(-half, along)),
        sum(foot, times(half, along)),
    ]
}

/// Common points of two circles. Circles that miss each other by the tolerance touch; equal circles have none.
fn circle_circle(a: &Arc, b: &Arc, tolerance: f64) -> Vec<Point> {
    let between = difference(b.center, a.center);
    let distance = length(between);
    let (sum_of, difference_of) = (a.radius + b.radius, (a.radius - b.radius).abs());
    if distance <= tolerance
        || distance > sum_of + tolerance
        || distance < difference_of - tolerance
    {
        return Vec::new();
    }
    let along = times(1.0 / distance, between);
    let foot = 0.5 * (distance + (a.radius - b.radius) * (a.radius + b.radius) / distance);
    let on_line = sum(a.center, times(foot, along));
    let reach = (a.radius - foot) * (a.radius + foot);
    if distance >= sum_of - tolerance || distance <= difference_of + tolerance || reach <= 0.0 {
        // they touch: the point of the first circle towards or away from the other centre
        let outward = if foot < 0.0 { -a.radius } else { a.radius };
        return vec![sum(a.center, times(outward, along))];
    }
    let beside = times(reach.sqrt(), [-along[1], along[0]]);
    vec![sum(on_line, beside), difference(on_line, beside)]
}
