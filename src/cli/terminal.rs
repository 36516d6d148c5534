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
        let on = |name, writer, colored| Shown {
            name,
            writer,
            colors: if colored { Colors::Ansi } else { Colors::None },
            closed: false,
        };
        Terminal {
            output: on("output", &mut *console.output, console.colored_output),
            errors: on("error output", &mut *console.errors, console.colored_errors),
            live: console.live,
        }
    }
}

/// A writer of text that escapes control characters. After its reader has closed it, as `head` does, it writes nothing and
/// reports no error: the files of a command are made without a reader, too.
pub(super) struct Shown<'a> {
    /// Its name in messages.
    name: &'static str,
    writer: &'a mut dyn Write,
    colors: Colors,
    closed: bool,
}

impl Shown<'_> {
    /// The function that `write!` and `writeln!` call.
    pub fn write_fmt(&mut self, text: fmt::Arguments<'_>) -> io::Result<()> {
        self.write_all(visible(&text.to_string()).as_bytes())
    }

    /// Writes a text without a change of any character: the contents of a file.
    pub fn write_all(&mut self, text: &[u8]) -> io::Result<()> {
        self.unless_closed(|writer| writer.write_all(text))
    }

    /// Hands everything over that was written.
    pub fn flush(&mut self) -> io::Result<()> {
        self.unless_closed(|writer| writer.flush())
    }

    /// Whether its reader has closed it.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    fn unless_closed(
        &mut self,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        if self.closed {
            return Ok(());
        }
        match write(&mut *self.writer) {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {
                self.closed = true;
                Ok(())
            }
            written => written.map_err(|error| {
                io::Error::new(error.kind(), format!("the {}: {error}", self.name))
            }),
        }
    }

    /// Prints messages, with colours if the output understands them. Their texts are escaped by the renderer.
    pub fn messages(&mut self, messages: &Diagnostics, sources: &SourceMap) -> io::Result<()> {
        let text = render::human(messages, sources, self.colors);
        self.write_all(text.as_bytes())
    }
}
