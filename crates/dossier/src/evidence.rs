//! Plants, tests, answers and problems: what was given to the dossier, as text, tables and chronograms.

use g7_draw::chronogram_picture;
use g7_draw::{Chronogram, Lane};
use g7_model::{Item, PlantItem, PropertyKind, Severity};

use crate::charts::written;
use crate::cover::missing;
use crate::data::{Answer, Input, Known, Part, Test, Verdict};
use crate::flow::Flow;
use crate::table::Table;
use crate::words::{self, fill};

/// The plants with their pictures.
pub(crate) fn plants(flow: &mut Flow, input: &Input<'_>) {
    let told = |word| input.language.told(word);
    flow.part(told(words::PLANTS));
    let mut none = true;
    for item in &input.source.whole().items {
        let Item::Plant(plant) = item else { continue };
        none = false;
        flow.heading(1, &plant.name.text);
        if let Some(comment) = &plant.comment {
            flow.text(&format!("“{comment}”"));
        }
        let view = |i: &PlantItem| if let PlantItem::View(v) = i { Some(v.file.to_string()) } else { None };
        let files: Vec<String> = plant.items.iter().filter_map(view).collect();
        if files.is_empty() {
            flow.remark(told(words::NO_VIEW));
        }
        for file in files {
            picture(flow, input, &file);
        }
        flow.written(input.source.written(plant.at.0).lines());
    }
    if none {
        flow.text(told(words::NONE));
    }
}

fn picture(flow: &mut Flow, input: &Input<'_>, file: &str) {
    let lost = |flow: &mut Flow, why: &str| {
        flow.remark(&fill(input.language.told(words::VIEW_LOST), &[file, why]));
    };
    match input.views.iter().find(|v| v.file == file).map(|v| &v.svg) {
        Some(Ok(svg)) => match size(svg) {
            Some(size) => flow.place(svg, size),
            None => lost(flow, input.language.told(words::PICTURE_BAD)),
        },
        Some(Err(why)) => lost(flow, &why.in_language(input.language)),
        None => lost(flow, "–"),
    }
}

/// The size of an SVG file: that of its view box, or its width and height.
fn size(svg: &[u8]) -> Option<[f64; 2]> {
    let text = std::str::from_utf8(svg).ok()?;
    // Drawing programs write a document type, which the reader refuses unless it is asked for.
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
    let document = roxmltree::Document::parse_with_options(text, options).ok()?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return None;
    }
    let number = |text: &str| text.trim().trim_end_matches("px").parse::<f64>().ok();
    let good = |w: f64, h: f64| (w > 0.0 && h > 0.0 && w.is_finite() && h.is_finite()).then_some([w, h]);
    if let Some(seen) = root.attribute("viewBox") {
        let numbers = seen.split([' ', ',']).filter(|t| !t.trim().is_empty()).filter_map(number);
        if let [_, _, w, h] = *numbers.collect::<Vec<_>>() {
            return good(w, h);
        }
    }
    good(number(root.attribute("width")?)?, number(root.attribute("height")?)?)
}

/// The tests with their results.
pub(crate) fn tests(flow: &mut Flow, input: &Input<'_>) {
    let told = |word| input.language.told(word);
    flow.part(told(words::TESTS));
    match &input.tests {
        Known::Missing(why) => {
            flow.text(&missing(input, Part::Tests, why));
            input.source.tests().for_each(|t| flow.text(&format!("“{}”", t.title)));
        }
        Known::Here(all) if all.is_empty() => flow.text(told(words::NONE)),
        Known::Here(all) => {
            let mut table = Table::new(&[
                (told(words::TEST), 60),
                (told(words::RESULT), 14),
                (told(words::TIME), 18),
                (told(words::SCANS), 14),
                (told(words::PLACE), 30),
            ]);
            for t in all {
                let cells =
                    [&t.title, result(input, t), &t.simulated, &t.scans.to_string(), input.place(&t.place)];
                table.row(cells.map(str::to_owned).to_vec());
            }
            table.write(flow);
            all.iter().for_each(|t| test(flow, input, t));
        }
    }
}

fn result(input: &Input<'_>, t: &Test) -> &'static str {
    input.language.told(if t.failure.is_some() { words::FAILED } else { words::PASSED })
}

fn test(flow: &mut Flow, input: &Input<'_>, t: &Test) {
    let told = |word| input.language.told(word);
    flow.heading(1, &format!("{} – {}", t.title, result(input, t)));
    if let Some(f) = &t.failure {
        flow.text(&fill(told(words::AT), &[&f.message.in_language(input.language), input.place(&f.place)]));
        flow.text(&fill(told(words::SITUATION), &[&f.situation]));
        let got: Vec<String> = f.got.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        if !got.is_empty() {
            flow.text(&fill(told(words::GOT), &[&got.join(", ")]));
        }
    }
    t.notes.iter().for_each(|n| flow.remark(&n.in_language(input.language)));
    if let Some(c) = &t.chronogram {
        chronogram(flow, input, c);
    }
}

/// Draws the signals that move, on as many sheets as they take, and names those that do not.
fn chronogram(flow: &mut Flow, input: &Input<'_>, all: &Chronogram) {
    let (moving, steady): (Vec<&Lane>, Vec<&Lane>) = all.lanes.iter().partition(|l| l.edges.len() > 1);
    let mut lanes = moving.as_slice();
    while !lanes.is_empty() {
        flow.need(LANES * LANE + AXIS);
        let count = (((flow.left() - AXIS) / LANE).max(1) as usize).min(lanes.len());
        let (now, rest) = lanes.split_at(count);
        let part = Chronogram { lanes: now.iter().map(|l| (*l).clone()).collect(), ..*all };
        let (picture, area) = chronogram_picture(&part, Some(flow.inside.w));
        flow.picture(picture, area);
        lanes = rest;
    }
    if !steady.is_empty() {
        let value = |l: &&Lane| {
            let show = l.edges.first().map_or("–", |e| &*e.show);
            format!("{} = {show}", l.name)
        };
        let list: Vec<String> = steady.iter().map(value).collect();
        flow.remark(&fill(input.language.told(words::STEADY), &[&list.join(", ")]));
    }
}

/// Height of a lane of a chronogram.
const LANE: i32 = 300;
/// Height of what stands over and under the lanes.
const AXIS: i32 = 400;
/// Lanes that begin a chronogram on a sheet.
const LANES: i32 = 4;

/// The questions with their answers.
pub(crate) fn proofs(flow: &mut Flow, input: &Input<'_>) {
    let told = |word| input.language.told(word);
    flow.part(told(words::PROOFS));
    let assumed = |p: &&g7_model::Property| matches!(p.kind, PropertyKind::Assume(_));
    let properties = || input.source.whole().properties();
    if properties().any(|p| assumed(&p)) {
        flow.heading(1, told(words::ASSUMED));
        properties().filter(assumed).for_each(|p| flow.text(&written(input, p.at.0)));
    }
    match &input.answers {
        Known::Missing(why) => {
            flow.text(&missing(input, Part::Proofs, why));
            properties().filter(|p| !assumed(p)).for_each(|p| flow.text(&written(input, p.at.0)));
        }
        Known::Here(all) if all.is_empty() => flow.text(told(words::NONE)),
        Known::Here(all) => {
            let (own, every): (Vec<&Answer>, Vec<&Answer>) = all.iter().partition(|a| a.own);
            for (heading, list) in [(words::OWN, own), (words::EVERY, every)] {
                if !list.is_empty() {
                    flow.heading(1, told(heading));
                    answers(flow, input, &list);
                }
            }
        }
    }
}

fn answers(flow: &mut Flow, input: &Input<'_>, all: &[&Answer]) {
    let told = |word| input.language.told(word);
    let mut table = Table::new(&[
        (told(words::CLAIM), 50),
        (told(words::VERDICT), 16),
        (told(words::SHOWN), 44),
        (told(words::PLACE), 24),
    ]);
    for a in all {
        let verdict = match a.verdict {
            Verdict::Proved => words::PROVED,
            Verdict::Refuted => words::REFUTED,
            Verdict::Open => words::OPEN,
        };
        let mut reason = a.reason.in_language(input.language);
        if !a.help.is_empty() {
            let help = fill(told(words::HELP), &[&a.help.in_language(input.language)]);
            reason = format!("{reason}\n{help}");
        }
        let claim = a.claim.in_language(input.language);
        table.row(vec![claim, told(verdict).to_owned(), reason, input.place(&a.place).to_owned()]);
    }
    table.write(flow);
}

/// The problems of the text.
pub(crate) fn problems(flow: &mut Flow, input: &Input<'_>) {
    let told = |word| input.language.told(word);
    flow.part(told(words::PROBLEMS));
    if input.problems.is_empty() {
        flow.text(told(words::FINE));
        return;
    }
    let mut table = Table::new(&[
        (told(words::SEVERITY), 18),
        (told(words::CODE), 12),
        (told(words::MESSAGE), 74),
        (told(words::PLACE), 28),
    ]);
    for p in &input.problems {
        let severity = match p.severity() {
            Severity::Error => words::ERROR,
            Severity::Warning => words::WARNING,
        };
        let mut what = p.what.in_language(input.language);
        if let Some(help) = &p.help {
            what = format!("{what}\n{}", fill(told(words::HELP), &[&help.in_language(input.language)]));
        }
        table.row(vec![
            told(severity).to_owned(),
            p.code.id.to_owned(),
            what,
            input.place(&input.source.place(p.at)).to_owned(),
        ]);
    }
    table.write(flow);
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_size_is_that_of_the_root_whatever_stands_before_and_in_it() {
        let size = |text: &str| super::size(text.as_bytes());
        let open = "xmlns='http://www.w3.org/2000/svg'";
        assert_eq!(size(&format!("<svg {open} viewBox='0 0 30,20'/>")), Some([30.0, 20.0]));
        assert_eq!(size(&format!("<svg {open} width='40px' height='10'/>")), Some([40.0, 10.0]));
        let commented =
            format!("<!-- <svg viewBox='0 0 1 1'> --><svg {open} data-a='>' viewBox='0 0 30 20'/>");
        assert_eq!(size(&commented), Some([30.0, 20.0]));
        assert_eq!(size(&format!("<!DOCTYPE svg><svg {open} viewBox='0 0 3 2'/>")), Some([3.0, 2.0]));
        for bad in [
            "",
            "no picture",
            "<svg",
            "<html/>",
            "<svg/>",
            "<svg viewBox='0 0 0 5'/>",
            "<svg width='a' height='1'/>",
        ] {
            assert_eq!(size(bad), None, "{bad}");
        }
    }
}
