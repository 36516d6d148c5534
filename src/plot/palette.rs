//! Colours and dashes of curves.

/// Okabe and Ito's palette, told apart with any colour vision ("Color Universal Design", 2008), without its yellow,
/// which is too pale on white; the order puts the most different ones first.
const COLORS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#000000", "#e69f00", "#56b4e9",
];

/// Dashes, so that curves differ in grey, too.
const DASHES: [&str; 5] = ["", "9 4", "2.5 3", "12 4 2.5 4", "5 2.5"];

/// Text and axes.
pub(super) const INK: &str = "#222222";
/// Text of second rank.
pub(super) const SOFT_INK: &str = "#595959";
/// Grid lines.
pub(super) const GRID: &str = "#e3e3e3";
/// Lines of second rank.
pub(super) const RULE: &str = "#9a9a9a";

/// Colour of the curve with this index.
pub(super) fn color(index: usize) -> &'static str {
    COLORS[index % COLORS.len()]
}

/// Dash pattern of the curve with this index; empty for a solid line.
pub(super) fn dash(index: usize) -> &'static str {
    DASHES[index % DASHES.len()]
}
