//! Clients of OPC UA, which G7 is the server of.
//!
//! Inputs are what clients write, outputs what they read. A value that a client has written counts as long as
//! its session is there: a client that comes back has to say again what it wants, as with every server.

use std::collections::{BTreeMap, BTreeSet};
use std::net::SocketAddr;
use std::sync::Arc;

use g7_host::{Clock as _, WallClock};
use g7_model::Nanos;
use g7_online::setup::{OpcUaServer, Security};
use g7_online::{Absent, Device, Failed, OutAt, Raw, Remark, Wire, Wired, Worth};
use g7_store::users::Users;
use opcua::crypto::SecurityPolicy;
use opcua::server::address_space::AddressSpace;
use opcua::server::authenticator::AuthManager;
use opcua::server::node_manager::ServerContext;
use opcua::server::node_manager::memory::{InMemoryNodeManager, InMemoryNodeManagerBuilder};
use opcua::server::{ServerBuilder, ServerEndpoint, ServerHandle};
use opcua::types::{DataValue, MessageSecurityMode, NodeId, StatusCode, Variant};
use tokio::net::TcpListener;
use tokio::runtime::{Builder, Runtime};

use crate::certificates::{self, Folder};
use crate::guard::{Guard, Notes, password_policy};
use crate::nodes::{Nodes, Shared, nothing, plan, shown};
use crate::time::duration;
use crate::values;

/// The time between two looks at the folder of the certificates.
const LOOK: Nanos = Nanos::SECOND;
/// The time between two looks at the file of the users.
const LOOK_FOR_USERS: Nanos = Nanos::from_millis(300);
/// The longest message, and the most sessions.
const LONGEST: usize = 4 << 20;
const SESSIONS: usize = 50;
/// The most subscriptions of a session.
const SUBSCRIPTIONS: usize = 200;
/// The least time between two messages of a subscription, in milliseconds.
const FASTEST: f64 = 50.0;

/// A server as a device.
pub(crate) struct Server {
    row: OpcUaServer,
    name: String,
    wired: Wired,
    shared: Shared,
    guard: Arc<Guard>,
    notes: Notes,
    folder: Folder,
    at_work: Option<AtWork>,
    /// By name: the last value, and its status.
    values: BTreeMap<String, (Variant, StatusCode)>,
    /// Inputs whose client is there.
    written: Vec<bool>,
    clock: WallClock,
    looked: Nanos,
    looked_for_users: Nanos,
}

/// A server that listens.
struct AtWork {
    runtime: Runtime,
    handle: ServerHandle,
    nodes: Arc<InMemoryNodeManager<Nodes>>,
    task: tokio::task::JoinHandle<Result<(), String>>,
}

impl Server {
    /// A server that does not listen yet.
    pub(crate) fn new(row: &OpcUaServer, wired: &Wired, users: Option<Arc<Users>>) -> Server {
        let notes = Notes::default();
        Server {
            row: row.clone(),
            name: wired.device.name.value.clone(),
            wired: wired.clone(),
            shared: Shared::of(wired),
            guard: Arc::new(Guard::new(users, row.anonymous, notes.clone())),
            notes,
            folder: Folder::new(&row.certificates),
            at_work: None,
            values: BTreeMap::new(),
            written: vec![false; wired.inputs.len()],
            clock: WallClock::default(),
            looked: Nanos::ZERO,
            looked_for_users: Nanos::ZERO,
        }
    }

    fn begin(&mut self) -> Result<AtWork, Failed> {
        let address = self.row.address;
        let failed = |e: &dyn std::fmt::Display| Failed(format!("cannot listen at {address}: {e}"));
        let runtime = Builder::new_multi_thread()
            .worker_threads(1)
            .thread_name("opc ua server")
            .enable_all()
            .build()
            .map_err(|e| failed(&e))?;
        let listener = runtime.block_on(TcpListener::bind(address)).map_err(|e| failed(&e))?;
        let uri = format!("urn:{}:g7:{}", certificates::host(), self.name);
        let host = host(address);
        self.folder.prepare(&format!("G7 {}", self.name), &uri, &host)?;
        self.folder.expired().into_iter().for_each(|note| self.notes.say(note));
        let builder = self.builder(&uri, &host);
        // The library starts tasks while it builds.
        let entered = runtime.enter();
        let (server, handle) = builder.build().map_err(|e| failed(&e))?;
        let nodes = handle.node_managers().get_of_type::<InMemoryNodeManager<Nodes>>();
        let nodes = nodes.ok_or_else(|| failed(&"its nodes are missing"))?;
        drop(entered);
        let task = runtime.spawn(server.run_with(listener));
        Ok(AtWork { runtime, handle, nodes, task })
    }

    fn builder(&self, uri: &str, host: &str) -> ServerBuilder {
        let row = &self.row;
        let (shared, plan) = (self.shared.clone(), plan(&self.wired));
        let nodes = move |context: ServerContext, space: &mut AddressSpace| {
            Nodes::build(&plan, shared, &context, space)
        };
        let mut builder = ServerBuilder::new()
            .application_name(format!("G7 {}", self.name))
            .application_uri(uri)
            .product_uri("urn:g7")
            .host(host)
            .port(row.address.port())
            .discovery_urls(vec![format!("opc.tcp://{host}:{}/", row.address.port())])
            .pki_dir(self.folder.path())
            .certificate_path(certificates::OWN)
            .private_key_path(certificates::KEY)
            .create_sample_keypair(false)
            .trust_client_certs(false)
            .check_cert_time(true)
            .with_authenticator(Arc::clone(&self.guard) as Arc<dyn AuthManager>)
            .with_node_manager(InMemoryNodeManagerBuilder::new(nodes))
            .max_sessions(SESSIONS)
            .max_session_timeout_ms(duration(row.silence).as_millis() as u64)
            .max_message_size(LONGEST)
            .subscription_poll_interval_ms(FASTEST as u64);
        let limits = builder.limits_mut();
        limits.subscriptions.max_subscriptions_per_session = SUBSCRIPTIONS;
        limits.subscriptions.max_pending_publish_requests = SUBSCRIPTIONS;
        limits.subscriptions.min_publishing_interval_ms = FASTEST;
        limits.subscriptions.min_sampling_interval_ms = FASTEST;
        for (id, endpoint) in endpoints(row.security) {
            builder = builder.add_endpoint(id, endpoint);
        }
        builder
    }

    /// Looks at the certificates from time to time.
    fn look(&mut self) {
        let now = self.clock.now();
        if now - self.looked < LOOK {
            return;
        }
        self.looked = now;
        // A file that cannot be adopted is told when somebody is refused for it.
        self.folder.adopt().ok();
        self.folder.rejected().into_iter().for_each(|note| self.notes.say(note));
    }

    /// Looks for changes of the users from time to time. A session of a user who was changed must end, and the
    /// library ends no single one: so all end, and the others log in again.
    fn look_for_users(&mut self) -> Result<(), Failed> {
        let now = self.clock.now();
        if now - self.looked_for_users < LOOK_FOR_USERS {
            return Ok(());
        }
        self.looked_for_users = now;
        self.guard.look();
        if !self.shared.lock().has_stranger(|user| self.guard.knows(user)) {
            return Ok(());
        }
        self.stop();
        self.shared.lock().clear();
        Err(Failed("a user who was there is changed: all clients log in again".to_owned()))
    }

    /// Takes the values that have changed, and tells the names of their nodes.
    fn take(&mut self, outputs: &[Raw], write: &[bool]) -> BTreeSet<String> {
        let mut changed = BTreeSet::new();
        let all = self.wired.outputs.iter().zip(outputs).zip(write);
        for ((out, raw), _) in all.filter(|(_, write)| **write) {
            let OutAt { wire, out, .. } = out;
            match wire {
                Wire::Worth(name) => {
                    let Raw::Whole(word) = raw else { continue };
                    self.values.entry(name.clone()).or_insert((Variant::Empty, StatusCode::Good)).1 =
                        status(Worth::of(*word));
                    changed.insert(name.clone());
                }
                wire => {
                    let Some(shown) = shown(wire) else { continue };
                    let (_, of) = values::own(&out.scaling);
                    // The type is that of the values, so there is one.
                    let Ok(value) = values::variant(*raw, of, out.scaling.kind) else { continue };
                    self.values.entry(shown.name.clone()).or_insert((Variant::Empty, StatusCode::Good)).0 =
                        value;
                    changed.insert(shown.name.clone());
                }
            }
        }
        changed
    }
}

/// The status of a value, by what it is worth (OPC 10000-8, 6.3.2).
fn status(worth: Worth) -> StatusCode {
    match worth {
        Worth::Unread => StatusCode::BadWaitingForInitialData,
        Worth::Good => StatusCode::Good,
        Worth::Last => StatusCode::UncertainLastUsableValue,
        Worth::Substitute => StatusCode::UncertainSubstituteValue,
        Worth::None => StatusCode::BadNoCommunication,
    }
}

/// The name by which clients reach an address.
fn host(address: SocketAddr) -> String {
    match address {
        _ if address.ip().is_unspecified() => certificates::host(),
        SocketAddr::V4(v4) => v4.ip().to_string(),
        SocketAddr::V6(v6) => format!("[{}]", v6.ip()),
    }
}

/// The endpoints that are offered: the least security, and whatever is more.
fn endpoints(least: Security) -> Vec<(String, ServerEndpoint)> {
    let modes = [
        (Security::Sign, MessageSecurityMode::Sign),
        (Security::SignAndEncrypt, MessageSecurityMode::SignAndEncrypt),
    ];
    let policies = [
        SecurityPolicy::Basic256Sha256,
        SecurityPolicy::Aes128Sha256RsaOaep,
        SecurityPolicy::Aes256Sha256RsaPss,
    ];
    let mut offered = Vec::new();
    if least == Security::None {
        let mut none = ServerEndpoint::new_none("/", &[]);
        none.password_security_policy = Some(password_policy());
        offered.push(("none".to_owned(), none));
    }
    for (_, mode) in modes.iter().filter(|(security, _)| *security >= least) {
        for policy in policies {
            offered.push((format!("{policy} {mode}"), ServerEndpoint::new("/", policy, *mode, &[])));
        }
    }
    offered
}

impl Device for Server {
    fn connect(&mut self) -> Result<(), Failed> {
        if self.at_work.as_ref().is_some_and(|at_work| at_work.task.is_finished()) {
            self.stop();
        }
        if self.at_work.is_none() {
            self.at_work = Some(self.begin()?);
        }
        Ok(())
    }

    /// Fails while there is no client, but hands the outputs over all the same: the next one is to read
    /// present values.
    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        _: &mut [Option<String>],
    ) -> Result<(), Failed> {
        self.look();
        let changed = self.take(outputs, write);
        self.look_for_users()?;
        let Some(at_work) = &self.at_work else { return Err(Failed("it does not listen".to_owned())) };
        if at_work.task.is_finished() {
            return Err(Failed("the server has ended".to_owned()));
        }
        let index = at_work.nodes.inner().index();
        let mut now: Vec<(NodeId, DataValue)> = changed
            .iter()
            .filter_map(|name| {
                let (value, status) = self.values.get(name)?;
                let value = DataValue::new_now_status(value.clone(), *status);
                Some((NodeId::new(index, name.as_str()), value))
            })
            .collect();
        let mut desk = self.shared.lock();
        let clients = desk.clients();
        for (k, input) in inputs.iter_mut().enumerate() {
            let value = desk.value(k);
            let was = self.written.get_mut(k);
            if let Some(was) = was.filter(|was| **was != value.is_some()) {
                *was = value.is_some();
                if let (None, Some(input)) = (value, desk.inputs.get(k)) {
                    now.push((NodeId::new(index, input.name.as_str()), nothing()));
                }
            }
            *input = value.ok_or_else(|| Absent::Refused("no client has written it".to_owned()));
        }
        drop(desk);
        let values = now.iter().map(|(id, value)| (id, None, value.clone()));
        at_work
            .nodes
            .set_values(at_work.handle.subscriptions(), values)
            .map_err(|status| Failed(format!("a node cannot be set: {status}")))?;
        if clients > 0 { Ok(()) } else { Err(Failed(format!("no client at {}", self.row.address))) }
    }

    fn remarks(&mut self) -> Vec<Remark> {
        let notes = self.notes.take().into_iter().map(Remark::Note);
        notes.chain(self.shared.lock().deeds()).collect()
    }

    /// Does nothing: clients come and go, and the server goes on to listen for them until it is dropped.
    fn close(&mut self) {}
}

impl Server {
    fn stop(&mut self) {
        if let Some(AtWork { runtime, handle, task, .. }) = self.at_work.take() {
            handle.cancel();
            // Clients are told, as long as that takes no longer than this.
            runtime.block_on(async { tokio::time::timeout(END, task).await.ok() });
            runtime.shutdown_background();
        }
    }
}

/// The time in which clients are told of the end.
const END: std::time::Duration = std::time::Duration::from_millis(500);

impl Drop for Server {
    fn drop(&mut self) {
        self.stop();
    }
}
