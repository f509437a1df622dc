//! Models of the process: they compute inputs from outputs.

use crate::{Block, Expr, Name, Param, Place, Type};

/// `plant Name { … }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plant {
    /// Its name.
    pub name: Name,
    /// `"…"`.
    pub comment: Option<Box<str>>,
    /// In the order of the text.
    pub items: Vec<PlantItem>,
    /// Where it stands.
    pub at: Place,
}

impl Plant {
    /// The picture, if there is one.
    pub fn view(&self) -> Option<&View> {
        self.items.iter().find_map(|item| if let PlantItem::View(view) = item { Some(view) } else { None })
    }
}

/// An item of a plant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PlantItem {
    /// A constant of the plant.
    Const {
        /// The names declared together.
        names: Vec<Name>,
        /// Their type.
        ty: Type,
        /// The value.
        value: Expr,
        /// `"…"`.
        comment: Option<Box<str>>,
        /// Where it stands.
        at: Place,
    },
    /// A state of the process.
    State(StateVar),
    /// How a state moves.
    Rate(Rate),
    /// The value of an input of the charts.
    Drive(Drive),
    /// Done once each time the condition becomes true.
    On(Expr, Block, Place),
    /// Done every tick.
    Each(Block, Place),
    /// A queue or track of parts.
    Parts(Parts),
    /// Parts that arrive by themselves.
    Arrivals(Arrivals),
    /// A picture.
    View(View),
}

/// `state level : REAL := 0.0 in 0.0 .. 100.0`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateVar {
    /// The names declared together.
    pub names: Vec<Name>,
    /// Their type.
    pub ty: Type,
    /// Initial value.
    pub init: Option<Expr>,
    /// Limits: the value is held within them.
    pub limits: Option<(Expr, Expr)>,
    /// `"…"`.
    pub comment: Option<Box<str>>,
    /// Where it stands.
    pub at: Place,
}

/// `rate level := 8.0 when V1`: units per second; rates of one state add up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rate {
    /// The state, or a track, whose parts then all move.
    pub state: Name,
    /// Units per second.
    pub value: Expr,
    /// Only while this holds.
    pub when: Option<Expr>,
    /// Where it stands.
    pub at: Place,
}

/// `drive b1 := level > 2.0`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drive {
    /// An input of the charts, or an element of an array of inputs.
    pub input: Expr,
    /// The value that it reads.
    pub value: Expr,
    /// Where it stands.
    pub at: Place,
}

/// `parts Path(colour : INT) max 20 length 3.0 := (1), (0)`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parts {
    /// Its name.
    pub name: Name,
    /// The attributes of each part.
    pub attributes: Vec<Param>,
    /// Most parts at once.
    pub max: u32,
    /// With a length it is a track: each part has a position from 0.
    pub length: Option<Expr>,
    /// The parts at the start, first out first.
    pub init: Vec<Vec<Expr>>,
    /// Where it stands.
    pub at: Place,
}

/// `arrivals Bottles every 1s .. 3s when motor { … }`: random, under the seed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arrivals {
    /// Its name.
    pub name: Name,
    /// Shortest (or only) time between two arrivals.
    pub least: Expr,
    /// Longest time between two; evenly spread from `least`.
    pub most: Option<Expr>,
    /// Its waiting time stops while this is false.
    pub when: Option<Expr>,
    /// The statements that run at an arrival.
    pub body: Block,
    /// Where it stands.
    pub at: Place,
}

/// `view 'tank.svg' { water.height := level }`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct View {
    /// The SVG file, relative to the chart's.
    pub file: Box<str>,
    /// The attributes that move.
    pub bindings: Vec<Binding>,
    /// Where it stands.
    pub at: Place,
}

/// `water.height := level`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binding {
    /// The element, by its `data-g7` name.
    pub element: Name,
    /// The attribute.
    pub attribute: Name,
    /// Its value.
    pub value: Expr,
}
