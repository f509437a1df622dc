//! Printed code as a project that is ready to build: a sketch with the core of Arduino, a program by CMake, a crate for
//! a Cortex-M. Each is built by its own tools where they are there.
#![allow(clippy::disallowed_methods, reason = "the tests start compilers")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use g7_codegen::{File, Language, Options, Parts, Project, Room, Style, print_as, with_project};
use g7_compile::compile;
use g7_model::FileId;

/// The core of Arduino as Debian has it; `make peers` installs it.
const CORE: &str = "/usr/share/arduino/hardware/arduino/avr";

/// A folder for the time of a test.
struct Folder(PathBuf);

impl Folder {
    fn new(of: &str) -> Folder {
        let folder = std::env::temp_dir().join(format!("g7-project-{of}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        Folder(folder)
    }

    fn write(&self, files: &[File]) {
        for f in files {
            let path = self.0.join(&f.name);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            std::fs::write(path, &f.text).expect("a file");
        }
    }

    fn run(&self, tool: &str, args: &[&str]) -> Output {
        Command::new(tool).args(args).current_dir(&self.0).output().expect("it starts")
    }

    fn does(&self, tool: &str, args: &[&str]) -> String {
        let out = self.run(tool, args);
        assert!(out.status.success(), "{tool} {args:?}: {}", String::from_utf8_lossy(&out.stderr));
        String::from_utf8_lossy(&out.stdout).into_owned()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// An example, printed.
fn printed(example: &str, name: &str, language: Language) -> Vec<File> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(example);
    let text = std::fs::read_to_string(path).expect("an example");
    let (doc, problems) = g7_syntax::parse(&text, FileId(0));
    let compiled = compile(&doc).0.unwrap_or_else(|| panic!("{problems:?}"));
    let style = Style::Structured;
    let options = Options { language, style, room: Room::usual(language, style), name, source: &text };
    print_as(&compiled, &options, Parts::Apart).unwrap_or_else(|p| panic!("{p:?}")).files
}

/// The examples that are built.
const EXAMPLES: [(&str, &str); 2] =
    [("bottle-conveyor/chart.g7", "conveyor"), ("bead-sorter/chart.g7", "sorter")];

#[test]
fn a_sketch_is_built_with_the_core_of_arduino() {
    if !g7_peers::tool("avr-g++") {
        return;
    }
    if !Path::new(CORE).is_dir() {
        g7_peers::skip("arduino-core-avr missing");
        return;
    }
    let boards =
        [("uno", "atmega328p", "standard", 2_048, 32_256), ("mega", "atmega2560", "mega", 8_192, 253_952)];
    for (board, mcu, variant, ram, flash) in boards {
        let (mcu, defined) = (format!("-mmcu={mcu}"), format!("-DARDUINO_AVR_{}", board.to_uppercase()));
        let (core, variant) = (format!("{CORE}/cores/arduino"), format!("-I{CORE}/variants/{variant}"));
        let include = format!("-I{core}");
        let flags = [
            "-Os",
            "-flto",
            "-ffunction-sections",
            "-fdata-sections",
            "-DF_CPU=16000000L",
            "-DARDUINO=10819",
            "-DARDUINO_ARCH_AVR",
            // Older avr-gcc has this name for C alone.
            "-DDECIMAL_DIG=__DECIMAL_DIG__",
            "-I.",
            &mcu,
            &defined,
            &include,
            &variant,
        ];
        let folder = Folder::new(board);
        let mut objects = Vec::new();
        // The core, as the Arduino IDE compiles it.
        let mut sources: Vec<PathBuf> =
            std::fs::read_dir(&core).expect("the core").map(|e| e.expect("an entry").path()).collect();
        sources.retain(|p| p.extension().is_some_and(|e| e == "c" || e == "cpp"));
        sources.sort();
        for (i, path) in sources.iter().enumerate() {
            let is_c = path.extension().is_some_and(|e| e == "c");
            let (tool, standard) = if is_c { ("avr-gcc", "-std=gnu11") } else { ("avr-g++", "-std=gnu++11") };
            let object = format!("core{i}.o");
            let path = path.to_string_lossy().into_owned();
            folder.does(tool, &[&flags[..], &[standard, "-w", "-c", &path, "-o", &object]].concat());
            objects.push(object);
        }
        for (example, name) in EXAMPLES {
            let files = printed(example, name, Language::Arduino);
            folder.write(&files);
            let mut all = objects.clone();
            for file in files.iter().filter(|f| f.name.ends_with(".c")) {
                let object = format!("{}.o", file.name);
                let strict = ["-std=gnu11", "-Wall", "-Wextra", "-Werror", "-c", &file.name, "-o", &object];
                folder.does("avr-gcc", &[&flags[..], &strict].concat());
                all.push(object);
            }
            // The IDE puts this line in front of a sketch.
            let sketch = format!("{name}.cpp");
            std::fs::write(
                folder.0.join(&sketch),
                format!("#include <Arduino.h>\n#include \"{name}.ino\"\n"),
            )
            .expect("a file");
            let strict = ["-std=gnu++11", "-Wall", "-Wextra", "-Werror", "-c", &sketch, "-o", "sketch.o"];
            folder.does("avr-g++", &[&flags[..], &strict].concat());
            all.push("sketch.o".to_owned());
            let all: Vec<&str> = all.iter().map(String::as_str).collect();
            let link = ["-Os", "-flto", "-fuse-linker-plugin", "-Wl,--gc-sections", &mcu];
            folder.does("avr-gcc", &[&link[..], &all, &["-o", "sketch.elf", "-lm"]].concat());
            let sizes = folder.does("avr-size", &["sketch.elf"]);
            let row: Vec<usize> = sizes
                .lines()
                .nth(1)
                .map(|l| l.split_whitespace().filter_map(|w| w.parse().ok()).collect())
                .unwrap_or_default();
            let [text, data, bss] = row[..3] else { panic!("{sizes}") };
            println!("{name} on an {board}: {} bytes of flash, {} of RAM", text + data, data + bss);
            assert!(text + data < flash && data + bss < ram, "{name} on {board}: {sizes}");
        }
    }
}

#[test]
fn a_sketch_has_its_file_for_platformio() {
    let files = printed(EXAMPLES[0].0, "conveyor", Language::Arduino);
    let ini = &files.iter().find(|f| f.name == "platformio.ini").expect("the file").text;
    for want in ["src_dir = .", "board = uno", "board = megaatmega2560", "board = esp32dev"] {
        assert!(ini.contains(want), "no `{want}` in\n{ini}");
    }
    assert!(files.last().is_some_and(|f| f.name == "conveyor.ino"));
}

#[test]
fn cmake_builds_a_program_that_runs() {
    if !g7_peers::tool("cmake") || !g7_peers::tool("gcc") {
        return;
    }
    for (example, name) in EXAMPLES {
        let room = Room::default();
        let files = with_project(printed(example, name, Language::C), Project::Cmake, name, room);
        let folder = Folder::new(&format!("cmake-{name}"));
        folder.write(&files);
        let strict = "-DCMAKE_C_FLAGS=-Wall -Wextra -Wconversion -pedantic -Werror";
        folder.does("cmake", &["-S", ".", "-B", "build", "-DCMAKE_C_COMPILER=gcc", strict]);
        folder.does("cmake", &["--build", "build"]);
        let said = folder.does(&format!("{}/build/{name}_program", folder.0.display()), &[]);
        assert_eq!(said, format!("{name}: 100 scans\n"));
    }
}

#[test]
fn a_crate_for_a_cortex_m_is_built() {
    if !g7_peers::target("thumbv7em-none-eabi") {
        return;
    }
    for (example, name) in EXAMPLES {
        let room = Room::default();
        let files = with_project(printed(example, name, Language::Rust), Project::Cargo, name, room);
        let folder = Folder::new(&format!("cargo-{name}"));
        folder.write(&files);
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cortex-m");
        let out = Command::new(env!("CARGO"))
            .args(["build", "--offline", "--quiet", "--release", "--target-dir"])
            .arg(&target)
            .current_dir(&folder.0)
            .output()
            .expect("cargo starts");
        let said = String::from_utf8_lossy(&out.stderr);
        if said.contains("--offline") || said.contains("offline mode") {
            g7_peers::skip("cortex-m-rt missing");
            return;
        }
        assert!(out.status.success() && !said.contains("warning"), "{said}");
        let program = target.join("thumbv7em-none-eabi/release").join(name);
        let bytes = std::fs::read(program).expect("a program");
        assert!(bytes.starts_with(b"\x7fELF"));
    }
}
