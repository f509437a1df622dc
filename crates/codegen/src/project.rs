//! Files round printed code that make it ready to build: a program that calls the chart in each cycle, and what the
//! build tool of its language reads.
//!
//! # Where this sits
//!
//! Callers add these files to those of [`crate::print_as`]. They belong to the user: they are written once, and never
//! over what stands there.

use crate::output::File;
use crate::room::{Clock, Room};

/// The names of files that belong to the user.
const OWN: [&str; 8] = [
    "CMakeLists.txt",
    "main.c",
    "platformio.ini",
    "Cargo.toml",
    "memory.x",
    ".cargo/config.toml",
    "src/lib.rs",
    "src/main.rs",
];

/// A build tool with its program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Project {
    /// CMake, for C: a library of the chart and a program for the machine at hand.
    Cmake,
    /// Cargo, for Rust: a crate for a Cortex-M such as an STM32.
    Cargo,
}

/// True if a file belongs to the user once it is written.
pub fn is_own(file: &str) -> bool {
    OWN.contains(&file)
}

/// The files of a chart with those of a project.
pub fn with_project(files: Vec<File>, project: Project, name: &str, room: Room) -> Vec<File> {
    match project {
        Project::Cmake => with_cmake(files, name, room),
        Project::Cargo => with_cargo(files, name, room),
    }
}

fn file(name: &str, text: String) -> File {
    File { name: name.into(), text }
}

/// The time between two scans: 10 ms in the unit of the clock.
fn cycle(room: Room) -> (i64, &'static str) {
    (10_000_000 / room.clock.nanoseconds(), room.clock.unit())
}

fn with_cmake(mut files: Vec<File>, name: &str, room: Room) -> Vec<File> {
    let math = files.iter().any(|f| f.name == "g7_math.h");
    let library = if math { format!("target_link_libraries({name} PUBLIC m)\n") } else { String::new() };
    let lists = format!(
        "# The chart {name} and a program round it. This file is yours: g7 does not write over it.\n\
         cmake_minimum_required(VERSION 3.13)\nproject({name} C)\nset(CMAKE_C_STANDARD 99)\n\
         set(CMAKE_C_EXTENSIONS OFF)\n\n\
         # The chart, with the part that all charts share. Add the .c of other charts here.\n\
         add_library({name} STATIC {name}.c g7.c)\n\
         target_include_directories({name} PUBLIC ${{CMAKE_CURRENT_SOURCE_DIR}})\n\
         target_compile_options({name} PRIVATE $<$<C_COMPILER_ID:GNU,Clang>:-ffunction-sections>)\n{library}\n\
         add_executable({name}_program main.c)\ntarget_link_libraries({name}_program PRIVATE {name})\n\
         # What nobody calls is left out.\n\
         target_link_options({name}_program PRIVATE $<$<C_COMPILER_ID:GNU>:-Wl,--gc-sections>)\n"
    );
    let (cycle, unit) = cycle(room);
    let ty = if room.clock == Clock::Nanoseconds { "int64_t" } else { "uint32_t" };
    let main = format!(
        "/* A program round the chart {name}: 100 scans, 10 ms apart in the time that the chart sees. This file is \
         yours:\n * g7 does not write over it. */\n#include <stdio.h>\n\n#include \"{name}.h\"\n\n\
         /* The time between two scans, in {unit}. */\nstatic const {ty} CYCLE = {cycle};\n\n\
         static {name}_state state;\nstatic {name}_inputs inputs;\nstatic {name}_outputs outputs;\n\n\
         /* Here the inputs come from the machine. */\nstatic void read_inputs({name}_inputs *to)\n{{\n    (void)to;\n}}\n\n\
         /* Here the outputs go to the machine. */\nstatic void write_outputs(const {name}_outputs *from)\n{{\n    \
         (void)from;\n}}\n\nint main(void)\n{{\n    {ty} now = 0;\n    {name}_init(&state);\n    \
         for (unsigned scan = 0; scan < 100U; scan++) {{\n        read_inputs(&inputs);\n        \
         const uint8_t fault = {name}_scan(&inputs, &outputs, &state, now);\n        write_outputs(&outputs);\n        \
         if (fault != G7_FAULT_NONE) {{\n            (void)printf(\"{name}: fault %u in scan %u\\n\", (unsigned)fault, scan);\n            \
         return 1;\n        }}\n        now += CYCLE;\n    }}\n    (void)printf(\"{name}: 100 scans\\n\");\n    return 0;\n}}\n"
    );
    files.insert(0, file("CMakeLists.txt", lists));
    files.insert(1, file("main.c", main));
    files
}

fn with_cargo(files: Vec<File>, name: &str, room: Room) -> Vec<File> {
    let math = files.iter().any(|f| f.text.contains("libm::"));
    let library = if math { "libm = \"0.2\"\n" } else { "" };
    let manifest = format!(
        "# The chart {name} on a Cortex-M. This file is yours: g7 does not write over it.\n[package]\n\
         name = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\n\
         cortex-m = {{ version = \"0.7.7\", features = [\"critical-section-single-core\"] }}\ncortex-m-rt = \"0.7\"\n\
         panic-halt = \"1\"\n{library}\n[profile.release]\nopt-level = \"s\"\nlto = true\n\n\
         # Not a part of another workspace, wherever the folder stands.\n[workspace]\n"
    );
    let config = "# An STM32F4 has a Cortex-M4; of a part without reals in hardware the machine is thumbv7em-none-eabi.\n\
                  [build]\ntarget = \"thumbv7em-none-eabi\"\n\n[target.thumbv7em-none-eabi]\n\
                  rustflags = [\"-C\", \"link-arg=-Tlink.x\"]\n";
    let memory = "/* The memory of an STM32F401xC; see the data sheet of yours. */\nMEMORY\n{\n  \
                  FLASH : ORIGIN = 0x08000000, LENGTH = 256K\n  RAM : ORIGIN = 0x20000000, LENGTH = 64K\n}\n";
    let lib = format!("//! The chart `{name}`.\n#![no_std]\n\npub mod {name};\n");
    let ty = if room.clock == Clock::Nanoseconds { "i64" } else { "u32" };
    let step = 1_000_000 / room.clock.nanoseconds();
    let unit = room.clock.unit();
    let next = if room.clock == Clock::Nanoseconds {
        "now += MILLISECOND"
    } else {
        "now = now.wrapping_add(MILLISECOND)"
    };
    let main = format!(
        "//! A program for an STM32 round the chart `{name}`: a scan in each millisecond. This file is yours: g7 does not\n\
         //! write over it.\n#![no_std]\n#![no_main]\n\nuse cortex_m::peripheral::syst::SystClkSource;\nuse cortex_m_rt::entry;\n\
         use {name}::{name}::{{Inputs, Outputs, State, init, scan}};\nuse panic_halt as _;\n\n\
         /// Cycles of the processor in a millisecond: it has 16 MHz behind a reset.\nconst CYCLES: u32 = 16_000;\n\n\
         /// A millisecond in {unit}, which is what the chart counts in.\nconst MILLISECOND: {ty} = {step};\n\n\
         /// Here the inputs come from the pins.\nfn read_inputs(_to: &mut Inputs) {{}}\n\n\
         /// Here the outputs go to the pins.\nfn write_outputs(_from: &Outputs) {{}}\n\n\
         #[entry]\nfn main() -> ! {{\n    let mut state = State::new();\n    let mut inputs = Inputs::new();\n    \
         let mut outputs = Outputs::new();\n    let mut now: {ty} = 0;\n    init(&mut state);\n    \
         let mut clock = cortex_m::Peripherals::take().map(|p| p.SYST);\n    if let Some(clock) = &mut clock {{\n        \
         clock.set_clock_source(SystClkSource::Core);\n        clock.set_reload(CYCLES - 1);\n        \
         clock.clear_current();\n        clock.enable_counter();\n    }}\n    loop {{\n        \
         if !clock.as_mut().is_some_and(|c| c.has_wrapped()) {{\n            continue;\n        }}\n        \
         read_inputs(&mut inputs);\n        // After a fault the outputs have their safe values; a reset starts again.\n        \
         let _fault = scan(&inputs, &mut outputs, &mut state, now);\n        write_outputs(&outputs);\n        {next};\n    }}\n}}\n"
    );
    let mut all = vec![
        file("Cargo.toml", manifest),
        file(".cargo/config.toml", config.into()),
        file("memory.x", memory.into()),
        file("src/lib.rs", lib),
        file("src/main.rs", main),
    ];
    all.extend(files.into_iter().map(|f| File { name: format!("src/{}", f.name), ..f }));
    all
}

/// The boards of a sketch for PlatformIO, which also reads it beside the Arduino IDE.
pub(crate) fn platformio(name: &str) -> File {
    let text = format!(
        "; The sketch {name} for PlatformIO: `pio run -e uno -t upload`. The Arduino IDE does not read this file.\n\
         ; It is yours: g7 does not write over it.\n[platformio]\nsrc_dir = .\ndefault_envs = uno\n\n\
         [env:uno]\nplatform = atmelavr\nboard = uno\nframework = arduino\n\n\
         [env:mega]\nplatform = atmelavr\nboard = megaatmega2560\nframework = arduino\n\n\
         [env:esp32]\nplatform = espressif32\nboard = esp32dev\nframework = arduino\n"
    );
    file("platformio.ini", text)
}
