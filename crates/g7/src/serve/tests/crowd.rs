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
