//! The places of the marks of an axis, and the text of its numbers.

/// Marks of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Ticks {
    /// Ends of the axis.
    pub range: (f64, f64),
    /// Marks with a number.
    pub values: Vec<f64>,
    /// Distance of the marks.
    pub step: f64,
}

/// Smallest and largest finite value; (0, 0) without any.
pub(crate) fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .into_iter()
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    if low > high { (0.0, 0.0) } else { (low, high) }
}

/// Marks at 1, 2, 2.5 or 5 times a power of ten, about `count` of them; the axis ends at marks.
pub fn rounded(low: f64, high: f64, count: usize) -> Ticks {
    let (low, high) = widened(low, high);
    let step = nice_step((high - low) / count.max(1) as f64);
    // an end at a mark, up to rounding, needs no further step
    let first = (low / step + 1e-9).floor();
    let last = (high / step - 1e-9).ceil();
    let values = marks(first, last, step);
    Ticks {
        range: (first * step, last * step),
        values,
        step,
    }
}

/// Marks at round numbers inside an axis that ends where the data end.
pub fn inside(low: f64, high: f64, count: usize) -> Ticks {
    let (low, high) = widened(low, high);
    let step = nice_step((high - low) / count.max(1) as f64);
    within(low, high, step)
}

/// Marks of an axis of equal ratios from `low` to `high`, both above zero: at 1, 2 and 5 times the powers of ten, at the
/// powers alone beyond five decades, and at equal steps up to a ratio of 5.
pub fn ratios(low: f64, high: f64) -> Vec<f64> {
    // a choice: marks at 1, 2 and 5 would be too few
    if high / low < 5.0 {
        return inside(low, high, 8).values;
    }
    let (first, last) = (libm::log10(low).floor(), libm::log10(high).ceil());
    // a choice: marks at 2 and 5 would be too close
    let of_decade: &[f64] = match last - first > 5.0 {
        true => &[1.0],
        false => &[1.0, 2.0, 5.0],
    };
    let decades = first as i32..=last as i32;
    decades
        .flat_map(|power| {
            let unit = libm::pow(10.0, f64::from(power.abs()));
            let unit = move |mark: &f64| if power < 0 { mark / unit } else { mark * unit };
            of_decade.iter().map(unit)
        })
        // an end at a mark, up to rounding, has its number
        .filter(|mark| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(mark))
        .collect()
}

/// A number with the digits that it needs. A power of ten from 10⁵ on is written as such.
pub fn shortest(value: f64) -> String {
    let power = libm::log10(value).round();
    if power >= 5.0 && (value / libm::pow(10.0, power) - 1.0).abs() < 1e-9 {
        power_of_ten(power as i32)
    } else {
        format!("{value}")
    }
}

/// Marks of a crank angle (°), at steps that divide a revolution, or at whole revolutions. There are at most `count` of them.
/// Two cycles of a four-stroke engine are an exception: they have a mark every 90°, as one cycle has.
pub fn crank_angle(low: f64, high: f64, count: usize) -> Ticks {
    const STEPS: [f64; 11] = [
        1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0, 720.0,
    ];
    let (low, high) = widened(low, high);
    let most = count.max(2) as f64 - 1.0;
    let step = STEPS
        .into_iter()
        .find(|step| (high - low) / step <= most)
        .unwrap_or_else(|| 720.0 * nice_step((high - low) / most / 720.0).ceil());
    let quarters = (high - low) / 90.0;
    // two cycles are sixteen quarters of a turn
    // from twelve marks on they have room; 1e-6 is the rounding of the ends. A choice
    let step = if step == 180.0 && most >= 12.0 && quarters <= 16.0 * (1.0 + 1e-6) {
        90.0
    } else {
        step
    };
    within(low, high, step)
}

/// Share of an axis by which it may grow to end at a mark, because samples end one step before 720° or 4 kHz.
/// The share is a choice.
const NEAR: f64 = 0.005;

fn within(low: f64, high: f64, step: f64) -> Ticks {
    let slack = NEAR * (high - low) / step + 1e-6;
    let first = (low / step - slack).ceil();
    let last = (high / step + slack).floor();
    Ticks {
        range: (low.min(first * step), high.max(last * step)),
        values: marks(first, last, step),
        step,
    }
}

fn marks(first: f64, last: f64, step: f64) -> Vec<f64> {
    // callers need a few hundred at most; the limit guards against steps that rounding makes zero
    let count = (last - first).clamp(-1.0, 1000.0) as i64;
    (0..=count).map(|i| (first + i as f64) * step).collect()
}

/// A range of some width.
fn widened(low: f64, high: f64) -> (f64, f64) {
    let size = low.abs().max(high.abs());
    if !(high - low).is_finite() || size == 0.0 {
        (-1.0, 1.0)
    // a constant up to rounding gets an axis of a fifth of its size; a choice
    } else if high - low <= 1e-9 * size {
        (low - 0.1 * size, high + 0.1 * size)
    } else {
        (low, high)
    }
}

fn nice_step(raw: f64) -> f64 {
    let power = libm::pow(10.0, libm::log10(raw).floor());
    let ratio = raw / power;
    let factor = [1.0, 2.0, 2.5, 5.0]
        .into_iter()
        // a ratio that is a factor up to rounding takes this factor
        .find(|factor| ratio <= factor * (1.0 + 1e-9))
        .unwrap_or(10.0);
    factor * power
}

/// The power of ten, a multiple of three, by which the numbers of an axis are divided; 0 if they are short.
pub fn exponent(range: (f64, f64)) -> i32 {
    let size = range.0.abs().max(range.1.abs());
    if size == 0.0 || !size.is_finite() || (0.01..100_000.0).contains(&size) {
        return 0;
    }
    3 * (libm::log10(size) / 3.0).floor() as i32
}

/// A mark's number with as many decimals as the step needs and a true minus sign.
pub fn number(value: f64, step: f64) -> String {
    let decimals = (0..=9)
        .find(|decimals| {
            let scaled = step * libm::pow(10.0, f64::from(*decimals));
            // rounding of the power and of the step
            (scaled - scaled.round()).abs() <= 1e-6 * scaled
        })
        .unwrap_or(9) as usize;
    let text = format!("{value:.decimals$}");
    let zero = text
        .trim_start_matches('-')
        .chars()
        .all(|c| c == '0' || c == '.');
    match text.strip_prefix('-') {
        Some(digits) if zero => digits.to_owned(),
        Some(digits) => format!("−{digits}"),
        None => text,
    }
}

/// Three digits, without trailing zeros.
pub(crate) fn significant(value: f64) -> String {
    let decimals = match value.abs() {
        v if v >= 100.0 => 0,
        v if v >= 10.0 => 1,
        _ => 2,
    };
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// `10³`.
pub fn power_of_ten(exponent: i32) -> String {
    let digits: String = exponent
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '0' => '⁰',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '4' => '⁴',
            '5' => '⁵',
            '6' => '⁶',
            '7' => '⁷',
            '8' => '⁸',
            _ => '⁹',
        })
        .collect();
    format!("10{digits}")
}
