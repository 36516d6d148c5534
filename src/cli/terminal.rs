//! The output of the command. It escapes control characters, so that no text of a model, a file or an
//! argument acts on the terminal.

use super::Console;
use crate::render::{self, Colors, visible};
use eng_grammar::{Diagnostics, SourceMap};
use std::fmt;
use std::io::{self, Write};

/// The console. It shows control characters and does not send them.
pub(super) struct Terminal<'a> {
    /// The requested output: tables, messages of `check`.
    pub output: Shown<'a>,
    /// Messages about the run.
    pub errors: Shown<'a>,
    /// Whether a progress bar may be drawn on the process's standard error.
    pub live: bool,
}

impl<'a> Terminal<'a> {
    pub fn new<'b: 'a>(console: &'a mut Console<'b>) -> Terminal<'a> {
        let on = |writer, colored| Shown {
            writer,
            colors: if colored { Colors::Ansi } else { Colors::None },
        };
        Terminal {
            output: on(&mut *console.output, console.colored_output),
            errors: on(&mut *console.errors, console.colored_errors),
            live: console.live,
        }
    }
}

/// A writer of text that escapes control characters.
pub(super) struct Shown<'a> {
    writer: &'a mut dyn Write,
    colors: Colors,
}

impl Shown<'_> {
    /// The function that `write!` and `writeln!` call.
    pub fn write_fmt(&mut self, text: fmt::Arguments<'_>) -> io::Result<()> {
        self.writer.write_all(visible(&text.to_string()).as_bytes())
    }

    /// Writes a text without a change of any character: the contents of a file.
    pub fn write_all(&mut self, text: &[u8]) -> io::Result<()> {
        self.writer.write_all(text)
    }

    /// Prints messages, with colours if the output understands them. Their texts are escaped by the renderer.
    pub fn messages(&mut self, messages: &Diagnostics, sources: &SourceMap) -> io::Result<()> {
        let text = render::human(messages, sources, self.colors);
        self.writer.write_all(text.as_bytes())
    }
}
