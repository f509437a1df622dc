//! Users of the server: who has a session, who may begin one, and the end of sessions.
//!
//! ```text
//! guard -> Access::who (memory alone) -> Who of a request
//! entry -> Access::login (throttle, two checks at once) -> Users -> file
//! a change of the file by anyone -> Access::look -> sockets hear that sessions ended
//! ```
//!
//! # Invariants
//!
//! A session that is over in the file is over here within a second, and so are its sockets.
//! Nobody is let in because something failed: without an answer of the file there is no session.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use axum::http::StatusCode;
use g7_host::utc_millis;
use g7_model::{Nanos, Said, say};
use g7_store::users::{Role, SessionHash, UserError, Users, session_hash};
use serde_json::json;
use tokio::sync::{Semaphore, watch};

use super::aside::aside;
use super::refusal::Refusal;
use super::throttle::Throttle;
use crate::audit::Audit;
use crate::failure::{Failure, raw};
use crate::who::Who;

/// Passwords that are checked at the same time: each takes 19 MiB.
const CHECKS: usize = 2;
/// Logins that wait for a check.
const WAITING: usize = 32;
/// The longest wait for a check.
const PATIENCE: Duration = Duration::from_secs(10);
/// A session is noted as used so often.
const NOTED: u64 = 60_000;
/// Wrong codes after which the first admin is made by the command line alone.
const CODES: u32 = 20;

/// How long sessions last, in ms.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lasts {
    pub(super) idle: u64,
    pub(super) whole: u64,
}

impl Lasts {
    /// A shift without use, a week in all, where nothing else is said.
    pub(super) fn of(idle: Option<Nanos>, whole: Option<Nanos>) -> Lasts {
        let ms = |time: Option<Nanos>, usual: Nanos| {
            u64::try_from(time.unwrap_or(usual).count() / 1_000_000).unwrap_or_default()
        };
        Lasts { idle: ms(idle, Nanos::HOUR * 8), whole: ms(whole, Nanos::HOUR * 168) }
    }
}

#[derive(Clone, Debug)]
struct Held {
    user: String,
    role: Role,
    created: u64,
    seen: u64,
    /// The time of use that the file knows.
    noted: u64,
}

/// The code that makes the first admin.
#[derive(Debug)]
struct Code {
    text: String,
    wrong: u32,
}

/// The users of a server and their sessions.
#[derive(Debug)]
pub(crate) struct Access {
    users: Users,
    lasts: Lasts,
    held: Mutex<BTreeMap<SessionHash, Held>>,
    version: Mutex<i64>,
    throttle: Mutex<Throttle>,
    checks: Semaphore,
    waiting: Semaphore,
    code: Mutex<Option<Code>>,
    /// Sockets look anew when it changes.
    changed: watch::Sender<u64>,
    audit: Audit,
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

fn full(text: Said) -> Refusal {
    Refusal::new(StatusCode::TOO_MANY_REQUESTS, text)
}

/// The refusal of a change of users.
pub(super) fn refusal(error: UserError) -> Refusal {
    match error {
        UserError::Refused(why) => Refusal::new(StatusCode::CONFLICT, why),
        store @ UserError::Store(_) => {
            Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, say!("{}; nothing was changed", store.said()))
        }
    }
}

impl Access {
    /// Opens the file of the users.
    pub(super) fn open(path: &Path, lasts: Lasts, audit: Audit) -> Result<Access, Failure> {
        let failed = |e: UserError| {
            Failure::Usage(say!("cannot use {} as the users: {e}", raw(path.display()), e = raw(&e)))
        };
        let users = Users::open(path).map_err(failed)?;
        let code = if users.has_admin().map_err(failed)? {
            None
        } else {
            Some(Code { text: code().map_err(failed)?, wrong: 0 })
        };
        let access = Access {
            users,
            lasts,
            held: Mutex::default(),
            version: Mutex::new(i64::MIN),
            throttle: Mutex::default(),
            checks: Semaphore::new(CHECKS),
            waiting: Semaphore::new(WAITING),
            code: Mutex::new(code),
            changed: watch::Sender::new(0),
            audit,
        };
        access.read().map_err(failed)?;
        Ok(access)
    }

    /// The code for the first admin, while there is none.
    pub(super) fn code(&self) -> Option<String> {
        lock(&self.code).as_ref().map(|code| code.text.clone())
    }

    /// Hears when sessions may have ended.
    pub(super) fn hear(&self) -> watch::Receiver<u64> {
        self.changed.subscribe()
    }

    /// The user of a session, by its secret; it counts as used.
    pub(super) fn who(&self, secret: &str, from: IpAddr) -> Option<Who> {
        self.again(&session_hash(secret), from, true)
    }

    /// The user of a session now; `None` once it is over. `used` by a request, or by a socket that is open.
    pub(super) fn again(&self, hash: &SessionHash, from: IpAddr, used: bool) -> Option<Who> {
        let now = utc_millis();
        let mut all = lock(&self.held);
        let held = all.get_mut(hash)?;
        if now.saturating_sub(held.created) >= self.lasts.whole
            || now.saturating_sub(held.seen) >= self.lasts.idle
        {
            return None;
        }
        if used {
            held.seen = now;
        }
        Some(Who::user(held.user.clone(), held.role, from.to_string(), Some(*hash)))
    }

    /// Reads the sessions of the file.
    fn read(&self) -> Result<(), UserError> {
        self.read_into(&mut lock(&self.held))?;
        self.changed.send_modify(|count| *count += 1);
        Ok(())
    }

    /// The same for who has the list: so no session that begins or ends meanwhile is missed.
    fn read_into(&self, all: &mut BTreeMap<SessionHash, Held>) -> Result<(), UserError> {
        *lock(&self.version) = self.users.version()?;
        let mut fresh = BTreeMap::new();
        for session in self.users.sessions()? {
            let seen = all.get(&session.hash).map_or(session.seen, |held| held.seen.max(session.seen));
            let (user, role, created, noted) = (session.user, session.role, session.created, session.seen);
            fresh.insert(session.hash, Held { user, role, created, seen, noted });
        }
        *all = fresh;
        Ok(())
    }

    /// Looks for changes by other programs, ends old sessions, and notes what was used. For a thread that may
    /// wait, some times a second.
    pub(super) fn look(&self) {
        match self.users.version() {
            Ok(version) if version == *lock(&self.version) => {}
            // A file that cannot be read lets nobody in.
            _ => {
                if self.read().is_err() {
                    lock(&self.held).clear();
                    self.changed.send_modify(|count| *count += 1);
                }
            }
        }
        let now = utc_millis();
        let (mut over, mut used) = (Vec::new(), Vec::new());
        for (hash, held) in lock(&self.held).iter_mut() {
            let idle = now.saturating_sub(held.seen) >= self.lasts.idle;
            if idle || now.saturating_sub(held.created) >= self.lasts.whole {
                over.push((*hash, held.user.clone()));
            } else if held.seen.saturating_sub(held.noted) >= NOTED {
                held.noted = held.seen;
                used.push((*hash, held.seen));
            }
        }
        for (hash, seen) in used {
            self.users.touch(&hash, seen).ok();
        }
        for (hash, user) in &over {
            lock(&self.held).remove(hash);
            self.users.end(hash).ok();
            self.audit.event("note", "session-over", None, &json!({ "user": user }));
        }
        if !over.is_empty() {
            self.changed.send_modify(|count| *count += 1);
        }
        for (from, count) in lock(&self.throttle).refused(now) {
            self.audit.event("warning", "login-throttled", None, &json!({ "from": from, "count": count }));
        }
    }

    /// Lets a guess of a password wait for its check, or refuses it.
    async fn guess(&self, from: IpAddr) -> Result<tokio::sync::SemaphorePermit<'_>, Refusal> {
        if !lock(&self.throttle).allows(from, utc_millis()) {
            return Err(full(say!("too many tries from this address: wait a minute")));
        }
        let busy = || full(say!("too many people log in at this moment: try again"));
        let _place = self.waiting.try_acquire().map_err(|_| busy())?;
        match tokio::time::timeout(PATIENCE, self.checks.acquire()).await {
            Ok(Ok(permit)) => Ok(permit),
            Ok(Err(_)) | Err(_) => Err(busy()),
        }
    }

    /// The user with this name and password, by the name of the file.
    pub(super) async fn prove(
        self: &Arc<Access>,
        name: String,
        password: String,
        from: IpAddr,
    ) -> Result<String, Refusal> {
        let _permit = self.guess(from).await?;
        let access = Arc::clone(self);
        aside(move || {
            let found = access.users.check(&name, &password).map_err(refusal)?;
            found.map(|(name, _)| name).ok_or_else(|| {
                // A name that nobody has may be a password in the wrong field.
                let known = access.users.list().unwrap_or_default();
                let known = known.into_iter().find(|user| user.name.eq_ignore_ascii_case(&name));
                let user = known.map_or_else(|| "(unknown)".to_owned(), |user| user.name);
                access.audit.event("warning", "login-refused", None, &json!({ "from": from, "user": user }));
                Refusal::new(StatusCode::UNAUTHORIZED, say!("name or password is wrong"))
            })
        })
        .await
    }

    /// Begins a session for a name and a password; its secret.
    pub(super) async fn login(
        self: &Arc<Access>,
        name: String,
        password: String,
        from: IpAddr,
    ) -> Result<String, Refusal> {
        let name = self.prove(name, password, from).await?;
        let access = Arc::clone(self);
        aside(move || access.opened(&name, from)).await
    }

    /// Gives a user who proves the old password a new one, and a session anew.
    pub(super) async fn renew(
        self: &Arc<Access>,
        who: Who,
        old: String,
        new: String,
        from: IpAddr,
    ) -> Result<String, Refusal> {
        // A session that someone left open does not give the user away.
        let name = self.prove(who.name.clone(), old, from).await?;
        let access = Arc::clone(self);
        aside(move || {
            let data = json!({ "user": name });
            access.change(&who, "user-password", &data, |users| users.set_password(&name, &new))?;
            access.opened(&name, from)
        })
        .await
    }

    /// Begins a session for a user who is known; the role is that of the file at this moment.
    pub(super) fn opened(&self, name: &str, from: IpAddr) -> Result<String, Refusal> {
        let mut all = lock(&self.held);
        let secret = self.users.begin(name, &from.to_string(), utc_millis()).map_err(refusal)?;
        self.read_into(&mut all).map_err(refusal)?;
        let role = all.get(&session_hash(&secret)).map_or(Role::Viewer, |held| held.role);
        drop(all);
        let who = Who::user(name.to_owned(), role, from.to_string(), None);
        self.audit.note(&who, "login", None, &json!({ "role": role.word() }));
        Ok(secret)
    }

    /// Makes the first admin, for who has the code of the console.
    pub(super) async fn first(
        self: &Arc<Access>,
        code: String,
        name: String,
        password: String,
        from: IpAddr,
    ) -> Result<String, Refusal> {
        let _permit = self.guess(from).await?;
        let access = Arc::clone(self);
        aside(move || {
            let wrong = || {
                Refusal::new(
                    StatusCode::UNAUTHORIZED,
                    say!("the code is wrong, or there is an admin already"),
                )
            };
            {
                let mut kept = lock(&access.code);
                let asked = kept.as_mut().ok_or_else(wrong)?;
                let given: String = code.chars().filter(char::is_ascii_alphanumeric).collect();
                let right =
                    session_hash(&given.to_ascii_lowercase()) == session_hash(&asked.text.replace('-', ""));
                if !right {
                    asked.wrong += 1;
                    if asked.wrong >= CODES {
                        *kept = None;
                    }
                    drop(kept);
                    access.audit.event("warning", "code-refused", None, &json!({ "from": from }));
                    return Err(wrong());
                }
            }
            let who = Who::user(name.clone(), Role::Admin, from.to_string(), None);
            access.must(&who, "user-add", &json!({ "user": name, "role": "admin", "first": true }))?;
            access.users.add(&name, Role::Admin, &password, utc_millis(), true).map_err(refusal)?;
            *lock(&access.code) = None;
            access.opened(&name, from)
        })
        .await
    }

    /// Ends a session.
    pub(super) fn logout(&self, who: &Who) -> Result<(), Refusal> {
        let Some(hash) = &who.session else { return Ok(()) };
        lock(&self.held).remove(hash);
        self.changed.send_modify(|count| *count += 1);
        self.audit.note(who, "logout", None, &json!({}));
        self.users.end(hash).map_err(refusal)
    }

    /// A change of the users, written into the log before it is made.
    pub(super) fn change(
        &self,
        who: &Who,
        kind: &str,
        data: &serde_json::Value,
        work: impl FnOnce(&Users) -> Result<(), UserError>,
    ) -> Result<(), Refusal> {
        self.must(who, kind, data)?;
        work(&self.users).map_err(|e| {
            // Its row is there already.
            let data = json!({ "deed": kind, "user": who.name, "why": e.to_string() });
            self.audit.event("warning", "not-done", None, &data);
            refusal(e)
        })?;
        self.read().map_err(refusal)
    }

    fn must(&self, who: &Who, kind: &str, data: &serde_json::Value) -> Result<(), Refusal> {
        self.audit
            .must(who, kind, data)
            .map_err(|why| Refusal::new(StatusCode::INSUFFICIENT_STORAGE, Said::foreign(why)))
    }

    /// The users.
    pub(super) fn users(&self) -> &Users {
        &self.users
    }
}

/// A code of 80 bits to be typed: letters and digits that are not mistaken for others.
fn code() -> Result<String, UserError> {
    const SIGNS: &[u8; 32] = b"abcdefghjkmnpqrstuvwxyz023456789";
    let secret = g7_store::users::secret()?;
    let signs = secret.as_bytes().chunks(2).take(16).filter_map(|pair| {
        let byte = u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()?;
        SIGNS.get(usize::from(byte % 32)).map(|sign| char::from(*sign))
    });
    let mut text = String::new();
    for (k, sign) in signs.enumerate() {
        if k > 0 && k % 4 == 0 {
            text.push('-');
        }
        text.push(sign);
    }
    Ok(text)
}
