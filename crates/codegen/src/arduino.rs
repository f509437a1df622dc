//! The sketch round the C code: pins from addresses, `millis()` as the clock.

use std::fmt::Write as _;

use g7_compile::ir::VarClass;
use g7_compile::symbols::Variable;
use g7_model::Type;

use crate::build::Gen;
use crate::c_words::comment;
use crate::room::{Clock, Room};

/// The use of a pin.
struct Pin {
    constant: String,
    field: String,
    ty: Type,
    inverted: bool,
    /// As the sketch writes it; none where the chart names no pin.
    number: Option<String>,
    note: String,
}

/// `13`, `A0`, `D5` as they are; `%I0.3`, `%Q0.3` have no pin of their own.
fn pin_of(address: &str) -> Option<String> {
    let plain = address.trim();
    let digits = plain.strip_prefix(['D', 'd']).unwrap_or(plain);
    if !digits.is_empty() && digits.len() <= 3 && digits.chars().all(|c| c.is_ascii_digit()) {
        return Some(digits.to_owned());
    }
    let analog = plain.strip_prefix(['A', 'a'])?;
    (!analog.is_empty() && analog.len() <= 2 && analog.chars().all(|c| c.is_ascii_digit()))
        .then(|| format!("A{analog}"))
}

fn pins(g: &Gen<'_>, class: VarClass) -> Vec<Pin> {
    let fits =
        |v: &&Variable| v.class == class && v.elements == 1 && !matches!(v.ty, Type::Fb(_) | Type::String(_));
    let pin = |v: &Variable| {
        let field = g.vars.slot(v.addr.0).map_or(String::new(), |s| s.field.clone());
        let address = v.address.as_deref().unwrap_or("");
        let place = if address.is_empty() { String::new() } else { format!(" at {address}") };
        Pin {
            constant: format!("PIN_{}", field.to_uppercase()),
            field,
            ty: v.ty,
            inverted: v.inverted,
            number: pin_of(address),
            note: comment(&format!("{}{place}", v.name)).replace('\n', " "),
        }
    };
    g.c.symbols.variables.iter().filter(fits).map(pin).collect()
}

/// How a pin is read into a field.
fn read(p: &Pin) -> String {
    match p.ty {
        Type::Bool => format!("digitalRead({}) == {}", p.constant, if p.inverted { "LOW" } else { "HIGH" }),
        _ => format!("analogRead({})", p.constant),
    }
}

fn write(p: &Pin) -> String {
    match p.ty {
        Type::Bool => {
            let (on, off) = if p.inverted { ("LOW", "HIGH") } else { ("HIGH", "LOW") };
            format!("digitalWrite({}, state.outputs.{} ? {on} : {off});", p.constant, p.field)
        }
        _ => format!("analogWrite({}, (int)state.outputs.{});", p.constant, p.field),
    }
}

/// How a sketch tells the time.
struct Clocked {
    memory: &'static str,
    step: &'static str,
    now: &'static str,
}

impl Clocked {
    fn new(room: Room) -> Clocked {
        match room.clock {
            Clock::Nanoseconds => Clocked {
                memory: "static int64_t now_ns;\n",
                step: "  // millis() starts again at 0 after 49 days; the difference does not mind.\n  \
                       if (began) { now_ns += (int64_t)(uint32_t)(ms - last_ms) * 1000000; }\n",
                now: "now_ns",
            },
            Clock::Microseconds => Clocked { memory: "", step: "", now: "micros()" },
            Clock::Milliseconds => Clocked { memory: "", step: "", now: "ms" },
        }
    }
}

/// The sketch. Pins that the chart does not name stand in the table at its top
/// with -1, which leaves them alone.
pub(crate) fn sketch(g: &Gen<'_>, name: &str, room: Room) -> String {
    let clock = Clocked::new(room);
    let (ins, outs) = (pins(g, VarClass::Input), pins(g, VarClass::Output));
    let mut t = format!(
        "// The chart {name}, printed by G7: a sketch round {name}.c and {name}.h, which belong in this folder.\n\n\
         #include \"{name}.h\"\n\n// The pins. What is -1 is left alone: put the number of the pin there.\n"
    );
    for p in ins.iter().chain(&outs) {
        let number = p.number.as_deref().unwrap_or("-1");
        let _ = writeln!(t, "static const int {} = {number}; // {}", p.constant, p.note);
    }
    let _ = write!(
        t,
        "\n// Time between scans in milliseconds; 0 for as often as it goes.\nstatic const unsigned long SCAN_MS = {};\n\n\
         static {name}_state state;\nstatic uint32_t last_ms;\nstatic bool began;\n{}\nvoid setup() {{\n",
        (g.c.symbols.cycle.count() / 1_000_000).max(0),
        clock.memory
    );
    for p in &ins {
        let mode = if p.inverted { "INPUT_PULLUP" } else { "INPUT" };
        if p.ty == Type::Bool {
            let _ = writeln!(t, "  if ({} >= 0) {{ pinMode({}, {mode}); }}", p.constant, p.constant);
        }
    }
    for p in &outs {
        let _ = writeln!(t, "  if ({} >= 0) {{ pinMode({}, OUTPUT); }}", p.constant, p.constant);
    }
    let _ = write!(
        t,
        "  {name}_init(&state);\n}}\n\nvoid loop() {{\n  const uint32_t ms = millis();\n  \
         if (began && ms - last_ms < SCAN_MS) {{\n    return;\n  }}\n{}  began = true;\n  last_ms = ms;\n\n",
        clock.step
    );
    for p in &ins {
        let _ = writeln!(t, "  if ({} >= 0) {{ state.inputs.{} = {}; }}", p.constant, p.field, read(p));
    }
    let _ = write!(
        t,
        "\n  // After a fault the outputs have their safe values; a reset starts again.\n  (void){name}_scan_in_place(&state, {});\n\n",
        clock.now
    );
    for p in &outs {
        let _ = writeln!(t, "  if ({} >= 0) {{ {} }}", p.constant, write(p));
    }
    t += "}\n";
    t
}
