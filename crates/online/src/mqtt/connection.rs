//! One connection to a broker, from CONNECT to DISCONNECT.
//!
//! The library works on a thread of its own. The driver gives it messages and never waits for it but
//! while it connects and while it ends, each for the time-out at most. A connection that is lost stays
//! lost: the link of the driver says when the next one is tried, so nothing turns in a circle here.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use g7_host::{Clock as _, WallClock};
use g7_model::Nanos;
use rumqttc::mqttbytes::Error as PacketError;
use rumqttc::{
    AsyncClient, ConnectReturnCode, ConnectionError, Event, EventLoop, LastWill, MqttOptions, NetworkOptions,
    Packet, PubAckReason, PublishNotice, PublishNoticeError, PublishOptions, QoS, StateError,
    SubscribeFilter, SubscribeReasonCode, TlsConfiguration, TlsError, Transport,
};
use tokio::runtime::{Builder, Runtime};

use crate::device::Failed;
use crate::setup::Broker;
use crate::tls;

/// The longest packet that the broker may send.
const LONGEST: u32 = 256 << 10;
/// Messages that wait for the broker; the others wait with the one who publishes them.
const MOST: usize = 64;

/// The subject of a message, for its answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum About {
    /// An output, by number.
    Output(usize),
    /// An event, by number.
    Event(i64),
    /// Something of this client itself.
    Own,
}

/// A message to be published.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Message {
    pub(super) topic: String,
    pub(super) payload: Vec<u8>,
    /// Quality of service 1 in place of 0.
    pub(super) acknowledged: bool,
    pub(super) retain: bool,
}

/// Takes a message of the broker: its topic and its payload.
pub(super) type Taker = Box<dyn FnMut(&str, &[u8]) + Send>;

/// How a connection is made.
pub(super) struct Opening<'a> {
    pub(super) broker: &'a Broker,
    pub(super) client_id: &'a str,
    pub(super) will: Option<Message>,
    /// Topics that are subscribed to, and true for quality of service 1.
    pub(super) topics: Vec<(String, bool)>,
    pub(super) timeout: Duration,
}

/// The state that the thread of the library and the driver share.
#[derive(Debug, Default)]
struct State {
    connected: bool,
    /// Why the connection is no more.
    ended: Option<String>,
    /// Messages that the broker has not taken yet.
    waiting: usize,
    /// The instant at which the broker took one last, or at which the first one began to wait.
    taken: Nanos,
    /// The answers to messages: what each was about, and why it was refused, if it was.
    answers: Vec<(About, Option<String>)>,
    clock: WallClock,
}

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // Each field is set whole, so the state is whole after a panic too.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.lock());
        self.changed.notify_all();
    }

    /// Waits until the state is as wanted; false after the time.
    fn wait(&self, time: Duration, wanted: impl Fn(&State) -> bool) -> bool {
        let waited = self.changed.wait_timeout_while(self.lock(), time, |state| !wanted(state));
        wanted(&waited.unwrap_or_else(PoisonError::into_inner).0)
    }
}

/// A connection to a broker.
pub(super) struct Connection {
    runtime: Option<Runtime>,
    client: AsyncClient,
    shared: Arc<Shared>,
    timeout: Duration,
}

impl Connection {
    /// Connects and subscribes. Returns why each topic was refused, if it was.
    pub(super) fn open(
        opening: Opening<'_>,
        taker: Taker,
    ) -> Result<(Connection, Vec<Option<String>>), Failed> {
        let timeout = opening.timeout;
        let runtime = Builder::new_multi_thread()
            .worker_threads(1)
            .thread_name("mqtt")
            .enable_all()
            .build()
            .map_err(|e| Failed(e.to_string()))?;
        let (client, events) = AsyncClient::builder(options(&opening)?).capacity(MOST).build();
        let shared = Arc::<Shared>::default();
        let mut connection = Connection { runtime: Some(runtime), client, shared, timeout };
        let shared = Arc::clone(&connection.shared);
        connection.spawn(attend(events, shared, taker));
        let there = connection.shared.wait(timeout, |s| s.connected || s.ended.is_some());
        connection.failed()?;
        if !there {
            connection.drop_now();
            return Err(late(timeout));
        }
        let refused = connection.subscribe(opening.topics)?;
        Ok((connection, refused))
    }

    fn spawn(&self, work: impl Future<Output = ()> + Send + 'static) {
        if let Some(runtime) = &self.runtime {
            runtime.spawn(work);
        }
    }

    fn subscribe(&self, topics: Vec<(String, bool)>) -> Result<Vec<Option<String>>, Failed> {
        if topics.is_empty() {
            return Ok(Vec::new());
        }
        let Some(runtime) = &self.runtime else { return Err(Failed("there is no connection".to_owned())) };
        let filters: Vec<SubscribeFilter> =
            topics.into_iter().map(|(topic, sure)| SubscribeFilter::new(topic, quality(sure))).collect();
        let notice = self.client.try_subscribe_many_tracked(filters).map_err(|e| Failed(e.to_string()))?;
        let answer =
            runtime.block_on(async { tokio::time::timeout(self.timeout, notice.wait_async()).await });
        self.failed()?;
        let answer = answer.map_err(|_| late(self.timeout))?.map_err(|e| Failed(e.to_string()))?;
        let refusal = |code: &SubscribeReasonCode| match code {
            SubscribeReasonCode::Success(_) => None,
            SubscribeReasonCode::NotAuthorized => Some("the broker does not allow its topic".to_owned()),
            other => Some(format!("the broker refuses its topic: {other:?}")),
        };
        Ok(answer.return_codes.iter().map(refusal).collect())
    }

    /// The connection as far as it is there.
    pub(super) fn failed(&self) -> Result<(), Failed> {
        let mut state = self.shared.lock();
        if let Some(why) = &state.ended {
            return Err(Failed(why.clone()));
        }
        let now = state.clock.now();
        let waited = Duration::from_nanos((now - state.taken).count().max(0).unsigned_abs());
        if state.waiting > 0 && waited > self.timeout {
            return Err(late(self.timeout));
        }
        Ok(())
    }

    /// Publishes a message. False where too many wait: it is to be tried again.
    pub(super) fn publish(&self, about: About, message: &Message) -> bool {
        let mut state = self.shared.lock();
        if state.waiting >= MOST {
            return false;
        }
        let options = PublishOptions::new(quality(message.acknowledged)).retain(message.retain);
        let sent = self.client.try_publish_tracked(message.topic.as_str(), message.payload.clone(), options);
        let Ok(notice) = sent else { return false };
        if state.waiting == 0 {
            state.taken = state.clock.now();
        }
        state.waiting += 1;
        drop(state);
        self.spawn(note(notice, about, Arc::clone(&self.shared)));
        true
    }

    /// The answers since the last call: what each was about, and why it was refused, if it was.
    pub(super) fn answers(&self) -> Vec<(About, Option<String>)> {
        std::mem::take(&mut self.shared.lock().answers)
    }

    /// Waits until `done`, which is asked again at each message, or for so long.
    pub(super) fn wait(&self, time: Duration, done: impl Fn() -> bool) {
        self.shared.wait(time, |state| state.ended.is_some() || done());
    }

    /// Waits until the broker has taken all messages; false where it does not within the time-out.
    pub(super) fn flush(&self) -> bool {
        self.shared.wait(self.timeout, |s| s.waiting == 0 || s.ended.is_some())
            && self.shared.lock().ended.is_none()
    }

    /// Says DISCONNECT, so that the will is not published.
    pub(super) fn end(mut self) {
        if self.client.try_disconnect_with_timeout(self.timeout).is_ok() {
            self.shared.wait(self.timeout, |s| s.ended.is_some());
        }
        self.drop_now();
    }

    /// Ends without a word: the broker publishes the will.
    fn drop_now(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.drop_now();
    }
}

fn late(timeout: Duration) -> Failed {
    let timeout = Nanos::new(i64::try_from(timeout.as_nanos()).unwrap_or(i64::MAX));
    Failed(format!("no answer within {}", timeout.plain()))
}

fn quality(acknowledged: bool) -> QoS {
    if acknowledged { QoS::AtLeastOnce } else { QoS::AtMostOnce }
}

fn options(opening: &Opening<'_>) -> Result<MqttOptions, Failed> {
    let broker = opening.broker;
    let mut options = MqttOptions::new(opening.client_id, (broker.host.as_str(), broker.port));
    options.set_keep_alive(broker.keep_alive).set_clean_start(true).set_connect_timeout(opening.timeout);
    options.set_max_packet_size(Some(LONGEST));
    let mut network = NetworkOptions::new();
    network.set_tcp_nodelay(true);
    options.set_network_options(network);
    match (&broker.user, &broker.password) {
        (Some(user), Some(password)) => {
            options.set_credentials(user.as_str(), password.secret.bytes().to_vec());
        }
        (Some(user), None) => {
            options.set_username(user.as_str());
        }
        (None, _) => {}
    }
    if let Some(will) = &opening.will {
        let (payload, quality) = (will.payload.clone(), quality(will.acknowledged));
        options.set_last_will(LastWill::new(will.topic.as_str(), payload, quality, will.retain, None));
    }
    if let Some(tls) = &broker.tls {
        let config = tls::config(tls.files()).map_err(|(_, why)| Failed(why.to_string()))?;
        options.set_transport(Transport::Tls(TlsConfiguration::Rustls(config)));
    }
    Ok(options)
}

/// Lets the library work until the connection ends.
async fn attend(mut events: EventLoop, shared: Arc<Shared>, mut taker: Taker) {
    loop {
        match events.poll().await {
            Ok(Event::Incoming(Packet::ConnAck(_))) => shared.change(|state| state.connected = true),
            Ok(Event::Incoming(Packet::Publish(publish))) => {
                // MQTT 5.0, 1.5.4: a topic is UTF-8, or the library has ended the connection.
                if let Ok(topic) = std::str::from_utf8(&publish.topic) {
                    taker(topic, &publish.payload);
                }
                shared.changed.notify_all();
            }
            Ok(_) => {}
            Err(error) => {
                // The library would connect anew by itself; the link decides when that is.
                return shared.change(|state| state.ended = Some(plain(&error)));
            }
        }
    }
}

/// Notes that the broker has taken a message, or that it refused it.
async fn note(notice: PublishNotice, about: About, shared: Arc<Shared>) {
    let result = notice.wait_completion_async().await;
    shared.change(|state| {
        state.waiting = state.waiting.saturating_sub(1);
        state.taken = state.clock.now();
        let refused = match result {
            Ok(()) => None,
            Err(PublishNoticeError::V5PubAck(PubAckReason::NotAuthorized)) => {
                Some("the broker does not allow its topic".to_owned())
            }
            Err(PublishNoticeError::V5PubAck(reason)) => Some(format!("the broker answers {reason:?}")),
            Err(PublishNoticeError::RetainNotSupported) => {
                Some("the broker keeps no messages: say `retain = false`".to_owned())
            }
            // The connection ends, which is told on its own.
            Err(_) => return,
        };
        state.answers.push((about, refused));
    });
}

/// The reason in words, where the library has only its own.
fn plain(error: &ConnectionError) -> String {
    match error {
        ConnectionError::ConnectionRefused(code)
        | ConnectionError::MqttState(StateError::ConnFail { reason: code }) => refusal(*code),
        // In TLS 1.3 a broker refuses the certificate of a client behind the handshake.
        ConnectionError::MqttState(StateError::Deserialization(PacketError::Io(e)))
        | ConnectionError::Io(e)
        | ConnectionError::Tls(TlsError::Io(e))
        | ConnectionError::MqttState(StateError::Io(e)) => {
            tls::refusal(e, "broker").unwrap_or_else(|| e.to_string())
        }
        ConnectionError::Timeout(_) => "no answer within the time-out".to_owned(),
        ConnectionError::MqttState(StateError::ServerDisconnect { reason_code, .. }) => {
            format!("the broker ended the connection: {reason_code:?}")
        }
        ConnectionError::MqttState(StateError::ConnectionAborted) => {
            "the broker closed the connection".to_owned()
        }
        ConnectionError::MqttState(StateError::AwaitPingResp) => "the broker is silent".to_owned(),
        other => of_tls(other).unwrap_or_else(|| other.to_string()),
    }
}

/// Why TLS has ended the connection, where that is at the root of an error.
fn of_tls(error: &ConnectionError) -> Option<String> {
    let mut next = std::error::Error::source(error);
    while let Some(error) = next {
        let io = error.downcast_ref::<std::io::Error>();
        if let Some(why) = io.and_then(|io| tls::refusal(io, "broker")) {
            return Some(why);
        }
        next = error.source();
    }
    None
}

fn refusal(code: ConnectReturnCode) -> String {
    match code {
        ConnectReturnCode::BadUserNamePassword => "the broker refuses user and password".to_owned(),
        ConnectReturnCode::NotAuthorized => "the broker does not let this client in".to_owned(),
        ConnectReturnCode::RefusedProtocolVersion | ConnectReturnCode::UnsupportedProtocolVersion => {
            "the broker does not know MQTT 5".to_owned()
        }
        other => format!("the broker refuses: {other:?}"),
    }
}
