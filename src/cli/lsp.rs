//! `eng lsp`.

use super::terminal::Terminal;
use super::{Stop, USAGE_OR_SYSTEM};
use crate::server::{Folders, serve};
use crate::sources::cache_folder;
use lsp_server::Connection;

/// Serves an editor on the standard input and output until it ends the connection.
pub(super) fn lsp(console: &mut Terminal<'_>) -> Result<(), Stop> {
    let cache = cache_folder(|name| std::env::var_os(name));
    let library = cache
        .as_ref()
        .map(|cache| cache.join(concat!("library-", env!("CARGO_PKG_VERSION"))));
    let (connection, threads) = Connection::stdio();
    let served = serve(&connection, Folders { cache, library });
    // the writing thread ends with the connection
    drop(connection);
    let ended = match served {
        Ok(()) => threads.join().map_err(|error| error.to_string()),
        Err(error) => Err(error.to_string()),
    };
    if let Err(error) = ended {
        writeln!(console.errors, "error: {error}")?;
        return Err(Stop::Code(USAGE_OR_SYSTEM));
    }
    Ok(())
}
