//! The commands, their options, and the examples in their help texts.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use g7_model::{Nanos, ProfileName, TargetPlc};

use crate::form::{EXIT_CODES, Format};
use crate::station::Drive;
use crate::values::{self, Assign};

const FIRST_STEPS: &str = "\
First steps:
  g7 new tank            a folder with a small chart, its plant and a test
  g7 run tank            see it work: steps, inputs, outputs, chronogram
  g7 test tank           its tests, in virtual time
  g7 check tank          what is wrong with it, and the way out

Exit codes:
  0  fine
  1  problems were found, or a test failed
  2  bad usage, or something outside the chart: no such file, a full disk

Data goes to the standard output, talk to the standard error.
NO_COLOR=1 or --color never turns colours off.";

/// GRAFCET charts: check them, run them against simulated plants, test them.
#[derive(Debug, Parser)]
#[command(name = "g7", version, arg_required_else_help = true, after_help = FIRST_STEPS)]
pub(crate) struct Cli {
    /// When to use colours.
    #[arg(long, global = true, value_enum, default_value_t = Color::Auto, value_name = "WHEN")]
    pub(crate) color: Color,
    /// The language of messages about charts and of the pages of `explain`; without it, that of LC_ALL, LC_MESSAGES or LANG.
    #[arg(long, global = true, value_enum, value_name = "LANGUAGE")]
    pub(crate) lang: Option<crate::tongue::Tongue>,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// When to use colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Color {
    /// If the output is a terminal and NO_COLOR is not set.
    Auto,
    /// Also in a pipe or a file.
    Always,
    /// Never.
    Never,
}

/// The format of problems.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Report {
    /// For people.
    Text,
    /// For programs: one JSON object.
    Json,
    /// For code review: a log of SARIF 2.1.0.
    Sarif,
    /// For workflows of GitHub: annotations of the lines.
    Github,
}

/// The fixes that are applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Fixing {
    /// Those of which nothing else can have been meant.
    Sure,
    /// Also those that are only likely.
    Likely,
}

/// The format of answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Answers {
    /// For people.
    Text,
    /// For programs: one JSON object.
    Json,
    /// For code review: a log of SARIF 2.1.0.
    Sarif,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Create a folder with a small chart, its plant and a test.
    New(New),
    /// Show the problems of charts: where they are and how to solve them.
    Check(Check),
    /// Format charts; notes are kept.
    Fmt(Fmt),
    /// Run a chart with its plant, in the terminal or without one.
    Run(Run),
    /// Ask why something happened in a run, or did not.
    Why(crate::why::Why),
    /// Ask the devices of a chart, or one by hand, what they have.
    Devices(crate::devices::Devices),
    /// Run the plant of a chart in the place of its devices.
    Plant(crate::plant::Plant),
    /// Show what the history of a controller has, or export it.
    History(crate::history::History),
    /// Run the tests of charts in virtual time.
    Test(Test),
    /// Grade the charts that students hand in, by the tests and questions of an exercise.
    Grade(crate::grade::Grade),
    /// Ask what charts can and cannot do, over all runs.
    Prove(Prove),
    /// Compare two charts, or one under two profiles, over all runs.
    Compare(Compare),
    /// Show the situations that a chart reaches, as a graph.
    Graph(crate::prove::Graph),
    /// Draw charts as SVG, PNG or PDF.
    Draw(crate::draw::Draw),
    /// Print all that is known of a chart as one PDF: drawings, tables, tests and proofs.
    Dossier(crate::dossier::args::Dossier),
    /// Open the editor in the browser, or drive a machine with the page of its operator.
    Serve(crate::serve::Serve),
    /// Show, add, change and remove the users of a server.
    Users(crate::users::Users),
    /// Show, export and check the log of a controller.
    Log(crate::journal::Journal),
    /// Make a certificate and its key, for encrypted connections.
    Cert(crate::certificate::Cert),
    /// Let the system start the controller of a chart (systemd).
    #[cfg(target_os = "linux")]
    Service(crate::service::Service),
    /// Convert a file of another tool to a .g7 file.
    Import(Import),
    /// Convert a chart to the format of another tool.
    Export(crate::export::Export),
    /// Generate code for a controller from a chart.
    Gen(crate::generate::Gen),
    /// Answer an editor: a server of the Language Server Protocol on standard input and output.
    Lsp(Lsp),
    /// Explain a problem code, or list them all.
    Explain(Explain),
    /// Print the completions for a shell.
    Completions(Completions),
    /// Print the manual page, or write the pages of all commands to a folder.
    Man(Man),
}

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  g7 new tank
  g7 new ~/plants/conveyor && g7 run ~/plants/conveyor
  g7 new exercise lamp        an exercise that checks itself, for students (g7 grade)

A folder that holds something already is left alone.")]
pub(crate) struct New {
    /// The folder to create; `exercise` makes an exercise, in the folder behind it.
    pub(crate) folder: PathBuf,
    /// With `exercise`: its folder [default: exercise].
    #[arg(value_name = "FOLDER")]
    pub(crate) exercise: Option<PathBuf>,
}

#[derive(Args, Debug)]
#[command(after_help = format!("\
Examples:
  g7 check                          every .g7 file in this folder and below
  g7 check tank/chart.g7            one file
  g7 check --target tsx3720 tank    against the limits of a PLC as well
  g7 check --watch tank             again whenever a file changes
  g7 check --fix tank               solves what has a sure solution
  g7 check --format json tank       for a program to read; sarif, github: for code review
  g7 check - < chart.g7             the standard input

{EXIT_CODES}"))]
pub(crate) struct Check {
    /// Files or folders; `-` reads the standard input.
    #[arg(default_value = ".")]
    pub(crate) paths: Vec<PathBuf>,
    /// Also check the limits of this PLC.
    #[arg(long, value_parser = values::targets(), value_name = "PLC")]
    pub(crate) target: Option<TargetPlc>,
    /// The profile to use instead of the file's own.
    #[arg(long, value_parser = values::profiles())]
    pub(crate) profile: Option<ProfileName>,
    /// For people, for programs, for code review or for workflows.
    #[arg(long, value_enum, default_value_t = Report::Text)]
    pub(crate) format: Report,
    /// Solve what has a sure solution, and write the files; `--fix=likely` takes what is likely too.
    #[arg(long, value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "sure", value_name = "WHICH")]
    pub(crate) fix: Option<Fixing>,
    /// Check again whenever a file changes.
    #[arg(long, short)]
    pub(crate) watch: bool,
    /// Count warnings as errors.
    #[arg(long)]
    pub(crate) strict: bool,
}

#[derive(Args, Debug)]
#[command(after_help = format!("\
Examples:
  g7 fmt                    every .g7 file in this folder and below
  g7 fmt --check tank       only say which files would change
  g7 fmt --check --diff     and show how
  g7 fmt - < chart.g7       from the standard input to the standard output

A file with syntax errors is left as it is. A file is written whole or not at all.

{EXIT_CODES}"))]
pub(crate) struct Fmt {
    /// Files or folders; `-` reads the standard input.
    #[arg(default_value = ".")]
    pub(crate) paths: Vec<PathBuf>,
    /// Write nothing; exit with 1 if a file would change.
    #[arg(long)]
    pub(crate) check: bool,
    /// Write nothing; show what would change, as `diff -u` does.
    #[arg(long)]
    pub(crate) diff: bool,
}

#[derive(Args, Debug)]
#[command(after_help = format!("\
Examples:
  g7 run examples/bead-sorter                      in the terminal; ? shows the keys
  g7 run tank --headless --for 60s                 no terminal: prints a chronogram
  g7 run tank --headless --for 60s --trace out.vcd  for GTKWave; .csv for a spreadsheet
  g7 run tank --headless --set start=1@2s --set start=0@2.5s
  g7 run tank --profile iec61131 --scan 40ms       under other rules of evolution
  g7 run tank --plant tank.fmu --wire h=level      an FMU is the plant
  g7 run Sorter.xml                                a file of another tool, here JGrafchart's
  g7 run sorter.g7 --online                        drives the devices of sorter.io.toml
  g7 run sorter.g7 --online --simulate line1       the same, with the plant in place of one

{EXIT_CODES}"))]
pub(crate) struct Run {
    /// A file, or a folder with a chart.g7.
    #[arg(default_value = ".")]
    pub(crate) path: PathBuf,
    /// Do not open the terminal view; print a chronogram at the end.
    #[arg(conflicts_with = "online", long)]
    pub(crate) headless: bool,
    /// How long to run [default: 10s; no limit in the terminal view].
    #[arg(long = "for", value_parser = values::duration, value_name = "TIME")]
    pub(crate) duration: Option<Nanos>,
    /// Write the values of all signals to this file; its name ends in .csv or .vcd.
    #[arg(conflicts_with = "online", long, value_name = "FILE")]
    pub(crate) trace: Option<PathBuf>,
    /// Set an input, a variable, a system bit (`%S21`) or a state of the plant at a time: `start=1@2s`.
    #[arg(conflicts_with = "online", long = "set", value_parser = values::assign, value_name = "NAME=VALUE@TIME")]
    pub(crate) set: Vec<Assign>,
    /// The profile to use instead of the file's own.
    #[arg(long, value_parser = values::profiles())]
    pub(crate) profile: Option<ProfileName>,
    /// Time between scans, instead of the file's own (10ms).
    #[arg(long, value_parser = values::duration, value_name = "TIME")]
    pub(crate) scan: Option<Nanos>,
    /// The plant to use if there are several; `none` for no plant; the file of an FMU, which is a program
    /// that you trust (`tank.fmu`, without the terminal view).
    #[arg(long, value_name = "NAME")]
    pub(crate) plant: Option<String>,
    /// With an FMU as the plant: connect an output of the charts or the FMU to an input of the other. The
    /// same names are connected anyway.
    #[arg(conflicts_with = "online", long, value_parser = values::wire, value_name = "OUTPUT=INPUT")]
    pub(crate) wire: Vec<(String, String)>,
    /// The seed of the plant's random numbers; the same seed gives the same run.
    #[arg(long, default_value_t = 0, value_name = "NUMBER")]
    pub(crate) seed: u64,
    /// With --headless: run in real time.
    #[arg(conflicts_with = "online", long)]
    pub(crate) real_time: bool,
    /// With --headless: the signals of the chronogram [default: all that change].
    #[arg(conflicts_with = "online", long, value_delimiter = ',', value_name = "NAMES")]
    pub(crate) show: Vec<String>,
    /// Keep the retained variables in this file between runs.
    #[arg(conflicts_with = "online", long, value_name = "FILE")]
    pub(crate) retain: Option<PathBuf>,
    /// With --headless: record everything that enters the charts, for --replay.
    #[arg(conflicts_with = "online", long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    /// Let --trace and --record replace a file that g7 did not write. The chart itself is never replaced.
    #[arg(conflicts_with = "online", long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) drive: Drive,
    /// Replay a record and check that every state is the same.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["record", "set", "duration", "retain", "online"])]
    pub(crate) replay: Option<PathBuf>,
}

#[derive(Args, Debug)]
#[command(after_help = format!("\
Examples:
  g7 test                         the tests of every .g7 file in this folder and below
  g7 test tank --filter batch     only tests with `batch` in the title
  g7 test tank --list             their titles
  g7 test tank --fail-fast        only up to the first that fails
  g7 test tank --coverage         which steps, transitions, actions no test reached
  g7 test tank --junit out.xml    for a build server

{EXIT_CODES}"))]
pub(crate) struct Test {
    /// Files or folders.
    #[arg(default_value = ".")]
    pub(crate) paths: Vec<PathBuf>,
    /// Run only tests whose title contains this text.
    #[arg(long, short, value_name = "TEXT")]
    pub(crate) filter: Option<String>,
    /// List the steps, transitions, actions and branches that no test reached.
    #[arg(long)]
    pub(crate) coverage: bool,
    /// Write a JUnit report.
    #[arg(long, value_name = "FILE")]
    pub(crate) junit: Option<PathBuf>,
    /// Let --junit replace a file that g7 did not write.
    #[arg(long)]
    pub(crate) force: bool,
    /// Only list the tests.
    #[arg(long, conflicts_with_all = ["coverage", "junit"])]
    pub(crate) list: bool,
    /// How many files are tested at a time [default: as many as there are processors].
    #[arg(long, short, value_name = "NUMBER", value_parser = clap::value_parser!(u16).range(1..=256))]
    pub(crate) jobs: Option<u16>,
    /// Run no more tests behind the first that fails.
    #[arg(long)]
    pub(crate) fail_fast: bool,
    /// End a test that takes more real time than this: it has failed.
    #[arg(long, value_parser = values::duration, value_name = "TIME", default_value = "60s")]
    pub(crate) timeout: Nanos,
    /// For people or for programs.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// The profile to use instead of the file's own.
    #[arg(long, value_parser = values::profiles())]
    pub(crate) profile: Option<ProfileName>,
    /// Time between scans, instead of the file's own (10ms).
    #[arg(long, value_parser = values::duration, value_name = "TIME")]
    pub(crate) scan: Option<Nanos>,
}

/// Bounds of a search, unless the user says others.
const TIME: &str = "60s";
const MEMORY: usize = 1024;
const STATES: usize = 20_000_000;

pub(crate) const PROOF_CODES: &str = "\
Exit codes:
  0  everything is proved (of two charts: they are equal); or process 0 of --hosts tells
  1  something is refuted (they differ), or the charts have errors
  2  bad usage, or something outside the chart: no such file, a full disk
  3  nothing is refuted, but something is not decided, or was not asked in time";

#[derive(Args, Clone, Debug)]
#[command(after_help = format!("\
Examples:
  g7 prove tank                   every question of every .g7 file in this folder and below
  g7 prove tank --all             also what is proved of every chart
  g7 prove tank --time 5s         with the answers that are known by then
  g7 prove tank --format json     for a program to read
  g7 prove tank --format sarif > tank.sarif      for code review
  g7 prove tank.g7 --save tank.g7                what is refuted, as tests that fail, in the same file
  g7 prove tank.g7 --tests all.g7                scenarios that reach all of the chart
  g7 prove tank.g7 --workers 4                   the search shared among four processes
  g7 prove tank.g7 --hosts hosts.txt --process 0 the same among machines, started on each of them
  g7 prove tank --shard 2/3 > part2.jsonl        the second third of all questions

{PROOF_CODES}"))]
pub(crate) struct Prove {
    /// Files or folders; `-` reads the standard input.
    #[arg(default_value = ".")]
    pub(crate) paths: Vec<PathBuf>,
    /// Show each answer with its reason, those that are proved too.
    #[arg(long)]
    pub(crate) all: bool,
    /// The profile to use instead of the file's own.
    #[arg(long, value_parser = values::profiles())]
    pub(crate) profile: Option<ProfileName>,
    /// Ask everything of the closed loop of charts and this plant.
    #[arg(long, value_name = "PLANT", conflicts_with = "tests")]
    pub(crate) plant: Option<String>,
    /// Stop after this time, all included: reading, compiling, answering.
    #[arg(long, value_parser = values::duration, value_name = "TIME", default_value = TIME)]
    pub(crate) time: Nanos,
    /// Memory for states, in MiB; the charts themselves come on top.
    #[arg(long, value_name = "MIB", default_value_t = MEMORY)]
    pub(crate) memory: usize,
    /// Most states of a search.
    #[arg(long, value_name = "NUMBER", default_value_t = STATES)]
    pub(crate) states: usize,
    /// Write a JUnit report.
    #[arg(long, value_name = "FILE")]
    pub(crate) junit: Option<PathBuf>,
    /// Write the chart with each refuted claim as a test that fails; the chart's own file takes
    /// the tests too.
    #[arg(long, value_name = "FILE")]
    pub(crate) save: Option<PathBuf>,
    /// Write the chart with a small set of tests that reach every step, transition, action and
    /// branch that can be reached, for you to confirm.
    #[arg(long, value_name = "FILE")]
    pub(crate) tests: Option<PathBuf>,
    /// With --save, --tests and --junit: replace a file that is there and is not the chart's own.
    #[arg(long)]
    pub(crate) force: bool,
    /// For people (if nothing is said), for programs or for code review.
    #[arg(long, value_enum)]
    pub(crate) format: Option<Answers>,
    #[command(flatten)]
    pub(crate) shared: Shared,
}

impl Prove {
    /// All questions of a file, each with its answer, within a time.
    pub(crate) fn of(path: &std::path::Path, time: Nanos) -> Prove {
        Prove {
            paths: vec![path.to_path_buf()],
            all: true,
            profile: None,
            plant: None,
            time,
            memory: MEMORY,
            states: STATES,
            junit: None,
            save: None,
            tests: None,
            force: false,
            format: None,
            shared: Shared::default(),
        }
    }

    /// The form of the answers; `--shard` has one of its own.
    pub(crate) fn answers(&self) -> Answers {
        self.format.unwrap_or(Answers::Text)
    }
}

// A proof whose work is shared. A comment of documentation here would take the place of the command's own.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Shared {
    /// Share the search over states among so many processes. Without --process all of them are started
    /// here.
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u16).range(1..=256), conflicts_with_all = ["plant", "tests"])]
    pub(crate) workers: Option<u16>,
    /// The addresses of the processes, `host:port`, one a line; without it they are on this machine only.
    /// They talk without encryption and believe each other: use a network that you trust.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["plant", "tests"])]
    pub(crate) hosts: Option<PathBuf>,
    /// Be the process with this number, from 0, in the file of hosts. Process 0 prints the answers.
    #[arg(long, value_name = "NUMBER", requires = "hosts")]
    pub(crate) process: Option<usize>,
    /// Keep the levels of the search in this folder: a process that is started again goes on from the last
    /// one.
    #[arg(long, value_name = "FOLDER")]
    pub(crate) keep: Option<PathBuf>,
    /// Answer one part of all questions of all files, as in 2/3, and print a line of JSON for each.
    #[arg(long, value_name = "I/N", value_parser = crate::prove::part, conflicts_with_all = ["workers", "hosts", "save", "tests", "junit"])]
    pub(crate) shard: Option<crate::prove::Part>,
    /// End when the standard input ends: the process that started this one is gone then.
    #[arg(long, hide = true)]
    pub(crate) child: bool,
}

#[derive(Args, Debug)]
#[command(after_help = format!("\
Examples:
  g7 compare before.g7 after.g7
  g7 compare tank.g7 --profiles iec60848,unity
  g7 compare a.g7 b.g7 --situations      the active steps too, by their names

{PROOF_CODES}"))]
pub(crate) struct Compare {
    /// Two files; or one, with --profiles.
    #[arg(required = true, num_args = 1..=2)]
    pub(crate) files: Vec<PathBuf>,
    /// Two profiles, for the first and the second chart.
    #[arg(long, value_parser = values::profiles(), value_delimiter = ',', value_name = "PROFILES")]
    pub(crate) profiles: Vec<ProfileName>,
    /// Compare situations as well as outputs.
    #[arg(long)]
    pub(crate) situations: bool,
    /// Write both charts as one system, an AIGER file for other model checkers: its first bad
    /// signal is 1 where they differ.
    #[arg(long, value_name = "FILE")]
    pub(crate) aiger: Option<PathBuf>,
    /// With --aiger: replace a file that is there; never one of the charts.
    #[arg(long)]
    pub(crate) force: bool,
    /// Stop after this time.
    #[arg(long, value_parser = values::duration, value_name = "TIME", default_value = TIME)]
    pub(crate) time: Nanos,
    /// Memory for states, in MiB.
    #[arg(long, value_name = "MIB", default_value_t = MEMORY)]
    pub(crate) memory: usize,
    /// Most pairs of states.
    #[arg(long, value_name = "NUMBER", default_value_t = STATES)]
    pub(crate) states: usize,
}

impl Compare {
    /// A comparison of outputs within the usual bounds.
    pub(crate) fn of_outputs() -> Compare {
        let time = values::duration(TIME).unwrap_or(Nanos::MAX);
        Compare {
            files: Vec::new(),
            profiles: Vec::new(),
            situations: false,
            aiger: None,
            force: false,
            time,
            memory: MEMORY,
            states: STATES,
        }
    }
}

#[derive(Args, Debug)]
#[command(after_help = format!("\
Examples:
  g7 import Sorter.xml                  to the standard output
  g7 import Sorter.xml -o sorter.g7     to a file, which must not be there yet
  g7 import Sorter.xml -o sorter.g7 --compare   and prove that it does the same

What the importer does not know is reported with its line, never dropped in silence.

{EXIT_CODES}"))]
pub(crate) struct Import {
    /// The file of another tool.
    pub(crate) file: PathBuf,
    /// The file to write [default: the standard output].
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Replace the output file if it exists.
    #[arg(long)]
    pub(crate) force: bool,
    /// Read the output back, and compare it with the file over all runs, as `g7 compare` does.
    #[arg(long, requires = "output")]
    pub(crate) compare: bool,
}

#[derive(Args, Debug)]
#[command(after_help = "\
The editor starts it; see the page on editors in the book.")]
pub(crate) struct Lsp {
    /// Accepted because most editors give it; there is no other way.
    #[arg(long, hide = true)]
    pub(crate) stdio: bool,
    /// Show the values of the runs of `g7 serve` on this machine; the address is the one that it prints.
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) follow: Option<String>,
}

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  g7 explain G0101
  g7 explain --lang fr G0101   in French
  g7 explain            every code with its title")]
pub(crate) struct Explain {
    /// The code, as in `error[G0101]`.
    #[arg(value_parser = values::problem_codes(), hide_possible_values = true)]
    pub(crate) code: Option<String>,
}

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  g7 completions bash > ~/.local/share/bash-completion/completions/g7
  g7 completions fish > ~/.config/fish/completions/g7.fish")]
pub(crate) struct Completions {
    /// The shell.
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  g7 man | man -l -
  g7 man --out /usr/local/share/man/man1")]
pub(crate) struct Man {
    /// Write a page for each command to this folder.
    #[arg(long, value_name = "FOLDER")]
    pub(crate) out: Option<PathBuf>,
}
