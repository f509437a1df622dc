//! The gestures of the user, as the page sends them (JSON with the tag `g`).

use g7_model::{ActionForm, LinkForm};

use crate::id::ItemId;
use crate::splice::Splice;

/// One gesture of the editor.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields = nullable))]
#[serde(tag = "g", rename_all = "snake_case", deny_unknown_fields)]
pub enum Gesture {
    /// Adds a step without links.
    AddStep {
        /// The chart.
        chart: String,
        /// Its place, in pixels of the drawing.
        #[serde(default)]
        at: Option<[f64; 2]>,
        /// Its kind; a plain step if absent.
        #[serde(default)]
        kind: Option<Sort>,
    },
    /// Continues a sequence: adds a transition and a step after a step, a step after a transition.
    Next {
        /// The step or transition.
        id: ItemId,
    },
    /// The same before a step or transition.
    Before {
        /// The step or transition.
        id: ItemId,
    },
    /// Adds a link, with a step or transition in between where steps and transitions must
    /// alternate.
    Connect {
        /// The start of the link.
        from: ItemId,
        /// The end of the link.
        to: ItemId,
    },
    /// Takes one end of a link to another symbol.
    Relink {
        /// The link, or one end of a broken one.
        link: ItemId,
        /// The end that moves.
        end: LinkEnd,
        /// The step or transition at which it ends then.
        to: ItemId,
    },
    /// Inserts a step and a transition into a link.
    Insert {
        /// The link.
        link: ItemId,
        /// The part to insert.
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        what: What,
    },
    /// Adds a branch.
    Branch {
        /// The step or transition at which it begins.
        id: ItemId,
        /// A selection (or) or simultaneous sequences (and).
        how: Branching,
    },
    /// Makes branches converge.
    Converge {
        /// The ends of the branches.
        ids: Vec<ItemId>,
        /// The end of a selection (or) or of simultaneous sequences (and).
        how: Branching,
        /// The step they lead to; a new one if absent.
        #[serde(default)]
        to: Option<ItemId>,
    },
    /// Adds a link to a step that may be far away.
    Jump {
        /// The step or transition at which it starts.
        id: ItemId,
        /// The step to which it leads.
        to: ItemId,
    },
    /// Adds a simultaneous branch beside a sequence.
    Parallel {
        /// The steps and transitions of the sequence.
        ids: Vec<ItemId>,
    },
    /// Deletes parts of a chart.
    Delete {
        /// The parts.
        ids: Vec<ItemId>,
        /// Join what was before the parts to what was after them.
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        heal: bool,
    },
    /// Renames a step, chart or variable wherever it is used.
    Rename {
        /// The step or chart.
        #[serde(default)]
        id: Option<ItemId>,
        /// A variable instead, as `Chart.name` if it belongs to a chart.
        #[serde(default)]
        name: Option<String>,
        /// The new name.
        to: String,
    },
    /// Changes the receptivity of a transition; TRUE if the text is empty.
    Receptivity {
        /// The transition.
        id: ItemId,
        /// The receptivity as typed.
        text: String,
    },
    /// Adds, changes or deletes an action of a step.
    Action {
        /// The step, or one of its actions.
        id: ItemId,
        /// The number of the action, from 0; a new action if absent.
        #[serde(default)]
        index: Option<usize>,
        /// The action as typed; empty to delete it.
        text: String,
    },
    /// Changes the comment of a step, transition or chart, or a comment of the layout section.
    Comment {
        /// The commented part, or the comment of the layout section.
        id: ItemId,
        /// The text without quotes. Empty removes the comment.
        text: String,
    },
    /// Adds a comment that belongs to no symbol, at a place of the drawing.
    CommentAt {
        /// The chart.
        chart: String,
        /// The text without quotes.
        text: String,
        /// Its upper left corner, in pixels.
        at: [f64; 2],
    },
    /// Changes the label of a transition.
    Label {
        /// The transition.
        id: ItemId,
        /// The label; empty for none.
        text: String,
    },
    /// Changes the priority of a transition.
    Priority {
        /// The transition.
        id: ItemId,
        /// The priority, 1 being the first; absent for none.
        #[serde(default)]
        n: Option<u32>,
    },
    /// Changes the preceding and succeeding steps of a transition.
    Ends {
        /// The transition.
        id: ItemId,
        /// The names of the preceding steps; unchanged if absent.
        #[serde(default)]
        before: Option<Vec<String>>,
        /// The names of the succeeding steps; unchanged if absent.
        #[serde(default)]
        after: Option<Vec<String>>,
    },
    /// Adds a step to the initial situation or removes it.
    Initial {
        /// The step.
        id: ItemId,
        /// True if the step is initial.
        on: bool,
    },
    /// Changes the kind of a step.
    Kind {
        /// The step.
        id: ItemId,
        /// The kind.
        kind: Sort,
    },
    /// Moves symbols on the drawing.
    Move {
        /// Steps and transitions.
        ids: Vec<ItemId>,
        /// Distance to the right, in pixels.
        dx: f64,
        /// Distance downward, in pixels.
        dy: f64,
    },
    /// Aligns symbols.
    Align {
        /// Steps and transitions.
        ids: Vec<ItemId>,
        /// The kind of alignment.
        how: Alignment,
    },
    /// Gives a link bends of its own.
    Bend {
        /// The link.
        link: ItemId,
        /// For each height at which it goes sideways, that height, and the place from which it goes on; in pixels,
        /// from its start. Without any the link goes the way of the layout again.
        points: Vec<[f64; 2]>,
    },
    /// Chooses the form in which a link is drawn.
    LinkForm {
        /// The link, or one end of a broken one.
        link: ItemId,
        /// The form; the layout decides if absent.
        #[serde(default)]
        form: Option<DrawnAs>,
    },
    /// Chooses how the actions of a step stand, or those of all steps of a chart that have no choice of their own.
    ActionForm {
        /// The step, one of its actions, or the chart.
        id: ItemId,
        /// The form; if absent, a step follows its chart and a chart has them one below the other.
        #[serde(default)]
        form: Option<StackedAs>,
    },
    /// Gives a chart its place on the sheet with the other charts of the file.
    Sheet {
        /// The chart; every chart of the file if absent, which then gets no place.
        #[serde(default)]
        chart: Option<String>,
        /// The place of the origin of its drawing, in pixels; without one it stands in the rows of the sheet.
        #[serde(default)]
        at: Option<[f64; 2]>,
    },
    /// Returns to the automatic layout.
    Tidy {
        /// The chart.
        chart: String,
    },
    /// Pastes a text that [`crate::copy`] returned.
    Paste {
        /// The chart.
        chart: String,
        /// The text.
        text: String,
        /// The place of its first step, in pixels.
        #[serde(default)]
        at: Option<[f64; 2]>,
    },
    /// Deletes parts that the page copied before.
    Cut {
        /// The parts.
        ids: Vec<ItemId>,
    },
    /// Adds a chart.
    AddChart {
        /// The kind of chart.
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
        kind: ChartSort,
        /// Its name; a new one is found if absent.
        #[serde(default)]
        name: Option<String>,
    },
    /// Deletes a chart and its layout section.
    DeleteChart {
        /// The chart.
        chart: String,
    },
    /// Moves a sequence into the expansion of a new macro-step.
    Macro {
        /// Its steps and transitions.
        ids: Vec<ItemId>,
    },
    /// Changes or adds a row of the table of variables.
    Variable {
        /// The variable to change, `Chart.name` if it belongs to a chart; a new one if absent.
        #[serde(default)]
        name: Option<String>,
        /// The new contents of the row.
        row: Row,
    },
    /// Declares variables, together with a gesture that names them.
    Declare {
        /// Their rows.
        rows: Vec<Row>,
        /// The gesture, which is undone with them.
        #[serde(default)]
        #[cfg_attr(feature = "types", ts(type = "Gesture | null", optional))]
        with: Option<Box<Gesture>>,
    },
    /// Deletes a variable.
    DeleteVariable {
        /// Its name, `Chart.name` if it belongs to a chart.
        name: String,
    },
    /// Sets the profile of the file.
    Profile {
        /// Its name.
        name: String,
    },
    /// Sets or clears a switch of the profile.
    Switch {
        /// The word of the switch, for instance `one-pass`.
        name: String,
        /// True to write the switch, false to leave it to the profile.
        on: bool,
    },
    /// Sets the greatest number of passes in a scan.
    Bound {
        /// The number; the profile decides if absent.
        #[serde(default)]
        n: Option<u32>,
    },
    /// Sets the scan time of the file.
    Scan {
        /// The time in milliseconds.
        ms: f64,
    },
    /// Gives a plant a picture, or changes what its picture shows.
    View {
        /// The plant.
        plant: String,
        /// The SVG file, relative to the file of the plant.
        file: String,
        /// All bindings that the picture has then.
        bindings: Vec<Bound>,
    },
    /// Changes the text directly, as the user types. The page sends its own changes as `splice`.
    #[cfg_attr(feature = "types", ts(skip))]
    Text {
        /// The changes, in bytes of the text before.
        splices: Vec<Splice>,
    },
}

/// A part that is inserted into a link; the step or transition that alternation needs comes with
/// it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Between"))]
#[serde(rename_all = "snake_case")]
pub enum What {
    /// A step.
    #[default]
    Step,
    /// A transition.
    Transition,
    /// A macro-step with a new expansion.
    Macro,
    /// An enclosing step.
    Enclosing,
}

/// A binding of a picture: an attribute of an element follows a value.
#[derive(Clone, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "PictureBinding"))]
pub struct Bound {
    /// The element, by its name in the picture.
    pub element: String,
    /// The attribute.
    pub attribute: String,
    /// The value, an expression in the terms of the plant.
    pub value: String,
}

/// The two ends of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum LinkEnd {
    /// The symbol that it leaves.
    From,
    /// The symbol to which it leads.
    To,
}

/// The forms in which a link can be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "LinkForm"))]
#[serde(rename_all = "snake_case")]
pub enum DrawnAs {
    /// A line from its start to its end.
    Line,
    /// Broken off, with the name of the other end at each.
    Jump,
}

impl DrawnAs {
    /// The form of a layout section.
    pub fn form(self) -> LinkForm {
        match self {
            DrawnAs::Line => LinkForm::Line,
            DrawnAs::Jump => LinkForm::Jump,
        }
    }
}

impl From<LinkForm> for DrawnAs {
    fn from(form: LinkForm) -> DrawnAs {
        match form {
            LinkForm::Line => DrawnAs::Line,
            LinkForm::Jump => DrawnAs::Jump,
        }
    }
}

/// How the actions of a step can stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ActionsForm"))]
#[serde(rename_all = "snake_case")]
pub enum StackedAs {
    /// One below the other.
    Column,
    /// Side by side.
    Row,
}

impl StackedAs {
    /// The form of a layout section.
    pub fn form(self) -> ActionForm {
        match self {
            StackedAs::Column => ActionForm::Column,
            StackedAs::Row => ActionForm::Row,
        }
    }
}

impl From<ActionForm> for StackedAs {
    fn from(form: ActionForm) -> StackedAs {
        match form {
            ActionForm::Column => StackedAs::Column,
            ActionForm::Row => StackedAs::Row,
        }
    }
}

/// Kinds of branching.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Branching {
    /// A selection: one of the branches.
    Or,
    /// Simultaneous sequences: all branches.
    And,
}

/// Kinds of step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "StepKind"))]
#[serde(rename_all = "snake_case")]
pub enum Sort {
    /// A plain step.
    Plain,
    /// A macro-step.
    Macro,
    /// An enclosing step.
    Enclosing,
    /// The first step of an expansion or task.
    Entry,
    /// The last step of an expansion or task.
    Exit,
}

/// Kinds of chart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "ChartKind"))]
#[serde(rename_all = "snake_case")]
pub enum ChartSort {
    /// An ordinary chart.
    #[default]
    Chart,
    /// The expansion of a macro-step.
    #[serde(alias = "macrochart")]
    Expansion,
    /// A task.
    Task,
}

/// Kinds of alignment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Alignment {
    /// In a column, at the symbol farthest to the left.
    Left,
    /// In a row, at the highest symbol.
    Top,
    /// In a column, at the middle of the symbols.
    Center,
    /// Equal horizontal distances.
    DistributeX,
    /// Equal vertical distances.
    DistributeY,
}

/// A variable as the table shows it; a field is empty if the variable has no such part.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "VariableEdit", optional_fields = nullable))]
#[serde(default)]
pub struct Row {
    /// Its name.
    #[serde(deserialize_with = "text_or_null")]
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    pub name: String,
    /// `input`, `output`, `var` or `const`; `var` if empty.
    #[serde(deserialize_with = "text_or_null")]
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    pub class: String,
    /// Its type; BOOL if empty.
    #[serde(rename = "type")]
    #[serde(deserialize_with = "text_or_null")]
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    pub ty: String,
    /// Its initial value.
    #[serde(deserialize_with = "text_or_null")]
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    pub init: String,
    /// Its address or channel.
    #[serde(deserialize_with = "text_or_null")]
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    pub address: String,
    /// True if the channel carries the complement.
    #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
    pub inverted: bool,
    /// True if the value is kept over a restart.
    #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
    pub retain: bool,
    /// For an output: its value after a fault.
    #[serde(deserialize_with = "text_or_null")]
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    pub safe: String,
    /// Its comment, without quotes.
    #[serde(deserialize_with = "text_or_null")]
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    pub comment: String,
    /// The chart to which it belongs; the file if absent.
    pub chart: Option<String>,
}

/// Reads a text for which the page may send `null`.
fn text_or_null<'de, D: serde::Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    use serde::Deserialize;
    Option::<String>::deserialize(from).map(Option::unwrap_or_default)
}

#[cfg(test)]
mod tests {
    use super::{Alignment, Branching, Gesture, What};
    use crate::id::{End, ItemId};

    #[test]
    fn gestures_are_read_as_the_page_writes_them() {
        for (json, gesture) in [
            (r#"{"g":"next","id":"G/s/1"}"#, Gesture::Next { id: ItemId::step("G", "1") }),
            (
                r#"{"g":"insert","link":"G/l/s:1>t:0"}"#,
                Gesture::Insert {
                    link: ItemId::link("G", End::Step("1".into()), End::Transition(0)),
                    what: What::Step,
                },
            ),
            (
                r#"{"g":"branch","id":"G/t/0","how":"and"}"#,
                Gesture::Branch { id: ItemId::transition("G", 0), how: Branching::And },
            ),
            (
                r#"{"g":"priority","id":"G/t/0","n":null}"#,
                Gesture::Priority { id: ItemId::transition("G", 0), n: None },
            ),
            (
                r#"{"g":"align","ids":[],"how":"distribute_x"}"#,
                Gesture::Align { ids: vec![], how: Alignment::DistributeX },
            ),
        ] {
            assert_eq!(serde_json::from_str::<Gesture>(json).expect(json), gesture);
        }
        for wrong in [r#"{"g":"fly"}"#, r#"{"g":"next","id":"G/q"}"#, r#"{"g":"next"}"#] {
            assert!(serde_json::from_str::<Gesture>(wrong).is_err(), "{wrong}");
        }
    }
}
