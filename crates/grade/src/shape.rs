//! Charts without the names that their author chose, to find those that are the same but for names, notes, order and
//! spacing.
//!
//! ```text
//! Source -> canonical text -> tokens, the author's names as numbers -> units (a step, a transition, a declaration)
//!        -> colours of names, refined until they tell no more names apart -> a mark, equal for equal charts
//! ```
//!
//! # What must hold
//!
//! - Two charts are called alike only if one becomes the other when names are exchanged one for one: equal colours are
//!   a guess, which [`alike`] confirms.
//! - Names that the template declares outside of its charts are no choice of the author. They stay as they are.

use std::collections::hash_map::DefaultHasher;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::hash::{Hash, Hasher};

use g7_compile::{Definition, references};
use g7_model::{Document, FileId, Item, Span};
use g7_rig::Source;
use g7_syntax::TokenKind;

/// The greatest number of refinements in a comparison. Charts with very many equal parts can need more; they are then not
/// called alike.
const MOST: usize = 2_000;

/// A word of a unit.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Word {
    /// As it stands in the text.
    Plain(Box<str>),
    /// A name of the author by its number, and the letters of the language before it (`X` of `X12`).
    Name(usize, Box<str>),
}

/// The charts of a document without names.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    units: Vec<Vec<Word>>,
    /// For each name, the units in which it stands, each with the positions.
    uses: Vec<Vec<(usize, Vec<usize>)>>,
    /// Equal for charts that are alike, and for few others.
    mark: u64,
}

impl Shape {
    /// The shape of a file's charts; `template` keeps its names. Nothing for a file that has errors or no charts.
    pub fn of(source: &Source, template: &Source) -> Option<Shape> {
        if source.is_broken() {
            return None;
        }
        let kept: BTreeSet<Definition> = references(template.whole())
            .all()
            .iter()
            .map(|u| u.definition.clone())
            .filter(|d| !matches!(d, Definition::Step { .. } | Definition::Transition { .. }))
            .collect();
        let items = source.whole().items.iter().filter(|i| is_of_charts(i)).cloned().collect();
        let text = g7_syntax::print(&Document { items, notes: Vec::new() }, None);
        let (document, problems) = g7_syntax::parse(&text, FileId(0));
        if !problems.is_empty() || document.charts().next().is_none() {
            return None;
        }
        let mut shape = Shape { units: units(&text, &document, &kept), ..Shape::default() };
        shape.index();
        let mut colours = shape.start();
        shape.refine(&mut colours);
        shape.mark = shape.sum(&colours);
        Some(shape)
    }

    /// Fills `uses`: the places of each name.
    fn index(&mut self) {
        let mut uses: Vec<BTreeMap<usize, Vec<usize>>> = Vec::new();
        for (number, unit) in self.units.iter().enumerate() {
            for (position, word) in unit.iter().enumerate() {
                if let Word::Name(name, _) = word {
                    if uses.len() <= *name {
                        uses.resize(*name + 1, BTreeMap::new());
                    }
                    if let Some(of) = uses.get_mut(*name) {
                        of.entry(number).or_default().push(position);
                    }
                }
            }
        }
        self.uses = uses.into_iter().map(|of| of.into_iter().collect()).collect();
    }

    /// The first colours: all names have the same one.
    fn start(&self) -> Vec<u64> {
        vec![0; self.uses.len()]
    }

    /// The hash of each unit, with the colours of its names in the place of the names.
    fn painted(&self, colours: &[u64]) -> Vec<u64> {
        let unit = |unit: &Vec<Word>| {
            let mut hasher = DefaultHasher::new();
            for word in unit {
                match word {
                    Word::Plain(text) => (0, text).hash(&mut hasher),
                    Word::Name(name, before) => (1, colours.get(*name), before).hash(&mut hasher),
                }
            }
            hasher.finish()
        };
        self.units.iter().map(unit).collect()
    }

    /// Gives names that stand at different places different colours, until the number of colours no longer grows.
    fn refine(&self, colours: &mut Vec<u64>) {
        let mut classes = 0;
        loop {
            let painted = self.painted(colours);
            let next = self.uses.iter().zip(colours.iter()).map(|(uses, colour)| {
                let mut places: Vec<_> =
                    uses.iter().map(|(unit, positions)| (painted.get(*unit), positions)).collect();
                places.sort_unstable();
                number(&(colour, places))
            });
            *colours = next.collect();
            let now = colours.iter().collect::<BTreeSet<_>>().len();
            if now == classes {
                return;
            }
            classes = now;
        }
    }

    /// The hash of all units together, whatever their order.
    fn sum(&self, colours: &[u64]) -> u64 {
        let mut painted = self.painted(colours);
        painted.sort_unstable();
        number(&painted)
    }
}

fn number(of: &impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    of.hash(&mut hasher);
    hasher.finish()
}

/// True if one becomes the other when its names are exchanged one for one.
fn alike(a: &Shape, b: &Shape) -> bool {
    a.mark == b.mark && {
        let mut left = MOST;
        matched(a, a.start(), b, b.start(), &mut left)
    }
}

/// Refines the colours of both charts. If several names still have one colour, the first of them in `a` is paired with each
/// of them in `b` in turn, until one pair leads to equal charts.
fn matched(a: &Shape, mut of_a: Vec<u64>, b: &Shape, mut of_b: Vec<u64>, left: &mut usize) -> bool {
    let Some(rest) = left.checked_sub(1) else { return false };
    *left = rest;
    a.refine(&mut of_a);
    b.refine(&mut of_b);
    if a.sum(&of_a) != b.sum(&of_b) {
        return false;
    }
    let mut classes: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (name, colour) in of_a.iter().enumerate() {
        classes.entry(*colour).or_default().push(name);
    }
    let Some((colour, names)) =
        classes.iter().filter(|(_, names)| names.len() > 1).min_by_key(|(_, n)| n.len())
    else {
        // Each name has a colour of its own, so equal sums are equal units.
        return true;
    };
    let paint = |colours: &[u64], name: usize| {
        let mut painted = colours.to_vec();
        painted.get_mut(name).into_iter().for_each(|c| *c = number(&(*c, "chosen")));
        painted
    };
    let Some(first) = names.first() else { return true };
    let partners = of_b.iter().enumerate().filter(|(_, c)| *c == colour).map(|(name, _)| name);
    partners
        .collect::<Vec<_>>()
        .into_iter()
        .any(|p| matched(a, paint(&of_a, *first), b, paint(&of_b, p), left))
}

/// The groups of shapes that are alike, each with the numbers of two or more, in their order.
pub fn groups(shapes: &[Option<Shape>]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let known = |number: &usize| shapes.get(*number).and_then(Option::as_ref);
    for number in 0..shapes.len() {
        let Some(shape) = known(&number) else { continue };
        let like =
            |group: &&mut Vec<usize>| group.first().and_then(known).is_some_and(|first| alike(first, shape));
        match groups.iter_mut().find(like) {
            Some(group) => group.push(number),
            None => groups.push(vec![number]),
        }
    }
    groups.retain(|group| group.len() > 1);
    groups
}

/// True for items that say what charts do.
fn is_of_charts(item: &Item) -> bool {
    !matches!(item, Item::Plant(_) | Item::Test(_) | Item::Prove(_) | Item::Layout(_))
}

/// The words of each step, transition, declaration and other item, without notes and comments.
fn units(text: &str, document: &Document, kept: &BTreeSet<Definition>) -> Vec<Vec<Word>> {
    let known = references(document);
    let named: BTreeMap<u32, (&Definition, usize)> =
        known.all().iter().map(|u| (u.at.start, (&u.definition, u.before))).collect();
    let mut numbers: BTreeMap<&Definition, usize> = BTreeMap::new();
    let mut units: Vec<Vec<Word>> = Vec::new();
    let mut unit = None;
    let (places, charts) = places(document);
    let mut steps = HashSet::new();
    for token in g7_syntax::tokens(text) {
        if matches!(token.kind, TokenKind::Note | TokenKind::Comment) {
            continue;
        }
        let at = token.start as u32;
        let inside = innermost(&places, at);
        if inside != unit || units.is_empty() {
            unit = inside;
            units.push(Vec::new());
            // The chart to which a step or a transition belongs.
            let chart = charts.iter().find(|(whole, _)| whole.start < at && at < whole.end);
            if let (Some((_, name)), Some(words)) = (chart, units.last_mut()) {
                let chart = named.get(&name.start).map(|(definition, _)| *definition);
                words.extend(chart.map(|definition| word(definition, "", "", kept, &mut numbers)));
            }
        }
        let written = text.get(token.start..token.end).unwrap_or_default();
        let word = match named.get(&at) {
            Some((definition, before)) => {
                word(definition, written, written.get(..*before).unwrap_or_default(), kept, &mut numbers)
            }
            None => Word::Plain(written.into()),
        };
        if let Some(words) = units.last_mut() {
            push(words, word, &steps);
        }
        if let Some((Definition::Step { .. }, _)) = named.get(&at) {
            steps.extend(units.last().and_then(|words| words.last()).cloned());
        }
    }
    units
}

/// Adds a word. The activity of step `Fill` is `Fill.X`, that of step `12` is `X12`: both are the name alone here.
fn push(words: &mut Vec<Word>, word: Word, steps: &HashSet<Word>) {
    let dot = Word::Plain(".".into());
    if let [.., step, last] = words.as_slice()
        && *last == dot
        && word == Word::Plain("X".into())
        && steps.contains(step)
    {
        words.pop();
        return;
    }
    words.push(word);
}

fn word<'d>(
    definition: &'d Definition,
    written: &str,
    before: &str,
    kept: &BTreeSet<Definition>,
    numbers: &mut BTreeMap<&'d Definition, usize>,
) -> Word {
    if kept.contains(definition) {
        return Word::Plain(
            if written.is_empty() { format!("{definition:?}") } else { written.to_owned() }.into(),
        );
    }
    let before = if matches!(definition, Definition::Step { .. }) { "" } else { before };
    let next = numbers.len();
    Word::Name(*numbers.entry(definition).or_insert(next), before.into())
}

/// The places of all units, and of the charts with their names.
fn places(document: &Document) -> (Vec<Span>, Vec<(Span, Span)>) {
    let (mut places, mut charts) = (Vec::new(), Vec::new());
    for item in &document.items {
        places.push(item.at());
        if let Item::Chart(chart) = item {
            charts.push((chart.at.0, chart.name.at.0));
            places.extend(chart.items.iter().map(g7_model::ChartItem::at));
        }
    }
    (places, charts)
}

/// The number of the smallest place that holds a byte.
fn innermost(places: &[Span], at: u32) -> Option<usize> {
    let holds = places.iter().enumerate().filter(|(_, p)| p.start <= at && at < p.end);
    holds.min_by_key(|(_, p)| p.end - p.start).map(|(number, _)| number)
}
