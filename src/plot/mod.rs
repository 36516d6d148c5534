//! Files of pictures of results, as SVG and as PNG; `eng_report::figure` draws them.
//!
//! PNGs use the two embedded fonts and no font of the machine.

mod font;
mod png;

pub use png::to_png;

use std::path::PathBuf;

/// A picture that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The SVG text was refused by the rasteriser.
    #[error("the picture cannot be drawn: {0}")]
    Svg(String),
    /// More pixels than an image can have, or none.
    #[error("a picture of {width} × {height} pixels cannot be made")]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The image could not be encoded.
    #[error("the picture cannot be encoded as PNG: {0}")]
    Png(String),
    /// The system refused.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
}

/// Writes `NAME.svg` and `NAME.png` into a folder and returns their paths.
pub fn write_svg_and_png(
    svg: &str,
    folder: &std::path::Path,
    name: &str,
) -> Result<[PathBuf; 2], PlotError> {
    let image = to_png(svg, 2.0)?;
    let paths = [
        folder.join(format!("{name}.svg")),
        folder.join(format!("{name}.png")),
    ];
    for (path, bytes) in paths.iter().zip([svg.as_bytes(), &image]) {
        crate::results::replace_file(path, |file: &mut std::fs::File| {
            std::io::Write::write_all(file, bytes)
        })
        .map_err(|source| PlotError::File {
            path: path.clone(),
            source,
        })?;
    }
    Ok(paths)
}
