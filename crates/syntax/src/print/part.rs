//! Parts of a document as texts of their own, for a text in which the rest stays as it is.
//!
//! A gesture changes a few parts; `g7-edit` puts their texts, made here, between those that stay. What
//! the user typed and what is only moved keeps its spelling: the caller knows it by its place.

use super::{Printer, Spelled};
use super::{chart, item};
use crate::lexer::{Lexer, Tok};
use g7_model::{Action, ChartItem, Item, Name, PlaceAt, Span, StepKind, VarDecl};

/// A part of a document.
#[derive(Clone, Copy, Debug)]
pub enum Part<'d> {
    /// An item of a file.
    Item(&'d Item),
    /// An item of a chart; a transition with its preceding steps, also if it continues another one.
    ChartItem(&'d ChartItem),
    /// A variable.
    Variable(&'d VarDecl),
    /// The words before the name of a step: `initial step`.
    StepWords(&'d StepKind, bool),
    /// Actions in their braces, behind a header that ends in this column.
    Actions(&'d [Action], usize),
    /// One action.
    Action(&'d Action),
    /// Preceding or succeeding steps: `5`, `(3, 5)` or `()`.
    Steps(&'d [Name]),
    /// A label and its colon.
    Label(&'d Name),
    /// A place in a layout section.
    Place(&'d PlaceAt),
}

/// The canonical text of a part without indentation and without the last line end. Lines end with
/// `\n`.
pub fn print_part(part: Part<'_>, spelled: Option<Spelled<'_>>) -> String {
    let mut printer = Printer::new(&[], None);
    printer.spelled = spelled;
    match part {
        Part::Item(item) => printer.item(item, false),
        Part::ChartItem(item) => printer.chart_item(item, None, false),
        Part::Variable(variable) => printer.variable(variable),
        Part::StepWords(kind, initial) => printer.step_words(kind, initial),
        Part::Actions(actions, column) => {
            // The header stands before the braces on their line.
            printer.out = " ".repeat(column);
            printer.actions(actions, Span::default());
            printer.out.drain(..column);
        }
        Part::Action(action) => printer.action(action),
        Part::Steps(names) => printer.step_list(names),
        Part::Label(name) => printer.transition_label(name),
        Part::Place(place) => printer.place_at(place),
    }
    printer.out.truncate(printer.out.trim_end().len());
    printer.out
}

/// True if a blank line separates two items of a file when both are new.
pub fn items_apart(a: &Item, b: &Item) -> bool {
    item::stand_apart(a, b)
}

/// True if a blank line separates two items of a chart when both are new.
pub fn chart_items_apart(a: &ChartItem, b: &ChartItem) -> bool {
    chart::stand_apart(a, b)
}

impl Printer<'_> {
    /// The text of a part that keeps its spelling.
    fn spelling(&self, at: Span) -> Option<String> {
        self.spelled.and_then(|spelled| spelled(at))
    }

    /// Writes a part that keeps its spelling, its further lines as deep as this line; false if the part
    /// is to be printed.
    pub(super) fn as_spelled(&mut self, at: Span) -> bool {
        let Some(text) = self.spelling(at) else { return false };
        for (k, line) in text.lines().enumerate() {
            if k > 0 {
                self.push("\n");
                if !line.trim().is_empty() {
                    self.start_line();
                }
            }
            self.push(line);
        }
        true
    }

    /// True if a part keeps a spelling that has a note in it, behind which nothing may stand.
    pub(super) fn spelled_with_note(&self, at: Span) -> bool {
        let Some(text) = self.spelling(at) else { return false };
        let mut lexer = Lexer::new(&text, at.file, 0);
        while lexer.token().kind != Tok::End {}
        !lexer.notes.is_empty()
    }
}
