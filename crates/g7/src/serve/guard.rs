//! Access control: only pages of this server are answered, with a token or the session of a user whose role
//! allows it.
//!
//! For every request, including WebSocket upgrades: the named host is an address of this machine or a
//! name of its certificate (a foreign site could point another name at it), a named origin is that of this
//! server, and everything except the page itself requires the token or a session. Every answer carries the
//! headers that isolate the page.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::extract::{Request, State};
use axum::http::header::{self, HeaderName};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use g7_host::utc_millis;
use g7_model::say;
use g7_store::users::Role;
use serde_json::json;

use super::access::Access;
use super::listen::Peer;
use super::refusal::Refusal;
use super::throttle::Throttle;
use super::tls::Certificate;
use super::tokens::Tokens;
use crate::audit::Audit;
use crate::who::Who;

/// The cookie of a session. A browser takes a name with this beginning over TLS alone, for this host alone.
pub(super) const COOKIE: &str = "__Host-g7";

/// The pass that lets a request in.
#[derive(Clone, Debug)]
pub(super) enum Pass {
    /// Whoever has a token may do everything.
    Tokens(Arc<Tokens>),
    /// Users do what their roles allow.
    Users(Arc<Access>),
}

/// The values that a request is compared with.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    pub(super) pass: Pass,
    /// The tokens of guests, where there may be some.
    pub(super) guests: Option<Arc<Tokens>>,
    pub(super) bound: SocketAddr,
    /// Its connections are encrypted; the names of the certificate are names of this server.
    pub(super) certificate: Option<Arc<Certificate>>,
    pub(super) audit: Audit,
    pub(super) foreign: Foreign,
    /// The pages that may show this one in a frame, as the policy names them; none may if it is missing.
    pub(super) framed: Option<String>,
}

/// Requests that other sites cause: a bounded number of rows a minute from an address, the others as a count.
#[derive(Clone, Debug, Default)]
pub(super) struct Foreign(Arc<Mutex<Throttle>>);

impl Foreign {
    fn throttle(&self) -> MutexGuard<'_, Throttle> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes the counts of those that are no row.
    pub(super) fn tell(&self, audit: &Audit) {
        for (from, count) in self.throttle().refused(utc_millis()) {
            audit.event("warning", "foreign-request", None, &json!({ "from": from, "count": count }));
        }
    }
}

/// The role that a request needs; `None` where nobody is asked. What is not known needs the greatest.
fn needed(method: &Method, path: &str) -> Option<Role> {
    Some(match (method, path) {
        (_, "/api/session" | "/api/login" | "/api/first") => return None,
        // Whoever asks learns nothing without a token of its own.
        (&Method::GET, "/api/again") => return None,
        (&Method::GET, "/api/info" | "/api/files" | "/api/file" | "/api/drafts" | "/api/live") => {
            Role::Viewer
        }
        (&Method::GET, "/api/history" | "/api/history/lanes" | "/api/history/export") => Role::Viewer,
        (_, "/api/logout" | "/api/password") => Role::Viewer,
        (&Method::GET, "/api/log") => Role::Operator,
        (&Method::POST, "/api/wiring/look") => Role::Viewer,
        (&Method::GET, "/api/guests") => Role::Engineer,
        (&Method::POST, "/api/wiring/edit" | "/api/wiring/live") => Role::Engineer,
        (_, "/api/file" | "/api/new" | "/api/rename" | "/api/delete") => Role::Engineer,
        (_, "/api/draft" | "/api/draft/take" | "/api/draft/saved") => Role::Engineer,
        _ => Role::Admin,
    })
}

const POLICY: &str = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; \
    style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; object-src 'none'; \
    base-uri 'none'; form-action 'none'";
const HEADERS: [(HeaderName, &str); 5] = [
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    // The address contains the token, so it must not be sent to other sites.
    (header::REFERRER_POLICY, "no-referrer"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (HeaderName::from_static("permissions-policy"), "camera=(), microphone=(), geolocation=()"),
];

/// Passes a request on, with who asks, or refuses it.
pub(super) async fn guard(State(guard): State<Guard>, mut request: Request, next: Next) -> Response {
    let judged = guard.judge(&request);
    let mut response = match judged {
        Ok(who) => {
            if let Some(who) = who {
                request.extensions_mut().insert(who);
            }
            next.run(request).await
        }
        Err(refusal) => refusal.into_response(),
    };
    let headers = response.headers_mut();
    for (name, value) in HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if guard.framed.is_none() {
        headers.insert(header::X_FRAME_OPTIONS, HeaderValue::from_static("DENY"));
    }
    if let Ok(policy) = HeaderValue::from_str(&guard.policy()) {
        headers.insert(header::CONTENT_SECURITY_POLICY, policy);
    }
    response
}

/// The address of the other end; that of this machine in a test without a connection.
pub(super) fn peer(request: &Request) -> IpAddr {
    request.extensions().get::<Peer>().map_or(Ipv4Addr::LOCALHOST.into(), |peer| peer.0)
}

impl Guard {
    fn scheme(&self) -> &'static str {
        if self.certificate.is_some() { "https" } else { "http" }
    }

    /// A request of another site, which someone who is logged in may have been led to.
    fn foreign(&self, request: &Request, what: &str) -> Refusal {
        let from = peer(request);
        if self.foreign.throttle().allows(from, utc_millis()) {
            self.audit.event("warning", "foreign-request", None, &json!({ "from": from, "what": what }));
        }
        Refusal::forbidden(say!("this request comes from another site: it is not answered"))
    }

    /// Who asks; `None` where nobody has to be known.
    fn judge(&self, request: &Request) -> Result<Option<Who>, Refusal> {
        let headers = request.headers();
        let host =
            only(headers, &header::HOST)?.ok_or_else(|| Refusal::bad(say!("this request names no host")))?;
        if !self.is_ours(host) {
            return Err(Refusal::forbidden(say!(
                "this server answers at `{}://{}/` only, not under other names",
                self.scheme(),
                self.bound
            )));
        }
        if let Some(origin) = only(headers, &header::ORIGIN)? {
            let rest = origin.strip_prefix(self.scheme()).and_then(|o| o.strip_prefix("://"));
            if !rest.is_some_and(|o| o.eq_ignore_ascii_case(host)) {
                return Err(self.foreign(request, "origin"));
            }
        }
        let path = request.uri().path();
        if path != "/api" && !path.starts_with("/api/") {
            return Ok(None);
        }
        let site = only(headers, &HeaderName::from_static("sec-fetch-site"))?;
        if site.is_some_and(|s| s != "same-origin" && s != "none") {
            return Err(self.foreign(request, "site"));
        }
        let Some(role) = needed(request.method(), path) else {
            return self.known(request);
        };
        let Some(who) = self.known(request)? else {
            let what = match self.pass {
                Pass::Tokens(_) => {
                    say!(
                        "this needs the whole address that `g7 serve` printed when it was started, with its token"
                    )
                }
                Pass::Users(_) => say!("this needs a user: log in"),
            };
            return Err(Refusal::new(StatusCode::UNAUTHORIZED, what));
        };
        who.needs(role).map_err(Refusal::forbidden)?;
        Ok(Some(who))
    }

    /// Who sends a request, by token or session.
    fn known(&self, request: &Request) -> Result<Option<Who>, Refusal> {
        let from = peer(request);
        let known = match &self.pass {
            Pass::Tokens(tokens) => has_token(tokens, request)?.then(|| Who::with_token(from.to_string())),
            Pass::Users(access) => cookie(request.headers()).and_then(|secret| access.who(secret, from)),
        };
        Ok(match &self.guests {
            Some(guests) if known.is_none() && has_token(guests, request)? => {
                Some(Who::guest(from.to_string()))
            }
            _ => known,
        })
    }

    /// True if a host names this server: by its address, or as `localhost`.
    fn is_ours(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.contains(']') => (name, port.parse().ok()),
            _ => (host, Some(if self.certificate.is_some() { 443 } else { 80 })),
        };
        if port != Some(self.bound.port()) {
            return false;
        }
        let bound = self.bound.ip();
        if self.certificate.as_ref().is_some_and(|c| names(&c.names(), name)) {
            return true;
        }
        if name.eq_ignore_ascii_case("localhost") {
            return bound.is_loopback() || bound.is_unspecified();
        }
        let bare = name.strip_prefix('[').and_then(|n| n.strip_suffix(']'));
        let address: Option<IpAddr> = match bare {
            Some(six) => six.parse().ok().filter(IpAddr::is_ipv6),
            None => name.parse().ok().filter(IpAddr::is_ipv4),
        };
        address
            .is_some_and(|a| a == bound || bound.is_unspecified() || (a.is_loopback() && bound.is_loopback()))
    }

    /// The content security policy. Older browsers do not count a WebSocket as the same origin, so
    /// it is named.
    fn policy(&self) -> String {
        let port = self.bound.port();
        let frames = self.framed.as_deref().unwrap_or("'none'");
        let policy = format!("{POLICY}; frame-ancestors {frames}");
        if self.certificate.is_some() {
            return format!("{policy}; connect-src 'self' wss://*:{port}");
        }
        let mut live = format!("'self' ws://localhost:{port} ws://127.0.0.1:{port}");
        if !self.bound.ip().is_unspecified() && !self.bound.ip().is_loopback() {
            live.push_str(&format!(" ws://{}", self.bound));
        }
        format!("{policy}; connect-src {live}")
    }
}

/// The token comes in a header, or in the address if the browser cannot set a header.
fn has_token(tokens: &Tokens, request: &Request) -> Result<bool, Refusal> {
    let header = only(request.headers(), &header::AUTHORIZATION)?;
    let given = header.and_then(|h| h.strip_prefix("Bearer "));
    if given.is_some_and(|g| tokens.admits(g)) {
        return Ok(true);
    }
    if request.uri().path() != "/api/live" {
        return Ok(false);
    }
    let mut pairs = request.uri().query().unwrap_or("").split('&');
    Ok(pairs.any(|p| p.strip_prefix("token=").is_some_and(|g| tokens.admits(g))))
}

/// The secret of the session; `None` where there is none, or more than one.
fn cookie(headers: &HeaderMap) -> Option<&str> {
    let all = headers.get_all(header::COOKIE).iter().filter_map(|v| v.to_str().ok());
    let mut found = all
        .flat_map(|v| v.split(';'))
        .filter_map(|pair| pair.trim().split_once('='))
        .filter_map(|(name, value)| (name == COOKIE).then_some(value));
    let secret = found.next()?;
    found.next().is_none().then_some(secret)
}

/// True if one of the names of a certificate is this one; `*.` stands for one label.
fn names(all: &[String], name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    let rest = name.split_once('.').map(|(_, rest)| rest);
    all.iter().any(|n| *n == name || n.strip_prefix("*.").is_some_and(|n| rest == Some(n)))
}

/// The value of a header that may occur at most once.
fn only<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Result<Option<&'a str>, Refusal> {
    let mut all = headers.get_all(name).iter();
    let Some(first) = all.next() else { return Ok(None) };
    let text = first.to_str().ok().filter(|_| all.next().is_none());
    text.map(Some).ok_or_else(|| Refusal::forbidden(say!("the header `{name}` means nothing")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(bound: &str) -> Guard {
        let bound = bound.parse().expect("an address");
        Guard {
            pass: Pass::Tokens(Arc::new(Tokens::fresh().expect("a token"))),
            bound,
            guests: None,
            certificate: None,
            audit: Audit::default(),
            foreign: Foreign::default(),
            framed: None,
        }
    }

    #[test]
    fn the_names_of_a_certificate_are_hosts_and_one_label_stands_for_a_star() {
        let all = ["plant.example".to_owned(), "*.line.example".to_owned()];
        for name in ["plant.example", "PLANT.example", "a.line.example"] {
            assert!(names(&all, name), "{name}");
        }
        for name in ["", "example", "a.plant.example", "line.example", "a.b.line.example", "*.line.exampl"] {
            assert!(!names(&all, name), "{name}");
        }
    }

    #[test]
    fn what_is_not_known_needs_the_greatest_role() {
        for (method, path, role) in [
            (Method::GET, "/api/login", None),
            (Method::GET, "/api/file", Some(Role::Viewer)),
            (Method::PUT, "/api/file", Some(Role::Engineer)),
            (Method::GET, "/api/drafts", Some(Role::Viewer)),
            (Method::GET, "/api/draft", Some(Role::Engineer)),
            (Method::POST, "/api/draft/take", Some(Role::Engineer)),
            (Method::GET, "/api/log", Some(Role::Operator)),
            (Method::GET, "/api/guests", Some(Role::Engineer)),
            (Method::GET, "/api/history/export", Some(Role::Viewer)),
            (Method::POST, "/api/wiring/look", Some(Role::Viewer)),
            (Method::POST, "/api/wiring/live", Some(Role::Engineer)),
            (Method::POST, "/api/history", Some(Role::Admin)),
            (Method::GET, "/api/users", Some(Role::Admin)),
            (Method::GET, "/api/new/thing", Some(Role::Admin)),
        ] {
            assert_eq!(needed(&method, path), role, "{method} {path}");
        }
    }

    #[test]
    fn two_cookies_of_a_session_are_none() {
        let of = |all: &[&'static str]| {
            let mut headers = HeaderMap::new();
            for value in all {
                headers.append(header::COOKIE, HeaderValue::from_static(value));
            }
            cookie(&headers).map(str::to_owned)
        };
        assert_eq!(of(&["a=1; __Host-g7=x; b=2"]).as_deref(), Some("x"));
        assert_eq!(of(&["__Host-g7=x; __Host-g7=y"]), None);
        assert_eq!(of(&["__Host-g7=x", "__Host-g7=x"]), None);
        assert_eq!(of(&["g7=x"]), None);
    }

    #[test]
    fn a_host_is_an_address_of_this_machine_and_no_other_name() {
        let local = at("127.0.0.1:4700");
        for host in ["127.0.0.1:4700", "localhost:4700", "LOCALHOST:4700", "[::1]:4700"] {
            assert!(local.is_ours(host), "{host}");
        }
        for host in [
            "127.0.0.1",
            "127.0.0.1:80",
            "evil.example:4700",
            "localhost.evil.example:4700",
            "10.0.0.1:4700",
            "",
            ":4700",
            "localhost:4700:4700",
            "[::1:4700",
            "::1:4700",
            "0x7f.1:4700",
        ] {
            assert!(!local.is_ours(host), "{host}");
        }
    }

    #[test]
    fn a_server_for_the_network_still_takes_no_names() {
        let wide = at("0.0.0.0:4700");
        assert!(wide.is_ours("192.168.1.7:4700") && wide.is_ours("localhost:4700"));
        assert!(!wide.is_ours("plant.example:4700"));
        let one = at("192.168.1.7:4700");
        assert!(one.is_ours("192.168.1.7:4700"));
        assert!(!one.is_ours("127.0.0.1:4700") && !one.is_ours("localhost:4700"));
    }
}
