//! The loads that the elements of a model can put on a marker. A flexible body needs static modes for these
//! loads.
//!
//! Each element is evaluated at random motions near the position of an assembled engine. Some loads are zero at the stated
//! parameters, and `--set` or an input switches them on. So each constant that is zero and depends on a parameter or on the
//! time is also tried as one. The following loads remain undetected:
//!
//! - a load that is zero as long as a parameter keeps its stated value, if that value is not zero or if one (SI) does not
//!   switch the load on, such as a load behind a threshold of two;
//! - a load that needs three or more of these zeros switched on and another one as stated, and one that needs two of them if an
//!   element has more than [`MOST_PAIRED`];
//! - a load that is zero at the time zero in all motions, such as an impulse;
//! - a load that begins beyond the motions of the trials, such as that of a stop with a clearance above [`PARTNER_DISTANCE`].

use super::flexible::{TermDraft, TermKind};
use super::scalar::{FIXED, TIME};
use super::{Elaborated, Elaborator};
use crate::codes;
use crate::ir::interpret::Interpreter;
use crate::ir::{ClassFunctions, Node, inputs_of};
use crate::resolve::suggest::listing;
use eng_grammar::{Diagnostic, Span};
use eng_system::code::{BindCode, Pair};
use eng_system::field::KERNELS;
use eng_system::flexible::{
    ALL_FREEDOMS, FlexibleSource, Freedoms, Interface, ModeTerm, freedom_text,
};
use eng_system::layout::{InputLayout, MARKER_WIDTH, ROTATION};
use eng_system::lint;
use eng_system::system::{BodyInertia, BodyRef, Element, Role, Slot};
use std::sync::Arc;

/// Random motions at which an element is tried with the stated parameters, and with all zeros switched on. A choice: a
/// component that acts in half of all motions, as that of a stop, is missed once in 4096 elements.
const TRIALS: usize = 12;
/// Random motions at which it is tried with one zero switched on, or with two. A choice: such a zero is a factor, so most
/// motions show its load.
const TRIALS_OF_FEW: usize = 4;
/// Most zeros of an element that are tried in pairs. A choice: they make 66 pairs, which take a few milliseconds.
const MOST_PAIRED: usize = 12;
/// Share of a wrench that a component must reach to count. Friction of a film and misalignment remain below it. A choice: a
/// much smaller share would count friction and misalignment, a larger one would overlook a real component.
const COMPONENT_SHARE: f64 = 0.01;
/// Arm (m) that converts moments to forces for the comparison. A choice: the size of a bearing or of a small
/// joint.
const ARM: f64 = 0.1;
/// Distance of the partners in a trial (m): small, as in an assembled engine. A choice: below the clearances
/// of films, which would touch at a larger distance.
const PARTNER_DISTANCE: f64 = 1e-5;
/// Relative tilt of the partners (rad): small, as in an assembled engine. A choice: it moves a point at a distance of [`ARM`]
/// by [`PARTNER_DISTANCE`].
const PARTNER_TILT: f64 = 1e-4;
/// Angular velocity of a trial (rad/s): 2900 rpm, an engine's speed. A choice: at rest films and dampers
/// would transmit nothing.
const TRIAL_SPIN: f64 = 300.0;

/// The loads on a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Transmitted {
    /// Wrench components along the marker's axes.
    pub freedoms: Freedoms,
    /// Whether an element depends on the marker's axes or turns it.
    pub turns: bool,
}

/// The slots of a model at the stated parameters.
struct StatedSlots {
    /// Their values; none if the model cannot be bound.
    values: Vec<f64>,
    /// Whether a parameter or the time changes them.
    change: Vec<bool>,
}

impl StatedSlots {
    fn of(elaborated: &Elaborated) -> StatedSlots {
        let defaults = vec![None; elaborated.system.parameters.len()];
        // an error in parameters is reported when the model is bound
        let bound = elaborated.bind.bind(&defaults, &elaborated.system.tables);
        let changing = elaborated.bind.depends(|k| k < FIXED || k == TIME);
        let slots = elaborated.bind.function.outputs.iter();
        StatedSlots {
            values: bound.map(|bound| bound.slots).unwrap_or_default(),
            change: slots.map(|node| changing[node.0 as usize]).collect(),
        }
    }
}

/// The loads that the elements of a model can put on a marker of the system.
fn transmitted(elaborated: &Elaborated, slots: &StatedSlots, marker: u32) -> Transmitted {
    let system = &elaborated.system;
    let mut found = Transmitted::default();
    for element in &system.elements {
        if element.role != Role::Dynamic {
            continue;
        }
        for (place, m) in (0..).zip(&element.markers) {
            if *m == marker {
                let by_element = tried(elaborated, slots, element, place);
                found.freedoms |= by_element.freedoms;
                found.turns |= by_element.turns;
            }
        }
    }
    found
}

/// The constants of an element that may switch its load on a marker, or its rows, and are zero at the stated parameters. A zero
/// of the law itself is none of them.
fn zeros(
    functions: &ClassFunctions,
    slots: &StatedSlots,
    element: &Element,
    place: u32,
) -> Vec<usize> {
    let layout = functions.layout;
    let outputs = &functions.residual.outputs;
    let rows = layout.rows as usize;
    let load = rows + 6 * place as usize;
    let decided = [outputs.get(..rows), outputs.get(load..load + 6)];
    let decided: Vec<Node> = decided.into_iter().flatten().flatten().copied().collect();
    let inputs = inputs_of(&functions.residual.graph, &decided);
    let zero = |(constant, slot): (u32, &Slot)| {
        let at = slot.0 as usize;
        let switches = slots.values.get(at) == Some(&0.0)
            && slots.change.get(at) == Some(&true)
            && inputs.contains(&layout.constant(constant));
        switches.then_some(constant as usize)
    };
    (0..).zip(&element.constants).filter_map(zero).collect()
}

/// The constants of the trials: those stated, then with zeros that are ones. All zeros are switched on together. Some switch a
/// load off if they are not zero, so each is switched on alone, and each with each.
fn settings(stated: &[f64], zeros: &[usize]) -> Vec<Vec<f64>> {
    let switched = |on: &[usize]| {
        let mut constants = stated.to_vec();
        for i in on {
            constants[*i] = 1.0;
        }
        constants
    };
    let mut all = vec![switched(&[]); TRIALS];
    if !zeros.is_empty() {
        all.extend(std::iter::repeat_n(switched(zeros), TRIALS));
    }
    // one zero is all zeros, and so are two
    if zeros.len() > 1 {
        for zero in zeros {
            all.extend(std::iter::repeat_n(switched(&[*zero]), TRIALS_OF_FEW));
        }
    }
    if (3..=MOST_PAIRED).contains(&zeros.len()) {
        for (place, first) in zeros.iter().enumerate() {
            for second in &zeros[..place] {
                let both = switched(&[*first, *second]);
                all.extend(std::iter::repeat_n(both, TRIALS_OF_FEW));
            }
        }
    }
    all
}

/// The loads of one element, found at random states near those of an assembled engine: partners at one
/// position with parallel z axes.
fn tried(
    elaborated: &Elaborated,
    slots: &StatedSlots,
    element: &Element,
    place: u32,
) -> Transmitted {
    let everything = Transmitted {
        freedoms: ALL_FREEDOMS,
        turns: true,
    };
    let Some(functions) = elaborated.classes.get(element.class as usize) else {
        return everything;
    };
    let layout = functions.layout;
    let interpreter = Interpreter::new(&functions.residual);
    let number = |slot: &Slot| slots.values.get(slot.0 as usize).copied();
    let constants: Vec<f64> = element.constants.iter().filter_map(number).collect();
    let states: Vec<f64> = element.state_start.iter().filter_map(number).collect();
    let scales: Vec<f64> = element.state_scale.iter().filter_map(number).collect();
    let complete = constants.len() == layout.constants as usize
        && states.len() == layout.states as usize
        && scales.len() == states.len();
    if !complete {
        return everything;
    }
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut scratch = Vec::new();
    let mut evaluate = |inputs: &[f64]| -> Option<Vec<f64>> {
        let pairs: Vec<Pair> = inputs.iter().map(|x| [*x; 2]).collect();
        let mut outputs = vec![[0.0; 2]; layout.residual_len() as usize];
        interpreter
            .evaluate(
                &pairs,
                &mut outputs,
                &elaborated.system.tables,
                &mut scratch,
            )
            .then(|| outputs.iter().map(|p| p[0]).collect())
            .filter(|values: &Vec<f64>| values.iter().all(|x| x.is_finite()))
    };
    let mut found = Transmitted::default();
    let mut greatest = [0.0f64; 6];
    let mut tries = 0;
    let zeros = zeros(functions, slots, element, place);
    for (trial, constants) in settings(&constants, &zeros).iter().enumerate() {
        // a load may consist of a state alone, which begins at zero; each setting is tried an even number of times
        let moved: Vec<f64> = states
            .iter()
            .zip(&scales)
            .map(|(start, scale)| {
                start
                    + if trial % 2 == 0 {
                        0.0
                    } else {
                        scale * random.next()
                    }
            })
            .collect();
        let mut inputs = state(&layout, constants, &moved, &mut random);
        answer(&layout, element, &mut inputs, &mut random);
        let Some(values) = evaluate(&inputs) else {
            continue;
        };
        tries += 1;
        let rotation = &inputs[(layout.marker(place) + ROTATION) as usize..][..9];
        let wrench = wrench(&layout, &values, place, rotation);
        for (most, x) in greatest.iter_mut().zip(wrench) {
            *most = most.max(x.abs());
        }
        // the same state with the marker turned: if its axes matter, the values change
        let mut turned = inputs.clone();
        // a tilt as in the trials, and a turn about the axis that no symmetry of a marker has. Choices
        let small = rotation_of([0.3 * PARTNER_TILT, -0.5 * PARTNER_TILT, 0.2]);
        let product = times(rotation, &small);
        turned[(layout.marker(place) + ROTATION) as usize..][..9].copy_from_slice(&product);
        if let Some(other) = evaluate(&turned) {
            let rows = layout.rows as usize;
            let change = |range: std::ops::Range<usize>| {
                let size = values[range.clone()]
                    .iter()
                    .fold(0.0, |m: f64, x| m.max(x.abs()));
                values[range.clone()]
                    .iter()
                    .zip(&other[range])
                    // 1e-12 (N, N m or SI of the rows) stands for no wrench at all: its rounding is no
                    // change. A choice
                    .any(|(a, b)| (a - b).abs() > COMPONENT_SHARE * size.max(1e-12))
            };
            let force = rows + 6 * place as usize;
            found.turns |= change(0..rows) || change(force..force + 3);
        }
    }
    found.freedoms = counted(&greatest);
    found.turns |= found.freedoms & 0b11_1000 != 0;
    if tries == 0 { everything } else { found }
}

fn state(layout: &InputLayout, constants: &[f64], states: &[f64], random: &mut Random) -> Vec<f64> {
    let mut inputs = vec![0.0; layout.len() as usize];
    for marker in 0..layout.markers {
        let at = layout.marker(marker) as usize;
        let numbers = &mut inputs[at..at + MARKER_WIDTH as usize];
        for x in &mut numbers[..3] {
            *x = PARTNER_DISTANCE * random.next();
        }
        let tilt = [PARTNER_TILT * random.next(), PARTNER_TILT * random.next()];
        let about_z = rotation_of([0.0, 0.0, std::f64::consts::PI * random.next()]);
        let tilted = rotation_of([tilt[0], tilt[1], 0.0]);
        numbers[3..12].copy_from_slice(&times(&tilted, &about_z));
        for x in &mut numbers[12..15] {
            *x = PARTNER_DISTANCE * TRIAL_SPIN * random.next();
        }
        numbers[15] = PARTNER_TILT * TRIAL_SPIN * random.next();
        numbers[16] = PARTNER_TILT * TRIAL_SPIN * random.next();
        numbers[17] = TRIAL_SPIN * random.next();
    }
    for (i, x) in states.iter().enumerate() {
        inputs[layout.state(i as u32) as usize] = *x;
    }
    for row in 0..layout.rows {
        inputs[layout.multiplier(row) as usize] = random.next();
    }
    for (i, x) in constants.iter().enumerate() {
        inputs[layout.constant(i as u32) as usize] = *x;
    }
    inputs
}

/// Sets the answers of the element's fields to random numbers of their usual sizes, because no kernel is
/// available here.
fn answer(layout: &InputLayout, element: &Element, inputs: &mut [f64], random: &mut Random) {
    let kernels = element.fields.iter().map(|field| field.kernel as usize);
    let rows = kernels.filter_map(|kernel| KERNELS.get(kernel));
    let sizes = rows.flat_map(|kernel| kernel.answers);
    let sizes = sizes.flat_map(|row| std::iter::repeat_n(row.size, row.count as usize));
    for (place, size) in (0..layout.answers).zip(sizes) {
        inputs[layout.answer(place) as usize] = size * random.next();
    }
}

/// Force and torque on a marker, along its axes.
fn wrench(layout: &InputLayout, values: &[f64], place: u32, rotation: &[f64]) -> [f64; 6] {
    let at = (layout.rows + 6 * place) as usize;
    let force = &values[at..at + 3];
    let mut wrench = [0.0; 6];
    for i in 0..3 {
        wrench[i] = (0..3).map(|j| rotation[3 * j + i] * force[j]).sum();
        wrench[3 + i] = values[at + 3 + i];
    }
    wrench
}

/// The components whose greatest value reaches [`COMPONENT_SHARE`] of the greatest of all.
fn counted(wrench: &[f64; 6]) -> Freedoms {
    let weighed = |i: usize| wrench[i] / if i < 3 { 1.0 } else { ARM };
    let whole = (0..6).map(weighed).fold(0.0, f64::max);
    if whole <= 0.0 {
        return 0;
    }
    (0..6)
        .filter(|i| weighed(*i) > COMPONENT_SHARE * whole)
        .fold(0, |bits, i| bits | (1 << i))
}

/// exp(v~), row-major (Rodrigues).
fn rotation_of(v: [f64; 3]) -> [f64; 9] {
    let angle = libm::sqrt(v.iter().map(|x| x * x).sum());
    // there both quotients are their limits but for rounding
    let (a, b) = if angle < 1e-9 {
        (1.0, 0.5)
    } else {
        let half = libm::sin(0.5 * angle) / angle;
        (libm::sin(angle) / angle, 2.0 * half * half)
    };
    let skew = [0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0];
    let square = times(&skew, &skew);
    std::array::from_fn(|i| f64::from(u8::from(i % 4 == 0)) + a * skew[i] + b * square[i])
}

fn times(a: &[f64], b: &[f64; 9]) -> [f64; 9] {
    std::array::from_fn(|i| (0..3).map(|k| a[i / 3 * 3 + k] * b[3 * k + i % 3]).sum())
}

/// Pseudo-random numbers in -1…1, the same on every machine (xorshift; G. Marsaglia, J. Stat. Softw. 8 (2003)
/// 14).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

impl Elaborator<'_, '_> {
    /// Gives the mode sets their freedoms, and warns of loads without a mode.
    pub fn flexible_sources(&mut self, elaborated: &mut Elaborated) {
        let drafts: Vec<_> = self.draft.flexible.drain(..).flatten().collect();
        if drafts.is_empty() {
            return;
        }
        let slots = StatedSlots::of(elaborated);
        let mut sources = Vec::with_capacity(drafts.len());
        for draft in drafts {
            let mut source = draft.source;
            let loads: Vec<Transmitted> = draft
                .markers
                .iter()
                .map(|m| transmitted(elaborated, &slots, *m))
                .collect();
            let mut served = vec![0; loads.len()];
            for message in idle_terms(&draft.terms, &loads, &source) {
                self.diagnostics.push(message);
            }
            let unloaded = unloaded_markers(&draft.terms, &loads, &source);
            let path = &source.origin.path;
            if !unloaded.is_empty() && !accepted(elaborated, lint::UNLOADED, path) {
                for (term, markers) in unloaded {
                    self.diagnostics.push(without_load(path, term, &markers));
                }
            }
            let written = match (draft.terms.first(), draft.terms.last()) {
                (Some(first), Some(last)) if first.span.source == last.span.source => Some(Span {
                    start: first.span.start.min(last.span.start),
                    end: first.span.end.max(last.span.end),
                    ..first.span
                }),
                (first, _) => first.map(|first| first.span),
            };
            for term in draft.terms {
                let at: Vec<Interface> = term
                    .at
                    .iter()
                    .map(|marker| Interface {
                        marker: *marker,
                        freedoms: term
                            .freedoms
                            .unwrap_or_else(|| loads[*marker as usize].freedoms),
                    })
                    .collect();
                source.modes.push(match term.kind {
                    TermKind::Static | TermKind::Constraint => {
                        for interface in &at {
                            // the author chose listed freedoms, so they give no warning
                            served[interface.marker as usize] |= match term.freedoms {
                                Some(_) => ALL_FREEDOMS,
                                None => interface.freedoms,
                            };
                        }
                        if matches!(term.kind, TermKind::Static) {
                            ModeTerm::Static(at)
                        } else {
                            ModeTerm::Constraint(at)
                        }
                    }
                    TermKind::Normal(count) => ModeTerm::Normal { count, fixed: at },
                    TermKind::Given { format, file } => ModeTerm::Given {
                        format,
                        file,
                        at: super::location(term.span),
                    },
                });
            }
            let unserved: Vec<String> = source
                .markers
                .iter()
                .zip(loads.iter().zip(&served))
                .enumerate()
                .filter(|(i, _)| !source.support.contains(&(*i as u32)))
                .filter_map(|(i, (marker, (load, served)))| {
                    let own = source.support_freedoms.iter();
                    let own = own.filter(|held| held.marker as usize == i);
                    let held = own.fold(0, |bits, held| bits | held.freedoms);
                    let rest = load.freedoms & !served & !held;
                    (rest != 0).then(|| format!("{} ({})", marker.name, freedom_text(rest)))
                })
                .collect();
            if !unserved.is_empty() {
                let body = super::binding::span_of(source.modes_at);
                // the terms may stand elsewhere, such as in the argument of an analysis
                let place = written.filter(|at| {
                    at.source != body.source || at.start < body.start || at.end > body.end
                });
                let message = without_static_mode(&source.origin.path, place.unwrap_or(body));
                let message = message.also_if(place.map(|_| body), "the modes of the body");
                self.diagnostics.push(
                    message
                    .with_note(format!("loads without a mode: {}", unserved.join(", ")))
                    .with_help("add `static(at: …)` with these markers; forces and torques that hardly bend the body may be left out"),
                );
            }
            sources.push(source);
        }
        elaborated.flexible = sources;
    }
}

/// The warning about loads without a static mode. The caller adds the remedy.
pub fn without_static_mode(body: &str, place: Span) -> Diagnostic {
    Diagnostic::warning(
        codes::UNSERVED,
        format!("some loads of {body} have no static mode"),
    )
    .at(
        place,
        "without a static mode the body is too stiff under these loads",
    )
}

/// Whether the text accepts a lint about the object of a path. Marks the accepting items as used.
fn accepted(elaborated: &mut Elaborated, name: &str, path: &str) -> bool {
    let mut found = false;
    for accepted in &mut Arc::make_mut(&mut elaborated.system).accepted {
        if accepted.covers(name, path) {
            accepted.used = true;
            found = true;
        }
    }
    found
}

/// The static terms with markers that no element loads, and the names of these markers. Terms of [`idle_terms`] are left
/// out: those have no mode at all.
fn unloaded_markers<'s>(
    terms: &[TermDraft],
    loads: &[Transmitted],
    source: &'s FlexibleSource,
) -> Vec<(Span, Vec<&'s str>)> {
    let free = |marker: &&u32| {
        let load = loads.get(**marker as usize);
        load.is_some_and(|load| load.freedoms == 0) && !source.support.contains(marker)
    };
    let mut found: Vec<(Span, Vec<&str>)> = Vec::new();
    for term in terms {
        let markers: Vec<&u32> = term.at.iter().filter(free).collect();
        let idle = term.freedoms.is_none() && markers.len() == term.at.len();
        let of_loads = matches!(term.kind, TermKind::Static | TermKind::Constraint);
        let known = found.iter().any(|(span, _)| *span == term.span);
        if markers.is_empty() || idle || known || !of_loads {
            continue;
        }
        let names = markers.into_iter();
        let names = names.filter_map(|m| Some(source.markers.get(*m as usize)?.name.as_str()));
        found.push((term.span, names.collect()));
    }
    found
}

/// The warning about markers of a static term that no element loads.
fn without_load(body: &str, term: Span, markers: &[&str]) -> Diagnostic {
    let one = markers.len() == 1;
    let names = listing(markers.iter().copied(), 5);
    let title = format!(
        "{body}: no element loads the {} {names} of this static term",
        if one { "marker" } else { "markers" }
    );
    Diagnostic::warning(codes::UNSERVED, title)
        .at(term, "static modes serve the loads of elements")
        .with_help(format!(
            "put a joint, force or journal on {}, or leave {} out of the term",
            if one { "it" } else { "them" },
            if one { "it" } else { "them" }
        ))
        .acceptable(lint::UNLOADED)
}

/// The warnings about terms without modes: they list no freedoms, and no element loads their markers.
fn idle_terms(
    terms: &[TermDraft],
    loads: &[Transmitted],
    source: &FlexibleSource,
) -> Vec<Diagnostic> {
    let free = |marker: &u32| {
        let load = loads.get(*marker as usize);
        load.is_some_and(|load| load.freedoms == 0)
    };
    let idle = |term: &&TermDraft| {
        term.freedoms.is_none() && !term.at.is_empty() && term.at.iter().all(free)
    };
    let mut reported: Vec<Span> = Vec::new();
    let mut messages = Vec::new();
    for term in terms.iter().filter(idle) {
        if reported.contains(&term.span) {
            continue;
        }
        reported.push(term.span);
        // `craig_bampton` is one term of the text, but makes two here: constraint modes and modes with held
        // markers
        let is_normal = |t: &TermDraft| matches!(t.kind, TermKind::Normal(_));
        let of_text = |normal: bool| {
            let same = |t: &TermDraft| t.span == term.span && is_normal(t) == normal;
            terms.iter().any(same)
        };
        let effect = match (of_text(false), of_text(true)) {
            (true, true) => {
                "this term gives no constraint modes, and its normal modes are not held at its markers"
            }
            (_, true) => "the modes of this term are not held at its markers",
            _ => "this term gives no mode",
        };
        let names = term.at.iter();
        let names = names.filter_map(|m| source.markers.get(*m as usize).map(|m| m.name.as_str()));
        messages.push(
            Diagnostic::warning(
                codes::UNSERVED,
                format!("{}: {effect}", source.origin.path),
            )
            .at(term.span, "no element loads its markers")
            .with_note(format!("these are {}", listing(names, 5)))
            .with_help("state `freedoms: [x, y, z]`, put a joint, force or journal on a marker, or leave the term out"),
        );
    }
    messages
}

impl Elaborated {
    /// For each marker of a flexible body, by its index in the source: whether an element turns it or depends
    /// on its axes.
    pub fn turned_markers(&self, flexible: u32) -> Vec<bool> {
        let slots = StatedSlots::of(self);
        let body = self
            .system
            .bodies
            .iter()
            .position(|b| b.inertia == BodyInertia::Flexible(flexible));
        let count = self
            .flexible
            .get(flexible as usize)
            .map_or(0, |s| s.markers.len());
        let mut turned = vec![false; count];
        for (m, marker) in (0..).zip(&self.system.markers) {
            let here = body.is_some_and(|b| marker.body == BodyRef::Body(b as u32));
            if let (true, Some(shape)) = (here, marker.shape)
                && let Some(flag) = turned.get_mut(shape as usize)
            {
                *flag = transmitted(self, &slots, m).turns;
            }
        }
        turned
    }
}
