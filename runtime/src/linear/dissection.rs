//! The order of elimination of a matrix: a tree of dense blocks, found once from the pattern.
//!
//! Unknowns with the same neighbours form a group: the velocities of a body, the multipliers of a joint.
//! Groups whose members are coupled among themselves are *firm*, because a body's mass is never singular. The
//! others are *loose*: their diagonal may be zero, and they can be eliminated only together with, or after,
//! the same number of firm unknowns. The graph of the groups is dissected. The firm group whose removal
//! leaves the smallest pieces (a crankshaft, a block) is eliminated last. Then each piece is dissected in
//! turn until it is small. A small piece, such as a rod, a piston and their multipliers, is one dense block
//! with pivoting inside.

use super::Pattern;
use std::collections::BTreeSet;

/// Pieces up to this many unknowns are not dissected. A choice: a dense block of them is faster than the
/// bookkeeping of smaller ones, and pivots may be chosen inside.
const PIECE: usize = 32;
/// Number of additional unknowns for which a block may still be joined with its parent. A choice: two rows of
/// zeros cost less than a block of its own.
const SLACK: usize = 2;
/// Number of groups that are tried as separators: those with most neighbours, and others evenly spread.
/// Choices: a block or a crankshaft has most neighbours. In a chain all have two, and one of evenly spread
/// ones is near its middle.
const HUBS: usize = 16;
const SPREAD: usize = 64;
/// Number of successive separators without effect after which the piece becomes one block. A choice: each
/// makes the border larger.
const PATIENCE: usize = 8;

/// One dense block of the elimination.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrontPlan {
    /// Unknowns eliminated here, and their rows.
    pub pivots: Vec<usize>,
    /// Unknowns of later fronts that these rows and columns reach.
    pub border: Vec<usize>,
    /// The front that receives the remainder of the border.
    pub parent: Option<usize>,
}

/// The fronts, each before its parent. Every unknown is a pivot of exactly one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dissection {
    fronts: Vec<FrontPlan>,
}

/// Unknowns with the same neighbours.
#[derive(Clone, Debug)]
struct Group {
    members: Vec<usize>,
    firm: bool,
    neighbours: BTreeSet<usize>,
}

struct Graph {
    groups: Vec<Group>,
}

/// A front before its unknowns are written out: groups and children.
struct Node {
    pivots: Vec<usize>,
    border: BTreeSet<usize>,
    children: Vec<Node>,
}

impl Graph {
    fn new(pattern: &Pattern) -> Graph {
        let n = pattern.size();
        let mut adjacent = vec![BTreeSet::new(); n];
        for column in 0..n {
            for row in pattern.rows_of(column) {
                if *row != column {
                    adjacent[column].insert(*row);
                    adjacent[*row].insert(column);
                }
            }
        }
        let mut groups: Vec<Group> = Vec::new();
        let mut group_of = vec![0; n];
        for unknown in 0..n {
            let joined = groups.last_mut().is_some_and(|group| {
                let first = group.members[0];
                let coupled = adjacent[first].contains(&unknown);
                if group.members.len() > 1 && coupled != group.firm {
                    return false;
                }
                let same = adjacent[first]
                    .iter()
                    .filter(|x| **x != unknown)
                    .eq(adjacent[unknown].iter().filter(|x| **x != first));
                if same {
                    group.members.push(unknown);
                    group.firm = coupled;
                }
                same
            });
            if !joined {
                groups.push(Group {
                    members: vec![unknown],
                    firm: false,
                    neighbours: BTreeSet::new(),
                });
            }
            group_of[unknown] = groups.len() - 1;
        }
        for index in 0..groups.len() {
            let neighbours = groups[index]
                .members
                .iter()
                .flat_map(|m| &adjacent[*m])
                .map(|x| group_of[*x])
                .filter(|g| *g != index)
                .collect();
            groups[index].neighbours = neighbours;
        }
        Graph { groups }
    }

    fn weight<'a>(&self, groups: impl IntoIterator<Item = &'a usize>) -> usize {
        let sizes = groups.into_iter().map(|g| self.groups[*g].members.len());
        sizes.sum()
    }

    /// Connected parts, in the order of their first groups.
    fn parts(&self, of: &BTreeSet<usize>) -> Vec<BTreeSet<usize>> {
        let mut left = of.clone();
        let mut parts = Vec::new();
        while let Some(first) = left.pop_first() {
            let mut part = BTreeSet::from([first]);
            let mut open = vec![first];
            while let Some(group) = open.pop() {
                for next in &self.groups[group].neighbours {
                    if left.remove(next) {
                        part.insert(*next);
                        open.push(*next);
                    }
                }
            }
            parts.push(part);
        }
        parts
    }

    /// The firm group whose removal leaves the smallest largest part; among equals the one with most
    /// neighbours, then the first.
    fn separator(&self, of: &BTreeSet<usize>) -> Option<usize> {
        let firm: Vec<usize> = of
            .iter()
            .copied()
            .filter(|g| self.groups[*g].firm)
            .collect();
        let mut hubs = firm.clone();
        hubs.sort_by_key(|g| (usize::MAX - self.groups[*g].neighbours.len(), *g));
        hubs.truncate(HUBS);
        let spread = firm.iter().step_by(firm.len().div_ceil(SPREAD).max(1));
        let tried: BTreeSet<usize> = hubs.iter().chain(spread).copied().collect();
        let mut best: Option<(usize, usize, usize)> = None;
        for group in &tried {
            let mut rest = of.clone();
            rest.remove(group);
            let parts = self.parts(&rest);
            let largest = parts.iter().map(|p| self.weight(p)).max().unwrap_or(0);
            let degree = self.groups[*group].neighbours.len();
            if best
                .is_none_or(|(size, most, _)| (largest, most) < (size, degree) && largest <= size)
            {
                best = Some((largest, degree, *group));
            }
        }
        best.map(|(_, _, group)| group)
    }

    /// Moves loose groups that touch the separator out of a part, until it has a firm unknown for each loose
    /// one.
    fn relieve(&self, part: &mut BTreeSet<usize>, separator: &mut Vec<usize>) {
        loop {
            let count =
                |firm: bool| self.weight(part.iter().filter(|g| self.groups[**g].firm == firm));
            let excess = count(false).saturating_sub(count(true));
            if excess == 0 {
                return;
            }
            let touching = part.iter().copied().filter(|g| {
                !self.groups[*g].firm
                    && self.groups[*g]
                        .neighbours
                        .iter()
                        .any(|n| separator.contains(n))
            });
            // the smallest sufficient group, else the largest
            let Some(moved) = touching.min_by_key(|g| {
                let size = self.groups[*g].members.len();
                (
                    size < excess,
                    if size < excess {
                        usize::MAX - size
                    } else {
                        size
                    },
                    *g,
                )
            }) else {
                return;
            };
            part.remove(&moved);
            separator.push(moved);
        }
    }

    /// `patience`: how many more separators may part nothing.
    fn dissect(&self, of: BTreeSet<usize>, patience: usize) -> Node {
        let mut left = patience;
        let separator = if self.weight(&of) <= PIECE || patience == 0 {
            None
        } else {
            self.separator(&of)
        };
        let (mut pivots, pieces) = match separator {
            None => (of.into_iter().collect::<Vec<_>>(), Vec::new()),
            Some(separator) => {
                let mut pivots = vec![separator];
                let mut rest = of;
                rest.remove(&separator);
                let mut open = self.parts(&rest);
                left = if open.len() > 1 {
                    PATIENCE
                } else {
                    patience - 1
                };
                let mut pieces = Vec::new();
                while let Some(mut part) = open.pop() {
                    let before = pivots.len();
                    self.relieve(&mut part, &mut pivots);
                    if pivots.len() > before {
                        open.extend(self.parts(&part));
                    } else {
                        pieces.push(part);
                    }
                }
                pieces.sort();
                (pivots, pieces)
            }
        };
        // bodies come before multipliers, which saves exchanges of rows
        pivots.sort_by_key(|g| (!self.groups[*g].firm, *g));
        let children: Vec<Node> = pieces.into_iter().map(|p| self.dissect(p, left)).collect();
        let mut node = Node {
            pivots,
            border: BTreeSet::new(),
            children: Vec::new(),
        };
        for child in children {
            node.border.extend(&child.border);
            node.children.push(child);
        }
        for group in &node.pivots {
            node.border.extend(&self.groups[*group].neighbours);
        }
        let below = |node: &Node| {
            let mut all = BTreeSet::new();
            collect(node, &mut all);
            all
        };
        let own = below(&node);
        node.border.retain(|g| !own.contains(g));
        self.join(node)
    }

    /// Merges children into a node if their border is nearly the whole node.
    fn join(&self, mut node: Node) -> Node {
        let mut kept = Vec::new();
        for child in std::mem::take(&mut node.children) {
            let whole = self.weight(&node.pivots) + self.weight(&node.border);
            if !child.children.is_empty() && self.weight(&child.border) + SLACK >= whole {
                let mut pivots = child.pivots;
                pivots.append(&mut node.pivots);
                node.pivots = pivots;
                kept.extend(child.children);
            } else {
                kept.push(child);
            }
        }
        node.children = kept;
        node
    }
}

fn collect(node: &Node, all: &mut BTreeSet<usize>) {
    all.extend(&node.pivots);
    for child in &node.children {
        collect(child, all);
    }
}

impl Dissection {
    /// The fronts.
    pub fn fronts(&self) -> &[FrontPlan] {
        &self.fronts
    }

    /// Plans the elimination of a pattern.
    pub fn new(pattern: &Pattern) -> Dissection {
        let graph = Graph::new(pattern);
        let all = (0..graph.groups.len()).collect();
        let mut dissection = Dissection { fronts: Vec::new() };
        for part in graph.parts(&all) {
            let node = graph.dissect(part, PATIENCE);
            dissection.write(&graph, &node);
        }
        dissection
    }

    /// Writes a node after its children; returns its index.
    fn write(&mut self, graph: &Graph, node: &Node) -> usize {
        let children: Vec<usize> = node
            .children
            .iter()
            .map(|child| self.write(graph, child))
            .collect();
        let unknowns = |groups: &mut dyn Iterator<Item = &usize>| -> Vec<usize> {
            groups
                .flat_map(|g| graph.groups[*g].members.iter().copied())
                .collect()
        };
        let index = self.fronts.len();
        self.fronts.push(FrontPlan {
            pivots: unknowns(&mut node.pivots.iter()),
            border: unknowns(&mut node.border.iter()),
            parent: None,
        });
        for child in children {
            self.fronts[child].parent = Some(index);
        }
        index
    }
}
