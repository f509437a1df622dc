//! A chart's drawing in the form that the page needs: px, ids, places in the text.

use std::collections::HashMap;

use g7_draw::{ActionForms, Bends, End, Look, Options, Picture, Point, Rect};
use g7_edit::{ChartSort, DrawnAs, ItemId, Sort, StackedAs};
use g7_ide::ids;
use g7_ide::{File, Positions, Readable};
use g7_model::{ActionKind, Chart, ChartKind, Document, Order, Said, Step, StepKind, Transition, say};
use g7_rig::Source;
use serde::{Deserialize, Serialize, Serializer};

/// The standard whose symbols are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "lowercase")]
pub(crate) enum Standard {
    Iec60848,
    Sfc,
}

/// The pages on which a chart is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "lowercase")]
pub(crate) enum Pages {
    Pl7,
}

/// The drawing that the page asks for.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "DrawingWish", optional_fields = nullable))]
pub(crate) struct Wish {
    pub(crate) file: String,
    pub(crate) chart: String,
    #[serde(default)]
    look: Option<Standard>,
    #[serde(default)]
    pages: Option<Pages>,
    #[serde(default)]
    actions: Option<bool>,
    /// The steps whose expansions and enclosed charts are drawn beside the chart, by their ids.
    #[serde(default)]
    #[cfg_attr(feature = "types", ts(as = "Option<_>", optional))]
    pub(crate) open: Vec<String>,
    /// The number of the drawing that the page has, 0 if none; absent if this one is not to be kept.
    #[serde(default)]
    pub(crate) since: Option<u64>,
}

impl Wish {
    /// How the chart is to be drawn.
    pub(crate) fn options(&self) -> Options {
        Options {
            look: match self.look {
                None | Some(Standard::Iec60848) => Look::Iec60848,
                Some(Standard::Sfc) => Look::Sfc,
            },
            actions: self.actions.unwrap_or(true),
            pages: self.pages == Some(Pages::Pl7),
            ..Options::default()
        }
    }

    /// The name under which the drawing is kept; the file stands first, on a line of its own.
    pub(crate) fn key(&self) -> String {
        let file = self.file.replace('\n', " ");
        let Wish { chart, look, pages, actions, open, .. } = self;
        format!("{file}\n{chart}\n{look:?}\n{pages:?}\n{actions:?}\n{open:?}")
    }
}

/// A rectangle, sent as its left and upper edge, width, height.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Box", as = "[f64; 4]"))]
pub(crate) struct Area(pub(crate) Rect);

impl Serialize for Area {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Rect { x, y, w, h } = self.0;
        [x, y, w, h].map(px).serialize(to)
    }
}

/// A point or a vector, sent as its two lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(as = "[f64; 2]"))]
pub(crate) struct Spot(pub(crate) Point);

impl Serialize for Spot {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        [self.0.x, self.0.y].map(px).serialize(to)
    }
}

/// The kinds of symbols.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub(crate) enum Part {
    Step,
    Action,
    Transition,
    Link,
    Connector,
    Comment,
    /// The name of a chart on a sheet with several; its anchor is the place of the origin of the chart.
    Title,
    /// It is only drawn.
    #[default]
    Text,
}

/// The drawing of a chart. Lengths are in px at 100 %.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub(crate) struct Drawn {
    pub(crate) chart: String,
    pub(crate) kind: ChartSort,
    /// True if the drawing shows an earlier text, because the present one has syntax errors.
    pub(crate) stale: bool,
    pub(crate) area: Area,
    /// How the actions of steps without a choice of their own stand.
    pub(crate) actions: StackedAs,
    #[serde(skip)]
    pub(crate) items: Vec<Item>,
}

/// A symbol, without its drawing, which is sent only where it is new.
#[derive(Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Shape", optional_fields))]
pub(crate) struct Item {
    pub(crate) id: String,
    pub(crate) part: Part,
    pub(crate) area: Area,
    #[serde(skip)]
    pub(crate) picture: Picture,
    pub(crate) from: usize,
    pub(crate) to: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    square: Option<Area>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bar: Option<Area>,
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<Area>,
    /// The anchor: the middle of the upper edge of a step, the middle of the bar of a transition.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) at: Option<Spot>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    label: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) comment: Option<String>,
    /// The receptivity or the action as typed.
    #[serde(skip_serializing_if = "Option::is_none")]
    source: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    priority: Option<u32>,
    /// The names of the preceding and the succeeding steps of a transition.
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<[Vec<String>; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<Sort>,
    #[serde(rename = "macro", skip_serializing_if = "Option::is_none")]
    expansion: Option<String>,
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    encloses: Vec<String>,
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    initial: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) ends: Option<[String; 2]>,
    /// How many segments at the start and at the end of a link no bend moves; absent if none can be moved.
    #[serde(skip_serializing_if = "Option::is_none")]
    held: Option<[usize; 2]>,
    /// The bends that the text gives a link: true if it follows them, false if they do not fit at present.
    #[serde(skip_serializing_if = "Option::is_none")]
    bent: Option<bool>,
    /// The form that the text gives a link, whatever the drawing could do.
    #[serde(skip_serializing_if = "Option::is_none")]
    form: Option<DrawnAs>,
    /// How the actions of a step stand, where it has a choice of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    stacked: Option<StackedAs>,
}

impl Item {
    /// A symbol with no more than its picture and its place in the text.
    pub(crate) fn plain(id: &ItemId, part: Part, picture: Picture, (from, to): (usize, usize)) -> Item {
        let area = Area(picture.area().unwrap_or_default());
        Item { id: id.to_string(), part, area, picture, from, to, ..Item::default() }
    }

    /// How far this symbol is moved from another one that is the same but for its number and its places in the
    /// text; `None` if it is another.
    #[inline(never)]
    pub(crate) fn moved_from(&self, old: &Item) -> Option<Point> {
        // `picture` is compared last, because it is long.
        let Item { id: _, part, area: _, picture, from: _, to: _, square, bar, text, at, .. } = self;
        let Item { name, label, comment, source, priority, steps, .. } = self;
        let Item { step, expansion, encloses, initial, ends, held, bent, form, stacked, .. } = self;
        let same = (part, name, label, comment) == (&old.part, &old.name, &old.label, &old.comment)
            && (source, priority, steps) == (&old.source, &old.priority, &old.steps)
            && (step, expansion, encloses, initial)
                == (&old.step, &old.expansion, &old.encloses, &old.initial)
            && (held, bent, form, stacked) == (&old.held, &old.bent, &old.form, &old.stacked)
            && same_ends(ends.as_ref(), old.ends.as_ref());
        let by = if same { picture.moved_from(&old.picture) } else { None }?;
        let boxes = [(*square, old.square), (*bar, old.bar), (*text, old.text)];
        let moved = |(new, old): (Option<Area>, Option<Area>)| match (new, old) {
            (Some(new), Some(old)) => new.0.is_moved_from(&old.0, by),
            (new, old) => new.is_none() && old.is_none(),
        };
        let anchor = at.map(|a| a.0) == old.at.map(|a| Point { x: a.0.x + by.x, y: a.0.y + by.y });
        (anchor && boxes.into_iter().all(moved)).then_some(by)
    }
}

/// True if two links lead from and to the same steps; a transition may have another number.
fn same_ends(ends: Option<&[String; 2]>, old: Option<&[String; 2]>) -> bool {
    let is_transition = |id: &str| id.split('/').nth(1) == Some("t");
    let same = |(a, b): (&String, &String)| a == b || is_transition(a) && is_transition(b);
    match (ends, old) {
        (Some(ends), Some(old)) => ends.iter().zip(old).all(same),
        (ends, old) => ends.is_none() && old.is_none(),
    }
}

/// Draws a chart of a file.
#[inline(never)]
pub(crate) fn drawing(file: &File, wish: &Wish) -> Result<Drawn, Said> {
    let find = |c: &&Chart| *c.name.text == *wish.chart;
    let has = |document: &Document| document.charts().any(|c| find(&c));
    let readable = file.drawn_chart(&wish.chart);
    let others = file.source.others().iter();
    match others.filter(|_| !has(readable.document)).find(|o| has(&o.source.document)) {
        Some(other) => {
            let Source { document, text, .. } = &*other.source;
            let readable = Readable { document, text, positions: &Positions::new(text), stale: false };
            let mut drawn = drawn(readable, wish)?;
            // A symbol of another file stands where this one uses that.
            let (from, to) = file.units(other.through);
            drawn.items.iter_mut().for_each(|item| (item.from, item.to) = (from, to));
            Ok(drawn)
        }
        None => drawn(readable, wish),
    }
}

fn drawn(readable: Readable<'_>, wish: &Wish) -> Result<Drawn, Said> {
    let options = wish.options();
    let find = |c: &&Chart| *c.name.text == *wish.chart;
    let chart = readable
        .document
        .charts()
        .find(find)
        .ok_or_else(|| say!("there is no chart `{name}`", name = wish.chart))?;
    let drawing = g7_draw::draw(readable.document, chart, &options);
    let names = Names::new(readable, chart);
    Ok(Drawn {
        chart: wish.chart.clone(),
        kind: sort(chart.kind),
        stale: readable.stale,
        area: Area(drawing.area),
        actions: names.forms.usual.into(),
        items: unique(drawing.items.into_iter().enumerate().map(|(n, i)| names.item(n, i)).collect()),
    })
}

/// The charts that a step opens: its expansion, or the charts that it encloses.
pub(crate) fn opens(step: &Step) -> impl Iterator<Item = &str> {
    let expansion = if let StepKind::Macro(name) = &step.kind { Some(&*name.text) } else { None };
    let enclosed = step.actions.iter().filter_map(|a| match &a.kind {
        ActionKind::Order(Order::Enclose(name)) => Some(&*name.text),
        _ => None,
    });
    expansion.into_iter().chain(enclosed)
}

pub(crate) struct Names<'a> {
    readable: Readable<'a>,
    chart: &'a Chart,
    steps: Vec<&'a Step>,
    transitions: Vec<&'a Transition>,
    /// The ids of the steps and of the transitions: links name each of them once more.
    step_ids: Vec<String>,
    transition_ids: Vec<String>,
    /// The comments of the layout section.
    comments: Vec<&'a str>,
    pub(crate) forms: ActionForms<'a>,
}

impl<'a> Names<'a> {
    pub(crate) fn new(readable: Readable<'a>, chart: &'a Chart) -> Names<'a> {
        let name = &*chart.name.text;
        let transitions: Vec<&Transition> = chart.transitions().collect();
        Names {
            readable,
            chart,
            steps: chart.steps().collect(),
            step_ids: chart.steps().map(|s| ids::step(name, &s.name.text)).collect(),
            transition_ids: (0..transitions.len()).map(|n| ids::transition(name, n)).collect(),
            transitions,
            forms: g7_draw::action_forms(readable.document, chart),
            comments: g7_draw::comments(readable.document, chart).map(|(text, _)| text).collect(),
        }
    }

    #[inline(never)]
    pub(crate) fn item(&self, number: usize, item: g7_draw::Item) -> Item {
        let chart = &*self.chart.name.text;
        let (from, to) = self.readable.units(item.at);
        let base = Item { area: Area(item.area), picture: item.picture, from, to, ..Item::default() };
        match item.part {
            g7_draw::Part::Step { step, square } => self.step(step, square, base),
            g7_draw::Part::Action { step, index } => {
                let name = self.name(step);
                let source = self.readable.words(item.at);
                let id = ids::action(chart, name, index as usize);
                Item { id, part: Part::Action, source: Some(source), ..base }
            }
            g7_draw::Part::Transition { transition, bar, text } => {
                self.transition(transition, bar, text, base)
            }
            g7_draw::Part::Link { from, to, held, bends, form, .. } => {
                let id = ItemId::link(chart, self.end(from), self.end(to)).to_string();
                let bent = match bends {
                    Bends::None => None,
                    Bends::Followed => Some(true),
                    Bends::Waived => Some(false),
                };
                let ends = Some([self.end_id(from), self.end_id(to)]);
                let form = form.map(DrawnAs::from);
                Item { id, part: Part::Link, ends, held, bent, form, ..base }
            }
            g7_draw::Part::Connector { from, to, leaving, form, .. } => {
                let id = ItemId::connector(chart, self.end(from), self.end(to), leaving).to_string();
                let (ends, form) = (Some([self.end_id(from), self.end_id(to)]), form.map(DrawnAs::from));
                Item { id, part: Part::Connector, ends, form, ..base }
            }
            g7_draw::Part::Comment { comment, place } => {
                let id = ItemId::note(chart, comment as usize).to_string();
                let text = self.comments.get(comment as usize).map(|t| (*t).to_owned());
                Item { id, part: Part::Comment, at: Some(Spot(place)), comment: text, ..base }
            }
            g7_draw::Part::Text => {
                Item { id: ItemId::other(chart, number).to_string(), part: Part::Text, ..base }
            }
        }
    }

    #[inline(never)]
    fn step(&self, number: u32, square: Rect, base: Item) -> Item {
        let Some(step) = self.steps.get(number as usize) else { return base };
        let (expansion, sort) = match &step.kind {
            StepKind::Plain => (None, Sort::Plain),
            StepKind::Entry => (None, Sort::Entry),
            StepKind::Exit => (None, Sort::Exit),
            StepKind::Macro(name) => (Some(name.text.to_string()), Sort::Macro),
            StepKind::Enclosing => (None, Sort::Enclosing),
        };
        let opened = opens(step).map(str::to_owned).filter(|n| Some(n) != expansion.as_ref());
        Item {
            id: self.end_id(End::Step(number)),
            part: Part::Step,
            at: Some(Spot(Point { x: square.x + square.w / 2, y: square.y })),
            square: Some(Area(square)),
            name: Some(step.name.text.to_string()),
            comment: step.comment.as_deref().map(str::to_owned),
            step: Some(sort),
            encloses: opened.collect(),
            expansion,
            initial: step.initial,
            stacked: self.forms.own(step).map(StackedAs::from),
            ..base
        }
    }

    #[inline(never)]
    fn transition(&self, number: u32, bar: Rect, text: Rect, base: Item) -> Item {
        let Some(t) = self.transitions.get(number as usize) else { return base };
        Item {
            id: self.end_id(End::Transition(number)),
            part: Part::Transition,
            at: Some(Spot(Point { x: bar.x + bar.w / 2, y: bar.y + bar.h / 2 })),
            bar: Some(Area(bar)),
            text: Some(Area(text)),
            label: t.label.as_ref().map(|l| l.text.to_string()),
            comment: t.comment.as_deref().map(str::to_owned),
            source: Some(self.readable.words(t.receptivity.at.0)),
            priority: t.priority,
            steps: Some([&t.from, &t.to].map(|l| l.iter().map(|n| n.text.to_string()).collect())),
            ..base
        }
    }

    fn name(&self, step: u32) -> &str {
        self.steps.get(step as usize).map_or("", |s| &*s.name.text)
    }

    fn end(&self, end: End) -> g7_edit::End {
        match end {
            End::Step(n) => g7_edit::End::Step(self.name(n).to_owned()),
            End::Transition(n) => g7_edit::End::Transition(n as usize),
        }
    }

    fn end_id(&self, end: End) -> String {
        let id = match end {
            End::Step(n) => self.step_ids.get(n as usize),
            End::Transition(n) => self.transition_ids.get(n as usize),
        };
        id.cloned().unwrap_or_default()
    }
}

/// Two steps with the same name are a problem of the chart, but they still get different ids.
#[inline(never)]
pub(crate) fn unique(mut items: Vec<Item>) -> Vec<Item> {
    let mut seen: HashMap<&str, u32> = HashMap::with_capacity(items.len());
    let mut again = Vec::new();
    for (n, item) in items.iter().enumerate() {
        let times = seen.entry(&item.id).or_default();
        *times += 1;
        if *times > 1 {
            again.push((n, *times));
        }
    }
    for (n, times) in again {
        if let Some(item) = items.get_mut(n) {
            item.id = format!("{}#{times}", item.id);
        }
    }
    items
}

/// Converts hundredths of u to px; a u is 10 px.
fn px(hundredths: i32) -> f64 {
    f64::from(hundredths) / 10.0
}

/// The kind of a chart, as the page has it.
pub(crate) fn sort(kind: ChartKind) -> ChartSort {
    match kind {
        ChartKind::Chart => ChartSort::Chart,
        ChartKind::Expansion => ChartSort::Expansion,
        ChartKind::Task => ChartSort::Task,
    }
}
