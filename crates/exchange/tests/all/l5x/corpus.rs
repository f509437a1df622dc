//! Projects that people wrote, where the corpus is at hand.

use crate::support::{Bench, corpus, errors, read};

#[test]
fn routines_of_the_corpus_come_over_whole() {
    for (name, bytes) in corpus("rockwell-l5x", &[".L5X"]) {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let (document, problems) = read("l5x", &bytes);
        assert!(errors(&problems).is_empty(), "{name}: {:?}", errors(&problems));
        assert_eq!(document.charts().count(), text.matches("<SFCContent").count(), "{name}");
        let steps: usize = document.charts().map(|c| c.steps().count()).sum();
        assert_eq!(steps, text.matches("<Step ID").count() + text.matches("<Stop ID").count(), "{name}");
        let transitions: Vec<_> = document.charts().flat_map(|c| c.transitions()).collect();
        assert_eq!(transitions.len(), text.matches("<Transition ID").count(), "{name}");
        // Only selections in these.
        assert!(transitions.iter().all(|t| t.from.len() == 1 && t.to.len() == 1), "{name}");
        let mut bench = Bench::new(&document);
        bench.scan().scan();
        assert_eq!(bench.active().len(), document.charts().count(), "{name}");
    }
}

#[test]
fn the_sorting_chart_waits_for_its_presets() {
    let files = corpus("rockwell-l5x", &["MainProgram.L5X"]);
    let Some((_, bytes)) = files.first() else { return };
    let (document, _) = read("l5x", bytes);
    let mut bench = Bench::new(&document);
    bench.set("pp", 1).set("f0", 1).set("start", 1).scan();
    assert_eq!(bench.active(), ["Step_001"]);
    bench.set("f1", 1).scan();
    assert_eq!((bench.active(), bench.get("F")), (vec!["Step_002".to_string()], 1));
    // Its preset is 3000 ms; without d1 the right branch is gone.
    bench.run(2900);
    assert_eq!(bench.active(), ["Step_002"]);
    bench.run(200);
    assert_eq!(bench.active(), ["Step_009"]);
}
