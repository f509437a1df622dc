//! A drawing as its difference from the one that the page has.
//!
//! A gesture changes a few symbols of a chart, but the drawing of 1000 steps has 1.5 MB of JSON, and symbols
//! behind the change move. So the page names the drawing that it has, by its number; of symbols that look the same,
//! only how far they have moved is sent.

use std::collections::HashMap;

use serde::Serialize;

use crate::drawing::{Drawn, Item, Spot, Wish};

/// Greatest number of drawings that are kept; each is as large as its JSON.
const MOST: usize = 8;

/// The drawings that the page has, the latest last.
#[derive(Default)]
pub(crate) struct Shown {
    list: Vec<(String, u64, Drawn)>,
    /// The drawing that was answered last, which its answer borrows; with its key if it is to be kept.
    last: Option<(Option<String>, Drawn)>,
    number: u64,
}

/// An answer: a whole drawing, or its difference from another.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
pub(crate) struct Redrawn<'a> {
    #[serde(flatten)]
    drawn: &'a Drawn,
    /// The number of this drawing; none if it is not kept.
    #[serde(skip_serializing_if = "Option::is_none")]
    number: Option<u64>,
    /// The number of the drawing to which `items` refer.
    #[serde(skip_serializing_if = "Option::is_none")]
    since: Option<u64>,
    items: Vec<Sent<'a>>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(untagged)]
enum Sent<'a> {
    Kept(Kept<'a>),
    Alike(Alike<'a>),
    New(Whole<'a>),
}

/// A run of symbols that look the same and stand in the same order in the other drawing.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
struct Kept<'a> {
    /// The number of the first of them in the other drawing.
    r#as: usize,
    count: usize,
    /// How far they have moved.
    by: Spot,
    /// By how many code units their places in the text have moved.
    along: isize,
    /// Their ids, if they have changed: an id contains the number of its transition.
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ids: Vec<&'a str>,
    /// With `ids`: the ends of the links among them.
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ends: Vec<&'a [String; 2]>,
}

/// A symbol that looks like one of the other drawing.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
struct Alike<'a> {
    /// The number of the symbol in the other drawing.
    r#as: usize,
    /// The distance from the old symbol to this one, to the right and down.
    by: Spot,
    #[serde(flatten)]
    item: &'a Item,
}

/// A symbol with its drawing.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Item"))]
struct Whole<'a> {
    /// The SVG of the symbol.
    svg: String,
    /// Path data for zoomed-out views.
    far: String,
    #[serde(flatten)]
    item: &'a Item,
}

impl Shown {
    /// Puts the drawing that was answered last into the list, if it is to be kept.
    fn settle(&mut self) {
        if let Some((Some(key), drawn)) = self.last.take() {
            self.list.push((key, self.number, drawn));
            if self.list.len() > MOST {
                self.list.remove(0);
            }
        }
    }

    /// Forgets the drawings of a file.
    pub(crate) fn forget(&mut self, file: &str) {
        self.settle();
        self.list.retain(|(key, ..)| key.split('\n').next() != Some(file));
    }

    /// Answers with a drawing, as its difference from the one that the page has, if that is known, and
    /// keeps it if the page asks so.
    #[inline(never)]
    pub(crate) fn answer(&mut self, wish: &Wish, drawn: Drawn) -> Redrawn<'_> {
        self.settle();
        let Some(since) = wish.since else {
            let (_, drawn) = self.last.insert((None, drawn));
            return Redrawn::new(drawn, None, None);
        };
        let key = wish.key();
        let place = self.list.iter().position(|(k, ..)| *k == key);
        let known = place.map(|p| self.list.remove(p)).filter(|(_, number, _)| *number == since);
        self.number += 1;
        let old = known.as_ref().map(|(_, number, drawn)| (*number, drawn.items.as_slice()));
        let (_, drawn) = self.last.insert((Some(key), drawn));
        Redrawn::new(drawn, Some(self.number), old)
    }
}

impl<'a> Redrawn<'a> {
    #[inline(never)]
    fn new(drawn: &'a Drawn, number: Option<u64>, old: Option<(u64, &[Item])>) -> Redrawn<'a> {
        let (since, old) = match old {
            Some((since, items)) => (Some(since), items),
            None => (None, &[][..]),
        };
        let mut seeker = Seeker { old, next: 0, by_id: None };
        let mut items = Vec::new();
        for item in &drawn.items {
            let Some((k, by, was)) = seeker.find(item) else {
                items.push(seeker.alike(item).unwrap_or_else(|| Sent::New(Whole::new(item))));
                continue;
            };
            let before = if let Some(Sent::Kept(kept)) = items.last_mut() { Some(kept) } else { None };
            if !before.is_some_and(|kept| kept.add(k, by, was, item)) {
                items.push(Kept::of_one(k, by, was, item));
            }
        }
        Redrawn { drawn, number, since, items }
    }
}

impl<'a> Kept<'a> {
    /// The first of some symbols; one whose places in the text have not moved as a whole is sent as alike.
    fn of_one(k: usize, by: Spot, was: &Item, item: &'a Item) -> Sent<'a> {
        let Some(along) = along(was, item) else { return Sent::Alike(Alike { r#as: k, by, item }) };
        let mut kept = Kept { r#as: k, count: 1, by, along, ids: Vec::new(), ends: Vec::new() };
        if is_renumbered(was, item) {
            kept.rename(item);
        }
        Sent::Kept(kept)
    }

    /// Adds a symbol, if it follows the others in the other drawing and has moved with them.
    #[inline(never)]
    fn add(&mut self, k: usize, by: Spot, was: &Item, item: &'a Item) -> bool {
        let renumbered = is_renumbered(was, item);
        let follows = self.r#as + self.count == k && self.by == by && along(was, item) == Some(self.along);
        if !follows || renumbered == self.ids.is_empty() {
            return false;
        }
        self.count += 1;
        if renumbered {
            self.rename(item);
        }
        true
    }

    fn rename(&mut self, item: &'a Item) {
        self.ids.push(&item.id);
        self.ends.extend(&item.ends);
    }
}

impl<'a> Whole<'a> {
    fn new(item: &'a Item) -> Whole<'a> {
        Whole { svg: item.picture.svg(), far: item.picture.far(), item }
    }
}

fn is_renumbered(was: &Item, item: &Item) -> bool {
    (&was.id, &was.ends) != (&item.id, &item.ends)
}

/// By how many code units the places of a symbol in the text have moved; `None` if its length is another.
fn along(was: &Item, item: &Item) -> Option<isize> {
    let moved = |new: usize, old: usize| new as isize - old as isize;
    Some(moved(item.from, was.from)).filter(|along| *along == moved(item.to, was.to))
}

/// Seeks the symbols of a drawing in the one before, where most have the same neighbours.
struct Seeker<'a> {
    old: &'a [Item],
    /// The number of the symbol behind the one that was found last.
    next: usize,
    by_id: Option<HashMap<&'a str, usize>>,
}

/// Number of symbols that are looked at behind the one that was found last: a gesture takes out a few.
const AHEAD: usize = 8;

impl<'a> Seeker<'a> {
    /// The same symbol: its number, how far the given one is moved from it, and itself.
    fn find(&mut self, item: &Item) -> Option<(usize, Spot, &'a Item)> {
        let old = self.old;
        let same = |k: usize| {
            let was = old.get(k)?;
            Some((k, Spot(item.moved_from(was)?), was))
        };
        let ahead = old.len().min(self.next + AHEAD);
        let found = (self.next..ahead).find_map(same).or_else(|| same(self.named(&item.id)?))?;
        self.next = found.0 + 1;
        Some(found)
    }

    /// The symbol as the one with the same id, if that one looks the same.
    fn alike<'b>(&mut self, item: &'b Item) -> Option<Sent<'b>> {
        let k = self.named(&item.id)?;
        let by = Spot(item.picture.moved_from(&self.old.get(k)?.picture)?);
        Some(Sent::Alike(Alike { r#as: k, by, item }))
    }

    /// The number of the symbol with an id.
    fn named(&mut self, id: &str) -> Option<usize> {
        let old = self.old;
        let by_id = || old.iter().enumerate().map(|(k, item)| (&*item.id, k)).collect();
        self.by_id.get_or_insert_with(by_id).get(id).copied()
    }
}
