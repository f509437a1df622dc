//! Turns a chart into its drawing: builds the symbols round their anchors, gives their sizes to the
//! layout, and puts the symbols at the places that the layout returns.

use std::collections::HashMap;

use g7_model::{ActionForm, Chart, Document, Item as Entry, PlaceAt, Placed, Step, Transition};

use crate::ink::Picture;
use crate::layout::layout;
use crate::layout::section::FAR;
use crate::pages;
use crate::symbols::{
    SQUARE, StepShape, TransitionShape, arrow, connector, connector_label, connector_width, double, note,
    step, transition, widest,
};
use crate::{Bar, Connector, Drawing, End, Item, Options, Part, Placement, Point, Rect, Sizes};

/// The symbols of a chart, built round their anchors, and the room that each needs.
pub(crate) struct Symbols<'a> {
    pub(crate) steps: Vec<(&'a Step, StepShape)>,
    pub(crate) transitions: Vec<(&'a Transition, TransitionShape)>,
    pub(crate) sizes: Sizes,
}

/// Measures the room that each symbol of a chart needs.
pub fn measure(document: &Document, chart: &Chart, options: &Options) -> Sizes {
    Symbols::new(chart, places(document, chart), options).sizes
}

/// The places of the symbols of a chart on one sheet.
pub fn placed(document: &Document, chart: &Chart, options: &Options) -> Placement {
    let places = places(document, chart);
    layout(chart, &Symbols::new(chart, places, options).sizes, places)
}

/// Draws a chart.
pub fn draw(document: &Document, chart: &Chart, options: &Options) -> Drawing {
    drawing(chart, places(document, chart), options)
}

/// Draws several charts of a document.
#[inline(never)]
pub fn draw_all<'a>(
    document: &Document,
    charts: impl IntoIterator<Item = &'a Chart>,
    options: &Options,
) -> Vec<Drawing> {
    let mut layouts: HashMap<&str, &[PlaceAt]> = HashMap::new();
    for item in &document.items {
        if let Entry::Layout(l) = item {
            layouts.entry(&l.chart.text).or_insert(&l.places);
        }
    }
    let places = |c: &Chart| layouts.get(&*c.name.text).copied().unwrap_or(&[]);
    charts.into_iter().map(|c| drawing(c, places(c), options)).collect()
}

/// Draws a chart with the entries of its layout section.
#[inline(never)]
fn drawing(chart: &Chart, places: &[PlaceAt], options: &Options) -> Drawing {
    let symbols = Symbols::new(chart, places, options);
    if options.pages {
        let paged = pages::place(chart, &symbols.sizes);
        return symbols.put(chart, &paged.placement, paged.frames, &paged.pages);
    }
    let placement = layout(chart, &symbols.sizes, places);
    let mut drawing = symbols.put(chart, &placement, Vec::new(), &[]);
    for note in notes(places).into_iter().map(Item::from) {
        drawing.area = drawing.area.union(&note.area);
        drawing.items.push(note);
    }
    drawing
}

/// The symbols of a chart on one sheet, as strokes, and where they stand.
pub(crate) fn inked(document: &Document, chart: &Chart, options: &Options) -> (Placement, Vec<Inked>) {
    let places = places(document, chart);
    let symbols = Symbols::new(chart, places, options);
    let placement = layout(chart, &symbols.sizes, places);
    let mut all = symbols.inked(&placement, &[]);
    all.extend(notes(places));
    (placement, all)
}

/// The comments in the layout section of a chart, in the order of the text, with their places.
pub fn comments<'a>(document: &'a Document, chart: &Chart) -> impl Iterator<Item = (&'a str, Point)> {
    comments_of(places(document, chart)).map(|(text, p)| (text, corner(p)))
}

fn comments_of(places: &[PlaceAt]) -> impl Iterator<Item = (&str, &PlaceAt)> {
    places.iter().filter_map(|p| match &p.what {
        Placed::Comment(text) => Some((&**text, p)),
        _ => None,
    })
}

/// The upper left corner of a comment.
fn corner(p: &PlaceAt) -> Point {
    Point { x: p.x.clamp(-FAR, FAR), y: p.y.clamp(-FAR, FAR) }
}

/// The comments in the layout section of a chart as they are drawn.
pub(crate) fn notes_of(document: &Document, chart: &Chart) -> Vec<Item> {
    notes(places(document, chart)).into_iter().map(Item::from).collect()
}

fn notes(places: &[PlaceAt]) -> Vec<Inked> {
    let note = |(comment, (text, p)): (u32, (&str, &PlaceAt))| {
        let place = corner(p);
        item(Part::Comment { comment, place }, note(text).moved(place), p.at.0)
    };
    (0..).zip(comments_of(places)).map(note).collect()
}

/// How the actions of the steps of a chart stand, as its layout section says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ActionForms<'a> {
    /// Those of a step without a form of its own.
    pub usual: ActionForm,
    own: HashMap<&'a str, ActionForm>,
}

impl<'a> ActionForms<'a> {
    /// The forms that the entries of a layout section give; the first entry counts.
    fn new(places: &'a [PlaceAt]) -> ActionForms<'a> {
        let mut usual = None;
        let mut own = HashMap::new();
        for place in places {
            match &place.what {
                Placed::Actions(None, form) => usual = usual.or(Some(*form)),
                Placed::Actions(Some(step), form) => {
                    if let Placed::Step(name) = &**step {
                        own.entry(&*name.text).or_insert(*form);
                    }
                }
                _ => {}
            }
        }
        ActionForms { usual: usual.unwrap_or_default(), own }
    }

    /// The form that a step has of its own.
    pub fn own(&self, step: &Step) -> Option<ActionForm> {
        self.own.get(&*step.name.text).copied()
    }

    /// The form in which the actions of a step are drawn.
    pub fn of(&self, step: &Step) -> ActionForm {
        self.own(step).unwrap_or(self.usual)
    }
}

/// How the actions of the steps of a chart stand.
pub fn action_forms<'a>(document: &'a Document, chart: &Chart) -> ActionForms<'a> {
    ActionForms::new(places(document, chart))
}

/// The entries of the layout section for this chart.
pub(crate) fn places<'a>(document: &'a Document, chart: &Chart) -> &'a [PlaceAt] {
    let mut sections = document.items.iter().filter_map(|i| match i {
        Entry::Layout(l) if l.chart == chart.name => Some(l.places.as_slice()),
        _ => None,
    });
    sections.next().unwrap_or(&[])
}

/// The number of transitions that follow each step, and the number that precede it.
fn alternatives(chart: &Chart) -> HashMap<&str, (usize, usize)> {
    let mut count = HashMap::<&str, (usize, usize)>::new();
    for t in chart.transitions() {
        t.from.iter().for_each(|n| count.entry(&n.text).or_default().0 += 1);
        t.to.iter().for_each(|n| count.entry(&n.text).or_default().1 += 1);
    }
    count
}

impl<'a> Symbols<'a> {
    #[inline(never)]
    pub(crate) fn new(chart: &'a Chart, places: &[PlaceAt], options: &Options) -> Symbols<'a> {
        let forms = ActionForms::new(places);
        let steps: Vec<_> = chart.steps().map(|s| (s, step(s, forms.of(s), options))).collect();
        let alternatives = alternatives(chart);
        let shape = |t: &'a Transition| {
            let at = |n: &g7_model::Name| alternatives.get(&*n.text).copied().unwrap_or_default();
            let among = t.from.iter().map(|n| at(n).0).chain(t.to.iter().map(|n| at(n).1));
            (t, transition(t, widest(among.max().unwrap_or(1))))
        };
        let transitions: Vec<_> = chart.transitions().map(shape).collect();
        let sizes = Sizes {
            steps: steps.iter().map(|(_, s)| s.extent).collect(),
            transitions: transitions.iter().map(|(_, t)| t.extent).collect(),
            connectors: steps
                .iter()
                .map(|(s, _)| connector_width(&connector_label(&s.name.text, None)))
                .collect(),
        };
        Symbols { steps, transitions, sizes }
    }

    /// Puts every symbol at its place, after the items that are there already. `pages` holds the page
    /// number of each step if the chart takes several pages.
    pub(crate) fn put(
        self,
        chart: &Chart,
        placement: &Placement,
        mut items: Vec<Item>,
        pages: &[u32],
    ) -> Drawing {
        items.extend(self.inked(placement, pages).into_iter().map(Item::from));
        let area = items
            .iter()
            .map(|i| i.area)
            .fold(None, |all: Option<Rect>, a| Some(all.map_or(a, |all| all.union(&a))));
        let area = area.map_or(placement.area, |a| a.union(&placement.area));
        Drawing { chart: chart.name.text.clone(), area, items }
    }

    /// Every symbol at its place, in the order of painting.
    #[inline(never)]
    fn inked(self, placement: &Placement, pages: &[u32]) -> Vec<Inked> {
        let mut items = Vec::new();
        self.links(placement, &mut items);
        let names = Names::new(&self);
        let mut bars: HashMap<u32, Vec<&Bar>> = HashMap::new();
        placement.bars.iter().for_each(|b| bars.entry(b.transition).or_default().push(b));
        for (index, c) in (0..).zip(&placement.connectors) {
            items.push(names.connector(index, c, placement, pages));
        }
        for (number, ((t, shape), at)) in (0..).zip(self.transitions.into_iter().zip(&placement.transitions))
        {
            let mut picture = shape.picture.moved(*at);
            let of = bars.get(&number).map_or(&[][..], Vec::as_slice);
            of.iter().for_each(|b| double(&mut picture, b, *at));
            let (bar, text) = (moved(shape.bar, *at), moved(shape.text, *at));
            items.push(item(Part::Transition { transition: number, bar, text }, picture, t.at.0));
        }
        for (number, ((s, shape), at)) in (0..).zip(self.steps.into_iter().zip(&placement.steps)) {
            for (index, picture) in shape.actions {
                let span = s.actions.get(index as usize).map_or(s.at.0, |a| a.at.0);
                items.push(item(Part::Action { step: number, index }, picture.moved(*at), span));
            }
            let square = moved(shape.square, *at);
            items.push(item(Part::Step { step: number, square }, shape.picture.moved(*at), s.at.0));
        }
        items
    }

    #[inline(never)]
    fn links(&self, placement: &Placement, items: &mut Vec<Inked>) {
        for (index, l) in (0..).zip(&placement.links) {
            let mut picture = Picture::default();
            let points: Vec<(i32, i32)> = l.points.iter().map(|p| (p.x, p.y)).collect();
            picture.line("g7-link", &points);
            l.arrows.iter().for_each(|(tip, way)| arrow(&mut picture, *tip, *way));
            let (from, to, held, bends, form) = (l.from, l.to, l.held, l.bends, l.form);
            let part = Part::Link { link: index, from, to, held, bends, form };
            items.push(item(part, picture, self.span(from)));
        }
    }

    fn span(&self, end: End) -> g7_model::Span {
        match end {
            End::Step(n) => self.steps.get(n as usize).map(|(s, _)| s.at.0),
            End::Transition(n) => self.transitions.get(n as usize).map(|(t, _)| t.at.0),
        }
        .unwrap_or_default()
    }
}

/// The names of the steps, for the texts of connectors.
struct Names {
    steps: Vec<Box<str>>,
    /// The first preceding and the first succeeding step of each transition.
    beside: Vec<(Option<u32>, Option<u32>)>,
    spans: Vec<g7_model::Span>,
}

impl Names {
    fn new(symbols: &Symbols) -> Names {
        let steps: Vec<Box<str>> = symbols.steps.iter().map(|(s, _)| s.name.text.clone()).collect();
        let numbers: HashMap<&str, u32> = symbols.steps.iter().map(|(s, _)| &*s.name.text).zip(0..).collect();
        let first = |names: &[g7_model::Name]| names.first().and_then(|n| numbers.get(&*n.text).copied());
        let beside = symbols.transitions.iter().map(|(t, _)| (first(&t.from), first(&t.to))).collect();
        let spans = symbols.transitions.iter().map(|(t, _)| t.at.0).collect();
        Names { steps, beside, spans }
    }

    /// The step whose name a connector shows: the other end of the link or, if that is a
    /// transition, the step beyond it.
    fn named(&self, c: &Connector) -> Option<u32> {
        let beside = |t: u32| self.beside.get(t as usize).copied().unwrap_or_default();
        match if c.leaving { c.to } else { c.from } {
            End::Step(s) => Some(s),
            End::Transition(t) if c.leaving => beside(t).1,
            End::Transition(t) => beside(t).0,
        }
    }

    #[inline(never)]
    fn connector(&self, index: u32, c: &Connector, placement: &Placement, pages: &[u32]) -> Inked {
        let named = self.named(c);
        let name = named.and_then(|s| self.steps.get(s as usize)).map_or("", |s| s);
        let page = named.and_then(|s| pages.get(s as usize)).copied();
        let mut picture = Picture::default();
        // The part of the link that ends where the link is broken.
        let start = match (c.leaving, c.from) {
            (false, _) => None,
            (true, End::Step(s)) => placement.steps.get(s as usize).map(|p| Point { y: p.y + SQUARE, ..*p }),
            (true, End::Transition(t)) => placement.transitions.get(t as usize).copied(),
        };
        let points: Vec<(i32, i32)> = c.points.iter().map(|p| (p.x, p.y)).collect();
        match start {
            _ if points.len() > 1 => picture.line("g7-link", &points),
            Some(from) if from.x == c.at.x => picture.line("g7-link", &[(from.x, from.y), (c.at.x, c.at.y)]),
            _ => picture.line("g7-link", &[(c.at.x, c.at.y - 160), (c.at.x, c.at.y)]),
        }
        let before = points.iter().rev().nth(1).copied().unwrap_or((c.at.x, c.at.y - 160));
        let way = ((c.at.x - before.0).signum() as i8, (c.at.y - before.1).signum() as i8);
        arrow(&mut picture, c.at, way);
        connector(&mut picture, c.text, &connector_label(name, page));
        let transition = match (c.from, c.to) {
            (End::Transition(t), _) | (_, End::Transition(t)) => Some(t),
            (End::Step(_), End::Step(_)) => None,
        };
        let span = transition.and_then(|t| self.spans.get(t as usize)).copied().unwrap_or_default();
        let part =
            Part::Connector { connector: index, from: c.from, to: c.to, leaving: c.leaving, form: c.form };
        item(part, picture, span)
    }
}

fn moved(r: Rect, by: Point) -> Rect {
    Rect { x: r.x + by.x, y: r.y + by.y, ..r }
}

fn item(part: Part, picture: Picture, at: g7_model::Span) -> Inked {
    Inked { part, picture, at }
}

/// A symbol at its place, as strokes.
pub(crate) struct Inked {
    pub(crate) part: Part,
    pub(crate) picture: Picture,
    at: g7_model::Span,
}

impl From<Inked> for Item {
    fn from(inked: Inked) -> Item {
        let Inked { part, picture, at } = inked;
        Item { part, area: picture.area().unwrap_or_default(), picture, at }
    }
}
