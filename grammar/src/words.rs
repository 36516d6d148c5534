//! The words of the language, for editors.

/// All words that have a meaning of their own somewhere. Only some are reserved; the others may be names elsewhere.
pub const WORDS: &[&str] = &[
    "accept",
    "advise",
    "against",
    "analysis",
    "and",
    "apply",
    "as",
    "at",
    "body",
    "branch",
    "by",
    "choice",
    "component",
    "const",
    "constrain",
    "cycle",
    "default",
    "der",
    "dimension",
    "drive",
    "else",
    "false",
    "field",
    "figure",
    "flexible",
    "fn",
    "for",
    "force",
    "from",
    "guess",
    "if",
    "in",
    "input",
    "interface",
    "interpolation",
    "joint",
    "journal",
    "let",
    "marker",
    "model",
    "not",
    "on",
    "or",
    "output",
    "param",
    "part",
    "place",
    "point",
    "record",
    "report",
    "require",
    "resolve",
    "scale",
    "start",
    "state",
    "summary",
    "table",
    "then",
    "torque",
    "true",
    "unit",
    "use",
    "value",
    "with",
];

#[cfg(test)]
mod tests {
    use super::WORDS;
    use std::collections::BTreeSet;

    /// The words between quotes in the rules of the grammar.
    fn of_the_grammar() -> BTreeSet<&'static str> {
        let rules = include_str!("eng.pest")
            .lines()
            .filter(|line| !line.starts_with("//"));
        let quoted = rules.flat_map(|line| line.split('"').skip(1).step_by(2));
        let is_word =
            |text: &&str| text.len() > 1 && text.bytes().all(|byte| byte.is_ascii_lowercase());
        quoted.filter(is_word).collect()
    }

    #[test]
    fn the_list_has_the_words_of_the_grammar() {
        let all: BTreeSet<&str> = WORDS.iter().copied().collect();
        assert_eq!(all, of_the_grammar());
        assert_eq!(all.len(), WORDS.len());
    }

    /// Editors of the family of TextMate colour texts by these rules.
    #[test]
    fn the_colours_of_editors_know_the_words() {
        let rules = include_str!("../../editors/vscode/syntaxes/eng.tmLanguage.json");
        let rules = rules.replace("\\\\b", " ");
        let coloured: BTreeSet<&str> = rules
            .split(|letter: char| !letter.is_ascii_lowercase())
            .collect();
        for word in WORDS {
            assert!(coloured.contains(word), "`{word}` has no colour");
        }
    }
}
