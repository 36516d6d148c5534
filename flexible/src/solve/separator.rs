//! A small set of vertices whose removal cuts a graph into two parts of about equal weight.

use super::coarsening::coarsen;
use super::graph::Graph;
use super::random::Random;
use std::collections::{BinaryHeap, VecDeque};

/// The part of a vertex: 0, 1 or the separator.
pub(crate) type Side = u8;
/// The separator.
pub(crate) const SEPARATOR: Side = 2;

/// The largest share of the whole weight that a part may have. A choice: halves would force long separators,
/// and parts of much more leave nothing for the other threads and levels.
const HEAVIEST_PART: f64 = 0.6;
/// Graphs are coarsened to about this many vertices before the first cut. A choice: the shape of the graph is
/// still there, and several first cuts take no time.
const COARSEST: usize = 120;
/// Number of first cuts tried on the coarsest graph: for a large graph, and for a small one, whose separator
/// matters less. A choice: they begin at random vertices, so some may be poor.
const FIRST_CUTS: [usize; 2] = [8, 4];
/// A graph with at least this many vertices counts as large. A choice: it decides the effort of the first
/// cuts, and through them the order of the elimination, not its result.
const LARGE: usize = 1000;
/// The largest number of refinement passes on each level. A choice: the first passes gain most, and a pass
/// without gain ends them.
const PASSES: usize = 8;
/// A pass ends after this many moves without gain. A choice: moves may have to climb out of a poor cut, but
/// not through the whole part.
const PATIENCE: usize = 80;

/// The sides of all vertices: multilevel, with a greedily grown first cut and refinement on each level
/// (Hendrickson, Rothberg: Improving the run time and quality of nested dissection ordering, SIAM J. Sci.
/// Comput. 20, 1998).
pub(crate) fn separate(graph: &Graph, random: &mut Random) -> Vec<Side> {
    let total = graph.total_weight();
    let heaviest = (1.5 * total as f64 / COARSEST as f64).max(1.0) as u32;
    let mut levels: Vec<(Graph, Vec<u32>)> = Vec::new();
    loop {
        let finest = levels.last().map_or(graph, |level| &level.0);
        if finest.vertices() <= COARSEST {
            break;
        }
        let (small, map) = coarsen(finest, heaviest, random);
        if small.vertices() * 20 > finest.vertices() * 19 {
            break;
        }
        levels.push((small, map));
    }
    let coarsest = levels.last().map_or(graph, |level| &level.0);
    let mut best: Option<Cut> = None;
    for _ in 0..FIRST_CUTS[usize::from(graph.vertices() < LARGE)] {
        let mut cut = Cut::grow(coarsest, random);
        cut.refine(coarsest);
        if best.as_ref().is_none_or(|best| cut.score() < best.score()) {
            best = Some(cut);
        }
    }
    let mut side = best.map_or_else(Vec::new, |cut| cut.side);
    while let Some((_, map)) = levels.pop() {
        let finer = levels.last().map_or(graph, |level| &level.0);
        let projected = map.iter().map(|&coarse| side[coarse as usize]).collect();
        let mut cut = Cut::new(finer, projected);
        cut.refine(finer);
        side = cut.side;
    }
    side
}

/// Weight of the separator.
pub(crate) fn separator_weight(graph: &Graph, side: &[Side]) -> i64 {
    graph
        .weight
        .iter()
        .zip(side)
        .filter(|(_, side)| **side == SEPARATOR)
        .map(|(&weight, _)| i64::from(weight))
        .sum()
}

/// A cut during its improvement.
struct Cut {
    side: Vec<Side>,
    /// Weights of the two parts and of the separator.
    weight: [i64; 3],
    /// The largest weight of a part.
    limit: i64,
    /// For a vertex of the separator: the weights of its neighbours in either part.
    pull: Vec<[i64; 2]>,
    /// Its gains in the last entry of the queues.
    queued: Vec<[i64; 2]>,
}

impl Cut {
    fn new(graph: &Graph, side: Vec<Side>) -> Cut {
        let mut weight = [0i64; 3];
        for (&side, &own) in side.iter().zip(&graph.weight) {
            weight[usize::from(side)] += i64::from(own);
        }
        Cut {
            limit: (HEAVIEST_PART * graph.total_weight() as f64) as i64,
            pull: vec![[0; 2]; side.len()],
            queued: vec![[i64::MIN; 2]; side.len()],
            side,
            weight,
        }
    }

    /// Part 0 grows from a vertex, nearest vertices first, up to half the weight. The vertices that it
    /// touches are the separator.
    fn grow(graph: &Graph, random: &mut Random) -> Cut {
        let count = graph.vertices();
        let half = graph.total_weight() / 2;
        let mut side = vec![1u8; count];
        let mut queued = vec![false; count];
        let mut queue = VecDeque::new();
        let mut grown = 0i64;
        while grown < half {
            let vertex = match queue.pop_front() {
                Some(vertex) => vertex,
                None => {
                    let start = random.below(count);
                    let Some(free) = (start..count).chain(0..start).find(|&v| !queued[v]) else {
                        break;
                    };
                    queued[free] = true;
                    free
                }
            };
            side[vertex] = 0;
            grown += i64::from(graph.weight[vertex]);
            for &other in graph.neighbours(vertex) {
                if !queued[other as usize] {
                    queued[other as usize] = true;
                    queue.push_back(other as usize);
                }
            }
        }
        for vertex in 0..count {
            if side[vertex] == 1
                && graph
                    .neighbours(vertex)
                    .iter()
                    .any(|&other| side[other as usize] == 0)
            {
                side[vertex] = SEPARATOR;
            }
        }
        Cut::new(graph, side)
    }

    /// The quality of the cut: overweight of a part, weight of the separator, difference of the parts.
    /// Smaller is better.
    fn score(&self) -> (i64, i64, i64) {
        let heavier = self.weight[0].max(self.weight[1]);
        (
            (heavier - self.limit).max(0),
            self.weight[2],
            (self.weight[0] - self.weight[1]).abs(),
        )
    }

    /// Makes passes until one brings no improvement.
    fn refine(&mut self, graph: &Graph) {
        let mut locked = vec![false; graph.vertices()];
        for _ in 0..PASSES {
            locked.fill(false);
            if !self.pass(graph, &mut locked) {
                break;
            }
        }
    }

    /// One pass (Fiduccia, Mattheyses, for vertex separators: Ashcraft, Liu 1994): vertices leave the
    /// separator for one part, and their neighbours in the other part enter it. The pass keeps the best state
    /// and undoes the moves after it. True if the state improved.
    fn pass(&mut self, graph: &Graph, locked: &mut [bool]) -> bool {
        let mut queues = [BinaryHeap::new(), BinaryHeap::new()];
        for vertex in 0..graph.vertices() {
            if self.side[vertex] == SEPARATOR {
                self.enter(graph, vertex, locked, &mut queues);
            }
        }
        let initial = self.score();
        let mut best = initial;
        let mut kept = 0;
        // the vertex that left, its new part, and the end of its followers in `followers`
        let mut moves: Vec<(u32, usize, usize)> = Vec::new();
        let mut followers: Vec<u32> = Vec::new();
        let mut touched: Vec<u32> = Vec::new();
        while let Some((to, vertex)) = self.choose(graph, locked, &mut queues) {
            let other = 1 - to;
            locked[vertex] = true;
            self.side[vertex] = to as Side;
            let own = i64::from(graph.weight[vertex]);
            self.weight[2] -= own;
            self.weight[to] += own;
            for &near in graph.neighbours(vertex) {
                let near = near as usize;
                if self.side[near] == SEPARATOR {
                    self.pull[near][to] += own;
                    touched.push(near as u32);
                } else if usize::from(self.side[near]) == other {
                    let weight = i64::from(graph.weight[near]);
                    self.side[near] = SEPARATOR;
                    self.weight[other] -= weight;
                    self.weight[2] += weight;
                    followers.push(near as u32);
                    for &beyond in graph.neighbours(near) {
                        let beyond = beyond as usize;
                        if self.side[beyond] == SEPARATOR {
                            self.pull[beyond][other] -= weight;
                            touched.push(beyond as u32);
                        }
                    }
                    self.enter(graph, near, locked, &mut queues);
                }
            }
            for near in touched.drain(..) {
                if !locked[near as usize] {
                    self.queue(graph, near as usize, &mut queues);
                }
            }
            moves.push((vertex as u32, to, followers.len()));
            let score = self.score();
            if score < best {
                best = score;
                kept = moves.len();
            } else if moves.len() - kept > PATIENCE {
                break;
            }
        }
        while moves.len() > kept {
            let Some((vertex, to, end)) = moves.pop() else {
                break;
            };
            let begin = moves.last().map_or(0, |before| before.2);
            let own = i64::from(graph.weight[vertex as usize]);
            self.side[vertex as usize] = SEPARATOR;
            self.weight[to] -= own;
            self.weight[2] += own;
            for &follower in &followers[begin..end] {
                let weight = i64::from(graph.weight[follower as usize]);
                self.side[follower as usize] = (1 - to) as Side;
                self.weight[1 - to] += weight;
                self.weight[2] -= weight;
            }
            followers.truncate(begin);
        }
        best < initial
    }

    /// The decrease of the separator's weight when the vertex leaves it for a part.
    fn gain(&self, graph: &Graph, vertex: usize, to: usize) -> i64 {
        i64::from(graph.weight[vertex]) - self.pull[vertex][1 - to]
    }

    /// Computes the gains of a vertex that entered the separator, and queues it.
    fn enter(
        &mut self,
        graph: &Graph,
        vertex: usize,
        locked: &[bool],
        queues: &mut [BinaryHeap<(i64, u32)>; 2],
    ) {
        let mut pull = [0i64; 2];
        for &other in graph.neighbours(vertex) {
            if let Some(part) = pull.get_mut(usize::from(self.side[other as usize])) {
                *part += i64::from(graph.weight[other as usize]);
            }
        }
        self.pull[vertex] = pull;
        if !locked[vertex] {
            self.queued[vertex] = [i64::MIN; 2];
            self.queue(graph, vertex, queues);
        }
    }

    /// Queues a vertex whose gains may have changed. The search skips its older entries.
    fn queue(&mut self, graph: &Graph, vertex: usize, queues: &mut [BinaryHeap<(i64, u32)>; 2]) {
        for (to, queue) in queues.iter_mut().enumerate() {
            let gain = self.gain(graph, vertex, to);
            if self.queued[vertex][to] != gain {
                self.queued[vertex][to] = gain;
                queue.push((gain, vertex as u32));
            }
        }
    }

    /// The next move: the one with the larger gain, unless its part is full. For equal gains it takes the
    /// lighter part.
    fn choose(
        &self,
        graph: &Graph,
        locked: &[bool],
        queues: &mut [BinaryHeap<(i64, u32)>; 2],
    ) -> Option<(usize, usize)> {
        let mut top = [None; 2];
        for to in 0..2 {
            while let Some(&(gain, vertex)) = queues[to].peek() {
                let vertex = vertex as usize;
                let current = self.side[vertex] == SEPARATOR
                    && !locked[vertex]
                    && self.gain(graph, vertex, to) == gain;
                let full = self.weight[to] + i64::from(graph.weight[vertex]) > self.limit
                    && self.weight[to] >= self.weight[1 - to];
                if current && !full {
                    top[to] = Some((gain, vertex));
                    break;
                }
                if current && full {
                    // it may fit later, when this part has lost vertices
                    break;
                }
                queues[to].pop();
            }
        }
        let lighter = usize::from(self.weight[1] < self.weight[0]);
        let to = match top {
            [Some(zero), Some(one)] if zero.0 == one.0 => lighter,
            [Some(zero), Some(one)] => usize::from(one.0 > zero.0),
            [Some(_), None] => 0,
            [None, Some(_)] => 1,
            [None, None] => return None,
        };
        top[to].map(|(_, vertex)| (to, vertex))
    }
}
