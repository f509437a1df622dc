//! The messages that the page can send, each with the type of its answer. They stand in one table. The requests, the
//! trait that answers them and the page's `protocol.ts` are all made from it.

use g7_model::Said;
use serde::Deserialize;

use crate::answer::{Answer, Before, Breaks, Shelved, Style, Text, ok};
use crate::drawing::Wish as Drawing;
use crate::edit::{Edited, Foreseen};
use crate::exercise::{Checked, Packed, Work};
use crate::export::{Form, Out};
use crate::language::{ActionForm, Coloured, Completion, Hit, Hover, Piece, Tables, Tongue};
use crate::merge::Merged;
use crate::overview::Overview;
use crate::picture::PlantPicture;
use crate::places::Change;
use crate::printed::{Printed, Wish as Sheets};
use crate::prove::{Both, Compared, Limits, Report as Proved, Ways, Wish as Refuted};
use crate::redrawn::Redrawn;
use crate::run::{Asked, Because, Form as SignalsForm, Frame, Lanes, Start, Started, Swapped};
use crate::testing::{Reasons as TestReasons, Report as Tested};

/// Makes of each row `fn name(fields) -> Answer;` a request with these fields and a method of [`Answers`]. A
/// method that returns something else does not compile.
macro_rules! requests {
    ($(
        $(#[doc = $doc:literal])*
        fn $name:ident($($(#[$of:meta])* $field:ident: $ty:ty),* $(,)?) -> $answer:ty;
    )*) => {
        /// A message of the page.
        #[derive(Debug, Deserialize)]
        #[serde(tag = "do")]
        #[allow(non_camel_case_types, reason = "the names are those of the messages")]
        pub(crate) enum Request {
            $($name($name),)*
        }

        $(
            /// The contents of the message of this name.
            #[derive(Debug, Deserialize)]
            #[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields = nullable))]
            #[allow(non_camel_case_types, reason = "the names are those of the messages")]
            pub(crate) struct $name {
                $($(#[$of])* $field: $ty,)*
            }
        )*

        /// Answers messages.
        pub(crate) trait Answers {
            $(
                $(#[doc = $doc])*
                fn $name(&mut self, $($field: $ty),*) -> Result<$answer, Said>;
            )*

            fn answer(&mut self, request: Request) -> Answer {
                match request {
                    $(Request::$name($name { $($field),* }) => ok(&self.$name($($field),*)?),)*
                }
            }
        }

        /// The types of all messages.
        #[cfg(feature = "types")]
        pub fn types() -> crate::types::Types {
            let mut types = crate::types::Types::default();
            $(types.row::<$name, $answer>(stringify!($name), concat!($($doc, "\n"),*));)*
            types
        }
    };
}

requests! {
    /// Opens a text under a name; a file that is imported gets another name. `uses` are texts of files that it uses, by
    /// their paths from its folder; those that are missing are wanted.
    fn open(file: String, text: String, uses: Option<Vec<Shelved>>) -> Overview;

    /// The texts of the files that a file uses, by their paths from its folder.
    fn used(file: String) -> Vec<Shelved>;

    /// Forgets a file.
    fn close(file: String) -> ();

    /// Gives the texts of files that open files use; without a text, it is not there.
    fn lend(files: Vec<Shelved>) -> ();

    /// Chooses the language of the answers: `en`, `fr`, `pt`. A program without the texts in it is given them.
    fn speak(language: String, words: Option<String>) -> ();

    fn look(file: String) -> Overview;

    fn text(file: String) -> Text;

    /// Changes the text as it is typed. A unit is undone alone; a change of others is not undone here.
    fn splice(
        file: String,
        splices: Vec<Change>,
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        unit: bool,
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        others: bool,
    ) -> Overview;

    /// Executes a gesture.
    fn edit(file: String, gesture: g7_edit::Gesture) -> Edited;

    /// The effect that a gesture would have.
    fn foresee(file: String, gesture: g7_edit::Gesture) -> Foreseen;

    /// Executes a fix, by the number of its problem in the overview of this version and its own number there.
    fn mend(file: String, version: u64, problem: usize, fix: usize) -> Edited;

    /// The parts of an action as typed, with another qualifier or time where one is given; an empty qualifier takes it
    /// away.
    fn action_form(text: String, qualifier: Option<String>, time: Option<String>) -> ActionForm;

    fn undo(file: String) -> Edited;

    fn redo(file: String) -> Edited;

    /// The steps that would be joined if these parts were deleted and the chart healed.
    fn joins(file: String, ids: Vec<g7_edit::ItemId>) -> Vec<g7_edit::Joined>;

    /// Copies symbols as text, to be pasted elsewhere.
    fn copy(file: String, ids: Vec<g7_edit::ItemId>) -> Text;

    /// Merges two changes of one text.
    fn merge(base: String, mine: String, theirs: String) -> Merged;

    fn format(file: String) -> Edited;

    /// The places that name the same part as the word at a place.
    fn references(file: String, at: usize) -> Vec<(usize, usize)>;

    fn drawing(#[serde(flatten)] wish: Drawing) -> Redrawn<'_>;

    /// Lists the forms in which a chart can be exported.
    fn forms() -> Vec<Form>;

    /// Exports a file in one of them.
    fn export(file: String, to: String) -> Out;

    /// Sheets of paper: of the named charts or, with `dossier`, all that is known of the file.
    fn sheets(file: String, #[serde(flatten)] wish: Sheets) -> Printed;

    /// The picture of a plant, and what can be bound in it.
    fn plant_picture(file: String, plant: String) -> PlantPicture;

    /// The logic of a symbol in one of the languages of controllers.
    fn logic(file: String, id: String, tongue: Tongue) -> Vec<Piece>;

    /// Converts logic in one of these languages to an expression of the text.
    fn logic_read(tongue: Tongue, text: String) -> Text;

    /// The style sheet of the drawings.
    fn style(
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        dark: bool,
    ) -> Style;

    /// Runs the tests whose titles contain `name`, or all.
    fn test(file: String, name: Option<String>) -> Tested;

    /// Why a test of this title failed.
    fn test_why(file: String, name: String) -> TestReasons;

    /// Answers all questions about the file, as far as the limits go.
    fn prove(file: String, #[serde(flatten)] limits: Limits) -> Proved;

    /// The ways on from a refuted claim.
    fn prove_ways(file: String, #[serde(flatten)] wish: Refuted) -> Ways;

    /// Compares two files for every sequence of inputs, as far as the limits go.
    fn compare(#[serde(flatten)] wish: Both) -> Compared;

    /// Makes of the files of an exercise what students get. The names of the files are their paths in its folder.
    fn exercise_pack(folder: String, files: Vec<Shelved>) -> Packed;

    /// Checks the work of a student by the tests and questions of an exercise.
    fn exercise_check(#[serde(flatten)] work: Work) -> Checked;

    /// The text before the last change.
    fn before(file: String) -> Before;

    /// The classes of the tokens in a part of the text.
    fn tokens(
        file: String,
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        from: usize,
        #[serde(default = "end")]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        to: usize,
    ) -> Vec<Coloured>;

    fn complete(file: String, at: usize) -> Completion;

    fn hover(file: String, at: usize) -> Option<Hover>;

    /// The tables of variables and steps.
    fn symbols(file: String) -> Tables;

    fn search(file: String, text: String) -> Vec<Hit>;

    fn run_start(#[serde(flatten)] wish: Start) -> Started;

    fn run_advance(
        run: String,
        ms: f64,
        most_scans: Option<u32>,
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        times: bool,
    ) -> Frame;

    fn run_scan(
        run: String,
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        times: bool,
    ) -> Frame;

    fn run_pass(
        run: String,
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        times: bool,
    ) -> Frame;

    fn run_set(run: String, signal: usize, value: String) -> Frame;

    fn run_toggle(run: String, signal: usize) -> Frame;

    fn run_force(run: String, signal: usize, value: String) -> Frame;

    /// Releases one signal, or all if none is named.
    fn run_release(run: String, signal: Option<usize>) -> Frame;

    fn run_restart(
        run: String,
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        warm: bool,
    ) -> Frame;

    /// Shows the run as it was at an instant.
    fn run_seek(run: String, ms: f64) -> Frame;

    /// Shows the present again, or goes on from the shown instant.
    fn run_live(
        run: String,
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        here: bool,
    ) -> Frame;

    fn run_breaks(run: String, ids: Vec<String>) -> Breaks;

    /// Continues a run with a changed text; what would be lost is lost only by force.
    fn run_swap(
        run: String,
        file: String,
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        force: bool,
    ) -> Swapped;

    fn run_stop(run: String) -> ();

    fn run_frame(
        run: String,
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        full: bool,
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        times: bool,
    ) -> Frame;

    /// Asks again for the description of a run that its start returned.
    fn run_signals(run: String) -> Started;

    fn run_lanes(
        run: String,
        signals: Vec<usize>,
        from_ms: f64,
        to_ms: f64,
        #[serde(default = "lane")]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        most: usize,
    ) -> Lanes;

    /// The record of a run from its start: all that entered the charts. The message `why` needs it.
    fn run_tape(run: String) -> Text;

    /// Why something happened in a run, of which this is the record.
    fn why(#[serde(flatten)] asked: Asked) -> Because;

    /// The signals as a file; all of them if none is named.
    fn run_export(
        run: String,
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        signals: Vec<usize>,
        r#as: SignalsForm,
        from_ms: Option<f64>,
        to_ms: Option<f64>,
    ) -> Text;
}

/// The default end of a range: the end of the text.
fn end() -> usize {
    usize::MAX
}

/// The default number of edges in a lane: more than the columns of a screen.
fn lane() -> usize {
    4_000
}

impl Request {
    /// The names of the files that the second module needs to answer this request. Empty if the first module
    /// answers it.
    pub(crate) fn files(&self) -> Vec<String> {
        match self {
            Request::export(export { file, .. })
            | Request::logic(logic { file, .. })
            | Request::sheets(sheets { file, .. })
            | Request::plant_picture(plant_picture { file, .. })
            | Request::prove(prove { file, .. })
            | Request::test(test { file, .. })
            | Request::test_why(test_why { file, .. })
            | Request::prove_ways(prove_ways { file, .. }) => vec![file.clone()],
            Request::compare(compare { wish }) => wish.files.to_vec(),
            _ => Vec::new(),
        }
    }
}
