//! A drawing as its difference from the one that the page has.
//!
//! A gesture changes a few symbols of a chart, but the drawing of 1000 steps has 1.5 MB of JSON. So the page names the
//! drawing that it has, by its number; symbols that are the same, or that look the same, are not
//! sent again.

use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

use serde::Serialize;

use crate::drawing::{Drawn, Item, Wish};

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
    /// The first and the last place in the text of each symbol that is the same.
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    places: Vec<usize>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(untagged)]
enum Sent<'a> {
    /// The symbol with this number in the other drawing, but for its places in the text.
    Same(usize),
    /// A symbol that is drawn as another one.
    Alike {
        r#as: usize,
        #[serde(flatten)]
        item: &'a Item,
    },
    New(Whole<'a>),
}

/// A symbol with its drawing.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Item"))]
struct Whole<'a> {
    /// The SVG of the symbol.
    svg: &'a str,
    /// Path data for zoomed-out views.
    far: &'a str,
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
    fn new(drawn: &'a Drawn, number: Option<u64>, old: Option<(u64, &[Item])>) -> Redrawn<'a> {
        let (since, old) = match old {
            Some((since, items)) => (Some(since), items),
            None => (None, &[][..]),
        };
        let known: HashMap<u64, usize> = old.iter().enumerate().map(|(k, item)| (look(item), k)).collect();
        let mut places = Vec::new();
        let alike = |item: &Item| {
            // A whole drawing is compared with nothing, so its symbols need no numbers.
            let k = if known.is_empty() { None } else { known.get(&look(item)).copied() }?;
            old.get(k).filter(|o| o.svg == item.svg && o.far == item.far).map(|o| (k, o))
        };
        let items = drawn.items.iter().map(|item| match alike(item) {
            Some((k, o)) if o.same(item) => {
                places.extend([item.from, item.to]);
                Sent::Same(k)
            }
            Some((k, _)) => Sent::Alike { r#as: k, item },
            None => Sent::New(Whole { svg: &item.svg, far: &item.far, item }),
        });
        let items = items.collect();
        Redrawn { drawn, number, since, items, places }
    }
}

/// A number for the drawing of a symbol; two different ones can have the same.
fn look(item: &Item) -> u64 {
    let mut hasher = DefaultHasher::new();
    item.svg.hash(&mut hasher);
    item.far.hash(&mut hasher);
    hasher.finish()
}
