//! One connection to a server, from the first byte to the last.
//!
//! The library works on a thread of its own. A connection that is lost stays lost: the link of the driver
//! says when the next one is tried, and each has its own session and subscription. So nothing of the library
//! has to find its way back, which is where changes were missing after a server had started again.

use std::future::Future;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use futures_util::future::{Either, select};
use futures_util::{StreamExt as _, pin_mut};
use g7_host::{Clock as _, WallClock};
use g7_model::Nanos;
use g7_online::Failed;
use g7_online::setup::{Namespace, NodeId, OpcUa, Policy, Security};
use opcua::client::{Client, ClientBuilder, IdentityToken, Session, SessionPollResult, SubscriptionActivity};
use opcua::crypto::{SecurityPolicy, X509};
use opcua::types::{EndpointDescription, MessageSecurityMode, NamespaceMap, StatusCode, UserTokenType};
use tokio::runtime::{Builder, Runtime};

use crate::certificates::{self, Folder};
use crate::time::duration;

/// The time between two looks while a connection is made.
const LOOK: Duration = Duration::from_millis(5);

/// How the connection is.
#[derive(Debug, Default)]
pub(crate) struct State {
    connected: bool,
    /// Why it is no more.
    ended: Option<String>,
    /// The instant of the latest sign of life of the subscription.
    heard: Nanos,
    clock: WallClock,
}

/// The state, as the library's thread and the driver share it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Life(Arc<Mutex<State>>);

impl Life {
    fn lock(&self) -> MutexGuard<'_, State> {
        // Each field is set whole, so it is whole after a panic too.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn hear(&self) {
        let mut state = self.lock();
        state.heard = state.clock.now();
    }

    fn end(&self, why: String) {
        self.lock().ended.get_or_insert(why);
    }

    /// The time since the latest sign of life.
    ///
    /// # Errors
    ///
    /// The connection is lost.
    pub(crate) fn silence(&self) -> Result<Nanos, Failed> {
        let mut state = self.lock();
        match &state.ended {
            Some(why) => Err(Failed(why.clone())),
            None => Ok(state.clock.now() - state.heard),
        }
    }

    /// Ends the connection when there was no sign of life for longer than `most`.
    ///
    /// # Errors
    ///
    /// The connection is lost, or silent.
    pub(crate) fn alive(&self, most: Option<Nanos>) -> Result<(), Failed> {
        let silence = self.silence()?;
        match most.filter(|most| silence > *most) {
            Some(most) => {
                let why = format!("no sign of life of the subscription for {}", most.plain());
                self.end(why.clone());
                Err(Failed(why))
            }
            None => Ok(()),
        }
    }
}

/// A connection with its session.
pub(crate) struct Connection {
    runtime: Option<Runtime>,
    pub(crate) session: Arc<Session>,
    pub(crate) life: Life,
    namespaces: Option<NamespaceMap>,
}

impl Connection {
    /// Connects and logs in.
    ///
    /// # Errors
    ///
    /// The server cannot be reached, is not trusted, or does not let this client in.
    pub(crate) fn open(server: &OpcUa, timeout: Duration) -> Result<Connection, Failed> {
        let mut folder = Folder::new(&server.certificates);
        let uri = format!("urn:{}:g7", certificates::host());
        folder.prepare("G7", &uri, "")?;
        let runtime = Builder::new_multi_thread()
            .worker_threads(1)
            .thread_name("opc ua")
            .enable_all()
            .build()
            .map_err(|e| Failed(e.to_string()))?;
        let life = Life::default();
        let opened =
            runtime.block_on(within(timeout, begin(server.clone(), uri, folder, timeout, life.clone())));
        match opened.and_then(|opened| opened) {
            Ok((session, namespaces)) => Ok(Connection { runtime: Some(runtime), session, life, namespaces }),
            Err(why) => {
                runtime.shutdown_background();
                Err(why)
            }
        }
    }

    /// Waits for work of the library, for so long.
    ///
    /// # Errors
    ///
    /// It takes longer, or it failed.
    pub(crate) fn wait<T: Send + 'static>(
        &self,
        timeout: Duration,
        work: impl Future<Output = Result<T, opcua::types::Error>> + Send + 'static,
    ) -> Result<T, Failed> {
        let Some(runtime) = &self.runtime else { return Err(Failed("there is no connection".to_owned())) };
        runtime.block_on(within(timeout, work))?.map_err(|e| Failed(plain(e.status())))
    }

    /// The same, as long as the connection lives and the silence of the subscription is not longer than `most`.
    ///
    /// # Errors
    ///
    /// It takes longer, it failed, or there is no sign of life.
    pub(crate) fn wait_alive<T: Send + 'static>(
        &self,
        timeout: Duration,
        most: Option<Nanos>,
        work: impl Future<Output = Result<T, opcua::types::Error>> + Send + 'static,
    ) -> Result<T, Failed> {
        let life = self.life.clone();
        let watched = async move {
            let lost = async {
                loop {
                    if let Err(why) = life.alive(most) {
                        break why;
                    }
                    tokio::time::sleep(LOOK).await;
                }
            };
            pin_mut!(lost, work);
            match select(work, lost).await {
                Either::Left((done, _)) => Ok(done),
                Either::Right((why, _)) => Err(why),
            }
        };
        self.wait(timeout, async move { Ok(watched.await) })?
            .and_then(|done| done.map_err(|e| Failed(plain(e.status()))))
    }

    /// The node as the server knows it now.
    ///
    /// # Errors
    ///
    /// The server has no such namespace.
    pub(crate) fn node(&self, node: &NodeId) -> Result<opcua::types::NodeId, String> {
        let index = match &node.namespace {
            Namespace::Index(index) => *index,
            Namespace::Uri(uri) => {
                let found = self.namespaces.as_ref().and_then(|map| map.get_index(uri));
                found.ok_or_else(|| format!("the server has no namespace `{uri}`"))?
            }
        };
        let parsed = node.identifier.parse::<opcua::types::Identifier>();
        let identifier = parsed.map_err(|_| format!("`{node}` is no node"))?;
        Ok(opcua::types::NodeId { namespace: index, identifier })
    }

    /// Says good-bye, as far as the server listens.
    pub(crate) fn close(mut self, timeout: Duration) {
        let session = Arc::clone(&self.session);
        if self.life.silence().is_ok() {
            self.wait(timeout.min(GOODBYE), async move { session.disconnect().await }).ok();
        }
        self.end();
    }

    fn end(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

/// The longest time of a good-bye.
const GOODBYE: Duration = Duration::from_millis(500);

impl Drop for Connection {
    fn drop(&mut self) {
        self.end();
    }
}

/// Does the work in a separate task: a panic in it ends that task and nothing else.
async fn within<T: Send + 'static>(
    timeout: Duration,
    work: impl Future<Output = T> + Send + 'static,
) -> Result<T, Failed> {
    let task = tokio::spawn(work);
    let end = task.abort_handle();
    match tokio::time::timeout(timeout, task).await {
        Ok(Ok(done)) => Ok(done),
        Ok(Err(_)) => Err(Failed("what the server says cannot be read".to_owned())),
        Err(_) => {
            end.abort();
            let time = Nanos::new(i64::try_from(timeout.as_nanos()).unwrap_or(i64::MAX));
            Err(Failed(format!("no answer within {}", time.plain())))
        }
    }
}

type Opened = (Arc<Session>, Option<NamespaceMap>);

async fn begin(
    server: OpcUa,
    uri: String,
    folder: Folder,
    timeout: Duration,
    life: Life,
) -> Result<Opened, Failed> {
    let client = client(&server, &uri, &folder, timeout)?;
    let endpoints = client
        .get_server_endpoints_from_url(server.url.as_str())
        .await
        .map_err(|e| Failed(unreached(&server, e.status())))?;
    let endpoint = endpoint(&server, &endpoints)?;
    if server.security != Security::None {
        let certificate = X509::from_byte_string(&endpoint.server_certificate)
            .map_err(|_| Failed("its certificate cannot be read".to_owned()))?;
        folder.check(&certificate)?;
    }
    let token = token(&server, &endpoint)?;
    let built = client
        .session_builder()
        .connect_to_endpoint_directly(endpoint)
        .map_err(|e| Failed(plain(e.status())))?
        .user_identity_token(token)
        .build(Arc::clone(client.certificate_store()));
    let (session, events) = built.map_err(|e| Failed(plain(e.status())))?;
    session.disable_reconnects();
    let watched = life.clone();
    tokio::spawn(async move {
        let events = events.enter();
        pin_mut!(events);
        while let Some(event) = events.next().await {
            match event {
                Ok(SessionPollResult::Reconnected(_)) => {
                    watched.hear();
                    watched.lock().connected = true;
                }
                Ok(SessionPollResult::Subscription(SubscriptionActivity::Publish)) => watched.hear(),
                Ok(SessionPollResult::ConnectionLost(status)) => watched.end(plain(status)),
                Ok(_) => {}
                Err(status) => watched.end(plain(status)),
            }
            if watched.lock().ended.is_some() {
                break;
            }
        }
        watched.end("the server closed the connection".to_owned());
    });
    while !life.lock().connected {
        life.silence()?;
        tokio::time::sleep(LOOK).await;
    }
    let namespaces = session.read_namespace_array().await.ok();
    Ok((session, namespaces))
}

fn client(server: &OpcUa, uri: &str, folder: &Folder, timeout: Duration) -> Result<Client, Failed> {
    let keep_alive = duration(server.keep_alive);
    ClientBuilder::new()
        .application_name("G7")
        .application_uri(uri)
        .product_uri("urn:g7")
        .session_name("G7")
        .pki_dir(folder.path())
        .certificate_path(certificates::OWN)
        .private_key_path(certificates::KEY)
        .create_sample_keypair(false)
        .trust_server_certs(false)
        .verify_server_certs(true)
        // A connection has one life.
        .session_retry_limit(0)
        .recreate_subscriptions(false)
        .request_timeout(timeout)
        .publish_timeout(timeout + keep_alive * 4)
        .keep_alive_interval(keep_alive)
        .min_publish_interval(duration(server.interval))
        .client()
        .map_err(|wrong| Failed(wrong.join(", ")))
}

fn mode(security: Security) -> MessageSecurityMode {
    match security {
        Security::None => MessageSecurityMode::None,
        Security::Sign => MessageSecurityMode::Sign,
        Security::SignAndEncrypt => MessageSecurityMode::SignAndEncrypt,
    }
}

fn policy(server: &OpcUa) -> SecurityPolicy {
    match (server.security, server.policy) {
        (Security::None, _) => SecurityPolicy::None,
        (_, Policy::Basic256Sha256) => SecurityPolicy::Basic256Sha256,
        (_, Policy::Aes128Sha256RsaOaep) => SecurityPolicy::Aes128Sha256RsaOaep,
        (_, Policy::Aes256Sha256RsaPss) => SecurityPolicy::Aes256Sha256RsaPss,
    }
}

/// The endpoint with the wanted security.
fn endpoint(server: &OpcUa, offered: &[EndpointDescription]) -> Result<EndpointDescription, Failed> {
    let (policy, mode) = (policy(server), mode(server.security));
    let found = Client::find_matching_endpoint(offered, &server.url, policy, mode)
        // Some servers name another path than the one by which they are reached.
        .or_else(|| {
            let fits = |e: &&EndpointDescription| {
                e.security_mode == mode && SecurityPolicy::from_uri(e.security_policy_uri.as_ref()) == policy
            };
            let mut found = offered.iter().find(fits).cloned()?;
            found.endpoint_url = server.url.as_str().into();
            Some(found)
        });
    found.ok_or_else(|| {
        let mut all: Vec<String> = offered
            .iter()
            .map(|e| {
                format!("{} {}", SecurityPolicy::from_uri(e.security_policy_uri.as_ref()), e.security_mode)
            })
            .collect();
        all.sort();
        all.dedup();
        Failed(format!("it does not offer {policy} {mode}; it offers {}", all.join(", ")))
    })
}

fn token(server: &OpcUa, endpoint: &EndpointDescription) -> Result<IdentityToken, Failed> {
    let Some((user, password)) = &server.user else { return Ok(IdentityToken::Anonymous) };
    let policies = endpoint.user_identity_tokens.as_deref().unwrap_or_default();
    let Some(policy) = policies.iter().find(|p| p.token_type == UserTokenType::UserName) else {
        return Err(Failed("it has no users with passwords".to_owned()));
    };
    let uri = if policy.security_policy_uri.is_empty() {
        &endpoint.security_policy_uri
    } else {
        &policy.security_policy_uri
    };
    if SecurityPolicy::from_uri(uri.as_ref()) == SecurityPolicy::None && !is_here(&server.url) {
        return Err(Failed(
            "the password would go through the network as it is: ask for `security`".to_owned(),
        ));
    }
    let password = std::str::from_utf8(password.secret.bytes())
        .map_err(|_| Failed("the password is no text in UTF-8".to_owned()))?;
    Ok(IdentityToken::new_user_name(user.as_str(), password))
}

/// True if the address is one of this machine.
fn is_here(url: &str) -> bool {
    let rest = url.strip_prefix("opc.tcp://").unwrap_or("");
    let host = rest.split('/').next().unwrap_or("");
    let host =
        host.rsplit_once(':').map_or(host, |(name, port)| if port.contains(']') { host } else { name });
    let host = host.trim_matches(['[', ']']);
    host == "localhost" || host.parse::<std::net::IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

fn unreached(server: &OpcUa, status: StatusCode) -> String {
    match status {
        StatusCode::BadCommunicationError | StatusCode::BadConnectionClosed => {
            format!("nobody answers at {}", server.url)
        }
        other => plain(other),
    }
}

/// A status in words, where the name alone says little to an engineer.
pub(crate) fn plain(status: StatusCode) -> String {
    let name = status.sub_code().name();
    let words = match status {
        StatusCode::BadIdentityTokenRejected | StatusCode::BadIdentityTokenInvalid => {
            "it refuses the user or the password"
        }
        StatusCode::BadUserAccessDenied => "it refuses the user, the password, or what the user may do",
        StatusCode::BadSecurityChecksFailed | StatusCode::BadCertificateUntrusted => {
            "it does not trust the certificate of G7: put own/cert.der among those that it trusts"
        }
        StatusCode::BadCertificateTimeInvalid => "a certificate has expired, or is not valid yet",
        StatusCode::BadCertificateHostNameInvalid => "its certificate is for another host",
        StatusCode::BadCertificateUriInvalid => "its certificate is for another application",
        StatusCode::BadConnectionClosed => "the connection was closed",
        StatusCode::BadTimeout => "no answer in time",
        StatusCode::BadTooManySessions => "it has as many sessions as it may have",
        _ => return name.to_owned(),
    };
    format!("{words} ({name})")
}
