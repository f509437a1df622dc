//! The persons who may use a server, their roles, and their sessions, in one file of SQLite.
//!
//! ```text
//! g7 users, the page of an admin -> Users -> file
//! login -> Users::check (argon2id) -> Users::begin -> a secret for the browser; the file has its hash
//! ```
//!
//! # Invariants
//!
//! No password and no secret of a session is in the file: argon2id of the one, SHA-256 of the other, whose 256
//! bits nobody guesses. There is no password that was not chosen by a person.
//! A change of role or password, and a removal, end the sessions of the user in the same step.
//! The last admin is neither removed nor given another role.

mod error;
mod password;

use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::sync::{Mutex, MutexGuard, PoisonError};

use g7_model::{Said, say};
use rusqlite::{Connection, ErrorCode, OptionalExtension as _, Transaction, params};
use sha2::{Digest as _, Sha256};

use crate::file::{self, Durable};
pub use error::UserError;

use password::Kept;
pub use password::LEAST;

/// The application id of the file: `G7US`.
const KIND: i32 = 0x4737_5553;

const LAYOUTS: [&str; 2] = [
    "\
CREATE TABLE user (
    name TEXT PRIMARY KEY COLLATE NOCASE,
    role TEXT NOT NULL,
    memory INTEGER NOT NULL,
    passes INTEGER NOT NULL,
    salt BLOB NOT NULL,
    hash BLOB NOT NULL,
    created INTEGER NOT NULL
) STRICT;
CREATE TABLE session (
    hash BLOB PRIMARY KEY,
    user TEXT NOT NULL COLLATE NOCASE REFERENCES user (name),
    origin TEXT NOT NULL,
    created INTEGER NOT NULL,
    seen INTEGER NOT NULL
) STRICT;",
    "ALTER TABLE user ADD COLUMN changes INTEGER NOT NULL DEFAULT 0;",
];

/// The rights of a user; each role may do what those before it may.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Sees everything but the log and the users.
    Viewer,
    /// Starts, stops, acknowledges; reads the log.
    Operator,
    /// Forces values, changes the chart and its files.
    Engineer,
    /// Manages the users.
    Admin,
}

impl Role {
    /// All roles, the least first.
    pub const ALL: [Role; 4] = [Role::Viewer, Role::Operator, Role::Engineer, Role::Admin];

    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Role::Viewer => "viewer",
            Role::Operator => "operator",
            Role::Engineer => "engineer",
            Role::Admin => "admin",
        }
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

impl FromStr for Role {
    type Err = Said;

    fn from_str(text: &str) -> Result<Role, Said> {
        let found = Role::ALL.into_iter().find(|role| role.word() == text);
        found.ok_or_else(|| say!("a role is one of `viewer`, `operator`, `engineer`, `admin`"))
    }
}

impl From<rusqlite::Error> for UserError {
    fn from(error: rusqlite::Error) -> UserError {
        UserError::Store(error.into())
    }
}

fn refused<T>(why: Said) -> Result<T, UserError> {
    Err(UserError::Refused(why))
}

/// A user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct User {
    /// The name.
    pub name: String,
    /// The rights of the user.
    pub role: Role,
    /// When the user was added, in ms since 1970, UTC.
    pub created: u64,
    /// The sessions that are open.
    pub sessions: u64,
    /// A number that is another one after each change that ends the sessions of the user.
    pub changes: u64,
}

/// The SHA-256 of the secret of a session.
pub type SessionHash = [u8; 32];

/// A session as the file has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Session {
    /// The hash of its secret.
    pub hash: SessionHash,
    /// The name of the user.
    pub user: String,
    /// The role of the user now.
    pub role: Role,
    /// When it began, in ms since 1970, UTC.
    pub created: u64,
    /// When it was last used, to about a minute.
    pub seen: u64,
}

/// The file of the users. Several processes may use it.
#[derive(Debug)]
pub struct Users {
    file: Mutex<Connection>,
    /// The hash that the password of nobody is compared with, so that it takes as long as that of a user.
    nobody: Kept,
}

/// The hash of the secret of a session.
pub fn session_hash(secret: &str) -> SessionHash {
    Sha256::digest(secret.as_bytes()).into()
}

/// A secret that nobody guesses: 256 bits in hexadecimal digits.
///
/// # Errors
///
/// The system gives no random numbers.
pub fn secret() -> Result<String, UserError> {
    let mut bytes = [0; 32];
    getrandom::fill(&mut bytes).map_err(|e| UserError::Refused(password::no_chance(&e)))?;
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}

impl Users {
    /// Opens or makes the file.
    ///
    /// # Errors
    ///
    /// The file is something else, or cannot be read or written.
    pub fn open(path: &Path) -> Result<Users, UserError> {
        let file = file::open(path, KIND, &LAYOUTS, Durable::AtOnce)?;
        file.pragma_update(None, "foreign_keys", true)?;
        own(path)?;
        Ok(Users { file: Mutex::new(file), nobody: Kept::of(&secret()?)? })
    }

    fn lock(&self) -> MutexGuard<'_, Connection> {
        self.file.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// All users by name.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn list(&self) -> Result<Vec<User>, UserError> {
        let file = self.lock();
        let mut query = file.prepare(
            "SELECT name, role, created, (SELECT count(*) FROM session WHERE user = name), changes
             FROM user ORDER BY name",
        )?;
        let rows = query.query_map((), |row| {
            let (created, sessions, changes): (i64, i64, i64) = (row.get(2)?, row.get(3)?, row.get(4)?);
            let user = User {
                name: row.get(0)?,
                role: role_of(row.get(1)?)?,
                created: created as u64,
                sessions: sessions as u64,
                changes: changes as u64,
            };
            Ok(user)
        })?;
        Ok(rows.collect::<Result<_, _>>()?)
    }

    /// True if someone can manage the users.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn has_admin(&self) -> Result<bool, UserError> {
        Ok(admins(&self.lock())? > 0)
    }

    /// Adds a user; `first` only if there is no admin yet.
    ///
    /// # Errors
    ///
    /// The name or the password will not do, the name is taken, or the file cannot be written.
    pub fn add(
        &self,
        name: &str,
        role: Role,
        password: &str,
        now: u64,
        first: bool,
    ) -> Result<(), UserError> {
        fit_name(name)?;
        password::fit(name, password)?;
        let kept = Kept::of(password)?;
        let mut file = self.lock();
        let step = file.transaction_with_behavior(rusqlite::TransactionBehavior::Immediate)?;
        if first && admins(&step)? > 0 {
            return refused(say!("there is an admin already"));
        }
        let Kept { memory, passes, salt, hash } = kept;
        let row = params![name, role.word(), memory, passes, salt, hash, now as i64];
        match step.execute("INSERT INTO user VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, 0)", row) {
            Err(e) if e.sqlite_error_code() == Some(ErrorCode::ConstraintViolation) => {
                return refused(say!("there is a user `{name}` already"));
            }
            done => done?,
        };
        Ok(step.commit()?)
    }

    /// Gives a user another role.
    ///
    /// # Errors
    ///
    /// There is no such user, it is the last admin, or the file cannot be written.
    pub fn set_role(&self, name: &str, role: Role) -> Result<(), UserError> {
        self.change(name, |step, was| {
            if was == Role::Admin && role != Role::Admin && admins(step)? < 2 {
                return refused(say!("`{name}` is the last admin: make another one first"));
            }
            step.execute("UPDATE user SET role = ?2 WHERE name = ?1", (name, role.word()))?;
            Ok(())
        })
    }

    /// Gives a user another password.
    ///
    /// # Errors
    ///
    /// There is no such user, the password will not do, or the file cannot be written.
    pub fn set_password(&self, name: &str, password: &str) -> Result<(), UserError> {
        password::fit(name, password)?;
        let Kept { memory, passes, salt, hash } = Kept::of(password)?;
        self.change(name, |step, _| {
            let text = "UPDATE user SET memory = ?2, passes = ?3, salt = ?4, hash = ?5 WHERE name = ?1";
            step.execute(text, params![name, memory, passes, salt, hash])?;
            Ok(())
        })
    }

    /// Removes a user.
    ///
    /// # Errors
    ///
    /// There is no such user, it is the last admin, or the file cannot be written.
    pub fn remove(&self, name: &str) -> Result<(), UserError> {
        self.change(name, |step, was| {
            if was == Role::Admin && admins(step)? < 2 {
                return refused(say!("`{name}` is the last admin: make another one first"));
            }
            step.execute("DELETE FROM user WHERE name = ?1", [name])?;
            Ok(())
        })
    }

    /// Ends all sessions of a user.
    ///
    /// # Errors
    ///
    /// There is no such user, or the file cannot be written.
    pub fn revoke(&self, name: &str) -> Result<(), UserError> {
        self.change(name, |_, _| Ok(()))
    }

    /// A change of a user, whose sessions end in the same step.
    fn change(
        &self,
        name: &str,
        work: impl FnOnce(&Transaction<'_>, Role) -> Result<(), UserError>,
    ) -> Result<(), UserError> {
        let mut file = self.lock();
        let step = file.transaction_with_behavior(rusqlite::TransactionBehavior::Immediate)?;
        let was = step
            .query_row("SELECT role FROM user WHERE name = ?1", [name], |row| role_of(row.get(0)?))
            .optional()?;
        let Some(was) = was else { return refused(say!("there is no user `{name}`")) };
        step.execute("DELETE FROM session WHERE user = ?1", [name])?;
        step.execute("UPDATE user SET changes = changes + 1 WHERE name = ?1", [name])?;
        work(&step, was)?;
        Ok(step.commit()?)
    }

    /// The user with this name and password, with the name as it is written in the file. Takes the time and
    /// the memory of argon2id, whether there is such a user or not.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn check(&self, name: &str, password: &str) -> Result<Option<(String, Role)>, UserError> {
        let text = "SELECT name, role, memory, passes, salt, hash FROM user WHERE name = ?1";
        let found = self
            .lock()
            .query_row(text, [name], |row| {
                let kept =
                    Kept { memory: row.get(2)?, passes: row.get(3)?, salt: row.get(4)?, hash: row.get(5)? };
                Ok((row.get(0)?, role_of(row.get(1)?)?, kept))
            })
            .optional()?;
        // Without the lock: others go on meanwhile.
        Ok(match found {
            Some((name, role, kept)) => kept.is(password)?.then_some((name, role)),
            None => {
                self.nobody.is(password)?;
                None
            }
        })
    }

    /// Begins a session; its secret is for the browser alone.
    ///
    /// # Errors
    ///
    /// There is no such user any more, or the file cannot be written.
    pub fn begin(&self, name: &str, origin: &str, now: u64) -> Result<String, UserError> {
        let secret = secret()?;
        let row = params![session_hash(&secret), name, origin, now as i64];
        match self.lock().execute("INSERT INTO session VALUES (?1, ?2, ?3, ?4, ?4)", row) {
            Err(e) if e.sqlite_error_code() == Some(ErrorCode::ConstraintViolation) => {
                refused(say!("there is no user `{name}`"))
            }
            done => {
                done?;
                Ok(secret)
            }
        }
    }

    /// Notes that a session was used.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub fn touch(&self, hash: &SessionHash, now: u64) -> Result<(), UserError> {
        self.lock().execute("UPDATE session SET seen = ?2 WHERE hash = ?1", (hash, now as i64))?;
        Ok(())
    }

    /// Ends a session.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub fn end(&self, hash: &SessionHash) -> Result<(), UserError> {
        self.lock().execute("DELETE FROM session WHERE hash = ?1", [hash])?;
        Ok(())
    }

    /// All sessions.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn sessions(&self) -> Result<Vec<Session>, UserError> {
        let file = self.lock();
        let mut query = file.prepare(
            "SELECT session.hash, name, role, session.created, seen FROM session JOIN user ON user = name",
        )?;
        let rows = query.query_map((), |row| {
            let (created, seen): (i64, i64) = (row.get(3)?, row.get(4)?);
            let (hash, user, role) = (row.get(0)?, row.get(1)?, role_of(row.get(2)?)?);
            Ok(Session { hash, user, role, created: created as u64, seen: seen as u64 })
        })?;
        Ok(rows.collect::<Result<_, _>>()?)
    }

    /// A number that is another one after each change by another process.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn version(&self) -> Result<i64, UserError> {
        Ok(self.lock().pragma_query_value(None, "data_version", |row| row.get(0))?)
    }
}

/// Makes the file that of its owner alone, with what SQLite has beside it.
#[cfg(unix)]
fn own(path: &Path) -> Result<(), UserError> {
    use std::os::unix::fs::PermissionsExt as _;
    for end in ["", "-wal", "-shm"] {
        let mut name = path.as_os_str().to_owned();
        name.push(end);
        match std::fs::set_permissions(&name, std::fs::Permissions::from_mode(0o600)) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                return refused(say!(
                    "it cannot be made its owner's alone: {}",
                    Said::foreign(e.to_string())
                ));
            }
            _ => {}
        }
    }
    Ok(())
}

#[cfg(not(unix))]
fn own(_: &Path) -> Result<(), UserError> {
    Ok(())
}

fn admins(file: &Connection) -> Result<i64, UserError> {
    Ok(file.query_row("SELECT count(*) FROM user WHERE role = 'admin'", (), |row| row.get(0))?)
}

fn role_of(text: String) -> rusqlite::Result<Role> {
    text.parse::<Role>()
        .map_err(|why| rusqlite::Error::FromSqlConversionFailure(0, rusqlite::types::Type::Text, why.into()))
}

/// A name that reads the same everywhere.
fn fit_name(name: &str) -> Result<(), UserError> {
    let fits = |c: char| c.is_alphanumeric() || "._-@".contains(c);
    if name.is_empty() || name.chars().count() > 40 || !name.chars().all(fits) {
        return refused(say!("a name has 1 to 40 letters, digits, `.`, `_`, `-` or `@`"));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
