//! The code that a `say!` stands for.

use proc_macro::{Delimiter, Group, Ident, Literal, Punct, Spacing, Span, TokenStream, TokenTree};

use crate::template::{holes, unquoted};

type Refused = (Span, &'static str);

/// `Said::plain(text)`, or `Said::filled(text, vec![parts])`.
pub(crate) fn expand(input: TokenStream) -> Result<TokenStream, Refused> {
    let mut rest = input.into_iter();
    let literal = match rest.next() {
        Some(first) => literal(first)?,
        None => return Err((Span::call_site(), "a text is needed")),
    };
    let at = literal.span();
    let text = unquoted(&literal.to_string()).ok_or((at, "a text is needed"))?;
    let (holes, plain) = holes(&text).map_err(|why| (at, why))?;
    let args = arguments(rest.collect());
    let place = TokenTree::Literal(literal);
    if holes.is_empty() {
        let plain: TokenTree = Literal::string(&plain).into();
        return match args.is_empty() {
            true => Ok(call("Said", "plain", &[place.into(), plain.into()], at)),
            false => Err((at, "an argument is not used")),
        };
    }
    let mut used = vec![false; args.len()];
    let (mut next, mut parts) = (0, TokenStream::new());
    for hole in holes {
        let found = if hole.name.is_empty() {
            let found = (next..args.len()).find(|k| args.get(*k).is_some_and(|a| a.0.is_none()));
            next = found.ok_or((at, "an argument is missing"))? + 1;
            found
        } else {
            args.iter().position(|a| a.0.as_deref() == Some(&*hole.name))
        };
        let value: TokenStream = match found {
            Some(k) => {
                used[k] = true;
                args.get(k).map(|a| a.1.clone()).unwrap_or_default()
            }
            None => TokenTree::from(Ident::new(&hole.name, at)).into(),
        };
        let value = if hole.form.is_empty() { value } else { formatted(&hole.form, value, at) };
        let way = if hole.quoted || !hole.form.is_empty() { "raw" } else { "spoken" };
        let borrowed = [punct('&', at), TokenTree::Group(Group::new(Delimiter::Parenthesis, value))];
        parts.extend(call("Part", way, &[borrowed.into_iter().collect()], at));
        parts.extend([punct(',', at)]);
    }
    if used.contains(&false) {
        return Err((at, "an argument is not used"));
    }
    let mut list: TokenStream = path(&["std", "vec"], at);
    list.extend([punct('!', at), TokenTree::Group(Group::new(Delimiter::Bracket, parts))]);
    Ok(call("Said", "filled", &[place.into(), list], at))
}

/// An error of the compiler at a place.
pub(crate) fn refused(at: Span, why: &str) -> TokenStream {
    let mut made = path(&["std", "compile_error"], at);
    let why = TokenTree::Literal(Literal::string(why));
    made.extend([punct('!', at), TokenTree::Group(Group::new(Delimiter::Parenthesis, why.into()))]);
    made
}

fn literal(token: TokenTree) -> Result<Literal, Refused> {
    match token {
        TokenTree::Literal(literal) => Ok(literal),
        TokenTree::Group(group) if group.delimiter() == Delimiter::None => {
            literal(group.stream().into_iter().next().ok_or((group.span(), "a text is needed"))?)
        }
        other => Err((other.span(), "the text stands here as it is, in quotation marks")),
    }
}

/// The arguments behind the text: a name, if one is given, and the value.
fn arguments(tokens: Vec<TokenTree>) -> Vec<(Option<String>, TokenStream)> {
    let comma = |t: &TokenTree| matches!(t, TokenTree::Punct(p) if p.as_char() == ',');
    let lists = tokens.split(comma).filter(|list| !list.is_empty());
    lists
        .map(|list| match list {
            [TokenTree::Ident(name), TokenTree::Punct(sign), value @ ..]
                if sign.as_char() == '=' && sign.spacing() == Spacing::Alone =>
            {
                (Some(name.to_string()), value.iter().cloned().collect())
            }
            _ => (None, list.iter().cloned().collect()),
        })
        .collect()
}

/// `std::format!("{:form}", value)`
fn formatted(form: &str, value: TokenStream, at: Span) -> TokenStream {
    let form = TokenTree::Literal(Literal::string(&format!("{{:{form}}}")));
    let mut inside: TokenStream = form.into();
    inside.extend([punct(',', at)]);
    inside.extend(value);
    let mut made = path(&["std", "format"], at);
    made.extend([punct('!', at), TokenTree::Group(Group::new(Delimiter::Parenthesis, inside))]);
    made
}

/// `::g7_model::owner::name(args)`
fn call(owner: &str, name: &str, args: &[TokenStream], at: Span) -> TokenStream {
    let mut inside = TokenStream::new();
    for arg in args {
        inside.extend(arg.clone());
        inside.extend([punct(',', at)]);
    }
    let mut made = path(&["g7_model", owner, name], at);
    made.extend([TokenTree::Group(Group::new(Delimiter::Parenthesis, inside))]);
    made
}

/// `::a::b::c`
fn path(names: &[&str], at: Span) -> TokenStream {
    let mut made = TokenStream::new();
    for name in names {
        let colon = TokenTree::Punct(Punct::new(':', Spacing::Joint));
        made.extend([colon, punct(':', at), TokenTree::Ident(Ident::new(name, at))]);
    }
    made
}

fn punct(sign: char, at: Span) -> TokenTree {
    let mut punct = Punct::new(sign, Spacing::Alone);
    punct.set_span(at);
    TokenTree::Punct(punct)
}
