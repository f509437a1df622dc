//! The actions of a step and the condition of a transition.

use g7_model::codes;
use g7_model::{
    Action, ActionKind, Expr, ExprKind, Path, Qualifier, Stmt, StmtKind, Target, Type, VarKind, Work, say,
};

use super::express::Express;
use super::limits::MOST_BYTES;
use super::naming::{Meaning, Names};
use super::phrase::{self, Deed, Fault, Letter, Statement};
use super::sheet::Plan;
use super::values::initial;
use g7_iec::nodes;
use g7_iec::report::{Report, shown};
use g7_iec::xml::attr::Text;

/// Reads texts until the limit for the file is reached.
pub(super) struct Texts<'a> {
    pub(super) plan: &'a Plan,
    pub(super) names: &'a Names,
    pub(super) report: &'a mut Report,
    /// The number of actions and conditions that may still be read.
    pub(super) left: usize,
}

impl Texts<'_> {
    /// The actions of a step; `aborted` is true while its macro-step is left by an exception.
    pub(super) fn actions(&mut self, sheet: usize, text: &Text, aborted: Option<&Expr>) -> Vec<Action> {
        if text.text.trim().is_empty() || !self.fits(text) {
            return Vec::new();
        }
        let (statements, faults) = phrase::actions(&text.text, self.left);
        self.left = self.left.saturating_sub(statements.len() + faults.len());
        self.faults(text, &faults);
        let mut express = self.express(sheet, sheet, text);
        statements.iter().filter_map(|s| action(&mut express, s, aborted)).collect()
    }

    /// The condition of a transition.
    pub(super) fn condition(&mut self, sheet: usize, text: &Text, at: &std::ops::Range<usize>) -> Expr {
        let bad = Expr { kind: ExprKind::Bad, at: self.report.span(at).into() };
        if text.text.trim().is_empty() {
            self.report.say(&codes::BAD_TEXT, at, say!("a transition without a condition"));
            return bad;
        }
        if !self.fits(text) {
            return bad;
        }
        self.left = self.left.saturating_sub(1);
        match phrase::condition(&text.text) {
            Ok(phrase) => self.express(sheet, sheet, text).condition(&phrase),
            Err(fault) => {
                self.faults(text, &[fault]);
                bad
            }
        }
    }

    /// For a variable that follows an expression: `v := e` at the beginning of each scan.
    pub(super) fn follow(&mut self, sheet: usize, var: usize, text: &Text) -> Option<Stmt> {
        let ty = self.plan.sheets.get(sheet)?.vars.get(var)?.ty;
        if !self.fits(text) {
            return None;
        }
        self.left = self.left.saturating_sub(1);
        match phrase::condition(&text.text) {
            Ok(phrase) => {
                let mut express = self.express(sheet, sheet, text);
                let at = express.span(&phrase.at);
                let target = nodes::expr(ExprKind::Path(express.var_path(sheet, var, at)), at);
                let value = express.value(&phrase, ty);
                Some(nodes::assign(target, value, at))
            }
            Err(fault) => {
                self.faults(text, &[fault]);
                None
            }
        }
    }

    /// The initial values of a called procedure's variables, as `P1` actions of its enter step.
    pub(super) fn begin(&mut self, inside: usize) -> Vec<Action> {
        let Some(sheet) = self.plan.sheets.get(inside) else { return Vec::new() };
        let (Some(call), Some((caller, _))) = (&sheet.call, sheet.owner) else { return Vec::new() };
        let mut actions = Vec::new();
        for (number, var) in sheet.vars.iter().enumerate() {
            if var.kind != VarKind::Var || var.follows.is_some() {
                continue;
            }
            self.left = self.left.saturating_sub(1);
            let value = call.values.iter().find(|(n, _)| *n == number).map(|(_, value)| value);
            let at = self.report.span(value.map_or(&var.at, |_| &call.parameters.at));
            let mut express = self.express(caller, inside, &call.parameters);
            let target = nodes::expr(ExprKind::Path(express.var_path(inside, number, at)), at);
            let value = match value {
                Some(phrase) => express.value(phrase, var.ty),
                None => initial(var, at),
            };
            let work = Work::Single(Box::new(nodes::assign(target, value, at)));
            actions.push(Action { kind: qualified(Qualifier::P1, Target::Work(work), None), at: at.into() });
        }
        actions
    }

    fn express<'b>(&'b mut self, sheet: usize, home: usize, text: &'b Text) -> Express<'b> {
        Express { plan: self.plan, names: self.names, report: self.report, sheet, home, text }
    }

    /// True if the text is not too long; otherwise reports it.
    fn fits(&mut self, text: &Text) -> bool {
        if text.text.len() > MOST_BYTES {
            let what = say!("a text of {} bytes; at most {MOST_BYTES} are read", text.text.len());
            self.report.say(&codes::TOO_LARGE, &text.at, what);
            return false;
        }
        if self.left == 0 {
            self.report.element(
                &codes::TOO_LARGE,
                "text",
                &text.at,
                say!("the file has too many actions and conditions"),
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

/// One action; None if a problem has been reported.
fn action(express: &mut Express, statement: &Statement, aborted: Option<&Expr>) -> Option<Action> {
    let at = express.span(&statement.at);
    if statement.letter == Letter::A && aborted.is_none() {
        let what = say!(
            "an abortive action runs only when an exception transition fires; none does here, and it is left out"
        );
        express.report.say(&codes::LEFT_OUT, &express.text.place(&statement.at), what);
        return None;
    }
    let kind = match &statement.deed {
        Deed::Call(names, place) => {
            let what = say!("`{}` is a function or method that is not known here", shown(&names.join(".")));
            express.report.say(&codes::UNKNOWN_FUNCTION, &express.text.place(place), what);
            return None;
        }
        Deed::Level(names, place) => {
            let (path, ty) = target(express, names, place)?;
            if ty != Type::Bool {
                let what = say!("`N` needs a Boolean; `{}` is of type {ty}", shown(&names.join(".")));
                express.report.say(&codes::BAD_TEXT, &express.text.place(place), what);
                return None;
            }
            if aborted.is_some() {
                let what = say!(
                    "`{}` goes off with its step; JGrafchart leaves it as it is when an exception transition fires",
                    shown(&names.join("."))
                );
                express.report.say(&codes::DIFFERENT, &express.text.place(place), what);
            }
            qualified(Qualifier::N, Target::Path(path), None)
        }
        Deed::Assign { target: (names, place), value } => {
            let Some((path, ty)) = target(express, names, place) else {
                // Other mistakes in the value are reported as well.
                express.value(value, Type::Dint);
                return None;
            };
            let target = Expr { kind: ExprKind::Path(path), at: express.span(place).into() };
            let value = express.value(value, ty);
            let work =
                Work::Single(Box::new(Stmt { kind: StmtKind::Assign { target, value }, at: at.into() }));
            match statement.letter {
                Letter::S => qualified(Qualifier::P1, Target::Work(work), None),
                // A step that an exception transition deactivates runs `A` instead of `X`.
                Letter::X => {
                    let kept = aborted.map(|a| nodes::not(a.clone(), at));
                    qualified(Qualifier::P0, Target::Work(work), kept)
                }
                Letter::A => qualified(Qualifier::P0, Target::Work(work), aborted.cloned()),
                Letter::P => ActionKind::EachScan { work, condition: None },
                // `N v = e` is not a form of JGrafchart.
                Letter::N => {
                    let what = say!("`N` takes the name of an output only; `S`, `P` and `X` assign");
                    express.report.say(&codes::BAD_TEXT, &express.text.place(&statement.at), what);
                    return None;
                }
            }
        }
    };
    Some(Action { kind, at: at.into() })
}

fn qualified(qualifier: Qualifier, target: Target, condition: Option<Expr>) -> ActionKind {
    ActionKind::Qualified { qualifier, time: None, target, condition }
}

/// The variable that is written, and its type.
fn target(express: &mut Express, names: &[String], place: &std::ops::Range<usize>) -> Option<(Path, Type)> {
    match express.find(names, place) {
        Meaning::Var(sheet, var) => {
            let ty = express.plan.sheets.get(sheet)?.vars.get(var)?.ty;
            Some((express.var_path(sheet, var, express.span(place)), ty))
        }
        Meaning::Step(..) => {
            let what = say!("`{}` cannot be written", shown(&names.join(".")));
            express.report.say(&codes::BAD_TEXT, &express.text.place(place), what);
            None
        }
        Meaning::Stranger(_) | Meaning::NoPart | Meaning::Nothing => None,
    }
}
