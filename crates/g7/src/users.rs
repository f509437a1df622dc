//! `g7 users`: the users of a server from the command line, also while it works.

use std::io::{BufRead as _, IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use crossterm::event::{Event, KeyCode, KeyEventKind, KeyModifiers, read};
use crossterm::terminal::{disable_raw_mode, enable_raw_mode};
use g7_host::{utc_millis, utc_text};
use g7_store::log::Log;
use g7_store::users::{Role, UserError, Users as File};
use serde_json::{Value, json};

use g7_model::{Said, say};

use crate::audit::{self, Audit};
use crate::failure::{Failure, Verdict, raw};
use crate::message::{talk, tell, told};
use crate::who::Who;
use crate::wiring;

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  g7 users list g7.users               names, roles, open sessions
  g7 users add g7.users ana admin      asks for a password, or reads a line of the input
  g7 users add sorter.g7 rui operator  the users and the log that sorter.io.toml names
  g7 users role g7.users rui engineer
  g7 users revoke g7.users rui         ends all sessions of rui, within a second
  g7 users remove g7.users rui

Roles: viewer sees; operator starts, stops, acknowledges and reads the log; engineer
forces values and changes charts and files; admin manages users. Each may do what those
before may. A change of role or password ends the sessions of the user.")]
pub(crate) struct Users {
    #[command(subcommand)]
    work: Work,
}

#[derive(Args, Debug)]
struct In {
    /// The file of the users, or a chart whose io file names it.
    file: PathBuf,
    /// The log into which changes are written [default: that of the io file].
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
enum Work {
    /// Print names, roles and the number of open sessions.
    List(In),
    /// Add a user; the password is asked for.
    Add {
        #[command(flatten)]
        at: In,
        /// The name.
        name: String,
        /// viewer, operator, engineer or admin.
        role: Role,
    },
    /// Give a user another role.
    Role {
        #[command(flatten)]
        at: In,
        /// The name.
        name: String,
        /// viewer, operator, engineer or admin.
        role: Role,
    },
    /// Give a user another password; it is asked for.
    Password {
        #[command(flatten)]
        at: In,
        /// The name.
        name: String,
    },
    /// Remove a user.
    Remove {
        #[command(flatten)]
        at: In,
        /// The name.
        name: String,
    },
    /// End all sessions of a user.
    Revoke {
        #[command(flatten)]
        at: In,
        /// The name.
        name: String,
    },
}

/// The files that a command works on.
struct Open {
    users: File,
    /// Written to its end before the command ends.
    _log: Option<Log>,
    audit: Audit,
}

fn failed(error: UserError) -> Failure {
    Failure::Usage(error.said())
}

/// A role in words; the words of the command line stay as they are.
fn called(role: Role) -> Said {
    match role {
        Role::Viewer => say!("viewer"),
        Role::Operator => say!("operator"),
        Role::Engineer => say!("engineer"),
        Role::Admin => say!("admin"),
    }
}

fn open(at: &In) -> Result<Open, Failure> {
    let (path, log) = paths(&at.file)?;
    let log = at.log.clone().or(log);
    let log = log.map(|path| audit::open(&path, None, None)).transpose()?;
    let (log, audit) = log.map_or_else(Default::default, |(log, audit)| (Some(log), audit));
    let users = File::open(&path).map_err(|e| {
        Failure::Usage(say!("cannot use {} as the users: {e}", raw(path.display()), e = e.said()))
    })?;
    Ok(Open { users, _log: log, audit })
}

/// The file of the users, and the log: named, or by a chart or its io file.
fn paths(file: &Path) -> Result<(PathBuf, Option<PathBuf>), Failure> {
    let ends = |end: &str| file.extension().is_some_and(|e| e == end);
    if !ends("g7") && !ends("toml") {
        return Ok((file.to_path_buf(), None));
    }
    let io = if ends("g7") { wiring::io_file(file, None) } else { file.to_path_buf() };
    let setup = wiring::settings(&io);
    let Some(users) = &setup.server.users else {
        return Err(Failure::Usage(say!(
            "{} names no file of users: write `users = \"g7.users\"` in its [server]",
            raw(io.display())
        )));
    };
    let log = setup.controller.log.as_ref().map(|log| io.with_file_name(&log.file.value));
    Ok((io.with_file_name(&users.value), log))
}

impl Open {
    /// A change, in the log before it is made.
    fn change(
        &self,
        kind: &str,
        data: &Value,
        work: impl FnOnce(&File) -> Result<(), UserError>,
    ) -> Result<(), Failure> {
        self.audit.must(&Who::console(), kind, data).map_err(|why| Failure::Usage(raw(why)))?;
        work(&self.users).map_err(failed)
    }
}

pub(crate) fn users(args: &Users) -> Result<Verdict, Failure> {
    match &args.work {
        Work::List(at) => list(at)?,
        Work::Add { at, name, role } => {
            let open = open(at)?;
            let password = password(name)?;
            open.change("user-add", &json!({ "user": name, "role": role.word() }), |users| {
                users.add(name, *role, &password, utc_millis(), false)
            })?;
            tell(say!("added {}, {}", raw(name), called(*role)));
        }
        Work::Role { at, name, role } => {
            let data = json!({ "user": name, "role": role.word() });
            open(at)?.change("user-role", &data, |users| users.set_role(name, *role))?;
            tell(say!("{} is {}", raw(name), called(*role)));
        }
        Work::Password { at, name } => {
            let open = open(at)?;
            let password = password(name)?;
            open.change("user-password", &json!({ "user": name }), |users| {
                users.set_password(name, &password)
            })?;
            tell(say!("{} has another password", raw(name)));
        }
        Work::Remove { at, name } => {
            open(at)?.change("user-remove", &json!({ "user": name }), |users| users.remove(name))?;
            tell(say!("removed {}", raw(name)));
        }
        Work::Revoke { at, name } => {
            open(at)?.change("user-revoke", &json!({ "user": name }), |users| users.revoke(name))?;
            tell(say!("{} has no session any more", raw(name)));
        }
    }
    Ok(Verdict::Fine)
}

fn list(at: &In) -> Result<(), Failure> {
    let (path, _) = paths(&at.file)?;
    if !path.is_file() {
        return Err(Failure::Read(path, std::io::ErrorKind::NotFound.into()));
    }
    let users = File::open(&path).map_err(failed)?;
    let mut out = anstream::stdout().lock();
    for user in users.list().map_err(failed)? {
        let day = utc_text(user.created);
        let day = day.get(..10).unwrap_or(&day);
        let since = told(&say!("since {}  sessions: {}", raw(day), user.sessions));
        writeln!(out, "{:<24} {:<12} {since}", user.name, told(&called(user.role)))?;
    }
    Ok(out.flush()?)
}

/// A password, typed twice without being seen, or a line of the standard input.
fn password(name: &str) -> Result<String, Failure> {
    if !std::io::stdin().is_terminal() {
        let mut line = String::new();
        std::io::stdin().lock().read_line(&mut line)?;
        return Ok(line.trim_end_matches(['\r', '\n']).to_owned());
    }
    let first = typed(&say!("password for `{name}`: "))?;
    if typed(&say!("once more: "))? != first {
        return Err(Failure::Usage(say!("the two are not the same; nothing was changed")));
    }
    Ok(first)
}

/// A line that the terminal does not show.
fn typed(ask: &Said) -> Result<String, Failure> {
    /// Gives the terminal back however the reading ends.
    struct Raw;
    impl Drop for Raw {
        fn drop(&mut self) {
            disable_raw_mode().ok();
            talk!();
        }
    }
    write!(anstream::stderr(), "{}", told(ask))?;
    enable_raw_mode()?;
    let _raw = Raw;
    let mut line = String::new();
    loop {
        let Event::Key(key) = read()? else { continue };
        if key.kind == KeyEventKind::Release {
            continue;
        }
        match key.code {
            KeyCode::Enter => return Ok(line),
            KeyCode::Backspace => drop(line.pop()),
            KeyCode::Char('c' | 'd') if key.modifiers.contains(KeyModifiers::CONTROL) => {
                return Err(Failure::Usage(say!("nothing was changed")));
            }
            KeyCode::Char(sign) => line.push(sign),
            _ => {}
        }
    }
}
