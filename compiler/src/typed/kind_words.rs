//! Names of kinds in messages.

use eng_grammar::ast::Kind;

/// The word of a kind in a text: `joint`, `body`.
pub(crate) fn kind_word(kind: Kind) -> &'static str {
    match kind {
        Kind::Model => "model",
        Kind::Component => "component",
        Kind::Interface => "interface",
        Kind::Record => "record",
        Kind::Body => "body",
        Kind::Flexible => "flexible",
        Kind::Marker => "marker",
        Kind::Joint => "joint",
        Kind::Force => "force",
        Kind::Journal => "journal",
        Kind::Drive => "drive",
        Kind::Part => "part",
        Kind::Cycle => "cycle",
        Kind::Analysis => "analysis",
        Kind::Default => "default",
    }
}

/// `a Length`, `an Angle`.
pub(crate) fn with_article(noun: &str) -> String {
    let vowel = noun
        .chars()
        .next()
        .is_some_and(|c| "aeiouAEIOU".contains(c));
    format!("{} {noun}", if vowel { "an" } else { "a" })
}
