//! What a person does to a chart, as the page says it (JSON, tag `g`).

use crate::id::ItemId;
use crate::splice::Splice;

/// One gesture of the editor.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(tag = "g", rename_all = "snake_case", deny_unknown_fields)]
pub enum Gesture {
    /// A step by itself.
    AddStep {
        /// The chart.
        chart: String,
        /// Where it stands, in pixels of the drawing.
        #[serde(default)]
        at: Option<[f64; 2]>,
        /// What sort; a plain one when absent.
        #[serde(default)]
        kind: Option<Sort>,
    },
    /// Builds on: behind a step a transition and a step, behind a transition a step.
    Next {
        /// The step or transition.
        id: ItemId,
    },
    /// The same before a step or transition.
    Before {
        /// The step or transition.
        id: ItemId,
    },
    /// A link; with what alternation needs in between.
    Connect {
        /// Where it begins.
        from: ItemId,
        /// Where it ends.
        to: ItemId,
    },
    /// A step and a transition into a link.
    Insert {
        /// The link.
        link: ItemId,
        /// What is wanted of it.
        #[serde(default)]
        what: What,
    },
    /// A branch more.
    Branch {
        /// The step or transition at which it begins.
        id: ItemId,
        /// Alternative or simultaneous.
        how: Branching,
    },
    /// Branches brought together.
    Converge {
        /// Their ends.
        ids: Vec<ItemId>,
        /// Alternative or simultaneous.
        how: Branching,
        /// The step they lead to; a new one when absent.
        #[serde(default)]
        to: Option<ItemId>,
    },
    /// A link to a step far away.
    Jump {
        /// The step or transition it begins at.
        id: ItemId,
        /// The step.
        to: ItemId,
    },
    /// A simultaneous branch beside a sequence.
    Parallel {
        /// The steps and transitions of the sequence.
        ids: Vec<ItemId>,
    },
    /// Takes things away.
    Delete {
        /// The things.
        ids: Vec<ItemId>,
        /// Joins what was before them to what was behind them.
        #[serde(default)]
        heal: bool,
    },
    /// Gives a step, chart or variable another name, wherever it is used.
    Rename {
        /// The step or chart.
        #[serde(default)]
        id: Option<ItemId>,
        /// Or the variable, `Chart.name` for one of a chart.
        #[serde(default)]
        name: Option<String>,
        /// The new name.
        to: String,
    },
    /// The receptivity of a transition; TRUE when empty.
    Receptivity {
        /// The transition.
        id: ItemId,
        /// As typed.
        text: String,
    },
    /// An action of a step.
    Action {
        /// The step, or one of its actions.
        id: ItemId,
        /// Which action, from 0; a new one when absent.
        #[serde(default)]
        index: Option<usize>,
        /// As typed; empty to delete it.
        text: String,
    },
    /// The comment of a step, transition or chart, or the text of one in the layout.
    Comment {
        /// The thing.
        id: ItemId,
        /// Without quotes; empty for none, which takes one in the layout away.
        text: String,
    },
    /// A comment that belongs to no symbol, somewhere on the drawing.
    CommentAt {
        /// The chart.
        chart: String,
        /// Without quotes.
        text: String,
        /// Its upper left corner, in pixels.
        at: [f64; 2],
    },
    /// The label of a transition.
    Label {
        /// The transition.
        id: ItemId,
        /// Empty for none.
        text: String,
    },
    /// The priority of a transition.
    Priority {
        /// The transition.
        id: ItemId,
        /// 1 is first.
        #[serde(default)]
        n: Option<u32>,
    },
    /// The steps that a transition joins.
    Ends {
        /// The transition.
        id: ItemId,
        /// Names of the preceding steps; as they are when absent.
        #[serde(default)]
        before: Option<Vec<String>>,
        /// Names of the succeeding steps; as they are when absent.
        #[serde(default)]
        after: Option<Vec<String>>,
    },
    /// Whether a step is active in the initial situation.
    Initial {
        /// The step.
        id: ItemId,
        /// Whether.
        on: bool,
    },
    /// What sort of step.
    Kind {
        /// The step.
        id: ItemId,
        /// The sort.
        kind: Sort,
    },
    /// Moves symbols on the drawing.
    Move {
        /// Steps and transitions.
        ids: Vec<ItemId>,
        /// To the right, in pixels.
        dx: f64,
        /// Downward, in pixels.
        dy: f64,
    },
    /// Brings symbols into line.
    Align {
        /// Steps and transitions.
        ids: Vec<ItemId>,
        /// Which line.
        how: Alignment,
    },
    /// Forgets where symbols were moved to.
    Tidy {
        /// The chart.
        chart: String,
    },
    /// Puts in what [`crate::copy`] gave.
    Paste {
        /// The chart.
        chart: String,
        /// The fragment.
        text: String,
        /// Where its first step stands, in pixels.
        #[serde(default)]
        at: Option<[f64; 2]>,
    },
    /// Takes things away that were copied before.
    Cut {
        /// The things.
        ids: Vec<ItemId>,
    },
    /// A chart more.
    AddChart {
        /// What it is for.
        #[serde(default)]
        kind: ChartSort,
        /// Its name; a fresh one when absent.
        #[serde(default)]
        name: Option<String>,
    },
    /// Takes a chart away, with its layout.
    DeleteChart {
        /// The chart.
        chart: String,
    },
    /// Puts a sequence into the expansion of a new macro-step.
    Macro {
        /// Its steps and transitions.
        ids: Vec<ItemId>,
    },
    /// A row of the table of variables.
    Variable {
        /// The variable that is changed, `Chart.name` for one of a chart; a new one when absent.
        #[serde(default)]
        name: Option<String>,
        /// What it is to be.
        row: Row,
    },
    /// Takes a variable away.
    DeleteVariable {
        /// `Chart.name` for one of a chart.
        name: String,
    },
    /// The profile of the file.
    Profile {
        /// Its name.
        name: String,
    },
    /// A switch of the profile.
    Switch {
        /// Its word, such as `one-pass`.
        name: String,
        /// Whether it is set beside the profile; else the profile says.
        on: bool,
    },
    /// Most passes in a scan.
    Bound {
        /// How many; as the profile says when absent.
        #[serde(default)]
        n: Option<u32>,
    },
    /// The scan time of the file.
    Scan {
        /// Milliseconds.
        ms: f64,
    },
    /// Typed into the text.
    Text {
        /// In bytes of the text before.
        splices: Vec<Splice>,
    },
}

/// What is put into a link; alternation brings the other one along.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
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

/// How branches go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Branching {
    /// One of them.
    Or,
    /// All of them at once.
    And,
}

/// Sorts of step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
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

/// Sorts of chart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChartSort {
    /// A chart of its own.
    #[default]
    Chart,
    /// An expansion.
    #[serde(alias = "macrochart")]
    Expansion,
    /// A task.
    Task,
}

/// Lines to bring symbols into.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Alignment {
    /// Below the one that stands farthest to the left.
    Left,
    /// Beside the highest.
    Top,
    /// Below each other, in the middle.
    Center,
    /// Equal distances to the right.
    DistributeX,
    /// Equal distances downward.
    DistributeY,
}

/// A variable as the table shows it; empty texts for what it has not.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(default)]
pub struct Row {
    /// Its name.
    #[serde(deserialize_with = "text_or_null")]
    pub name: String,
    /// `input`, `output`, `var` or `const`; `var` when empty.
    #[serde(deserialize_with = "text_or_null")]
    pub class: String,
    /// Its type; BOOL when empty.
    #[serde(rename = "type", deserialize_with = "text_or_null")]
    pub ty: String,
    /// Its initial value.
    #[serde(deserialize_with = "text_or_null")]
    pub init: String,
    /// Its address or channel.
    #[serde(deserialize_with = "text_or_null")]
    pub address: String,
    /// The channel carries the complement.
    pub inverted: bool,
    /// Kept over a restart.
    pub retain: bool,
    /// The value of an output after a fault.
    #[serde(deserialize_with = "text_or_null")]
    pub safe: String,
    /// Without quotes.
    #[serde(deserialize_with = "text_or_null")]
    pub comment: String,
    /// The chart it belongs to; the file when absent.
    pub chart: Option<String>,
}

/// The page has `null` for what a variable has not.
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
