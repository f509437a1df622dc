//! The deeds of a person at a panel: a wish becomes a movement of one of its parts.

use std::sync::Arc;

use g7_host::Value;
use g7_online::setup::Handle;
use g7_online::{Moved, Panels, Part};

use super::names::Names;
use super::order::Wish;
use super::stage::Asker;
use super::told::Told;

/// The hand of the terminal; those of pages are addresses, which are never 0.
const TERMINAL: u64 = 0;

/// Does what a wish says to a panel. Returns what is to be told; nothing where it is no news.
pub(crate) fn operate(
    panels: &Panels,
    names: &Names,
    wish: &Wish,
    by: &Asker,
) -> Result<Option<Told>, String> {
    let hand = match by {
        Asker::Line => TERMINAL,
        Asker::Page(outbox, ..) => Arc::as_ptr(outbox).addr() as u64,
    };
    let (name, moved, shown) = match wish {
        Wish::Press { name, down } => {
            let (name, _) = names.part(name)?;
            (name, if *down { Moved::Pressed } else { Moved::Released }, None)
        }
        Wish::Set { name, value } => {
            let (name, part) = names.part(name)?;
            let (number, shown) = number(names, name, part, value)?;
            (name, Moved::Set(number), Some(shown))
        }
        _ => return Err("this is no deed at a panel".to_owned()),
    };
    let news = panels.set(name, hand, moved)?;
    let who = match by {
        Asker::Line => Some("terminal".to_owned()),
        Asker::Page(outbox, ..) => Some(outbox.who().name.clone()).filter(|name| !name.is_empty()),
    };
    Ok(news.then(|| Told::Moved { name: name.to_owned(), value: shown, who }))
}

/// The number of a value as a person gives it, and how it is told.
fn number(names: &Names, name: &str, part: &Part, text: &str) -> Result<(f64, String), String> {
    if let Handle::Choice(words) = &part.handle {
        let place = words.iter().position(|word| word == text.trim());
        let place = place.ok_or_else(|| format!("`{name}` is one of {}", words.join(", ")))?;
        return Ok((place as f64, text.trim().to_owned()));
    }
    let item = names.bench.item(name).ok_or_else(|| names.bench.unknown(name).to_string())?;
    let value = item.read(text).map_err(|e| e.to_string())?;
    let word = match value {
        Value::Word(word) => word,
        Value::Text(_) => return Err(format!("`{name}` is a text")),
    };
    let plain = g7_online::Scaling::plain(item.kind).raw(word).0;
    let number = match plain {
        g7_online::Raw::Bit(on) => f64::from(u8::from(on)),
        g7_online::Raw::Whole(n) => n as f64,
        g7_online::Raw::Real(x) => x,
    };
    Ok((number, item.show(&Value::Word(word))))
}
