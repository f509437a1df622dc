//! The mistakes of an exercise that show when its model solution and its wrong solutions are graded.

use g7_model::{Said, say};

use crate::exercise::{Fault, problem};
use crate::judge::{Graded, Mark};

/// The mistakes that the graded solutions show: a model solution that fails, and wrong solutions that no test catches.
pub fn check(model: &Graded, wrong: &[Graded]) -> Vec<Fault> {
    let mut faults = of_the_model(model);
    for one in wrong {
        let what = match one.mark {
            Mark::Failed | Mark::Fitted => continue,
            Mark::Passed => say!("no test catches this wrong solution"),
            Mark::Changed => say!("no test catches this wrong solution: it only changes a locked part"),
            Mark::Unread => say!("this wrong solution has errors, so that no test can catch it"),
        };
        faults.push(Fault { place: one.source.name.clone(), what });
        faults.extend(one.problems.iter().map(|p| problem(&one.source, p)));
    }
    faults
}

fn of_the_model(model: &Graded) -> Vec<Fault> {
    let mut faults: Vec<Fault> = model.problems.iter().map(|p| problem(&model.source, p)).collect();
    faults.extend(model.changed.iter().map(|c| Fault { place: c.place.clone(), what: c.what.clone() }));
    for test in &model.tests {
        if let Some(why) = test.ended.why() {
            let title = Said::foreign(test.title.as_str());
            let what = say!("the model solution fails the test `{title}`: {why}");
            faults.push(Fault { place: test.ended.place().unwrap_or(&test.place).to_owned(), what });
        }
    }
    for question in model.questions.iter().filter(|q| q.is_refuted()) {
        let what = say!("the model solution does not keep this: {}", question.claim);
        faults.push(Fault { place: question.place.clone(), what });
    }
    faults
}
