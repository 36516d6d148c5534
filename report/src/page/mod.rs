//! One self-contained HTML file: text, tables, figures, animations.
//!
//! It loads no part from another place.
//!
//! May contain: markup, style, the two scripts. Must not contain: the drawing of figures, files. The page is
//! readable without scripts, on paper, with the keyboard and with screen readers. It is light or dark as the
//! reader's system is.

mod contents;
pub(crate) mod table;

pub use contents::{EnergyAudit, Mode, Provenance, modes_table};
pub use table::{Cell, Column, Table};

use crate::animation::{Animation, AnimationError, SCRIPT as VIEWER};
use crate::escape::{base64, escaped};
use crate::figure::Figure;
use std::fmt::Write;

const STYLE: &str = include_str!("style.css");
pub(crate) const FIGURES: &str = include_str!("figure.js");

/// A part of a section.
#[derive(Clone, Debug, PartialEq)]
enum Block {
    Paragraph(String),
    Warning(String),
    Facts(Vec<(String, Cell)>),
    List(Vec<String>),
    Code(String),
    Table(Table),
    Figure(Box<Plot>),
    Drawing(Box<Drawing>),
    Animation(Box<Animation>),
    Section(Section),
}

/// A figure with the text below it.
#[derive(Clone, Debug, PartialEq)]
struct Plot {
    figure: Figure,
    caption: String,
    /// The name of its file; empty for a name from the caption.
    name: String,
    /// The text of the figure in the model; may be empty.
    written: String,
}

impl Plot {
    fn caption(&self) -> &str {
        match self.caption.is_empty() {
            true => self.figure.title(),
            false => &self.caption,
        }
    }
}

/// A picture that another program part drew as SVG.
#[derive(Clone, Debug, PartialEq)]
struct Drawing {
    svg: String,
    title: String,
    caption: String,
}

impl Drawing {
    /// The text below it.
    fn caption(&self) -> &str {
        match self.caption.is_empty() {
            true => &self.title,
            false => &self.caption,
        }
    }
}

/// A figure of a page as a file of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberedFigure {
    /// Its number in the page, from 1.
    pub number: usize,
    /// The text below it.
    pub caption: String,
    /// The name of its file, if the text gives one.
    pub name: Option<String>,
    /// The picture.
    pub svg: String,
}

/// A heading with its contents.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    title: String,
    blocks: Vec<Block>,
}

/// The page.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    title: String,
    subtitle: String,
    language: String,
    sections: Vec<Section>,
}

impl Section {
    /// A section without contents.
    pub fn new(title: impl Into<String>) -> Section {
        Section {
            title: title.into(),
            blocks: Vec::new(),
        }
    }

    fn with(mut self, block: Block) -> Section {
        self.blocks.push(block);
        self
    }

    /// A paragraph.
    pub fn paragraph(self, text: impl Into<String>) -> Section {
        self.with(Block::Paragraph(text.into()))
    }

    /// A warning.
    pub fn warning(self, text: impl Into<String>) -> Section {
        self.with(Block::Warning(text.into()))
    }

    /// Names with their values, the summary's form.
    pub fn facts<N: Into<String>, V: Into<Cell>>(
        self,
        facts: impl IntoIterator<Item = (N, V)>,
    ) -> Section {
        let facts = facts
            .into_iter()
            .map(|(name, value)| (name.into(), value.into()))
            .collect();
        self.with(Block::Facts(facts))
    }

    /// Points of a list.
    pub fn list<T: Into<String>>(self, points: impl IntoIterator<Item = T>) -> Section {
        self.with(Block::List(points.into_iter().map(Into::into).collect()))
    }

    /// A text of a program, as it is.
    pub fn code(self, text: impl Into<String>) -> Section {
        self.with(Block::Code(text.into()))
    }

    /// A table.
    pub fn table(self, table: Table) -> Section {
        self.with(Block::Table(table))
    }

    /// A figure with a caption. The caption also describes the figure to readers who cannot see it.
    pub fn figure(self, figure: impl Into<Figure>, caption: impl Into<String>) -> Section {
        self.figure_named(figure, caption, "", "")
    }

    /// A figure of a `report` block, with the name of its file and its text in the block.
    pub fn figure_named(
        self,
        figure: impl Into<Figure>,
        caption: impl Into<String>,
        name: impl Into<String>,
        written: impl Into<String>,
    ) -> Section {
        self.with(Block::Figure(Box::new(Plot {
            figure: figure.into(),
            caption: caption.into(),
            name: name.into(),
            written: written.into(),
        })))
    }

    /// A picture as the text of an SVG file. The page shows it unchanged, and the script does not serve it.
    /// `title` is its name for readers who cannot see it.
    pub fn drawing(
        self,
        svg: impl Into<String>,
        title: impl Into<String>,
        caption: impl Into<String>,
    ) -> Section {
        self.with(Block::Drawing(Box::new(Drawing {
            svg: svg.into(),
            title: title.into(),
            caption: caption.into(),
        })))
    }

    /// An animation.
    pub fn animation(self, animation: Animation) -> Section {
        self.with(Block::Animation(Box::new(animation)))
    }

    /// A section within this one.
    pub fn section(self, section: Section) -> Section {
        self.with(Block::Section(section))
    }
}

impl Page {
    /// A page without contents, in English.
    pub fn new(title: impl Into<String>) -> Page {
        Page {
            title: title.into(),
            subtitle: String::new(),
            language: "en".to_owned(),
            sections: Vec::new(),
        }
    }

    /// The text below the title.
    pub fn subtitle(mut self, text: impl Into<String>) -> Page {
        self.subtitle = text.into();
        self
    }

    /// The language of the texts (BCP 47): `de`.
    pub fn language(mut self, tag: impl Into<String>) -> Page {
        self.language = tag.into();
        self
    }

    /// The next section.
    pub fn section(mut self, section: Section) -> Page {
        self.sections.push(section);
        self
    }

    /// All figures as files of their own, in the order of the page and with its numbers.
    pub fn figures(&self) -> Vec<NumberedFigure> {
        fn gather(section: &Section, found: &mut Vec<NumberedFigure>) {
            for block in &section.blocks {
                let number = found.len() + 1;
                match block {
                    Block::Figure(plot) => found.push(NumberedFigure {
                        number,
                        caption: plot.caption().to_owned(),
                        name: Some(plot.name.clone()).filter(|name| !name.is_empty()),
                        svg: plot.figure.to_svg(),
                    }),
                    Block::Drawing(drawing) => found.push(NumberedFigure {
                        number,
                        caption: drawing.caption().to_owned(),
                        name: None,
                        svg: drawing.svg.clone(),
                    }),
                    Block::Section(section) => gather(section, found),
                    _ => {}
                }
            }
        }
        let mut found = Vec::new();
        for section in &self.sections {
            gather(section, &mut found);
        }
        found
    }

    /// The file's text.
    ///
    /// # Errors
    /// An animation that does not fit together.
    pub fn to_html(&self) -> Result<String, AnimationError> {
        let mut writer = Writer::default();
        for section in &self.sections {
            writer.section(section, 2)?;
        }
        let title = escaped(&self.title);
        let mut text = String::with_capacity(writer.text.len() + 64 * 1024);
        // the policy allows no content of another origin; writing to a String cannot fail
        let _ = write!(
            text,
            "<!DOCTYPE html>
<html lang=\"{}\">
<head>
<meta charset=\"utf-8\">
<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">
<meta name=\"color-scheme\" content=\"light dark\">
<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:\">
<title>{title}</title>
<style>
{STYLE}</style>
</head>
<body>
<a class=\"skip\" href=\"#contents\">Skip to the contents</a>
<header>
<h1>{title}</h1>
",
            escaped(&self.language)
        );
        if !self.subtitle.is_empty() {
            let _ = writeln!(
                text,
                "<p class=\"subtitle\">{}</p>",
                escaped(&self.subtitle)
            );
        }
        text.push_str("</header>\n<nav aria-label=\"Sections\">\n<ol>\n");
        let mut inner = false;
        for (index, (rank, id, title)) in writer.entries.iter().enumerate() {
            if (*rank == 3) != inner {
                // a list within the item before
                text.push_str(if inner { "</li></ul></li>\n" } else { "\n<ul>" });
                inner = !inner;
            } else if index > 0 {
                text.push_str("</li>\n");
            }
            let _ = write!(text, "<li><a href=\"#{id}\">{}</a>", escaped(title));
        }
        text.push_str(match (inner, writer.entries.is_empty()) {
            (true, _) => "</li></ul></li>\n",
            (false, false) => "</li>\n",
            (false, true) => "",
        });
        text.push_str("</ol>\n</nav>\n<main id=\"contents\">\n");
        text.push_str(&writer.text);
        text.push_str("</main>\n");
        for (needed, script) in [(writer.plots > 0, FIGURES), (writer.animations > 0, VIEWER)] {
            if needed {
                let _ = writeln!(text, "<script>\n{script}</script>");
            }
        }
        text.push_str("</body>\n</html>\n");
        Ok(text)
    }
}

#[derive(Default)]
struct Writer {
    text: String,
    /// Sections of the first two ranks: rank, id and title.
    entries: Vec<(usize, String, String)>,
    sections: usize,
    figures: usize,
    /// Number of figures that the script serves.
    plots: usize,
    animations: usize,
}

impl Writer {
    fn put(&mut self, text: std::fmt::Arguments<'_>) {
        // writing to a String cannot fail
        let _ = self.text.write_fmt(text);
    }

    fn section(&mut self, section: &Section, rank: usize) -> Result<(), AnimationError> {
        self.sections += 1;
        let id = format!("section-{}", self.sections);
        if rank <= 3 {
            self.entries.push((rank, id.clone(), section.title.clone()));
        }
        let rank = rank.min(6);
        self.put(format_args!(
            "<section aria-labelledby=\"{id}\">\n<h{rank} id=\"{id}\">{}</h{rank}>\n",
            escaped(&section.title)
        ));
        for block in &section.blocks {
            self.block(block, rank)?;
        }
        self.text.push_str("</section>\n");
        Ok(())
    }

    fn block(&mut self, block: &Block, rank: usize) -> Result<(), AnimationError> {
        match block {
            Block::Paragraph(text) => self.put(format_args!("<p>{}</p>\n", escaped(text))),
            Block::Warning(text) => self.put(format_args!(
                "<p class=\"warning\"><strong>Note:</strong> {}</p>\n",
                escaped(text)
            )),
            Block::Facts(facts) => {
                self.text.push_str("<dl>\n");
                for (name, value) in facts {
                    self.put(format_args!(
                        "<div><dt>{}</dt><dd>{}</dd></div>\n",
                        escaped(name),
                        value.to_html()
                    ));
                }
                self.text.push_str("</dl>\n");
            }
            Block::List(points) => {
                self.text.push_str("<ul>\n");
                for point in points {
                    self.put(format_args!("<li>{}</li>\n", escaped(point)));
                }
                self.text.push_str("</ul>\n");
            }
            Block::Code(text) => {
                // line breaks stay, which `escaped` takes for control characters
                let lines: Vec<String> = text.lines().map(escaped).collect();
                self.put(format_args!(
                    "<pre tabindex=\"0\"><code>{}</code></pre>\n",
                    lines.join("\n")
                ));
            }
            Block::Table(table) => self.text.push_str(&table.to_html()),
            Block::Figure(plot) => self.figure(plot),
            Block::Drawing(drawing) => self.drawing(drawing),
            Block::Animation(animation) => {
                self.animations += 1;
                let id = format!("animation-{}", self.animations);
                let text = animation.in_page(&id)?;
                self.text.push_str(&text);
            }
            Block::Section(section) => self.section(section, rank + 1)?,
        }
        Ok(())
    }

    /// Writes the drawing as an image, whose text can run no script and reach no address.
    fn drawing(&mut self, drawing: &Drawing) {
        self.figures += 1;
        let number = self.figures;
        self.put(format_args!(
            "<figure class=\"drawn\" id=\"figure-{number}\" aria-labelledby=\"figure-{number}-caption\">\n<img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\">\n<figcaption id=\"figure-{number}-caption\"><b>Figure {number}.</b> {}</figcaption>\n</figure>\n",
            escaped(&drawing.title),
            base64(drawing.svg.as_bytes()),
            escaped(drawing.caption())
        ));
    }

    fn figure(&mut self, plot: &Plot) {
        self.figures += 1;
        self.plots += 1;
        let number = self.figures;
        let id = format!("figure-{number}");
        let drawing = plot.figure.in_page(&format!("{id}-"));
        let (width, height) = size_of(&drawing);
        let written = match plot.written.is_empty() {
            true => String::new(),
            false => format!("<br><code>{}</code>", escaped(&plot.written)),
        };
        self.put(format_args!(
            "<figure class=\"plot\" id=\"{id}\" aria-labelledby=\"{id}-caption\">\n<div class=\"sheet\">\n<div class=\"drawn-near\" style=\"max-width:{width}px;aspect-ratio:{width}/{height}\">\n{drawing}</div>\n</div>\n<div class=\"tools\" hidden><button type=\"button\" class=\"reset\" disabled>Show all</button> <span class=\"hint\">Drag to zoom, shift and drag to move; click the drawing to zoom by the wheel or + and −.</span></div>\n<output class=\"readout\" aria-live=\"off\"></output>\n<figcaption id=\"{id}-caption\"><b>Figure {number}.</b> {}{written}</figcaption>\n</figure>\n",
            escaped(plot.caption())
        ));
    }
}

/// Width and height of a drawing from its own text.
fn size_of(drawing: &str) -> (&str, &str) {
    let (_, rest) = drawing.split_once("viewBox=\"0 0 ").unwrap_or_default();
    let (size, _) = rest.split_once('"').unwrap_or_default();
    size.split_once(' ').unwrap_or(("1200", "800"))
}
