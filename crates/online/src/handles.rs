//! How a variable is wired to a part of a panel.
//!
//! Pure: `wiring` holds the channel against the chart and the device, and asks here for the rest.

use g7_host::Kind;
use g7_model::{Said, say};

use crate::messages::Refused;
use crate::part::{Part, number};
use crate::setup::{self, Channel, Handle, Point};
use crate::value::Scaling;
use crate::wire::Wire;

/// The part of a panel that a channel names, and how its value becomes a word.
pub(crate) fn wire(
    channel: &Channel,
    (name, kind): (&str, Kind),
    input: bool,
) -> Result<(Wire, Scaling), Refused> {
    let refused = |at, what: Said, help: Option<Said>| Refused { at, what, help };
    let Point::Panel(handle) = &channel.point else {
        let what = say!("`{}` is no point of a panel", channel.point);
        let help =
            say!("its points are button(), switch(), number(), choice(A1, F1), page(), lamp(green), value()");
        return Err(refused(channel.at, what, Some(help)));
    };
    if handle.is_input() != input {
        let what = match handle.is_input() {
            true => say!("`{handle}` is an input"),
            false => say!("`{handle}` is an output"),
        };
        let help = say!("a person moves button, switch, number and choice; lamp and value show an output");
        return Err(refused(channel.at, what, Some(help)));
    }
    let fits = match (handle, kind) {
        (_, Kind::Text) => false,
        (Handle::Button | Handle::Switch | Handle::Page | Handle::Lamp(_), kind) => kind == Kind::Bool,
        (Handle::Number, kind) => kind != Kind::Bool,
        (Handle::Choice(words), Kind::Int { bits, signed }) => {
            let most = if signed { bits.saturating_sub(1) } else { bits };
            most >= 63 || words.len() <= 1 << most
        }
        (Handle::Choice(_), _) => false,
        (Handle::Value, _) => true,
    };
    if !fits {
        let what = say!("`{handle}` cannot carry `{name}`");
        let help =
            say!("button, switch, page and lamp are BOOL, a choice is a whole number, a number is one");
        return Err(refused(channel.at, what, Some(help)));
    }
    let numbers = [&channel.scale, &channel.offset].into_iter().flatten().map(|n| n.at);
    let other = numbers.chain(channel.encoding.as_ref().map(|e| e.at)).chain(channel.message.first());
    if let Some(at) = other.into_iter().next() {
        let what = say!("a panel has no scale, offset, form of number or messages");
        return Err(refused(at, what, None));
    }
    if let (Some(at), false) = (channel.limits.first(), *handle == Handle::Number) {
        return Err(refused(at, say!("`{handle}` has no limits: `number()` has them"), None));
    }
    // TRUE is pressed, whatever the contact of a real button would be.
    let scaling = Scaling::plain(kind);
    let limit = |at: &Option<setup::At<f64>>| at.as_ref().map(|x| x.value);
    let setup::Limits { min, max, initial } = &channel.limits;
    if let Some(initial) = initial.as_ref().filter(|x| scaling.word(number(x.value)).is_none()) {
        return Err(refused(initial.at, say!("`{name}` cannot have this value"), None));
    }
    let part = Part { handle: handle.clone(), min: limit(min), max: limit(max), initial: limit(initial) };
    Ok((Wire::Panel(part), scaling))
}
