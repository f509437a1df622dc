//! Actions: rectangles at the right of a step, one below the other, or side by side in one row.

use g7_model::{
    Action, ActionForm, ActionKind, Expr, ExprKind, Order, Qualifier, Situation, Step, Target, UnaryOp,
};

use crate::ink::{Picture, stack};
use crate::symbols::parts::{ACTION_TEXT, SMALL, SQUARE, quoted};
use crate::text::{Line, body, clean, set, shortened, width};
use crate::{Look, Options, Rect};

/// Distance from the square to the actions.
pub(crate) const GAP: i32 = 200;
/// Most lines of a body that are shown.
const LINES: usize = 6;
/// Greatest width of a line of an action.
const WIDEST: i32 = 2800;
/// Margin left and right of the text in its rectangle.
const PAD: i32 = 80;

/// Distance from the left edge of a rectangle to the stub over it.
const STUB: i32 = 120;
/// Distance from a stub to its condition.
const BESIDE_STUB: i32 = 60;
/// Distance from a stub with a flag to its event.
const BESIDE_FLAG: i32 = 150;

/// The frame round an action.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Frame {
    /// A plain rectangle.
    Plain,
    /// A double rectangle: a forcing order or another order to charts.
    Double,
    /// Doubled vertical sides: a call.
    Sides,
    /// Cut corners: an enclosed chart.
    Cut,
    /// No frame: a comment.
    None,
}

/// The sign at the left inside the rectangle.
enum Sign {
    Nothing,
    /// Stored on activation.
    Up,
    /// Stored on deactivation.
    Down,
    /// Executed in each scan.
    Each,
    /// A qualifier, possibly with its time.
    Box(String),
}

/// The stub over the rectangle.
enum Stub {
    Condition(Vec<Line>),
    Event(Vec<Line>),
}

/// An action, prepared for drawing.
struct Row {
    frame: Frame,
    sign: Sign,
    stub: Option<Stub>,
    lines: Vec<Line>,
    title: Option<String>,
}

/// Draws the actions of a step; `edge` is the right edge of its square.
pub(crate) fn actions(
    step: &Step,
    list: &[Action],
    edge: i32,
    form: ActionForm,
    options: &Options,
) -> Vec<(u32, Picture)> {
    let rows: Vec<Row> = list.iter().map(|a| row(step, a, options.look)).collect();
    match form {
        ActionForm::Column => in_column(&rows, edge),
        ActionForm::Row => in_row(&rows, edge),
    }
}

/// Draws actions side by side: rectangles of one height that touch each other, comments behind them.
#[inline(never)]
fn in_row(rows: &[Row], edge: i32) -> Vec<(u32, Picture)> {
    let framed = |r: &Row| r.frame != Frame::None;
    let h = rows.iter().filter(|r| framed(r)).map(|r| r.height(true)).max().unwrap_or(0);
    let y = (SQUARE - h).max(100) / 2;
    let mut x = edge + GAP;
    let mut out = Vec::new();
    let all = || (0..).zip(rows);
    for (index, row) in all().filter(|(_, r)| framed(r)).chain(all().filter(|(_, r)| !framed(r))) {
        let mut p = Picture { title: row.title.clone(), ..Picture::default() };
        if framed(row) {
            if x == edge + GAP {
                p.line("g7-thin", &[(edge, SQUARE / 2), (x, SQUARE / 2)]);
            }
            let cell = row.sign.width();
            // The condition of an action stands over its own rectangle.
            let w = row.width(cell).max(row.stub_width());
            row.draw(&mut p, Rect { x, y, w, h }, cell, true);
            x += w;
        } else {
            let (w, h) = (row.width(0), row.height(true));
            row.draw(&mut p, Rect { x: x + PAD, y: (SQUARE - h) / 2, w, h }, 0, true);
            x += w + 2 * PAD;
        }
        out.push((index, p));
    }
    out.sort_by_key(|(index, _)| *index);
    out
}

/// Draws actions one below the other.
#[inline(never)]
fn in_column(rows: &[Row], edge: i32) -> Vec<(u32, Picture)> {
    // The boxes of qualifiers have one width, so that they form a column.
    let cell = rows.iter().map(|r| r.sign.width()).max().unwrap_or(0);
    let w = rows.iter().filter(|r| r.frame != Frame::None).map(|r| r.width(cell)).max().unwrap_or(0);
    let x = edge + GAP;
    let mut out = Vec::new();
    let mut low: Option<i32> = None;
    let mut contiguous = false;
    // The lower end of the vertical line that joins the actions.
    let mut bus: Option<i32> = None;
    for (index, row) in (0..).zip(rows) {
        let h = row.height(rows.len() == 1);
        let over = row.stub_height();
        let joins = row.frame != Frame::None;
        let stacks = row.frame == Frame::Plain && row.stub.is_none();
        let y = match low {
            None if joins => (SQUARE - h).max(100) / 2,
            None => (SQUARE - h) / 2,
            Some(low) if contiguous && stacks => low,
            Some(low) => low + 60 + over,
        };
        let mut p = Picture { title: row.title.clone(), ..Picture::default() };
        if joins && !(low.is_some() && contiguous && stacks) {
            // The first action hangs at the middle of the square, the others at the vertical line.
            let middle = if low.is_none() { SQUARE / 2 } else { y + h / 2 };
            let bend = edge + GAP / 2;
            match bus {
                None if middle == SQUARE / 2 => p.line("g7-thin", &[(edge, middle), (x, middle)]),
                None => {
                    p.line("g7-thin", &[(edge, SQUARE / 2), (bend, SQUARE / 2), (bend, middle), (x, middle)]);
                }
                Some(from) => p.line("g7-thin", &[(bend, from), (bend, middle), (x, middle)]),
            }
            bus = Some(middle);
        }
        row.draw(&mut p, Rect { x, y, w, h }, cell, rows.len() == 1);
        low = Some(y + h);
        contiguous = row.frame == Frame::Plain;
        out.push((index, p));
    }
    out
}

/// The lines that are shown; if some are left out, also the full text.
#[inline(never)]
pub(crate) fn limited(lines: &[Line]) -> (Vec<Line>, Option<String>) {
    let full = || {
        let indent = |l: &Line| " ".repeat(usize::try_from(l.indent / 70).unwrap_or(0));
        lines.iter().map(|l| format!("{}{}", indent(l), l.linear())).collect::<Vec<_>>().join("\n")
    };
    let mut shown: Vec<Line> = lines.iter().cloned().flat_map(|l| l.wrap(ACTION_TEXT, WIDEST)).collect();
    if shown.len() <= LINES {
        let title = shown.iter().any(Line::is_cut).then(full);
        return (shown, title);
    }
    shown.truncate(LINES - 1);
    shown.push(Line::plain("…"));
    (shown, Some(full()))
}

#[inline(never)]
fn row(step: &Step, action: &Action, look: Look) -> Row {
    let plain = |sign, lines: &[Line]| {
        let (lines, title) = limited(lines);
        Row { frame: Frame::Plain, sign, stub: None, lines, title }
    };
    match &action.kind {
        ActionKind::Qualified { qualifier, time, target, condition } => {
            let condition = condition.as_ref();
            match look {
                Look::Sfc => {
                    let mut row =
                        plain(Sign::Box(qualified(*qualifier, time.as_ref())), &target_lines(target));
                    row.stub = condition.map(|c| Stub::Condition(above(set(c))));
                    row
                }
                Look::Iec60848 => grafcet(step, *qualifier, time.as_ref(), target, condition),
            }
        }
        ActionKind::OnEvent { event, work } => {
            let mut row = plain(Sign::Nothing, &body(work.statements()));
            row.stub = Some(Stub::Event(above(set(event))));
            row
        }
        ActionKind::EachScan { work, condition } => {
            let mut row = plain(Sign::Each, &body(work.statements()));
            row.stub = condition.as_ref().map(|c| Stub::Condition(above(set(c))));
            row
        }
        ActionKind::Order(order) => ordered(order),
        ActionKind::Comment(text) => {
            let (lines, whole) = quoted(text, 2400, 4);
            let title = (!whole).then(|| text.to_string());
            Row { frame: Frame::None, sign: Sign::Nothing, stub: None, lines, title }
        }
    }
}

/// A qualified action in the notation of GRAFCET; where GRAFCET has none, the qualifier stays.
#[inline(never)]
fn grafcet(step: &Step, q: Qualifier, time: Option<&Expr>, target: &Target, c: Option<&Expr>) -> Row {
    let work = matches!(target, Target::Work(_));
    let lines = target_lines(target);
    let assigned =
        |value: &str| lines.iter().map(|l| Line::plain(format!("{} := {value}", l.text))).collect();
    let (sign, lines): (Sign, Vec<Line>) = match q {
        Qualifier::N if !work => (Sign::Nothing, lines),
        Qualifier::D | Qualifier::L if !work => (Sign::Nothing, lines),
        Qualifier::S if !work => (Sign::Up, assigned("1")),
        Qualifier::R if !work => (Sign::Up, assigned("0")),
        Qualifier::P1 => (Sign::Up, lines),
        Qualifier::P0 => (Sign::Down, lines),
        Qualifier::N
        | Qualifier::S
        | Qualifier::R
        | Qualifier::L
        | Qualifier::D
        | Qualifier::P
        | Qualifier::SD
        | Qualifier::DS
        | Qualifier::SL => (Sign::Box(qualified(q, time)), lines),
    };
    let in_time = match (q, &sign, time) {
        (Qualifier::D, Sign::Nothing, Some(t)) => Some(since(step, t, false)),
        (Qualifier::L, Sign::Nothing, Some(t)) => Some(since(step, t, true)),
        _ => None,
    };
    let mut row = Row { frame: Frame::Plain, sign, stub: None, lines: Vec::new(), title: None };
    (row.lines, row.title) = limited(&lines);
    row.stub = match (in_time, c) {
        (None, None) => None,
        (None, Some(c)) => Some(Stub::Condition(above(set(c)))),
        (Some(t), None) => Some(Stub::Condition(above(set(&t)))),
        (Some(t), Some(c)) => Some(Stub::Condition(above(set(&and(t, c.clone()))))),
    };
    row
}

/// The condition `t/X2` or its complement: the delay and the limit of IEC 60848.
fn since(step: &Step, t: &Expr, complement: bool) -> Expr {
    let name = if step.name.text.starts_with(|c: char| c.is_ascii_digit()) {
        format!("X{}", step.name.text)
    } else {
        format!("{}.X", step.name.text)
    };
    let at = t.at;
    let name = g7_model::Name { text: name.into(), at };
    let active = Expr { kind: ExprKind::Path(g7_model::Path { names: vec![name] }), at };
    let timer = Expr { kind: ExprKind::Timer { t1: Box::new(t.clone()), e: Box::new(active), t2: None }, at };
    if complement { Expr { kind: ExprKind::Unary(UnaryOp::Not, Box::new(timer)), at } } else { timer }
}

fn and(a: Expr, b: Expr) -> Expr {
    let at = a.at;
    Expr { kind: ExprKind::Binary(g7_model::BinaryOp::And, Box::new(a), Box::new(b)), at }
}

fn above(line: Line) -> Vec<Line> {
    let mut lines = line.wrap(SMALL, WIDEST);
    if lines.len() > LINES {
        lines.truncate(LINES - 1);
        lines.push(Line::plain("…"));
    }
    lines
}

fn qualified(q: Qualifier, time: Option<&Expr>) -> String {
    match time {
        Some(t) => format!("{} {}", q.name(), shortened(&set(t).text, SMALL, 900).0),
        None => q.name().to_owned(),
    }
}

fn target_lines(target: &Target) -> Vec<Line> {
    match target {
        Target::Path(p) => vec![Line::plain(clean(&p.text()))],
        Target::Element(element) => vec![set(element)],
        Target::Direct(d, _) => vec![Line::plain(format!("%{}", clean(d)))],
        Target::Work(work) => body(work.statements()),
    }
}

#[inline(never)]
fn ordered(order: &Order) -> Row {
    let (frame, text) = match order {
        Order::Force(chart, situation) => {
            let steps = match situation {
                Situation::Init => "INIT".to_owned(),
                Situation::Current => "*".to_owned(),
                Situation::Steps(steps) => {
                    steps.iter().map(|n| clean(&n.text)).collect::<Vec<_>>().join(", ")
                }
            };
            (Frame::Double, format!("{}{{{steps}}}", clean(&chart.text)))
        }
        Order::Enable(chart) => (Frame::Double, format!("enable {}", clean(&chart.text))),
        Order::Mask(what) => (Frame::Double, format!("mask {}", clean(&what.text))),
        Order::Call(task) => (Frame::Sides, clean(&task.text)),
        Order::Enclose(chart) => (Frame::Cut, clean(&chart.text)),
    };
    let (lines, title) = limited(&[Line::plain(text)]);
    Row { frame, sign: Sign::Nothing, stub: None, lines, title }
}

impl Row {
    /// The margins left and right of the text; `cell` is the width of the step's qualifier boxes.
    fn sides(&self, cell: i32) -> (i32, i32) {
        let extra = match self.frame {
            Frame::Double | Frame::Sides => 40,
            Frame::Cut => 30,
            Frame::Plain | Frame::None => 0,
        };
        let sign = match &self.sign {
            Sign::Nothing => 0,
            Sign::Up | Sign::Down => 110,
            Sign::Each => 150,
            Sign::Box(_) => cell,
        };
        (PAD + extra + sign, PAD + extra)
    }

    fn width(&self, cell: i32) -> i32 {
        let (left, right) = self.sides(cell);
        let text = self.lines.iter().map(|l| l.width(ACTION_TEXT)).max().unwrap_or(0);
        (left + text + right).max(400)
    }

    fn height(&self, alone: bool) -> i32 {
        let (_, text) = stack(&self.lines, if self.frame == Frame::None { SMALL } else { ACTION_TEXT });
        match self.frame {
            Frame::None => text,
            Frame::Double => (text + 160).max(if alone { 400 } else { 330 }),
            Frame::Plain | Frame::Sides | Frame::Cut => (text + 120).max(if alone { 400 } else { 300 }),
        }
    }

    fn stub_height(&self) -> i32 {
        match &self.stub {
            None => 0,
            Some(Stub::Condition(lines) | Stub::Event(lines)) => stack(lines, SMALL).1 + 60,
        }
    }

    /// The width of the condition or event over the rectangle, with its stub.
    fn stub_width(&self) -> i32 {
        let (lines, before) = match &self.stub {
            None => return 0,
            Some(Stub::Condition(lines)) => (lines, STUB + BESIDE_STUB),
            Some(Stub::Event(lines)) => (lines, STUB + BESIDE_FLAG),
        };
        before + lines.iter().map(|l| l.width(SMALL)).max().unwrap_or(0) + PAD
    }

    #[inline(never)]
    fn draw(&self, p: &mut Picture, at: Rect, cell: i32, alone: bool) {
        let Rect { x, y, w, h } = at;
        let size = if self.frame == Frame::None { SMALL } else { ACTION_TEXT };
        let (up, height) = stack(&self.lines, size);
        match self.frame {
            Frame::None => {
                p.lines("g7-note", (x, y + up), SMALL, &self.lines);
                return;
            }
            Frame::Plain => p.rect("g7-action", x, y, w, h),
            Frame::Double => {
                p.rect("g7-action", x, y, w, h);
                p.rect("g7-inner", x + 40, y + 40, w - 80, h - 80);
            }
            Frame::Sides => {
                p.rect("g7-action", x, y, w, h);
                p.line("g7-inner", &[(x + 45, y), (x + 45, y + h)]);
                p.line("g7-inner", &[(x + w - 45, y), (x + w - 45, y + h)]);
            }
            Frame::Cut => cut_box(p, x, y, w, h),
        }
        self.sign(p, at, cell);
        let (left, right) = self.sides(cell);
        let text = self.lines.iter().map(|l| l.width(ACTION_TEXT)).max().unwrap_or(0);
        // A single action is centred; the texts of several actions start at the same column.
        let left = if alone { left + (w - left - right - text) / 2 } else { left };
        // A single line is centred at the height of its capitals.
        let first = match self.lines.as_slice() {
            [_] => y + h / 2 + size * 35 / 100,
            _ => y + (h - height) / 2 + up,
        };
        p.lines("g7-act", (x + left, first), size, &self.lines);
        if let Some(stub) = &self.stub {
            draw_stub(p, stub, x + STUB, y);
        }
    }

    #[inline(never)]
    fn sign(&self, p: &mut Picture, r: Rect, cell: i32) {
        let middle = r.y + r.h / 2;
        let at = r.x + 95;
        match &self.sign {
            Sign::Nothing => {}
            Sign::Up => {
                p.line("g7-sign", &[(at, middle + 85), (at, middle - 40)]);
                p.shape("g7-mark", &[(at, middle - 95), (at - 38, middle - 15), (at + 38, middle - 15)]);
            }
            Sign::Down => {
                p.line("g7-sign", &[(at, middle - 85), (at, middle + 40)]);
                p.shape("g7-mark", &[(at, middle + 95), (at - 38, middle + 15), (at + 38, middle + 15)]);
            }
            Sign::Each => p.text("g7-qual", r.x + 70, middle + 50, 140, "↻"),
            Sign::Box(text) => {
                p.line("g7-thin", &[(r.x + cell, r.y), (r.x + cell, r.y + r.h)]);
                p.text("g7-qual", r.x + 60, middle + SMALL * 35 / 100, SMALL, text);
            }
        }
    }
}

impl Sign {
    /// The width of the box of a qualifier.
    fn width(&self) -> i32 {
        match self {
            Sign::Box(text) => width(text, SMALL) + 120,
            Sign::Nothing | Sign::Up | Sign::Down | Sign::Each => 0,
        }
    }
}

/// Draws the rectangle of an enclosed chart.
fn cut_box(p: &mut Picture, x: i32, y: i32, w: i32, h: i32) {
    let (c, r, b) = (80, x + w, y + h);
    p.shape(
        "g7-action",
        &[(x + c, y), (r - c, y), (r, y + c), (r, b - c), (r - c, b), (x + c, b), (x, b - c), (x, y + c)],
    );
}

/// Draws the stub over a rectangle, with a flag for an event.
#[inline(never)]
fn draw_stub(p: &mut Picture, stub: &Stub, x: i32, y: i32) {
    let (lines, event) = match stub {
        Stub::Condition(lines) => (lines, false),
        Stub::Event(lines) => (lines, true),
    };
    let (up, height) = stack(lines, SMALL);
    let top = y - height - 60;
    p.line("g7-thin", &[(x, y), (x, top)]);
    let text = if event {
        p.shape("g7-mark", &[(x, top), (x + 110, top + 45), (x, top + 90)]);
        x + BESIDE_FLAG
    } else {
        x + BESIDE_STUB
    };
    p.lines("g7-cond", (text, top + up), SMALL, lines);
}
