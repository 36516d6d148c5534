//! The viewer inside a page: the glTF file, a canvas, controls. Its script reads the same bytes as any other
//! viewer would.

use super::packed::packed;
use super::poster::VIEW;
use super::{Animation, AnimationError};
use crate::escape::{base64, escaped};
use crate::figure::significant;
use std::fmt::Write;

/// The viewer's script, for a page with at least one animation.
pub(crate) const SCRIPT: &str = include_str!("viewer.js");

impl Animation {
    /// Part of a page; no other part of it has the same `id`.
    ///
    /// # Errors
    /// As [`Animation::to_glb`].
    pub(crate) fn in_page(&self, id: &str) -> Result<String, AnimationError> {
        let bytes = self.to_glb()?;
        let title = escaped(&self.title);
        let last = self.times.len().saturating_sub(1);
        let mut text = String::new();
        let stresses = self.first_field().map_or_else(String::new, |range| {
            let (unit, most) = (escaped(&range.unit), significant(range.largest));
            let high = significant(range.high);
            format!(
                "<img class=\"poster\" alt=\"\" width=\"1200\" height=\"675\" src=\"data:image/png;base64,{}\">
<p class=\"poster\"><span class=\"bar\"></span> {}: {} (dark blue) to {high} {unit}{} (yellow){}</p>
",
                base64(&self.to_poster(Some(&range))),
                escaped(&range.name),
                significant(range.low),
                if range.high < range.largest { " and more" } else { "" },
                if range.high < range.largest {
                    format!("; at most {most} {unit}")
                } else {
                    String::new()
                }
            )
        });
        let hidden = |unused: bool| if unused { " hidden" } else { "" };
        let deforms = hidden(self.flexible.is_empty());
        let colors = hidden(self.flexible.is_empty() && self.films.surfaces.is_empty());
        // writing to a String cannot fail
        let _ = write!(
            text,
            "<figure class=\"animation\" id=\"{id}\" aria-labelledby=\"{id}-title\" data-view=\"{} {} {}\">
<div class=\"stage\">
<canvas tabindex=\"0\" role=\"img\" aria-label=\"{title}: moving bodies in three dimensions. Arrow keys turn the view, plus and minus come closer or go away, space starts and stops.\"></canvas>
<img class=\"poster\" alt=\"\" width=\"1200\" height=\"675\" src=\"data:image/png;base64,{}\">
{stresses}<div class=\"colors\" hidden><span class=\"low\"></span><span class=\"bar\"></span><span class=\"high\"></span></div>
<div class=\"kinds\" hidden></div>
</div>
<p class=\"trouble\" role=\"status\" hidden></p>
<div class=\"controls\" hidden>
<button type=\"button\" class=\"play\" aria-pressed=\"false\">Play</button>
<label>Time <input type=\"range\" class=\"time\" min=\"0\" max=\"{last}\" step=\"any\" value=\"0\"></label>
<output class=\"clock\"></output>
<label>Speed <input type=\"range\" class=\"rate\" min=\"-2\" max=\"2\" step=\"0.25\" value=\"0\"></label>
<output class=\"rate-value\"></output>
<label{deforms}>Displacements <input type=\"range\" class=\"scale\" min=\"0\" max=\"2\" step=\"0.01\" value=\"1\"></label>
<output class=\"scale-value\"{deforms}></output>
<label{colors}>Colours <select class=\"color\"><option value=\"body\">by body</option><option value=\"displacement\">displacement</option></select></label>
<button type=\"button\" class=\"home\">Reset view</button>
<a class=\"save\" download=\"{}.glb\" href=\"#{id}\">Save as glTF</a>
</div>
<figcaption id=\"{id}-title\">{title}. {}; {}.</figcaption>
<script type=\"text/plain\" class=\"model\">{}</script>
</figure>
",
            VIEW[0],
            VIEW[1],
            VIEW[2],
            base64(&self.to_poster(None)),
            file_stem(&self.title),
            if self.flexible.is_empty() {
                "All bodies are rigid".to_owned()
            } else {
                format!("Displacements × {} at first", self.scale)
            },
            escaped(&format!(
                "{} times from {:.4} s to {:.4} s, one second of motion in {} s",
                self.times.len(),
                self.times.first().copied().unwrap_or_default(),
                self.times.last().copied().unwrap_or_default(),
                self.slowdown
            )),
            packed(&bytes)
        );
        Ok(text)
    }
}

/// Letters and digits of a title.
pub fn file_stem(title: &str) -> String {
    let stem: String = title
        .chars()
        .map(|c| {
            if c.is_ascii_alphanumeric() {
                c.to_ascii_lowercase()
            } else {
                '-'
            }
        })
        .collect();
    let stem = stem.trim_matches('-');
    if stem.is_empty() {
        "animation".to_owned()
    } else {
        stem.to_owned()
    }
}
