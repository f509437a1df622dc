//! `g7 serve`: the editor in the browser, its files, and runs that pages share.
//!
//! # Where this sits
//!
//! ```text
//! browser -> listen -> guard -> assets                          the page
//!             (tls)     |    -> entry -> access                  login, users, the log
//!                    access  -> api  -> folder, drafts, watch   files
//!                            -> wiring -> folder, online        io files; devices are asked
//!                            -> history -> store                the history of a controller
//!                            -> live -> runs -> desk -> Page    shared runs
//!                                <- outbox <-+
//!                                    -> together                people who edit one file at once
//!                                    -> operator::Stage         a running controller (`--online`)
//! ```
//!
//! # Invariants
//!
//! Nothing is answered without the right host and origin; nothing except the page itself is
//! answered without a token (`tokens`), or a session of a user whose role allows it (`guard`).
//! Whoever is reached from other machines has TLS and users, or does not start (`rules`).
//! Only the given folder is read or written; links that lead out of it are refused (`folder`).
//! Whatever clients do, runs go on and memory stays bounded (`outbox`, `desk`).

mod access;
mod api;
mod args;
mod aside;
mod assets;
mod bodies;
mod browser;
mod desk;
mod drafts;
mod encoding;
mod entry;
mod file_names;
mod fingerprint;
mod folder;
mod guard;
mod history;
mod line;
pub(crate) mod listen;
mod live;
pub(crate) mod outbox;
mod places;
mod refusal;
mod registry;
mod rules;
mod runs;
mod shared;
mod shelf;
mod state;
mod system;
#[cfg(test)]
mod tests;
mod throttle;
mod tls;
mod together;
mod tokens;
mod watch;
mod wiring;

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::Path;
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use axum::Router;
use axum::routing::get;
use g7_model::say;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;

use crate::attendant::Attendant;
use crate::failure::{Failure, Verdict, raw};
use crate::message::tell;
use crate::operator::{Order, Stage};
use crate::project::Project;
use crate::station::{self, More, Settings, Station};
use crate::{audit, files, sources};
pub(crate) use args::Serve;
use drafts::Drafts;
use folder::Folder;
use guard::{Guard, Pass};
use places::Places;
use rules::Rules;
use runs::Runs;
use shared::{Clients, Inner, Limits, Shared};
use together::Together;
use tokens::{Shelf, Tokens};
use watch::Watch;

/// The port that is tried first if none is given.
const PORT: u16 = 4700;
/// Time between two searches of the folder for changes.
const LOOK: Duration = Duration::from_millis(500);
/// Time between two looks at the file of the users: a session that was revoked is over within a second.
const LOOK_USERS: Duration = Duration::from_millis(300);

/// The shared data for a folder and for the place of unsaved copies.
fn shared(
    args: &Serve,
    limits: Limits,
    state: Option<&Path>,
    station: Option<SyncSender<Order>>,
    rules: &Rules,
) -> Result<Shared, Failure> {
    let unreadable = |e| Failure::Read(args.path.clone(), e);
    let is_file = std::fs::metadata(&args.path).map_err(unreadable)?.is_file();
    let (root, first) = match (is_file, args.path.parent(), args.path.file_name()) {
        (true, Some(parent), Some(name)) => {
            let parent = if parent.as_os_str().is_empty() { Path::new(".") } else { parent };
            let name = name.to_string_lossy().into_owned();
            file_names::path(&name).map_err(|why| Failure::Usage(raw(why)))?;
            if file_names::is_io(&name) {
                return Err(Failure::Usage(say!(
                    "{name} belongs to a chart: serve that one",
                    name = raw(&name)
                )));
            }
            (parent.to_path_buf(), Some(name))
        }
        _ => (args.path.clone(), None),
    };
    let folder = Arc::new(Folder::new(&root, args.read_only).map_err(unreadable)?);
    let project = Project::of(folder.root()).map_err(Failure::Usage)?.unwrap_or_default();
    let main = project.main(folder.root()).map_err(Failure::Usage)?;
    let chart = folder.root().join("chart.g7").is_file().then(|| "chart.g7".to_owned());
    let start = args.start.clone().or(first).or(main).or(chart);
    if let Some(start) = &start {
        folder.read(start).map_err(|r| Failure::Usage(raw(r.text)))?;
    }
    let page = args.page_dir.as_ref().map(|p| p.canonicalize().map_err(|e| Failure::Read(p.clone(), e)));
    Ok(Arc::new(Inner {
        title: project.name.unwrap_or_else(|| root.display().to_string()),
        start,
        page: page.transpose()?,
        place: state::name_of(folder.root()),
        drafts: Drafts::of(folder.root(), state),
        watch: Watch::new(Arc::clone(&folder)),
        folder,
        runs: Arc::new(Runs::new(limits.runs)),
        clients: Clients::default(),
        together: Together::default(),
        guests: OnceLock::new(),
        seats: Places::new(limits.clients, limits.from_one),
        limits,
        station,
        access: rules.access.clone(),
        audit: rules.audit.clone(),
        log: rules.log.clone(),
        history: OnceLock::new(),
        asker: wiring::Asker::new(rules.host.is_loopback()),
    }))
}

/// All addresses, behind the guard.
fn app(shared: Shared, guard: Guard) -> Router {
    let again = match &guard.pass {
        Pass::Tokens(tokens) => {
            let all = [Some(tokens), guard.guests.as_ref()].into_iter().flatten().cloned();
            tokens::routes(all.collect(), guard.bound)
        }
        Pass::Users(_) => Router::new(),
    };
    Router::new()
        .merge(api::routes())
        .merge(drafts::routes::routes())
        .merge(entry::routes())
        .merge(history::routes())
        .merge(wiring::routes())
        .route("/api/live", get(live::live))
        .fallback(get(assets::asset))
        .with_state(shared)
        .merge(again)
        .layer(axum::middleware::from_fn_with_state(guard, guard::guard))
        .layer(axum::middleware::from_fn(refusal::translate))
}

/// Notifies every client of changes in the folder and of unsaved work.
async fn tell_changes(shared: Shared) {
    let mut tick = tokio::time::interval(LOOK);
    tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    loop {
        tick.tick().await;
        if shared.clients.is_empty() {
            continue;
        }
        let of = Arc::clone(&shared);
        let changes = tokio::task::spawn_blocking(move || of.watch.changes()).await.unwrap_or_default();
        let drafts = shared.drafts.have_changed();
        // The clients are listed after the search, since `changes` returns each change only once:
        // a client that connected during the search would otherwise never hear of it.
        let clients = shared.clients.all();
        for change in changes {
            let text = runs::letter(&serde_json::json!({ "changed": change }));
            clients.iter().for_each(|c| c.put(text.clone()));
        }
        if drafts {
            let text = runs::letter(&serde_json::json!({ "drafts": true }));
            clients.iter().for_each(|c| c.put(text.clone()));
        }
    }
}

/// Binds the given port; otherwise the one where pages of this folder wait, the default port, or any free one.
async fn bind(host: IpAddr, port: Option<u16>, waiting: Option<u16>) -> Result<TcpListener, Failure> {
    let at = |port| TcpListener::bind(SocketAddr::new(host, port));
    let mut bound = at(port.or(waiting).unwrap_or(PORT)).await;
    for next in [PORT, 0] {
        if port.is_none() && bound.is_err() {
            bound = at(next).await;
        }
    }
    bound.map_err(|e| {
        let port = port.unwrap_or(PORT);
        Failure::Usage(say!(
            "cannot listen at {host} port {port}: {}",
            crate::failure::plain(&e),
            host = raw(host),
            port = raw(port)
        ))
    })
}

/// Looks for changes of the users and of the certificate, and notes which tokens were used.
async fn look_after(rules: Rules, tokens: Vec<Arc<Tokens>>) {
    let mut tick = tokio::time::interval(LOOK_USERS);
    tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    loop {
        tick.tick().await;
        let (rules, tokens) = (rules.clone(), tokens.clone());
        let look = move || {
            rules.look();
            tokens.iter().for_each(|tokens| tokens.look());
        };
        tokio::task::spawn_blocking(look).await.ok();
    }
}

/// A server at work, until it is dropped.
struct Open {
    runtime: Option<Runtime>,
    bound: SocketAddr,
    /// The tokens that let in, where there are no users.
    tokens: Option<Arc<Tokens>>,
    /// The tokens of guests, where there may be some.
    guests: Option<Arc<Tokens>>,
}

impl Open {
    /// Listens, and answers from here on.
    fn new(shared: &Shared, rules: &Rules, args: &Serve) -> Result<Open, Failure> {
        let forget = args.forget;
        system::room_for(shared.limits.clients);
        let mut threads = tokio::runtime::Builder::new_multi_thread();
        if shared.station.is_some() {
            threads.on_thread_start(system::step_back);
        }
        let runtime = threads.enable_all().worker_threads(2).build();
        let runtime =
            runtime.map_err(|e| Failure::Usage(say!("the server cannot start: {e}", e = raw(&e))))?;
        // Whoever operates a machine begins anew with it: a controller knows the token of its own start alone.
        let state = if shared.station.is_some() { None } else { state::folder() };
        let root = shared.folder.root();
        let of_guests = state.as_ref().map(|state| Shelf::of_guests(root, state));
        let shelf = state.filter(|_| rules.access.is_none()).map(|state| Shelf::of(root, &state));
        let waiting = shelf.as_ref().filter(|_| !forget).and_then(|shelf| shelf.port(rules.host));
        let listener = runtime.block_on(bind(rules.host, rules.port, waiting))?;
        let bound = listener.local_addr()?;
        let kept = |shelf: Option<Shelf>| -> Result<Arc<Tokens>, Failure> {
            Ok(Arc::new(shelf.map_or_else(Tokens::fresh, |shelf| Tokens::kept(shelf, bound, forget))?))
        };
        let guests = args.guests.then(|| kept(of_guests)).transpose()?;
        if let Some(guests) = &guests {
            // It is set once.
            shared.guests.set(guests.own().to_owned()).ok();
        }
        let (pass, tokens) = match (&rules.access, shelf) {
            (Some(access), _) => (Pass::Users(Arc::clone(access)), None),
            (None, shelf) => {
                let tokens = kept(shelf)?;
                (Pass::Tokens(Arc::clone(&tokens)), Some(tokens))
            }
        };
        let app = app(Arc::clone(shared), rules.guard(pass, guests.clone(), bound));
        runtime.spawn(tell_changes(Arc::clone(shared)));
        runtime.spawn(together::talk::tell_moves(Arc::clone(shared)));
        let all = tokens.iter().chain(&guests).cloned().collect();
        runtime.spawn(look_after(rules.clone(), all));
        runtime.spawn(listen::listen(listener, app, rules.door()?));
        Ok(Open { runtime: Some(runtime), bound, tokens, guests })
    }

    /// Tells the user where the page is.
    fn tell(&self, args: &Serve, shared: &Shared, rules: &Rules) -> Result<(), Failure> {
        let page = if shared.station.is_some() { "operator" } else { "" };
        let scheme = if rules.certificate.is_some() { "https" } else { "http" };
        let bare = format!("{scheme}://{}/{page}", shown(self.bound));
        let with = |tokens: &Arc<Tokens>| format!("{bare}?token={}", tokens.own());
        let address = self.tokens.as_ref().map_or_else(|| bare.clone(), with);
        let title = raw(&shared.title);
        tell(if args.read_only { say!("G7 serves {title}, read-only") } else { say!("G7 serves {title}") });
        if self.bound.ip().is_unspecified() {
            tell(say!("others put the name or the address of this machine in place of 127.0.0.1"));
        }
        if let Some(code) = rules.access.as_ref().and_then(|access| access.code()) {
            tell(say!("there is no admin yet: whoever gives this code in the page becomes the first one"));
            tell(say!("code: {}", raw(code)));
        }
        print(&address)?;
        if let Some(guests) = &self.guests {
            tell(say!("for guests, who look and change nothing:"));
            print(&with(guests))?;
        }
        tell(say!("Ctrl-C ends it"));
        if !args.no_open {
            browser::open(&address);
        }
        Ok(())
    }
}

impl Drop for Open {
    /// Nothing is left incomplete, because files are written completely or not at all.
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

/// Executes the command until Ctrl-C.
pub(crate) fn serve(args: &Serve) -> Result<Verdict, Failure> {
    if args.drive.online {
        return online(args);
    }
    let log = args.log.as_deref().map(|path| audit::open(path, None, None)).transpose()?;
    let (_log, audit) = log.map_or_else(Default::default, |(log, audit)| (Some(log), audit));
    let rules = Rules::of(args, None, &audit, args.log.clone())?;
    let limits = rules.limits(Limits::default());
    let shared = shared(args, limits, state::folder().as_deref(), None, &rules)?;
    let open = Open::new(&shared, &rules, args)?;
    open.tell(args, &shared, &rules)?;
    if let Some(runtime) = &open.runtime {
        runtime.block_on(tokio::signal::ctrl_c())?;
    }
    Ok(Verdict::Fine)
}

/// Serves the page of a controller, which this starts and ends.
fn online(args: &Serve) -> Result<Verdict, Failure> {
    let path = files::one(&args.path)?;
    let source = sources::load(&path, 0)?;
    let Settings { setup, io, log, audit, log_file, users } =
        station::settings(&path, &args.drive, args.log.as_deref())?;
    let rules = Rules::of(args, Some((&setup.server, &io)), &audit, log_file)?;
    let (station, orders) = Stage::door();
    let limits = rules.limits(Limits::beside_a_machine());
    let shared = shared(args, limits, state::folder().as_deref(), Some(station), &rules)?;
    // A port that is taken is found before anything moves.
    let open = Open::new(&shared, &rules, args)?;
    let users = args.users.clone().or(users);
    let (plant, users, logged) = (args.plant.as_deref(), users.as_deref(), audit.is_kept());
    let more = More { plant, users, logged, ..More::default() };
    let station = station::start(&path, source, &args.drive, more)?;
    let Some(station) = station else { return Ok(Verdict::Found) };
    let Station { names, origin, running, sight, monitor, post, panels, historian, claims: _claims } =
        station;
    if let Some(historian) = &historian {
        // It is set once.
        shared.history.set(historian.path.clone()).ok();
    }
    open.tell(args, &shared, &rules)?;
    let stage = Stage::new(names.clone(), sight, orders);
    let attendant = Attendant::new(names).with(monitor, post).logging(log, audit).recording(historian);
    attendant.on(stage).at(panels).changing(origin).attend(running, None)
}

/// The address that the user opens.
fn shown(bound: SocketAddr) -> SocketAddr {
    match bound.ip() {
        // An unspecified address cannot be opened; use that of this machine.
        IpAddr::V4(ip) if ip.is_unspecified() => SocketAddr::new(Ipv4Addr::LOCALHOST.into(), bound.port()),
        IpAddr::V6(ip) if ip.is_unspecified() => SocketAddr::new(Ipv4Addr::LOCALHOST.into(), bound.port()),
        IpAddr::V4(_) | IpAddr::V6(_) => bound,
    }
}

fn print(address: &str) -> Result<(), Failure> {
    use std::io::Write as _;
    let mut out = anstream::stdout();
    writeln!(out, "{address}")?;
    Ok(out.flush()?)
}
