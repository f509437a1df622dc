//! A workspace of the file, with the file's own names and links.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

use g7_model::{Type, VarKind};

use g7_iec::xml::attr::Text;

/// All workspaces of a file; a nested one comes after the one that contains it.
#[derive(Default)]
pub(super) struct Plan {
    pub(super) sheets: Vec<Sheet>,
    /// The first element of the file.
    pub(super) at: Range<usize>,
}

/// The kind of a workspace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SheetKind {
    /// A chart of its own.
    Top,
    /// The content of a macro-step.
    Macro,
    /// The content of a workspace object: a name space whose steps run on their own.
    Object,
}

/// One workspace.
pub(super) struct Sheet {
    pub(super) kind: SheetKind,
    /// Its name, or that of the object that contains it; may be empty.
    pub(super) name: Text,
    /// The workspace around it, in which its texts look up names: the one that contains it, or for
    /// a procedure the one where the procedure is declared.
    pub(super) parent: Option<usize>,
    /// The step that it belongs to: workspace and number.
    pub(super) owner: Option<(usize, usize)>,
    /// The parameters, if it is the copy of a called procedure.
    pub(super) call: Option<Call>,
    /// The time between two scans of a top workspace, in milliseconds.
    pub(super) speed: Option<i64>,
    /// For a workspace object: one scan of it for so many scans of the workspace around it.
    pub(super) cycle: i64,
    pub(super) at: Range<usize>,
    pub(super) vars: Vec<Var>,
    pub(super) steps: Vec<StepNode>,
    pub(super) transitions: Vec<TransitionNode>,
    pub(super) posts: Vec<Post>,
    /// Number of parallel splits and joins.
    pub(super) bars: usize,
    pub(super) links: Vec<Link>,
    pub(super) texts: Vec<FreeText>,
    pub(super) fusions: Vec<Fusion>,
    /// Workspace objects: name, index of their workspace.
    pub(super) objects: Vec<(String, usize)>,
    /// Named objects that are not carried over, with the name of the element.
    pub(super) strangers: HashMap<String, String>,
    /// Parameters by reference: the meaning of a name, with the workspace where it is looked up.
    pub(super) refs: HashMap<String, (usize, Vec<String>)>,
    /// The object of each identifier.
    pub(super) ids: BTreeMap<String, Node>,
}

impl Sheet {
    pub(super) fn new(kind: SheetKind, name: Text, parent: Option<usize>, at: Range<usize>) -> Sheet {
        Sheet {
            kind,
            name,
            parent,
            owner: None,
            call: None,
            speed: None,
            cycle: 1,
            at,
            vars: Vec::new(),
            steps: Vec::new(),
            transitions: Vec::new(),
            posts: Vec::new(),
            bars: 0,
            links: Vec::new(),
            texts: Vec::new(),
            fusions: Vec::new(),
            objects: Vec::new(),
            strangers: HashMap::new(),
            refs: HashMap::new(),
            ids: BTreeMap::new(),
        }
    }
}

/// An object at an end of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Node {
    Step(usize),
    /// An exit of a macro-step with several: the step and the number of the exit, from 1.
    Way(usize, usize),
    Transition(usize),
    /// A parallel split, by its number among the bars.
    Split(usize),
    /// A parallel join, by its number among the bars.
    Join(usize),
    /// The connection post that lines lead into, by its number among the posts.
    PostIn(usize),
    /// The connection post that lines lead out of, by its number among the posts.
    PostOut(usize),
    /// An object that is not carried over; it has been reported.
    Stranger,
}

/// The kind of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StepSort {
    Plain,
    Initial,
    Enter,
    Exit,
    /// A macro-step or the call of a procedure, with its workspace.
    Macro(Option<usize>),
}

/// A step, macro-step, enter step or exit step.
pub(super) struct StepNode {
    pub(super) sort: StepSort,
    pub(super) name: Text,
    /// Its texts; several if steps are fused.
    pub(super) actions: Vec<Text>,
    /// The step with which it is fused.
    pub(super) fused: Option<usize>,
    pub(super) at: Range<usize>,
    pub(super) x: i32,
    pub(super) y: i32,
}

/// A transition.
pub(super) struct TransitionNode {
    /// True for an exception transition, which leaves its macro-step at any of its steps.
    pub(super) exception: bool,
    pub(super) condition: Text,
    pub(super) priority: Option<u32>,
    pub(super) at: Range<usize>,
    pub(super) x: i32,
    pub(super) y: i32,
}

/// A text on the drawing.
pub(super) struct FreeText {
    pub(super) text: Text,
    pub(super) x: i32,
    pub(super) y: i32,
}

/// A set of fused steps.
pub(super) struct Fusion {
    pub(super) members: Vec<Text>,
    pub(super) abortive: bool,
    pub(super) at: Range<usize>,
}

/// The call of a procedure, stored with the workspace that is its copy.
pub(super) struct Call {
    pub(super) parameters: Text,
    /// Parameters by value: the number of the variable, and the expression of its value.
    pub(super) values: Vec<(usize, super::phrase::Phrase)>,
}

/// A connection post.
pub(super) struct Post {
    pub(super) name: String,
    /// The name of the post at the other end, starting at the top workspace.
    pub(super) remote: String,
    /// True if lines lead into it.
    pub(super) inward: bool,
    pub(super) at: Range<usize>,
}

/// A line.
pub(super) struct Link {
    pub(super) from: Text,
    pub(super) to: Text,
    pub(super) at: Range<usize>,
}

/// A variable, input or output.
pub(super) struct Var {
    pub(super) name: Text,
    pub(super) kind: VarKind,
    pub(super) ty: Type,
    pub(super) init: Option<Value>,
    pub(super) channel: Option<Text>,
    pub(super) inverted: bool,
    pub(super) retain: bool,
    /// The expression that it follows; it is computed at the beginning of each scan.
    pub(super) follows: Option<Text>,
    pub(super) at: Range<usize>,
}

/// A value, as the file gives it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Bool(bool),
    Int(i32),
    Real(f64),
    Str(String),
}

/// The place of a name, or of the element if it has none.
pub(super) fn name_place(name: &Text, at: &Range<usize>) -> Range<usize> {
    if name.text.is_empty() { at.clone() } else { name.at.clone() }
}
