//! Completion: the words that are possible at a place of the text.

use g7_compile::references::{Declared, Kind, Member, Types, values};
use g7_model::instances::Drawings;
use g7_model::words::{self, Told, Word};
use g7_model::{
    Chart, Document, Item, Name, ProfileName, Qualifier, Said, StandardFunction, Type, VarDecl, VarKind, say,
};
use g7_rig::{LIBRARY, Part};
use g7_syntax::{Token, TokenKind};

use crate::file::{File, OWN, floor};
use crate::names::{Meaning, names, sort};
use crate::tables::{declaration, member_declaration, type_declaration};

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
    /// A structure.
    Struct,
    /// The declarations of a function block. Its body is [`Around::Body`].
    Block,
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
    let document = file.with_uses(readable);
    let place = Place { text, before, prefix, document: &document, at };
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

/// The type that an item declares.
fn type_choice(item: &Item) -> Option<Choice> {
    let (name, told) = match item {
        Item::Composed(c) => {
            let what = if c.block { say!("function block") } else { say!("structure") };
            (&c.name, c.comment.as_deref().map_or(what, Said::foreign))
        }
        Item::Type(t) => {
            let told = t.comment.as_deref().map_or_else(|| type_declaration(t), str::to_owned);
            (t.names.first()?, Said::foreign(told))
        }
        _ => return None,
    };
    Some(choice(&name.text, "type", told, &g7_syntax::show_name(&name.text)))
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
            (TokenKind::Note | TokenKind::Str | TokenKind::Comment, _) if self.is_within(last) => Vec::new(),
            (TokenKind::PathDot, _) => self.members(),
            (TokenKind::Sign, ".") if self.joins(last) => self.members(),
            (TokenKind::Colon, _)
                if around == Around::Struct
                    || self.declares()
                    || around == Around::File && self.in_head() =>
            {
                [types(), self.composed(around)].concat()
            }
            (_, "OF" | "of") if around == Around::Struct || self.declares() => {
                let elementary = types().into_iter().filter(|c| !c.insert.contains(' '));
                elementary.chain(self.composed(around)).collect()
            }
            (_, "of") if around == Around::File => self.blocks(),
            (TokenKind::Arrow, _) => self.steps(),
            (_, "profile") => {
                let one = |p: ProfileName| choice(p.name(), "profile", Said::foreign(p.does()[0]), p.name());
                ProfileName::ALL.map(one).into()
            }
            (_, "use") => {
                let told = |p: &Part| choice(p.name, "library", Said::foreign(p.title()), p.name);
                LIBRARY.iter().map(told).collect()
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
                Around::Struct => Vec::new(),
                Around::Block => keywords(words::BLOCK),
                Around::Body => [self.values(), functions()].concat(),
            },
            (
                _,
                "step" | "initial" | "macro" | "enclosing" | "chart" | "macrochart" | "task" | "var"
                | "input",
            )
            | (_, "output" | "inout" | "const" | "struct") => Vec::new(),
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

    /// True if the place lies in a note or a text. A note that begins with `//` goes on up to the end of its line.
    fn is_within(&self, last: &Token) -> bool {
        let (end, at) = (last.end, self.at as usize);
        end > at || end == at && self.word(last).starts_with("//")
    }

    /// True if a dot joins what is typed to what stands before it: nothing follows the dot yet, or it stands close
    /// behind an index. Elsewhere such a dot is AND.
    fn joins(&self, dot: &Token) -> bool {
        let index = self.before.iter().rev().nth(1).filter(|t| t.end == dot.start && self.word(t) == "]");
        let typed = self.text.get(dot.end..self.at as usize).unwrap_or(" ");
        typed.is_empty() || index.is_some() && !typed.contains(char::is_whitespace)
    }

    /// True if a statement or an item begins here.
    fn begins(&self, last: &Token) -> bool {
        let between = self.text.get(last.end..self.at as usize).unwrap_or("");
        matches!(last.kind, TokenKind::LBrace | TokenKind::RBrace | TokenKind::Semi)
            || between.contains('\n') && !matches!(last.kind, TokenKind::Sign | TokenKind::Comma)
    }

    /// The item whose braces enclose the place, found by its first word.
    fn around(&self) -> Around {
        self.open().last().map_or(Around::File, |(around, _)| *around)
    }

    /// The name of the item of a kind that encloses the place.
    fn enclosing(&self, kind: Around) -> Option<&str> {
        let (_, name) = self.open().into_iter().find(|(around, _)| *around == kind)?;
        self.before.get(name).map(|t| self.word(t).trim_matches('`'))
    }

    /// The function block whose body, or one of whose charts, encloses the place.
    fn block(&self) -> Option<&str> {
        let of_chart = || self.here()?.block.as_ref().map(|b| &*b.text);
        self.enclosing(Around::Block).or_else(of_chart)
    }

    /// The items whose braces enclose the place, the outermost first, each with the token that is its name.
    fn open(&self) -> Vec<(Around, usize)> {
        let mut open: Vec<(Around, usize)> = Vec::new();
        let mut head: Option<usize> = None;
        let text_of = |i: usize| self.before.get(i).map_or("", |t| self.word(t));
        for (i, t) in self.before.iter().enumerate() {
            let first = i.checked_sub(1).and_then(|i| self.before.get(i)).is_none_or(|b| {
                matches!(b.kind, TokenKind::LBrace | TokenKind::RBrace)
                    || self.text.get(b.end..t.start).unwrap_or("").contains('\n')
            });
            if first {
                head = Some(i);
            }
            match t.kind {
                TokenKind::LBrace => {
                    let inside = open.last().map_or(Around::File, |(around, _)| *around);
                    let head_at = head.unwrap_or(i);
                    let block = text_of(head_at + 1) == "block" && text_of(head_at + 2) != "(";
                    let opened = match (inside, head.map_or("", text_of)) {
                        (Around::File, "chart" | "macrochart" | "task") => Around::Chart,
                        (Around::File, "plant") => Around::Plant,
                        (Around::File, "test") => Around::Test,
                        (Around::File, "layout") => Around::Layout,
                        (Around::File, "struct") => Around::Struct,
                        (Around::File, "function") if block => Around::Block,
                        (Around::Chart, "step" | "initial" | "entry" | "exit" | "macro" | "enclosing") => {
                            Around::Step
                        }
                        (Around::Test, _) => Around::Test,
                        _ => Around::Body,
                    };
                    open.push((opened, head_at + if opened == Around::Block { 2 } else { 1 }));
                    head = None;
                }
                TokenKind::RBrace => {
                    open.pop();
                    head = None;
                }
                _ => {}
            }
        }
        open
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
        ["input", "output", "inout", "var", "const", "state", "function", "parts"]
            .iter()
            .any(|w| self.after(w))
    }

    fn here(&self) -> Option<&g7_model::Chart> {
        let around =
            |c: &&g7_model::Chart| c.at.0.file == OWN && c.at.0.start <= self.at && self.at <= c.at.0.end;
        self.document.charts().find(around)
    }

    /// The types that the file declares, where a variable can have one. A parameter, a local variable and a result hold
    /// one value.
    fn composed(&self, around: Around) -> Vec<Choice> {
        if self.after("state") || self.after("parts") {
            return Vec::new();
        }
        let parameter = around == Around::File && self.in_head();
        let one = |i: &&Item| matches!(i, Item::Type(t) if t.array.is_none());
        let fits = |i: &&Item| one(i) || !parameter && around != Around::Body;
        self.document.items.iter().filter(fits).filter_map(type_choice).collect()
    }

    /// True if this line is the head of a function or of a chart.
    fn in_head(&self) -> bool {
        ["function", "chart", "macrochart", "task"].iter().any(|w| self.after(w))
    }

    /// The function blocks that the file declares.
    fn blocks(&self) -> Vec<Choice> {
        let block = |i: &&Item| matches!(i, Item::Composed(c) if c.block);
        self.document.items.iter().filter(block).filter_map(type_choice).collect()
    }

    /// The names before the dot, joined by dots, without their indexes.
    fn owners(&self) -> Vec<&str> {
        let mut owners = Vec::new();
        let mut before = self.before.iter().rev();
        let dot = |t: &Token| t.kind == TokenKind::PathDot || self.word(t) == ".";
        while before.next().is_some_and(dot) {
            let mut name = before.next();
            let mut depth = 0;
            while let Some(t) = name {
                match self.word(t) {
                    "]" => depth += 1,
                    "[" => depth -= 1,
                    _ if depth == 0 => break,
                    _ => {}
                }
                name = before.next();
            }
            let Some(name) = name.filter(|t| is_word(t.kind)) else { break };
            owners.push(self.word(name).trim_matches('`'));
        }
        owners.reverse();
        owners
    }

    /// The members of the variable before the dot, or of the part of one; None if it has none.
    fn members_of(&self, owners: &[&str]) -> Option<Vec<Choice>> {
        let types = Types::of(self.document);
        let (first, behind) = owners.split_first()?;
        if let Some(t) = types.other(first).filter(|_| behind.is_empty()) {
            let told = Said::foreign(type_declaration(t));
            let value = |(_, name): (_, &Name)| {
                choice(&name.text, "value", told.clone(), &g7_syntax::show_name(&name.text))
            };
            return Some(values(t).map(value).collect());
        }
        let block = self.block().and_then(|name| types.named(name));
        let own = block.and_then(|of| Member::named(of, first)).map(|m| types.kind_of(&m));
        let (kind, rest) = own.map(|kind| (kind, behind)).or_else(|| {
            let of_chart = behind.split_first().and_then(|(name, rest)| {
                let v = types.variable(Some(Drawings::of(self.document).drawn_for(first)), name)?;
                Some((types.kind(v), rest))
            });
            let here = self.enclosing(Around::Chart).and_then(|c| types.variable(Some(c), first));
            let alone = here.or_else(|| types.variable(None, first));
            of_chart.or_else(|| alone.map(|v| (types.kind(v), behind)))
        })?;
        match types.behind(kind, rest) {
            (found, _) if found.len() < rest.len() => None,
            (_, Kind::Composed(of)) => {
                // The parameters stand first: the others are those of the block itself.
                let mut all: Vec<Member<'_>> = Member::all(of).filter(|m| rank(m).is_some()).collect();
                all.sort_by_key(rank);
                let one = |m: Member<'_>| {
                    let shown = g7_syntax::show_path_name(&m.name.text, false, false);
                    choice(&m.name.text, "member", Said::foreign(member_declaration(&m)), &shown)
                };
                let chart = |c: &Chart| {
                    let told = comment(c.comment.as_deref());
                    choice(
                        &c.name.text,
                        "chart",
                        told,
                        &g7_syntax::show_path_name(&c.name.text, false, false),
                    )
                };
                Some(all.into_iter().map(one).chain(types.charts(of).map(chart)).collect())
            }
            (_, Kind::Plain(Type::Fb(kind))) => {
                let member = |(m, ty, input): &(&str, Type, bool)| {
                    let told = if *input { say!("input : {ty}") } else { say!("output : {ty}") };
                    choice(m, "member", told, m)
                };
                Some(kind.members().iter().map(member).collect())
            }
            (_, Kind::Plain(_) | Kind::Unknown) => None,
        }
    }

    /// The names that can follow the dot.
    fn members(&self) -> Vec<Choice> {
        let owners = self.owners();
        if let Some(found) = self.members_of(&owners) {
            return found;
        }
        let owner = owners.last().copied().unwrap_or("");
        let owner = Drawings::of(self.document).drawn_for(owner);
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
                Meaning::Step(..) if name == owner => {
                    found.extend(words::STEP.iter().map(member));
                }
                Meaning::Other("parts of the plant", _) if name == owner => {
                    found.extend(words::PART.iter().map(member));
                }
                Meaning::Variable(..)
                | Meaning::Step(..)
                | Meaning::Chart(_)
                | Meaning::Type(_)
                | Meaning::Named(_)
                | Meaning::Value(_)
                | Meaning::Member(_)
                | Meaning::Other(..) => {}
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
        let block = self.block();
        let (mut own, mut found) = (Vec::new(), Vec::new());
        for n in names(self.document) {
            let name = &*n.name.text;
            let shown = g7_syntax::show_name(name);
            match n.meaning {
                Meaning::Member(m) if block == Some(&*m.of.name.text) => {
                    let told = Said::foreign(member_declaration(&m));
                    own.push(choice(name, "variable", told, &shown));
                }
                Meaning::Member(_) | Meaning::Type(_) | Meaning::Named(_) => {}
                Meaning::Value(t) => {
                    let told = Said::foreign(type_declaration(t));
                    found.push(choice(name, "value", told, &shown));
                }
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
        // The names of a function block hide those of the file.
        found.retain(|c| own.iter().all(|o| o.label != c.label));
        own.append(&mut found);
        own
    }
}

/// The place of a member among those that can follow a dot; None for what only the body sees.
fn rank(member: &Member<'_>) -> Option<u8> {
    match member.declared {
        Declared::Var(v) if matches!(v.kind, VarKind::Input | VarKind::Output) => Some(0),
        Declared::Var(_) => Some(1),
        Declared::InOut(_) | Declared::Local(_) => None,
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
