//! Access: only own hosts and origins, and only with the token.

use super::*;

#[tokio::test]
async fn the_page_asks_with_its_token() {
    let server = Server::new().await;
    let info = server.get("/api/info").await.is(200).json();
    assert_eq!(info["name"], "g7");
    assert_eq!(info["read_only"], false);
    assert_eq!(info["start"], "chart.g7");
}

#[tokio::test]
async fn without_the_token_of_this_start_nothing_is_told() {
    let server = Server::new().await;
    let host = server.bound.to_string();
    let other = "0".repeat(server.token.len());
    let short = server.token[1..].to_owned();
    for given in [None, Some(String::new()), Some(other), Some(short)] {
        let bearer = given.map(|t| format!("Bearer {t}"));
        let mut headers = vec![("Host", host.as_str())];
        headers.extend(bearer.as_deref().map(|b| ("Authorization", b)));
        for path in ["/api/info", "/api/files", "/api/file?path=chart.g7", "/api/drafts", "/api/nothing"] {
            let reply = server.bare("GET", path, &headers, "").await.is(401);
            assert!(reply.text().contains("g7 serve"), "says what to do: {}", reply.text());
        }
        let headers: Vec<_> = headers.iter().copied().chain([("If-Match", "*")]).collect();
        server.bare("PUT", "/api/file?path=chart.g7", &headers, "x").await.is(401);
    }
    // In the address, the token counts only where a browser can set no header.
    let path = format!("/api/info?token={}", server.token);
    server.bare("GET", &path, &[("Host", &host)], "").await.is(401);
    assert_eq!(server.on_disk("chart.g7"), CHART);
}

#[tokio::test]
async fn two_starts_have_two_tokens() {
    let own = || Tokens::fresh().expect("a token").own().to_owned();
    assert_ne!(own(), own());
    assert_eq!(own().len(), 48);
}

#[tokio::test]
async fn foreign_hosts_are_refused_whatever_they_know() {
    let server = Server::new().await;
    let bearer = format!("Bearer {}", server.token);
    let port = server.bound.port();
    let (evil, near, other) =
        (format!("evil.example:{port}"), format!("localhost.evil.example:{port}"), "127.0.0.1:1".to_owned());
    for host in [evil, near, other, "127.0.0.1".to_owned(), String::new()] {
        for path in ["/", "/api/info", "/api/live", "/nothing"] {
            let headers = [("Host", host.as_str()), ("Authorization", bearer.as_str())];
            server.bare("GET", path, &headers, "").await.is(403);
        }
    }
    // No host, and two hosts.
    let headers = [("Authorization", bearer.as_str())];
    assert!(server.bare("GET", "/api/info", &headers, "").await.status >= 400);
    let own = server.bound.to_string();
    let headers = [("Host", own.as_str()), ("Host", own.as_str()), ("Authorization", bearer.as_str())];
    assert!(server.bare("GET", "/api/info", &headers, "").await.status >= 400);
    // A name that means this machine.
    let local = format!("localhost:{port}");
    server.bare("GET", "/api/info", &[("Host", &local), ("Authorization", &bearer)], "").await.is(200);
}

#[tokio::test]
async fn foreign_origins_are_refused_whatever_they_know() {
    let server = Server::new().await;
    let own = format!("http://{}", server.bound);
    server.ask("GET", "/api/info", &[("Origin", &own)], "").await.is(200);
    let port = server.bound.port();
    let origins = [
        "http://evil.example".to_owned(),
        "null".to_owned(),
        format!("https://{}", server.bound),
        format!("http://localhost:{port}"),
        "http://127.0.0.1:1".to_owned(),
        format!("{own}.evil.example"),
    ];
    for origin in &origins {
        for (method, path) in [("GET", "/api/info"), ("PUT", "/api/file?path=chart.g7"), ("GET", "/")] {
            server.ask(method, path, &[("Origin", origin), ("If-Match", "*")], "x").await.is(403);
        }
        assert_eq!(refused(server.try_live(&[("Origin", origin)]).await).0, 403, "{origin}");
    }
    server.ask("GET", "/api/info", &[("Sec-Fetch-Site", "cross-site")], "").await.is(403);
    server.ask("GET", "/api/info", &[("Sec-Fetch-Site", "same-origin")], "").await.is(200);
    assert!(server.try_live(&[("Origin", &own)]).await.is_ok());
    assert_eq!(server.on_disk("chart.g7"), CHART);
}

#[tokio::test]
async fn a_socket_needs_host_and_token_too() {
    let mut server = Server::new().await;
    let host = format!("evil.example:{}", server.bound.port());
    assert_eq!(refused(server.try_live(&[("Host", &host)]).await).0, 403);
    let token = std::mem::replace(&mut server.token, "wrong".to_owned());
    assert_eq!(refused(server.try_live(&[]).await).0, 401);
    server.token = token;
    assert!(server.try_live(&[]).await.is_ok());
}

#[tokio::test]
async fn every_answer_keeps_the_page_to_itself() {
    let server = Server::new().await;
    for path in
        ["/", "/chart.g7", "/api/info", "/api/file?path=chart.g7", "/api/file?path=none.g7", "/nothing"]
    {
        let reply = server.get(path).await;
        assert_eq!(reply.header("x-content-type-options"), Some("nosniff"), "{path}");
        assert_eq!(reply.header("referrer-policy"), Some("no-referrer"), "{path}");
        let policy = reply.header("content-security-policy").expect("a policy");
        assert!(
            policy.contains("default-src 'self'") && policy.contains("frame-ancestors 'none'"),
            "{policy}"
        );
        let scripts = policy.split("; ").find(|p| p.starts_with("script-src")).expect("of scripts");
        assert_eq!(scripts, "script-src 'self' 'wasm-unsafe-eval'");
    }
}

#[tokio::test]
async fn only_editors_may_frame_the_page_and_only_where_the_server_was_asked_to_let_them() {
    let server = Server::new().await;
    assert_eq!(server.get("/").await.header("x-frame-options"), Some("DENY"));
    let editors = "frame-ancestors 'self' vscode-webview: vscode-file: https://*.vscode-cdn.net";
    for (given, wanted) in
        [("", editors.to_owned()), ("http://127.0.0.1:8080", format!("{editors} http://127.0.0.1:8080"))]
    {
        let server = Server::with(|args| args.framed = Some(given.to_owned()), Limits::default()).await;
        let reply = server.get("/").await;
        assert_eq!(reply.header("x-frame-options"), None);
        let policy = reply.header("content-security-policy").expect("a policy");
        assert_eq!(policy.split("; ").find(|p| p.starts_with("frame-ancestors")), Some(&*wanted));
    }
    // An address cannot bring rules of its own.
    for wrong in ["*", "https:", "http://", "http://a; script-src *", "http://a/path", "http://a b"] {
        let args = Serve { framed: Some(wrong.to_owned()), ..args_of(Path::new(".")) };
        assert!(Rules::of(&args, None, &crate::audit::Audit::default(), None).is_err(), "{wrong}");
    }
}

#[tokio::test]
async fn the_page_comes_from_its_folder_only() {
    let server = Server::new().await;
    fs::write(server.path("index.html"), "<p>page").expect("a page");
    let page = server.get("/?token=x").await.is(200);
    assert_eq!(
        (page.text().as_str(), page.header("content-type")),
        ("<p>page", Some("text/html; charset=utf-8"))
    );
    let tag = page.tag();
    server.ask("GET", "/", &[("If-None-Match", &tag)], "").await.is(304);
    for path in ["/../secret.g7", "/%2e%2e/secret.g7", "/..%2fsecret.g7", "//secret.g7", "/none.js"] {
        assert!(!server.get(path).await.is(404).text().contains("secret"), "{path}");
    }
}

#[tokio::test]
async fn without_a_page_it_is_said_how_to_build_one() {
    let server = Server::new().await;
    let reply = server.get("/").await.is(503);
    assert!(reply.text().contains("make web"), "{}", reply.text());
}

#[tokio::test]
async fn a_server_proves_that_it_knows_the_token_before_it_is_told() {
    use sha2::{Digest as _, Sha256};
    let hex = |text: &str| Sha256::digest(text).iter().map(|b| format!("{b:02x}")).collect::<String>();
    let server = Server::new().await;
    let host = server.bound.to_string();
    let ask = async |number: &str| {
        let path = format!("/api/again?number={number}");
        server.bare("GET", &path, &[("Host", &host)], "").await
    };
    let number = "00112233445566778899aabbccddeeff";
    // A page has one token: that of this start or that of guests.
    let awaited = [&server.token, &server.guest]
        .map(|token| hex(&format!("{}:{}:{number}", hex(token), server.bound.port())));
    assert_eq!(ask(number).await.is(200).json(), json!({ "proofs": awaited }));
    for wrong in ["", "00", &format!("{number}00"), &format!("{}zz", &number[..30])] {
        ask(wrong).await.is(400);
    }
    let foreign = [("Host", host.as_str()), ("Origin", "http://evil.example")];
    server.bare("GET", &format!("/api/again?number={number}"), &foreign, "").await.is(403);
}
