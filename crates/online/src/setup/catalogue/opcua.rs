//! The rows of OPC UA: servers, and the server of our own.

use super::row::{
    Argument, BAD, Carries, Form, GOOD, PASSWORD_FILE, PASSWORD_VARIABLE, Point, SCALE, Setting, Usual,
    setting, times,
};

const SECURITY: Setting = setting(
    "security",
    Form::Words(&["none", "sign", "sign-and-encrypt"]),
    Usual::Is("\"sign-and-encrypt\""),
    "the security of its connections",
);

pub(super) const CLIENT: &[Setting] = &[
    setting("url", Form::Text, Usual::Needed("opc.tcp://10.0.0.7:4840"), "its address"),
    SECURITY,
    setting(
        "policy",
        Form::Words(&["Basic256Sha256", "Aes128-Sha256-RsaOaep", "Aes256-Sha256-RsaPss"]),
        Usual::None("Basic256Sha256"),
        "the algorithms of signature and encryption",
    ),
    setting("user", Form::Text, Usual::None("sorter"), "the user that the server knows"),
    PASSWORD_FILE,
    PASSWORD_VARIABLE,
    setting(
        "certificates",
        Form::Text,
        Usual::Is("\"opcua-certificates\""),
        "the folder of the certificates, beside the io file",
    ),
    setting(
        "interval",
        Form::Duration("10ms", "60s"),
        Usual::Is("\"100ms\""),
        "the time between two messages of the server",
    ),
    setting(
        "keep-alive",
        Form::Duration("100ms", "1h"),
        Usual::Is("\"1s\""),
        "the time between two signs of life of the server; without three of them it is gone",
    ),
    setting(
        "uncertain",
        Form::Words(&["bad", "good"]),
        Usual::Is("\"bad\""),
        "how a value counts that the server calls uncertain",
    ),
];

pub(super) const CLIENT_TIMES: &[Setting] = &times("\"2s\"");

pub(super) const SERVER: &[Setting] = &[
    setting("listen", Form::Text, Usual::Needed("127.0.0.1:4840"), "an address of this machine, with a port"),
    SECURITY,
    setting(
        "anonymous",
        Form::Words(&["refuse", "read"]),
        Usual::None("read"),
        "what clients without a user may do; without users and without this they write too",
    ),
    setting(
        "expose",
        Form::Words(&["shown", "all"]),
        Usual::Is("\"shown\""),
        "the things that clients see: those that are wired to it, or the whole chart",
    ),
    setting(
        "certificates",
        Form::Text,
        Usual::None("opcua-scada"),
        "the folder of the certificates, beside the io file",
    ),
    setting(
        "silence",
        Form::Duration("1s", "1h"),
        Usual::Is("\"30s\""),
        "a client without a request for so long is gone",
    ),
];

const FORM_OF_NODE: &[Setting] = &[setting(
    "as",
    Form::Words(&["u16", "i16", "u32", "i32", "u64", "i64", "f32", "f64"]),
    Usual::None("u16"),
    "the form of the number in the node; that of the type of the variable without it",
)];

const UNIT: &[Setting] =
    &[setting("unit", Form::Text, Usual::None("m/s"), "the unit, which is shown with the value")];

/// The points of a server of OPC UA.
pub(super) const NODES: &[Point] = &[
    Point {
        word: "node",
        argument: Argument::Text("ns=2;s=Tank.Level"),
        carries: Carries::Any,
        input: true,
        output: true,
        of_input: &[FORM_OF_NODE, SCALE, BAD],
        of_output: &[FORM_OF_NODE, SCALE],
        about: "a node of the server",
    },
    GOOD,
];

/// The points of the server of our own.
pub(super) const OWN_NODES: &[Point] = &[
    Point {
        word: "node",
        argument: Argument::TextOrName("Level"),
        carries: Carries::Any,
        input: true,
        output: true,
        of_input: &[FORM_OF_NODE, SCALE, UNIT, BAD],
        of_output: &[FORM_OF_NODE, SCALE, UNIT],
        about: "a node by this name",
    },
    Point { about: "TRUE while a client is there", ..GOOD },
];
