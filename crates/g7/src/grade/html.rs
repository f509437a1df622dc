//! The pages: `index.html` for the teacher, and one for each submission, which its author may be given.
//!
//! A page of a submission tells of a hidden test and a hidden question no more than whether it passed: its title, its
//! place and its chronogram stand in the teacher's page alone, and so do the names of others whose charts are the same.

use std::collections::BTreeSet;

use g7_draw::Options;
use g7_grade::{Ended, Exercise, Graded, Mark, Tested};
use g7_model::{Said, say};
use g7_rig::testing::Sort;

use super::pages::MARK;
use super::rows::{Row, Rows};
use super::table::{alike, answer, counted, errors, notes, percent};
use crate::failure::raw;
use crate::message::told;
use crate::testing::escape;
use crate::tongue::language;

const STYLE: &str = include_str!("page.css");

/// The pages by their file names.
pub(super) fn pages(exercise: &Exercise, all: &Rows) -> Vec<(String, String)> {
    let rows = &all.rows;
    let mut taken = BTreeSet::from(["index.html".to_owned()]);
    let names: Vec<String> = rows.iter().map(|row| file_name(&row.name, &mut taken)).collect();
    let mut pages = vec![("index.html".to_owned(), index(exercise, all, &names))];
    pages.extend(rows.iter().zip(&names).map(|(row, name)| (name.clone(), page(exercise, row))));
    pages
}

/// A name of a page that no other one has, in letters that every system and every address takes.
fn file_name(name: &str, taken: &mut BTreeSet<String>) -> String {
    let stem = name.strip_suffix(".g7").unwrap_or(name);
    let plain = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_') { c } else { '_' };
    let stem: String = stem.chars().map(plain).take(80).collect();
    let numbered = (2..).map(|n| format!("{stem}-{n}.html"));
    let mut names = std::iter::once(format!("{stem}.html")).chain(numbered);
    // Where names differ in case alone, some systems have one file for both.
    let free = names.find(|n| !taken.contains(&n.to_lowercase())).unwrap_or_default();
    taken.insert(free.to_lowercase());
    free
}

fn text(what: &Said) -> String {
    escape(&told(what))
}

fn frame(title: &str, body: &str) -> String {
    let (title, language) = (escape(title), language().tag());
    format!(
        "<!DOCTYPE html>\n<html lang=\"{language}\">\n<head>\n<meta charset=\"utf-8\">\n{MARK}\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n"
    )
}

/// The class of a result, for its colour.
fn class(mark: Mark) -> &'static str {
    match mark {
        Mark::Passed => "good",
        Mark::Changed | Mark::Fitted => "warn",
        Mark::Failed | Mark::Unread => "bad",
    }
}

/// The page of the teacher.
fn index(exercise: &Exercise, all: &Rows, names: &[String]) -> String {
    let rows = &all.rows;
    let title = exercise.statement.title(language());
    let mut body = format!("<h1>{}</h1>\n", escape(title));
    body += &format!("<p>{}</p>\n", text(&counted(all)));
    let warning = say!("this page tells the hidden tests; the others do not");
    body += &format!("<p class=\"faint\">{}</p>\n<div class=\"wide\"><table>\n<thead><tr>", text(&warning));
    let heads = [say!("submission"), say!("result"), say!("tests"), say!("coverage"), say!("questions")];
    heads.iter().for_each(|head| body += &format!("<th scope=\"col\">{}</th>", text(head)));
    body += "</tr></thead>\n<tbody>\n";
    rows.iter().zip(names).for_each(|(row, name)| body += &line(row, name));
    body += "</tbody>\n</table></div>\n";
    body += &list(&say!("Alike"), all.groups.iter().map(|group| told(&alike(group))).collect());
    frame(title, &body)
}

/// A submission in the page of the teacher.
fn line(row: &Row, page: &str) -> String {
    let mut cells = [String::new(), String::new(), String::new()];
    if let Ok(graded) = &row.graded
        && row.mark() != Mark::Unread
    {
        let ((passed, all), (proved, questions)) = (graded.passed(), graded.proved());
        cells = [
            format!("{passed}/{all}"),
            format!("{}&nbsp;%", percent(graded)),
            format!("{proved}/{questions}"),
        ];
    }
    let [tests, coverage, questions] = cells;
    let mut line = format!(
        "<tr><th scope=\"row\"><a href=\"{page}\">{}</a></th><td class=\"{}\">{}</td><td class=\"number\">{tests}</td>\
         <td class=\"number\">{coverage}</td><td class=\"number\">{questions}</td></tr>\n",
        escape(&row.name),
        class(row.mark()),
        text(&row.mark().said()),
    );
    let notes: Vec<String> = notes(row).iter().map(|n| format!("<li>{}</li>", escape(n))).collect();
    if !notes.is_empty() {
        let first = row.first_failing().map(first).unwrap_or_default();
        line +=
            &format!("<tr class=\"more\"><td colspan=\"5\"><ul>{}</ul>{first}</td></tr>\n", notes.concat());
    }
    line
}

/// The first failing test, with its chronogram folded in.
fn first(test: &Tested) -> String {
    let title = format!("{}: {}", text(&say!("first failing test")), escape(&test.title));
    match &test.ended {
        Ended::Failed(_) => format!("<details><summary>{title}</summary>{}</details>", failure(test)),
        Ended::Blocked { .. } | Ended::Passed => title,
    }
}

/// The page of a submission.
fn page(exercise: &Exercise, row: &Row) -> String {
    let title = format!("{} – {}", row.name, exercise.statement.title(language()));
    let (mark, result) = (class(row.mark()), text(&row.mark().said()));
    let mut body = format!("<h1>{}</h1>\n<p class=\"result {mark}\">{result}</p>\n", escape(&title));
    match &row.graded {
        Err(why) => body += &format!("<p>{}</p>\n", text(why)),
        Ok(graded) => {
            body += &list(&say!("Errors"), errors(graded));
            let place = |place: &str, what: &Said| format!("{place}: {}", told(what));
            body += &list(
                &say!("Locked parts"),
                graded.changed.iter().map(|c| place(&c.place, &c.what)).collect(),
            );
            body += &list(&say!("Names"), graded.lacks.iter().map(|l| told(&l.said())).collect());
            if row.mark() != Mark::Unread {
                body += &tests(graded);
                body += &questions(graded);
                body += &coverage(graded);
            }
            body += &drawing(graded);
        }
    }
    frame(&title, &body)
}

/// A heading with a list; nothing without items.
fn list(head: &Said, items: Vec<String>) -> String {
    if items.is_empty() {
        return String::new();
    }
    let items: Vec<String> = items.iter().map(|i| format!("<li>{}</li>", escape(i))).collect();
    format!("<h2>{}</h2>\n<ul>{}</ul>\n", text(head), items.concat())
}

fn tests(graded: &Graded) -> String {
    let mut out = format!("<h2>{}</h2>\n<ul class=\"tests\">\n", text(&say!("Tests")));
    let mut hidden = 0;
    for test in &graded.tests {
        let passed = test.ended.is_passed();
        let (mark, word) = if passed { ("good", say!("passed")) } else { ("bad", say!("failed")) };
        let title = if test.hidden {
            hidden += 1;
            told(&say!("hidden test {hidden}"))
        } else {
            test.title.clone()
        };
        let why = if passed || test.hidden { String::new() } else { failure(test) };
        out += &format!("<li><b class=\"{mark}\">{}</b> {}{why}</li>\n", text(&word), escape(&title));
    }
    out + "</ul>\n"
}

/// Why a test failed: what was expected and what was there, the situation, the signals that led to it.
fn failure(test: &Tested) -> String {
    let Some(why) = test.ended.why() else { return String::new() };
    let mut out = format!("<p>{}</p>", text(&why));
    if let Ended::Failed(d) = &test.ended {
        let at = say!("at {}, {} after the start", raw(&d.place), raw(d.time.plain()));
        out += &format!("<p>{}</p>", text(&at));
        if !d.got.is_empty() {
            let got: Vec<String> = d.got.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            out += &format!("<p>{}</p>", text(&say!("got {}", raw(got.join(", ")))));
        }
        out += &format!("<p>{}</p>", text(&say!("situation {}", raw(&d.situation))));
        if !d.chronogram.is_empty() {
            out += &format!("<pre tabindex=\"0\">{}</pre>", escape(d.chronogram.trim_end()));
        }
    }
    out
}

fn questions(graded: &Graded) -> String {
    let mut hidden = 0;
    let lines = graded.questions.iter().map(|q| {
        if q.hidden {
            hidden += 1;
            return format!("{}: {}", told(&say!("hidden question {hidden}")), told(&answer(q)));
        }
        format!("{}: {} ({})", told(&answer(q)), told(&q.claim), told(&q.reason))
    });
    list(&say!("Questions"), lines.collect())
}

fn coverage(graded: &Graded) -> String {
    let sorts = graded.coverage.sorts();
    let line = |sort: Sort, reached: usize, all: usize| {
        format!("{reached} {} {all} {}", told(&say!("of")), told(&sort.plural()))
    };
    let mut lines: Vec<String> = sorts
        .iter()
        .map(|(sort, rows)| line(*sort, rows.values().filter(|r| r.hits > 0).count(), rows.len()))
        .collect();
    for (sort, rows) in &sorts {
        let left = rows.values().filter(|r| r.hits == 0);
        lines.extend(
            left.map(|row| {
                told(&say!("not reached: {} {} ({})", sort.one(), raw(&row.name), raw(&row.place)))
            }),
        );
    }
    list(&say!("Coverage"), lines)
}

/// The charts as a picture.
fn drawing(graded: &Graded) -> String {
    if graded.source.is_broken() || graded.source.document.charts().next().is_none() {
        return String::new();
    }
    let options = Options { font: false, ..Options::default() };
    let document = &graded.source.document;
    let drawings = g7_draw::draw_all(document, document.charts(), &options);
    let svg = g7_draw::sheet(document, &drawings, &options);
    format!("<h2>{}</h2>\n<div class=\"sheet\">{svg}</div>\n", text(&say!("The charts")))
}
