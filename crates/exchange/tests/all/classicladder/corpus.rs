//! Projects that people drew, where the corpus is at hand.

use g7_model::Document;

use crate::support::{Bench, corpus, errors, read};

/// Lines of the chart's own file that begin with a letter and a number.
fn count(text: &str, letter: char) -> usize {
    let part = text.split("_FILE-sequential.csv").nth(1).unwrap_or("");
    let part = part.split("_/FILE-sequential.csv").next().unwrap_or("");
    let numbered = |l: &&str| l.starts_with(letter) && l[1..].starts_with(|c: char| c.is_ascii_digit());
    part.lines().filter(numbered).count()
}

fn steps(document: &Document) -> usize {
    document.charts().map(|c| c.steps().count()).sum()
}

#[test]
fn projects_of_the_corpus_come_over_whole() {
    for (name, bytes) in corpus("classicladder", &[".clp", ".clprj"]) {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let (document, problems) = read("classicladder", &bytes);
        assert_eq!(steps(&document), count(&text, 'S'), "{name}");
        let transitions: usize = document.charts().map(|c| c.transitions().count()).sum();
        assert_eq!(transitions, count(&text, 'T'), "{name}");
        assert!(errors(&problems).is_empty(), "{name}: {:?}", errors(&problems));
        let mut bench = Bench::new(&document);
        bench.scan().scan().scan();
        assert!(!bench.active().is_empty(), "{name}");
    }
}

#[test]
fn the_example_with_parallel_branches_goes_round() {
    let files = corpus("classicladder", &["example_sequential.clp"]);
    let Some((_, bytes)) = files.first() else { return };
    let (document, _) = read("classicladder", bytes);
    let mut bench = Bench::new(&document);
    // Step 0 waits for %B1, which rung 1 sets from the inputs 0, 1 and 2.
    bench.scan();
    assert_eq!(bench.active(), ["0"]);
    bench.set("I2", 1).scan();
    assert_eq!(bench.active(), ["8", "9"]);
}
