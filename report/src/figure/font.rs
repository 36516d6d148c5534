//! The width of text.

/// Fonts of a picture. The first one has the widths below, and Verdana has nearly the same.
pub const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// Advance widths of the characters from space to `~`, in 1/2048 of the size.
const WIDTHS: [u16; 95] = [
    651, 821, 942, 1716, 1303, 1946, 1597, 563, 799, 799, 1024, 1716, 651, 739, 651, 690, 1303,
    1303, 1303, 1303, 1303, 1303, 1303, 1303, 1303, 1303, 690, 690, 1716, 1716, 1716, 1087, 2048,
    1401, 1405, 1430, 1577, 1294, 1178, 1587, 1540, 604, 604, 1343, 1141, 1767, 1532, 1612, 1235,
    1612, 1423, 1300, 1251, 1499, 1401, 2025, 1403, 1251, 1403, 799, 690, 799, 1716, 1024, 1024,
    1255, 1300, 1126, 1300, 1260, 721, 1300, 1298, 569, 569, 1186, 569, 1995, 1298, 1253, 1300,
    1300, 842, 1067, 803, 1298, 1212, 1675, 1212, 1212, 1075, 1303, 690, 1303, 1716,
];

/// Width of a text in pixels at a font size; other characters than ASCII count as a wide letter.
pub fn text_width(text: &str, size: f64, bold: bool) -> f64 {
    let units: f64 = text
        .chars()
        .map(|character| {
            let index = (character as usize).wrapping_sub(32);
            f64::from(WIDTHS.get(index).copied().unwrap_or(1400))
        })
        .sum();
    // bold letters are at most 13 % wider
    units / 2048.0 * size * if bold { 1.13 } else { 1.0 }
}
