//! Words of the language's choices, names with stars, lists of names.

use eng_system::input::Interpolation;
use eng_system::internals::fits;
use eng_system::lint::Accepted;
use eng_system::place::Location;
use eng_system::sentence::{joined, listed};
use eng_system::system::Names;
use eng_system::system::summary::Statistic;

#[test]
fn interpolations_have_their_words() {
    for (word, interpolation) in Interpolation::NAMED {
        assert_eq!(Interpolation::named(word), Some(interpolation));
        assert_eq!(interpolation.word(), word);
    }
    assert_eq!(Interpolation::named("spline"), None);
}

#[test]
fn words_and_numbers_correspond() {
    for (word, statistic) in Statistic::ALL {
        assert_eq!(
            (Statistic::of(word), statistic.word()),
            (Some(statistic), word)
        );
    }
    assert_eq!(Statistic::of("smallest"), None);
}

#[test]
fn lists_are_parts_of_sentences() {
    assert_eq!(listed(&["a", "b", "c"], 3), "a, b, c");
    assert_eq!(listed(&["a", "b", "c", "d"], 3), "a, b to d (4 in all)");
    assert_eq!(listed(&[], 3), "");
    assert_eq!(joined(&[], 3), "");
    assert_eq!(joined(&["a"], 3), "a");
    assert_eq!(joined(&["a", "b"], 3), "a and b");
    assert_eq!(joined(&["a", "b", "c"], 3), "a, b and c");
    assert_eq!(joined(&["a", "b", "c", "d", "e"], 3), "a, b, c and 2 more");
}

#[test]
fn stars_fit_indices_and_vectors_their_components() {
    assert!(fits("gas[*]", "gas[12]") && fits("gas[*].top", "gas[1, 2].top"));
    assert!(!fits("gas[*]", "gas[1].top") && !fits("gas[*]", "gas") && !fits("gas", "gas[1]"));
    let channels = Names::Channels;
    assert!(channels.means("main[*].force", "main[2].force.y"));
    assert!(channels.means("main[2].force.y", "main[2].force.y"));
    assert!(!channels.means("main[2]", "main[2].force.y"));
    assert!(!Names::Inputs.means("push", "push.x"));
    assert!(Names::Parameters.means("rod[*].length", "rod[2].length"));
}

#[test]
fn an_acceptance_holds_for_its_item_and_what_is_in_it() {
    let of = |path: &str| Accepted {
        name: "usual".into(),
        path: path.into(),
        at: Location {
            source: 0,
            start: 0,
            end: 0,
        },
        used: false,
    };
    assert!(of("").covers("usual", "main[1]"));
    assert!(of("main[1]").covers("usual", "main[1]"));
    assert!(of("cylinder[2]").covers("usual", "cylinder[2].big_end"));
    assert!(!of("main[1]").covers("usual", "main[10]"));
    assert!(!of("main[1]").covers("short", "main[1]"));
    assert!(!of("").covers("", "main[1]"));
}
