//! The actions of a step and the condition of a transition.

use g7_model::codes;
use g7_model::{Action, ActionKind, Expr, ExprKind, Path, Qualifier, Stmt, StmtKind, Target, Type, Work};

use super::express::Express;
use super::names::{Meaning, Names};
use super::phrase::{self, Deed, Fault, Letter, Statement};
use super::read::shown;
use super::sheet::Plan;
use crate::report::Report;
use crate::xml::attr::Text;

/// Longest text of one step or transition, in bytes.
const MOST_BYTES: usize = 1 << 16;
/// Actions and conditions of a file: each costs memory far beyond its text.
pub(super) const MOST_WORK: usize = 100_000;

/// Reads texts until the file's share is used up.
pub(super) struct Texts<'a> {
    pub(super) plan: &'a Plan,
    pub(super) names: &'a Names,
    pub(super) report: &'a mut Report,
    /// Actions and conditions that may still be read.
    pub(super) left: usize,
}

impl Texts<'_> {
    /// The actions of a step.
    pub(super) fn actions(&mut self, sheet: usize, text: &Text) -> Vec<Action> {
        if text.text.trim().is_empty() || !self.fits(text) {
            return Vec::new();
        }
        let (statements, faults) = phrase::actions(&text.text, self.left);
        self.left = self.left.saturating_sub(statements.len() + faults.len());
        self.faults(text, &faults);
        let mut express = self.express(sheet, text);
        statements.iter().filter_map(|s| action(&mut express, s)).collect()
    }

    /// The condition of a transition.
    pub(super) fn condition(&mut self, sheet: usize, text: &Text, at: &std::ops::Range<usize>) -> Expr {
        let bad = Expr { kind: ExprKind::Bad, at: self.report.span(at).into() };
        if text.text.trim().is_empty() {
            self.report.say(&codes::BAD_TEXT, at, "a transition without a condition");
            return bad;
        }
        if !self.fits(text) {
            return bad;
        }
        self.left = self.left.saturating_sub(1);
        match phrase::condition(&text.text) {
            Ok(phrase) => self.express(sheet, text).condition(&phrase),
            Err(fault) => {
                self.faults(text, &[fault]);
                bad
            }
        }
    }

    fn express<'b>(&'b mut self, sheet: usize, text: &'b Text) -> Express<'b> {
        Express { plan: self.plan, names: self.names, report: self.report, sheet, text }
    }

    /// Whether the text is of a size that anybody writes.
    fn fits(&mut self, text: &Text) -> bool {
        if text.text.len() > MOST_BYTES {
            let what = format!("a text of {} bytes; at most {MOST_BYTES} are read", text.text.len());
            self.report.say(&codes::TOO_LARGE, &text.at, what);
            return false;
        }
        if self.left == 0 {
            self.report.element(
                &codes::TOO_LARGE,
                "text",
                &text.at,
                "the file has too many actions and conditions",
            );
        }
        self.left > 0
    }

    fn faults(&mut self, text: &Text, faults: &[Fault]) {
        for fault in faults {
            self.report.say(&codes::BAD_TEXT, &text.place(&fault.at), fault.what.clone());
        }
    }
}

/// One action, or nothing where it has been reported.
fn action(express: &mut Express, statement: &Statement) -> Option<Action> {
    let at = express.span(&statement.at);
    if statement.letter == Letter::A {
        let what = "an abortive action runs only when an exception transition fires; it is left out";
        express.report.say(&codes::LEFT_OUT, &express.text.place(&statement.at), what);
        return None;
    }
    let kind = match &statement.deed {
        Deed::Call(names, place) => {
            let what =
                format!("`{}` is a function or method that is not known here", shown(&names.join(".")));
            express.report.say(&codes::UNKNOWN_FUNCTION, &express.text.place(place), what);
            return None;
        }
        Deed::Level(names, place) => {
            let (path, ty) = target(express, names, place)?;
            if ty != Type::Bool {
                let what = format!("`N` needs a Boolean; `{}` is of type {ty}", shown(&names.join(".")));
                express.report.say(&codes::BAD_TEXT, &express.text.place(place), what);
                return None;
            }
            qualified(Qualifier::N, Target::Path(path))
        }
        Deed::Assign { target: (names, place), value } => {
            let Some((path, ty)) = target(express, names, place) else {
                // Its other mistakes are worth hearing of at once.
                express.value(value, Type::Dint);
                return None;
            };
            let target = Expr { kind: ExprKind::Path(path), at: express.span(place).into() };
            let value = express.value(value, ty);
            let work =
                Work::Single(Box::new(Stmt { kind: StmtKind::Assign { target, value }, at: at.into() }));
            match statement.letter {
                Letter::S => qualified(Qualifier::P1, Target::Work(work)),
                Letter::X => qualified(Qualifier::P0, Target::Work(work)),
                Letter::P => ActionKind::EachScan { work, condition: None },
                // `N v = e` is none of JGrafchart's forms; `A` has been dealt with.
                Letter::N | Letter::A => {
                    let what = "`N` takes the name of an output only; `S`, `P` and `X` assign";
                    express.report.say(&codes::BAD_TEXT, &express.text.place(&statement.at), what);
                    return None;
                }
            }
        }
    };
    Some(Action { kind, at: at.into() })
}

fn qualified(qualifier: Qualifier, target: Target) -> ActionKind {
    ActionKind::Qualified { qualifier, time: None, target, condition: None }
}

/// The variable that is written, and its type.
fn target(express: &mut Express, names: &[String], place: &std::ops::Range<usize>) -> Option<(Path, Type)> {
    match express.find(names, place) {
        Meaning::Var(sheet, var) => {
            let ty = express.plan.sheets.get(sheet)?.vars.get(var)?.ty;
            Some((express.var_path(sheet, var, express.span(place)), ty))
        }
        Meaning::Step(..) => {
            let what = format!("`{}` cannot be written", shown(&names.join(".")));
            express.report.say(&codes::BAD_TEXT, &express.text.place(place), what);
            None
        }
        Meaning::Stranger(_) | Meaning::NoPart | Meaning::Nothing => None,
    }
}
