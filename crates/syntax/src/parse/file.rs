//! A file and its items.

use super::Parser;
use super::marks::Level;
use crate::lexer::Tok;
use crate::quote;
use crate::words;
use g7_iec::constant;
use g7_model::{
    Block, Document, Expr, ExprKind, Fix, Function, Item, Name, NamedAction, Path, Problem, Profile,
    ProfileName, Said, Section, Stmt, StmtKind, Switch, TargetPlc, Use, codes, say,
};

impl Parser<'_> {
    /// The whole file.
    pub(crate) fn document(&mut self) -> Document {
        let mut items = Vec::new();
        self.items(&mut items);
        Document { items, notes: Vec::new() }
    }

    /// The items up to the end of the text, or to where the rest is known.
    pub(super) fn items(&mut self, items: &mut Vec<Item>) {
        loop {
            self.skip_semis();
            if self.at(Tok::End) || self.mark(items.len(), Level::File) {
                break;
            }
            let start = self.cur.start;
            match self.item() {
                Some(item) => items.push(item),
                None if self.correct(&g7_model::words::texts(g7_model::words::FILE)) => {
                    items.extend(self.item())
                }
                None => self.lost_item(start),
            }
        }
    }

    fn item(&mut self) -> Option<Item> {
        if let Some(kind) = self.var_kind() {
            return Some(Item::Var(self.line(|p| p.variable(kind))));
        }
        let start = self.cur.start;
        Some(match self.word() {
            "profile" => self.line(Parser::profile),
            "scan" => {
                let time = self.line(|p| {
                    p.bump();
                    p.duration(say!("a duration"))
                });
                Item::Cycle(time, self.since(start).into())
            }
            "target" => self.line(Parser::target),
            "use" => Item::Use(self.line(Parser::using)),
            "chart" | "macrochart" | "task" => Item::Chart(self.chart()),
            "instance" => Item::Instance(self.line(Parser::instance)),
            "struct" => Item::Composed(self.structure()),
            "type" => Item::Type(self.line(Parser::type_declaration)),
            "function" if self.at_block() => Item::Composed(self.function_block()),
            "action" => Item::Action(self.line(Parser::named_action)),
            "transition" => Item::Section(self.line(Parser::section)),
            "function" => Item::Function(self.line(Parser::function)),
            "pre" => {
                self.bump();
                let body = self.body();
                Item::Pre(body, self.since(start).into())
            }
            "post" => {
                self.bump();
                let body = self.body();
                Item::Post(body, self.since(start).into())
            }
            "plant" => Item::Plant(self.plant()),
            "test" => Item::Test(self.test()),
            "prove" => Item::Prove(self.line(Parser::property)),
            "assume" => Item::Prove(self.line(Parser::assumption)),
            "layout" => Item::Layout(self.layout()),
            _ => return None,
        })
    }

    /// Reports text that begins no item, suggests what was meant, and skips it.
    fn lost_item(&mut self, start: u32) {
        let at = self.here();
        let word = self.word();
        if self.at(Tok::RBrace) {
            self.closes_nothing();
            self.bump();
            return;
        }
        if self.foreign_block(word) {
            return;
        }
        if self.at_chart_start() {
            let help = say!("write it between the braces of a chart: `chart Main {{ … }}`");
            self.problem_help(&codes::EXPECTED, at, say!("steps and transitions stand in a chart"), help);
        } else if !word.is_empty() {
            let what = say!("no item of a file begins with `{word}`");
            self.problem_help(
                &codes::UNKNOWN_WORD,
                at,
                what,
                say!("items are variables, charts, plants, tests, …"),
            );
        } else {
            self.unexpected(say!("a variable, a chart or another item of a file"), None);
        }
        if self.cur.start == start {
            self.bump();
        }
        self.recover(|p| p.at_file_start() || p.var_kind().is_some());
        // The brace that closes the skipped text.
        if self.at(Tok::RBrace) {
            self.bump();
        }
    }

    /// Tells of a block of declarations as IEC 61131-3 has them, and passes it.
    fn foreign_block(&mut self, word: &str) -> bool {
        let item = match word.to_ascii_uppercase().as_str() {
            "VAR_INPUT" => "input",
            "VAR_OUTPUT" => "output",
            "VAR" | "VAR_GLOBAL" | "VAR_EXTERNAL" | "VAR_TEMP" | "VAR_IN_OUT" => "var",
            _ => return false,
        };
        let at = self.here();
        let what = say!("variables are declared one a line, without `{word}` and `END_VAR`");
        self.problem_help(&codes::UNKNOWN_WORD, at, what, say!("write `{item} a : BOOL`"));
        while !self.at(Tok::End) && !self.word().eq_ignore_ascii_case("END_VAR") && !self.at_file_start() {
            self.bump();
        }
        if self.word().eq_ignore_ascii_case("END_VAR") {
            self.bump();
        }
        true
    }

    fn profile(&mut self) -> Item {
        let start = self.bump().start;
        let word = self.word();
        let name = ProfileName::ALL.into_iter().find(|p| p.name() == word);
        if name.is_some() {
            self.bump();
        } else {
            let names = ProfileName::ALL.map(ProfileName::name);
            self.unknown(word, say!("a profile"), &names);
        }
        let open = self.here();
        let mut switches = Vec::new();
        if self.eat(Tok::LBrace) {
            while !matches!(self.cur.kind, Tok::RBrace | Tok::End) && !self.at_file_start() {
                let at = self.cur.start;
                if let Some(switch) = self.line(Parser::switch) {
                    switches.push((switch, self.since(at).into()));
                }
                if !self.eat(Tok::Comma) {
                    self.skip_semis();
                }
            }
            self.close(Tok::RBrace, say!("`}}` after the switches"), open);
        }
        let at = self.since(start).into();
        Item::Profile(Profile { name: name.unwrap_or_default(), switches, at })
    }

    /// Reports an unknown word and suggests one from the list; the word is skipped.
    pub(super) fn unknown(&mut self, word: &str, what: Said, list: &[&str]) {
        if word.is_empty() {
            self.expected(say!("{what}: {}", Said::foreign(list.join(", "))));
            return;
        }
        let at = self.here();
        let near = words::similar(word, list);
        self.report(at, || {
            let problem = Problem::new(&codes::UNKNOWN_WORD, at, say!("`{word}` is not {what}"));
            match near {
                Some(near) => problem.meant(near),
                None => problem.help(say!("there are {}", Said::foreign(list.join(", ")))),
            }
        });
        self.bump();
    }

    /// A switch: words joined by `-`.
    fn switch(&mut self) -> Option<Switch> {
        let start = self.cur.start;
        if !self.at(Tok::Word) {
            self.expected(say!("a switch, such as `multi-token`"));
            self.bump();
            return None;
        }
        self.bump();
        while self.at(Tok::Minus) && self.cur.start == self.prev.end && self.peek().kind == Tok::Word {
            self.bump();
            self.bump();
        }
        let at = self.since(start);
        let text = self.text_at(at);
        if text == "bound" {
            return Some(Switch::Bound(self.integer_u32(say!("the largest number of passes in a scan"))));
        }
        let found = SWITCHES.iter().find(|(name, _)| *name == text);
        if found.is_none() {
            let names = SWITCHES.map(|(name, _)| name);
            let near = words::similar(text, &names);
            self.lexer.problems.add(at, || {
                let problem = Problem::new(&codes::UNKNOWN_WORD, at, say!("there is no switch `{text}`"));
                match near {
                    Some(near) => {
                        let problem = problem.help(say!("did you mean `{near}`?"));
                        problem.fix(Fix::sure(say!("write `{near}`"), at, near))
                    }
                    None => problem.help(say!("there are {} and bound", Said::foreign(names.join(", ")))),
                }
            });
        }
        found.map(|(_, switch)| *switch)
    }

    fn target(&mut self) -> Item {
        let start = self.bump().start;
        let word = self.word();
        let found = TargetPlc::ALL.into_iter().find(|t| t.name() == word);
        if found.is_some() {
            self.bump();
        } else {
            self.unknown(word, say!("a PLC whose limits are known"), &TargetPlc::ALL.map(TargetPlc::name));
        }
        Item::Target(found.unwrap_or(TargetPlc::Tsx57), self.since(start).into())
    }

    /// True if `use` begins an item here: the name of a variable or step can be the same word.
    pub(super) fn at_use(&mut self) -> bool {
        let (first, next) = (self.cur.newline, self.peek());
        let named = matches!(next.kind, Tok::Str | Tok::Comment | Tok::Word | Tok::Ticked);
        first && named && !next.newline
    }

    /// `use 'lib/axis.g7'`, or `use debounce`.
    fn using(&mut self) -> Use {
        let start = self.bump().start;
        let token = self.cur;
        let at = self.span_of(token);
        let (name, library) = match token.kind {
            Tok::Str => {
                self.bump();
                (Name::new(self.string(token), at), false)
            }
            Tok::Comment => {
                let path = quote::unquote(self.slice(token), '"');
                self.slip_to(at, say!("a path stands in single quotes"), &constant::quote_st(&path));
                self.bump();
                (Name::new(path, at), false)
            }
            _ => {
                (self.name(say!("the path of a file in quotes, or the name of a part of the library")), true)
            }
        };
        Use { name, library, at: self.since(start).into() }
    }

    /// `action Pump { … }`.
    pub(super) fn named_action(&mut self) -> NamedAction {
        let start = self.bump().start;
        let name = self.name(say!("the name of the action"));
        let comment = self.comment_if();
        let body = self.body();
        NamedAction { name, comment, body, at: self.since(start).into() }
    }

    /// `transition section Ready …`.
    pub(super) fn section(&mut self) -> Section {
        let start = self.bump().start;
        if !self.eat_word("section") {
            self.expected_help(
                say!("`section`"),
                Some(say!("a transition is written `1 -> 2 when …`, without the word `transition`")),
            );
        }
        let name = self.name(say!("the name of the section"));
        let from = self.cur.start;
        let short = self.at(Tok::Assign) || self.at(Tok::Eq);
        let body = if short {
            self.assign_sign();
            let value = self.condition();
            short_section(&name, value, self.since(from).into())
        } else {
            self.block(say!("`{{` or `:=`"))
        };
        Section { name, body, short, at: self.since(start).into() }
    }

    fn function(&mut self) -> Function {
        let start = self.bump().start;
        let name = self.name(say!("the name of the function"));
        let params = self.params();
        let result = self.value_type();
        let body = self.block(say!("`{{` and the statements"));
        Function { name, params, result, body, at: self.since(start).into() }
    }
}

/// `:= e` as the one assignment that it stands for.
fn short_section(name: &Name, value: Expr, at: g7_model::Place) -> Block {
    let kind = ExprKind::Path(Path { names: vec![name.clone()] });
    let target = Expr { kind, at: name.at };
    let stmt = Stmt { kind: StmtKind::Assign { target, value }, at };
    Block { locals: Vec::new(), statements: vec![stmt], at }
}

/// The switches of profiles by their words, `bound` aside; the two words of a switch are neighbours.
pub const SWITCHES: [(&str, Switch); 16] = [
    ("stable", Switch::Stable(true)),
    ("one-pass", Switch::Stable(false)),
    ("multi-token", Switch::MultiToken(true)),
    ("single-token", Switch::MultiToken(false)),
    ("simultaneous", Switch::Sequential(false)),
    ("sequential", Switch::Sequential(true)),
    ("parallel-actions", Switch::ParallelActions(true)),
    ("ordered-actions", Switch::ParallelActions(false)),
    ("final-scan", Switch::FinalScan(true)),
    ("no-final-scan", Switch::FinalScan(false)),
    ("keep-step-time", Switch::KeepStepTime(true)),
    ("zero-step-time", Switch::KeepStepTime(false)),
    ("time-clock", Switch::ScanClock(false)),
    ("scan-clock", Switch::ScanClock(true)),
    ("pulse-first", Switch::PulseFirst(true)),
    ("text-order", Switch::PulseFirst(false)),
];
