//! Blocks that people drew, where the corpus is at hand.

use crate::support::{Bench, corpus, errors, read};

#[test]
fn blocks_of_the_corpus_come_over_whole() {
    for (name, bytes) in corpus("siemens-graph", &[".xml"]) {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let (document, problems) = read("s7graph", &bytes);
        assert!(errors(&problems).is_empty(), "{name}: {:?}", errors(&problems));
        let chart = document.charts().next().expect("a chart");
        assert_eq!(&*chart.name.text, "FB_SEQ_One", "{name}");
        assert_eq!(chart.steps().count(), text.matches("<Step Number").count(), "{name}");
        assert_eq!(chart.transitions().count(), text.matches("<Transition IsMissing").count(), "{name}");
        // Only alternative branches in these; one ends the sequence.
        assert!(chart.transitions().all(|t| t.from.len() == 1 && t.to.len() <= 1), "{name}");
        let ends = chart.transitions().filter(|t| t.to.is_empty()).count();
        assert_eq!(ends, usize::from(name == "GraphEnd.xml"), "{name}");
        let mut bench = Bench::new(&document);
        // Every transition is true: one step further in each scan, by the first way.
        bench.scan();
        assert_eq!(bench.active(), ["Step 21"], "{name}");
    }
}
