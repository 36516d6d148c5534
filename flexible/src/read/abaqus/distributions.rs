//! `*DISTRIBUTION` over elements: the points of the axes of an `*ORIENTATION`, element by element.
//!
//! The first line is for all elements without a line of their own: `, a1, a2, a3, b1, b2, b3`. Each further line begins with
//! an element or a set of elements. Of several lines for one element the last one counts, as in CalculiX
//! (`distributions.f`).

use std::collections::BTreeMap;

use super::lines::{Row, squeezed};
use super::model::Model;
use super::scope::Block;
use crate::error::FileProblem;
use crate::mesh::Code;

/// The lines of a distribution by element.
#[derive(Debug)]
pub(super) struct Distribution<'m> {
    /// The line of all elements without a line of their own.
    default: &'m Row,
    /// The other lines.
    others: Vec<&'m Row>,
    /// The number of the line, from 1, of each element that has one, by its index in [`Model::rows`].
    of_element: BTreeMap<u32, u32>,
}

impl<'m> Distribution<'m> {
    /// The distribution with a name, of the same place as its user. `None` if it does not hold two points for each element.
    ///
    /// # Errors
    /// No such distribution, table, element or set; no line for the other elements.
    pub fn named(
        (model, code): (&'m Model, Code),
        place: usize,
        name: &str,
        user: &Block,
    ) -> Result<Option<Self>, FileProblem> {
        let Some(block) = model.named_block(Some(place), "DISTRIBUTION", name) else {
            return Err(user.keyword.problem(
                &format!("the distribution {name} is missing"),
                "add its *DISTRIBUTION, or write the points a and b of the axes in place of its name",
            ));
        };
        let keyword = &block.keyword;
        if !matches!(keyword.choice("LOCATION").as_str(), "" | "ELEMENT") {
            return Ok(None);
        }
        // CalculiX reads no table
        let table = keyword.get("TABLE").filter(|_| code != Code::CalculiX);
        if let Some(table) = table {
            let Some(found) = model.named_block(None, "DISTRIBUTIONTABLE", table) else {
                return Err(keyword.problem(
                    &format!("the distribution table {table} is missing"),
                    "add its *DISTRIBUTION TABLE",
                ));
            };
            let fields = found.rows.iter().flat_map(|row| row.fields());
            let kinds: Vec<String> = fields.map(squeezed).collect();
            if kinds != ["COORD3D", "COORD3D"] {
                return Ok(None);
            }
        }
        let mut rows = block.rows.iter().filter(|row| !row.is_blank());
        let Some(default) = rows.next().filter(|row| row.text(0).is_empty()) else {
            return Err(keyword.problem(
                "its first line is not that of the elements without a line of their own",
                "begin the first line with a comma, then the points a and b of the axes",
            ));
        };
        let others: Vec<&Row> = rows.collect();
        let mut of_element = BTreeMap::new();
        for (line, row) in (1_u32..).zip(&others) {
            let elements = row.text(0);
            if elements.is_empty() {
                return Err(row.at.problem(
                    "a line of *DISTRIBUTION names no element",
                    "begin it with an element or a set of elements; only the first line is for the others",
                ));
            }
            for element in model.rows_of(place, elements, &row.at)? {
                of_element.insert(element, line);
            }
        }
        Ok(Some(Distribution {
            default,
            others,
            of_element,
        }))
    }

    /// The line of an element (index into [`Model::rows`]), and its number from 0.
    pub fn line(&self, element: u32) -> (u32, &'m Row) {
        let number = self.of_element.get(&element).copied().unwrap_or(0);
        let place = (number as usize).checked_sub(1);
        let own = place.and_then(|place| self.others.get(place).copied());
        (number, own.unwrap_or(self.default))
    }
}
