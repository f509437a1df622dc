//! The results for programs: a line for each submission (CSV), and all of them (JSON).

use g7_grade::{Answered, Ended, Exercise, Graded, Tested};
use g7_host::csv_quote;
use serde_json::{Value, json};

use super::rows::Row;
use super::table::{answer, notes};
use crate::files::GRADES;
use crate::message::told;
use crate::testing::defect_json;

/// The table for a spreadsheet. A value that would begin a formula there begins with a quote.
pub(super) fn csv(rows: &[Row]) -> String {
    let mut out = format!(
        "{GRADES}tests,visible passed,visible,hidden passed,hidden,reached,elements,proved,refuted,not decided,\
         first failing,expected,seconds,place,locked parts changed,names missing,errors,the same but for names\n"
    );
    for row in rows {
        let mut cells = vec![row.name.clone(), row.mark().key().to_owned()];
        match &row.graded {
            Ok(graded) => cells.extend(numbers(graded)),
            Err(_) => cells.extend(std::iter::repeat_n(String::new(), 11)),
        }
        cells.extend(first(row.first_failing()));
        let graded = row.graded.as_ref().ok();
        let count = |n: Option<usize>| n.map(|n| n.to_string()).unwrap_or_default();
        cells.push(count(graded.map(|g| g.changed.len())));
        cells.push(count(graded.map(|g| g.lacks.len())));
        cells.push(count(graded.map(|g| g.problems.len())));
        cells.push(row.like.join(", "));
        let cells: Vec<String> = cells.iter().map(|c| cell(c)).collect();
        out.push_str(&cells.join(","));
        out.push('\n');
    }
    out
}

fn cell(text: &str) -> String {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']);
    csv_quote(&if is_formula { format!("'{text}") } else { text.to_owned() })
}

fn numbers(graded: &Graded) -> Vec<String> {
    let of = |hidden: bool| {
        let mine = || graded.tests.iter().filter(move |t| t.hidden == hidden);
        [mine().filter(|t| t.ended.is_passed()).count(), mine().count()]
    };
    let ((passed, all), (reached, elements)) = (graded.passed(), graded.reached());
    let [seen, hidden] = [of(false), of(true)];
    let (proved, questions) = graded.proved();
    let refuted = graded.questions.iter().filter(|q| q.is_refuted()).count();
    let counts = [passed, all].into_iter().chain(seen).chain(hidden).chain([
        reached,
        elements,
        proved,
        refuted,
        questions - proved - refuted,
    ]);
    counts.map(|n| n.to_string()).collect()
}

/// The first failing test: its title, what was expected, the time, the place.
fn first(test: Option<&Tested>) -> Vec<String> {
    let Some(test) = test else { return vec![String::new(); 4] };
    let (expected, time) = match &test.ended {
        Ended::Failed(defect) => (told(&defect.sentence()), defect.time.in_seconds().to_string()),
        Ended::Blocked { what, .. } => (told(what), String::new()),
        Ended::Passed => (String::new(), String::new()),
    };
    vec![test.title.clone(), expected, time, test.ended.place().unwrap_or(&test.place).to_owned()]
}

/// All results.
pub(super) fn json(exercise: &Exercise, rows: &[Row]) -> String {
    let rows: Vec<Value> = rows.iter().map(one).collect();
    let title = exercise.statement.title(crate::tongue::language());
    format!("{:#}\n", json!({ "tool": "g7 grade", "exercise": title, "submissions": rows }))
}

fn one(row: &Row) -> Value {
    let mut value = json!({
        "submission": row.name, "result": row.mark().key(), "notes": notes(row), "the_same_but_for_names": row.like,
    });
    let Ok(graded) = &row.graded else { return value };
    let (reached, elements) = graded.reached();
    value["coverage"] = json!({ "reached": reached, "elements": elements });
    value["tests"] = graded.tests.iter().map(test).collect();
    value["questions"] = graded.questions.iter().map(question).collect();
    let place = |p: &g7_model::Problem| json!({ "place": graded.source.place(p.at), "code": p.code.id, "message": told(&p.what) });
    value["errors"] = graded.problems.iter().map(place).collect();
    let changed = graded.changed.iter().map(|c| json!({ "place": c.place, "message": told(&c.what) }));
    value["locked_parts_changed"] = changed.collect();
    let lack = graded.lacks.iter().map(|l| {
        let near = l.near.as_ref().map(|(name, place)| json!({ "name": name, "place": place }));
        json!({ "name": l.name, "needed_at": l.place, "near": near })
    });
    value["names_missing"] = lack.collect();
    value
}

fn test(test: &Tested) -> Value {
    let mut value = json!({
        "title": test.title, "hidden": test.hidden, "place": test.place, "passed": test.ended.is_passed(),
    });
    match &test.ended {
        Ended::Passed => {}
        Ended::Blocked { place, what } => value["failure"] = json!({ "place": place, "what": told(what) }),
        Ended::Failed(defect) => {
            value["failure"] = defect_json(defect, &told(&defect.what));
            value["failure"]["ended_for_time"] = json!(defect.overdue);
        }
    }
    value
}

fn question(question: &Answered) -> Value {
    json!({
        "claim": told(&question.claim), "hidden": question.hidden, "place": question.place,
        "answer": told(&answer(question)), "proved": question.is_proved(), "refuted": question.is_refuted(),
        "reason": told(&question.reason),
    })
}
