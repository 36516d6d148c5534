//! The `eng` command.
fn main() {}
