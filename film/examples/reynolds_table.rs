//! Writes the table of the law `Reynolds`, some minutes of work:
//! `cargo run --release -p eng-film --example reynolds_table > stdlib/reynolds.csv`

use eng_film::impedance::{HEADER, line, points};
use std::io::{BufWriter, Write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut out = BufWriter::new(std::io::stdout().lock());
    let [slenderness, u, cosine] = points();
    writeln!(out, "{HEADER}")?;
    for wide in &slenderness {
        for u in &u {
            for cosine in &cosine {
                writeln!(out, "{}", line(*wide, *u, *cosine)?)?;
            }
        }
    }
    Ok(())
}
