//! Charts that people drew, where the corpus is at hand.

use crate::support::{Bench, corpus, errors, read};

#[test]
fn charts_of_the_corpus_come_over_whole() {
    for (name, bytes) in corpus("control-expert-xsf", &[".xml", ".XEF"]) {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let (document, problems) = read("controlexpert", &bytes);
        assert!(errors(&problems).is_empty(), "{name}: {:?}", errors(&problems));
        let steps: usize = document.charts().map(|c| c.steps().count()).sum();
        assert_eq!(steps, text.matches("<step ").count(), "{name}");
        let transitions: Vec<_> = document.charts().flat_map(|c| c.transitions()).collect();
        assert_eq!(transitions.len(), text.matches("<transition>").count(), "{name}");
        // No parallel branches in these: each transition has one step before and one behind it.
        assert!(transitions.iter().all(|t| t.from.len() == 1 && t.to.len() == 1), "{name}");
        let initial = document.charts().flat_map(|c| c.steps()).filter(|s| s.initial).count();
        assert_eq!(initial, text.matches("\"initialStep\"").count(), "{name}");
        let mut bench = Bench::new(&document);
        bench.scan().scan().scan();
        assert_eq!(bench.active().len(), initial, "{name}");
    }
}

#[test]
fn the_packaging_robot_turns_and_moves_its_arms() {
    let files = corpus("control-expert-xsf", &["Packaging_Robot.xml"]);
    let Some((_, bytes)) = files.first() else { return };
    let (document, _) = read("controlexpert", bytes);
    let mut bench = Bench::new(&document);
    bench.set("Belt_running", 0).set("Start_process", 1).scan().scan();
    assert_eq!(bench.active(), ["Rotation"]);
    // The rotation begins with an edge of the belt and takes a second.
    bench.set("Belt_running", 1).scan();
    assert_eq!(bench.get("Robot_one.Rotation_left"), 1);
    bench.run(1100);
    assert_ne!(bench.active(), ["Rotation"]);
}
