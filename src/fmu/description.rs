//! `modelDescription.xml` of FMI 2.0 and 3.0.

use super::Kind;
use super::variables::Described;
use crate::{Dimension, Interpolation};
use eng_report::escape::escaped;
use eng_system::dimension::{BASE_SYMBOLS, BASES};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

/// Duration and interval of the samples of an analysis (s), if they are times.
pub(super) type Experiment = (Option<f64>, Option<f64>);

/// The contents of a description.
#[derive(Clone, Debug)]
pub(super) struct About<'a> {
    pub model: &'a str,
    pub token: &'a str,
    pub variables: &'a [Described],
    pub experiment: Experiment,
}

/// An attribute, or nothing without a value.
fn attribute(name: &str, value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| {
        format!(" {name}=\"{}\"", escaped(&value.to_string()))
    })
}

/// A number that a reader gets back with the same bits.
pub fn number(value: f64) -> String {
    format!("{value:e}")
}

/// Whether a path has the structured form of the standard: names with dots between them and whole numbers as indices.
pub fn is_structured(path: &str) -> bool {
    path.split('.').all(|part| {
        let (name, indices) = part
            .split_once('[')
            .map_or((part, None), |(name, rest)| (name, Some(rest)));
        let named = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let counted = |rest: &str| {
            let inner = rest.strip_suffix(']');
            inner.is_some_and(|inner| {
                inner
                    .split(',')
                    .all(|n| !n.is_empty() && n.chars().all(|c| c.is_ascii_digit()))
            })
        };
        named && indices.is_none_or(counted)
    })
}

/// The description.
pub(super) fn description(about: &About<'_>, version: Version) -> String {
    let About {
        model,
        token,
        variables,
        ..
    } = about;
    let structured = variables
        .iter()
        .all(|known| is_structured(&known.variable.path));
    let naming = if structured { "structured" } else { "flat" };
    let (number, tokened) = match version {
        Version::Two => ("2.0", "guid"),
        Version::Three => ("3.0", "instantiationToken"),
    };
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let _ = writeln!(
        text,
        "<fmiModelDescription fmiVersion=\"{number}\" modelName=\"{model}\" {tokened}=\"{token}\" \
             generationTool=\"Eng {}\" variableNamingConvention=\"{naming}\">",
        env!("CARGO_PKG_VERSION")
    );
    let linear = |known: &Described| known.interpolation == Interpolation::Linear;
    let _ = match version {
        Version::Two => writeln!(
            text,
            "  <CoSimulation modelIdentifier=\"{model}\" canHandleVariableCommunicationStepSize=\"true\" \
             canInterpolateInputs=\"{}\" canNotUseMemoryManagementFunctions=\"true\" \
             canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"/>",
            variables.iter().any(linear)
        ),
        Version::Three => writeln!(
            text,
            "  <CoSimulation modelIdentifier=\"{model}\" canHandleVariableCommunicationStepSize=\"true\" \
             canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"/>"
        ),
    };
    units(&mut text, variables);
    text.push_str("  <LogCategories>\n");
    text.push_str(
        "    <Category name=\"logStatusError\" description=\"Refused calls and failed steps\"/>\n",
    );
    text.push_str(
        "    <Category name=\"logStatusWarning\" description=\"Doubts about the model\"/>\n",
    );
    text.push_str("  </LogCategories>\n");
    let (stop, step) = about.experiment;
    let _ = writeln!(
        text,
        "  <DefaultExperiment startTime=\"0\"{}{}/>",
        attribute("stopTime", stop),
        attribute("stepSize", step)
    );
    text.push_str("  <ModelVariables>\n");
    let time = match version {
        Version::Two => {
            "    <ScalarVariable name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\"><Real unit=\"s\"/></ScalarVariable>\n"
        }
        Version::Three => {
            "    <Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\" unit=\"s\"/>\n"
        }
    };
    text.push_str(time);
    for (reference, known) in (1..).zip(*variables) {
        variable(&mut text, reference, known, version);
    }
    text.push_str("  </ModelVariables>\n");
    structure(&mut text, variables, version);
    text.push_str("</fmiModelDescription>\n");
    text
}

/// The SI unit of each dimension, with the display units of its variables.
fn units(text: &mut String, variables: &[Described]) {
    let mut all: BTreeMap<Dimension, BTreeMap<&str, (f64, f64)>> = BTreeMap::new();
    all.entry(Dimension::TIME).or_default();
    for known in variables {
        let shown = all.entry(known.dimension).or_default();
        let unit = &known.display;
        shown.insert(&unit.symbol, (1.0 / unit.scale, -unit.offset / unit.scale));
    }
    text.push_str("  <UnitDefinitions>\n");
    for (dimension, shown) in all {
        let _ = writeln!(
            text,
            "    <Unit name=\"{}\">",
            escaped(&dimension.to_string())
        );
        let exponents: Vec<_> = (0..BASES).map(|base| dimension.exponent(base)).collect();
        // the standard has whole exponents only
        if exponents.iter().all(|(_, denominator)| *denominator == 1) {
            text.push_str("      <BaseUnit");
            for (symbol, (exponent, _)) in BASE_SYMBOLS.iter().zip(exponents) {
                text.push_str(&attribute(symbol, (exponent != 0).then_some(exponent)));
            }
            text.push_str("/>\n");
        }
        for (symbol, (factor, offset)) in shown {
            let _ = writeln!(
                text,
                "      <DisplayUnit name=\"{}\"{}{}/>",
                escaped(symbol),
                attribute("factor", (factor != 1.0).then(|| number(factor))),
                attribute("offset", (offset != 0.0).then(|| number(offset)))
            );
        }
        text.push_str("    </Unit>\n");
    }
    text.push_str("  </UnitDefinitions>\n");
}

fn variable(text: &mut String, reference: usize, known: &Described, version: Version) {
    let (causality, variability) = match (known.variable.kind, known.interpolation) {
        (Kind::Parameter, _) => ("parameter", "fixed"),
        (Kind::Input, Interpolation::Hold) => ("input", "discrete"),
        (Kind::Input, _) => ("input", "continuous"),
        (Kind::Output, _) => ("output", "continuous"),
    };
    let (low, high) = known.limits;
    let finite = |limit: f64| limit.is_finite().then(|| number(limit));
    let head = format!(
        "name=\"{}\" valueReference=\"{reference}\" causality=\"{causality}\" variability=\"{variability}\"",
        escaped(&known.variable.path)
    );
    let facts = format!(
        " unit=\"{}\" displayUnit=\"{}\"{}{}{}",
        escaped(&known.dimension.to_string()),
        escaped(&known.display.symbol),
        attribute("min", finite(low)),
        attribute("max", finite(high)),
        attribute("start", known.start.map(number))
    );
    let _ = match version {
        Version::Two => writeln!(
            text,
            "    <ScalarVariable {head}><Real{facts}/></ScalarVariable>"
        ),
        Version::Three => writeln!(text, "    <Float64 {head}{facts}/>"),
    };
}

/// The outputs. Without stated dependencies each may depend on all inputs and parameters.
fn structure(text: &mut String, variables: &[Described], version: Version) {
    let outputs = (1..)
        .zip(variables)
        .filter(|(_, known)| known.variable.kind == Kind::Output);
    let references: Vec<usize> = outputs.map(|(reference, _)| reference).collect();
    text.push_str("  <ModelStructure>\n");
    match version {
        Version::Two => {
            for list in ["Outputs", "InitialUnknowns"] {
                let _ = writeln!(text, "    <{list}>");
                for reference in &references {
                    // indices count from 1, and time is the first
                    let _ = writeln!(text, "      <Unknown index=\"{}\"/>", reference + 1);
                }
                let _ = writeln!(text, "    </{list}>");
            }
        }
        Version::Three => {
            for item in ["Output", "InitialUnknown"] {
                for reference in &references {
                    let _ = writeln!(text, "    <{item} valueReference=\"{reference}\"/>");
                }
            }
        }
    }
    text.push_str("  </ModelStructure>\n");
}
