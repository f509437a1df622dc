//! Changes the picture of a plant. No gesture changes anything else of a plant.

use g7_model::{Binding, Expr, ExprKind, Literal, Plant, Span, View};
use g7_syntax::{print_expr, show_name};

use super::item::expr_text;
use super::lines::Sheet;
use super::list::{Block, Style, list};
use crate::draft::Draft;
use crate::gestures::binding_at;

/// Writes the picture of a plant.
#[inline(never)]
pub(crate) fn edit(sheet: &mut Sheet<'_>, draft: &Draft<'_>, old: &Plant, new: &Plant) {
    match (old.view(), new.view()) {
        (Some(a), Some(b)) if a != b => change(sheet, draft, a, b),
        (None, Some(b)) => add(sheet, draft, old, b),
        _ => {}
    }
}

/// Writes a first picture as the last item of its plant.
fn add(sheet: &mut Sheet<'_>, draft: &Draft<'_>, plant: &Plant, view: &View) {
    let (start, close) = (plant.at.0.start as usize, plant.at.0.end as usize - 1);
    let (nl, outer) = (sheet.newline, sheet.indent(start));
    let inner = format!("{outer}  ");
    let mut text = format!("{inner}view {}", quoted(view));
    if !view.bindings.is_empty() {
        text.push_str(&braces(sheet, draft, view, &inner));
    }
    if sheet.begins_line(close) {
        let at = sheet.line_start(close);
        sheet.put(at, at, text + nl);
    } else {
        let from = sheet.slice(0, close).trim_end().len();
        sheet.put(from, close, format!("{nl}{text}{nl}{outer}"));
    }
}

fn change(sheet: &mut Sheet<'_>, draft: &Draft<'_>, old: &View, new: &View) {
    let (start, end) = (old.at.0.start as usize, old.at.0.end as usize);
    let (head, open) = sheet.header(start, end);
    let Some(file) = head.get(1) else { return };
    if old.file != new.file {
        sheet.put(file.start, file.end, quoted(new));
    }
    let outer = sheet.indent(start);
    match open {
        None if new.bindings.is_empty() => {}
        None => {
            let text = braces(sheet, draft, new, outer);
            sheet.put(end, end, text);
        }
        Some(_) if new.bindings.is_empty() && !sheet.has_notes(file.end, end) => sheet.put(file.end, end, ""),
        Some(open) => {
            let block = Block { open: Some(open.end), close: end - 1, indent: format!("{outer}  "), outer };
            list(sheet, &old.bindings, &new.bindings, &block, &Bindings { draft });
        }
    }
}

/// The name of the file as the text has it.
fn quoted(view: &View) -> String {
    print_expr(&Expr { kind: ExprKind::Literal(Literal::Str(view.file.clone())), at: view.at })
}

/// All bindings in their braces.
fn braces(sheet: &Sheet<'_>, draft: &Draft<'_>, view: &View, outer: &str) -> String {
    let style = Bindings { draft };
    let mut out = " {".to_owned();
    for binding in &view.bindings {
        out.push_str(sheet.newline);
        out.push_str(&style.fresh(sheet, binding, &format!("{outer}  ")));
    }
    format!("{out}{}{outer}}}", sheet.newline)
}

/// Writes the bindings of a picture, one on each line.
struct Bindings<'d, 's> {
    draft: &'d Draft<'s>,
}

impl Style<Binding> for Bindings<'_, '_> {
    fn at(&self, thing: &Binding) -> Span {
        binding_at(thing)
    }

    fn edit(&self, sheet: &mut Sheet<'_>, old: &Binding, new: &Binding) {
        if old.value != new.value {
            let at = old.value.at.0;
            sheet.put(at.start as usize, at.end as usize, expr_text(&new.value, self.draft));
        }
    }

    fn fresh(&self, _sheet: &Sheet<'_>, new: &Binding, indent: &str) -> String {
        let (element, attribute) = (show_name(&new.element.text), show_name(&new.attribute.text));
        format!("{indent}{element}.{attribute} := {}", expr_text(&new.value, self.draft))
    }

    fn apart(&self, _: &Binding, _: &Binding) -> bool {
        false
    }
}
