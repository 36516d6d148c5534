//! A small renderer: triangles and lines with hidden parts left out, as a PNG with transparent ground
//! (W3C, "Portable Network Graphics Specification, Second Edition").

use super::packed::deflated;
use flate2::Crc;

/// Samples along each side of a pixel. A choice: four samples make edges smooth.
const FINE: usize = 2;

/// Samples of a picture: colour and nearness.
pub struct Canvas {
    width: usize,
    height: usize,
    /// Nearness of each sample: larger is nearer; `-∞` where nothing is drawn.
    near: Vec<f64>,
    color: Vec<[u8; 3]>,
}

/// A point in pixels and its nearness.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Pixels from the left.
    pub x: f64,
    /// Pixels from the top.
    pub y: f64,
    /// Nearness: larger is nearer.
    pub near: f64,
}

impl Canvas {
    /// An empty picture of a given size in pixels.
    pub fn new(width: usize, height: usize) -> Canvas {
        let (width, height) = (width * FINE, height * FINE);
        Canvas {
            width,
            height,
            near: vec![f64::NEG_INFINITY; width * height],
            color: vec![[0; 3]; width * height],
        }
    }

    fn put(&mut self, x: usize, y: usize, near: f64, color: [u8; 3]) {
        let at = y * self.width + x;
        if let (Some(before), Some(place)) = (self.near.get_mut(at), self.color.get_mut(at))
            && near > *before
        {
            *before = near;
            *place = color;
        }
    }

    /// Samples from `low` to `high` along a side of `count`.
    fn span(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
        let clamp = |value: f64| value.clamp(0.0, count as f64) as usize;
        clamp(low.floor())..clamp(high.ceil() + 1.0)
    }

    /// A triangle of one colour, by the barycentric coordinates of each sample's middle.
    pub fn triangle(&mut self, corners: [Vertex; 3], color: [u8; 3]) {
        let fine = FINE as f64;
        let [a, b, c] = corners.map(|v| (v.x * fine, v.y * fine, v.near));
        let area = (b.0 - a.0) * (c.1 - a.1) - (c.0 - a.0) * (b.1 - a.1);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let least = |u: f64, v: f64, w: f64| u.min(v).min(w);
        let most = |u: f64, v: f64, w: f64| u.max(v).max(w);
        let columns = Canvas::span(least(a.0, b.0, c.0), most(a.0, b.0, c.0), self.width);
        for row in Canvas::span(least(a.1, b.1, c.1), most(a.1, b.1, c.1), self.height) {
            let y = row as f64 + 0.5;
            for column in columns.clone() {
                let x = column as f64 + 0.5;
                let second = ((x - a.0) * (c.1 - a.1) - (c.0 - a.0) * (y - a.1)) / area;
                let third = ((b.0 - a.0) * (y - a.1) - (x - a.0) * (b.1 - a.1)) / area;
                let first = 1.0 - second - third;
                // a sliver's edge belongs to both sides
                if least(first, second, third) >= -1e-9 {
                    let near = first * a.2 + second * b.2 + third * c.2;
                    self.put(column, row, near, color);
                }
            }
        }
    }

    /// A line two pixels wide, drawn nearer by `lift` than its ends.
    pub fn line(&mut self, from: Vertex, to: Vertex, lift: f64, color: [u8; 3]) {
        let fine = FINE as f64;
        let length = libm::hypot(to.x - from.x, to.y - from.y) * fine;
        if !length.is_finite() {
            return;
        }
        let steps = (length.ceil() as usize).clamp(1, 4 * (self.width + self.height));
        for step in 0..=steps {
            let share = step as f64 / steps as f64;
            let between = |a: f64, b: f64| a + share * (b - a);
            let (x, y) = (between(from.x, to.x) * fine, between(from.y, to.y) * fine);
            let near = between(from.near, to.near) + lift;
            // the three or four samples about the point: about two pixels of [`FINE`] samples
            for row in Canvas::span(y - 1.5, y + 0.5, self.height) {
                for column in Canvas::span(x - 1.5, x + 0.5, self.width) {
                    self.put(column, row, near, color);
                }
            }
        }
    }

    /// As the bytes of a PNG, eight bits of red, green, blue and opacity.
    pub fn to_png(&self) -> Vec<u8> {
        let (width, height) = (self.width / FINE, self.height / FINE);
        let mut rows = Vec::with_capacity(height * (1 + 4 * width));
        for row in 0..height {
            // no filter: areas of one colour are short as they are
            rows.push(0);
            for column in 0..width {
                rows.extend(self.pixel(column, row));
            }
        }
        let mut header = Vec::new();
        header.extend((width as u32).to_be_bytes());
        header.extend((height as u32).to_be_bytes());
        // eight bits, colours with opacity, the only compression and filter method, not interlaced
        header.extend([8, 6, 0, 0, 0]);
        let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
        chunk(&mut png, b"IHDR", &header);
        chunk(&mut png, b"IDAT", &deflated(&rows));
        chunk(&mut png, b"IEND", &[]);
        png
    }

    /// The mean of a pixel's samples; its opacity is the share of those that were drawn.
    pub fn pixel(&self, column: usize, row: usize) -> [u8; 4] {
        let mut sum = [0u32; 3];
        let mut drawn = 0u32;
        for y in 0..FINE {
            for x in 0..FINE {
                let at = (row * FINE + y) * self.width + column * FINE + x;
                let near = self.near.get(at).copied().unwrap_or(f64::NEG_INFINITY);
                if near > f64::NEG_INFINITY
                    && let Some(color) = self.color.get(at)
                {
                    drawn += 1;
                    for (sum, part) in sum.iter_mut().zip(color) {
                        *sum += u32::from(*part);
                    }
                }
            }
        }
        if drawn == 0 {
            return [0; 4];
        }
        let [red, green, blue] = sum.map(|s| (s / drawn) as u8);
        let opacity = (255 * drawn / (FINE * FINE) as u32) as u8;
        [red, green, blue, opacity]
    }
}

fn chunk(png: &mut Vec<u8>, kind: &[u8; 4], data: &[u8]) {
    png.extend((data.len() as u32).to_be_bytes());
    png.extend(kind);
    png.extend(data);
    let mut sum = Crc::new();
    sum.update(kind);
    sum.update(data);
    png.extend(sum.sum().to_be_bytes());
}
