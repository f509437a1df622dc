//! The contents of an io file as data: the kinds of devices with their settings, their points, and what a
//! channel says of each point. The wizard of the page makes its forms of it.
//!
//! The reader (`device`, `broker`, `point`) decides what is accepted. `tests/all/catalogue.rs` holds the two
//! together: it gives the reader each setting as it is written here, with its limits, its words and its
//! default, and compares what the reader asks for with what stands here. A kind without a row fails it.

mod opcua;
mod row;

pub use row::{Argument, Carries, Form, KindRow, Point, Setting, Usual};
use row::{BAD, GOOD, PASSWORD_FILE, PASSWORD_VARIABLE, SCALE, setting, times};

/// All kinds of devices, in the order in which a person is shown them.
pub const KINDS: &[KindRow] = &[
    KindRow {
        word: "modbus-tcp",
        about: "a server of Modbus TCP, which G7 asks",
        settings: &[TCP, MODBUS, DEVICE_TIMES],
        points: REGISTERS,
        shows: false,
    },
    KindRow {
        word: "modbus-rtu",
        about: "a slave of Modbus RTU on a serial line, which G7 asks",
        settings: &[SERIAL, MODBUS, DEVICE_TIMES],
        points: REGISTERS,
        shows: false,
    },
    KindRow {
        word: "modbus-server",
        about: "masters of Modbus TCP, which ask G7",
        settings: &[LISTEN],
        points: TABLES,
        shows: true,
    },
    KindRow {
        word: "mqtt",
        about: "a broker of MQTT 5",
        settings: &[BROKER, BROKER_TIMES],
        points: MESSAGES,
        shows: true,
    },
    KindRow {
        word: "opc-ua",
        about: "a server of OPC UA",
        settings: &[opcua::CLIENT, opcua::CLIENT_TIMES],
        points: opcua::NODES,
        shows: false,
    },
    KindRow {
        word: "opc-ua-server",
        about: "clients of OPC UA, which G7 is the server of",
        settings: &[opcua::SERVER],
        points: opcua::OWN_NODES,
        shows: true,
    },
    KindRow {
        word: "s7",
        about: "a controller of Siemens, which G7 asks",
        settings: &[S7, DEVICE_TIMES],
        points: CELLS,
        shows: false,
    },
    KindRow {
        word: "gpio",
        about: "lines of this machine",
        settings: &[CHIP, DEVICE_TIMES],
        points: LINES,
        shows: false,
    },
    KindRow {
        word: "panel",
        about: "buttons and lamps on the operator page",
        settings: &[PANEL],
        points: HANDLES,
        shows: true,
    },
];

/// The settings of `[controller]`.
pub const CONTROLLER: &[Setting] = &[
    setting("period", Form::Duration("100us", "60s"), Usual::None("10ms"), "the time between two scans"),
    setting(
        "watchdog",
        Form::Duration("1ms", "1h"),
        Usual::None("250ms"),
        "the longest time between the ends of two steps",
    ),
    setting("start", Form::Words(&["run", "stop"]), Usual::Is("\"run\""), "what it does when G7 starts"),
    setting("retain", Form::Text, Usual::None("sorter.values"), "the file of the values that are kept"),
    setting(
        "changed",
        Form::Words(&["refuse", "cold", "fit"]),
        Usual::Is("\"refuse\""),
        "what happens with kept values of another chart",
    ),
    setting("priority", Form::Whole(1, 99), Usual::None("80"), "the priority of the scan"),
    setting(
        "metrics",
        Form::Text,
        Usual::None("127.0.0.1:9464"),
        "an address of this machine where a monitoring system asks",
    ),
    setting("log", Form::Text, Usual::None("sorter.log"), "the file of the log of events and deeds"),
    setting("log-days", Form::Whole(1, 36_500), Usual::None("400"), "rows of the log that are older go"),
    setting("log-mib", Form::Whole(1, 100_000), Usual::None("100"), "the greatest size of the log, in MiB"),
];

const TCP: &[Setting] = &[
    setting("host", Form::Text, Usual::Needed("10.0.0.7"), "its name or address"),
    setting("port", Form::Whole(1, 65_535), Usual::Is("502"), "its port"),
];

const SERIAL: &[Setting] = &[
    setting("port", Form::Text, Usual::Needed("/dev/ttyUSB0"), "the serial port"),
    setting("baud", Form::Whole(300, 4_000_000), Usual::Is("19200"), "bits per second"),
    setting("parity", Form::Words(&["even", "odd", "none"]), Usual::Is("\"even\""), "the parity bit"),
    setting("stop-bits", Form::Whole(1, 2), Usual::Is("1"), "stop bits"),
];

const MODBUS: &[Setting] =
    &[setting("unit", Form::Whole(0, 247), Usual::Is("1"), "the unit or slave"), WORD_ORDER];

const WORD_ORDER: Setting = setting(
    "words",
    Form::Words(&["high-first", "low-first"]),
    Usual::Is("\"high-first\""),
    "the order of numbers in several registers",
);

const DEVICE_TIMES: &[Setting] = &times("\"500ms\"");

const LISTEN: &[Setting] = &[
    setting("listen", Form::Text, Usual::Needed("127.0.0.1:1502"), "an address of this machine, with a port"),
    setting(
        "access",
        Form::Words(&["this-machine", "anyone"]),
        Usual::Is("\"this-machine\""),
        "who may reach it: Modbus has no users and no keys",
    ),
    setting(
        "silence",
        Form::Duration("100ms", "1h"),
        Usual::Is("\"5s\""),
        "without a request for so long there is no master",
    ),
    WORD_ORDER,
];

const BROKER: &[Setting] = &[
    setting("host", Form::Text, Usual::Needed("10.0.0.7"), "its name or address"),
    setting("port", Form::Whole(1, 65_535), Usual::Is("1883"), "its port"),
    setting("user", Form::Text, Usual::None("sorter"), "the user that the broker knows"),
    PASSWORD_FILE,
    PASSWORD_VARIABLE,
    setting("client-id", Form::Text, Usual::None("sorter"), "the name of this client"),
    setting(
        "keep-alive",
        Form::Duration("1s", "1h"),
        Usual::Is("\"10s\""),
        "a broker that is silent for twice as long is gone",
    ),
    setting("status", Form::Text, Usual::None("plant/status"), "a topic that says online or offline"),
    setting(
        "tls",
        Form::FlagOrTable(&[
            setting("ca", Form::Text, Usual::None("ca.pem"), "the file of the certificates that are trusted"),
            setting(
                "certificate",
                Form::Text,
                Usual::None("sorter.pem"),
                "the file of the certificate of this client",
            ),
            setting("key", Form::Text, Usual::None("sorter.key"), "the file of its key"),
        ]),
        Usual::Is("false"),
        "the connection is encrypted; the port is then 8883",
    ),
    setting(
        "events",
        Form::Table(&[
            setting("topic", Form::Text, Usual::Needed("plant/sorter/events"), "the topic of the events"),
            setting("file", Form::Text, Usual::None("hub.events"), "the file in which they wait"),
            setting("most", Form::Whole(100, 10_000_000), Usual::Is("100000"), "events that wait at most"),
            setting("bytes", Form::Whole(100_000, 1 << 40), Usual::Is("67108864"), "bytes of them at most"),
        ]),
        Usual::None(""),
        "the events of the controller are published",
    ),
    setting(
        "sparkplug",
        Form::Table(&[
            setting("group", Form::Text, Usual::Needed("plant"), "the group"),
            setting("node", Form::Text, Usual::Needed("sorter"), "the edge node"),
            setting("device", Form::Text, Usual::None("plc"), "the device"),
        ]),
        Usual::None(""),
        "Sparkplug B in place of plain topics",
    ),
];

const BROKER_TIMES: &[Setting] = &[
    setting("poll", Form::Duration("1ms", "1h"), Usual::Is("\"20ms\""), "the time between two exchanges"),
    setting("timeout", Form::Duration("1ms", "1h"), Usual::Is("\"2s\""), "the longest time of an answer"),
    setting(
        "refresh",
        Form::Duration("1ms", "1h"),
        Usual::None("1m"),
        "outputs that did not change are published again after this time",
    ),
    setting(
        "retry",
        Form::Duration("10ms", "1h"),
        Usual::Is("\"2s\""),
        "the longest time between two attempts to reach it",
    ),
];

const S7: &[Setting] = &[
    setting("host", Form::Text, Usual::Needed("10.0.0.8"), "its name or address"),
    setting("port", Form::Whole(1, 65_535), Usual::Is("102"), "its port"),
    setting("rack", Form::Whole(0, 7), Usual::Is("0"), "the rack of its processor"),
    setting("slot", Form::Whole(0, 31), Usual::Is("1"), "the slot of its processor"),
    setting(
        "connection",
        Form::Words(&["programmer", "panel", "basic"]),
        Usual::Is("\"programmer\""),
        "the kind of connection that it gives",
    ),
];

const CHIP: &[Setting] =
    &[setting("chip", Form::Text, Usual::Needed("/dev/gpiochip0"), "the device file of the chip")];

const PANEL: &[Setting] = &[
    setting(
        "release",
        Form::Duration("300ms", "10s"),
        Usual::Is("\"1s\""),
        "a button is released when its page has been silent for so long",
    ),
    setting("press", Form::Duration("10ms", "10s"), Usual::Is("\"200ms\""), "a press lasts at least so long"),
];

const FORM_OF_NUMBER: &[Setting] = &[setting(
    "as",
    Form::Words(&["u16", "i16", "u32", "i32", "u64", "i64", "f32", "f64"]),
    Usual::None("u16"),
    "the form of the number in registers; that of the type of the variable without it",
)];

const PIN: &[Setting] = &[
    setting(
        "bias",
        Form::Words(&["pull-up", "pull-down", "none"]),
        Usual::None("pull-up"),
        "the resistor at the line; as the line has it without it",
    ),
    setting("active-low", Form::Flag, Usual::Is("false"), "TRUE is the low level"),
];

const DEBOUNCE: &[Setting] = &[setting(
    "debounce",
    Form::Duration("1us", "4s"),
    Usual::None("5ms"),
    "an input has to be steady for so long",
)];

const MESSAGE: &[Setting] = &[
    setting("field", Form::Text, Usual::None("level"), "the field of a JSON object, or a pointer"),
    setting("qos", Form::Whole(0, 1), Usual::Is("1"), "the quality of service"),
];

const SILENCE: &[Setting] = &[setting(
    "silence",
    Form::Duration("10ms", "24h"),
    Usual::None("10s"),
    "without a message for so long the input is bad",
)];

const PUBLISHED: &[Setting] = &[
    setting("retain", Form::Flag, Usual::Is("true"), "the broker keeps the last value"),
    setting("will", Form::Flag, Usual::Is("false"), "its safe value is the last will"),
];

const LIMITS: &[Setting] = &[
    setting("min", Form::Number, Usual::None("0"), "the least number that can be entered"),
    setting("max", Form::Number, Usual::None("100"), "the greatest number that can be entered"),
];

const INITIAL: &[Setting] =
    &[setting("initial", Form::Number, Usual::None("20"), "its value until a person gives one")];

const fn bits(word: &'static str, input: bool, output: bool, about: &'static str) -> Point {
    Point {
        word,
        argument: Argument::Address(u16::MAX),
        carries: Carries::Bit,
        input,
        output,
        of_input: &[BAD],
        of_output: &[],
        about,
    }
}

const fn numbers(word: &'static str, input: bool, output: bool, about: &'static str) -> Point {
    Point {
        carries: Carries::Number,
        of_input: &[FORM_OF_NUMBER, SCALE, BAD],
        of_output: &[FORM_OF_NUMBER, SCALE],
        ..bits(word, input, output, about)
    }
}

const fn one_bit(word: &'static str, input: bool, output: bool, about: &'static str) -> Point {
    Point { argument: Argument::Bit(u16::MAX), ..bits(word, input, output, about) }
}

/// The points of a device of Modbus that G7 asks.
const REGISTERS: &[Point] = &[
    bits("coil", true, true, "a bit that can be written"),
    bits("discrete", true, false, "a bit that can only be read"),
    numbers("input", true, false, "a number in registers that can only be read"),
    numbers("holding", true, true, "a number in registers that can be written"),
    one_bit("input", true, false, "one bit of a register that can only be read"),
    one_bit("holding", true, true, "one bit of a register that can be written"),
    GOOD,
];

/// The points of a server of Modbus.
const TABLES: &[Point] = &[
    bits("coil", true, true, "a bit that a master writes"),
    bits("discrete", false, true, "a bit that a master only reads"),
    numbers("input", false, true, "a number that a master only reads"),
    numbers("holding", true, true, "a number that a master writes"),
    one_bit("input", false, true, "one bit of a register that a master only reads"),
    one_bit("holding", true, true, "one bit of a register that a master writes"),
    Point { about: "TRUE while a master asks", ..GOOD },
];

/// The points of a controller of Siemens.
const CELLS: &[Point] = &[
    Point {
        argument: Argument::Alone("DB1.DBX0.0"),
        ..bits("", true, true, "a bit: DB1.DBX0.0, M0.0, I0.0, Q0.0")
    },
    Point {
        argument: Argument::Alone("DB1.DBW2"),
        ..numbers("", true, true, "a number: B is a byte, W two, D four: DB1.DBW2, MD4")
    },
    GOOD,
];

/// The points of a chip of this machine.
const LINES: &[Point] = &[
    Point {
        of_input: &[PIN, DEBOUNCE, BAD],
        of_output: &[PIN],
        ..bits("line", true, true, "a line of the chip")
    },
    GOOD,
];

const MESSAGES: &[Point] = &[
    Point {
        word: "topic",
        argument: Argument::Text("plant/level"),
        carries: Carries::Any,
        input: true,
        output: true,
        of_input: &[MESSAGE, SCALE, SILENCE, BAD],
        of_output: &[MESSAGE, SCALE, PUBLISHED],
        about: "the messages of a topic",
    },
    Point {
        word: "metric",
        argument: Argument::TextOrName("Tank/Level"),
        carries: Carries::Any,
        input: true,
        output: true,
        of_input: &[SCALE, BAD],
        of_output: &[SCALE],
        about: "a metric of Sparkplug",
    },
    GOOD,
];

const fn handle(word: &'static str, carries: Carries, about: &'static str) -> Point {
    Point {
        word,
        argument: Argument::Nothing,
        carries,
        input: true,
        output: false,
        of_input: &[],
        of_output: &[],
        about,
    }
}

/// The colours of lamps.
pub const LAMPS: &[&str] = &["green", "red", "yellow", "blue", "white"];

const HANDLES: &[Point] = &[
    handle("button", Carries::Bit, "TRUE while it is pressed"),
    handle("switch", Carries::Bit, "TRUE while it is on; off after a start of G7"),
    Point {
        of_input: &[LIMITS, INITIAL, BAD],
        ..handle("number", Carries::Number, "a number that a person enters")
    },
    Point {
        argument: Argument::List("A1, F1, F4"),
        ..handle("choice", Carries::Whole, "one of some words: 0 for the first, 1 for the second")
    },
    handle("page", Carries::Bit, "TRUE while an operator page is open"),
    Point {
        argument: Argument::Word(LAMPS),
        input: false,
        output: true,
        ..handle("lamp", Carries::Bit, "a lamp")
    },
    Point { input: false, output: true, ..handle("value", Carries::Any, "a value") },
];

/// The row of a kind.
pub fn kind(word: &str) -> Option<&'static KindRow> {
    KINDS.iter().find(|kind| kind.word == word)
}
