//! Messages on the standard input and output.
//!
//! `lsp-server` has such a transport. It reserves the length that a header states, so a header of a few bytes could end
//! the process, and one body that is no JSON ends the connection. Here a length has a limit, and a body that cannot be
//! read gets the error of the protocol.

use crossbeam_channel::{Receiver, Sender, bounded};
use lsp_server::{Connection, ErrorCode, Message};
use serde_json::json;
use std::io::{self, BufRead, Read, Write};
use std::thread::{self, JoinHandle};

/// Longest body (bytes). A choice: no text of a model is near it.
const LONGEST: usize = 1 << 28;
/// Longest line of a header (bytes). A choice.
const LONGEST_LINE: u64 = 4096;

/// The threads that read and write.
pub struct Transport {
    reader: JoinHandle<io::Result<()>>,
    writer: JoinHandle<io::Result<()>>,
}

/// A connection over the standard input and output.
///
/// # Errors
/// The operating system has no thread left.
pub fn standard() -> io::Result<(Connection, Transport)> {
    let (sender, outgoing) = bounded::<Message>(0);
    let (incoming, receiver) = bounded::<Message>(0);
    let writer = thread::Builder::new()
        .name("write".to_owned())
        .spawn(move || write_all(&outgoing))?;
    let reader = thread::Builder::new()
        .name("read".to_owned())
        .spawn(move || read_all(&mut io::stdin().lock(), &incoming))?;
    Ok((
        Connection { sender, receiver },
        Transport { reader, writer },
    ))
}

impl Transport {
    /// The failure of the reader, the cause of a broken connection. The reader must have ended.
    pub fn failure(self) -> Option<io::Error> {
        self.reader.join().ok()?.err()
    }

    /// Waits until everything is written. The connection must be dropped before, and the input at its end.
    ///
    /// # Errors
    /// A message that could not be read or written.
    pub fn join(self) -> io::Result<()> {
        let ended = |_| io::Error::other("a thread of the connection has ended");
        self.reader.join().map_err(ended)??;
        self.writer.join().map_err(ended)?
    }
}

fn write_all(outgoing: &Receiver<Message>) -> io::Result<()> {
    // locked for each message, because the reader answers bodies that it cannot read
    outgoing
        .iter()
        .try_for_each(|message| message.write(&mut io::stdout().lock()))
}

fn read_all(input: &mut impl BufRead, incoming: &Sender<Message>) -> io::Result<()> {
    while let Some(body) = body(input)? {
        match serde_json::from_slice::<Message>(&body) {
            Ok(message) => {
                let last = matches!(&message, Message::Notification(one) if one.method == "exit");
                // the receiver is gone after the end of the server
                if incoming.send(message).is_err() || last {
                    break;
                }
            }
            Err(error) => refuse(&mut io::stdout().lock(), &body, &error)?,
        }
    }
    Ok(())
}

/// Answers a body that is no message. Nobody knows the number of its request.
pub fn refuse(output: &mut impl Write, body: &[u8], error: &serde_json::Error) -> io::Result<()> {
    let code = match serde_json::from_slice::<serde_json::Value>(body) {
        Ok(_) => ErrorCode::InvalidRequest,
        Err(_) => ErrorCode::ParseError,
    };
    let answer = json!({
        "jsonrpc": "2.0", "id": null,
        "error": { "code": code as i32, "message": format!("this is no message: {error}") },
    });
    let answer = answer.to_string();
    write!(output, "Content-Length: {}\r\n\r\n{answer}", answer.len())?;
    output.flush()
}

fn wrong(words: impl Into<String>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, words.into())
}

/// The next body; `None` at the end of the input.
pub fn body(input: &mut impl BufRead) -> io::Result<Option<Vec<u8>>> {
    let mut length = None;
    loop {
        let mut line = Vec::new();
        let read = input
            .by_ref()
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut line)?;
        if read == 0 {
            return Ok(None);
        }
        let text = String::from_utf8_lossy(&line);
        if !text.ends_with('\n') {
            return Err(wrong("a header does not end"));
        }
        let text = text.trim_end();
        if text.is_empty() {
            break;
        }
        let Some((name, value)) = text.split_once(':') else {
            return Err(wrong(format!("this is no header: {text}")));
        };
        if name.eq_ignore_ascii_case("content-length") {
            let stated = value.trim().parse::<usize>().ok();
            let fits = stated.filter(|length| *length <= LONGEST);
            let message = || wrong(format!("a message cannot have the length {}", value.trim()));
            length = Some(fits.ok_or_else(message)?);
        }
    }
    let length = length.ok_or_else(|| wrong("a header states no length"))?;
    let mut body = Vec::new();
    // the memory grows with what comes, and not with what the header promises
    let read = input.by_ref().take(length as u64).read_to_end(&mut body)?;
    match read == length {
        true => Ok(Some(body)),
        false => Err(wrong("the input ends inside of a message")),
    }
}
