//! Colours and dashes, on paper and in a page.

/// Okabe and Ito's palette, whose colours differ for any colour vision ("Color Universal Design", 2008). Its
/// yellow is left out because it is too pale on white. The most different colours come first.
const SERIES: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#000000", "#e69f00", "#56b4e9",
];

/// The same as names of a page's style, which has other shades on a dark sheet.
const SERIES_NAMES: [&str; 7] = [
    "var(--series-0)",
    "var(--series-1)",
    "var(--series-2)",
    "var(--series-3)",
    "var(--series-4)",
    "var(--series-5)",
    "var(--series-6)",
];

/// Dashes, so that curves differ in grey, too.
const DASHES: [&str; 5] = ["", "9 4", "2.5 3", "12 4 2.5 4", "5 2.5"];

/// Levels of a map, dark to bright: cividis (Nuñez, Anderton and Renslow 2018), even for any colour vision
/// and in grey.
const LEVELS: [&str; 16] = [
    "#00224e", "#00306f", "#213d6b", "#3a486b", "#4c546c", "#5c5f6d", "#6b6a6f", "#7a7676",
    "#8a8279", "#9b8e78", "#ac9a74", "#bea76e", "#d0b465", "#e2c258", "#f3d047", "#fee838",
];

/// The place of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Theme {
    /// A file of its own: fixed colours on white.
    Paper,
    /// Inside a page: the page's colours, light or dark.
    Page,
}

/// The role of a line or a text. It decides the colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Color {
    /// The sheet itself.
    Sheet,
    /// Text and axes.
    Ink,
    /// Text of second rank.
    SoftInk,
    /// Grid lines.
    Grid,
    /// Lines of second rank.
    Rule,
    /// Earlier cycles.
    Pale,
    /// The curve with this index.
    Series(usize),
    /// Lines and text on a map, whose colours are the same in any theme.
    OnMap,
    /// Around text on a map.
    MapSeam,
    /// A level of a map, 0 to [`LEVEL_COUNT`] − 1.
    Level(usize),
}

/// Levels of a map.
pub(crate) const LEVEL_COUNT: usize = LEVELS.len();

impl Color {
    /// The value of an attribute.
    pub fn css(self, theme: Theme) -> &'static str {
        let named = |paper, page| match theme {
            Theme::Paper => paper,
            Theme::Page => page,
        };
        match self {
            Color::Sheet => named("#ffffff", "var(--sheet)"),
            Color::Ink => named("#222222", "var(--ink)"),
            Color::SoftInk => named("#595959", "var(--soft-ink)"),
            Color::Grid => named("#e3e3e3", "var(--grid)"),
            Color::Rule => named("#9a9a9a", "var(--rule)"),
            Color::Pale => named("#b9cfdd", "var(--pale)"),
            Color::Series(index) => {
                let index = index % SERIES.len();
                named(SERIES[index], SERIES_NAMES[index])
            }
            Color::OnMap => "#ffffff",
            Color::MapSeam => LEVELS[0],
            Color::Level(index) => LEVELS[index.min(LEVEL_COUNT - 1)],
        }
    }
}

/// Dash pattern of the curve with this index; empty for a solid line.
pub(crate) fn dash(index: usize) -> &'static str {
    DASHES[index % DASHES.len()]
}
