//! The charts: each on its sheets, and its steps and transitions in a table with all texts in full.

use g7_draw::{End, Options, Page, Paper, Sheet, sheets};
use g7_model::{Chart, ChartKind, Document, Language, Step, StepKind, Transition};
use g7_rig::Source;

use crate::data::{Dossier, Entry, Head, Input, title_block};
use crate::flow::{Flow, options};
use crate::table::Table;
use crate::words::{self, fill};

/// Draws charts on sheets of paper, with title blocks, and nothing else.
pub fn print(
    source: &Source,
    charts: &[&Chart],
    options: &Options,
    paper: Paper,
    head: &Head,
    language: Language,
) -> Dossier {
    let document = source.whole();
    let mut outline = Vec::new();
    let mut drawn: Vec<(String, String, Sheet)> = Vec::new();
    for chart in charts {
        let made = sheets(document, chart, options, &paper, drawn.len() + 1);
        let of = made.len();
        outline.push(Entry { level: 0, title: title(chart, language), page: drawn.len() + 1 });
        let sheets =
            (1..).zip(made).map(|(n, sheet)| (heading(chart, n, of, language), remark(chart), sheet));
        drawn.extend(sheets);
    }
    let of = drawn.len();
    let page = |(n, (heading, remark, sheet)): (usize, (String, String, Sheet))| {
        let mut page = Page::new(paper, &title_block(head, &source.name, &heading, (n, of), language));
        page.heading(&heading, &remark);
        page.draw(&sheet.drawing, sheet.scale);
        page
    };
    let pages = (1..).zip(drawn).map(page).collect();
    Dossier { pages, paper, outline, pictures: Vec::new(), title: head.title_of(&source.name).to_owned() }
}

/// The charts of a file and of those that it uses; of the library none.
pub(crate) fn charts(source: &Source) -> impl Iterator<Item = &Chart> {
    source.whole().charts().filter(|c| !source.is_of_library(c.at.0))
}

fn title(chart: &Chart, language: Language) -> String {
    let template = match chart.kind {
        ChartKind::Chart => words::CHART,
        ChartKind::Expansion => words::EXPANSION,
        ChartKind::Task => words::TASK,
    };
    fill(language.told(template), &[&chart.name.text])
}

fn heading(chart: &Chart, n: usize, of: usize, language: Language) -> String {
    let title = title(chart, language);
    if of < 2 {
        return title;
    }
    format!("{title} {}", fill(language.told(words::SHEET_OF), &[&n.to_string(), &of.to_string()]))
}

fn remark(chart: &Chart) -> String {
    chart.comment.as_deref().map_or(String::new(), |c| format!("“{c}”"))
}

/// The part of the dossier.
pub(crate) fn section(flow: &mut Flow, input: &Input<'_>) {
    let told = |word| input.language.told(word);
    let document = input.source.whole();
    let mut first = true;
    for chart in charts(input.source) {
        let made = sheets(document, chart, &options(input), &input.paper, flow.page() + 1);
        let of = made.len();
        let mut at: Vec<(End, usize)> = Vec::new();
        for (n, sheet) in (1..).zip(made) {
            let heading = heading(chart, n, of, input.language);
            let Sheet { drawing, symbols, scale, .. } = sheet;
            flow.drawing(&title(chart, input.language), &heading, &remark(chart), drawing, scale);
            if std::mem::take(&mut first) {
                flow.mark(0, told(words::CHARTS));
            }
            if n == 1 {
                flow.mark(1, &title(chart, input.language));
            }
            at.extend(symbols.into_iter().map(|s| (s, flow.page())));
        }
        flow.next(&title(chart, input.language));
        flow.heading(1, &fill(told(words::OF_CHART), &[&chart.name.text]));
        if let Some(comment) = &chart.comment {
            flow.text(&format!("“{comment}”"));
        }
        let page = |of: End| at.iter().find(|(s, _)| *s == of).map_or(String::new(), |(_, p)| p.to_string());
        steps(flow, input, chart, &page);
        transitions(flow, input, chart, &page);
        remarks(flow, input, document, chart);
    }
    if first {
        flow.part(told(words::CHARTS));
        flow.text(told(words::NONE));
    }
}

/// The words of the text, on one line.
pub(crate) fn written(input: &Input<'_>, at: g7_model::Span) -> String {
    input.source.written(at).split_whitespace().collect::<Vec<_>>().join(" ")
}

fn steps(flow: &mut Flow, input: &Input<'_>, chart: &Chart, page: &dyn Fn(End) -> String) {
    let told = |word| input.language.told(word);
    let mut table = Table::new(&[
        (told(words::STEP), 18),
        (told(words::COMMENT), 32),
        (told(words::ACTIONS), 60),
        (told(words::SHEET), 10),
    ]);
    for (n, step) in (0..).zip(chart.steps()) {
        let actions: Vec<String> = step.actions.iter().map(|a| written(input, a.at.0)).collect();
        let name = [step.name.text.to_string(), kind(step, input.language)];
        let name: Vec<String> = name.into_iter().filter(|t| !t.is_empty()).collect();
        let comment = step.comment.as_deref().unwrap_or_default().to_owned();
        table.row(vec![name.join("\n"), comment, actions.join("\n"), page(End::Step(n))]);
    }
    if !table.is_empty() {
        table.write(flow);
    }
}

/// The kind of a step, and its marks.
fn kind(step: &Step, language: Language) -> String {
    let told = |word| language.told(word).to_owned();
    let mut kinds = Vec::new();
    match &step.kind {
        StepKind::Plain => {}
        StepKind::Entry => kinds.push(told(words::ENTRY)),
        StepKind::Exit => kinds.push(told(words::EXIT)),
        StepKind::Macro(of) => kinds.push(fill(language.told(words::MACRO), &[&of.text])),
        StepKind::Enclosing => kinds.push(told(words::ENCLOSING)),
    }
    if step.initial {
        kinds.push(told(words::INITIAL));
    }
    if step.linked {
        kinds.push(told(words::LINKED));
    }
    kinds.join(", ")
}

/// A transition as lists name it: its label, its steps.
pub(crate) fn named(t: &Transition) -> String {
    let list = |names: &[g7_model::Name]| {
        let names: Vec<&str> = names.iter().map(|n| &*n.text).collect();
        if names.is_empty() { "–".to_owned() } else { names.join(", ") }
    };
    let steps = format!("{} → {}", list(&t.from), list(&t.to));
    t.label.as_ref().map_or(steps.clone(), |label| format!("{}: {steps}", label.text))
}

fn transitions(flow: &mut Flow, input: &Input<'_>, chart: &Chart, page: &dyn Fn(End) -> String) {
    let told = |word| input.language.told(word);
    let mut table = Table::new(&[
        (told(words::TRANSITION), 30),
        (told(words::RECEPTIVITY), 50),
        (told(words::COMMENT), 30),
        (told(words::SHEET), 10),
    ]);
    for (n, t) in (0..).zip(chart.transitions()) {
        let mut name = named(t);
        if let Some(priority) = t.priority {
            name.push_str(&format!("\n{} {priority}", told(words::PRIORITY)));
        }
        let mut receptivity = written(input, t.receptivity.at.0);
        if let Some(block) = &t.on_clearing {
            receptivity.push_str(&format!("\n{}: {}", told(words::CLEARING), written(input, block.at.0)));
        }
        let comment = t.comment.as_deref().unwrap_or_default().to_owned();
        table.row(vec![name, receptivity, comment, page(End::Transition(n))]);
    }
    if !table.is_empty() {
        table.write(flow);
    }
}

/// The comments of the layout section in full: the drawing shows a part of a long one.
fn remarks(flow: &mut Flow, input: &Input<'_>, document: &Document, chart: &Chart) {
    let mut comments = g7_draw::comments(document, chart).peekable();
    if comments.peek().is_some() {
        flow.sized(input.language.told(words::REMARKS), crate::flow::TEXT, "g7-cond");
    }
    comments.for_each(|(text, _)| flow.text(&format!("“{text}”")));
}
