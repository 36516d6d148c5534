//! Homogeneous equations Σ c u = 0 for which the file names no dependent freedom: this module
//! chooses some freedoms and expresses them by the others.

use std::collections::BTreeMap;

use super::ties::Sum;

/// Coefficient that counts as rounding, in an equation whose largest coefficient was one. A choice some
/// decades above the rounding unit, because each elimination adds some.
const ROUNDING: f64 = 1e-11;

/// `a` + `factor` · `b`, without the entry at `dropped` and without rounding.
fn combined(a: &Sum, factor: f64, b: &Sum, dropped: u32) -> Sum {
    let mut sum = Sum::with_capacity(a.len() + b.len());
    let (mut i, mut j) = (0, 0);
    loop {
        let (freedom, x) = match (a.get(i), b.get(j)) {
            (Some(&(p, x)), Some(&(q, y))) if p == q => {
                i += 1;
                j += 1;
                (p, x + factor * y)
            }
            (Some(&(p, x)), other) if other.is_none_or(|(q, _)| p < *q) => {
                i += 1;
                (p, x)
            }
            (_, Some(&(q, y))) => {
                j += 1;
                (q, factor * y)
            }
            (_, None) => return sum,
        };
        if freedom != dropped && x != 0.0 {
            sum.push((freedom, x));
        }
    }
}

fn largest(sum: &Sum) -> Option<(u32, f64)> {
    // the first of equals, so that the choice does not hang on rounding in the order
    sum.iter().copied().fold(None, |best, entry| match best {
        Some((_, x)) if f64::abs(x) >= entry.1.abs() => best,
        _ => Some(entry),
    })
}

/// Solves equations for the freedoms with the largest coefficients (Gauss–Jordan with the largest pivot of
/// all rows left): each chosen freedom as a sum over freedoms that are not chosen. Equations that follow from
/// others are dropped.
pub fn eliminate(equations: Vec<Sum>) -> BTreeMap<u32, Sum> {
    let mut open: Vec<Sum> = Vec::new();
    for equation in equations {
        if let Some((_, most)) = largest(&equation) {
            open.push(equation.into_iter().map(|(f, x)| (f, x / most)).collect());
        }
    }
    // solved: u_pivot + Σ = 0
    let mut solved: Vec<(u32, Sum)> = Vec::new();
    loop {
        let mut best: Option<(usize, u32, f64)> = None;
        for (row, sum) in open.iter().enumerate() {
            if let Some((freedom, x)) = largest(sum)
                && best.is_none_or(|(.., y)| x.abs() > y.abs())
            {
                best = Some((row, freedom, x));
            }
        }
        let Some((row, pivot, value)) = best.filter(|(.., x)| x.abs() > ROUNDING) else {
            break;
        };
        let chosen: Sum = open
            .swap_remove(row)
            .into_iter()
            .map(|(f, x)| (f, x / value))
            .collect();
        let clear = |sum: &mut Sum| {
            if let Ok(place) = sum.binary_search_by_key(&pivot, |(f, _)| *f) {
                *sum = combined(sum, -sum[place].1, &chosen, pivot);
            }
        };
        open.iter_mut().for_each(clear);
        solved.iter_mut().for_each(|(_, sum)| clear(sum));
        let rest = chosen.into_iter().filter(|(f, _)| *f != pivot).collect();
        solved.push((pivot, rest));
    }
    solved
        .into_iter()
        .map(|(pivot, sum)| (pivot, sum.into_iter().map(|(f, x)| (f, -x)).collect()))
        .collect()
}
