//! Ties and supports as rules for single freedoms, in the analysis frames of their nodes ("local axes").

use std::collections::BTreeMap;

use super::averaging::{self, Follower};
use super::check::list;
use super::freedoms::{FreedomMap, direction};
use super::residual;
use super::vector::{cross, dot, subtract};
use crate::error::FlexibleError;
use crate::mesh::{Mesh, Support, Tie};

/// A sum over freedoms: freedom and coefficient, freedoms ascending, none twice.
pub(super) type Sum = Vec<(u32, f64)>;

/// The role of each freedom, in local axes.
#[derive(Clone, Debug)]
pub struct Constraints {
    /// Nodes whose freedoms are in their analysis frame: those that ties or supports name.
    pub(super) turned: Vec<bool>,
    /// Dependent and held freedoms as sums over independent ones; a held one is an empty sum.
    pub(super) dependent: BTreeMap<u32, Sum>,
}

/// A dependent freedom in the form of its tie.
struct Rule {
    tie: u64,
    sum: Vec<(u32, f64)>,
}

/// The sum with sorted terms, each freedom once and without zeros.
fn collected(terms: impl IntoIterator<Item = (u32, f64)>) -> Sum {
    let mut sum: BTreeMap<u32, f64> = BTreeMap::new();
    for (freedom, coefficient) in terms {
        *sum.entry(freedom).or_insert(0.0) += coefficient;
    }
    sum.into_iter().filter(|(_, x)| *x != 0.0).collect()
}

impl Constraints {
    /// The ties of a checked mesh, with freedoms held at zero. A tie may make a held freedom dependent (the
    /// centre of an averaging tie). Then one of the freedoms in its sum becomes dependent instead.
    ///
    /// # Errors
    /// A freedom is dependent by two ties; ties form a circle; the nodes of an averaging tie do not determine
    /// its reference; an equation has no first term.
    pub fn new(
        mesh: &Mesh,
        freedoms: &FreedomMap,
        held: &[Support],
    ) -> Result<Self, FlexibleError> {
        let mut rules: BTreeMap<u32, Rule> = BTreeMap::new();
        let mut turned = vec![false; mesh.nodes.len()];
        let mut turn = |node: u32| {
            if let Some(turned) = turned.get_mut(node as usize) {
                *turned = mesh.nodes[node as usize].frame.is_some();
            }
        };
        for tie in &mesh.ties {
            tie.each(|node, _| turn(node));
            let followers = match tie {
                Tie::Rigid {
                    id,
                    independent,
                    dependent,
                } => rigid(mesh, freedoms, *id, *independent, dependent)?,
                Tie::Averaging {
                    id,
                    reference,
                    reference_components,
                    independent,
                } => {
                    let reference = (*reference, *reference_components);
                    averaging::followers(mesh, freedoms, *id, reference, independent)?
                }
                Tie::Equation { id, terms } => vec![equation(freedoms, *id, terms)?],
            };
            let tie = tie.id();
            for (freedom, sum) in followers {
                if let Some(other) = rules.get(&freedom) {
                    return Err(FlexibleError::structure(
                        format!(
                            "{} depends on two ties, {} and {tie}",
                            name(mesh, freedoms, freedom),
                            other.tie
                        ),
                        "remove it from one of the two ties; a dependent node can depend on one tie only",
                    ));
                }
                rules.insert(freedom, Rule { tie, sum });
            }
        }
        let mut zero = Vec::new();
        for support in held {
            turn(support.node);
            for component in (0..6u8).filter(|c| support.components >> c & 1 == 1) {
                if let Some(freedom) = freedoms.freedom(support.node, component) {
                    zero.push(freedom as u32);
                }
            }
        }
        let mut dependent = resolve(rules)?;
        hold(&mut dependent, &zero);
        Ok(Constraints { turned, dependent })
    }
}

/// Name of a freedom for a message.
fn name(mesh: &Mesh, freedoms: &FreedomMap, freedom: u32) -> String {
    freedoms
        .owner(freedom as usize)
        .map_or_else(String::new, |(node, component)| {
            mesh.freedom_name(node, component)
        })
}

/// The dependent freedoms of a rigid tie: with r from the independent node, a freedom along a moves by a·u +
/// (r × a)·θ, one about a by a·θ.
fn rigid(
    mesh: &Mesh,
    freedoms: &FreedomMap,
    id: u64,
    independent: u32,
    dependent: &[(u32, u8)],
) -> Result<Vec<Follower>, FlexibleError> {
    let leader = freedoms.of(independent).start as u32;
    let axes: Vec<[f64; 3]> = (0..3u8)
        .map(|component| direction(mesh, independent, component))
        .collect();
    let mut followers = Vec::new();
    for &(node, mask) in dependent {
        if node == independent {
            return Err(FlexibleError::structure(
                format!(
                    "rigid tie {id}: node {} depends on itself",
                    mesh.nodes[node as usize].id
                ),
                "remove the independent node from the dependent nodes",
            ));
        }
        let arm = subtract(
            mesh.nodes[node as usize].position,
            mesh.nodes[independent as usize].position,
        );
        for component in (0..6u8).filter(|c| mask >> c & 1 == 1) {
            // a node of solids has no rotations to follow
            let Some(freedom) = freedoms.freedom(node, component) else {
                continue;
            };
            let along = direction(mesh, node, component);
            let turning = if component < 3 {
                cross(arm, along)
            } else {
                along
            };
            let mut sum = Vec::with_capacity(6);
            for (k, &axis) in axes.iter().enumerate() {
                if component < 3 {
                    sum.push((leader + k as u32, dot(along, axis)));
                }
                sum.push((leader + 3 + k as u32, dot(turning, axis)));
            }
            followers.push((freedom as u32, sum));
        }
    }
    Ok(followers)
}

fn equation(
    freedoms: &FreedomMap,
    id: u64,
    terms: &[(u32, u8, f64)],
) -> Result<(u32, Vec<(u32, f64)>), FlexibleError> {
    let none = || {
        FlexibleError::structure(
            format!("the first coefficient of equation {id} is zero or missing"),
            "give a coefficient other than zero first: its freedom depends on the others",
        )
    };
    let mut known = Vec::with_capacity(terms.len());
    for &(node, component, coefficient) in terms {
        let freedom = freedoms.freedom(node, component).ok_or_else(none)?;
        known.push((freedom as u32, coefficient));
    }
    let &(first, _) = known.first().ok_or_else(none)?;
    let sum = collected(known);
    let own = sum
        .iter()
        .find(|(freedom, _)| *freedom == first)
        .map(|(_, x)| *x)
        .ok_or_else(none)?;
    let others = sum
        .into_iter()
        .filter(|(freedom, _)| *freedom != first)
        .map(|(freedom, x)| (freedom, -x / own))
        .collect();
    Ok((first, others))
}

/// Replaces dependent freedoms in the rules by their sums, in an order in which every needed sum is already
/// known.
fn resolve(rules: BTreeMap<u32, Rule>) -> Result<BTreeMap<u32, Sum>, FlexibleError> {
    // the number of dependent freedoms in the sum of each rule
    let mut waiting: BTreeMap<u32, usize> = BTreeMap::new();
    let mut users: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    let mut ready = std::collections::VecDeque::new();
    for (&freedom, rule) in &rules {
        let mut count = 0;
        for (other, _) in rule
            .sum
            .iter()
            .filter(|(other, _)| rules.contains_key(other))
        {
            users.entry(*other).or_default().push(freedom);
            count += 1;
        }
        if count == 0 {
            ready.push_back(freedom);
        } else {
            waiting.insert(freedom, count);
        }
    }
    let mut resolved: BTreeMap<u32, Sum> = BTreeMap::new();
    while let Some(freedom) = ready.pop_front() {
        let Some(rule) = rules.get(&freedom) else {
            continue;
        };
        let sum = collected(
            rule.sum
                .iter()
                .flat_map(|&(other, x)| match resolved.get(&other) {
                    Some(known) => known.iter().map(|&(f, y)| (f, x * y)).collect(),
                    None => vec![(other, x)],
                }),
        );
        resolved.insert(freedom, sum);
        for user in users.get(&freedom).into_iter().flatten() {
            if let Some(count) = waiting.get_mut(user) {
                *count -= 1;
                if *count == 0 {
                    waiting.remove(user);
                    ready.push_back(*user);
                }
            }
        }
    }
    if waiting.is_empty() {
        return Ok(resolved);
    }
    let ties: std::collections::BTreeSet<u64> = waiting
        .keys()
        .filter_map(|freedom| rules.get(freedom))
        .map(|rule| rule.tie)
        .collect();
    Err(FlexibleError::structure(
        format!(
            "ties depend on each other in a circle: {}",
            list(ties.iter().map(u64::to_string))
        ),
        "make one of their nodes independent",
    ))
}

/// Holds freedoms at zero. An independent freedom becomes an empty sum. For a dependent freedom the equation
/// remains that its sum is zero.
fn hold(dependent: &mut BTreeMap<u32, Sum>, zero: &[u32]) {
    let mut residuals = Vec::new();
    let mut held: BTreeMap<u32, Sum> = BTreeMap::new();
    for freedom in zero {
        match dependent.get(freedom) {
            Some(sum) => residuals.push(sum.clone()),
            None => {
                held.insert(*freedom, Sum::new());
            }
        }
    }
    if residuals.is_empty() && held.is_empty() {
        return;
    }
    for sum in &mut residuals {
        sum.retain(|(freedom, _)| !held.contains_key(freedom));
    }
    held.extend(residual::eliminate(residuals));
    for sum in dependent.values_mut() {
        if sum.iter().any(|(freedom, _)| held.contains_key(freedom)) {
            *sum = collected(
                sum.iter()
                    .flat_map(|&(freedom, x)| match held.get(&freedom) {
                        Some(known) => known.iter().map(|&(f, y)| (f, x * y)).collect(),
                        None => vec![(freedom, x)],
                    }),
            );
        }
    }
    dependent.extend(held);
    // a held freedom is exactly zero, without the rounding error of its sum
    for freedom in zero {
        dependent.insert(*freedom, Sum::new());
    }
}
