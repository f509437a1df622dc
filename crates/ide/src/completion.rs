//! Completion: the words that are possible at a place of the text.

use g7_model::instances::drawn_for;
use g7_model::words::{self, Told, Word};
use g7_model::{Document, ProfileName, Qualifier, Said, StandardFunction, Type, VarDecl, say};
use g7_syntax::{Token, TokenKind};

use crate::file::{File, floor};
use crate::names::{Meaning, names, sort};
use crate::tables::declaration;

/// The possible words, and the place at which the word begins.
#[derive(Debug)]
pub struct Completion {
    /// The byte at which the word to be completed begins.
    pub from: usize,
    /// The words, the likely ones first.
    pub items: Vec<Choice>,
}

/// One possible word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// The word as it is shown.
    pub label: String,
    /// Its kind: `keyword`, `variable`, `step`, `chart`, `function`, `type`, `member`, …
    pub kind: &'static str,
    /// Its effect or its declaration.
    pub detail: Said,
    /// The text that takes the place of the typed word.
    pub insert: String,
}

/// The item whose braces enclose a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Around {
    File,
    Chart,
    Step,
    Plant,
    Test,
    Layout,
    /// Statements.
    Body,
}

/// The completion at a byte.
pub fn complete(file: &File, at: usize) -> Completion {
    let text = file.text();
    let byte = floor(text, at);
    let before: Vec<Token> = g7_syntax::tokens(text).take_while(|t| t.start < byte).collect();
    // A word that ends at the place is the one being typed.
    let typed = before.last().filter(|t| t.end >= byte && is_word(t.kind));
    let from = typed.map_or(byte, |t| t.start);
    let before = if typed.is_some() { before.split_last().map_or(&[][..], |(_, b)| b) } else { &before[..] };
    let readable = file.drawn();
    let prefix = &*text.get(from..byte).unwrap_or("").trim_start_matches('`').to_lowercase();
    let at = u32::try_from(byte).unwrap_or(u32::MAX);
    let place = Place { text, before, prefix, document: readable.document, at };
    let mut items = place.choices();
    items.retain(|c| c.label.to_lowercase().contains(prefix));
    items.sort_by_key(|c| !c.label.to_lowercase().starts_with(prefix));
    items.dedup();
    items.truncate(200);
    for item in &mut items {
        // The effects of the language's words are translated in the table `words`.
        let told = words::in_language(&item.detail, file.language);
        if told != item.detail.as_str() {
            item.detail = Said::foreign(told);
        }
    }
    Completion { from, items }
}

fn is_word(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::Word | TokenKind::Ticked | TokenKind::Number)
}

struct Place<'a> {
    text: &'a str,
    /// The tokens before the word being typed.
    before: &'a [Token],
    /// The beginning of the word being typed, in small letters.
    prefix: &'a str,
    document: &'a Document,
    at: u32,
}

impl Place<'_> {
    fn word(&self, token: &Token) -> &str {
        self.text.get(token.start..token.end).unwrap_or("")
    }

    fn choices(&self) -> Vec<Choice> {
        let Some(last) = self.before.last() else { return keywords(words::FILE) };
        let around = self.around();
        let word = self.word(last).to_owned();
        match (last.kind, word.as_str()) {
            (TokenKind::Note | TokenKind::Str | TokenKind::Comment, _) if last.end as u32 > self.at => {
                Vec::new()
            }
            (TokenKind::PathDot, _) => self.members(),
            // A dot that nothing follows yet.
            (TokenKind::Sign, ".") if last.end as u32 == self.at => self.members(),
            (TokenKind::Colon, _) if self.declares() => types(),
            (TokenKind::Arrow, _) => self.steps(),
            (_, "profile") => {
                let one = |p: ProfileName| choice(p.name(), "profile", Said::foreign(p.does()[0]), p.name());
                ProfileName::ALL.map(one).into()
            }
            (_, "force" | "enclose" | "call" | "enable" | "mask" | "layout" | "instance") => self.charts(),
            (_, "with") => self.others("plant"),
            _ if self.begins(last) => match around {
                Around::File => keywords(words::FILE),
                Around::Chart => [self.steps(), keywords(words::CHART)].concat(),
                Around::Step => [qualifiers(), keywords(words::ACTION), self.values()].concat(),
                Around::Plant => keywords(words::PLANT),
                Around::Test => keywords(words::TEST),
                Around::Layout => self.steps(),
                Around::Body => [self.values(), functions()].concat(),
            },
            (
                _,
                "step" | "initial" | "macro" | "enclosing" | "chart" | "macrochart" | "task" | "var"
                | "input",
            )
            | (_, "output" | "const") => Vec::new(),
            (TokenKind::Comma | TokenKind::LParen, _) if around == Around::Chart && !self.after("when") => {
                self.steps()
            }
            _ if around == Around::Chart && self.after("->") && !self.after("when") => {
                let behind = words::CLAUSES.iter().filter(|w| matches!(w.text, "when" | "priority"));
                behind.map(|w| keyword(&w.phrase(), w.does)).chain(self.steps()).collect()
            }
            _ => [self.values(), functions()].concat(),
        }
    }

    /// True if a statement or an item begins here.
    fn begins(&self, last: &Token) -> bool {
        let between = self.text.get(last.end..self.at as usize).unwrap_or("");
        matches!(last.kind, TokenKind::LBrace | TokenKind::RBrace | TokenKind::Semi)
            || between.contains('\n') && !matches!(last.kind, TokenKind::Sign | TokenKind::Comma)
    }

    /// The item whose braces enclose the place, found by its first word.
    fn around(&self) -> Around {
        let mut open: Vec<Around> = Vec::new();
        let mut head: Option<&str> = None;
        for (i, t) in self.before.iter().enumerate() {
            let first = i.checked_sub(1).and_then(|i| self.before.get(i)).is_none_or(|b| {
                matches!(b.kind, TokenKind::LBrace | TokenKind::RBrace)
                    || self.text.get(b.end..t.start).unwrap_or("").contains('\n')
            });
            let word = self.word(t);
            if first {
                head = Some(word);
            }
            match t.kind {
                TokenKind::LBrace => {
                    let inside = open.last().copied().unwrap_or(Around::File);
                    let opened = match (inside, head.unwrap_or("")) {
                        (Around::File, "chart" | "macrochart" | "task") => Around::Chart,
                        (Around::File, "plant") => Around::Plant,
                        (Around::File, "test") => Around::Test,
                        (Around::File, "layout") => Around::Layout,
                        (Around::Chart, "step" | "initial" | "entry" | "exit" | "macro" | "enclosing") => {
                            Around::Step
                        }
                        (Around::Test, _) => Around::Test,
                        _ => Around::Body,
                    };
                    open.push(opened);
                    head = None;
                }
                TokenKind::RBrace => {
                    open.pop();
                    head = None;
                }
                _ => {}
            }
        }
        open.last().copied().unwrap_or(Around::File)
    }

    /// True if a word or sign occurs earlier on this line.
    fn after(&self, sign: &str) -> bool {
        let mut end = self.at as usize;
        for t in self.before.iter().rev() {
            if self.text.get(t.end..end).is_some_and(|b| b.contains('\n')) {
                return false;
            }
            if self.word(t) == sign || sign == "->" && t.kind == TokenKind::Arrow {
                return true;
            }
            end = t.start;
        }
        false
    }

    /// True if this line is a declaration.
    fn declares(&self) -> bool {
        ["input", "output", "var", "const", "state", "function", "parts"].iter().any(|w| self.after(w))
    }

    fn here(&self) -> Option<&g7_model::Chart> {
        self.document.charts().find(|c| c.at.0.start <= self.at && self.at <= c.at.0.end)
    }

    /// The names that can follow the dot.
    fn members(&self) -> Vec<Choice> {
        let mut before = self.before.iter().rev().skip(1).map(|t| self.word(t));
        let mut owner = before.next().unwrap_or("");
        if owner == "]" {
            // `Axis[3].` has the members of `Axis`.
            owner = before.by_ref().skip_while(|w| *w != "[").nth(1).unwrap_or("");
        }
        let owner = drawn_for(self.document, owner.trim_matches('`'));
        let mut found = Vec::new();
        for n in names(self.document) {
            let name = &*n.name.text;
            match n.meaning {
                Meaning::Step(c, _) if *c.name.text == *owner => {
                    found.push(activity(&step_variable(name), name, &c.name.text))
                }
                Meaning::Variable(v, Some(c)) if *c.name.text == *owner => {
                    found.push(choice(name, "variable", declared(name, v), name));
                }
                Meaning::Variable(v, _) if name == owner => {
                    if let g7_model::Type::Fb(kind) = v.ty {
                        let member = |(m, ty, input): &(&str, g7_model::Type, bool)| {
                            let told = if *input { say!("input : {ty}") } else { say!("output : {ty}") };
                            choice(m, "member", told, m)
                        };
                        found.extend(kind.members().iter().map(member));
                    }
                }
                Meaning::Step(..) if name == owner => {
                    found.extend(words::STEP.iter().map(member));
                }
                Meaning::Other("parts of the plant", _) if name == owner => {
                    found.extend(words::PART.iter().map(member));
                }
                Meaning::Variable(..) | Meaning::Step(..) | Meaning::Chart(_) | Meaning::Other(..) => {}
            }
        }
        if owner.starts_with('X')
            && owner.get(1..2).is_some_and(|c| c.starts_with(|c: char| c.is_ascii_digit()))
        {
            found.extend(words::STEP.iter().filter(|w| w.text == "T").map(member));
        }
        found
    }

    fn steps(&self) -> Vec<Choice> {
        let steps = self.here().into_iter().flat_map(|c| c.steps());
        steps
            .map(|s| {
                choice(
                    &s.name.text,
                    "step",
                    comment(s.comment.as_deref()),
                    &g7_syntax::show_step_name(&s.name.text),
                )
            })
            .collect()
    }

    fn charts(&self) -> Vec<Choice> {
        let shown = |c: &g7_model::Chart| {
            choice(&c.name.text, "chart", comment(c.comment.as_deref()), &g7_syntax::show_name(&c.name.text))
        };
        self.document.charts().map(shown).collect()
    }

    fn others(&self, what: &str) -> Vec<Choice> {
        let named = names(self.document).into_iter().filter_map(|n| match n.meaning {
            Meaning::Other(w, told) if w == what => {
                Some(choice(&n.name.text, "plant", comment(told), &g7_syntax::show_name(&n.name.text)))
            }
            _ => None,
        });
        named.collect()
    }

    /// The names that an expression can use: variables, steps, charts, parts of plants.
    fn values(&self) -> Vec<Choice> {
        let here = self.here().map(|c| c.name.text.clone());
        let mut found = Vec::new();
        for n in names(self.document) {
            let name = &*n.name.text;
            let shown = g7_syntax::show_name(name);
            match n.meaning {
                Meaning::Variable(v, None) => found.push(choice(name, "variable", declared(name, v), &shown)),
                Meaning::Variable(v, Some(c)) => {
                    let inside = here.as_ref() == Some(&c.name.text);
                    let path = if inside {
                        shown
                    } else {
                        format!("{}.{shown}", g7_syntax::show_name(&c.name.text))
                    };
                    found.push(choice(&path, "variable", declared(name, v), &path));
                }
                // There may be thousands of steps, and the text about each costs more than its name.
                Meaning::Step(c, _) if here.as_ref() == Some(&c.name.text) => {
                    let variable = step_variable(name);
                    if variable.to_lowercase().contains(self.prefix) {
                        found.push(activity(&variable, name, &c.name.text));
                    }
                }
                Meaning::Step(..) => {}
                Meaning::Chart(c) => found.push(choice(name, "chart", crate::tables::kind(c.kind), &shown)),
                Meaning::Other(what, comment) => {
                    if n.scope.is_none_or(|s| s.start <= self.at && self.at <= s.end) && what != "transition"
                    {
                        let told = comment.map_or_else(|| sort(what), Said::foreign);
                        found.push(choice(name, "name", told, &shown));
                    }
                }
            }
        }
        found
    }
}

/// The step variable of a step, as an expression writes it.
fn step_variable(step: &str) -> String {
    if step.starts_with(|c: char| c.is_ascii_digit()) {
        format!("X{step}")
    } else {
        format!("{}.X", g7_syntax::show_name(step))
    }
}

fn activity(variable: &str, step: &str, chart: &str) -> Choice {
    choice(variable, "step", say!("step `{step}` of `{chart}` is active"), variable)
}

fn keywords(list: &[Word]) -> Vec<Choice> {
    list.iter().map(|w| keyword(&w.phrase(), w.does)).collect()
}

fn keyword(word: &str, [does, ..]: Told) -> Choice {
    choice(word, "keyword", Said::foreign(does), &format!("{word} "))
}

/// The qualifiers, each with what it does.
fn qualifiers() -> Vec<Choice> {
    Qualifier::ALL.map(|q| keyword(q.name(), words::of_qualifier(q))).into()
}

/// The types: those used most stand first.
fn types() -> Vec<Choice> {
    let often = [Type::Bool, Type::Int, Type::Real, Type::Time].map(Type::name);
    let does = |name: &str| Type::named(name).map_or("", |ty| words::of_type(ty)[0]);
    let others = Type::names().filter(|name| !often.contains(name));
    let named = often.into_iter().chain(others).map(|t| choice(t, "type", Said::foreign(does(t)), t));
    let composed = words::TYPE.iter().map(|word| {
        let text = word.text.to_ascii_uppercase();
        let phrase = format!("{text}{}", word.then);
        choice(&text, "type", Said::foreign(word.does[0]), &phrase)
    });
    named.chain(composed).collect()
}

fn functions() -> Vec<Choice> {
    let edges = words::VALUE.iter().filter(|w| !w.capitals).map(|w| (w.text, w.does[0]));
    let standard = StandardFunction::ALL.into_iter().map(|f| (f.row().name, f.row().does[0]));
    let one = |(name, does): (&str, &str)| choice(name, "function", Said::foreign(does), &format!("{name}("));
    edges.chain(standard).map(one).collect()
}

fn member(word: &Word) -> Choice {
    choice(word.text, "member", Said::foreign(word.does[0]), word.text)
}

fn comment(comment: Option<&str>) -> Said {
    comment.map_or_else(Said::default, Said::foreign)
}

fn declared(name: &str, v: &VarDecl) -> Said {
    Said::foreign(declaration(name, v))
}

fn choice(label: &str, kind: &'static str, detail: Said, insert: &str) -> Choice {
    Choice { label: label.to_owned(), kind, detail, insert: insert.to_owned() }
}
