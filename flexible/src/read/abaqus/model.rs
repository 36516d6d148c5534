//! Instances and the input outside of them, with common numbers of nodes and elements. Names are looked up
//! from each of these places.

use std::collections::BTreeMap;

use super::deck::Deck;
use super::frames::{Motion, STILL};
use super::lines::{key, unquoted};
use super::scope::{Block, Scope, label};
use super::shapes::Shape;
use super::surfaces::Surface;
use crate::error::FileProblem;
use crate::mesh::Node;
use crate::read::labels::Labels;
use crate::read::source::{At, whole};

/// The named objects of a place.
pub(super) type Named<T> = BTreeMap<String, (String, T)>;

/// An instance, or the input outside all instances.
#[derive(Debug, Default)]
pub(super) struct Placed {
    /// Name of the instance; empty for the input outside all instances.
    pub name: String,
    /// Its contents.
    pub scope: Scope,
    /// The motion that places it.
    pub motion: Option<Motion>,
    /// Its nodes.
    pub nodes: Labels,
    /// Its elements, as indices into [`Model::rows`].
    pub elements: Labels,
    /// The number added to its numbers.
    pub offset: u64,
    /// Sets of nodes by name in capitals.
    pub node_sets: Named<Vec<u32>>,
    /// Sets of elements, as indices into [`Model::rows`].
    pub element_sets: Named<Vec<u32>>,
    /// Surfaces.
    pub surfaces: Named<Surface>,
}

impl Placed {
    /// The motion that places it.
    pub fn motion(&self) -> Motion {
        self.motion.unwrap_or(STILL)
    }
}

/// An element of any kind.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// Its number in the file.
    pub label: u64,
    /// Its number in the mesh.
    pub id: u64,
    /// Its shape.
    pub shape: Shape,
    /// Its place, as an index into [`Model::places`].
    pub place: usize,
    /// Start of its nodes in [`Model::row_nodes`].
    first: usize,
    count: usize,
    /// The elements of the mesh made from it: index of the first, and their number.
    pub elements: (u32, u32),
    /// Its place in the file.
    pub at: At,
}

/// The whole model.
#[derive(Debug, Default)]
pub(super) struct Model {
    /// Instances, and last the input outside of them.
    pub places: Vec<Placed>,
    /// Nodes of the mesh.
    pub nodes: Vec<Node>,
    /// All elements.
    pub rows: Vec<Row>,
    row_nodes: Vec<u32>,
}

impl Model {
    /// Gives all nodes and elements of a file common numbers.
    pub fn new(deck: &mut Deck, file: &str) -> Result<Self, FileProblem> {
        let mut model = Model::default();
        for (instance, scope) in deck.placed()? {
            model.places.push(Placed {
                name: instance.name,
                scope,
                motion: Some(instance.motion),
                ..Placed::default()
            });
        }
        model.places.push(Placed {
            scope: std::mem::take(&mut deck.root),
            ..Placed::default()
        });
        for place in 0..model.places.len() {
            model.number_nodes(place)?;
        }
        for place in 0..model.places.len() {
            model.number_elements(place)?;
        }
        model.offset(file)?;
        Ok(model)
    }

    fn number_nodes(&mut self, place: usize) -> Result<(), FileProblem> {
        let Some(placed) = self.places.get_mut(place) else {
            return Ok(());
        };
        let motion = placed.motion();
        let rows = std::mem::take(&mut placed.scope.nodes);
        let mut order = rows
            .iter()
            .enumerate()
            .map(|(i, row)| (row.label, i))
            .collect::<Vec<_>>();
        order.sort_unstable();
        let mut again = Vec::new();
        for pair in order.windows(2) {
            let [(label, one), (other, two)] = *pair else {
                continue;
            };
            if let (true, Some(first), Some(second)) =
                (label == other, rows.get(one), rows.get(two))
            {
                if first.position != second.position {
                    return Err(twice("node", label, &first.at, &second.at));
                }
                again.push(two);
            }
        }
        again.sort_unstable();
        let mut pairs = Vec::with_capacity(rows.len());
        for (i, row) in rows.iter().enumerate() {
            if again.binary_search(&i).is_ok() {
                continue;
            }
            let index = u32::try_from(self.nodes.len())
                .map_err(|_| row.at.problem("too many nodes", "divide the model"))?;
            let position = motion.place(row.position);
            if position.iter().any(|x| !x.is_finite()) {
                return Err(row.at.problem(
                    format!("the position of node {} is not finite", row.label),
                    "check its coordinates and the translation of its instance",
                ));
            }
            pairs.push((row.label, index));
            self.nodes.push(Node {
                id: row.label,
                position,
                frame: None,
            });
        }
        placed.nodes = Labels::new(pairs);
        Ok(())
    }

    fn number_elements(&mut self, place: usize) -> Result<(), FileProblem> {
        let Some(placed) = self.places.get_mut(place) else {
            return Ok(());
        };
        let elements = std::mem::take(&mut placed.scope.elements);
        let labels = std::mem::take(&mut placed.scope.labels);
        let qualified = std::mem::take(&mut placed.scope.qualified);
        let mut pairs = Vec::with_capacity(elements.len());
        for element in elements {
            let index = u32::try_from(self.rows.len())
                .map_err(|_| element.at.problem("too many elements", "divide the model"))?;
            let first = self.row_nodes.len();
            let range = element.first..element.first + element.count;
            for (i, label) in range.clone().zip(labels.get(range).unwrap_or(&[])) {
                let found = match qualified.get(&i) {
                    Some(name) => match *self.nodes_of(place, name, &element.at)?.as_slice() {
                        [node] => Some(node),
                        _ => None,
                    },
                    None => self
                        .places
                        .get(place)
                        .and_then(|placed| placed.nodes.find(*label)),
                };
                let Some(node) = found else {
                    return Err(element.at.problem(
                        format!(
                            "element {} uses node {label}, which is missing",
                            element.label
                        ),
                        "add it to *NODE, or *INCLUDE the file that holds it",
                    ));
                };
                self.row_nodes.push(node);
            }
            pairs.push((element.label, index));
            self.rows.push(Row {
                label: element.label,
                id: element.label,
                shape: element.shape,
                place,
                first,
                count: element.count,
                elements: (0, 0),
                at: element.at,
            });
        }
        let sorted = Labels::new(pairs.clone());
        for (label, index) in pairs {
            if sorted.find(label) != Some(index)
                && let (Some(first), Some(second)) = (
                    sorted
                        .find(label)
                        .and_then(|other| self.rows.get(other as usize)),
                    self.rows.get(index as usize),
                )
            {
                let (first, second) = if first.first < second.first {
                    (first, second)
                } else {
                    (second, first)
                };
                return Err(twice("element", label, &first.at, &second.at));
            }
        }
        if let Some(placed) = self.places.get_mut(place) {
            placed.elements = sorted;
        }
        Ok(())
    }

    /// Makes the numbers of nodes and elements differ among places. If two places share a number, the k-th
    /// place (from 0) adds k times the power of ten above all numbers.
    fn offset(&mut self, file: &str) -> Result<(), FileProblem> {
        let meets = self.places.iter().enumerate().any(|(i, one)| {
            self.places
                .iter()
                .skip(i + 1)
                .any(|other| one.nodes.meets(&other.nodes) || one.elements.meets(&other.elements))
        });
        if !meets {
            return Ok(());
        }
        let largest = self
            .places
            .iter()
            .map(|placed| placed.nodes.largest().max(placed.elements.largest()))
            .max()
            .unwrap_or(0);
        let step = (1..19).map(|n| 10_u64.pow(n)).find(|step| *step > largest);
        let step = step.filter(|step| {
            step.checked_mul(self.places.len() as u64)
                .is_some_and(|end| end < u64::MAX / 2)
        });
        let Some(step) = step else {
            return Err(whole(
                file,
                format!(
                    "a node or an element has the number {largest}, which is too large for {} instances",
                    self.places.len()
                ),
                "give nodes and elements numbers below 1e12",
            ));
        };
        for (k, placed) in self.places.iter_mut().enumerate() {
            placed.offset = step * k as u64;
            for index in placed.nodes.indices() {
                if let Some(node) = self.nodes.get_mut(index as usize) {
                    node.id += placed.offset;
                }
            }
        }
        for row in &mut self.rows {
            row.id += self.places.get(row.place).map_or(0, |placed| placed.offset);
        }
        Ok(())
    }

    /// Nodes of an element.
    pub fn row_nodes(&self, row: &Row) -> &[u32] {
        self.row_nodes
            .get(row.first..row.first + row.count)
            .unwrap_or(&[])
    }

    /// All blocks with their places, in order.
    pub fn blocks(&self) -> impl Iterator<Item = (usize, &Block)> {
        self.places
            .iter()
            .enumerate()
            .flat_map(|(place, placed)| placed.scope.blocks.iter().map(move |block| (place, block)))
    }

    /// The first block of a keyword (capitals, without blanks) with a NAME: at a place, or anywhere.
    pub fn named_block(&self, place: Option<usize>, keyword: &str, name: &str) -> Option<&Block> {
        let wanted = Some(key(name));
        let mut blocks = self.blocks();
        let found = blocks.find(|(of, block)| {
            let known = &block.keyword;
            known.key == keyword
                && place.is_none_or(|place| place == *of)
                && known.get("NAME").map(key) == wanted
        });
        found.map(|(_, block)| block)
    }

    /// The position of a node.
    pub fn position(&self, node: u32) -> [f64; 3] {
        self.nodes
            .get(node as usize)
            .map_or([0.0; 3], |node| node.position)
    }

    /// Looks up a name from a place: in that place, or outside all instances as `Instance.name`.
    pub fn search<'m, T>(
        &'m self,
        place: usize,
        name: &str,
        find: impl Fn(&'m Placed, &str) -> Option<T>,
    ) -> Option<T> {
        let name = unquoted(name);
        let own = self.places.get(place)?;
        find(own, name).or_else(|| {
            if !own.name.is_empty() {
                return None;
            }
            name.match_indices('.').find_map(|(dot, _)| {
                let (instance, rest) = (name.get(..dot)?, name.get(dot + 1..)?);
                let placed = self
                    .places
                    .iter()
                    .find(|placed| !placed.name.is_empty() && key(&placed.name) == key(instance))?;
                find(placed, unquoted(rest))
            })
        })
    }

    /// The instance with a name.
    pub fn instance(&self, name: &str, at: &At) -> Result<usize, FileProblem> {
        self.places
            .iter()
            .position(|placed| !placed.name.is_empty() && key(&placed.name) == key(name))
            .ok_or_else(|| {
                at.problem(
                    format!("the instance {name} is missing"),
                    "check the name, or add its *INSTANCE",
                )
            })
    }

    /// The nodes of a number or of a named set.
    pub fn nodes_of(&self, place: usize, text: &str, at: &At) -> Result<Vec<u32>, FileProblem> {
        self.search(place, text, |placed, name| match label(name) {
            Some(label) => placed.nodes.find(label).map(|node| vec![node]),
            None => placed
                .node_sets
                .get(&key(name))
                .map(|(_, nodes)| nodes.clone()),
        })
        .ok_or_else(|| missing("node", "*NODE or *NSET", text, at))
    }

    /// The single node of a number or of a named set.
    pub fn node_of(&self, place: usize, text: &str, at: &At) -> Result<u32, FileProblem> {
        match *self.nodes_of(place, text, at)?.as_slice() {
            [node] => Ok(node),
            ref nodes => Err(at.problem(
                format!("{text} contains {} nodes instead of one", nodes.len()),
                "give one node, or a set of one node",
            )),
        }
    }

    /// The elements (indices into [`Self::rows`]) of a number or of a named set.
    pub fn rows_of(&self, place: usize, text: &str, at: &At) -> Result<Vec<u32>, FileProblem> {
        self.search(place, text, |placed, name| match label(name) {
            Some(label) => placed.elements.find(label).map(|row| vec![row]),
            None => placed
                .element_sets
                .get(&key(name))
                .map(|(_, rows)| rows.clone()),
        })
        .ok_or_else(|| missing("element", "*ELEMENT or *ELSET", text, at))
    }

    /// The nodes of elements, sorted.
    pub fn nodes_of_rows(&self, rows: &[u32]) -> Vec<u32> {
        let mut nodes = rows
            .iter()
            .filter_map(|row| self.rows.get(*row as usize))
            .flat_map(|row| self.row_nodes(row).iter().copied())
            .collect::<Vec<_>>();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}

fn missing(what: &str, keywords: &str, text: &str, at: &At) -> FileProblem {
    let advice = format!("add it to {keywords}, or *INCLUDE the file that holds it");
    if label(text).is_some() {
        at.problem(format!("{what} {text} is missing"), advice)
    } else {
        at.problem(format!("the {what} set {text} is missing"), advice)
    }
}

fn twice(what: &str, label: u64, first: &At, second: &At) -> FileProblem {
    second.problem(
        format!(
            "{what} {label} is defined twice, first in {}, line {}",
            first.file, first.line
        ),
        "renumber or remove one of them",
    )
}
