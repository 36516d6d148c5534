//! SVG to PNG.

use super::{PlotError, font};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::sync::Arc;

/// Draws an SVG of `eng_report::figure`, `scale` pixels a unit, with the embedded fonts alone.
pub fn to_png(svg: &str, scale: f32) -> Result<Vec<u8>, PlotError> {
    let mut options = Options {
        font_family: "DejaVu Sans".to_owned(),
        ..Options::default()
    };
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(font::REGULAR.to_vec());
    fonts.load_font_data(font::BOLD.to_vec());
    let tree = Tree::from_str(svg, &options).map_err(|e| PlotError::Svg(e.to_string()))?;
    let size = tree.size().to_int_size();
    let pixels = |length: u32| (length as f32 * scale).round() as u32;
    let (width, height) = (pixels(size.width()), pixels(size.height()));
    let mut pixmap = Pixmap::new(width, height).ok_or(PlotError::Size { width, height })?;
    resvg::render(
        &tree,
        Transform::from_scale(scale, scale),
        &mut pixmap.as_mut(),
    );
    encoded(width, height, &pixmap.take_demultiplied()).map_err(|e| PlotError::Png(e.to_string()))
}

/// A PNG of pixels in RGBA. The usual compression takes as long as the rest of a picture, so a fast one is used.
fn encoded(width: u32, height: u32, pixels: &[u8]) -> Result<Vec<u8>, png::EncodingError> {
    let mut data = Vec::new();
    let mut encoder = png::Encoder::new(&mut data, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(data)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws a text and counts the pixels that are not white.
    fn dark_pixels(text: &str) -> usize {
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200\" height=\"40\" font-family=\"{}\"><rect width=\"200\" height=\"40\" fill=\"#ffffff\"/><text x=\"5\" y=\"28\" font-size=\"20\">{text}</text></svg>",
            eng_report::figure::FONT_FAMILY
        );
        let png = to_png(&svg, 1.0).unwrap();
        let image = Pixmap::decode_png(&png).unwrap();
        assert_eq!((image.width(), image.height()), (200, 40));
        image.pixels().iter().filter(|p| p.red() < 128).count()
    }

    #[test]
    fn text_is_drawn_with_the_embedded_font() {
        assert_eq!(dark_pixels(""), 0);
        assert!(dark_pixels("Kraft 12 µm °CA ε −3") > 300);
    }

    #[test]
    fn refuses_what_is_no_picture() {
        assert!(matches!(to_png("<svg", 1.0), Err(PlotError::Svg(_))));
        let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"10\" height=\"10\"/>";
        assert!(matches!(to_png(svg, 0.0), Err(PlotError::Size { .. })));
    }

    #[test]
    fn figures_without_data_are_drawn() {
        let history = eng_report::figure::History {
            title: "Nothing".to_owned(),
            subtitle: String::new(),
            abscissa: eng_report::figure::Abscissa::Time,
            ordinate: eng_report::figure::Ordinate {
                quantity: "Force".to_owned(),
                unit: "N".to_owned(),
                frame: String::new(),
            },
            scale: eng_report::figure::Scale::Linear,
            marks: Vec::new(),
            panels: Vec::new(),
        };
        let image = Pixmap::decode_png(&to_png(&history.to_svg(), 0.5).unwrap()).unwrap();
        assert_eq!(image.width(), 600);
    }
}
