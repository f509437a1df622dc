//! The command line: files, arguments, the terminal; internal numbers are shown as names.
//!
//! # Where this sits
//!
//! ```text
//! arguments -> files -> syntax -> compile -> host::Runner -> view, traces, test reports
//! ```
//!
//! # Invariants
//!
//! Data goes to the standard output, messages go to the standard error.
//! Exit code 0: no problem; 1: problems, failed tests or refuted claims; 3: not decided; 2: wrong usage or a failure outside the
//! chart.
//! Files are written completely or not at all; a closed pipe ends the program silently.
#![forbid(unsafe_code)]

mod attendant;
mod audit;
mod brought;
mod certificate;
mod check;
mod cli;
mod devices;
mod dossier;
mod draw;
mod ended;
mod explain;
mod export;
mod failure;
mod files;
mod fmt;
mod fmu;
mod form;
mod generate;
mod grade;
mod history;
mod import;
mod journal;
mod lsp;
mod manager;
mod message;
mod monitor;
mod new;
mod operator;
mod origin;
mod plant;
mod post;
mod progress;
mod project;
mod prove;
mod reasons;
mod report;
mod run;
mod sarif;
mod scratch;
mod serve;
#[cfg(target_os = "linux")]
mod service;
mod share;
mod shell;
mod sole;
mod sources;
mod station;
mod style;
mod testing;
mod tongue;
mod used;
mod users;
mod values;
mod view;
mod who;
mod why;
mod wiring;

use std::process::ExitCode;

use clap::Parser;

use crate::cli::{Cli, Color, Command};
use crate::failure::{Failure, Verdict};

fn main() -> ExitCode {
    let cli = Cli::parse();
    tongue::choose(cli.lang);
    match cli.color {
        Color::Auto => {}
        Color::Always => anstream::ColorChoice::Always.write_global(),
        Color::Never => anstream::ColorChoice::Never.write_global(),
    }
    match run(&cli.command) {
        Ok(Verdict::Fine) => ExitCode::SUCCESS,
        Ok(Verdict::Found) => ExitCode::from(1),
        Ok(Verdict::Open) => ExitCode::from(3),
        Err(failure) if failure.is_quiet() => ExitCode::SUCCESS,
        Err(failure) => {
            message::error(&failure);
            ExitCode::from(2)
        }
    }
}

fn run(command: &Command) -> Result<Verdict, Failure> {
    match command {
        Command::New(args) => new::new(args),
        Command::Check(args) => check::check(args),
        Command::Fmt(args) => fmt::fmt(args),
        Command::Run(args) => run::run(args),
        Command::Devices(args) => devices::devices(args),
        Command::Plant(args) => plant::plant(args),
        Command::History(args) => history::history(args),
        Command::Why(args) => why::why(args),
        Command::Test(args) => testing::test(args),
        Command::Grade(args) => grade::grade(args),
        Command::Prove(args) => prove::prove(args),
        Command::Compare(args) => prove::compare(args),
        Command::Graph(args) => prove::graph(args),
        Command::Draw(args) => draw::draw(args),
        Command::Dossier(args) => dossier::dossier(args),
        Command::Serve(args) => serve::serve(args),
        Command::Users(args) => users::users(args),
        Command::Log(args) => journal::journal(args),
        Command::Cert(args) => certificate::certificate(args),
        #[cfg(target_os = "linux")]
        Command::Service(args) => service::service(args),
        Command::Import(args) => import::import(args),
        Command::Export(args) => export::export(args, prove::read_back),
        Command::Gen(args) => generate::generate(args),
        Command::Lsp(args) => lsp::serve(args.follow.as_deref()),
        Command::Explain(args) => explain::explain(args),
        Command::Completions(args) => shell::completions(args),
        Command::Man(args) => shell::man(args),
    }
}
