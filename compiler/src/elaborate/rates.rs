//! Rates of values that change with inputs.
//!
//! The rate of an expression of parameters is one more expression of the bind graph: the derivative of the
//! expression, with the rates of the inputs as further inputs of the graph. An element that needs the rate gets it as
//! a constant, so element code and layouts contain no inputs. A parameter with a stated value is constant. The rate
//! of any other parameter is that of its default. The default of an input that an analysis drives is a function of
//! time, whose derivative is exact.

use super::scalar::{FIXED, PROVISIONAL, RATE, Scalar, Stage, TIME};
use super::{Elaborator, Eval};
use crate::codes;
use crate::ir::kinks::{functions_of, smoothly_needed};
use crate::ir::{BoundKink, KinkPlace, Node, Op, dependencies, forward, inputs_of};
use eng_grammar::{Diagnostic, Span};
use eng_system::input::Interpolation;
use eng_system::system::Kink;
use std::collections::{BTreeMap, BTreeSet};

/// Constants that follow inputs, with the constants of their rates; the kinks of these constants, with their texts.
pub(super) type Changing = (Vec<(u32, u32)>, Vec<(BoundKink, Kink)>);

impl Elaborator<'_, '_> {
    /// The rate of a node of the bind graph; `None` if it is constant between two points of time.
    pub(super) fn rate_of_bound(&mut self, node: Node) -> Option<Node> {
        let mut seeds: BTreeMap<u32, Node> = BTreeMap::new();
        for input in inputs_of(&self.graphs.bind.graph, &[node]) {
            let seed = match input {
                TIME => Some(self.graphs.bind.graph.constant(1.0)),
                _ => self.rate_of_parameter(input),
            };
            if let Some(seed) = seed {
                seeds.insert(input, seed);
            }
        }
        if seeds.is_empty() {
            return None;
        }
        let seed = |input: u32| seeds.get(&input).copied();
        let rates = forward(&mut self.graphs.bind.graph, &[node], &seed);
        rates.first().copied()
    }

    /// The input of the bind graph that is the rate of a parameter; `None` if the parameter is constant
    /// between two points.
    fn rate_of_parameter(&mut self, parameter: u32) -> Option<Node> {
        if parameter >= FIXED {
            return None;
        }
        if !self.draft.parameter_rates.contains_key(&parameter) {
            let default = self.draft.parameter_defaults.get(parameter as usize);
            let of_default = match default.copied() {
                Some(default) => self.rate_of_bound(default),
                None => None,
            };
            let mut inputs = self.draft.inputs.iter();
            let moves = inputs.any(|input| {
                input.parameter == parameter && input.interpolation != Interpolation::Hold
            });
            let rate = match (of_default, moves) {
                (None, true) => Some(self.graphs.bind.graph.constant(0.0)),
                (rate, _) => rate,
            };
            self.draft.parameter_rates.insert(parameter, rate);
        }
        // the rate of the default is evaluated before, because its operations come first
        self.draft
            .parameter_rates
            .get(&parameter)
            .copied()
            .flatten()?;
        Some(self.graphs.bind.graph.input(RATE + parameter))
    }

    /// The rates of the constants that nodes of the present element depend on: inputs of constants, and the
    /// bind nodes of the rates.
    fn followed_constants(&mut self, nodes: &[Node]) -> Vec<(u32, Node)> {
        let Some(element) = &self.graphs.element else {
            return Vec::new();
        };
        if self.draft.inputs.is_empty() {
            return Vec::new();
        }
        let needed = dependencies(&element.graph, nodes);
        let used = element.graph.nodes().iter().zip(&needed);
        let constants: Vec<(u32, Node)> = used
            .filter(|(_, needed)| **needed)
            .filter_map(|(op, _)| {
                let Op::Input(input) = op else { return None };
                let index = input.checked_sub(PROVISIONAL.constant(0))?;
                Some((*input, *element.constants.get(index as usize)?))
            })
            .collect();
        let rated = constants.into_iter();
        rated
            .filter_map(|(input, bound)| Some((input, self.rate_of_bound(bound)?)))
            .collect()
    }

    /// The rates of the constants that nodes of the present element depend on, by the constant's input, as
    /// nodes of the element.
    pub(super) fn rates_of_constants(&mut self, nodes: &[Node]) -> BTreeMap<u32, Node> {
        let found = self.followed_constants(nodes).into_iter();
        found
            .map(|(input, rate)| (input, self.graphs.lift(Stage::Bind, rate)))
            .collect()
    }

    /// Constants of the present element that follow inputs, each with the constant of its rate, as indices. Its
    /// loads, rates and conditions of a stop depend on them. Then the kinks of these constants, with their texts.
    pub(super) fn changing_constants(&mut self) -> Changing {
        let Some(element) = &self.graphs.element else {
            return Default::default();
        };
        let rates = element.states.iter().filter_map(|state| state.rate);
        let drives = element.fields.iter().flat_map(|field| &field.drives);
        let nodes: Vec<Node> = (element.loads.iter().flatten())
            .chain(drives)
            .chain(&element.stops)
            .copied()
            .chain(rates)
            .collect();
        let followed = self.followed_constants(&nodes);
        let constants = self.graphs.element.as_ref().map(|e| e.constants.clone());
        let constants = constants.unwrap_or_default();
        let mut bound = Vec::new();
        let mut pairs = Vec::new();
        for (input, rate) in followed {
            let index = input - PROVISIONAL.constant(0);
            bound.extend(constants.get(index as usize).copied());
            if let Some(rate) = self.constant_of_rate(rate) {
                pairs.push((index, rate));
            }
        }
        (pairs, self.kinks_of_constants(bound))
    }

    /// The constant of the present element that is a rate.
    fn constant_of_rate(&mut self, rate: Node) -> Option<u32> {
        let rate = match self.graphs.bind.graph.as_constant(rate) {
            // the number must not be part of the code, because other elements of the class have others
            Some(value) => self.graphs.bind.fixed(value),
            None => rate,
        };
        self.constant_of_bound(rate)
    }

    /// The index of the present element's constant with the value of a node of the bind graph.
    fn constant_of_bound(&mut self, bound: Node) -> Option<u32> {
        let element = self.graphs.element.as_mut()?;
        let node = element.constant(bound);
        match element.graph.op(node) {
            Op::Input(place) => place.checked_sub(PROVISIONAL.constant(0)),
            _ => None,
        }
    }

    /// The kinks of nodes of the bind graph that follow inputs, as constants of the present element. An input
    /// that an analysis drives also has those of its function of time.
    fn kinks_of_constants(&mut self, nodes: Vec<Node>) -> Vec<(BoundKink, Kink)> {
        let mut found = Vec::new();
        let mut known = BTreeSet::new();
        for (node, op) in self.bound_operations(nodes) {
            for function in functions_of(&mut self.graphs.bind.graph, op) {
                if !known.insert(function) {
                    continue;
                }
                let Some(rate) = self.rate_of_bound(function.value) else {
                    continue;
                };
                let argument = function.table.map_or(0, |(_, kind)| kind.argument);
                let place = KinkPlace { node, argument };
                let text = self.graphs.bind.kinks.get(&place).cloned();
                let value = self.constant_of_bound(function.value);
                let rate = self.constant_of_rate(rate);
                let table = (function.table)
                    .and_then(|(handle, kind)| Some((self.constant_of_bound(handle)?, kind)));
                if let (Some(value), Some(rate)) = (value, rate) {
                    found.push((BoundKink { value, rate, table }, text.unwrap_or_default()));
                }
            }
        }
        found
    }

    /// The operations of the bind graph that nodes depend on, also through the defaults of parameters.
    fn bound_operations(&self, mut nodes: Vec<Node>) -> Vec<(Node, Op)> {
        let graph = &self.graphs.bind.graph;
        let mut parameters = BTreeSet::new();
        loop {
            let needed = smoothly_needed(graph, &nodes);
            let operations = (0..).map(Node).zip(graph.nodes().iter().copied());
            let operations = operations.zip(needed);
            let used: Vec<(Node, Op)> = operations
                .filter_map(|(operation, needed)| needed.then_some(operation))
                .collect();
            let before = nodes.len();
            for (_, op) in &used {
                if let Op::Input(parameter) = op
                    && parameters.insert(*parameter)
                {
                    let defaults = &self.draft.parameter_defaults;
                    nodes.extend(defaults.get(*parameter as usize));
                }
            }
            if nodes.len() == before {
                return used;
            }
        }
    }

    /// Refuses the rate of an input that is held between two points. Marks the other inputs: where their rates jump,
    /// the loads jump.
    pub(super) fn rates_known(&mut self, values: &[Scalar], span: Span) -> Eval<()> {
        for index in self.inputs_in(values) {
            let Some(input) = self.draft.inputs.get_mut(index) else {
                continue;
            };
            if input.interpolation != Interpolation::Hold {
                input.differentiated = true;
                continue;
            }
            let parameter = self.draft.parameters.get(input.parameter as usize);
            let path = parameter.map_or("", |parameter| &parameter.origin.path);
            let title =
                format!("the input `{path}` has no rate: it jumps between values that it holds");
            let mut message =
                Diagnostic::error(codes::NO_RATE, title).at(span, "depends on this input");
            if let Some(declared) = parameter.and_then(|parameter| parameter.origin.used_at) {
                message = message.also(super::binding::span_of(declared), "declared here");
            }
            return Err(self.report(message.with_help(
                "declare it with `interpolation: linear` (its rate is the slope between two points) or `interpolation: cubic`",
            )));
        }
        Ok(())
    }
}
