//! The embedded fonts.

/// DejaVu Sans Book, reduced to Latin, Greek and the signs of units; licence beside it.
pub(super) const REGULAR: &[u8] = include_bytes!("font/DejaVuSans.ttf");
/// DejaVu Sans Bold, in the same form.
pub(super) const BOLD: &[u8] = include_bytes!("font/DejaVuSans-Bold.ttf");
