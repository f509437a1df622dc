//! `g7 gen fmu`: the files of `g7_codegen::fmu` compiled for this machine and packed as a zip archive.

use std::io::{Cursor, Write};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use clap::Args;
use g7_codegen::fmu::{Fmu as Files, Version};
use g7_model::{ProfileName, say};
use zip::write::SimpleFileOptions;

use crate::failure::{Failure, Verdict, raw};
use crate::message::{note, wrote};
use crate::scratch::Scratch;
use crate::{files, values};

/// Compilers that are tried if `CC` names none.
const COMPILERS: [&str; 3] = ["cc", "gcc", "clang"];

/// The arguments of `g7 gen fmu`.
#[derive(Args, Debug)]
pub(crate) struct Fmu {
    /// A .g7 file, a file of another tool, or a folder with a chart.g7.
    #[arg(default_value = ".")]
    pub(crate) file: PathBuf,
    /// The version of the standard: 2 is read by nearly every tool, 3 has all integer types.
    #[arg(long, value_enum, default_value_t = Fmi::Two)]
    pub(crate) fmi: Fmi,
    /// The FMU [default: the name of the chart's file, with .fmu].
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The name of the model and the prefix of its C names [default: the name of the chart's file].
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,
    /// The profile to use instead of the file's own.
    #[arg(long, value_parser = values::profiles())]
    pub(crate) profile: Option<ProfileName>,
    /// Pack the sources alone: the simulator compiles them.
    #[arg(long)]
    sources: bool,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
}

/// The versions, as one writes them.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(crate) enum Fmi {
    /// FMI 2.0.
    #[value(name = "2")]
    Two,
    /// FMI 3.0.
    #[value(name = "3")]
    Three,
}

impl From<Fmi> for Version {
    fn from(fmi: Fmi) -> Version {
        match fmi {
            Fmi::Two => Version::V2,
            Fmi::Three => Version::V3,
        }
    }
}

/// Compiles the files for this machine, if that is possible, and writes the archive.
pub(crate) fn pack(args: &Fmu, name: &str, made: &Files) -> Result<Verdict, Failure> {
    let to = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.fmu")));
    files::refuse_source(Some(&to), &[&files::one(&args.file)?])?;
    if to.exists() && !args.force {
        return Err(Failure::Usage(say!("{} already exists; --force replaces it", raw(to.display()))));
    }
    let library = if args.sources { None } else { library(args.fmi.into(), made)? };
    let mut entries: Vec<(String, Vec<u8>)> =
        made.files.iter().map(|f| (f.name.clone(), f.text.clone().into_bytes())).collect();
    entries.extend(library);
    let bytes = archive(&entries).map_err(|e| Failure::Write(to.clone(), std::io::Error::other(e)))?;
    if let Some(folder) = to.parent().filter(|p| !p.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|e| Failure::Write(folder.to_path_buf(), e))?;
    }
    files::write(&to, &bytes)?;
    wrote(to.display());
    Ok(Verdict::Fine)
}

/// The archive. Its times are fixed, so the same files give the same bytes.
fn archive(entries: &[(String, Vec<u8>)]) -> zip::result::ZipResult<Vec<u8>> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        archive.start_file(name, SimpleFileOptions::default())?;
        archive.write_all(bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}

/// The library for this machine and its path in the archive; without a compiler there is none, which is told.
fn library(version: Version, made: &Files) -> Result<Option<(String, Vec<u8>)>, Failure> {
    let Some(folder) = version.folder(std::env::consts::OS, std::env::consts::ARCH) else {
        note(say!("FMI has no name for this machine: the FMU holds the sources alone"));
        return Ok(None);
    };
    let Some(compiler) = compiler() else {
        note(say!(
            "no C compiler was found (CC, cc, gcc, clang): the FMU holds the sources alone, and the simulator has \
             to compile them"
        ));
        return Ok(None);
    };
    let scratch = Scratch::new()?;
    for file in made.files.iter().filter(|f| f.name.starts_with("sources/")) {
        let name = file.name.trim_start_matches("sources/");
        files::write(&scratch.path().join(name), file.text.as_bytes())?;
    }
    let file = format!("{}{}", made.identifier, std::env::consts::DLL_SUFFIX);
    let mut command = Command::new(&compiler);
    command.current_dir(scratch.path()).args(["-std=c99", "-O2", "-shared", "-fvisibility=hidden"]);
    if !cfg!(windows) {
        command.arg("-fPIC");
    }
    command.args(&made.compiled).args(["-o", &file]);
    if !cfg!(windows) {
        command.arg("-lm");
    }
    let out = command
        .output()
        .map_err(|e| Failure::Usage(say!("{compiler}: {e}", compiler = raw(&compiler), e = raw(&e))))?;
    if !out.status.success() {
        let said = String::from_utf8_lossy(&out.stderr);
        let said: Vec<&str> = said.lines().take(10).collect();
        return Err(Failure::Usage(say!(
            "{compiler} does not compile the code; --sources packs it as it is:{}",
            raw(format!("\n{}", said.join("\n"))),
            compiler = raw(&compiler)
        )));
    }
    let bytes = files::read(&scratch.path().join(&file))?;
    Ok(Some((format!("binaries/{folder}/{file}"), bytes)))
}

/// A C compiler of this machine.
fn compiler() -> Option<String> {
    let starts = |name: &String| {
        let mut command = Command::new(name);
        command.arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|s| s.success())
    };
    let named = std::env::var("CC").ok().filter(|c| !c.is_empty());
    match named {
        Some(named) => Some(named).filter(starts),
        None => COMPILERS.map(str::to_owned).into_iter().find(starts),
    }
}
