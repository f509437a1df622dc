//! Receptivities and actions in the languages of controllers: converts them to Structured Text,
//! Instruction List and Ladder, and back.

use g7_compile::symbols::Symbols;
use g7_draw::{Element, Rung};
use g7_iec::ld::{self, Coil};
use g7_model::{
    ActionKind, Document, Expr, ExprKind, FileId, Item, Path, Said, Stmt, StmtKind, Target, Type, UnaryOp,
    Work, say,
};
use g7_syntax::{il, ladder, print_expr, print_statements};

use crate::file::File;
use crate::ids::{self, Thing};

/// A language of controllers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tongue {
    /// Structured Text.
    St,
    /// Instruction List.
    Il,
    /// Ladder.
    Ld,
}

/// A receptivity, a condition or a body.
#[derive(Debug)]
pub struct Piece {
    /// The part of the symbol that it is.
    pub part: Part,
    /// The number of the action in its step.
    pub index: Option<usize>,
    /// The text; absent if the language cannot express the piece.
    pub text: Option<String>,
    /// The drawing as SVG, for Ladder.
    pub picture: Option<String>,
}

/// A part of a symbol that contains logic.
#[derive(Clone, Copy, Debug)]
pub enum Part {
    /// The receptivity of a transition.
    Receptivity,
    /// The condition of an action.
    Condition,
    /// The event of a stored action.
    Event,
    /// The statements of an action.
    Body,
}

/// The logic of a transition, of an action, or of all actions of a step, in one of the languages.
pub fn logic(file: &File, id: &str, tongue: Tongue) -> Result<Vec<Piece>, Said> {
    match tongue {
        Tongue::St => structured(file, id),
        Tongue::Il => pieces(file, id, &|e| (Some(il::show_expr(e)), None), &|s| (il::show(s), None)),
        Tongue::Ld => {
            let symbols = g7_compile::compile(file.source.whole()).0.map(|c| c.symbols);
            let boolean = |e: &Expr| is_boolean(e, symbols.as_ref());
            let drawn = |text: Option<String>| {
                let picture = text.as_deref().and_then(picture);
                (text, picture)
            };
            let condition = |e: &Expr| drawn(Some(ladder::show_expr(e)));
            pieces(file, id, &condition, &|s| drawn(ladder::show(s, &boolean)))
        }
    }
}

/// The same in Structured Text, for whoever has not the other languages.
pub fn structured(file: &File, id: &str) -> Result<Vec<Piece>, Said> {
    pieces(file, id, &|e| (Some(print_expr(e)), None), &|s| (Some(print_statements(s)), None))
}

/// A text, and its drawing.
type Written = (Option<String>, Option<String>);

/// The pieces of a symbol, written by these functions.
fn pieces(
    file: &File,
    id: &str,
    condition: &dyn Fn(&Expr) -> Written,
    body: &dyn Fn(&[Stmt]) -> Written,
) -> Result<Vec<Piece>, Said> {
    let document = &file.source.document;
    let (_, thing) =
        ids::things(document).find(|(_, t)| t.id() == id).ok_or_else(|| say!("there is no `{id}`"))?;
    let show = Show { document, condition, body };
    Ok(match thing {
        Thing::Transition(chart, n) => match chart.transitions().nth(n) {
            Some(t) => {
                let body = t.on_clearing.iter().map(|b| show.body(None, &b.statements));
                [show.condition(Part::Receptivity, None, &t.receptivity)].into_iter().chain(body).collect()
            }
            None => Vec::new(),
        },
        Thing::Step(_, step) => {
            (0..step.actions.len()).flat_map(|i| show.action(i, &step.actions[i].kind)).collect()
        }
        Thing::Action(_, step, i) => step.actions.get(i).map_or_else(Vec::new, |a| show.action(i, &a.kind)),
    })
}

/// Reads a condition in one of the languages and returns it as an expression of a .g7 text.
pub fn read(tongue: Tongue, text: &str) -> Result<String, Said> {
    let (expr, problems) = match tongue {
        Tongue::St => g7_syntax::parse_expr(text, FileId(0)),
        Tongue::Il => il::expression(text, FileId(0)),
        Tongue::Ld => ladder::expression(text, FileId(0)),
    };
    match problems.into_iter().next() {
        Some(p) => {
            let before = text.get(..p.at.start as usize).unwrap_or(text);
            let line = before.matches('\n').count() + 1;
            Err(say!("line {line}: {}", p.what))
        }
        None if matches!(expr.kind, ExprKind::Bad) => Err(say!("there is no logic in this text")),
        None => Ok(print_expr(&expr)),
    }
}

/// A name without the brackets in it: `m.x` for `m[i].x`.
fn without_indexes(name: &str) -> String {
    let mut depth = 0_u32;
    let outside = |c: &char| {
        let inner = depth > 0;
        match c {
            '[' => depth += 1,
            ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        !inner && *c != '['
    };
    name.chars().filter(outside).collect()
}

/// True if a variable or call is a BOOL: by its declaration, otherwise by the spelling of names of
/// steps and of members of blocks.
fn is_boolean(e: &Expr, symbols: Option<&Symbols>) -> bool {
    let text = print_expr(e);
    // With a variable index, any element of the array tells the type.
    let array = matches!(e.kind, ExprKind::Element(..)).then(|| without_indexes(&text));
    let named = |name: &str| name == text || array.as_deref().is_some_and(|a| without_indexes(name) == a);
    let declared = symbols.and_then(|s| s.variables.iter().find(|v| named(&v.name)));
    match declared {
        Some(v) => v.ty == Type::Bool,
        None => !matches!(text.rsplit('.').next(), Some("t" | "s" | "ET" | "CV" | "PT" | "PV")),
    }
}

struct Show<'a> {
    document: &'a Document,
    condition: &'a dyn Fn(&Expr) -> Written,
    body: &'a dyn Fn(&[Stmt]) -> Written,
}

impl Show<'_> {
    fn action(&self, index: usize, kind: &ActionKind) -> Vec<Piece> {
        let mut pieces = Vec::new();
        match kind {
            ActionKind::Qualified { target, condition, .. } => {
                if let Some(e) = condition {
                    pieces.push(self.condition(Part::Condition, Some(index), e));
                }
                match target {
                    Target::Work(work) => pieces.push(self.work(index, work)),
                    Target::Path(path) => pieces.extend(self.named(path).map(|s| self.body(Some(index), s))),
                    Target::Element(_) | Target::Direct(..) => {}
                }
            }
            ActionKind::OnEvent { event, work } => {
                pieces.push(self.condition(Part::Event, Some(index), event));
                pieces.push(self.work(index, work));
            }
            ActionKind::EachScan { work, condition } => {
                if let Some(e) = condition {
                    pieces.push(self.condition(Part::Condition, Some(index), e));
                }
                pieces.push(self.work(index, work));
            }
            ActionKind::Order(_) | ActionKind::Comment(_) => {}
        }
        pieces
    }

    fn work(&self, index: usize, work: &Work) -> Piece {
        self.body(Some(index), work.statements())
    }

    /// The statements of the named action that a path refers to.
    fn named(&self, path: &Path) -> Option<&[Stmt]> {
        let [name] = path.names.as_slice() else { return None };
        self.document.items.iter().find_map(|item| match item {
            Item::Action(a) if a.name.text == name.text => Some(a.body.block().statements.as_slice()),
            _ => None,
        })
    }

    fn condition(&self, part: Part, index: Option<usize>, e: &Expr) -> Piece {
        let (text, picture) = (self.condition)(e);
        Piece { part, index, text, picture }
    }

    fn body(&self, index: Option<usize>, statements: &[Stmt]) -> Piece {
        let (text, picture) = (self.body)(statements);
        Piece { part: Part::Body, index, text, picture }
    }
}

/// Draws rungs in the Ladder notation of .g7.
fn picture(text: &str) -> Option<String> {
    let (rungs, problems) = ladder::read(text, FileId(0));
    let drawn = |r: &ld::Rung| Rung {
        label: r.label.as_ref().map_or_else(String::new, |l| l.text.to_string()),
        elements: elements(&r.elements),
        ..Rung::default()
    };
    problems.is_empty().then(|| g7_draw::rungs(&rungs.iter().map(drawn).collect::<Vec<_>>()))
}

fn elements(list: &[ld::Element]) -> Vec<Element> {
    list.iter().map(element).collect()
}

fn element(e: &ld::Element) -> Element {
    match e {
        ld::Element::Contact(e) => {
            let (sign, inner) = match &e.kind {
                ExprKind::Unary(UnaryOp::Not, inner) => ("/", &**inner),
                ExprKind::Unary(UnaryOp::Rise, inner) => ("P", &**inner),
                ExprKind::Unary(UnaryOp::Fall, inner) => ("N", &**inner),
                _ => ("", e),
            };
            Element::Contact { sign, text: print_expr(inner) }
        }
        ld::Element::Coil(coil, _) => {
            let (sign, text) = match coil {
                Coil::Assign(e, false) => ("", print_expr(e)),
                Coil::Assign(e, true) => ("/", print_expr(e)),
                Coil::Latch(e, true) => ("S", print_expr(e)),
                Coil::Latch(e, false) => ("R", print_expr(e)),
                Coil::Edge(e, UnaryOp::Rise) => ("P", print_expr(e)),
                Coil::Edge(e, _) => ("N", print_expr(e)),
                Coil::Statement(s) => ("", statement(s)),
                Coil::Jump(to) => ("", format!("JMP {}", to.text)),
                Coil::Return => ("", "RET".to_owned()),
            };
            Element::Coil { sign, text }
        }
        ld::Element::Block { path, args, output, .. } => {
            let of = |out: bool| {
                let named = args.iter().filter(move |a| a.output == out);
                named
                    .filter_map(|a| Some((a.name.as_ref()?.text.to_string(), print_expr(&a.value))))
                    .collect()
            };
            // The argument without a name is the pin through which power enters.
            let power = args.iter().find(|a| a.name.is_none()).map(|a| print_expr(&a.value));
            Element::Block {
                title: path.names.iter().map(|n| &*n.text).collect::<Vec<_>>().join("."),
                power: power.unwrap_or_default(),
                inputs: of(false),
                output: output.as_ref().map_or_else(String::new, |n| n.text.to_string()),
                outputs: of(true),
            }
        }
        ld::Element::Branch(ways, _) => Element::Branch(ways.iter().map(|w| elements(w)).collect()),
    }
}

/// A statement on one line.
fn statement(s: &Stmt) -> String {
    match &s.kind {
        StmtKind::Assign { target, value } => format!("{} := {}", print_expr(target), print_expr(value)),
        _ => print_statements(std::slice::from_ref(s)).split_whitespace().collect::<Vec<_>>().join(" "),
    }
}
