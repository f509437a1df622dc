//! Queues and tracks of the plant, shown as one line each: the number of parts and the attributes
//! of each part, from the first to the last.

use g7_compile::symbols::Symbols;
use g7_engine::{Addr, State};
use g7_host::{Kind, Value, read_text};

use super::build::kind;
use super::{Bench, Role};

/// A queue or track.
#[derive(Clone, Debug)]
pub struct Table {
    /// Its name.
    pub name: String,
    /// The position of its number of parts in [`Bench::items`].
    pub count: usize,
    /// The positions of its other items there.
    pub rest: Vec<usize>,
    counted: Addr,
    lost: Option<Addr>,
    /// For each place its cells; the part that came first has place 0.
    places: Vec<Vec<Cell>>,
}

#[derive(Clone, Copy, Debug)]
struct Cell {
    addr: Addr,
    kind: Kind,
    /// True for the cell that holds the position of a part on a track.
    position: bool,
}

impl Table {
    /// The queues and tracks of the plant, in the order of declaration.
    pub fn all(bench: &Bench) -> Vec<Table> {
        let Some(plant) = &bench.plant else { return Vec::new() };
        let states = || bench.items.iter().enumerate().filter(|(_, i)| i.role == Role::Plant);
        let of = |count: usize, name: &str| {
            let inner = format!("{name}.");
            let mine = states().filter(|(at, i)| *at != count && i.name.starts_with(&inner));
            let lost = states().find(|(_, i)| i.name.strip_prefix(&inner) == Some("lost"));
            Table {
                name: name.to_owned(),
                count,
                rest: mine.map(|(at, _)| at).collect(),
                counted: Addr(bench.items.get(count).map_or(0, |i| i.addr)),
                lost: lost.map(|(_, i)| Addr(i.addr)),
                places: places(&plant.compiled.symbols, &inner),
            }
        };
        states().filter_map(|(at, i)| Some(of(at, i.name.strip_suffix(".count")?))).collect()
    }

    /// Shows a queue as `One  3: 0 0 1`, a track with positions as `Belt  2: 1@0.35 0@0.1`.
    pub fn show(&self, state: &State) -> String {
        let count = state.word(self.counted);
        let mut text = format!("{}  {count}", self.name);
        let there = self.places.iter().take(usize::try_from(count).unwrap_or(0));
        for (i, cells) in there.enumerate() {
            text.push_str(if i == 0 { ": " } else { " " });
            text.push_str(&part(cells, state));
        }
        match self.lost.map_or(0, |at| state.word(at)) {
            0 => text,
            lost => format!("{text} ({lost} lost)"),
        }
    }
}

/// The cells of a table, by place; the variables are named `T.column.place`.
fn places(symbols: &Symbols, inner: &str) -> Vec<Vec<Cell>> {
    let mut places: Vec<Vec<Cell>> = Vec::new();
    for v in &symbols.variables {
        let cell = v.name.strip_prefix(inner).and_then(|rest| rest.rsplit_once('.'));
        let Some((column, place)) = cell.and_then(|(c, p)| Some((c, p.parse::<usize>().ok()?))) else {
            continue;
        };
        let Some(kind) = kind(v.ty) else { continue };
        // The variables are declared place by place.
        if place == places.len() {
            places.push(Vec::new());
        }
        if let Some(cells) = places.get_mut(place) {
            cells.push(Cell { addr: v.addr, kind, position: column == "position" });
        }
    }
    places
}

/// The attributes of a part, followed by `@` and its position on a track.
fn part(cells: &[Cell], state: &State) -> String {
    let value = |c: &Cell| match c.kind {
        Kind::Text => Value::Text(read_text(state.words(), c.addr.0).into()),
        Kind::Bool | Kind::Int { .. } | Kind::Real | Kind::Lreal | Kind::Time | Kind::Moment(_) => {
            Value::Word(state.word(c.addr))
        }
    };
    let show = |c: &Cell| match c.kind {
        Kind::Bool => value(c).word().to_string(),
        Kind::Real | Kind::Lreal => {
            let text = format!("{:.2}", value(c).number(c.kind));
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        Kind::Int { .. } | Kind::Time | Kind::Moment(_) | Kind::Text => value(c).show(c.kind),
    };
    let attributes: Vec<String> = cells.iter().filter(|c| !c.position).map(show).collect();
    let position = cells.iter().find(|c| c.position).map(show);
    match (attributes.join("/"), position) {
        (own, None) if own.is_empty() => "·".to_owned(),
        (own, None) => own,
        (own, Some(position)) if own.is_empty() => position,
        (own, Some(position)) => format!("{own}@{position}"),
    }
}
