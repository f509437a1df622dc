//! An exercise as a student's own program has it grades as the whole one.

use std::fs;
use std::path::{Path, PathBuf};

use g7_grade::{Exercise, Files, Graded, Limits, judge};
use g7_host::VirtualClock;
use g7_model::{Nanos, Said};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../exercises").join(name)
}

/// The files of an exercise, with its wrong solutions.
fn files(name: &str) -> Files {
    let list = |within: &str| {
        let entries = fs::read_dir(folder(name).join(within)).expect("a folder");
        entries.map(|e| e.expect("an entry").path()).filter(|p| p.is_file()).collect::<Vec<_>>()
    };
    let path = |p: &Path| p.strip_prefix(folder(name)).expect("inside").to_string_lossy().into_owned();
    let all = list("").into_iter().chain(list("wrong"));
    all.map(|p| (path(&p), fs::read(&p).expect("a file"))).collect()
}

fn graded(exercise: &Exercise, text: &str) -> Graded {
    let no_file = &mut |_: &str| Err(Said::foreign("none"));
    let source = exercise.submission("work.g7", text.as_bytes().to_vec(), no_file);
    let mut limits = Limits {
        test: Nanos::new(i64::MAX),
        questions: &|| Box::new(|| false),
        bytes: 64 << 20,
        states: Some(20_000),
        clock: &mut VirtualClock::default(),
    };
    judge(exercise, source, &mut limits)
}

/// All that is told of a work.
fn told(graded: &Graded) -> Vec<String> {
    let mut told = vec![graded.mark.key().to_owned()];
    told.extend(graded.problems.iter().map(|p| p.what.to_string()));
    told.extend(graded.changed.iter().map(|c| format!("{} {}", c.place, c.what)));
    told.extend(graded.lacks.iter().map(|l| l.said().to_string()));
    told.extend(graded.tests.iter().map(|t| format!("{} {} {:?}", t.title, t.hidden, t.ended.why())));
    told.extend(graded.questions.iter().map(|q| format!("{} {} {}", q.claim, q.hidden, q.is_refuted())));
    told
}

#[test]
fn the_handed_exercise_grades_as_the_whole_one() {
    for name in ["press", "pedestrian-light"] {
        let files = files(name);
        let whole = Exercise::read(&files, "").expect("an exercise");
        let template = whole.template.text.clone();
        let handed = Exercise::handed(template.as_bytes(), whole.given(), &whole.sealed()).expect("opens");
        let text = |path: &str| String::from_utf8_lossy(&files[path]).into_owned();
        let mut works: Vec<String> = files.keys().filter(|p| p.ends_with(".g7")).map(|p| text(p)).collect();
        // A name that is missing, a locked part that was changed, and an error.
        works.push(text("model.g7").replace("down", "dawn").replace("green", "grün"));
        works.push(text("model.g7").replace(": BOOL", ": BOOL := FALSE"));
        works.push(text("model.g7").replace(" when ", " when nothing and "));
        for work in works {
            assert_eq!(told(&graded(&handed, &work)), told(&graded(&whole, &work)), "{name}: {work}");
        }
    }
}

#[test]
fn the_failure_of_a_test_brings_the_inputs_that_lead_there() {
    let files = files("press");
    let exercise = Exercise::read(&files, "").expect("an exercise");
    let graded = graded(&exercise, &exercise.template.text);
    let failed = graded.first_failing().expect("a test that fails");
    assert_eq!(failed.title, "both buttons close the press, and it opens again");
    let g7_grade::Ended::Failed(defect) = &failed.ended else { panic!("{:?}", failed.ended) };
    // left, right, top, bottom: the buttons are pressed behind the first scan, and the press stays open.
    let begin = [vec![0, 0, 1, 0], vec![1, 1, 1, 0]];
    assert!(defect.inputs.starts_with(&begin), "{:?}", &defect.inputs[..2]);
    let period = 10;
    assert_eq!(defect.inputs.len() as i64, defect.time.count() / 1_000_000 / period + 1);
    assert!(defect.inputs[1..].iter().all(|read| *read == begin[1]));
}

#[test]
fn a_test_that_forces_has_no_such_inputs() {
    let mut files = files("press");
    let template = String::from_utf8_lossy(&files["template.g7"]).into_owned();
    let forced = template + "\ntest \"forced\" {\n  force left := TRUE\n  expect down\n}\n";
    files.insert("template.g7".to_owned(), forced.into_bytes());
    let exercise = Exercise::read(&files, "").expect("an exercise");
    let graded = graded(&exercise, &exercise.template.text);
    let test = graded.tests.iter().find(|t| t.title == "forced").expect("the test");
    let g7_grade::Ended::Failed(defect) = &test.ended else { panic!("{:?}", test.ended) };
    assert!(defect.inputs.is_empty());
}
