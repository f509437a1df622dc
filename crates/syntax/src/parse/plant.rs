//! Plants.

use super::Parser;
use crate::lexer::Tok;
use g7_model::{
    Arrivals, Binding, Drive, Expr, Name, Parts, Plant, PlantItem, Rate, Said, StateVar, View, say, words,
};

impl Parser<'_> {
    /// `plant Name { … }`.
    pub(super) fn plant(&mut self) -> Plant {
        let start = self.cur.start;
        let (name, comment) = self.head(|p| {
            p.bump();
            (p.name(say!("the name of the plant")), p.comment_if())
        });
        let open = self.here();
        let mut items = Vec::new();
        if self.expect(Tok::LBrace, say!("`{{` and the parts of the plant")) {
            loop {
                self.skip_semis();
                if self.eat(Tok::RBrace) {
                    break;
                }
                if self.at(Tok::End) || self.cur.newline && self.at_file_start() {
                    self.close(Tok::RBrace, say!("`}}` after the last item of the plant"), open);
                    break;
                }
                let at = self.cur.start;
                match self.line(Parser::plant_item) {
                    Some(item) => items.push(item),
                    None if self.correct(&words::texts(words::PLANT)) => {
                        items.extend(self.line(Parser::plant_item))
                    }
                    None => self.lost_plant_item(at),
                }
            }
        }
        Plant { name, comment, items, at: self.since(start).into() }
    }

    fn lost_plant_item(&mut self, start: u32) {
        self.unexpected(
            say!("an item of a plant: const, state, rate, drive, on, each, parts, arrivals or view"),
            None,
        );
        if self.cur.start == start {
            self.bump();
        }
        self.recover(|p| p.at(Tok::Word));
    }

    fn plant_item(&mut self) -> Option<PlantItem> {
        let start = self.cur.start;
        Some(match self.word() {
            "const" => self.plant_const(),
            "state" => PlantItem::State(self.state()),
            "rate" => PlantItem::Rate(self.rate()),
            "drive" => PlantItem::Drive(self.drive()),
            "on" => {
                self.bump();
                let event = self.condition();
                let block = self.block(say!("`{{` and what happens"));
                PlantItem::On(event, block, self.since(start).into())
            }
            "each" => {
                self.bump();
                let block = self.block(say!("`{{` and what happens at every tick"));
                PlantItem::Each(block, self.since(start).into())
            }
            "parts" => PlantItem::Parts(self.parts()),
            "arrivals" => PlantItem::Arrivals(self.arrivals()),
            "view" => PlantItem::View(self.view()),
            _ => return None,
        })
    }

    fn plant_const(&mut self) -> PlantItem {
        let start = self.bump().start;
        let names = self.names(say!("the name of the constant"));
        let ty = self.typed();
        let value = match self.initial_value() {
            Some(value) => value,
            None => {
                self.expected(say!("`:=` and the value of the constant"));
                self.bad()
            }
        };
        let comment = self.comment_if();
        PlantItem::Const { names, ty, value, comment, at: self.since(start).into() }
    }

    fn state(&mut self) -> StateVar {
        let start = self.bump().start;
        let names = self.names(say!("the name of the state"));
        let ty = self.typed();
        let init = self.initial_value();
        let limits = self.eat_word("in").then(|| {
            let least = self.expr();
            self.expect(Tok::DotDot, say!("`..` and the upper limit"));
            (least, self.expr())
        });
        let comment = self.comment_if();
        StateVar { names, ty, init, limits, comment, at: self.since(start).into() }
    }

    /// `name := e`, of a rate or a drive.
    fn name_and_value(&mut self, what: Said) -> (Name, Expr) {
        let name = self.name(what);
        let value = if self.assign_sign() { self.expr() } else { self.bad() };
        (name, value)
    }

    fn rate(&mut self) -> Rate {
        let start = self.bump().start;
        let (state, value) = self.name_and_value(say!("the name of a state or of a track"));
        let when = self.eat_word("when").then(|| self.condition());
        Rate { state, value, when, at: self.since(start).into() }
    }

    fn drive(&mut self) -> Drive {
        let start = self.bump().start;
        let first = self.cur.start;
        let name = self.name(say!("the name of an input"));
        let path = self.path_from(name);
        let kind = self.variable_of(path);
        let input = Expr { kind, at: self.since(first).into() };
        let value = if self.assign_sign() { self.expr() } else { self.bad() };
        Drive { input, value, at: self.since(start).into() }
    }

    fn parts(&mut self) -> Parts {
        let start = self.bump().start;
        let name = self.name(say!("the name of the parts"));
        let attributes = self.params();
        if !self.eat_word("max") {
            self.expected(say!("`max` and how many parts there are at most"));
        }
        let max = self.integer_u32(say!("how many parts there are at most"));
        let length = self.eat_word("length").then(|| self.expr());
        let mut init = Vec::new();
        if self.eat(Tok::Assign) {
            loop {
                init.push(self.part());
                if !self.eat(Tok::Comma) {
                    break;
                }
            }
        }
        Parts { name, attributes, max, length, init, at: self.since(start).into() }
    }

    /// `(1, TRUE)`.
    fn part(&mut self) -> Vec<Expr> {
        let open = self.here();
        let mut values = Vec::new();
        if !self.expect(Tok::LParen, say!("`(` and the attributes of a part")) {
            return values;
        }
        while !matches!(self.cur.kind, Tok::RParen | Tok::End) {
            let start = self.cur.start;
            values.push(self.expr());
            if !self.eat(Tok::Comma) || self.cur.start == start {
                break;
            }
        }
        self.close(Tok::RParen, say!("`)`"), open);
        values
    }

    fn arrivals(&mut self) -> Arrivals {
        let start = self.bump().start;
        let name = self.name(say!("the name of the arrivals"));
        if !self.eat_word("every") {
            self.expected(say!("`every` and the time between two arrivals"));
        }
        let least = self.expr();
        let most = self.eat(Tok::DotDot).then(|| self.expr());
        let when = self.eat_word("when").then(|| self.condition());
        let body = self.block(say!("`{{` and what happens at an arrival"));
        Arrivals { name, least, most, when, body, at: self.since(start).into() }
    }

    fn view(&mut self) -> View {
        let start = self.bump().start;
        let file = self.text_if().unwrap_or_else(|| {
            self.expected(say!("the name of a picture file in quotes"));
            "".into()
        });
        let open = self.here();
        let mut bindings = Vec::new();
        if self.eat(Tok::LBrace) {
            self.skip_semis();
            let mut before = None;
            while self.at_name() && before != Some(self.cur.start) {
                before = Some(self.cur.start);
                bindings.push(self.line(Parser::binding));
                self.skip_semis();
            }
            self.close(Tok::RBrace, say!("`}}` after the bindings"), open);
        }
        View { file, bindings, at: self.since(start).into() }
    }

    /// `element.attribute := e`.
    fn binding(&mut self) -> Binding {
        let element = self.name(say!("the name of an element"));
        if !self.eat(Tok::PathDot) {
            self.expected(say!("`.` and an attribute of the element"));
        }
        let (attribute, value) = self.name_and_value(say!("an attribute of the element"));
        Binding { element, attribute, value }
    }
}
