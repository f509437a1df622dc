//! Changes charts and the lists of their items.

use g7_model::{Chart, ChartItem, Span};
use g7_syntax::{Part, TokenKind, chart_items_apart, print_part};

use super::item;
use super::lines::{Sheet, reindent};
use super::list::{Block, Style, changed, list};
use crate::draft::{Draft, is_fresh};

/// Changes a chart in place.
pub(crate) fn edit(sheet: &mut Sheet<'_>, draft: &Draft<'_>, old: &Chart, new: &Chart) {
    let (start, end) = (old.at.0.start as usize, old.at.0.end as usize);
    let (head, Some(open)) = sheet.header(start, end) else { return };
    if old.comment != new.comment {
        // Parameters and the function block stand before the comment, the period behind it.
        let named = head.iter().take_while(|t| t.kind != TokenKind::Comment && sheet.word(t) != "every");
        let end = named.last().map_or(start, |t| t.end);
        sheet.put_comment(&head, end, new.comment.as_deref());
    }
    let outer = sheet.indent(start);
    let block = Block { open: Some(open.end), close: end - 1, indent: format!("{outer}  "), outer };
    list(sheet, &old.items, &new.items, &block, &Items { draft });
}

/// The text of a new chart; its items may come from elsewhere in the text.
#[inline(never)]
pub(crate) fn fresh(sheet: &Sheet<'_>, draft: &Draft<'_>, chart: &Chart) -> String {
    let bare = Chart { items: Vec::new(), ..chart.clone() };
    let mut out = print_part(Part::Item(&g7_model::Item::Chart(bare)), None);
    if chart.items.is_empty() {
        return out;
    }
    out.truncate(out.trim_end_matches('}').len());
    let style = Items { draft };
    let mut before: Option<&ChartItem> = None;
    for item in &chart.items {
        let apart = before.is_some_and(|b| style.apart(b, item));
        out.push_str(if apart { "\n\n" } else { "\n" });
        out.push_str(&style.fresh(sheet, item, "  "));
        before = Some(item);
    }
    out.push_str("\n}");
    out
}

/// How the items of a chart are written.
struct Items<'d, 's> {
    draft: &'d Draft<'s>,
}

impl Items<'_, '_> {
    /// The original of an item that was moved from elsewhere in the text.
    fn origin(&self, item: &ChartItem) -> Option<&ChartItem> {
        let at = self.at(item);
        if is_fresh(at.into()) {
            return None;
        }
        let charts = self.draft.source.document.charts();
        charts.flat_map(|c| &c.items).find(|i| self.at(i).start == at.start)
    }
}

impl Style<ChartItem> for Items<'_, '_> {
    fn at(&self, thing: &ChartItem) -> Span {
        thing.at()
    }

    fn edit(&self, sheet: &mut Sheet<'_>, old: &ChartItem, new: &ChartItem) {
        match (old, new) {
            (ChartItem::Step(a), ChartItem::Step(b)) => item::edit_step(sheet, self.draft, a, b),
            (ChartItem::Transition(a), ChartItem::Transition(b)) => {
                item::edit_transition(sheet, self.draft, a, b);
            }
            (ChartItem::Var(a), ChartItem::Var(b)) => item::edit_variable(sheet, self.draft, a, b),
            _ => {}
        }
    }

    fn lead(&self, old: &ChartItem, new: &ChartItem) -> Option<String> {
        let (ChartItem::Transition(a), ChartItem::Transition(b)) = (old, new) else { return None };
        (a.chained && !b.chained).then(|| {
            let label = b.label.as_ref().map(|l| print_part(Part::Label(l), None) + " ");
            format!("{}{} ", label.unwrap_or_default(), print_part(Part::Steps(&b.from), None))
        })
    }

    #[inline(never)]
    fn fresh(&self, sheet: &Sheet<'_>, new: &ChartItem, indent: &str) -> String {
        if let Some(old) = self.origin(new) {
            let lead = self.lead(old, new);
            let deeper = if lead.is_none() && self.inner(new) { "  " } else { "" };
            let own = sheet.indent(self.at(old).start as usize).to_owned();
            let text = lead.unwrap_or_default() + &changed(sheet, self, old, new);
            return format!("{indent}{deeper}{}", reindent(&text, &own, indent, sheet.newline));
        }
        let typed = |at| self.draft.typed(at);
        let text = typed(self.at(new)).unwrap_or_else(|| print_part(Part::ChartItem(new), Some(&typed)));
        format!("{indent}{}", reindent(&text, "", indent, sheet.newline))
    }

    fn apart(&self, a: &ChartItem, b: &ChartItem) -> bool {
        chart_items_apart(a, b)
    }

    fn inner(&self, thing: &ChartItem) -> bool {
        matches!(thing, ChartItem::Transition(t) if t.chained)
    }
}
