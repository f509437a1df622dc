//! Documents, charts, steps and transitions.

use crate::words::Told;
use crate::{
    Action, Arg, Block, Body, Expr, Layout, Limits, Name, Nanos, Param, Place, Plant, Property, Scenario,
    Span, Type, Use, ValueType,
};

/// All of one file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Document {
    /// In the order of the text.
    pub items: Vec<Item>,
    /// Notes to the reader (`//`, `/* */`, `(* *)`) in the order of the text.
    pub notes: Vec<Note>,
}

/// A note to the reader. Only the formatter keeps it.
#[derive(Clone, Debug, Eq)]
pub struct Note {
    /// With its delimiters.
    pub text: Box<str>,
    /// Where it stands.
    pub at: Span,
    /// The first byte of its line, if it is a `//` that stands behind something there.
    pub behind: Option<u32>,
}

impl PartialEq for Note {
    fn eq(&self, other: &Note) -> bool {
        self.text == other.text
    }
}

/// An item at the outermost level of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Item {
    /// `profile …`.
    Profile(Profile),
    /// `scan 10ms`: the nominal scan time.
    Cycle(Nanos, Place),
    /// `target tsx57`.
    Target(TargetPlc, Place),
    /// `use 'lib/axis.g7'`, or `use debounce`.
    Use(Use),
    /// A variable of the file.
    Var(VarDecl),
    /// A chart, an expansion or a task.
    Chart(Chart),
    /// `instance Axis[1..6]`.
    Instance(Instance),
    /// A structure, or a function block of one's own.
    Composed(Composed),
    /// `type Percent : INT(0..100)` or `type Mode : (Manual, Automatic)`: a declaration whose one name is that of the type.
    Type(VarDecl),
    /// `action Pump { … }`.
    Action(NamedAction),
    /// `transition section …`.
    Section(Section),
    /// `function …`.
    Function(Function),
    /// Preliminary processing.
    Pre(Body, Place),
    /// Posterior processing.
    Post(Body, Place),
    /// A model of the process.
    Plant(Plant),
    /// `test "…" { … }`.
    Test(Scenario),
    /// `prove …`.
    Prove(Property),
    /// `layout …`.
    Layout(Layout),
}

/// `profile iec61131 { multi-token }`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Profile {
    /// The set of switches to start from.
    pub name: ProfileName,
    /// Switches set one by one.
    pub switches: Vec<(Switch, Place)>,
    /// Where it stands.
    pub at: Place,
}

/// The five sets of evolution rules.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ProfileName {
    /// IEC 60848, with search for stability.
    #[default]
    Iec60848,
    /// IEC 61131-3 SFC.
    Iec61131,
    /// PL7 (TSX Micro and Premium).
    Pl7,
    /// Unity Pro, Control Expert.
    Unity,
    /// JGrafchart.
    Jgrafchart,
}

impl ProfileName {
    /// All five.
    pub const ALL: [ProfileName; 5] = [
        ProfileName::Iec60848,
        ProfileName::Iec61131,
        ProfileName::Pl7,
        ProfileName::Unity,
        ProfileName::Jgrafchart,
    ];

    /// As written.
    pub fn name(self) -> &'static str {
        match self {
            ProfileName::Iec60848 => "iec60848",
            ProfileName::Iec61131 => "iec61131",
            ProfileName::Pl7 => "pl7",
            ProfileName::Unity => "unity",
            ProfileName::Jgrafchart => "jgrafchart",
        }
    }

    /// Its rules in a few words, in the languages of the table of words.
    pub const fn does(self) -> Told {
        match self {
            ProfileName::Iec60848 => [
                "GRAFCET, with a search for stability",
                "GRAFCET, avec recherche de stabilité",
                "GRAFCET, com procura de estabilidade",
            ],
            ProfileName::Iec61131 => ["SFC of IEC 61131-3", "SFC de la CEI 61131-3", "SFC da IEC 61131-3"],
            ProfileName::Pl7 => {
                ["PL7 on TSX Micro and Premium", "PL7 sur TSX Micro et Premium", "PL7 em TSX Micro e Premium"]
            }
            ProfileName::Unity => {
                ["Unity Pro and Control Expert", "Unity Pro et Control Expert", "Unity Pro e Control Expert"]
            }
            ProfileName::Jgrafchart => ["JGrafchart", "JGrafchart", "JGrafchart"],
        }
    }
}

/// One switch of a profile; `docs/book/src/language/profiles.md` explains each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Switch {
    /// `stable` (true) or `one-pass`.
    Stable(bool),
    /// `multi-token` (true) or `single-token`.
    MultiToken(bool),
    /// `sequential` (true, one transition after the other) or `simultaneous`.
    Sequential(bool),
    /// `parallel-actions` (true, stored actions read the values from before
    /// the pass) or `ordered-actions`.
    ParallelActions(bool),
    /// `final-scan` (true) or `no-final-scan`.
    FinalScan(bool),
    /// `keep-step-time` (true) or `zero-step-time`.
    KeepStepTime(bool),
    /// `scan-clock` (true, step times count scans) or `time-clock`.
    ScanClock(bool),
    /// `pulse-first` (true, P1 first and P0 last) or `text-order`.
    PulseFirst(bool),
    /// `bound n`: most passes in a scan.
    Bound(u32),
}

/// PLCs whose limits can be checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TargetPlc {
    /// TSX 37-10.
    Tsx3710,
    /// TSX 37-20.
    Tsx3720,
    /// TSX 57.
    Tsx57,
}

impl TargetPlc {
    /// All of them.
    pub const ALL: [TargetPlc; 3] = [TargetPlc::Tsx3710, TargetPlc::Tsx3720, TargetPlc::Tsx57];

    /// As written.
    pub fn name(self) -> &'static str {
        match self {
            TargetPlc::Tsx3710 => "tsx3710",
            TargetPlc::Tsx3720 => "tsx3720",
            TargetPlc::Tsx57 => "tsx57",
        }
    }
}

/// The role of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VarKind {
    /// Read from the plant.
    Input,
    /// Written to the plant.
    Output,
    /// Internal.
    Var,
    /// Never changes.
    Const,
}

/// `ARRAY[1..6, 0..3] OF` (IEC 61131-3:2003, 2.3.3.1).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Array {
    /// The least and the greatest index of each dimension.
    pub dimensions: Vec<(Expr, Expr)>,
    /// Where it stands.
    pub at: Place,
}

impl Array {
    /// The bounds, in the order of the text.
    pub fn bounds(&self) -> impl Iterator<Item = &Expr> {
        self.dimensions.iter().flat_map(|(from, to)| [from, to])
    }
}

/// A declaration of variables.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VarDecl {
    /// Their role.
    pub kind: VarKind,
    /// The names declared together, at least one.
    pub names: Vec<Name>,
    /// The bounds, of arrays.
    pub array: Option<Box<Array>>,
    /// Their type; of arrays, that of the elements. BOOL where `of` names the type.
    pub ty: Type,
    /// The name of a type that the file declares, see [`Composed`] and [`Item::Type`].
    pub of: Option<Box<Name>>,
    /// The structure of which this is a member: `Motor` for `m.speed`. Only [`crate::composed::with_blocks`] makes it.
    pub part_of: Option<Box<Name>>,
    /// The values that they can have, if these are not all values of `ty`.
    pub limits: Option<Box<Limits>>,
    /// The value of elements that `init` leaves out, if a declared type gives one; otherwise it is the type's zero. The
    /// pass [`crate::named`] makes it; the parser never does.
    pub usual: Option<Box<Expr>>,
    /// Initial value; the type's zero when absent. Of arrays, a [`crate::ExprKind::List`].
    pub init: Option<Expr>,
    /// Address (`%I0.0`, with its `%`) or channel, as written.
    pub address: Option<Name>,
    /// The channel carries the complement.
    pub inverted: bool,
    /// Kept over a restart.
    pub retain: bool,
    /// Value of an output after a fault; the type's zero when absent.
    pub safe: Option<Expr>,
    /// `"…"`.
    pub comment: Option<Box<str>>,
    /// Where it stands.
    pub at: Place,
}

impl VarDecl {
    /// Variables with names and a type alone.
    pub fn new(kind: VarKind, names: Vec<Name>, ty: Type, at: Place) -> VarDecl {
        VarDecl {
            kind,
            names,
            array: None,
            ty,
            of: None,
            part_of: None,
            limits: None,
            usual: None,
            init: None,
            address: None,
            inverted: false,
            retain: false,
            safe: None,
            comment: None,
            at,
        }
    }
}

/// The role of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ChartKind {
    /// A partial chart that evolves by itself.
    Chart,
    /// The expansion of a macro-step.
    Expansion,
    /// A task, called from steps.
    Task,
}

/// A chart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chart {
    /// Its role.
    pub kind: ChartKind,
    /// Its name.
    pub name: Name,
    /// Its parameters. A chart with parameters runs only as its instances, see [`Instance`].
    pub params: Vec<Param>,
    /// `of Gripper`: the function block whose instances have such a chart each.
    pub block: Option<Name>,
    /// `"…"`.
    pub comment: Option<Box<str>>,
    /// `every 20ms`: the period of its evolutions.
    pub every: Option<Nanos>,
    /// In the order of the text.
    pub items: Vec<ChartItem>,
    /// Where it stands.
    pub at: Place,
}

/// Charts that run: those of a chart with parameters, each with values of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instance {
    /// The chart with parameters.
    pub chart: Name,
    /// How the instances are named.
    pub names: InstanceNames,
    /// The values of the parameters, by name or in their order; without the first one in a range.
    pub args: Vec<Arg>,
    /// `"…"`.
    pub comment: Option<Box<str>>,
    /// Where it stands.
    pub at: Place,
}

/// The names of instances.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum InstanceNames {
    /// `instance Lift : Axis(7)`: one, with a name of its own.
    One(Name),
    /// `instance Axis[1..6]`: `Axis[1]` to `Axis[6]`; the number is the value of the first parameter.
    Range(Box<Expr>, Box<Expr>),
}

/// An item of a chart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ChartItem {
    /// A variable of the chart.
    Var(VarDecl),
    /// A step.
    Step(Step),
    /// A transition.
    Transition(Transition),
    /// Preliminary processing of this chart.
    Pre(Body, Place),
    /// Posterior processing of this chart.
    Post(Body, Place),
    /// A named action of this chart.
    Action(NamedAction),
    /// A transition section of this chart.
    Section(Section),
}

/// The kind of a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StepKind {
    /// A plain step.
    Plain,
    /// The first step of an expansion or task.
    Entry,
    /// The last step of an expansion or task.
    Exit,
    /// A macro-step, with the name of its expansion.
    Macro(Name),
    /// An enclosing step; its `enclose` orders name the enclosed charts.
    Enclosing,
}

/// A step or macro-step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// Its name or number.
    pub name: Name,
    /// Its kind.
    pub kind: StepKind,
    /// Active in the initial situation.
    pub initial: bool,
    /// Carries the activation link `*`.
    pub linked: bool,
    /// `"…"`.
    pub comment: Option<Box<str>>,
    /// Its actions, in the order of the text.
    pub actions: Vec<Action>,
    /// True if braces were written: an empty action block is kept.
    pub braces: bool,
    /// Where it stands.
    pub at: Place,
}

/// A transition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Transition {
    /// `t7:`.
    pub label: Option<Name>,
    /// The preceding steps; empty for a source transition.
    pub from: Vec<Name>,
    /// The succeeding steps; empty for a sink transition.
    pub to: Vec<Name>,
    /// The receptivity.
    pub receptivity: Expr,
    /// `priority n`, 1 first.
    pub priority: Option<u32>,
    /// `"…"`.
    pub comment: Option<Box<str>>,
    /// Stored action on clearing.
    pub on_clearing: Option<Block>,
    /// Follows the transition before it in one chain (`1 -> 2 when a -> 3 when b`);
    /// then `from` repeats that transition's `to`. Kept for the printer.
    pub chained: bool,
    /// Where it stands.
    pub at: Place,
}

/// `action Pump { … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedAction {
    /// Its name.
    pub name: Name,
    /// `"…"`.
    pub comment: Option<Box<str>>,
    /// Its statements.
    pub body: Body,
    /// Where it stands.
    pub at: Place,
}

/// `transition section Ready { … }` (Unity Pro).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Section {
    /// Its name, which is also that of its one BOOL output.
    pub name: Name,
    /// Statements that assign the output; `:= e` is kept as one assignment.
    pub body: Block,
    /// Written as `:= e`.
    pub short: bool,
    /// Where it stands.
    pub at: Place,
}

/// `function Full(level : REAL) : BOOL { … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// Its name, which is also that of its result.
    pub name: Name,
    /// Its inputs.
    pub params: Vec<Param>,
    /// The type of its result.
    pub result: ValueType,
    /// Its statements.
    pub body: Block,
    /// Where it stands.
    pub at: Place,
}

/// `struct Motor { … }` (IEC 61131-3:2003, 2.3.3.1), or `function block Debounce { … }` (2.5.2).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Composed {
    /// Its name.
    pub name: Name,
    /// `"…"`.
    pub comment: Option<Box<str>>,
    /// The variables that each variable of this type has. Those of a structure are [`VarKind::Var`]; of a function
    /// block, inputs and outputs are parameters of its calls.
    pub members: Vec<VarDecl>,
    /// The parameters that stand for a variable of the caller; of a function block alone.
    pub inouts: Vec<VarDecl>,
    /// True for a function block.
    pub block: bool,
    /// The statements of a call; None for a structure, and for a function block that has charts alone.
    pub body: Option<Body>,
    /// Where it stands.
    pub at: Place,
}

impl Document {
    /// The charts, expansions and tasks, in the order of the text.
    pub fn charts(&self) -> impl Iterator<Item = &Chart> {
        self.items.iter().filter_map(|i| if let Item::Chart(c) = i { Some(c) } else { None })
    }

    /// The nominal scan time, the first if there are several.
    pub fn cycle(&self) -> Option<Nanos> {
        self.items.iter().find_map(|i| if let Item::Cycle(time, _) = i { Some(*time) } else { None })
    }

    /// The properties to be proved, in the order of the text.
    pub fn properties(&self) -> impl Iterator<Item = &Property> {
        self.items.iter().filter_map(|i| if let Item::Prove(p) = i { Some(p) } else { None })
    }

    /// The lines that take in other files, in the order of the text.
    pub fn uses(&self) -> impl Iterator<Item = &Use> {
        self.items.iter().filter_map(|i| if let Item::Use(u) = i { Some(u) } else { None })
    }

    /// The profile, the first if there are several, else the default.
    pub fn profile(&self) -> Option<&Profile> {
        self.items.iter().find_map(|i| if let Item::Profile(p) = i { Some(p) } else { None })
    }
}

impl Item {
    /// Its place in the text.
    pub fn at(&self) -> Span {
        match self {
            Item::Profile(p) => p.at.0,
            Item::Cycle(_, at) | Item::Target(_, at) | Item::Pre(_, at) | Item::Post(_, at) => at.0,
            Item::Use(u) => u.at.0,
            Item::Var(v) => v.at.0,
            Item::Chart(c) => c.at.0,
            Item::Instance(i) => i.at.0,
            Item::Composed(c) => c.at.0,
            Item::Type(t) => t.at.0,
            Item::Action(a) => a.at.0,
            Item::Section(s) => s.at.0,
            Item::Function(f) => f.at.0,
            Item::Plant(p) => p.at.0,
            Item::Test(t) => t.at.0,
            Item::Prove(p) => p.at.0,
            Item::Layout(l) => l.at.0,
        }
    }
}

impl ChartItem {
    /// Its place in the text.
    pub fn at(&self) -> Span {
        match self {
            ChartItem::Var(v) => v.at.0,
            ChartItem::Step(s) => s.at.0,
            ChartItem::Transition(t) => t.at.0,
            ChartItem::Pre(_, at) | ChartItem::Post(_, at) => at.0,
            ChartItem::Action(a) => a.at.0,
            ChartItem::Section(s) => s.at.0,
        }
    }
}

impl Chart {
    /// Its steps, in the order of the text.
    pub fn steps(&self) -> impl Iterator<Item = &Step> {
        self.items.iter().filter_map(|i| if let ChartItem::Step(s) = i { Some(s) } else { None })
    }

    /// Its transitions, in the order of the text.
    pub fn transitions(&self) -> impl Iterator<Item = &Transition> {
        self.items.iter().filter_map(|i| if let ChartItem::Transition(t) = i { Some(t) } else { None })
    }

    /// Its variables, in the order of the text.
    pub fn vars(&self) -> impl Iterator<Item = &VarDecl> {
        self.items.iter().filter_map(|i| if let ChartItem::Var(v) = i { Some(v) } else { None })
    }
}
