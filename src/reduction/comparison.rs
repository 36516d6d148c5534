//! The modes of a reduced body beside those of another code, as text.

use super::Reduction;
use eng_flexible::FlexibleError;
use eng_flexible::read::matrix::ForeignModes;
use eng_flexible::recover::{ModeComparison, NearestMode, Recovery};
use eng_system::significant::significant;
use std::fmt::{self, Write};

/// The share of the largest frequency of a file below which a mode of a free body is a rigid motion. A choice: the digits of a
/// file leave less, and the first elastic mode of a part has more.
const RIGID: f64 = 1e-4;

impl Reduction {
    /// Each mode of a file of the same mesh beside the mode of the body that is nearest to it by modal assurance: lines for a
    /// person. Rigid motions of a free body are left out.
    ///
    /// # Errors
    /// A file without a node of the mesh, a body without modes, a shape with values missing.
    pub fn compared(&self, given: &ForeignModes) -> Result<String, FlexibleError> {
        let found = Recovery::of_stored(&self.stored)?.compare(given)?;
        let mut text = String::new();
        // writing to a text cannot fail
        let _ = self.write_comparison(&mut text, &given.file, &found);
        Ok(text)
    }

    fn write_comparison(
        &self,
        out: &mut impl Write,
        file: &str,
        found: &ModeComparison,
    ) -> fmt::Result {
        let frequency = |mode: &NearestMode| {
            let angular = libm::sqrt(mode.eigenvalue?.max(0.0));
            Some(angular / (2.0 * std::f64::consts::PI) / self.time)
        };
        let largest = (found.modes.iter())
            .filter_map(frequency)
            .fold(0.0, f64::max);
        let free = !self.stored.report.supported;
        let is_rigid = |mode: &&NearestMode| {
            free && frequency(mode).is_some_and(|frequency| frequency < RIGID * largest)
        };
        let rigid = found.modes.iter().filter(is_rigid).count();
        write!(
            out,
            "  compared with {file}: {} of its {} nodes are in the mesh",
            found.common, found.nodes
        )?;
        match rigid {
            0 => writeln!(out)?,
            _ => writeln!(out, ", {rigid} of its modes are rigid motions")?,
        }
        writeln!(
            out,
            "  its mode  frequency Hz  nearest mode  frequency Hz  difference  modal assurance"
        )?;
        for mode in found.modes.iter().filter(|mode| !is_rigid(mode)) {
            let own = self.frequencies().get(mode.nearest).copied();
            let own = own.unwrap_or(0.0);
            let theirs = frequency(mode).filter(|theirs| *theirs > 0.0);
            let shown = theirs.map_or("–".to_owned(), |theirs| significant(theirs, 7));
            let difference = theirs.map_or("–".to_owned(), |theirs| {
                format!("{:+.3} %", 100.0 * (own / theirs - 1.0))
            });
            writeln!(
                out,
                "  {:>8}  {shown:>12}  {:>12}  {:>12}  {difference:>10}  {:>15.5}",
                mode.number,
                mode.nearest + 1,
                significant(own, 7),
                mode.assurance
            )?;
        }
        Ok(())
    }
}
