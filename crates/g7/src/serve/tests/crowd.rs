//! Many clients, and clients that misbehave: the scans go on.

use super::*;

/// Waits for frames until `more` further scans were made.
async fn goes_on(page: &mut Live, more: u64) {
    let scans = |f: &Value| f["scans"].as_u64().expect("scans");
    page.unread.clear();
    let first = scans(&page.hear_of("frame").await);
    while scans(&page.hear_of("frame").await) < first + more {}
}

async fn paced(server: &Server) -> Live {
    let mut page = server.live().await;
    page.start("a").await;
    page.call(json!({ "do": "pace", "run": "a", "speed": 1.0 })).await;
    page
}

#[tokio::test]
async fn there_are_200_places_and_no_more() {
    let server = Server::with(|_| {}, Limits { clients: 200, ..Limits::default() }).await;
    let mut pages = vec![paced(&server).await];
    while pages.len() < 200 {
        let mut page = server.live().await;
        page.call(json!({ "do": "watch", "run": "a" })).await;
        pages.push(page);
    }
    for page in &mut pages {
        goes_on(page, 1).await;
    }
    let (status, text) = refused(server.try_live(&[]).await);
    assert_eq!(status, 429);
    assert!(text.is_empty() || text.contains("200 places"), "{text}");
    server.get("/api/info").await.is(200);
    goes_on(&mut pages[0], 10).await;
    // A client that leaves makes room.
    drop(pages.pop());
    while server.try_live(&[]).await.is_err() {
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
}

#[tokio::test]
async fn a_page_that_never_reads_holds_up_nobody() {
    let server = Server::new().await;
    let mut page = paced(&server).await;
    let mut mute = server.live().await;
    let watch = json!({ "id": 1, "call": { "do": "watch", "run": "a" } }).to_string();
    mute.send(&watch).await;
    // Answers that it never reads, as many as the network can hold.
    let flood = async {
        for _ in 0..10_000 {
            if mute.socket.send(Message::text(watch.clone())).await.is_err() {
                break;
            }
        }
        std::future::pending::<()>().await;
    };
    tokio::select! {
        () = flood => {}
        () = goes_on(&mut page, 100) => {}
    }
}

#[tokio::test]
async fn garbage_is_answered_and_forgotten() {
    let server = Server::new().await;
    let mut page = paced(&server).await;
    let mut noise = server.live().await;
    let deep = "[".repeat(100_000);
    let words = [
        "",
        "null",
        "[]",
        "{",
        "\"text\"",
        "\u{0}\u{1F600}",
        &deep,
        "{\"id\":-1,\"call\":{}}",
        "{\"id\":1}",
        "{\"id\":1e99,\"call\":{\"do\":\"runs\"}}",
        "{\"call\":{\"do\":\"runs\"}}",
    ];
    for word in words {
        noise.send(word).await;
        assert!(noise.receive().await["no"].is_string(), "{word:.20}");
    }
    for call in [
        json!({}),
        json!([]),
        json!(7),
        json!({ "do": 7 }),
        json!({ "do": "what" }),
        json!({ "do": "run_" }),
        json!({ "do": "run_start" }),
        json!({ "do": "run_start", "run": "a" }),
        json!({ "do": "run_toggle", "run": "a", "signal": 1e9 as u64 }),
        json!({ "do": "run_toggle", "run": "a", "signal": -1 }),
        json!({ "do": "run_set", "run": "a" }),
        json!({ "do": "run_lanes", "run": "a", "signals": [0, 1, 99], "from_ms": "x", "to_ms": null }),
        json!({ "do": "watch" }),
        json!({ "do": "operator_run" }),
        json!({ "do": "operator_watch" }),
        json!({ "do": "pace", "run": "none", "speed": 1.0 }),
        json!({ "do": "pace", "run": "a", "speed": "fast" }),
    ] {
        let why = noise.no(call.clone()).await;
        assert!(!why.is_empty(), "{call}");
    }
    noise.socket.send(Message::binary(vec![0u8; 1000])).await.expect("sent");
    assert!(noise.receive().await["no"].is_string());
    for _ in 0..10_000 {
        noise.socket.feed(Message::text("garbage")).await.expect("sent");
        if noise.next % 50 == 0 {
            noise.socket.flush().await.expect("sent");
        }
        noise.next += 1;
        // Unread answers would fill the way back.
        assert!(noise.receive_after_flush().await["no"].is_string());
    }
    goes_on(&mut page, 20).await;
    assert_eq!(noise.call(json!({ "do": "runs" })).await["runs"][0]["run"], "a", "it may mend its ways");
}

impl Live {
    async fn receive_after_flush(&mut self) -> Value {
        self.socket.flush().await.expect("sent");
        self.receive().await
    }
}

#[tokio::test]
async fn a_message_of_100_mb_ends_who_sends_it() {
    let server = Server::new().await;
    let mut page = paced(&server).await;
    let mut huge = server.live().await;
    let send = huge.socket.send(Message::text("x".repeat(100 << 20)));
    // The server closes the connection while the client is still sending.
    let sent = tokio::time::timeout(PATIENCE, send).await.expect("an end");
    if sent.is_ok() {
        while let Ok(Some(Ok(_))) = tokio::time::timeout(PATIENCE, huge.socket.next()).await {}
    }
    goes_on(&mut page, 20).await;
    // Nor is it a call: its contents are never looked at.
    assert_eq!(page.call(json!({ "do": "runs" })).await["runs"].as_array().map(Vec::len), Some(1));
    // Noise instead of HTTP, and a connection that sends nothing.
    let idle = TcpStream::connect(server.bound).await.expect("a connection");
    let mut noise = TcpStream::connect(server.bound).await.expect("a connection");
    noise.write_all(&[0xff; 10_000]).await.ok();
    goes_on(&mut page, 20).await;
    drop(idle);
}

#[tokio::test]
async fn who_gives_no_sign_is_let_go() {
    let limits = Limits {
        clients: 2,
        ping: Duration::from_millis(200),
        silence: Duration::from_secs(4),
        ..Limits::default()
    };
    let server = Server::with(|_| {}, limits).await;
    let mut page = paced(&server).await;
    // A client that never reads and therefore answers no ping.
    let mute = server.live().await;
    assert_eq!(refused(server.try_live(&[]).await).0, 429);
    loop {
        goes_on(&mut page, 1).await;
        if server.try_live(&[]).await.is_ok() {
            break;
        }
    }
    drop(mute);
    assert_eq!(page.call(json!({ "do": "runs" })).await["runs"][0]["run"], "a", "who reads stays");
}

#[tokio::test]
async fn a_page_left_behind_is_given_a_full_frame() {
    let server = Server::new().await;
    let mut page = server.live().await;
    page.start("a").await;
    let outbox = Arc::new(outbox::Outbox::default());
    let run: Arc<str> = Arc::from("a");
    // More than the server keeps for any client.
    server.shared.runs.watch("a", &outbox, 1).await.expect("watched");
    for _ in 0..1_000 {
        page.call(json!({ "do": "run_scan", "run": "a" })).await;
    }
    assert!(matches!(outbox.next().await, outbox::Next::Text(t) if t.contains("\"answer\"")));
    assert_eq!(outbox.next().await, outbox::Next::Behind(Arc::clone(&run)));
    server.shared.runs.catch_up(&run, &outbox);
    let outbox::Next::Text(full) = outbox.next().await else { panic!("a frame") };
    let full: Value = serde_json::from_str(&full).expect("JSON");
    assert_eq!((&full["frame"]["full"], &full["frame"]["scans"]), (&json!(true), &json!(1_001)));
    // From then on it gets the same frames as the others.
    let frame = page.call(json!({ "do": "run_scan", "run": "a" })).await;
    let outbox::Next::Text(next) = outbox.next().await else { panic!("a frame") };
    assert_eq!(serde_json::from_str::<Value>(&next).expect("JSON")["frame"], frame);
}

/// A panic of which nobody reads on the terminal.
async fn breaks() {
    std::panic::resume_unwind(Box::new("as the test wants it"))
}

#[tokio::test]
async fn row_18_a_handler_that_panics_ends_its_own_connection_and_nothing_else() {
    let server = Server::new().await;
    let mut page = paced(&server).await;
    let broken: Router = Router::new().route("/", get(breaks)).route("/well", get(|| async { "well" }));
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.expect("a port");
    let beside = listener.local_addr().expect("an address");
    let task = tokio::spawn(listen::listen(listener, broken, listen::Door::default()));
    let ask = async |path: &str| {
        let mut stream = TcpStream::connect(beside).await.expect("a connection");
        let head = format!("GET {path} HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
        stream.write_all(head.as_bytes()).await.expect("sent");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).await.ok();
        answer
    };
    let count = g7_peers::faults::trials(100, 3);
    for _ in 0..count {
        assert_eq!(ask("/").await, "", "the connection ends");
        assert!(ask("/well").await.ends_with("well"), "the next one is served");
    }
    goes_on(&mut page, 5).await;
    task.abort();
    g7_peers::faults::row(18, "the server", count.into(), 0, "one connection ends, all others go on");
}

/// A server beside one, with other rules for connections. It ends with the test.
async fn beside(server: &Server, door: listen::Door) -> SocketAddr {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.expect("a port");
    let bound = listener.local_addr().expect("an address");
    let rules = Rules::of(&args_of(&server.root.join("charts")), None, &crate::audit::Audit::default(), None);
    let guard = rules.expect("they fit").guard(some_pass(), None, bound);
    tokio::spawn(listen::listen(listener, app(Arc::clone(&server.shared), guard), door));
    bound
}

/// Asks for a file without a token.
async fn ask_for(bound: SocketAddr, path: &str) -> TcpStream {
    let mut stream = TcpStream::connect(bound).await.expect("a connection");
    let head = format!("GET {path} HTTP/1.1\r\nHost: {bound}\r\nConnection: close\r\n\r\n");
    stream.write_all(head.as_bytes()).await.expect("sent");
    stream
}

async fn all_of(mut stream: TcpStream) -> Vec<u8> {
    let mut bytes = Vec::new();
    tokio::time::timeout(PATIENCE, stream.read_to_end(&mut bytes)).await.expect("an end").ok();
    bytes
}

/// More than the system takes off a connection that nobody reads.
const GIANT: usize = 32 << 20;

#[tokio::test]
async fn who_reads_nothing_locks_nobody_out() {
    let server = Server::new().await;
    fs::write(server.path("g7.wasm"), vec![7; GIANT]).expect("a large file");
    fs::write(server.path("index.html"), "<p>page").expect("a page");
    let quiet = Duration::from_millis(300);
    let bound = beside(&server, listen::Door { from_one: 8, quiet, ..listen::Door::default() }).await;
    let mut held = Vec::new();
    for _ in 0..8 {
        held.push(ask_for(bound, "/g7.wasm").await);
    }
    let served = async {
        while !all_of(ask_for(bound, "/").await).await.ends_with(b"<p>page") {
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    };
    // Well before the time in which an answer may stand still.
    tokio::time::timeout(Duration::from_secs(12), served).await.expect("let in");
    // Who reads has the whole file, however many hold it.
    let whole = all_of(ask_for(bound, "/g7.wasm").await).await;
    let body = whole.windows(4).position(|w| w == b"\r\n\r\n").expect("a head") + 4;
    assert!(whole.len() - body == GIANT && whole.iter().skip(body).all(|b| *b == 7));
}

#[tokio::test]
async fn an_answer_that_nobody_reads_ends() {
    let server = Server::new().await;
    fs::write(server.path("g7.wasm"), vec![7; GIANT]).expect("a large file");
    let stall = Duration::from_millis(400);
    let bound = beside(&server, listen::Door { stall, ..listen::Door::default() }).await;
    let stream = ask_for(bound, "/g7.wasm").await;
    tokio::time::sleep(stall * 5).await;
    assert!(all_of(stream).await.len() < GIANT, "it was given up");
}

#[tokio::test]
async fn slow_uploads_delay_no_save() {
    let server = Server::new().await;
    let mut slow = Vec::new();
    for _ in 0..12 {
        let mut stream = TcpStream::connect(server.bound).await.expect("a connection");
        let head = format!(
            "PUT /api/file?path=slow.g7 HTTP/1.1\r\nHost: {}\r\nAuthorization: Bearer {}\r\n\
             If-None-Match: *\r\nContent-Length: 8000000\r\n\r\nchart",
            server.bound, server.token
        );
        stream.write_all(head.as_bytes()).await.expect("sent");
        slow.push(stream);
    }
    // All of them are being read.
    tokio::time::sleep(Duration::from_millis(200)).await;
    let save = server.ask("PUT", "/api/file?path=chart.g7", &[("If-Match", "*")], "saved");
    tokio::time::timeout(Duration::from_secs(4), save).await.expect("without a wait").is(204);
    assert_eq!(server.on_disk("chart.g7"), "saved");
    // Those who stand still hear so.
    let first = all_of(slow.remove(0)).await;
    assert!(first.starts_with(b"HTTP/1.1 408"), "{}", String::from_utf8_lossy(&first));
    assert!(!server.path("slow.g7").exists());
}

#[tokio::test]
async fn a_run_that_is_refused_as_too_large_is_not_there() {
    let server = Server::new().await;
    let name = "n".repeat(900);
    let text = format!("var {name} : ARRAY[1..20000] OF INT\n{CHART}");
    fs::write(server.path("large.g7"), text).expect("a large chart");
    let mut page = server.live().await;
    let start = json!({ "do": "run_start", "run": "a", "file": "large.g7" });
    let why = page.no(start).await;
    assert!(why.contains("too much at once"), "{why}");
    assert_eq!(page.call(json!({ "do": "runs" })).await["runs"], json!([]));
}
