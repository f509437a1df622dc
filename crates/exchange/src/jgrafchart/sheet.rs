//! A workspace of the file, in the file's own names and with its own links.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

use g7_model::{Type, VarKind};

use crate::xml::attr::Text;

/// All workspaces of a file; a nested one stands behind the one that holds it.
#[derive(Default)]
pub(super) struct Plan {
    pub(super) sheets: Vec<Sheet>,
    /// The file's first element.
    pub(super) at: Range<usize>,
}

/// What a workspace belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SheetKind {
    /// A chart of its own.
    Top,
    /// The inside of a macro-step.
    Macro,
    /// The inside of a workspace object: a name space whose steps run by themselves.
    Object,
}

/// One workspace.
pub(super) struct Sheet {
    pub(super) kind: SheetKind,
    /// Its name, or that of the object that holds it; may be empty.
    pub(super) name: Text,
    /// The workspace around it, where its texts look names up: that which holds it,
    /// for a procedure that in which the procedure stands.
    pub(super) parent: Option<usize>,
    /// The step that it is the inside of: its workspace and number.
    pub(super) owner: Option<(usize, usize)>,
    /// What is brought along where a procedure is called.
    pub(super) call: Option<Call>,
    /// Time between two scans, in milliseconds, of a top workspace.
    pub(super) speed: Option<i64>,
    /// Scans of the workspace around it between two of its own; of a workspace object.
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
    /// Named objects that are not carried over: name to element.
    pub(super) strangers: HashMap<String, String>,
    /// Parameters by reference: what a name stands for, and in which workspace.
    pub(super) refs: HashMap<String, (usize, Vec<String>)>,
    /// What an identifier stands for.
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

/// What a link can start or end at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Node {
    Step(usize),
    /// A way out of a macro-step with several: the step and the number of the way, from 1.
    Way(usize, usize),
    Transition(usize),
    /// A parallel split, by its number among the bars.
    Split(usize),
    /// A parallel join, by its number among the bars.
    Join(usize),
    /// The connection post that lines lead into, by its number among the posts.
    PostIn(usize),
    /// The connection post that lines lead out of.
    PostOut(usize),
    /// Something that is not carried over; it has been reported.
    Stranger,
}

/// What sort of step.
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
    /// Its texts; several where steps are fused.
    pub(super) actions: Vec<Text>,
    /// The step that it is one with.
    pub(super) fused: Option<usize>,
    pub(super) at: Range<usize>,
    pub(super) x: i32,
    pub(super) y: i32,
}

/// A transition.
pub(super) struct TransitionNode {
    /// It leaves its macro-step at any of its steps.
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

/// Steps that are one step.
pub(super) struct Fusion {
    pub(super) members: Vec<Text>,
    pub(super) abortive: bool,
    pub(super) at: Range<usize>,
}

/// The call of a procedure, kept with the workspace that it brings about.
pub(super) struct Call {
    pub(super) parameters: Text,
    /// Parameters by value: the variable of the procedure, and where in the text its value stands.
    pub(super) values: Vec<(usize, super::phrase::Phrase)>,
}

/// A connection post.
pub(super) struct Post {
    pub(super) name: String,
    /// The name of the post at the other end, from the top workspace on.
    pub(super) remote: String,
    /// Lines lead into it.
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
    /// It follows this expression, worked out at the beginning of each scan.
    pub(super) follows: Option<Text>,
    pub(super) at: Range<usize>,
}

/// A value as the file gives it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Bool(bool),
    Int(i32),
    Real(f64),
    Str(String),
}
