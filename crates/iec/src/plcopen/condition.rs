//! The condition of a transition: written in any language, given by name, or wired.

use g7_model::codes;
use g7_model::{ChartItem, Expr, Name, Section, Stmt, StmtKind, say};

use super::draft::{Draft, Maker, block};
use super::graph::Slot;
use super::network;
use super::tree::{self, Language, Xml, head, kid, text, word};
use crate::nodes::{self, line};
use crate::xml::attr;
use crate::{il, st};

impl<'a> Maker<'_, '_, '_, 'a> {
    pub(super) fn condition(&mut self, draft: &mut Draft<'_, 'a>, index: usize) -> Expr {
        let Some(object) = draft.graph.get(index) else { return nodes::bad(Default::default()) };
        let node = object.node;
        let at = self.coder.report.span(&head(node));
        let condition = kid(node, "condition");
        let value = match condition {
            Some(c) if kid(c, "reference").is_some() => self.named_condition(draft, c),
            Some(c) if kid(c, "inline").is_some() => {
                let inline = kid(c, "inline").unwrap_or(c);
                tree::body(inline).and_then(|(language, body)| self.value(draft, language, body, None))
            }
            _ if object.inputs.iter().any(|i| i.slot == Slot::Condition) => {
                let (value, before) = network::condition(draft.graph, object, self.coder.report);
                self.before(draft, before, node);
                value.map(|v| self.coder.expr(v, &draft.place))
            }
            _ => None,
        };
        let Some(value) = value else {
            self.coder.say(&codes::BAD_TEXT, node, say!("a transition without a condition"));
            return nodes::bad(at);
        };
        let by_wire = object.inputs.iter().any(|i| i.slot == Slot::Condition && i.negated);
        let negated = condition.is_some_and(|c| tree::flag(c, "negated")) && !by_wire;
        if negated || tree::flag(node, "negated") { nodes::not(value, at) } else { value }
    }

    /// A condition that is the name of a transition of the unit or of a variable.
    fn named_condition(&mut self, draft: &mut Draft<'_, 'a>, condition: Xml<'a>) -> Option<Expr> {
        let reference = kid(condition, "reference")?;
        let written = text(reference, "name")?;
        let name = written.text.trim();
        let known = self.coder.plan.pou(draft.unit).and_then(|pou| {
            pou.transitions
                .iter()
                .copied()
                .find(|t| word(*t, "name").is_some_and(|n| n.eq_ignore_ascii_case(name)))
        });
        if let Some(transition) = known {
            let (language, body) = tree::body(transition)?;
            return self.value(draft, language, body, Some(name));
        }
        // Dialects allow any expression here.
        let raw = st::expression(&written.text, &|r| written.place(&r), self.coder.report);
        Some(self.coder.expr(raw, &draft.place))
    }

    /// The value of a condition in any language.
    fn value(
        &mut self,
        draft: &mut Draft<'_, 'a>,
        language: Language,
        body: Xml<'a>,
        name: Option<&str>,
    ) -> Option<Expr> {
        let value = match language {
            Language::St => return self.st_value(draft, body, name),
            Language::Il => {
                let text = attr::content(body);
                il::expression(&text.text, &|r| text.place(&r), self.coder.report)
            }
            Language::Ld | Language::Fbd => {
                let (value, before) = network::value(body, name, self.coder.report);
                self.before(draft, before, body);
                value?
            }
            Language::Sfc => {
                self.coder.say(&codes::NOT_CARRIED, body, say!("a condition that is a chart"));
                return None;
            }
        };
        Some(self.coder.expr(value, &draft.place))
    }

    /// Reads an expression, `:= expression`, or statements that assign to the transition's name.
    fn st_value(&mut self, draft: &mut Draft<'_, 'a>, body: Xml<'a>, name: Option<&str>) -> Option<Expr> {
        let text = attr::content(body);
        let place = |r: std::ops::Range<usize>| text.place(&r);
        let bare = text.text.trim_start();
        if bare.trim().is_empty() {
            return None;
        }
        let starts = |word: &str| bare.to_uppercase().starts_with(word);
        let statements =
            starts("IF ") || starts("IF(") || starts("CASE ") || bare.trim().matches(';').count() > 1;
        let named = name.is_some_and(|n| {
            starts(&format!("{} ", n.to_uppercase())) || starts(&format!("{}:", n.to_uppercase()))
        });
        if !statements && !named {
            let skip = text.text.len() - bare.len();
            let skip = skip + if bare.starts_with(":=") { 2 } else { 0 };
            let rest = text.text.get(skip..).unwrap_or("");
            let raw = st::expression(rest, &|r| place(r.start + skip..r.end + skip), self.coder.report);
            return Some(self.coder.expr(raw, &draft.place));
        }
        let raw = st::statements(&text.text, &place, self.coder.report);
        let at = self.coder.report.span(&text.at);
        if let [Stmt { kind: StmtKind::Assign { value, .. }, .. }] = raw.as_slice() {
            return Some(self.coder.expr(value.clone(), &draft.place));
        }
        let Some(name) =
            name.map(line).filter(|n| draft.labels.insert(format!("section {}", n.to_uppercase())))
        else {
            self.coder.say(&codes::NOT_CARRIED, body, say!("a condition of several statements"));
            return None;
        };
        let mut of_section = draft.place.clone();
        of_section.locals.insert(name.to_uppercase(), name.clone());
        let statements = self.coder.statements(raw, &of_section);
        let section = Section {
            name: Name::new(name.as_str(), at),
            body: block(statements, at),
            short: false,
            at: at.into(),
        };
        draft.items.push(ChartItem::Section(section));
        Some(nodes::name(&[&name], at))
    }

    /// Blocks with memory before a condition run in every scan.
    fn before(&mut self, draft: &mut Draft<'_, 'a>, raw: Vec<Stmt>, node: Xml) {
        if raw.is_empty() {
            return;
        }
        let what =
            say!("a block with memory before a condition; it runs in every scan, before the chart evolves");
        self.coder.say(&codes::DIFFERENT, node, what);
        let mut more = self.coder.statements(raw, &draft.place);
        draft.pre.append(&mut more);
    }
}
