//! Users over TLS: who is let in, for what, and for how long (rows 22, 24 and 25 of the table of faults).

use std::net::IpAddr;

use g7_peers::faults::row;
use g7_store::log::{Filter, Keep, Log, Opened, Reader};
use g7_store::users::{Role, Users};
use rcgen::{CertificateParams, KeyPair, date_time_ymd};
use tokio_rustls::TlsConnector;
use tokio_rustls::client::TlsStream;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::{CertificateDer, ServerName};
use tokio_rustls::rustls::{ClientConfig, RootCertStore};

use super::*;
use crate::audit::Audit;
use crate::serve::access::Access;
use crate::serve::listen::Door;

const PASSWORD: &str = "correct horse";

/// A certificate for this machine; its files, and what trusts it.
fn certificate(root: &std::path::Path, years: (i32, i32)) -> (tls::Files, TlsConnector) {
    let names = ["localhost", "127.0.0.1", "plant.example"].map(str::to_owned);
    let mut params = CertificateParams::new(names).expect("names");
    params.not_before = date_time_ymd(years.0, 1, 1);
    params.not_after = date_time_ymd(years.1, 1, 1);
    let key = KeyPair::generate().expect("a key");
    let cert = params.self_signed(&key).expect("a certificate");
    let files = tls::Files { cert: root.join("cert.pem"), key: root.join("key.pem") };
    fs::write(&files.cert, cert.pem()).expect("written");
    fs::write(&files.key, key.serialize_pem()).expect("written");
    let mut roots = RootCertStore::empty();
    roots.add(CertificateDer::from(cert.der().to_vec())).expect("a root");
    let config = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()))
        .with_safe_default_protocol_versions()
        .expect("versions")
        .with_root_certificates(roots)
        .with_no_client_auth();
    (files, TlsConnector::from(Arc::new(config)))
}

/// A server with users. `ana` is an admin, `eng` an engineer, `op` an operator, `vi` a viewer.
struct Site {
    server: Server,
    trusts: TlsConnector,
    access: Arc<Access>,
    rules: Rules,
    log: Option<Log>,
}

impl Site {
    async fn new() -> Site {
        Site::with(Door::default(), Limits::default()).await
    }

    async fn with(door: Door, limits: Limits) -> Site {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let root = std::env::temp_dir().join(format!("g7-users-{}-{number}", std::process::id()));
        fs::create_dir_all(root.join("charts")).expect("a folder");
        fs::write(root.join("charts/chart.g7"), CHART).expect("a chart");
        let (files, trusts) = certificate(&root, (2020, 2099));
        let users = Users::open(&root.join("users")).expect("users");
        for (name, role) in
            [("ana", Role::Admin), ("eng", Role::Engineer), ("op", Role::Operator), ("vi", Role::Viewer)]
        {
            users.add(name, role, PASSWORD, 1, false).expect("added");
        }
        let Opened { log, .. } =
            Log::open(&root.join("log"), Keep::default(), g7_host::utc_millis).expect("a log");
        let audit = Audit::of(&log);
        let args = Serve {
            users: Some(root.join("users")),
            cert: Some(files.cert),
            key: Some(files.key),
            page_dir: Some(root.join("charts")),
            ..args_of(&root.join("charts"))
        };
        let rules = Rules::of(&args, None, &audit, Some(root.join("log"))).expect("they fit");
        let access = rules.access.clone().expect("users");
        let shared =
            shared(&args, limits, Some(&root.join("state")), None, &rules).expect("a folder to serve");
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.expect("a port");
        let bound = listener.local_addr().expect("an address");
        let app = app(Arc::clone(&shared), rules.guard(Pass::Users(Arc::clone(&access)), None, bound));
        let door = Door { tls: rules.door().expect("a door").tls, ..door };
        let of = rules.clone();
        let task = tokio::spawn(async move {
            tokio::select! {
                () = listen::listen(listener, app, door) => {}
                () = look_after(of, Vec::new()) => {}
            }
        });
        let server = Server { bound, token: String::new(), guest: String::new(), root, shared, task };
        Site { server, trusts, access, rules, log: Some(log) }
    }

    async fn stream(&self) -> TlsStream<TcpStream> {
        let stream = TcpStream::connect(self.server.bound).await.expect("a connection");
        let name = ServerName::try_from("localhost").expect("a name");
        self.trusts.connect(name, stream).await.expect("TLS")
    }

    async fn raw(&self, request: &[u8]) -> Reply {
        let mut stream = self.stream().await;
        stream.write_all(request).await.ok();
        let mut bytes = Vec::new();
        tokio::time::timeout(PATIENCE, stream.read_to_end(&mut bytes)).await.expect("an answer").ok();
        reply(&bytes)
    }

    async fn ask(&self, method: &str, path: &str, cookie: &str, body: &str) -> Reply {
        self.ask_with(method, path, &[("Cookie", &format!("__Host-g7={cookie}"))], body).await
    }

    async fn ask_with(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> Reply {
        let mut request =
            format!("{method} {path} HTTP/1.1\r\nConnection: close\r\nHost: {}\r\n", self.server.bound);
        headers.iter().for_each(|(n, v)| request.push_str(&format!("{n}: {v}\r\n")));
        request.push_str(&format!("Content-Length: {}\r\n\r\n{body}", body.len()));
        self.raw(request.as_bytes()).await
    }

    /// Tries to log in; the session, or the status of the refusal.
    async fn login(&self, name: &str, password: &str) -> Result<String, u16> {
        let body = json!({ "name": name, "password": password }).to_string();
        let reply = self.ask_with("POST", "/api/login", &[], &body).await;
        if reply.status != 204 {
            return Err(reply.status);
        }
        let cookie = reply.header("set-cookie").expect("a cookie").to_owned();
        for part in ["__Host-g7=", "; Path=/", "; Secure", "; HttpOnly", "; SameSite=Strict"] {
            assert!(cookie.contains(part), "{cookie}");
        }
        assert!(!cookie.contains("Domain"), "{cookie}");
        let secret = cookie.split(['=', ';']).nth(1).expect("a value").to_owned();
        assert_eq!(secret.len(), 64, "256 bits");
        Ok(secret)
    }

    /// A session of a user, without a login: logins are bounded.
    fn session(&self, name: &str) -> String {
        self.access.opened(name, IpAddr::from([127, 0, 0, 1])).expect("a session")
    }

    async fn live(&self, cookie: &str, headers: &[(&'static str, &str)]) -> Result<TlsLive, Error> {
        use tokio_tungstenite::tungstenite::client::IntoClientRequest as _;
        let address = format!("wss://{}/api/live", self.server.bound);
        let mut request = address.into_client_request().expect("a request");
        let cookie = format!("__Host-g7={cookie}");
        for (name, value) in headers.iter().copied().chain([("cookie", cookie.as_str())]) {
            request.headers_mut().insert(name, value.parse().expect("a header"));
        }
        Ok(tokio_tungstenite::client_async(request, self.stream().await).await?.0)
    }

    /// The rows of a kind, once there are so many.
    async fn rows(&self, kind: &str, count: usize) -> Vec<String> {
        let reader = Reader::open(&self.server.root.join("log")).expect("readable");
        loop {
            let rows = reader.rows(&Filter::default(), 10_000).expect("rows");
            let found: Vec<String> =
                rows.iter().filter(|r| r.entry.kind == kind).map(|r| r.entry.data.clone()).collect();
            if found.len() >= count {
                return found;
            }
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    }
}

type TlsLive = WebSocketStream<TlsStream<TcpStream>>;

async fn said(live: &mut TlsLive, call: Value) -> Value {
    let text = json!({ "id": 1, "call": call }).to_string();
    live.send(Message::text(text)).await.expect("an open socket");
    loop {
        let message = tokio::time::timeout(PATIENCE, live.next()).await.expect("in time");
        if let Message::Text(text) = message.expect("open").expect("a message") {
            return serde_json::from_str::<Value>(&text).expect("JSON")["answer"].clone();
        }
    }
}

#[tokio::test]
async fn a_user_logs_in_and_does_what_the_role_allows() {
    let site = Site::new().await;
    assert_eq!(site.login("ana", "wrong password").await, Err(401));
    assert_eq!(site.login("nobody", PASSWORD).await, Err(401));
    let ana = site.login("ANA", PASSWORD).await.expect("let in");
    let told = site.ask("GET", "/api/session", &ana, "").await.is(200).json();
    assert_eq!(told["user"], json!({ "name": "ana", "role": "admin" }));
    assert_eq!(site.ask_with("GET", "/api/session", &[], "").await.is(200).json()["user"], Value::Null);
    let new = json!({ "path": "n.g7", "text": CHART }).to_string();
    for (user, statuses) in
        [("vi", [200, 403, 403, 403]), ("op", [200, 200, 403, 403]), ("eng", [200, 200, 204, 403])]
    {
        let session = site.session(user);
        for ((method, path, body), status) in [
            ("GET", "/api/file?path=chart.g7", ""),
            ("GET", "/api/log", ""),
            ("POST", "/api/new", new.as_str()),
            ("GET", "/api/users", ""),
        ]
        .into_iter()
        .zip(statuses)
        {
            let reply = site.ask(method, path, &session, body).await;
            assert_eq!(reply.status, status, "{user} {method} {path}: {}", reply.text());
            if status == 403 {
                assert!(reply.text().contains("needs the role"), "{}", reply.text());
                let cookie = format!("__Host-g7={session}");
                let french = site
                    .ask_with(method, path, &[("Cookie", &cookie), ("Accept-Language", "fr")], body)
                    .await;
                assert!(french.is(403).text().contains("demande le rôle"), "{user} {path}");
            }
        }
    }
    assert_eq!(
        site.ask("GET", "/api/users", &ana, "").await.is(200).json()["users"].as_array().map(Vec::len),
        Some(4)
    );
    for (method, path) in [("GET", "/api/info"), ("GET", "/api/users"), ("PUT", "/api/file?path=chart.g7")] {
        site.ask_with(method, path, &[], "").await.is(401);
    }
    assert_eq!(site.rows("file-new", 1).await, [json!({ "file": "n.g7" }).to_string()]);
    assert_eq!(site.rows("login", 4).await.len(), 4);
}

#[tokio::test]
async fn the_first_admin_is_made_with_the_code_of_the_console_once() {
    let site = Site::new().await;
    let path = site.server.root.join("none");
    let access = Arc::new(Access::open(&path, access::Lasts::of(None, None), Audit::default()).expect("new"));
    let code = access.code().expect("a code");
    assert!(code.len() >= 16, "{code}");
    let from = IpAddr::from([127, 0, 0, 1]);
    let first = |code: &str| {
        let (name, password) = ("boss".to_owned(), PASSWORD.to_owned());
        let (access, code) = (Arc::clone(&access), code.to_owned());
        async move { access.first(code, name, password, from).await }
    };
    assert_eq!(first("0000-0000-0000-0000").await.expect_err("wrong").status.as_u16(), 401);
    assert_eq!(first("").await.expect_err("wrong").status.as_u16(), 401);
    let secret = first(&code.to_uppercase()).await.expect("made");
    assert_eq!(access.who(&secret, from).expect("known").role, Role::Admin);
    assert_eq!(first(&code).await.expect_err("used").status.as_u16(), 401);
    assert!(
        Access::open(&path, access::Lasts::of(None, None), Audit::default()).expect("again").code().is_none()
    );
    // A server with an admin takes no code.
    let body = json!({ "code": code, "name": "eve", "password": PASSWORD }).to_string();
    site.ask_with("POST", "/api/first", &[], &body).await.is(401);
}

#[tokio::test]
async fn row_24_guesses_are_throttled_and_stand_in_the_log() {
    let site = Site::new().await;
    let guesses = if g7_peers::faults::many() { 10_000 } else { 60 };
    let (mut checked, mut refused) = (0, 0);
    for k in 0..guesses {
        match site.login("ana", &format!("guess number {k}")).await {
            Err(401) => checked += 1,
            Err(429) => refused += 1,
            other => panic!("{other:?}"),
        }
    }
    assert!(refused > 0 && checked >= 10, "ten a minute are checked");
    assert!(guesses > 1_000 || checked == 10 || checked == 20, "{checked}");
    // Also with the right one: whoever guesses does not learn that it is right.
    assert_eq!(site.login("ana", PASSWORD).await, Err(429));
    assert_eq!(site.rows("login-refused", checked).await.len(), checked);
    row(
        24,
        "guessed passwords",
        guesses,
        0,
        format!("{checked} checked and in the log, {refused} refused at once"),
    );
}

#[tokio::test]
async fn row_24_a_session_that_is_over_is_not_taken_again() {
    let site = Site::new().await;
    let secret = site.session("op");
    site.ask("GET", "/api/info", &secret, "").await.is(200);
    site.ask("POST", "/api/logout", &secret, "").await.is(204);
    site.ask("GET", "/api/info", &secret, "").await.is(401);
    assert!(matches!(site.live(&secret, &[]).await, Err(Error::Http(answer)) if answer.status() == 401));
    // The hash that the file has of it lets nobody in.
    let hash = g7_store::users::session_hash(&site.session("op"));
    let hash: String = hash.iter().map(|byte| format!("{byte:02x}")).collect();
    site.ask("GET", "/api/info", &hash, "").await.is(401);
    // Nor two at once.
    let twice = format!("{0}; __Host-g7={0}", site.session("op"));
    site.ask("GET", "/api/info", &twice, "").await.is(401);
    assert_eq!(site.rows("logout", 1).await.len(), 1);
    row(24, "sessions that are over, stolen hashes, two at once", 4, 0, "refused");
}

#[tokio::test]
async fn row_24_a_revoked_session_ends_its_socket_and_a_smaller_role_its_deeds() {
    let site = Site::new().await;
    let ana = site.session("ana");
    let changes = [
        json!({ "do": "role", "name": "op", "role": "viewer" }),
        json!({ "do": "role", "name": "op", "role": "operator" }),
        json!({ "do": "revoke", "name": "op" }),
        json!({ "do": "password", "name": "op", "password": "another horse" }),
        json!({ "do": "remove", "name": "op" }),
    ];
    for change in changes {
        let secret = site.session("op");
        let mut live = site.live(&secret, &[]).await.expect("let in");
        assert!(said(&mut live, json!({ "do": "runs" })).await["ok"].is_object());
        site.ask("POST", "/api/users", &ana, &change.to_string()).await.is(204);
        over(&mut live).await;
        site.ask("GET", "/api/info", &secret, "").await.is(401);
    }
    // By another program, as `g7 users` is.
    let secret = site.session("vi");
    let mut live = site.live(&secret, &[]).await.expect("let in");
    let begin = std::time::Instant::now();
    Users::open(&site.server.root.join("users")).expect("open").revoke("vi").expect("revoked");
    over(&mut live).await;
    let ms = begin.elapsed().as_millis();
    let held = format!("sockets end with a reason; {ms} ms after another program revoked the session");
    row(24, "changed, revoked and removed users", 6, 0, held);
    assert_eq!(site.rows("user-role", 2).await.len(), 2);
}

/// Waits for the end of a socket, with the code that says why.
async fn over(live: &mut TlsLive) {
    loop {
        let message = tokio::time::timeout(PATIENCE, live.next()).await.expect("an end");
        match message {
            Some(Ok(Message::Close(Some(close)))) => {
                assert_eq!(u16::from(close.code), 4401);
                return;
            }
            Some(Ok(_)) => {}
            Some(Err(_)) | None => panic!("it ends with a reason"),
        }
    }
}

#[tokio::test]
async fn row_24_foreign_sites_are_refused_with_a_session_as_well_and_stand_in_the_log() {
    let site = Site::new().await;
    let secret = site.session("ana");
    let own = format!("https://{}", site.server.bound);
    let cookie = format!("__Host-g7={secret}");
    let with =
        |origin: &str| [("Cookie".to_owned(), cookie.clone()), ("Origin".to_owned(), origin.to_owned())];
    for (origin, status) in [
        (own.as_str(), 200),
        ("https://evil.example", 403),
        ("null", 403),
        (&own.replace("https", "http"), 403),
    ] {
        let headers = with(origin);
        let headers =
            [(headers[0].0.as_str(), headers[0].1.as_str()), (headers[1].0.as_str(), headers[1].1.as_str())];
        assert_eq!(site.ask_with("GET", "/api/users", &headers, "").await.status, status, "{origin}");
        assert_eq!(site.live(&secret, &[("origin", origin)]).await.is_ok(), status == 200, "{origin}");
    }
    assert_eq!(site.rows("foreign-request", 6).await.len(), 6);
    // A name of the certificate is a host of this server, another is not.
    for (host, status) in [("plant.example", 200), ("evil.example", 403)] {
        let port = site.server.bound.port();
        let request =
            format!("GET /api/session HTTP/1.1\r\nConnection: close\r\nHost: {host}:{port}\r\n\r\n");
        assert_eq!(site.raw(request.as_bytes()).await.status, status, "{host}");
    }
    row(24, "foreign sites and names, WebSockets too", 7, 0, "refused, in the log");
}

#[tokio::test]
async fn row_25_users_and_files_are_not_changed_while_the_log_cannot_be_written() {
    let mut site = Site::new().await;
    let (ana, eng) = (site.session("ana"), site.session("eng"));
    // The thread of the log is gone, as after any failure that it does not survive.
    drop(site.log.take());
    let add = json!({ "do": "add", "name": "eve", "role": "admin", "password": PASSWORD }).to_string();
    let reply = site.ask("POST", "/api/users", &ana, &add).await.is(507);
    assert!(reply.text().contains("cannot be written into the log"), "{}", reply.text());
    assert_eq!(site.access.users().list().expect("read").len(), 4);
    let new = json!({ "path": "n.g7", "text": CHART }).to_string();
    site.ask("POST", "/api/new", &eng, &new).await.is(507);
    assert!(!site.server.path("n.g7").exists());
    site.ask("GET", "/api/file?path=chart.g7", &eng, "").await.is(200);
    row(25, "a log that cannot be written", 2, 0, "users and files are not changed");
}

#[tokio::test]
async fn row_22_slow_heads_giant_bodies_and_crowds_are_refused() {
    let door = Door { head: Duration::from_millis(400), from_one: 8, ..Door::default() };
    let limits = Limits { from_one: 4, ..Limits::default() };
    let site = Site::with(door, limits).await;
    let secret = site.session("eng");
    // A head that never ends.
    let mut slow = site.stream().await;
    slow.write_all(b"GET / HTTP/1.1\r\nHost: ").await.expect("sent");
    let mut bytes = Vec::new();
    tokio::time::timeout(PATIENCE, slow.read_to_end(&mut bytes)).await.expect("an end").ok();
    assert_eq!(reply(&bytes).status, 408);
    // A body that says it is giant, and one that is.
    let head = format!(
        "PUT /api/file?path=chart.g7 HTTP/1.1\r\nHost: {}\r\nCookie: __Host-g7={secret}\r\nIf-Match: *\r\n",
        site.server.bound
    );
    let reply = site.raw(format!("{head}Content-Length: 99999999999\r\n\r\n").as_bytes()).await;
    assert_eq!(reply.status, 413);
    // Those who wait take their places, and no more.
    let mut waiting = Vec::new();
    while waiting.len() < 7 {
        waiting.push(TcpStream::connect(site.server.bound).await.expect("a connection"));
    }
    tokio::time::sleep(Duration::from_millis(50)).await;
    drop(waiting);
    // Sockets of one address.
    let mut sockets = Vec::new();
    for _ in 0..4 {
        sockets.push(site.live(&secret, &[]).await.expect("let in"));
    }
    let fifth = site.live(&secret, &[]).await;
    assert!(matches!(fifth, Err(Error::Http(answer)) if answer.status() == 429));
    assert!(said(&mut sockets[0], json!({ "do": "runs" })).await["ok"].is_object(), "the others go on");
    assert_eq!(site.server.on_disk("chart.g7"), CHART);
}

#[tokio::test]
async fn row_22_without_tls_a_crowd_hears_429() {
    let server = Server::new().await;
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.expect("a port");
    let bound = listener.local_addr().expect("an address");
    let rules =
        Rules::of(&args_of(&server.root.join("charts")), None, &Audit::default(), None).expect("they fit");
    let app = app(Arc::clone(&server.shared), rules.guard(some_pass(), None, bound));
    // Those who hold the places are quiet, and keep them.
    let door = Door { from_one: 8, quiet: PATIENCE, ..Door::default() };
    let task = tokio::spawn(listen::listen(listener, app, door));
    let crowd = if g7_peers::faults::many() { 10_000 } else { 300 };
    let (mut held, mut refused) = (Vec::new(), 0);
    for _ in 0..crowd {
        let mut stream = TcpStream::connect(bound).await.expect("a connection");
        if held.len() < 8 {
            held.push(stream);
            continue;
        }
        let mut bytes = Vec::new();
        tokio::time::timeout(PATIENCE, stream.read_to_end(&mut bytes)).await.expect("an end").ok();
        assert_eq!(reply(&bytes).status, 429);
        refused += 1;
    }
    row(22, "connections from one address, 8 allowed", crowd, 0, format!("{refused} heard 429"));
    drop(held);
    task.abort();
}

#[tokio::test]
async fn who_asks_in_plain_text_is_told_to_encrypt() {
    let site = Site::new().await;
    let mut stream = TcpStream::connect(site.server.bound).await.expect("a connection");
    stream.write_all(b"GET / HTTP/1.1\r\nHost: x\r\n\r\n").await.expect("sent");
    let mut bytes = Vec::new();
    stream.read_to_end(&mut bytes).await.ok();
    let reply = reply(&bytes);
    assert_eq!(reply.status, 400);
    assert!(reply.text().contains("https://"), "{}", reply.text());
}

#[tokio::test]
async fn a_certificate_is_judged_before_anything_listens_and_taken_anew_when_it_is_renewed() {
    let site = Site::new().await;
    let root = &site.server.root;
    let open = |files: tls::Files| tls::Certificate::open(files).map(drop).map_err(|e| e.to_string());
    let (files, _) = certificate(root, (2020, 2021));
    assert!(open(files.clone()).expect_err("expired").contains("has expired on 2021-01-01"));
    // A server that works goes on with the one of before.
    site.rules.look();
    drop(site.stream().await);
    let (files, _) = certificate(root, (2098, 2099));
    assert!(open(files.clone()).expect_err("not yet").contains("is valid from 2098-01-01 on"));
    fs::write(&files.cert, "nothing").expect("written");
    assert!(open(files.clone()).expect_err("no certificate").contains("no certificate"));
    let (files, trusts) = certificate(root, (2020, 2099));
    let other = KeyPair::generate().expect("a key").serialize_pem();
    let right = fs::read(&files.key).expect("there");
    fs::write(&files.key, other).expect("written");
    assert!(open(files.clone()).expect_err("other key").contains("is not the key of the certificate"));
    fs::write(&files.key, "nothing").expect("written");
    assert!(open(files.clone()).expect_err("no key").contains("no private key"));
    fs::remove_file(&files.key).expect("removed");
    assert!(open(files.clone()).expect_err("no file").contains("cannot read"));
    // The renewed one is taken without a new start.
    fs::write(&files.key, right).expect("written");
    open(files).expect("right");
    let site = Site { trusts, ..site };
    site.rules.look();
    drop(site.stream().await);
}

#[test]
fn what_others_reach_has_tls_and_users() {
    let wide = Some(IpAddr::from([0, 0, 0, 0]));
    let root = std::env::temp_dir().join(format!("g7-rules-{}", std::process::id()));
    fs::create_dir_all(&root).expect("a folder");
    let (files, _) = certificate(&root, (2020, 2099));
    let of = |host: Option<IpAddr>, cert: bool, users: bool| {
        let args = Serve {
            host,
            users: users.then(|| root.join("users")),
            cert: cert.then(|| files.cert.clone()),
            key: cert.then(|| files.key.clone()),
            ..args_of(&root)
        };
        Rules::of(&args, None, &Audit::default(), None).map(drop).map_err(|e| e.to_string())
    };
    assert!(of(wide, true, true).is_ok() && of(None, false, false).is_ok() && of(None, true, false).is_ok());
    for (host, cert, users, words) in [
        (wide, false, false, ["g7 cert", "--users"]),
        (wide, true, false, ["no users", "--users"]),
        (wide, false, true, ["nothing is encrypted", "g7 cert"]),
        (None, false, true, ["encrypted connections alone", "g7 cert"]),
    ] {
        let why = of(host, cert, users).expect_err("refused");
        assert!(words.iter().all(|word| why.contains(word)), "{why}");
    }
    fs::remove_dir_all(&root).ok();
}
