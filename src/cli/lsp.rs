//! `eng lsp`.

use super::terminal::Terminal;
use super::{Stop, USAGE_OR_SYSTEM};
use crate::server::{Folders, ServerError, serve, standard};
use crate::sources::cache_folder;

/// Serves an editor on the standard input and output until it ends the connection.
pub(super) fn lsp(console: &mut Terminal<'_>) -> Result<(), Stop> {
    let cache = cache_folder(|name| std::env::var_os(name));
    let library = cache
        .as_ref()
        .map(|cache| cache.join(concat!("library-", env!("CARGO_PKG_VERSION"))));
    let ended = match standard() {
        Err(error) => Err(error.to_string()),
        Ok((connection, transport)) => {
            let served = serve(&connection, Folders { cache, library });
            // the writing thread ends with the connection
            drop(connection);
            match served {
                Ok(()) => transport.join().map_err(|error| error.to_string()),
                Err(ServerError::Protocol(broken)) if broken.channel_is_disconnected() => {
                    Err(match transport.failure() {
                        Some(cause) => cause.to_string(),
                        None => ServerError::Protocol(broken).to_string(),
                    })
                }
                // the protocol asks for this code
                Err(error @ ServerError::Ended) => {
                    writeln!(console.errors, "error: {error}")?;
                    return Err(Stop::Code(1));
                }
                Err(error) => Err(error.to_string()),
            }
        }
    };
    if let Err(error) = ended {
        writeln!(console.errors, "error: {error}")?;
        return Err(Stop::Code(USAGE_OR_SYSTEM));
    }
    Ok(())
}
