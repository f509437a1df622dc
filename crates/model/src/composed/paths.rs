//! The meaning of a path: `m[i].t[j].x` as the one name `m[].t[].x` with its indexes.

use super::base::{Composition, Env, Scope, Segment, Spot, is_local};
use crate::{
    BinaryOp, Composed, Expr, ExprKind, Index, Literal, Name, Path, Place, Problem, Span, UnaryOp, VarDecl,
    VarKind, codes, instance_of, say, slot_of,
};

/// A path that leads to no variable. Its problem has been reported.
pub(super) struct Lost;

/// The meaning of a path.
enum Meaning<'d> {
    /// A variable, or an element or a member of one.
    Variable(Box<Spot<'d>>),
    /// A chart of an instance, or a step of it: the path with the full name of the chart.
    OfChart(ExprKind),
    /// Something in which nothing is replaced.
    Other,
}

impl<'d> Composition<'d> {
    /// The names of a path, each with its indexes as they are written.
    pub(super) fn segments(&self, path: &Path, index: &[Expr], env: &Env<'_, 'd>) -> Vec<Segment> {
        let mut rest = index.iter().cloned();
        let last = path.names.len().saturating_sub(1);
        let mut all: Vec<Segment> = Vec::new();
        for (n, name) in path.names.iter().enumerate() {
            let slot = slot_of(&name.text).filter(|_| n < last);
            let whole = |text: &str| self.base(text, env).is_some() || self.charts.contains_key(text);
            let numbered = instance_of(&name.text).filter(|_| !whole(&name.text));
            let (text, index) = match (slot, numbered) {
                (Some((bare, count)), _) => (bare, rest.by_ref().take(count).collect()),
                (None, Some((bare, number))) => (bare, vec![number_of(number, name.at)]),
                (None, None) => (&*name.text, Vec::new()),
            };
            all.push(Segment { name: Name { text: text.into(), at: name.at }, index });
        }
        if let Some(last) = all.last_mut() {
            last.index.extend(rest);
        }
        all
    }

    /// Replaces the names in the indexes of some segments. The indexes are expressions of the statement that has the path.
    pub(super) fn indexed(&mut self, segments: &mut [Segment], env: &Env<'_, 'd>) {
        for e in segments.iter_mut().flat_map(|s| &mut s.index) {
            self.expr(e, env);
        }
    }

    /// True if a path can begin with the name and lead to a variable.
    pub(super) fn is_variable(&self, name: &str, env: &Env<'_, 'd>) -> bool {
        let inner = match env {
            Env::Block { instance, inouts, .. } => {
                inouts.contains_key(name) || instance.of.is_some_and(|of| member(of, name).is_some())
            }
            Env::Chart { instance, .. } => {
                instance.of.is_some_and(|of| member(of, name).is_some()) || self.base(name, env).is_some()
            }
            Env::Outer { .. } => self.base(name, env).is_some(),
        };
        inner || self.file.contains_key(name) || self.charts.contains_key(name)
    }

    /// The variable that a name alone means, outside of function blocks.
    pub(super) fn base(&self, name: &str, env: &Env<'_, 'd>) -> Option<&'d VarDecl> {
        if env.root().1.iter().any(|l| **l == *name) {
            return None;
        }
        let own = self.own_scope(env).and_then(|scope| scope.get(name));
        own.or_else(|| self.file.get(name)).copied()
    }

    /// The variables of the chart in which the path stands.
    fn own_scope(&self, env: &Env<'_, 'd>) -> Option<&Scope<'d>> {
        self.scope(env.root().0?)
    }

    /// The variable that a path leads to; None if it leads to none, or to one in which nothing is replaced.
    pub(super) fn spot(&mut self, segments: &[Segment], env: &Env<'_, 'd>) -> Result<Option<Spot<'d>>, Lost> {
        let [first, rest @ ..] = segments else { return Ok(None) };
        match env {
            Env::Chart { instance, locals, .. }
                if !locals.contains(&first.name.text)
                    && instance.of.is_some_and(|of| member(of, &first.name.text).is_some()) =>
            {
                self.member_of_own(instance.clone(), first, rest).map(Some)
            }
            Env::Outer { .. } | Env::Chart { .. } => {
                if let (Some(scope), [second, rest @ ..]) = (self.scope(&first.name.text), rest)
                    && let Some(decl) = scope.get(&*second.name.text).copied()
                {
                    let chart = first.name.clone();
                    let spot = self.start(second, decl, Some(chart), Some(&first.name.text));
                    return self.follow(spot, rest).map(Some);
                }
                let Some(decl) = self.base(&first.name.text, env) else { return Ok(None) };
                let own = self.own_scope(env).is_some_and(|scope| scope.contains_key(&*first.name.text));
                let home = env.home().filter(|_| own);
                self.follow(self.start(first, decl, None, home), rest).map(Some)
            }
            Env::Block { instance, inouts, outer } => {
                if let Some(alias) = inouts.get(&*first.name.text) {
                    let mut whole = alias.clone();
                    if let Some(last) = whole.last_mut() {
                        last.index.extend(first.index.iter().cloned());
                        last.name.at = first.name.at;
                    }
                    whole.extend(rest.iter().cloned());
                    return self.spot(&whole, outer);
                }
                let of = instance.of;
                if of.is_some_and(|of| member(of, &first.name.text).is_some()) {
                    return self.member_of_own(instance.clone(), first, rest).map(Some);
                }
                if !self.is_variable(&first.name.text, env) && !self.is_known(&first.name.text) {
                    return Err(self.foreign(&first.name));
                }
                self.captured(&first.name, instance, env)?;
                let outside = Env::outside();
                self.spot(segments, &outside)
            }
        }
    }

    /// A member of the instance whose text it is, which can write it.
    fn member_of_own(
        &mut self,
        instance: Spot<'d>,
        first: &Segment,
        rest: &[Segment],
    ) -> Result<Spot<'d>, Lost> {
        let spot = self.step(instance, first)?;
        self.follow(Spot { inner: false, ..spot }, rest)
    }

    /// Reports a name of the file in a function block that has another meaning where the block is called.
    fn captured(&mut self, name: &Name, instance: &Spot<'d>, env: &Env<'_, 'd>) -> Result<(), Lost> {
        let (chart, locals) = env.root();
        let own = chart.and_then(|c| self.scope(c)?.get(&*name.text)).map(|v| v.at.0);
        let Some(own) = own.or_else(|| locals.contains(&name.text).then_some(instance.at)) else {
            return Ok(());
        };
        self.once(two_meanings(name, own));
        Err(Lost)
    }

    /// Reports a name in a function block that neither it nor the file has: in the calling chart, it would be that of
    /// a step there.
    fn foreign(&mut self, name: &Name) -> Lost {
        if name.text.is_empty() {
            return Lost; // The name could not be read; the parser has reported it.
        }
        let what = say!("neither this function block nor the file has a variable `{}`", name.text);
        self.once(Problem::new(&codes::UNKNOWN_NAME, name.at.0, what));
        Lost
    }

    /// A variable: `chart` is the chart that the path names, `home` the one that declares the variable.
    pub(super) fn start(
        &self,
        segment: &Segment,
        decl: &'d VarDecl,
        chart: Option<Name>,
        home: Option<&str>,
    ) -> Spot<'d> {
        Spot {
            home: home.map(Box::from),
            at: chart.as_ref().map_or(segment.name.at.0, |c| c.at.0.to(segment.name.at.0)),
            chart,
            text: segment.name.text.to_string(),
            index: Vec::new(),
            own: segment.index.clone(),
            of: self.type_of(decl),
            decl,
            within: None,
            inner: false,
            tail: Vec::new(),
            whole: false,
        }
    }

    fn follow(&mut self, mut spot: Spot<'d>, rest: &[Segment]) -> Result<Spot<'d>, Lost> {
        for (n, segment) in rest.iter().enumerate() {
            if spot.of.is_none() && spot.decl.of.is_none() {
                spot.tail = rest.iter().skip(n).map(|s| s.name.clone()).collect();
                return Ok(spot);
            }
            spot = self.step(spot, segment)?;
        }
        // A type that the file does not have is reported where it is named.
        if spot.of.is_none() && spot.decl.of.is_some() { Err(Lost) } else { Ok(spot) }
    }

    /// From a variable to one of its members.
    pub(super) fn step(&mut self, mut spot: Spot<'d>, segment: &Segment) -> Result<Spot<'d>, Lost> {
        let Some(of) = spot.of else { return Err(Lost) };
        let name = &segment.name;
        let Some(decl) = member(of, &name.text) else { return Err(self.no_member(of, name)) };
        if self.kept.has(of) {
            return Ok(self.member_of_kept(spot, of, decl, segment));
        }
        spot = self.entered(spot)?;
        if is_local(of, decl) && !spot.index.is_empty() {
            spot.text = self.numbered(&spot)?;
            spot.index.clear();
        }
        spot.text = format!("{}.{}", spot.text, name.text);
        spot.own = segment.index.clone();
        spot.inner |= of.block && decl.kind != VarKind::Input;
        spot.of = self.type_of(decl);
        spot.decl = decl;
        spot.at = spot.at.to(name.at.0);
        Ok(spot)
    }

    /// The same part, whose members can follow: the indexes behind its name have their places in it.
    pub(super) fn entered(&mut self, mut spot: Spot<'d>) -> Result<Spot<'d>, Lost> {
        let dimensions = spot.decl.array.as_ref().map_or(0, |a| a.dimensions.len());
        if spot.own.len() != dimensions && !(spot.own.is_empty() && spot.index.is_empty() && spot.whole) {
            let (has, given, text) = (dimensions, spot.own.len(), filled(&spot.text, &spot.index));
            let what = say!("the number of indexes of `{text}` is {has}; {given} stand here");
            return Err(self.lost(Problem::new(&codes::WRONG_ARGUMENTS, spot.at, what)));
        }
        if dimensions > 0 {
            spot.text = format!("{}[{}]", spot.text, ",".repeat(dimensions - 1));
        }
        spot.index.append(&mut spot.own);
        Ok(spot)
    }

    /// The name of a part with its indexes, which are numbers.
    pub(super) fn numbered(&mut self, spot: &Spot<'d>) -> Result<String, Lost> {
        match spot.index.iter().find(|e| e.kind.whole().is_none()) {
            None => Ok(filled(&spot.text, &spot.index)),
            Some(e) => {
                let what = say!("before an inner variable of a function block, the index is a number");
                Err(self.lost(Problem::new(&codes::NOT_CONSTANT, e.at.0, what)))
            }
        }
    }

    pub(super) fn lost(&mut self, problem: Problem) -> Lost {
        self.problems.push(problem);
        Lost
    }

    fn no_member(&mut self, of: &Composed, name: &Name) -> Lost {
        if name.text.is_empty() {
            return Lost; // The name could not be read; the parser has reported it.
        }
        let what = say!("`{}` has no member `{}`", of.name.text, name.text);
        let problem = Problem::new(&codes::UNKNOWN_MEMBER, name.at.0, what)
            .related(of.name.at.0, say!("declared here"));
        let members = of.members.iter().flat_map(|m| &m.names);
        let charts = self.owned.get(&*of.name.text).into_iter().flatten().map(|c| &c.name);
        let all: Vec<&str> = members.chain(charts).map(|n| &*n.text).collect();
        let problem = match crate::similar(&name.text, &all) {
            Some(near) => problem.meant(near),
            None => problem.help(say!("its members are {}", crate::Said::foreign(all.join(", ")))),
        };
        self.lost(problem)
    }

    /// Replaces the names in an expression.
    pub(super) fn expr(&mut self, e: &mut Expr, env: &Env<'_, 'd>) {
        self.memoryless(e, env);
        match &mut e.kind {
            ExprKind::Path(_) | ExprKind::Element(..) => self.replace(e, env, false),
            ExprKind::Unary(_, a) => self.expr(a, env),
            ExprKind::Binary(_, a, b) => [a, b].into_iter().for_each(|e| self.expr(e, env)),
            ExprKind::Timer { t1, e, t2 } => [t1, e].into_iter().chain(t2).for_each(|e| self.expr(e, env)),
            ExprKind::Call(_, args) => args.iter_mut().for_each(|a| self.expr(&mut a.value, env)),
            ExprKind::List(values) => values.iter_mut().for_each(|(_, e)| self.expr(e, env)),
            ExprKind::Literal(_) | ExprKind::Direct(_) | ExprKind::Bad => {}
        }
    }

    /// Reports an edge or a delay in a function block: these look at a value once in each pass, and a function block
    /// sees its inputs in each call.
    fn memoryless(&mut self, e: &Expr, env: &Env<'_, 'd>) {
        let help = match (&e.kind, env) {
            (ExprKind::Unary(UnaryOp::Rise | UnaryOp::Fall, _), Env::Block { .. }) => {
                say!("declare `var edge : R_TRIG` or `F_TRIG`, call it, and read its Q")
            }
            (ExprKind::Timer { .. }, Env::Block { .. }) => {
                say!("declare `var delayed : TON`, call it, and read its Q")
            }
            _ => return,
        };
        let what = say!("an edge or a delay cannot stand in a function block");
        self.once(Problem::new(&codes::NOT_HERE, e.at.0, what).help(help));
    }

    /// Replaces the names of a variable that gets a value.
    pub(super) fn target(&mut self, e: &mut Expr, env: &Env<'_, 'd>) {
        self.replace(e, env, true);
    }

    /// Replaces a path and the names in its indexes.
    fn replace(&mut self, e: &mut Expr, env: &Env<'_, 'd>, written: bool) {
        let kind = match self.meaning(e, env) {
            Ok(Meaning::Variable(spot)) => self.plain(*spot, written),
            Ok(Meaning::OfChart(kind)) => Some(kind),
            Err(Lost) => None,
            Ok(Meaning::Other) => {
                if let ExprKind::Element(_, index, _) = &mut e.kind {
                    index.iter_mut().for_each(|i| self.expr(i, env));
                }
                return;
            }
        };
        e.kind = kind.unwrap_or(ExprKind::Bad);
    }

    /// The variable that a path or an element leads to, with the names in its indexes replaced.
    pub(super) fn spot_of(&mut self, e: &Expr, env: &Env<'_, 'd>) -> Result<Option<Spot<'d>>, Lost> {
        match self.meaning(e, env)? {
            Meaning::Variable(spot) => Ok(Some(*spot)),
            Meaning::OfChart(_) | Meaning::Other => Ok(None),
        }
    }

    /// The meaning of a path or an element.
    fn meaning(&mut self, e: &Expr, env: &Env<'_, 'd>) -> Result<Meaning<'d>, Lost> {
        let (path, index, bit) = match &e.kind {
            ExprKind::Path(path) => (path, &[][..], None),
            ExprKind::Element(path, index, bit) => (&**path, index.as_slice(), bit.as_ref()),
            _ => return Ok(Meaning::Other),
        };
        let mut segments = self.segments(path, index, env);
        self.indexed(&mut segments, env);
        let charted = self.charted(&mut segments, env)?;
        let spot = match charted {
            true => self.spot(&segments, &Env::outside()),
            false => self.spot(&segments, env),
        }?;
        let bit = bit.map(|b| (**b).clone());
        let Some(mut spot) = spot else {
            return Ok(if charted { Meaning::OfChart(of_chart(segments, bit)) } else { Meaning::Other });
        };
        spot.tail.extend(bit);
        Ok(Meaning::Variable(Box::new(spot)))
    }

    /// The expression for a variable of an elementary type or an array of such.
    pub(super) fn plain(&mut self, spot: Spot<'d>, written: bool) -> Option<ExprKind> {
        if let Some(of) = spot.of {
            let text = spot.shown();
            let what = if of.block {
                say!("`{text}` is an instance of `{}`; it is no value", of.name.text)
            } else {
                say!("`{text}` is a structure of `{}`; here is a place for one of its members", of.name.text)
            };
            return self.report(
                Problem::new(&codes::WRONG_KIND, spot.at, what).related(of.name.at.0, say!("declared here")),
            );
        }
        if written && spot.inner {
            let what = say!("only the function block itself gives `{}` a value", spot.shown());
            let help = say!("its inputs can be written");
            return self.report(Problem::new(&codes::NOT_WRITABLE, spot.at, what).help(help));
        }
        Some(spot.kind())
    }
}

impl Spot<'_> {
    /// The same, where indexes that are left out mean whole arrays.
    pub(super) fn whole(self) -> Self {
        Spot { whole: true, ..self }
    }

    /// As an author writes it.
    pub(super) fn shown(&self) -> String {
        filled(&self.text, &self.index)
    }

    /// The expression.
    pub(super) fn kind(self) -> ExprKind {
        let mut names: Vec<Name> = self.chart.into_iter().collect();
        names.push(Name::new(self.text, self.at));
        names.extend(self.within.map(|(_, member)| member));
        let mut tail = self.tail;
        let index: Vec<Expr> = self.index.into_iter().chain(self.own).collect();
        if index.is_empty() {
            names.append(&mut tail);
            return ExprKind::Path(Path { names });
        }
        let bit = tail.pop().map(Box::new);
        names.append(&mut tail);
        ExprKind::Element(Box::new(Path { names }), index, bit)
    }
}

/// A name of the file in a type that has another meaning where a variable of the type stands.
pub(super) fn two_meanings(name: &Name, own: Span) -> Problem {
    let what = say!("`{}` also has a meaning where this function block is called", name.text);
    let help = say!(
        "a function block sees its own variables and those of the file; give one of the two another name"
    );
    Problem::new(&codes::DEFINED_TWICE, name.at.0, what).related(own, say!("in this chart")).help(help)
}

/// The member of a type.
pub(super) fn member<'d>(of: &'d Composed, name: &str) -> Option<&'d VarDecl> {
    of.members.iter().find(|m| m.names.iter().any(|n| &*n.text == name))
}

/// A name with its indexes: `m[3].x` for `m[].x`; what is no number stays as `…`.
pub(super) fn filled(text: &str, index: &[Expr]) -> String {
    let numbers: Vec<String> =
        index.iter().map(|e| e.kind.whole().map_or_else(|| "…".to_owned(), |n| n.to_string())).collect();
    crate::filled(text, &numbers).0
}

/// The index in a name: `d[3]`, `d[i + 1]`.
fn number_of(index: Index<'_>, at: Place) -> Expr {
    let whole = |n: i64| Expr { kind: ExprKind::Literal(Literal::Int(n.into(), None)), at };
    match index {
        Index::Number(n) => whole(n),
        Index::Parameter(name, added) => {
            let name = Path { names: vec![Name { text: name.into(), at }] };
            let value = Expr { kind: ExprKind::Path(name), at };
            let op = if added < 0 { BinaryOp::Sub } else { BinaryOp::Add };
            match added {
                0 => value,
                n => Expr {
                    kind: ExprKind::Binary(op, Box::new(value), Box::new(whole(n.saturating_abs()))),
                    at,
                },
            }
        }
    }
}

/// A path to a step of a chart. An index or a bit, which a step does not have, is told later.
fn of_chart(segments: Vec<Segment>, bit: Option<Name>) -> ExprKind {
    let index: Vec<Expr> = segments.iter().flat_map(|s| s.index.iter().cloned()).collect();
    let path = Path { names: segments.into_iter().map(|s| s.name).chain(bit).collect() };
    match index.is_empty() {
        true => ExprKind::Path(path),
        false => ExprKind::Element(Box::new(path), index, None),
    }
}

/// The place of a whole path.
pub(super) fn at_of(segments: &[Segment]) -> Span {
    match (segments.first(), segments.last()) {
        (Some(first), Some(last)) => first.name.at.0.to(last.name.at.0),
        _ => Span::default(),
    }
}

/// The name of a path that has no other, if an expression is such a path.
pub(super) fn one_name(kind: ExprKind) -> Option<Name> {
    match kind {
        ExprKind::Path(path) => <[Name; 1]>::try_from(path.names).ok().map(|[name]| name),
        _ => None,
    }
}
