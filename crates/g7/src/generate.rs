//! `g7 gen`: generates code for a controller.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use g7_codegen::{
    BOARDS, Board, Clock, File, Language, Options, Parts, Project, Room, Sizes, Style, file_name, is_own,
    plc, with_project,
};
use g7_model::{Problem, ProfileName, Severity, say};

use crate::failure::{Failure, Verdict, raw};
use crate::message::{talk, tell, wrote};
use crate::report::{self, Tally};
use crate::sources::Source;
use crate::{files, fmu, sources, style, values};

const EXAMPLES: &str = "\
Examples:
  g7 gen c tank -o out            out/tank.h, out/tank.c and out/tank_run.h, with out/g7.h and out/g7.c
  g7 gen c tank --whole -o out    out/tank.h and out/tank.c, which need no g7.h and g7.c
  g7 gen c tank                   to the standard output, as one file that compiles as it is
  g7 gen c tank --style flat      Boolean equations with memories
  g7 gen c tank --small --time-unit ms
                                  for little memory; the clock in milliseconds
  g7 gen arduino tank -o tank     a sketch folder: tank.ino, the C code, platformio.ini
  g7 gen c tank --project cmake -o out
                                  the same with CMakeLists.txt and a program round it
  g7 gen rust tank -o src         src/tank.rs, a module without the standard library
  g7 gen rust tank --project cargo -o tank
                                  a crate with a program for an STM32
  g7 gen st tank                  Structured Text: a function block of equations
  g7 gen il tank --style dolog80  Instruction List: steps that are set and reset
  g7 gen ld tank -o out           Ladder as PLCopen XML: out/tank.xml
  g7 gen ld tank --style drawn    Ladder as a picture (SVG)
  g7 gen awl tank -o out          S7-300, S7-400: out/tank.awl and its symbols out/tank.asc
  g7 gen scl tank -o out          TIA Portal: out/tank.scl and its tags out/tank.tags.xml
  g7 gen twincat tank -o out      TwinCAT 3: out/tank.TcPOU
  g7 gen logix tank -o out        Logix 5000: out/tank.L5X, a program
  g7 gen unity tank -o out        Control Expert, Unity Pro: out/tank.XST, a section
  g7 gen fmu tank                 tank.fmu for simulators: FMI 2.0, Co-Simulation
  g7 gen fmu tank --fmi 3 -o out/tank3.fmu
                                  the same for FMI 3.0

The code does what `g7 run` does, scan by scan. What a language cannot say is
reported with its place, and nothing is written then.

Exit codes:
  0  fine
  1  the chart has errors, or the language cannot say what it means
  2  bad usage, or something outside the chart: no such file, a full disk";

/// The arguments of `g7 gen`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Gen {
    #[command(subcommand)]
    language: Words,
}

/// The languages.
#[derive(Debug, Subcommand)]
enum Words {
    /// C99 without heap and library: the chart, and `g7.h` and `g7.c` for all charts.
    #[command(after_help = EXAMPLES)]
    C(Code),
    /// The same C99 code and an Arduino sketch.
    #[command(after_help = EXAMPLES)]
    Arduino(Code),
    /// A Rust module without the standard library.
    #[command(after_help = EXAMPLES)]
    Rust(Code),
    /// Structured Text (IEC 61131-3): Boolean equations with memories.
    #[command(after_help = EXAMPLES)]
    St(Plc),
    /// The same equations as Instruction List.
    #[command(after_help = EXAMPLES)]
    Il {
        /// How the equations are written.
        #[arg(long, value_enum, default_value_t = IlStyle::Flat)]
        style: IlStyle,
        #[command(flatten)]
        what: Plc,
    },
    /// The same equations as Ladder.
    #[command(after_help = EXAMPLES)]
    Ld {
        /// A file for other tools, or a picture.
        #[arg(long, value_enum, default_value_t = LdStyle::Xml)]
        style: LdStyle,
        #[command(flatten)]
        what: Plc,
    },
    /// AWL (STL) source for S7-300 and S7-400, with a symbol table.
    #[command(after_help = EXAMPLES)]
    Awl(Plc),
    /// SCL source for TIA Portal (S7-1200, S7-1500), with a table of PLC tags.
    #[command(after_help = EXAMPLES)]
    Scl(Plc),
    /// A POU for TwinCAT 3 in Structured Text (`.TcPOU`).
    #[command(after_help = EXAMPLES)]
    Twincat(Plc),
    /// A program for Logix 5000 with a routine in Structured Text (L5X).
    #[command(after_help = EXAMPLES)]
    Logix(Plc),
    /// A section for Control Expert or Unity Pro in Structured Text (XST).
    #[command(after_help = EXAMPLES)]
    Unity(Plc),
    /// An FMU for simulators such as OpenModelica, Dymola or Simulink (FMI, Co-Simulation).
    #[command(after_help = EXAMPLES)]
    Fmu(fmu::Fmu),
}

/// The arguments for C and Rust.
#[derive(Args, Debug)]
struct Code {
    /// How the evolution is written; its behaviour is the same.
    #[arg(long, value_enum, default_value_t = CodeStyle::Structured)]
    style: CodeStyle,
    /// For little memory: truth values as bits, and a time for those steps alone whose time the chart
    /// reads. A sketch is always like this.
    #[arg(long)]
    small: bool,
    /// The unit of the clock: `ns` in 64 bits, `us` and `ms` in 32 bits [default: ns; of a sketch ms].
    #[arg(long, value_enum, value_name = "UNIT")]
    time_unit: Option<TimeUnit>,
    /// The board that the code is for; nothing is written where its RAM is too small.
    #[arg(long, value_parser = board)]
    board: Option<Board>,
    /// Put what all charts have in common into the chart's own file, instead of `g7.h` and `g7.c`.
    #[arg(long, requires = "output")]
    whole: bool,
    /// Also write a program that calls the chart, and the files for a build tool. Change them as you like: later
    /// calls leave them as they are.
    #[arg(long, value_enum, value_name = "TOOL", requires = "output", conflicts_with = "whole")]
    project: Option<Tool>,
    #[command(flatten)]
    what: What,
}

/// Build tools.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Tool {
    /// For C: CMakeLists.txt and main.c, for the machine at hand.
    Cmake,
    /// For Rust: Cargo.toml and src/main.rs, for an STM32 (Cortex-M4).
    Cargo,
}

/// A board by its name.
fn board(name: &str) -> Result<Board, String> {
    let names = BOARDS.map(|b| b.name).join(", ");
    BOARDS.into_iter().find(|b| b.name == name).ok_or_else(|| format!("the boards are {names}"))
}

/// Units of the clock.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum TimeUnit {
    /// Nanoseconds in 64 bits.
    Ns,
    /// Microseconds in 32 bits; no time is longer than 35 minutes.
    Us,
    /// Milliseconds in 32 bits; no time is longer than 24 days.
    Ms,
}

/// Styles of C and Rust.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum CodeStyle {
    /// By the elements of the chart: steps, transitions, receptivities, actions.
    Structured,
    /// As Boolean equations: clearing conditions, memories of steps, outputs.
    Flat,
}

impl Code {
    fn print(&self, language: Language) -> Result<Verdict, Failure> {
        let style = match self.style {
            CodeStyle::Structured => Style::Structured,
            CodeStyle::Flat => Style::Flat,
        };
        let usual = Room::usual(language, style);
        let clock = match self.time_unit {
            None => usual.clock,
            Some(TimeUnit::Ns) => Clock::Nanoseconds,
            Some(TimeUnit::Us) => Clock::Microseconds,
            Some(TimeUnit::Ms) => Clock::Milliseconds,
        };
        let room = Room { small: self.small || usual.small, clock };
        if matches!(style, Style::Flat) && room != Room::default() {
            let why = say!("--small and --time-unit are for the structured style");
            return Err(Failure::Usage(why));
        }
        if self.whole && matches!(language, Language::Rust) {
            return Err(Failure::Usage(say!("--whole is for C: a Rust module is one file anyway")));
        }
        let project = match (self.project, language) {
            (None, _) => None,
            (Some(Tool::Cmake), Language::C) => Some(Project::Cmake),
            (Some(Tool::Cargo), Language::Rust) => Some(Project::Cargo),
            (Some(_), _) => {
                let why = say!(
                    "--project cmake is for `gen c`, --project cargo for `gen rust`; a sketch has its platformio.ini"
                );
                return Err(Failure::Usage(why));
            }
        };
        let parts = match self.what.output {
            None => Parts::One,
            Some(_) if self.whole => Parts::Whole,
            Some(_) => Parts::Apart,
        };
        let form = Form { language, style, room, parts, project, board: self.board };
        controller(Tongue::Code(form), &self.what)
    }
}

/// Styles of Instruction List.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum IlStyle {
    /// One equation for each step.
    Flat,
    /// A memory for each receptivity; steps are set and reset.
    Dolog80,
}

/// Forms of Ladder.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum LdStyle {
    /// PLCopen XML.
    Xml,
    /// A picture (SVG).
    Drawn,
}

/// The arguments for the languages of PLCs.
#[derive(Args, Debug)]
struct Plc {
    /// Write comments in ASCII alone, for tools that take no other letters.
    #[arg(long)]
    ascii: bool,
    #[command(flatten)]
    what: What,
}

impl Plc {
    fn print(&self, form: plc::Form) -> Result<Verdict, Failure> {
        controller(Tongue::Plc { form, ascii: self.ascii }, &self.what)
    }
}

/// The arguments for all languages.
#[derive(Args, Debug)]
struct What {
    /// A .g7 file, a file of another tool, or a folder with a chart.g7.
    #[arg(default_value = ".")]
    file: PathBuf,
    /// The folder for the files [default: the standard output].
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// The prefix of file names and public names [default: the name of the chart's file].
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// The profile to use instead of the file's own.
    #[arg(long, value_parser = values::profiles())]
    profile: Option<ProfileName>,
    /// Replace existing files.
    #[arg(long)]
    force: bool,
}

pub(crate) fn generate(args: &Gen) -> Result<Verdict, Failure> {
    match &args.language {
        Words::C(code) => code.print(Language::C),
        Words::Arduino(code) => code.print(Language::Arduino),
        Words::Rust(code) => code.print(Language::Rust),
        Words::St(what) => what.print(plc::Form::St),
        Words::Il { style: IlStyle::Flat, what } => what.print(plc::Form::Il),
        Words::Il { style: IlStyle::Dolog80, what } => what.print(plc::Form::Dolog80),
        Words::Ld { style: LdStyle::Xml, what } => what.print(plc::Form::Ld),
        Words::Ld { style: LdStyle::Drawn, what } => what.print(plc::Form::Drawing),
        Words::Awl(what) => what.print(plc::Form::Awl),
        Words::Scl(what) => what.print(plc::Form::Scl),
        Words::Twincat(what) => what.print(plc::Form::TwinCat),
        Words::Logix(what) => what.print(plc::Form::Logix),
        Words::Unity(what) => what.print(plc::Form::Unity),
        Words::Fmu(what) => packed(what),
    }
}

/// An FMU of the chart.
fn packed(args: &fmu::Fmu) -> Result<Verdict, Failure> {
    let path = files::one(&args.file)?;
    let (source, compiled) = match read(&path, args.profile)? {
        Ok(read) => read,
        Err(verdict) => return Ok(verdict),
    };
    let name = args.name.clone().unwrap_or_else(|| name_of(&path));
    match g7_codegen::fmu::fmu(&compiled, args.fmi.into(), &name, &source.text) {
        Ok(fmu) => {
            if !fmu.problems.is_empty() {
                found(&source, &fmu.problems);
            }
            fmu::pack(args, &name, &fmu)
        }
        Err(problems) => Ok(found(&source, &problems)),
    }
}

/// How C or Rust is printed.
#[derive(Clone, Copy)]
struct Form {
    language: Language,
    style: Style,
    room: Room,
    parts: Parts,
    project: Option<Project>,
    board: Option<Board>,
}

/// The language of the output. PLC code has a form too; `ascii` keeps its comments in ASCII.
#[derive(Clone, Copy)]
enum Tongue {
    Code(Form),
    Plc { form: plc::Form, ascii: bool },
}

impl Tongue {
    /// True if a `main.c` stands beside the chart.
    fn has_main(self) -> bool {
        matches!(self, Tongue::Code(Form { project: Some(Project::Cmake), .. }))
    }

    fn print(
        self,
        compiled: &g7_compile::Compiled,
        name: &str,
        source: &str,
    ) -> Result<Written, Vec<Problem>> {
        match self {
            Tongue::Code(Form { language, style, room, parts, project, board }) => {
                let options = Options { language, style, room, name, source };
                let p = g7_codegen::print_as(compiled, &options, parts)?;
                let sizes = (language != Language::Rust).then_some((p.sizes, room, board));
                let files = match project {
                    Some(project) => with_project(p.files, project, &file_name(name), room),
                    None => p.files,
                };
                Ok(Written { files, problems: p.problems, sizes })
            }
            Tongue::Plc { form, ascii } => {
                let printed = plc::print(compiled, form, name, source)?;
                let beside = printed.beside.into_iter();
                let all = beside.chain([(form.ending(), printed.text)]).map(|(ending, text)| File {
                    name: format!("{name}.{ending}"),
                    text: if ascii { plc::ascii(&text) } else { text },
                });
                Ok(Written { files: all.collect(), problems: printed.problems, sizes: None })
            }
        }
    }
}

/// The printed files, and the memory that the code takes.
struct Written {
    files: Vec<File>,
    problems: Vec<Problem>,
    sizes: Option<(Sizes, Room, Option<Board>)>,
}

/// Tells the memory that the code takes. False where a board has less.
fn tell_sizes(sizes: Sizes, room: Room, board: Option<Board>) -> bool {
    tell(say!(
        "memory: {} bytes of RAM for the state (inputs, outputs and variables included) on an 8-bit AVR, {} on 32 \
         bits; {} bytes of tables in flash. Not counted: instructions, the stack, the program around",
        sizes.avr,
        sizes.wide,
        sizes.tables
    ));
    let Some(board) = board else { return true };
    let (state, left) = (board.state(sizes), board.ram.saturating_sub(board.reserve));
    if board.holds(sizes) {
        tell(say!(
            "{}: {state} of {left} bytes, with {} left for the stack and the board",
            raw(board.name),
            board.reserve
        ));
        return true;
    }
    let way = if room == (Room { small: true, clock: Clock::Milliseconds }) {
        say!("split the chart, or take a larger board")
    } else {
        say!("try --small --time-unit ms, or a larger board")
    };
    let name = raw(format!("{}{}{:#}", style::BAD, board.name, style::BAD));
    tell(say!(
        "{name} is too small: the state takes {state} bytes, and {left} of its {} are free beside the stack and the \
         board; {way}",
        board.ram
    ));
    false
}

/// A chart that compiles; otherwise its errors are told.
fn read(
    path: &Path,
    profile: Option<ProfileName>,
) -> Result<Result<(Source, g7_compile::Compiled), Verdict>, Failure> {
    let source = sources::load(path, 0)?;
    if source.is_broken() {
        return Ok(Err(found(&source, &source.read_problems())));
    }
    let (compiled, problems) = match profile {
        Some(profile) => g7_compile::compile_as(source.whole(), profile),
        None => g7_compile::compile(source.whole()),
    };
    let Some(compiled) = compiled else {
        let errors: Vec<Problem> = problems.into_iter().filter(|p| p.severity() == Severity::Error).collect();
        return Ok(Err(found(&source, &errors)));
    };
    Ok(Ok((source, compiled)))
}

fn controller(tongue: Tongue, what: &What) -> Result<Verdict, Failure> {
    let path = files::one(&what.file)?;
    let (source, compiled) = match read(&path, what.profile)? {
        Ok(read) => read,
        Err(verdict) => return Ok(verdict),
    };
    let name = what.name.clone().unwrap_or_else(|| name_of(&path));
    if tongue.has_main() && file_name(&name) == "main" {
        return Err(Failure::Usage(say!("main.c is the program round the chart: choose another --name")));
    }
    match tongue.print(&compiled, &name, &source.text) {
        Ok(Written { files, problems, sizes }) => {
            if !problems.is_empty() {
                found(&source, &problems);
            }
            if let Some((sizes, room, board)) = sizes
                && !tell_sizes(sizes, room, board)
            {
                return Ok(Verdict::Found);
            }
            deliver(what, &files)?;
            Ok(Verdict::Fine)
        }
        Err(problems) => Ok(found(&source, &problems)),
    }
}

/// The base name: `tank` for `tank.g7` and `tank/chart.g7`; for `chart.g7` the name of the current
/// folder.
fn name_of(path: &Path) -> String {
    let stem = path.file_stem().map_or("chart".into(), |s| s.to_string_lossy().into_owned());
    if stem != "chart" {
        return stem;
    }
    let folder = std::path::absolute(path).ok().and_then(|p| p.parent()?.file_name().map(|n| n.to_owned()));
    folder.map_or(stem, |f| f.to_string_lossy().into_owned())
}

fn deliver(what: &What, printed: &[File]) -> Result<(), Failure> {
    let Some(folder) = &what.output else {
        let mut out = anstream::stdout().lock();
        for (i, file) in printed.iter().enumerate() {
            write!(out, "{}{}", if i > 0 { "\n" } else { "" }, file.text)?;
        }
        out.flush()?;
        return Ok(());
    };
    // Several charts in one folder share `g7.h` and `g7.c`: what is there as it would be written stays.
    let is_same = |file: &File, path: &Path| std::fs::read(path).is_ok_and(|old| old == file.text.as_bytes());
    let paths = printed.iter().map(|f| (f, folder.join(&f.name)));
    // The program round a chart is the user's, once it is there.
    let is_kept = |file: &File, path: &Path| is_same(file, path) || (is_own(&file.name) && path.exists());
    let new: Vec<(&File, PathBuf)> = paths.filter(|(f, p)| !is_kept(f, p)).collect();
    if let Some((_, there)) = new.iter().find(|(_, p)| p.exists() && !what.force) {
        return Err(Failure::Usage(say!("{} already exists; --force replaces it", raw(there.display()))));
    }
    let from = files::one(&what.file)?;
    new.iter().try_for_each(|(_, path)| files::refuse_source(Some(path), &[&from]))?;
    std::fs::create_dir_all(folder).map_err(|e| Failure::Write(folder.clone(), e))?;
    for (file, path) in &new {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|e| Failure::Write(folder.to_owned(), e))?;
        }
        files::write(path, file.text.as_bytes())?;
        wrote(path.display());
    }
    if new.is_empty() {
        tell(say!("{}: everything is there already, as it would be written", raw(folder.display())));
    }
    Ok(())
}

fn found(source: &Source, problems: &[Problem]) -> Verdict {
    talk!("{}", report::text(source, problems).trim_end());
    talk!("{}: {}", source.name, Tally::of(problems));
    Verdict::Found
}
